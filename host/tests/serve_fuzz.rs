//! `wmr serve` and whatever may come over a network: requests and socket messages of chance, from seeds.
#![allow(clippy::unwrap_used, clippy::panic, reason = "helpers of tests fail as tests do")]
#![cfg(feature = "dashboard")]

mod server;

use fastrand::Rng;
use serde_json::{Value, json};
use server::{Server, is_at_rest};
use std::io::{Read, Write};

/// Requests and messages in all, half of them while the robot drives and half while it rests.
const ATTEMPTS: usize = 10_000;
/// One of so many is a socket with messages instead of a request.
const SOCKET_SHARE: usize = 10;
const MESSAGES: usize = 5;

/// What may be asked without moving the robot or stopping it.
const PATHS: [&str; 24] = [
    "/",
    "/api/state",
    "/api/photo",
    "/api/corners",
    "/api/detect",
    "/api/scene",
    "/api/plan",
    "/api/steps",
    "/api/steps/1_plan_view.png",
    "/api/run.jsonl",
    "/api/runs",
    "/api/runs/run-0001",
    "/api/runs/../../etc/passwd",
    "/api/runs/run-0001/%2e%2e%2fplan.json",
    "/api/ports",
    "/api/connect",
    "/api/parameters",
    "/api/faults",
    "/api/frames",
    "/ws",
    "/page/app.js",
    "/page/../x",
    "/%00",
    "*",
];

const TEXTS: [&str; 14] = [
    "{}",
    "[]",
    "null",
    r#"{"sample":"demo"}"#,
    r#"{"corners_px":null}"#,
    r#"{"corners_px":[[0,0],[0,0],[0,0],[0,0]]}"#,
    r#"{"goal":[0.5,0.5]}"#,
    r#"{"goal":[1e308,-1e308]}"#,
    r#"{"values":{"track":1e30}}"#,
    r#"{"port":"/etc/passwd"}"#,
    r#"{"hold":"ahead"}"#,
    r#"{"loss":0}"#,
    r#"{"reading":{"ignore":[[0.1,0.1,0.1]]}}"#,
    r#"{"format":"wmr-scene/1","arena":{"width":1,"height":1},"obstacles":[[0.4,0.4,0.6,0.6]]}"#,
];

/// A request of chance to one of `paths`; its status, and what it was.
fn ask(server: &Server, random: &mut Rng, paths: &[&str]) -> (u16, String) {
    let kinds = ["application/json", "image/png", "text/plain"];
    let method = ["GET", "POST", "POST", "POST", "PUT", "OPTIONS"][random.usize(..6)];
    let path = paths[random.usize(..paths.len())];
    let mut body = TEXTS[random.usize(..TEXTS.len())].as_bytes().to_vec();
    for _ in 0..random.usize(..4) {
        let at = random.usize(..body.len());
        body[at] = random.u8(..);
    }
    let bearer = format!("Bearer {}", server.token);
    let kind = kinds[random.usize(..kinds.len())];
    let heads =
        [("Host", server.host.as_str()), ("Authorization", &bearer), ("Content-Type", kind)];
    let (status, _) = server.raw(&format!("{method} {path}"), &heads, &body);
    (status, format!("{method} {path} {kind} {}", String::from_utf8_lossy(&body)))
}

/// Messages of chance on a socket of its own: frames of every kind, damaged ones, too large ones.
fn talk(server: &Server, random: &mut Rng) {
    let (status, mut socket) = server.open_socket(&server.token, &[("Host", &server.host)]);
    assert_eq!(status, 101);
    for _ in 0..MESSAGES {
        let length = random.usize(..120);
        let head = [random.u8(..), 0x80 | length as u8, 1, 2, 3, 4];
        let body: Vec<u8> = (0..length).map(|_| random.u8(..)).collect();
        if socket.write_all(&head).and_then(|()| socket.write_all(&body)).is_err() {
            break;
        }
    }
    socket.shutdown(std::net::Shutdown::Write).unwrap_or_default();
    let mut rest = Vec::new();
    // The server may have closed it in the middle.
    let _ = socket.read_to_end(&mut rest);
}

/// So many requests and messages; how many requests were refused, and how many were made.
fn pester(server: &Server, random: &mut Rng, paths: &[&str], count: usize) -> (usize, usize) {
    let (mut refused, mut asked, mut done) = (0, 0, 0);
    while done < count {
        if random.usize(..SOCKET_SHARE) == 0 {
            talk(server, random);
            done += MESSAGES;
        } else {
            let (status, request) = ask(server, random, paths);
            assert!(status != 500 && status != 0, "{status} {request}");
            refused += usize::from(status >= 400);
            asked += 1;
            done += 1;
        }
    }
    (refused, asked)
}

fn drive_time(state: &Value) -> f64 {
    state["drive"]["time"].as_f64().unwrap()
}

/// A way straight ahead that lasts longer than all requests.
fn long_way() -> Value {
    let scene = json!({
        "format": "wmr-scene/2", "arena": {"width": 100, "height": 1}, "obstacles": [],
        "start": [0.3, 0.5, 0],
    });
    json!({"scene": scene, "goal": [99.7, 0.5]})
}

/// Wheels that have come to rest turn by a count or two more while the motors let go: metres and radians.
const SETTLING: f64 = 0.004;

#[test]
fn nothing_that_is_asked_or_said_disturbs_a_drive_or_a_stop_or_moves_a_robot_at_rest() {
    let server = Server::start_at("1");
    server.done("plan", &long_way());
    server.done("drive", &json!({"unattended": true}));
    server.when("driving", |state| state["base"]["state"] == "driving");
    let mut random = Rng::with_seed(15);

    // What would move the robot is refused while it drives.
    let moving: Vec<&str> = PATHS.iter().copied().chain(["/api/drive", "/api/jog"]).collect();
    let (refused, asked) = pester(&server, &mut random, &moving, ATTEMPTS / 2);
    assert!(refused > asked / 4 && refused < asked, "{refused} of {asked}");
    let state = server.state();
    assert_eq!(state["base"]["state"], "driving", "{}", state["run"]);
    let [x, y] = [0, 1].map(|axis| state["base"]["pose"][axis].as_f64().unwrap());
    assert!((y - 0.5).abs() < 0.01 && x > 0.301 && x < 99.0, "on its path: {}", state["base"]);

    let before = drive_time(&server.state());
    server.done("stop", &json!({}));
    let stands = |state: &Value| is_at_rest(state) && state["base"]["wheels"] == json!([0.0, 0.0]);
    let state = server.when("at rest", stands);
    assert_eq!(state["run"]["error"]["code"], "robot.stopped");
    // Heard within 0.3 s, and then braked within the limits: π/2 · 0.4 m/s / 0.8 m/s².
    let took = drive_time(&state) - before;
    assert!(took < 0.3 + 0.79, "at rest after {took} s");

    let rest = server.when("stopped", |state| state["base"]["state"] == "stopped");
    pester(&server, &mut random, &PATHS, ATTEMPTS / 2);
    let state = server.state();
    let moved = |axis: usize| {
        let [now, then] =
            [&state, &rest].map(|state| state["base"]["pose"][axis].as_f64().unwrap());
        (now - then).abs()
    };
    assert!((0..3).all(|axis| moved(axis) < SETTLING), "it was told nothing: {state} {rest}");
    assert_eq!(state["base"]["state"], "stopped");

    // And it drives again.
    server.done("faults", &json!({}));
    server.done("plan", &json!({"goal": [1.0, 0.5], "scene": {
        "format": "wmr-scene/2", "arena": {"width": 2, "height": 1}, "obstacles": [], "start": [0.3, 0.5, 0],
    }}));
    server.done("drive", &json!({}));
    assert_eq!(server.when("at rest", is_at_rest)["run"]["report"]["reached"], true);
}
