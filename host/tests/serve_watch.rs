//! `wmr serve` with a camera over the arena: its frames, the drives that it watches, and what it may not be asked.
#![allow(clippy::unwrap_used, clippy::panic, reason = "helpers of tests fail as tests do")]
#![cfg(feature = "dashboard")]

mod server;

use serde_json::{Value, json};
use server::{Server, is_at_rest};
use std::io::Read;

/// A floor with one box beside the way, which is short: each frame is seen by an unoptimised program.
fn plan(server: &Server) -> Value {
    let scene = json!({
        "format": "wmr-scene/1", "arena": {"width": 1.2, "height": 0.9}, "robot_radius": 0.075,
        "obstacles": [[0.5, 0.6, 0.7, 0.9]],
    });
    server.done("plan", &json!({"scene": scene, "start": [0.25, 0.3, 0], "goal": [0.7, 0.3]}))
}

fn frame(server: &Server, token: &str) -> (u16, Vec<u8>) {
    let line = format!("GET /api/camera/frame?t={token}");
    server.raw(&line, &[("Host", &server.host)], b"")
}

#[test]
fn a_simulated_camera_shows_the_floor_and_watches_the_drive() {
    let server = Server::start_at("1");
    plan(&server);
    assert_eq!(server.state()["camera"]["sources"], json!(["sim"]));
    assert_eq!(frame(&server, &server.token).0, 409, "none is on");
    server.done("camera", &json!({"source": "sim"}));
    let state = server.when("a frame", |state| state["camera"]["frame"].is_u64());
    let camera = &state["camera"];
    assert_eq!((&camera["source"], &camera["problem"]), (&json!("sim"), &Value::Null));
    assert_eq!(camera["corners_px"].as_array().map(Vec::len), Some(4));
    let (status, bytes) = frame(&server, &server.token);
    assert!(status == 200 && bytes.starts_with(&[0xff, 0xd8]), "a JPEG file");
    assert_eq!(frame(&server, "guess").0, 401);

    server.done("drive", &json!({}));
    assert_eq!(server.post("camera", &json!({"source": null})).0, 409, "it watches");
    let state = server.when("watched", |state| state["drive"]["view"]["way"].is_array());
    let view = &state["drive"]["view"];
    assert!(view["covariance"][0][0].as_f64().unwrap() > 0.0, "{view}");
    assert_eq!(view["things"].as_array().map(Vec::len), Some(1), "{view}");
    let report = server.when("at rest", is_at_rest)["run"]["report"].clone();
    assert_eq!((&report["reached"], &report["collisions"]), (&json!(true), &json!(0)), "{report}");
    assert!(report["watch"]["used"].as_u64().unwrap() > 5, "{report}");
}

#[test]
fn a_stop_ends_a_watched_drive_and_one_before_it_begins() {
    let server = Server::start_at("1");
    plan(&server);
    server.done("camera", &json!({"source": "sim"}));
    server.done("drive", &json!({}));
    server.when("driving", |state| state["base"]["state"] == "driving");
    server.done("stop", &json!({}));
    let state = server.when("at rest", is_at_rest);
    assert_eq!(state["run"]["error"]["code"], "robot.stopped", "{}", state["run"]);
    assert_eq!(state["base"]["wheels"], json!([0.0, 0.0]));

    // A stop while the first frame is still looked at.
    std::thread::scope(|scope| {
        let drive = scope.spawn(|| server.post("drive", &json!({})));
        while !drive.is_finished() {
            server.done("stop", &json!({}));
        }
        drive.join().unwrap()
    });
    let state = server.when("at rest", is_at_rest);
    assert_ne!(state["run"]["report"]["reached"], true, "{}", state["run"]);
}

#[test]
fn a_dark_camera_is_said_before_and_after_somebody_wants_to_drive() {
    let server = Server::start_at("1");
    plan(&server);
    server.done("camera", &json!({"source": "sim"}));
    server.done("faults", &json!({"camera": "dark"}));
    let is_dark = |state: &Value| {
        state["camera"]["problem"].as_str().is_some_and(|words| words.contains("black"))
    };
    server.when("dark", is_dark);
    let (status, document) = server.post("drive", &json!({}));
    assert_eq!((status, &document["error"]["code"]), (422, &json!("photo")), "{document}");
    server.done("faults", &json!({}));
    server.when("light", |state| state["camera"]["problem"].is_null());
}

#[test]
fn a_folder_is_a_camera_whose_picture_can_be_the_photo() {
    let folder = tempfile::tempdir().unwrap();
    let photo = concat!(env!("CARGO_MANIFEST_DIR"), "/assets/demo.png");
    std::fs::copy(photo, folder.path().join("0001.png")).unwrap();
    let source = folder.path().to_str().unwrap();
    let server =
        Server::start_with(&["serve", "--addr", "127.0.0.1:0", "--no-open", "--watch", source]);
    let state = server.when("a frame", |state| state["camera"]["frame"].is_u64());
    assert_eq!(state["camera"]["sources"], json!([source, "sim"]));
    assert_eq!(frame(&server, &server.token).1, std::fs::read(photo).unwrap());
    server.done("photo", &json!({"sample": "camera"}));
    assert_eq!(server.state()["photo"]["type"], "image/png");
}

#[test]
fn a_page_has_no_other_camera_opened_and_nothing_set_down_on_a_real_floor() {
    let server = Server::start();
    for source in ["/etc", "http://127.0.0.1:1/", "", "sim "] {
        let (status, document) = server.post("camera", &json!({"source": source}));
        assert_eq!(status, 400, "{source}: {document}");
    }
    assert_eq!(server.post("camera", &json!({"watch": "sim"})).0, 400);
    assert_eq!(server.post("things", &json!({"at": [0.5, 0.5]})).0, 409, "there is no floor");
    plan(&server);
    server.done("camera", &json!({"source": "sim"}));
    assert_eq!(server.post("things", &json!({"at": [0.5, 0.5], "size": [9, 1]})).0, 400);
    let set_down = (0..40).map(|_| server.post("things", &json!({"at": [0.9, 0.2]})).0);
    assert_eq!(set_down.filter(|status| *status == 200).count(), 32, "a floor has an end");
}

#[test]
fn what_is_no_camera_ends_the_program_in_words() {
    for (arguments, words) in [
        (&["--watch", "nowhere"][..], "nowhere is no source of frames"),
        (&["--watch", "sim", "--port", "tcp://127.0.0.1:1"], "sees a simulated robot alone"),
    ] {
        let begin = ["serve", "--addr", "127.0.0.1:0", "--no-open"];
        let mut process = server::program(&[&begin[..], arguments].concat());
        let mut text = String::new();
        process.stderr.take().unwrap().read_to_string(&mut text).unwrap();
        assert!(text.contains(words), "{text}");
        assert_eq!(process.wait().unwrap().code(), Some(2));
    }
}
