//! `wmr calibrate camera` from the command line: a file that detect takes, and errors that help.
#![allow(clippy::unwrap_used, clippy::panic, reason = "helpers of tests fail as tests do")]

mod program;

use program::{document, numbers, succeed, wmr};
use serde_json::Value;
use std::path::Path;

/// Drawn at 250 pixels a metre, looking straight down on the middle of the arena.
const PHOTO: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/assets/paper.png");
const OTHER_PHOTO: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/assets/demo.png");
const ARENA: &str = "1.6x2.0";
/// From 3 m such a picture takes a lens of 750 pixels.
const FOCAL: f64 = 750.0;
/// The border is found to a tenth of a pixel, of 400.
const FOCAL_TOLERANCE: f64 = 0.5;
/// A tenth of a pixel, and as much for the lens.
const PLACE_TOLERANCE: f64 = 0.002;
/// Two pixels.
const EDGE_TOLERANCE: f64 = 0.008;

fn calibrate(words: &[&str]) -> Vec<String> {
    let all = [&["calibrate", "camera", "--json", "--arena", ARENA], words].concat();
    all.into_iter().map(str::to_owned).collect()
}

fn calibrated(words: &[&str]) -> Value {
    let words = calibrate(words);
    succeed(&words.iter().map(String::as_str).collect::<Vec<_>>())
}

/// The exit code and the error's code, message and help.
fn refused(words: &[&str]) -> (i32, [String; 3]) {
    let words = calibrate(words);
    let output = wmr(&words.iter().map(String::as_str).collect::<Vec<_>>());
    let error = &document(&output)["error"];
    let text = ["code", "message", "help"].map(|key| error[key].as_str().unwrap().to_owned());
    (output.status.code().unwrap(), text)
}

#[test]
fn detect_takes_the_camera_that_was_calibrated() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("camera.json");
    let file = path.to_str().unwrap();
    let found = calibrated(&[PHOTO, PHOTO, "--height", "3m", "--out", file]);
    let written: Value = serde_json::from_str(&std::fs::read_to_string(&path).unwrap()).unwrap();
    assert_eq!(written, found);
    assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 1);
    let camera = &found["main"];
    assert!((camera["K"][0][0].as_f64().unwrap() - FOCAL).abs() < FOCAL_TOLERANCE, "{camera}");
    for (found, place) in numbers(&camera["position"]).into_iter().zip([0.8, 1.0, 3.0]) {
        assert!((found - place).abs() < PLACE_TOLERANCE, "{camera}");
    }
    let spread = numbers(&camera["sd"]["position"]);
    assert!(spread.into_iter().all(|metres| metres > 0.0 && metres < 0.1), "{camera}");

    let seen = |more: &[&str]| {
        let seen = succeed(&[&["detect", PHOTO, "--arena", ARENA, "--json"], more].concat());
        seen["obstacles"].as_array().unwrap().iter().map(numbers).collect::<Vec<_>>()
    };
    let (by_border, by_camera) = (seen(&[]), seen(&["--camera", file]));
    assert_eq!(by_border.len(), by_camera.len());
    for (a, b) in by_border.iter().flatten().zip(by_camera.iter().flatten()) {
        assert!((a - b).abs() < EDGE_TOLERANCE, "{by_border:?} {by_camera:?}");
    }
}

#[test]
fn a_camera_that_has_moved_is_told() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("camera.json");
    let mut camera = calibrated(&[PHOTO, "--height", "3"]);
    let warned = |camera: &Value| {
        std::fs::write(&path, camera.to_string()).unwrap();
        let file = path.to_str().unwrap();
        let seen = succeed(&["detect", PHOTO, "--arena", ARENA, "--camera", file, "--json"]);
        seen["warnings"].to_string().contains("the camera may have moved")
    };
    assert!(!warned(&camera));
    let x = camera["main"]["K"][0][2].as_f64().unwrap();
    let y = camera["main"]["K"][1][2].as_f64().unwrap();
    camera["main"]["K"][0][2] = (x + 8.0).into();
    camera["main"]["K"][1][2] = (y + 8.0).into();
    assert!(warned(&camera));
}

#[test]
fn two_cameras_are_written_for_two_pictures() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("pair.json");
    let file = path.to_str().unwrap();
    let pair = [PHOTO, "--second", PHOTO, "--height", "3,2.5", "--out", file];
    let found = calibrated(&pair);
    let height = |name: &str| numbers(&found[name]["position"])[2];
    assert!((height("a") - 3.0).abs() < PLACE_TOLERANCE, "{found}");
    assert!((height("b") - 2.5).abs() < PLACE_TOLERANCE, "{found}");
    // Both stand over one point, which detect says of the file that it could read.
    let output = wmr(&["detect", PHOTO, PHOTO, "--arena", ARENA, "--camera", file, "--json"]);
    assert_eq!(output.status.code(), Some(3));
    let error = document(&output)["error"].to_string();
    assert!(error.contains("apart"), "{error}");
}

#[test]
fn corners_may_be_pointed_at() {
    let seen = succeed(&["detect", PHOTO, "--arena", ARENA, "--json"]);
    let corners: Vec<String> = seen["corners_px"].as_array().unwrap().iter().map(pixel).collect();
    let found = calibrated(&[PHOTO, "--height", "3", "--corners", &corners.join(" ")]);
    let camera = &found["main"];
    // A pixel of 400 each way.
    assert!((camera["K"][0][0].as_f64().unwrap() / FOCAL - 1.0).abs() < 0.005, "{camera}");
    let wrong: Vec<String> = corners.into_iter().rev().collect();
    let (exit, [_, message, _]) = refused(&[PHOTO, "--corners", &wrong.join(" ")]);
    assert!(exit == 3 && message.contains("do not run counter-clockwise"), "{message}");
}

/// A corner as one would read it off a picture.
fn pixel(corner: &Value) -> String {
    let [x, y] = numbers(corner)[..] else { panic!("{corner} is no pixel") };
    format!("{x:.0},{y:.0}")
}

#[test]
fn without_a_height_from_straight_above_it_says_what_to_measure() {
    let found = calibrated(&[PHOTO]);
    let camera = &found["main"];
    let (focal, spread) =
        (camera["K"][0][0].as_f64().unwrap(), camera["sd"]["focal"].as_f64().unwrap());
    assert!(spread > 0.25 * focal, "{camera}");
    assert!(camera["warnings"][0].as_str().unwrap().contains("--height"), "{camera}");
}

#[test]
fn bad_input_is_refused_with_what_to_type_next() {
    let missing = "no such photo.png";
    for (words, exit, code, part) in [
        (&[PHOTO, missing][..], 3, "file.read", missing),
        (&[PHOTO, "--height", "0"], 2, "usage", "height"),
        (&[PHOTO, "--height", "3,3"], 2, "usage", "--height is given for 2 cameras"),
        (&[PHOTO, "--second", PHOTO, "--focal", "750"], 2, "usage", "--focal"),
        (&[PHOTO, "--height", "150"], 3, "photo", "focal length"),
        (&[PHOTO, "--corners", "1,1 2,2"], 2, "usage", "corners"),
        (&[PHOTO, OTHER_PHOTO], 3, "photo", OTHER_PHOTO),
        (&[PHOTO, "--out", "no such folder/camera.json"], 3, "file.write", "no such folder"),
    ] {
        let (got, [found, message, help]) = refused(words);
        assert_eq!((got, found.as_str()), (exit, code), "{words:?}: {message}");
        assert!(message.contains(part) && !help.is_empty(), "{words:?}: {message}; {help}");
    }
    assert!(!Path::new("no such folder").exists());
}
