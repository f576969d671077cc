//! `wmr drive` and what it tells: arrivals, misses, margins, logs.
#![allow(clippy::unwrap_used, clippy::panic, reason = "helpers of tests fail as tests do")]

mod program;

use program::{
    END_POSITION, ENDS, PAPER, assert_arrived, assert_refused, document, floor, number, numbers,
    succeed, wmr, write,
};

#[test]
fn the_papers_experiment_takes_27_seconds() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("plan.json");
    let plan =
        succeed(&["plan", PAPER, "--planner", "grid", "--json", "-o", path.to_str().unwrap()]);
    let matrix = plan["mini_matrix"].as_array().unwrap();
    assert_eq!((matrix.len(), matrix[0].as_array().unwrap().len()), (7, 5));
    let twos =
        matrix.iter().flat_map(|row| row.as_array().unwrap()).filter(|element| **element == 2);
    assert_eq!(twos.count(), 2);
    assert_eq!((&plan["areas"]["start"], &plan["areas"]["goal"]), (&48.into(), &13.into()));
    assert_eq!(plan["areas"]["traps"], serde_json::json!([20, 41]));
    // The exact length by the corners (0.875, 0.475) and (0.875, 1.525).
    assert!((number(&plan["length"]) - 2.160859).abs() < 1e-6);

    let plan = path.to_str().unwrap();
    let run = succeed(&[
        "drive",
        plan,
        "--port",
        "sim",
        "--timing",
        "paper",
        "--leg-time",
        "9",
        "--json",
    ]);
    assert_arrived(&run);
    assert_eq!(number(&run["duration"]), 27.0);
    assert_eq!(run["legs"].as_array().unwrap().len(), 3);
}

#[test]
fn a_goal_missed_is_one_document_and_exit_code_7() {
    let folder = tempfile::tempdir().unwrap();
    // 180 m of dead reckoning end centimetres off.
    let far = r#"{"format":"wmr-scene/1","arena":{"width":99,"height":99},"obstacles":[[40,0,41,90]],"start":[1,1,0],"goal":[97,1]}"#;
    let far = write(&folder, "far.json", far);
    let output = wmr(&["drive", &far, "--port", "sim", "--json"]);
    assert_eq!(output.status.code(), Some(7), "{output:?}");
    assert_eq!(document(&output)["reached"], false);
    assert!(String::from_utf8_lossy(&output.stderr).contains("robot.missed"), "{output:?}");
}

/// What `wmr drive PLAN OPTIONS --port sim --json` prints, and says beside it.
fn driven(plan: &str, options: &[&str]) -> (serde_json::Value, String) {
    let output = wmr(&[&["drive", plan, "--port", "sim", "--json"], options].concat());
    (document(&output), String::from_utf8_lossy(&output.stderr).into_owned())
}

#[test]
fn a_plan_is_driven_as_it_was_made_and_other_legs_are_said() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("plan.json");
    let path = path.to_str().unwrap();
    let plan =
        succeed(&["plan", PAPER, "--timing", "paper", "--leg-time", "12", "-o", path, "--json"]);
    assert_eq!(number(&plan["made_for"]["leg_time"]), 12.0);
    let (run, said) = driven(path, &["--margin", "0"]);
    assert_eq!(number(&run["duration"]), number(&plan["duration"]));
    assert!(!said.contains("again"), "{said}");
    // Another way along the same plan keeps its timing.
    let (run, said) = driven(path, &[]);
    assert_arrived(&run);
    assert_eq!(number(&run["duration"]), number(&plan["duration"]));
    assert!(said.contains("its way is planned again") && !said.contains("made again"), "{said}");

    let (run, said) = driven(path, &["--margin", "0", "--timing", "limits"]);
    assert!(number(&run["duration"]) < number(&plan["duration"]));
    assert!(said.contains("12 s a leg; for 0.4 m/s") && said.contains("made again"), "{said}");
}

#[test]
fn a_plan_is_not_driven_to_another_goal_than_asked_for() {
    let folder = tempfile::tempdir().unwrap();
    let scene = write(&folder, "scene.json", &floor(ENDS));
    let plan = folder.path().join("plan.json");
    let plan = plan.to_str().unwrap();
    succeed(&["plan", &scene, "-o", plan, "--json"]);
    let run = succeed(&["drive", plan, "--goal", "1,0.5", "--port", "sim", "--json"]);
    assert_arrived(&run);
    assert!((numbers(&run["true_pose"])[0] - 1.0).abs() < END_POSITION, "{run}");
    let again = succeed(&["plan", plan, "--start", "0.7,0.4", "--radius", "20cm", "--json"]);
    assert_eq!(numbers(&again["waypoints"][0]), [0.7, 0.4]);
    assert_eq!(number(&again["scene"]["robot_radius"]), 0.2);
}

#[test]
fn a_floor_too_narrow_for_the_margin_is_driven_without_it() {
    let folder = tempfile::tempdir().unwrap();
    let scene = write(&folder, "scene.json", &floor(ENDS));
    succeed(&["drive", &scene, "--radius", "0.496", "--port", "sim", "--json"]);
    assert_refused(3, "plan.bad_arena", &["drive", &scene, "--radius", "0.51", "--port", "sim"]);
}

#[test]
fn the_plan_is_in_the_log_before_the_robot_is_looked_for() {
    let folder = tempfile::tempdir().unwrap();
    let scene = write(&folder, "scene.json", &floor(ENDS));
    let log = folder.path().join("log");
    let to = ["--log", log.to_str().unwrap()];
    assert_refused(
        5,
        "port.missing",
        &[&["drive", &scene, "--port", "tcp://127.0.0.1:1"], &to[..]].concat(),
    );
    assert!(log.join("plan.json").is_file());
    // No folder, no drive: the port is not even tried.
    let to = ["--log", &scene];
    assert_refused(
        3,
        "file.write",
        &[&["drive", &scene, "--port", "tcp://127.0.0.1:1"], &to[..]].concat(),
    );
}

#[test]
fn a_leg_too_short_to_drive_leaves_its_length_as_the_error() {
    let folder = tempfile::tempdir().unwrap();
    let ends = r#""start":[0.3,0.5,0],"goal":[0.301,0.5]"#;
    let scene = write(&folder, "scene.json", &floor(ends));
    let run = succeed(&["drive", &scene, "--port", "sim", "--json"]);
    let moved = numbers(&run["true_pose"])[0] - 0.3;
    assert!((number(&run["error"]["position"]) - (0.001 - moved).abs()).abs() < 1e-6, "{run}");
}

#[test]
fn a_heading_of_many_turns_is_a_heading() {
    let folder = tempfile::tempdir().unwrap();
    let ends = r#""start":[0.3,0.5,1e300],"goal":[1.4,0.5,-1e300]"#;
    let scene = write(&folder, "scene.json", &floor(ends));
    let plan = succeed(&["plan", &scene, "--json"]);
    assert!(number(&plan["legs"][0]["start"][2]).abs() <= std::f64::consts::PI + 1e-6, "{plan}");
    assert!(number(&plan["legs"][0]["goal"][2]).abs() <= std::f64::consts::PI + 1e-6, "{plan}");
}

#[test]
fn a_robot_led_away_from_a_box_keeps_its_margin_from_there() {
    let folder = tempfile::tempdir().unwrap();
    let near = floor(r#""start":[0.3,0.5,0],"goal":[1.7,0.5]"#);
    let near = near.replace(r#""obstacles":[]"#, r#""obstacles":[[0.36,0.4,0.5,0.6]]"#);
    let run = succeed(&["drive", &write(&folder, "near.json", &near), "--port", "sim", "--json"]);
    // It stands 15 mm too near, and touches nothing else on its way.
    assert_eq!(run["collisions"], 1, "{run}");
}

#[test]
fn a_drive_is_told_whatever_becomes_of_its_log() {
    let folder = tempfile::tempdir().unwrap();
    // Nothing can be written where a folder stands.
    std::fs::create_dir_all(folder.path().join("run.jsonl")).unwrap();
    let log = folder.path().to_str().unwrap();
    let output = wmr(&["drive", PAPER, "--port", "sim", "--json", "--log", log]);
    assert_eq!(output.status.code(), Some(3), "{output:?}");
    let run = document(&output);
    assert_eq!(run["reached"], true, "{run}");
    let told = String::from_utf8_lossy(&output.stderr);
    assert!(told.contains("error[file.write]") && told.contains("run.jsonl"), "{told}");
}

/// A plan is driven from where the robot is said to stand; what that misses shows only in the truth.
#[test]
fn a_robot_beside_its_start_misses_its_goal_by_as_much() {
    let output = wmr(&["drive", PAPER, "--port", "sim", "--json", "--sim-start-error", "20mm,0"]);
    assert_eq!(output.status.code(), Some(7), "{output:?}");
    let run = document(&output);
    assert_eq!(run["reached"], false);
    let missed = number(&run["error"]["position"]);
    assert!((0.015..0.025).contains(&missed), "{run}");
}
