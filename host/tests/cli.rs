//! The command line's contract: JSON documents, exit codes, errors that help, files that appear.
#![allow(clippy::unwrap_used, clippy::panic, reason = "helpers of tests fail as tests do")]

mod program;

use program::{
    ENDS, PAPER, PAPER_PHOTO, PHOTO, PHOTO_ARENA, PHOTO_GOAL, assert_arrived, assert_refused,
    assert_valid, document, floor, number, numbers, read_json, succeed, wmr, write,
};
use serde_json::Value;
use std::process::{Command, Stdio};

#[test]
fn the_demo_reaches_its_goal_and_leaves_pictures() {
    let folder = tempfile::tempdir().unwrap();
    let out = folder.path().to_str().unwrap();
    let run = succeed(&["demo", "--out", out, "--json"]);
    assert_arrived(&run);
    assert!(run["legs"].as_array().unwrap().len() >= 3);
    let scene: Value = read_json(&folder.path().join("scene.json"));
    assert!(scene["obstacles"].as_array().unwrap().len() >= 5);
    for name in
        ["1_plan_view.png", "7_obstacles.svg", "11_mini_matrix.svg", "14_path.svg", "15_motion.svg"]
    {
        assert!(folder.path().join(name).metadata().unwrap().len() > 100, "{name}");
    }
    for file in std::fs::read_dir(folder.path()).unwrap() {
        let name = file.unwrap().file_name().into_string().unwrap();
        let is_picture = name.ends_with(".png") || name.ends_with(".svg");
        assert!(!is_picture || wmr::picture::index::caption(&name).is_some(), "{name}");
    }
    let log = std::fs::read_to_string(folder.path().join("run.jsonl")).unwrap();
    let lines: Vec<Value> = log.lines().map(|line| serde_json::from_str(line).unwrap()).collect();
    lines.iter().for_each(|line| assert_valid("run-line", line));
    let times: Vec<f64> = lines.iter().map(|line| number(&line["t"])).collect();
    assert!(times.len() > 100 && times.is_sorted());
}

#[test]
fn the_papers_experiment_is_found_in_a_picture_of_it() {
    let drawn = wmr::picture::overhead::overhead_png(&paper_scene(), 250.0).unwrap();
    assert!(
        std::fs::read(PAPER_PHOTO).unwrap() == drawn,
        "draw it again: host/examples/paper_picture.rs"
    );
    let photo = [PAPER_PHOTO, "--arena", "1.6x2.0", "--goal", "1.4,1.75"];
    let plan = succeed(&[&["plan"], &photo[..], &["--planner", "grid", "--json"]].concat());
    assert_eq!((&plan["areas"]["start"], &plan["areas"]["goal"]), (&48.into(), &13.into()));
    assert_eq!(plan["areas"]["traps"], serde_json::json!([20, 41]));
    let run = succeed(
        &[&["drive"], &photo[..], &["--port", "sim", "--timing", "paper", "--json"]].concat(),
    );
    assert_arrived(&run);
    assert_eq!(number(&run["duration"]), 27.0);
}

fn paper_scene() -> wmr::scene::Scene {
    wmr::scene::Scene::from_json(&std::fs::read_to_string(PAPER).unwrap()).unwrap()
}

#[test]
fn detect_prints_a_scene_with_margins_corners_and_robot() {
    let seen = succeed(&["detect", PHOTO, "--arena", PHOTO_ARENA, "--json"]);
    assert_eq!(seen["format"], "wmr-scene/2");
    let obstacles = seen["obstacles"].as_array().unwrap();
    assert_eq!(obstacles.len(), 8);
    assert_eq!(seen["margins"].as_array().unwrap().len(), 8);
    assert!(obstacles.iter().all(|rect| numbers(rect).len() == 4));
    assert_eq!(seen["corners_px"].as_array().unwrap().len(), 4);
    let robot = numbers(&seen["robot"]);
    // The picture's truth, to 3 mm and 3.5°: a triangle of 15 by 30 pixels tells no more.
    assert!((robot[0] - 0.163).hypot(robot[1] - 0.696) < 0.003 && (robot[2] - 1.521).abs() < 0.06);
    assert!((0.0..=1.0).contains(&number(&seen["confidence"])));
    assert!(seen["warnings"].is_array());
    assert!(
        number(&seen["timing_ms"]["decode"]) >= 0.0 && number(&seen["timing_ms"]["detect"]) > 0.0
    );
}

#[test]
fn a_plan_from_a_photo_is_a_plan_file_that_drives() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("plan.json");
    let file = file.to_str().unwrap();
    let photo = [PHOTO, "--arena", PHOTO_ARENA, "--goal", PHOTO_GOAL];
    let plan = succeed(&[&["plan"], &photo[..], &["-o", file, "--json"]].concat());
    assert_eq!(plan["format"], "wmr-plan/1");
    assert!(number(&plan["clearance"]) >= 0.0749);
    assert!(number(&plan["duration"]) > 0.0 && number(&plan["timing_us"]["query"]) > 0.0);
    for leg in plan["legs"].as_array().unwrap() {
        assert_eq!(numbers(&leg["start"]).len(), 3);
        assert_eq!(leg["goal"].as_array().unwrap().len(), 3);
        assert!(leg["direction"] == "forward" || leg["direction"] == "reverse");
    }
    let waypoints = plan["waypoints"].as_array().unwrap();
    assert_eq!(numbers(waypoints.last().unwrap()), [0.996, 0.229]);
    assert_eq!(plan["scene"]["format"], "wmr-scene/2");
    assert_arrived(&succeed(&["drive", file, "--port", "sim", "--json"]));
}

#[test]
fn broken_input_is_refused_with_the_contracts_exit_code() {
    let folder = tempfile::tempdir().unwrap();
    let write = |name: &str, text: &str| {
        let path = folder.path().join(name);
        std::fs::write(&path, text).unwrap();
        path.to_str().unwrap().to_owned()
    };
    let text = write("photo.png", "this is no picture");
    let empty = write("empty.png", "");
    let walled = write(
        "walled.json",
        r#"{"format":"wmr-scene/1","arena":{"width":2,"height":1},"obstacles":[[0.9,0,1.1,1]],"start":[0.3,0.5,0],"goal":[1.7,0.5]}"#,
    );
    let inside_out = write(
        "inside.json",
        r#"{"format":"wmr-scene/1","arena":{"width":2,"height":1},"obstacles":[[1,0,0.5,1]]}"#,
    );
    let goalless = write(
        "goalless.json",
        r#"{"format":"wmr-scene/1","arena":{"width":2,"height":1},"obstacles":[],"start":[0.3,0.5,0]}"#,
    );
    assert_refused(3, "photo", &["plan", &text, "--arena", "2x1", "--goal", "1,0.5"]);
    assert_refused(3, "photo", &["detect", &text, "--arena", "2x1"]);
    assert_refused(3, "file.empty", &["detect", &empty, "--arena", "2x1"]);
    assert_refused(3, "file.empty", &["drive", &empty, "--port", "sim"]);
    assert_refused(3, "file.read", &["plan", "no-such-file.json"]);
    assert_refused(3, "scene", &["plan", &inside_out, "--start", "1,1", "--goal", "1,1"]);
    assert_refused(4, "plan.start_blocked", &["plan", PAPER, "--start", "1.0,1.0"]);
    assert_refused(4, "plan.goal_blocked", &["drive", PAPER, "--goal", "1.0,1.0", "--port", "sim"]);
    assert_refused(4, "plan.goal_outside", &["plan", PAPER, "--goal", "140,175"]);
    assert_refused(4, "plan.no_path", &["plan", &walled]);
    assert_refused(4, "plan.no_path", &["drive", &walled, "--port", "sim"]);
    assert_refused(2, "plan.no_goal", &["plan", &goalless]);
    assert_refused(2, "usage", &["plan", PAPER, "--goal", "NaN,1"]);
    assert_refused(2, "usage", &["plan", PHOTO, "--goal", "1,1"]);
    assert_refused(2, "usage", &["fly"]);
    assert_refused(2, "usage", &["sim", "--pty", "never", "--fault", "camera-dark"]);
    let incomplete = document(&wmr(&["sim", "--json"]));
    assert!(incomplete["error"]["message"].as_str().unwrap().contains("--pty"), "{incomplete}");
    assert_refused(5, "port.missing", &["drive", PAPER, "--port", "/dev/no-such-port"]);
    assert_refused(5, "port.missing", &["drive", PAPER, "--port", "tcp://127.0.0.1:1"]);
    assert_refused(
        7,
        "robot.refused",
        &["drive", PAPER, "--port", "sim", "--timing", "paper", "--leg-time", "2"],
    );
}

#[test]
fn a_plan_that_does_not_belong_to_its_arena_moves_nothing() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("plan.json");
    let mut plan = succeed(&["plan", PAPER, "--json"]);
    let refuse = |plan: &Value, exit: i32| {
        std::fs::write(&path, plan.to_string()).unwrap();
        assert_refused(exit, "plan.file", &["drive", path.to_str().unwrap(), "--port", "sim"]);
    };
    let whole = plan.clone();
    plan["scene"]["obstacles"] = serde_json::json!([[0.8, 0.9, 1.0, 1.1]]);
    refuse(&plan, 4);
    plan = whole.clone();
    plan["legs"].as_array_mut().unwrap().pop();
    refuse(&plan, 3);
    plan = whole;
    plan["waypoints"][1][0] = serde_json::json!(0.7);
    refuse(&plan, 3);
}

#[test]
fn an_arena_exported_for_ros_has_the_same_shortest_way() {
    let folder = tempfile::tempdir().unwrap();
    let yaml = folder.path().join("paper.yaml");
    let map = folder.path().join("paper.map");
    let [yaml, map] = [&yaml, &map].map(|path| path.to_str().unwrap());
    // The paper's boxes are whole cells of 25 mm.
    let export = succeed(&["export", PAPER, "-o", yaml, "--resolution", "25mm", "--json"]);
    assert_eq!((number(&export["columns"]), number(&export["rows"])), (64.0, 80.0));
    assert!(folder.path().join("paper.pgm").exists());
    let ends = ["--radius", "0.075", "--start", "1.4,0.35", "--goal", "1.4,1.75", "--json"];
    let there = succeed(&[&["plan", yaml], &ends[..]].concat());
    assert!((number(&there["length"]) - 2.160_859).abs() < 1e-6, "{there}");
    // And from one format to the other.
    succeed(&["export", yaml, "-o", map, "--json"]);
    let cells = [&["plan", map, "--resolution", "0.025"], &ends[..]].concat();
    assert_eq!(succeed(&cells)["waypoints"], there["waypoints"]);
    let error = wmr(&["export", PAPER, "-o", "paper.txt", "--json"]);
    assert_eq!(error.status.code(), Some(2));
}

#[test]
fn inflation_by_a_disc_shortens_the_path_and_keeps_the_radius() {
    let folder = tempfile::tempdir().unwrap();
    let steps = folder.path().to_str().unwrap();
    let square = succeed(&["plan", PAPER, "--json"]);
    let round = succeed(&["plan", PAPER, "--inflation", "disc", "--steps", steps, "--json"]);
    assert!(number(&round["length"]) < number(&square["length"]) - 0.01, "{round}");
    assert!(number(&round["clearance"]) >= 0.075 - 1e-9, "{round}");
    let picture = std::fs::read_to_string(folder.path().join("14_path.svg")).unwrap();
    assert!(picture.contains("grown by the radius"));
    let grid = wmr(&["plan", PAPER, "--inflation", "disc", "--planner", "grid", "--json"]);
    assert_eq!(
        (grid.status.code(), document(&grid)["error"]["code"].clone()),
        (Some(2), "plan.disc_needs_exact".into())
    );
    let detect = wmr(&["detect", PHOTO, "--arena", PHOTO_ARENA, "--corners", "round", "--json"]);
    assert_eq!(detect.status.code(), Some(2));
    let message = document(&detect)["error"]["message"].to_string();
    assert!(message.contains("--inflation disc"), "{message}");
}

#[test]
fn a_goal_that_cannot_be_reached_is_told_the_gap_or_the_nearest_free_point() {
    let folder = tempfile::tempdir().unwrap();
    let scene = folder.path().join("wall.json");
    let text = r#"{"format":"wmr-scene/1","arena":{"width":2.0,"height":1.0},"robot_radius":0.075,
        "obstacles":[[0.9,0.0,1.1,0.3],[0.9,0.41,1.1,1.0]],"start":[0.2,0.5,0],"goal":[1.8,0.5]}"#;
    std::fs::write(&scene, text).unwrap();
    let scene = scene.to_str().unwrap();
    let refused = |arguments: &[&str]| {
        let output = wmr(&[&["plan", scene, "--json"], arguments].concat());
        assert_eq!(output.status.code(), Some(4), "{output:?}");
        let error = document(&output)["error"].clone();
        (error["code"].as_str().unwrap().to_owned(), format!("{error}"))
    };
    let (code, text) = refused(&[]);
    assert_eq!(code, "plan.no_path");
    for part in ["11.0 cm", "obstacle 1", "obstacle 2", "15.0 cm"] {
        assert!(text.contains(part), "{part} is missing in {text}");
    }
    let (code, text) = refused(&["--goal", "0.87,0.2"]);
    assert_eq!(code, "plan.goal_blocked");
    assert!(text.contains("the nearest free point is (0.8250, 0.2000)"), "{text}");
}

#[test]
fn a_text_is_no_photo_whatever_it_begins_with() {
    let folder = tempfile::tempdir().unwrap();
    let marked = write(&folder, "marked.json", &format!("\u{feff}{}", floor(ENDS)));
    succeed(&["plan", &marked, "--json"]);
    let list = write(&folder, "list.json", "[]");
    assert_refused(3, "file.json", &["plan", &list]);
}

#[cfg(unix)]
#[test]
fn a_file_without_end_is_refused() {
    assert_refused(3, "file.size", &["plan", "/dev/zero"]);
}

#[test]
#[cfg(target_os = "linux")]
fn a_result_that_cannot_be_written_is_an_error() {
    let full = std::fs::File::options().write(true).open("/dev/full").unwrap();
    let mut command = Command::new(env!("CARGO_BIN_EXE_wmr"));
    let output =
        command.args(["plan", PAPER]).stdout(full).stderr(Stdio::piped()).output().unwrap();
    assert_eq!(output.status.code(), Some(3));
    assert!(String::from_utf8(output.stderr).unwrap().contains("cannot write"));
}
