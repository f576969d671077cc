//! Files that are not whole, and files that must not be written over.
#![allow(clippy::unwrap_used, reason = "helpers of tests fail as tests do")]

mod program;

use image::{ExtendedColorType, codecs::jpeg::JpegEncoder};
use program::{PAPER, PHOTO, wmr};
use std::path::Path;
use std::process::Output;

/// The demo's photo as a JPEG.
fn jpeg() -> Vec<u8> {
    let picture = image::open(PHOTO).unwrap().into_rgb8();
    let mut bytes = Vec::new();
    let mut encoder = JpegEncoder::new_with_quality(&mut bytes, 92);
    encoder
        .encode(picture.as_raw(), picture.width(), picture.height(), ExtendedColorType::Rgb8)
        .unwrap();
    bytes
}

fn detect(photo: &Path) -> Output {
    wmr(&["detect", photo.to_str().unwrap(), "--arena", "1.3x1.55", "--json"])
}

#[test]
fn a_jpeg_that_was_cut_short_is_refused_however_little_is_missing() {
    let folder = tempfile::tempdir().unwrap();
    let photo = folder.path().join("photo.jpg");
    let whole = jpeg();
    std::fs::write(&photo, &whole).unwrap();
    assert!(detect(&photo).status.success());
    for share in [0.2, 0.6, 0.95, 0.999] {
        std::fs::write(&photo, &whole[..(share * whole.len() as f64) as usize]).unwrap();
        let output = detect(&photo);
        assert_eq!(output.status.code(), Some(3), "{share}");
        let text = String::from_utf8(output.stdout).unwrap();
        assert!(text.contains("complete PNG or JPEG"), "{share}: {text}");
    }
}

#[test]
fn no_result_is_written_over_its_input_or_another_kind_of_file() {
    let folder = tempfile::tempdir().unwrap();
    let scene = folder.path().join("scene.json");
    std::fs::copy(PAPER, &scene).unwrap();
    let name = scene.to_str().unwrap();
    for arguments in [["plan", name, "-o", name], ["tags", "--out", name, "--json"]] {
        let output = wmr(&arguments);
        assert_eq!(output.status.code(), Some(2), "{output:?}");
        assert_eq!(std::fs::read(&scene).unwrap(), std::fs::read(PAPER).unwrap());
    }
    // The folder in which the inputs lie is none for results that have their names.
    let log = folder.path().to_str().unwrap();
    let output = wmr(&["drive", name, "--port", "sim", "--log", log]);
    assert_eq!(output.status.code(), Some(2), "{output:?}");
    assert_eq!(std::fs::read(&scene).unwrap(), std::fs::read(PAPER).unwrap());
    // An older plan may be written over.
    let plan = folder.path().join("plan.json");
    for _ in 0..2 {
        assert!(wmr(&["plan", name, "-o", plan.to_str().unwrap()]).status.success());
    }
    let plan = plan.to_str().unwrap();
    let before = std::fs::read(plan).unwrap();
    let output = wmr(&["drive", plan, "--port", "sim", "--log", log]);
    assert_eq!(output.status.code(), Some(2), "{output:?}");
    assert_eq!(std::fs::read(plan).unwrap(), before);
}

#[test]
fn a_map_a_photo_and_a_scenario_are_not_written_over_by_what_is_made_of_them() {
    let folder = tempfile::tempdir().unwrap();
    let write = |name: &str, bytes: &[u8]| {
        let path = folder.path().join(name);
        std::fs::write(&path, bytes).unwrap();
        path.to_str().unwrap().to_owned()
    };
    let map = write("a.map", b"type octile\nheight 2\nwidth 3\nmap\n...\n.@.\n");
    let photo = write("photo", &std::fs::read(PHOTO).unwrap());
    let scenario = write("pushed.toml", include_bytes!("../../tests/scenarios/pushed.toml"));
    let notes = write("scene.json", b"my notes");
    let here = folder.path().to_str().unwrap();
    for arguments in [
        &["export", &map, "-o", &map, "--resolution", "0.5"] as &[&str],
        &["detect", &photo, "--arena", "1.3x1.55", "--steps", here],
        &["sim", "--scenario", &scenario, "--moment", "idle", "--out", &scenario],
        &["plan", PAPER, "--steps", here],
        &["calibrate", "camera", &photo, "--arena", "1.3x1.55", "--out", &photo],
    ] {
        let before = [&map, &photo, &scenario, &notes].map(|path| std::fs::read(path).unwrap());
        let output = wmr(arguments);
        let after = [&map, &photo, &scenario, &notes].map(|path| std::fs::read(path).unwrap());
        assert!(before == after, "{arguments:?} has written over a file: {output:?}");
    }
}
