//! ROS maps as a user has them: coordinates in the map's frame, YAML in any spelling, pictures that moved.
#![allow(clippy::unwrap_used, clippy::panic, reason = "helpers of tests fail as tests do")]

use serde_json::Value;
use std::fmt::Write;
use std::path::Path;
use std::process::{Command, Output};

/// Lengths are right to this, metres.
const TOLERANCE: f64 = 1e-9;

/// 2 × 1 m in cells of 0.1 m with a wall of two columns that leaves the upper half free.
fn map(folder: &Path, yaml: &str) {
    let mut picture = "P2\n20 10\n255\n".to_owned();
    for row in 0..10 {
        for column in 0..20 {
            let wall = (9..11).contains(&column) && row >= 5;
            let _ = write!(picture, "{} ", if wall { 0 } else { 254 });
        }
    }
    std::fs::write(folder.join("floor.pgm"), picture).unwrap();
    std::fs::write(folder.join("map.yaml"), yaml).unwrap();
}

fn plan(folder: &Path, start: &str, goal: &str) -> Output {
    let mut wmr = Command::new(env!("CARGO_BIN_EXE_wmr"));
    let file = folder.join("map.yaml");
    let (start, goal) = (format!("--start={start}"), format!("--goal={goal}"));
    wmr.arg("plan").arg(file).args([&start, &goal, "--radius", "0.05", "--json"]).output().unwrap()
}

fn document(output: &Output) -> Value {
    serde_json::from_slice(&output.stdout).unwrap_or_else(|error| panic!("{error}: {output:?}"))
}

const REST: &str = "resolution: 0.1\nnegate: 0\noccupied_thresh: 0.65\nfree_thresh: 0.196\n";

/// From (0.3, 0.3) around both upper corners of the wall, which grow by the radius to (0.85, 0.55) and
/// (1.15, 0.55), to (1.7, 0.3).
fn around_the_wall() -> f64 {
    2.0 * 0.55_f64.hypot(0.25) + 0.3
}

#[test]
fn points_and_waypoints_are_in_the_maps_frame() {
    let folder = tempfile::tempdir().unwrap();
    map(folder.path(), &format!("image: floor.pgm\norigin: [-1.0, -0.5, 0.0]\n{REST}"));
    let output = plan(folder.path(), "-0.7,-0.2", "0.7,-0.2");
    let found = document(&output);
    assert!((found["length"].as_f64().unwrap() - around_the_wall()).abs() < TOLERANCE, "{found}");
    let expected = [[-0.7, -0.2], [-0.15, 0.05], [0.15, 0.05], [0.7, -0.2]];
    for (point, [x, y]) in found["waypoints"].as_array().unwrap().iter().zip(expected) {
        let apart = (point[0].as_f64().unwrap() - x).hypot(point[1].as_f64().unwrap() - y);
        assert!(apart < TOLERANCE, "{found}");
    }
    // In the frame of the picture's corner these would be free points.
    let refused = plan(folder.path(), "0.3,0.3", "1.7,0.3");
    assert_eq!(refused.status.code(), Some(4), "{refused:?}");
    assert!(document(&refused)["error"]["message"].as_str().unwrap().contains("1.7"));
}

#[test]
fn yaml_in_the_style_of_json_is_read_as_yaml() {
    for yaml in [
        "{image: floor.pgm, resolution: 0.1, origin: [0, 0, 0], negate: 0, occupied_thresh: 0.65, free_thresh: 0.196}",
        r#"{"image": "floor.pgm", "resolution": 0.1, "origin": [0, 0, 0], "negate": 0, "occupied_thresh": 0.65, "free_thresh": 0.196}"#,
    ] {
        let folder = tempfile::tempdir().unwrap();
        map(folder.path(), yaml);
        let found = document(&plan(folder.path(), "0.3,0.3", "1.7,0.3"));
        assert!(
            (found["length"].as_f64().unwrap() - around_the_wall()).abs() < TOLERANCE,
            "{found}"
        );
    }
}

#[test]
fn a_picture_beside_the_yaml_stands_in_for_one_elsewhere_and_is_said() {
    for image in
        ["/nowhere/maps/floor.pgm", "~/floor.pgm", "maps/floor.pgm", "file:///nowhere/floor.pgm"]
    {
        let folder = tempfile::tempdir().unwrap();
        map(folder.path(), &format!("image: {image}\norigin: [0.0, 0.0, 0.0]\n{REST}"));
        let output = plan(folder.path(), "0.3,0.3", "1.7,0.3");
        let found = document(&output);
        assert!(
            (found["length"].as_f64().unwrap() - around_the_wall()).abs() < TOLERANCE,
            "{found}"
        );
        let said = String::from_utf8(output.stderr).unwrap();
        assert!(said.contains("floor.pgm is taken"), "{image}: {said}");
    }
}
