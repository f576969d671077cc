//! `wmr serve` over real sockets: from photo to goal, stop, pause, jog, and a robot that is lost.
#![allow(clippy::unwrap_used, clippy::panic, reason = "helpers of tests fail as tests do")]
#![cfg(feature = "dashboard")]

mod server;

use serde_json::{Value, json};
use server::{Server, first_line, is_at_rest, next_text, program};
use std::io::Write;

#[test]
fn the_sample_is_seen_planned_and_driven() {
    let server = Server::start();
    let plan = server.plan_sample();
    let state = server.state();
    assert_eq!(state["detection"]["obstacles"].as_array().unwrap().len(), 8);
    assert_eq!(state["scene"]["goal"], json!([0.996, 0.229]));
    assert_eq!(plan["margin"], 0.01);

    let stale = plan["revision"]["plan"].as_u64().unwrap() - 1;
    assert_eq!(server.post("drive", &json!({"plan": stale})).0, 409);
    server.done("drive", &json!({"plan": plan["revision"]["plan"]}));
    assert_eq!(server.post("drive", &json!({})).0, 409, "it is under way");
    let state = server.when("at rest", is_at_rest);
    let report = &state["run"]["report"];
    assert_eq!(report["reached"], true, "{}", state["run"]);
    assert_eq!(report["collisions"], 0);
    assert!(report["error"]["position"].as_f64().unwrap() < 0.02);
    assert!(state["run"]["trail"].as_array().unwrap().len() > 10);
    let (_, lines) = server.raw("GET /api/run.jsonl", &[("Host", &server.host)], b"");
    let last = String::from_utf8(lines).unwrap().lines().last().map(str::to_owned).unwrap();
    assert!(serde_json::from_str::<Value>(&last).unwrap()["pose"].is_array());
}

#[test]
fn a_stop_ends_the_drive_while_an_upload_and_a_detection_are_pending() {
    let server = Server::start();
    server.plan_sample();
    let goal = json!([0.996, 0.229]);
    server.done("drive", &json!({}));
    server.when("driving", |state| state["drive"]["leg"].as_u64() >= Some(1));

    // Half of a photo that never comes to its end.
    let mut upload = server.connect();
    let head = format!(
        "POST /api/photo HTTP/1.1\r\nHost: {}\r\nAuthorization: Bearer {}\r\nContent-Type: image/png\r\nContent-Length: 1000000\r\n\r\n",
        server.host, server.token
    );
    upload.write_all(head.as_bytes()).unwrap();
    upload.write_all(&[0; 1000]).unwrap();
    std::thread::scope(|scope| {
        scope.spawn(|| server.post("detect", &json!({})));
        server.done("stop", &json!({}));
    });

    let state = server.when("at rest", is_at_rest);
    assert_eq!(state["run"]["error"]["code"], "robot.stopped", "{}", state["run"]);
    assert_eq!(state["run"]["report"]["reached"], false);
    assert_eq!(state["base"]["state"], "stopped");
    assert_eq!(state["base"]["wheels"], json!([0.0, 0.0]));
    drop(upload);

    // The robot can be told to drive again.
    server.done("plan", &json!({"start": state["base"]["pose"], "goal": goal}));
    server.done("drive", &json!({}));
    assert_eq!(server.when("at rest", is_at_rest)["run"]["report"]["reached"], true);
}

#[test]
fn a_robot_is_held_and_goes_on() {
    let server = Server::start();
    server.plan_sample();
    server.done("drive", &json!({}));
    server.when("driving", |state| state["base"]["state"] == "driving");
    server.done("pause", &json!({}));
    let held = |state: &Value| {
        state["base"]["state"] == "paused" && state["base"]["wheels"] == json!([0.0, 0.0])
    };
    let pose = server.when("paused", held)["base"]["pose"].clone();
    assert!(
        server.when("paused", held)["base"]["pose"][0].as_f64().unwrap()
            - pose[0].as_f64().unwrap()
            < 1e-3
    );
    server.done("resume", &json!({}));
    assert_eq!(server.when("at rest", is_at_rest)["run"]["report"]["reached"], true);
}

#[test]
fn a_robot_that_nobody_watches_any_more_pauses() {
    let server = Server::start();
    server.plan_sample();
    let own = ("Host", server.host.as_str());
    let (_, mut first) = server.open_socket(&server.token, &[own]);
    let (_, second) = server.open_socket(&server.token, &[own]);
    assert!(next_text(&mut first)["base"]["age"].is_number());
    server.done("drive", &json!({}));
    while next_text(&mut first)["base"]["state"] != "driving" {}
    drop(second);
    assert_eq!(next_text(&mut first)["drive"]["pause_wanted"], false, "one page still watches");
    drop(first);
    server.when("paused", |state| state["base"]["state"] == "paused");
    server.done("resume", &json!({}));
    assert_eq!(server.when("at rest", is_at_rest)["run"]["report"]["reached"], true);

    server.done("drive", &json!({"unattended": true}));
    let (_, page) = server.open_socket(&server.token, &[own]);
    drop(page);
    assert_eq!(server.when("at rest", is_at_rest)["run"]["report"]["reached"], true);
}

#[test]
fn a_goal_that_cannot_be_reached_names_the_gap() {
    let server = Server::start();
    // A wall with a gap of 11 cm, and one of 6 cm.
    let scene = json!({
        "format": "wmr-scene/1", "arena": {"width": 2, "height": 1},
        "obstacles": [[0.9, 0, 1.1, 0.3], [0.9, 0.41, 1.1, 0.7], [0.9, 0.76, 1.1, 1]],
    });
    let (status, document) =
        server.post("plan", &json!({"scene": scene, "start": [0.2, 0.5], "goal": [1.8, 0.5]}));
    assert_eq!((status, &document["error"]["code"]), (422, &json!("plan.no_path")));
    let gap = &document["error"]["gap"];
    assert_eq!(gap["between"], json!([0, 1]));
    assert!((gap["width"].as_f64().unwrap() - 0.11).abs() < 1e-9, "{gap}");
    assert!((gap["need"].as_f64().unwrap() - 0.15).abs() < 1e-9, "{gap}");
    let state = server.state();
    assert_eq!(state["plan"]["error"]["code"], "plan.no_path");
    assert_eq!(state["scene"]["goal"], json!([1.8, 0.5]), "the person's wish is kept");
    assert_eq!(server.post("drive", &json!({})).0, 409);
}

#[test]
fn two_jogs_lead_where_they_should() {
    let server = Server::start();
    server.when("connected", |state| state["base"]["pose"].is_array());
    for step in [json!({"turn": 0.3}), json!({"distance": 0.05})] {
        server.done("jog", &step);
        let state = server.when("at rest", is_at_rest);
        assert_eq!(state["run"]["error"], Value::Null, "{}", state["run"]);
    }
    let pose = server.state()["base"]["pose"].clone();
    let number = |index: usize| pose[index].as_f64().unwrap();
    let (sin, cos) = 0.3f64.sin_cos();
    assert!(
        (number(0) - 0.05 * cos).abs() < 0.003 && (number(1) - 0.05 * sin).abs() < 0.003,
        "{pose}"
    );
    assert!((number(2) - 0.3).abs() < 0.03, "{pose}");
}

/// The same on a robot in a process of its own, behind a socket, as a real one is behind a port.
#[test]
fn a_robot_behind_a_port_drives_and_stops_and_its_loss_is_said() {
    let mut robot = program(&["sim", "--tcp", "127.0.0.1:0"]);
    let line = first_line(&mut robot);
    let port = line.split_whitespace().find(|word| word.starts_with("tcp://")).unwrap();
    let port = port.trim_end_matches(';');
    let server =
        Server::start_with(&["serve", "--addr", "127.0.0.1:0", "--no-open", "--port", port]);
    server.when("connected", |state| state["base"]["connected"] == true);
    let scene =
        json!({"format": "wmr-scene/2", "arena": {"width": 3, "height": 1}, "obstacles": []});
    let wish = json!({"scene": scene, "start": [0.3, 0.5, 0], "goal": [0.8, 0.5]});
    server.done("plan", &wish);
    server.done("drive", &json!({}));
    let state = server.when("at rest", is_at_rest);
    assert_eq!(state["run"]["report"]["reached"], true, "{}", state["run"]);
    assert_eq!(state["run"]["report"]["true_pose"], Value::Null, "nobody knows it");

    server.done("plan", &json!({"start": [0.8, 0.5, 0], "goal": [2.8, 0.5]}));
    server.done("drive", &json!({}));
    server.when("driving", |state| state["base"]["state"] == "driving");
    server.done("stop", &json!({}));
    let state = server.when("stopped", is_at_rest);
    assert_eq!(state["run"]["error"]["code"], "robot.stopped");
    assert!(state["base"]["pose"][0].as_f64().unwrap() < 2.5, "{}", state["base"]);

    robot.kill().unwrap();
    robot.wait().unwrap();
    let state = server.when("lost", |state| state["base"]["connected"] == false);
    assert!(state["base"]["problem"]["help"].is_string(), "{}", state["base"]);
}

#[test]
fn what_is_held_moves_and_what_nobody_says_is_held_stops() {
    let server = Server::start();
    server.when("connected", |state| state["base"]["pose"].is_array());
    let ask = |hold: &str, begin: bool| server.post("jog", &json!({"hold": hold, "begin": begin}));
    assert_eq!(ask("ahead", false).1["held"], false, "nobody has pressed it");
    assert_eq!(server.state()["drive"]["active"], false);
    assert_eq!(ask("ahead", true).0, 200);
    let is_far = |state: &Value| state["base"]["pose"][0].as_f64().unwrap() > 0.3;
    while !is_far(&server.state()) {
        assert_eq!(ask("ahead", false).1["held"], true);
    }
    // Silence lets it go.
    let state = server.when("at rest", is_at_rest);
    assert_eq!(state["run"]["error"], Value::Null, "{}", state["run"]);
    assert_eq!(state["base"]["wheels"], json!([0.0, 0.0]));
    assert_eq!(ask("ahead", false).1["held"], false);

    assert_eq!(ask("left", true).0, 200);
    server.done("stop", &json!({}));
    assert_eq!(ask("left", false).1["held"], false, "a stop starts again only with a new press");
    let state = server.when("at rest", is_at_rest);
    assert_eq!(state["base"]["state"], "stopped");
}

#[test]
fn numbers_are_kept_for_the_next_drive_and_only_ones_that_make_sense() {
    let server = Server::start();
    server.when("connected", |state| state["base"]["connected"] == true);
    let speed = |document: &Value| {
        let list = document["parameters"].as_array().unwrap().clone();
        list.into_iter().find(|number| number["name"] == "speed").unwrap()
    };
    let old = server.done("parameters", &json!({}));
    assert_eq!((&speed(&old)["value"], &speed(&old)["unit"]), (&json!(0.4), &json!("m/s")));
    let new = server.done("parameters", &json!({"values": {"speed": 0.2}, "keep": true}));
    assert_eq!(speed(&new)["value"], 0.2);
    let refused = server.post("parameters", &json!({"values": {"speed": 1000.0}}));
    assert_eq!((refused.0, &refused.1["error"]["code"]), (409, &json!("robot.refused")));
    assert_eq!(server.post("parameters", &json!({"values": {"sped": 1.0}})).0, 400);
    server.plan_sample();
    server.done("drive", &json!({}));
    let state = server.when("at rest", is_at_rest);
    let slow = state["run"]["report"]["duration"].as_f64().unwrap();
    assert!(slow > state["plan"]["length"].as_f64().unwrap() / 0.2, "{slow}");
    assert_eq!(speed(&server.done("parameters", &json!({})))["value"], 0.2);
}

#[test]
fn faults_strike_while_it_drives_and_end_when_they_are_taken_back() {
    let server = Server::start();
    server.plan_sample();
    server.done("drive", &json!({}));
    server.when("driving", |state| state["base"]["state"] == "driving");
    server.done("faults", &json!({"blocked": [true, true]}));
    let state = server.when("at rest", is_at_rest);
    assert_eq!(state["run"]["report"]["reached"], false, "{}", state["run"]);
    assert!(state["run"]["error"]["help"].is_string());
    // Of the few frames of a short drive one in ten may by chance all come through.
    server.done("faults", &json!({"loss": 0.3}));
    server.plan_sample();
    server.done("drive", &json!({}));
    let state = server.when("at rest", is_at_rest);
    assert_eq!(state["run"]["report"]["reached"], true, "{}", state["run"]["error"]);
    assert!(state["run"]["report"]["link"]["retransmitted"].as_u64() > Some(0));
    assert_eq!(server.post("faults", &json!({"loss": 2})).0, 400);
}

#[test]
fn six_courses_and_their_ends_calibrate_the_base() {
    let server = Server::start_at("40");
    server.when("connected", |state| state["base"]["pose"].is_array());
    let mut ends = Vec::new();
    for index in 0..6 {
        let before = server.state()["run"]["revision"].clone();
        server.done("course", &json!({"index": index, "side": 0.5}));
        let state = server.when("at rest", |state| {
            is_at_rest(state) && state["run"]["revision"].as_u64() > before.as_u64()
        });
        ends.push(state["run"]["course"].clone());
    }
    let wish = json!({"side": 0.5, "ends": ends, "keep": true});
    let found = server.done("calibrate", &wish);
    let rms = |when: &str| found[when]["rms"].as_f64().unwrap();
    assert!(rms("after") <= rms("before") && rms("after") < 0.005, "{found}");
    let numbers = server.done("parameters", &json!({}));
    assert_eq!(numbers["calibration"], found["calibration"]);
    // Ends that no lengths explain.
    let mut far = wish.clone();
    far["ends"][0]["measured"] = json!([5, 0, 0]);
    assert_eq!(server.post("calibrate", &far).1["error"]["code"], "calibrate");
    assert_eq!(server.done("parameters", &json!({}))["calibration"], found["calibration"]);
    assert_eq!(server.post("course", &json!({"index": 6, "side": 1})).0, 400);
}

#[test]
fn a_drive_is_kept_listed_and_read_again() {
    let folder = tempfile::tempdir().unwrap();
    let log = folder.path().to_str().unwrap();
    let start = ["serve", "--addr", "127.0.0.1:0", "--no-open", "--sim-speed", "20", "--log", log];
    let server = Server::start_with(&start);
    server.plan_sample();
    server.done("drive", &json!({}));
    let state = server.when("kept", |state| state["run"]["kept"].is_string());
    drop(server);

    // Another start of the program finds it.
    let server = Server::start_with(&start);
    let get = |path: &str| {
        let (status, body) = server.raw(&format!("GET {path}"), &[("Host", &server.host)], b"");
        (status, serde_json::from_slice::<Value>(&body).unwrap_or(Value::Null))
    };
    let (_, list) = get("/api/runs");
    assert_eq!(list["runs"][0]["name"], state["run"]["kept"]);
    assert_eq!(list["runs"][0]["reached"], true);
    let (_, run) = get("/api/runs/run-0001");
    assert_eq!(run["report"]["pose"], state["run"]["report"]["pose"]);
    let files: Vec<_> = run["files"].as_array().unwrap().iter().map(|name| name.as_str()).collect();
    assert!(files.contains(&Some("photo")) && files.contains(&Some("run.jsonl")), "{files:?}");
    assert_eq!(get("/api/runs/run-0001/plan.json").1["format"], "wmr-plan/1");
    for path in ["/api/runs/run-0002", "/api/runs/run-0001/..%2f..%2fsecret", "/api/runs/.."] {
        assert_eq!(get(path).0, 404, "{path}");
    }
}

#[test]
fn only_known_ports_are_opened() {
    let server = Server::start();
    for port in ["/etc/passwd", "elf:/bin/true", "/dev/mem", ""] {
        assert_eq!(server.post("connect", &json!({"port": port})).0, 400, "{port}");
    }
    server.done("connect", &json!({"port": "tcp://127.0.0.1:1"}));
    let state = server.when("lost", |state| state["base"]["problem"].is_object());
    assert_eq!(state["base"]["port"], "tcp://127.0.0.1:1");
    server.done("connect", &json!({"port": "sim"}));
    server.when("connected", |state| state["base"]["connected"] == true);
}
