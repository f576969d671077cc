//! `wmr params` and `wmr calibrate base`, on the simulated robot.
#![allow(clippy::unwrap_used, clippy::panic, reason = "helpers of tests fail as tests do")]

use serde_json::Value;
use std::process::{Command, Output};

fn wmr(arguments: &[&str]) -> Output {
    let mut command = Command::new(env!("CARGO_BIN_EXE_wmr"));
    command.args(arguments).args(["--port", "sim", "--json"]).output().unwrap()
}

fn document(output: &Output) -> Value {
    serde_json::from_slice(&output.stdout).unwrap_or_else(|error| panic!("{error}: {output:?}"))
}

fn number(value: &Value) -> f64 {
    value.as_f64().unwrap_or_else(|| panic!("{value} is no number"))
}

#[test]
fn numbers_are_changed_and_brought_back_from_a_file() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("robot.json");
    let changed = wmr(&["params", "track=121mm", "speed=0.3"]);
    let numbers = document(&changed);
    assert_eq!(numbers["saved"], true);
    assert_eq!(number(&numbers["parameters"]["track"]), 0.121);
    std::fs::write(&file, changed.stdout).unwrap();

    // The next simulated robot is a new one.
    assert_eq!(number(&document(&wmr(&["params"]))["parameters"]["speed"]), 0.4);
    let restored = document(&wmr(&["params", "--from", file.to_str().unwrap(), "speed=0.35"]));
    assert_eq!(number(&restored["parameters"]["track"]), 0.121);
    assert_eq!(number(&restored["parameters"]["speed"]), 0.35);
}

#[test]
fn numbers_that_make_no_sense_are_refused() {
    for (arguments, exit, code) in [
        (vec!["params", "tracks=1"], 2, "usage"),
        (vec!["params", "track=wide"], 2, "usage"),
        (vec!["params", "track=0"], 7, "robot.refused"),
        (vec!["params", "speed=0.9"], 7, "robot.refused"),
        (vec!["params", "track=NaN"], 2, "usage"),
        (vec!["params", "heading-gain=NaN"], 7, "robot.refused"),
        (vec!["params", "--from", "/nowhere/robot.json"], 3, "params.file"),
        (vec!["calibrate", "base", "--side", "0"], 2, "usage"),
        (vec!["calibrate", "base", "--sim-errors", "1,2"], 2, "usage"),
    ] {
        let output = wmr(&arguments);
        assert_eq!(output.status.code(), Some(exit), "{arguments:?} {output:?}");
        let error = &document(&output)["error"];
        assert_eq!(error["code"], code, "{arguments:?}");
        assert!(!error["help"].as_str().unwrap().is_empty(), "{arguments:?}");
    }
}

/// A promise to users: each length to a tenth of a percent.
const LENGTH_TOLERANCE: f64 = 0.001;

#[test]
fn calibration_finds_what_is_wrong_with_the_base() {
    let found = document(&wmr(&["calibrate", "base", "--side", "4", "--sim-errors", "1,0.5,-2"]));
    let after = &found["after"];
    // The defaults of the firmware, and what the base really is.
    for (name, truth) in
        [("wheel_radius", 0.035 * 1.01), ("wheel_ratio", 1.005), ("track", 0.12 * 0.98)]
    {
        assert!((number(&after[name]) / truth - 1.0).abs() < LENGTH_TOLERANCE, "{name} {found}");
    }
    let falls = number(&found["before"]["return_error"]) / number(&after["return_error"]);
    assert!(falls >= 15.0, "{found}");
    assert_eq!(found["calibration"], 1);
}
