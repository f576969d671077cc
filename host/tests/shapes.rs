//! Scenes with shapes through the whole program: planned, driven against true shapes, exported, refused.
#![allow(clippy::unwrap_used, clippy::panic, reason = "helpers of tests fail as tests do")]

use serde_json::Value;
use std::process::{Command, Output};

const SCENE: &str = r#"{"format": "wmr-scene/2", "arena": {"width": 1.6, "height": 1.2}, "robot_radius": 0.075,
 "obstacles": [[0.9, 0, 1.0, 0.25],
               {"polygon": [[0.5, 0.3], [0.9, 0.5], [0.6, 0.8]], "height": 0.1},
               {"circle": [1.15, 0.75, 0.12]}],
 "margins": [[0.001, 0.002, 0.003, 0.004], 0.004, 0.004],
 "start": [0.2, 0.3, 0], "goal": [1.4, 0.9]}"#;

/// The robot's radius and the margin of triangle and disc.
const KEPT: f64 = 0.079;

fn wmr(scene: &str, arguments: &[&str]) -> (Output, Value) {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("scene.json");
    std::fs::write(&file, scene).unwrap();
    let mut command = Command::new(env!("CARGO_BIN_EXE_wmr"));
    let output = command
        .args([arguments[0], file.to_str().unwrap()])
        .args(&arguments[1..])
        .arg("--json")
        .env("XDG_STATE_HOME", folder.path())
        .env_remove("WMR_PORT")
        .output()
        .unwrap();
    let text = String::from_utf8(output.stdout.clone()).unwrap();
    let document = serde_json::from_str(&text).unwrap_or_else(|error| panic!("{error}: {text}"));
    (output, document)
}

#[test]
fn a_way_among_shapes_is_planned_kept_and_driven() {
    let (_, plan) = wmr(SCENE, &["plan"]);
    assert_eq!(plan["inflation"], "disc");
    let clearance = plan["clearance"].as_f64().unwrap();
    assert!((KEPT - 1e-9..KEPT + 0.0005).contains(&clearance), "{clearance}");
    let scene: Value = serde_json::from_str(SCENE).unwrap();
    assert_eq!(plan["scene"]["margins"], scene["margins"]);
    assert_eq!(plan["scene"]["obstacles"][1], scene["obstacles"][1]);
    // The plan file drives as well as the scene, and nothing is touched on the way.
    for input in [SCENE, &plan.to_string()] {
        let (output, run) = wmr(input, &["drive", "--port", "sim"]);
        assert!(output.status.success(), "{output:?}");
        assert_eq!((&run["reached"], &run["collisions"]), (&true.into(), &0.into()));
    }
}

#[test]
fn the_fuzzy_planner_weighs_margins_and_draws_its_grid() {
    let steps = tempfile::tempdir().unwrap();
    let folder = steps.path().to_str().unwrap();
    let (_, plan) = wmr(
        SCENE,
        &["plan", "--planner", "fuzzy", "--risk", "20", "--area", "5mm", "--steps", folder],
    );
    assert_eq!((&plan["planner"], &plan["inflation"]), (&"fuzzy".into(), &"disc".into()));
    assert_eq!(
        (&plan["fuzzy"]["risk_weight"], &plan["fuzzy"]["area"]),
        (&20.0.into(), &0.005.into())
    );
    assert!(plan["clearance"].as_f64().unwrap() >= 0.075 - 1e-9, "{plan}");
    let picture = std::fs::read_to_string(steps.path().join("13_membership.svg")).unwrap();
    assert!(picture.contains("320 × 240 areas of 5.0 mm"));
    let (output, run) = wmr(SCENE, &["drive", "--port", "sim", "--planner", "fuzzy"]);
    assert!(output.status.success(), "{output:?}");
    assert_eq!((&run["reached"], &run["collisions"]), (&true.into(), &0.into()));
    let (output, error) = wmr(SCENE, &["plan", "--planner", "fuzzy", "--inflation", "square"]);
    assert_eq!(
        (output.status.code(), &error["error"]["code"]),
        (Some(2), &"plan.fuzzy_alone".into())
    );
}

#[test]
fn the_paper_s_planners_and_squares_go_round_shapes_too() {
    for arguments in [["plan", "--planner", "grid"], ["plan", "--inflation", "square"]] {
        let (_, plan) = wmr(SCENE, &arguments);
        assert_eq!(plan["inflation"], "square");
        assert!(plan["clearance"].as_f64().unwrap() >= KEPT - 1e-9, "{plan}");
    }
}

#[test]
fn a_plan_whose_scene_got_a_disc_beside_its_way_is_not_driven() {
    let empty = SCENE.split("\"obstacles\"").next().unwrap().to_owned()
        + r#""obstacles": [], "start": [0.2, 0.6, 0], "goal": [1.4, 0.6]}"#;
    let (_, mut plan) = wmr(&empty, &["plan"]);
    plan["scene"]["obstacles"] = serde_json::json!([{"circle": [0.8, 0.75, 0.1]}]);
    let (output, refused) = wmr(&plan.to_string(), &["drive", "--port", "sim", "--margin", "0"]);
    assert_eq!(output.status.code(), Some(4), "{refused}");
    assert!(refused["error"]["message"].as_str().unwrap().contains("0.0500 m"), "{refused}");
}

#[test]
fn shapes_that_are_none_are_refused_with_their_number() {
    let bow_tie = SCENE.replace("[0.6, 0.8]]", "[0.6, 0.8], [0.8, 0.3]]");
    let (output, refused) = wmr(&bow_tie, &["plan"]);
    assert_eq!(output.status.code(), Some(3));
    let message = refused["error"]["message"].as_str().unwrap();
    assert!(message.contains("obstacle 2: its outline crosses"), "{message}");
}

#[test]
fn a_gap_between_shapes_is_named() {
    let discs = r#""obstacles": [{"circle": [0.8, 0.3, 0.25]}, {"circle": [0.8, 0.95, 0.25]}],
        "start": [0.2, 0.6, 0], "goal": [1.4, 0.6]}"#;
    let scene = SCENE.split("\"obstacles\"").next().unwrap().to_owned() + discs;
    let (output, refused) = wmr(&scene, &["plan", "--radius", "0.08"]);
    assert_eq!(output.status.code(), Some(4), "{refused}");
    let message = refused["error"]["message"].as_str().unwrap();
    assert!(message.contains("a gap of 15.0 cm between obstacle 1 and obstacle 2"), "{message}");
}
