//! `wmr drive --watch`, as a user runs it.
#![allow(clippy::unwrap_used, reason = "helpers of tests fail as tests do")]

mod program;

use program::{
    PAPER, PHOTO, PHOTO_ARENA, PHOTO_GOAL, assert_arrived, assert_refused, document, number,
    succeed, wmr,
};

/// A box is set down in the way of the paper's robot; tags say best where it is.
#[test]
fn a_simulated_robot_drives_round_what_is_set_down() {
    let run = succeed(&[
        "drive",
        PAPER,
        "--port",
        "sim",
        "--watch",
        "sim",
        "--robot-tag",
        "7",
        "--sim-fault",
        "shape,rect=[0.65,0.9,0.8,1.1],at=2",
        "--json",
    ]);
    assert_arrived(&run);
    let watch = &run["watch"];
    assert!(number(&watch["replans"]) >= 1.0, "{run}");
    assert!(number(&watch["used"]) > 50.0 && number(&watch["corrections"]) >= 1.0, "{run}");
}

/// The plan of three legs takes 27 s; within the limits of a usual robot the way would take 11.
#[test]
fn a_plan_keeps_its_timing_under_a_camera() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("plan.json");
    let path = path.to_str().unwrap();
    let plan = succeed(&["plan", PAPER, "--timing", "paper", "-o", path, "--json"]);
    assert_eq!(number(&plan["duration"]), 27.0);
    let watched = ["drive", path, "--port", "sim", "--watch", "sim", "--robot-tag", "7", "--json"];
    let run = succeed(&watched);
    assert_arrived(&run);
    assert!(number(&run["duration"]) >= number(&plan["duration"]), "{run}");
}

/// A folder in which one picture stays is a camera that has died: the robot stops, and the error says why.
#[test]
fn a_camera_that_sends_nothing_more_stops_the_robot() {
    let folder = tempfile::tempdir().unwrap();
    std::fs::copy(PHOTO, folder.path().join("0001.png")).unwrap();
    let output = wmr(&[
        "drive",
        "--watch",
        folder.path().to_str().unwrap(),
        "--watch-patience",
        "1",
        "--arena",
        PHOTO_ARENA,
        "--goal",
        PHOTO_GOAL,
        "--port",
        "sim",
        "--json",
    ]);
    assert_eq!(output.status.code(), Some(7), "{output:?}");
    let error = &document(&output)["error"];
    assert_eq!(error["code"], "watch.waited", "{error}");
    assert!(error["message"].as_str().unwrap().contains("stopped after waiting"), "{error}");
}

#[test]
fn what_cannot_be_watched_is_refused() {
    let refused = |arguments: &[&str]| {
        assert_refused(2, "usage", &[&["drive", PAPER, "--watch"], arguments].concat());
    };
    refused(&["sim", "--port", "tcp://127.0.0.1:1"]);
    for source in ["nowhere", "https://camera/", "/dev/video0", "http://"] {
        assert_refused(2, "watch.source", &["drive", PAPER, "--port", "sim", "--watch", source]);
    }
}
