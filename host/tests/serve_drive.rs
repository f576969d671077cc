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
