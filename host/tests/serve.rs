//! `wmr serve` over real sockets: who may ask, what cannot be asked, and a drive from photo to goal.
#![allow(clippy::unwrap_used, clippy::panic, reason = "helpers of tests fail as tests do")]
#![cfg(feature = "dashboard")]

use serde_json::{Value, json};
use std::io::{BufRead, BufReader, Read, Write};
use std::net::TcpStream;
use std::process::{Child, Command, Stdio};
use std::time::{Duration, Instant};

/// A server of its own for each test.
struct Server {
    process: Child,
    host: String,
    token: String,
}

impl Drop for Server {
    fn drop(&mut self) {
        let _ = self.process.kill();
        let _ = self.process.wait();
    }
}

/// How long something may take on a busy computer before a test gives it up.
const PATIENCE: Duration = Duration::from_secs(60);

fn program(arguments: &[&str]) -> Child {
    let mut command = Command::new(env!("CARGO_BIN_EXE_wmr"));
    // A browser is not to be opened on the computer of whoever runs the tests.
    command.env_remove("DISPLAY").env_remove("WAYLAND_DISPLAY").env_remove("WMR_PORT");
    command.args(arguments).stderr(Stdio::piped()).stdout(Stdio::piped()).spawn().unwrap()
}

/// What a program says first.
fn first_line(process: &mut Child) -> String {
    let mut line = String::new();
    BufReader::new(process.stderr.take().unwrap()).read_line(&mut line).unwrap();
    line
}

impl Server {
    fn start() -> Self {
        Self::start_at("20")
    }

    /// The same with a robot `speed` times as fast as the clock.
    fn start_at(speed: &str) -> Self {
        Self::start_with(&["serve", "--addr", "127.0.0.1:0", "--no-open", "--sim-speed", speed])
    }

    fn start_with(arguments: &[&str]) -> Self {
        let mut process = program(arguments);
        let line = first_line(&mut process);
        let (_, rest) = line.split_once("http://").unwrap();
        let (host, rest) = rest.split_once("/?t=").unwrap();
        let token = rest.split_whitespace().next().unwrap();
        Self { host: host.into(), token: token.into(), process }
    }

    fn connect(&self) -> TcpStream {
        let stream = TcpStream::connect(&self.host).unwrap();
        stream.set_read_timeout(Some(PATIENCE)).unwrap();
        stream
    }

    /// Status and body of a request with exactly these heads.
    fn raw(&self, line: &str, heads: &[(&str, &str)], body: &[u8]) -> (u16, Vec<u8>) {
        let mut stream = self.connect();
        let mut head = format!("{line} HTTP/1.1\r\nConnection: close\r\n");
        heads.iter().for_each(|(name, value)| head += &format!("{name}: {value}\r\n"));
        if !body.is_empty() {
            head += &format!("Content-Length: {}\r\n", body.len());
        }
        stream.write_all(format!("{head}\r\n").as_bytes()).unwrap();
        // A server that refuses a body need not read it.
        let _ = stream.write_all(body);
        let mut answer = Vec::new();
        let _ = stream.read_to_end(&mut answer);
        let text = String::from_utf8_lossy(&answer);
        let status = text.split(' ').nth(1).and_then(|code| code.parse().ok()).unwrap_or(0);
        let end = answer.windows(4).position(|four| four == b"\r\n\r\n").map_or(0, |at| at + 4);
        (status, answer.split_off(end))
    }

    fn send(&self, path: &str, kind: &str, body: &[u8]) -> (u16, Value) {
        let bearer = format!("Bearer {}", self.token);
        let heads =
            [("Host", self.host.as_str()), ("Authorization", &bearer), ("Content-Type", kind)];
        let (status, body) = self.raw(&format!("POST {path}"), &heads, body);
        (status, serde_json::from_slice(&body).unwrap_or(Value::Null))
    }

    fn post(&self, what: &str, body: &Value) -> (u16, Value) {
        self.send(&format!("/api/{what}"), "application/json", body.to_string().as_bytes())
    }

    /// A request that must succeed.
    fn done(&self, what: &str, body: &Value) -> Value {
        let (status, document) = self.post(what, body);
        assert_eq!(status, 200, "{what}: {document}");
        document
    }

    fn state(&self) -> Value {
        let (status, body) = self.raw("GET /api/state", &[("Host", &self.host)], b"");
        assert_eq!(status, 200);
        serde_json::from_slice(&body).unwrap()
    }

    /// The state as soon as it is as wanted.
    fn when(&self, what: &str, wanted: impl Fn(&Value) -> bool) -> Value {
        let began = Instant::now();
        loop {
            let state = self.state();
            if wanted(&state) {
                return state;
            }
            assert!(began.elapsed() < PATIENCE, "never {what}: {}", state["drive"]);
            std::thread::sleep(Duration::from_millis(10));
        }
    }

    /// Lays the sample on the desk and plans to the demo's goal.
    fn plan_sample(&self) -> Value {
        self.done("photo", &json!({"sample": "demo"}));
        self.done("detect", &json!({}));
        self.done("plan", &json!({"goal": [0.996, 0.229]}))
    }

    /// Opens a web socket; the status of the answer and the stream behind it.
    fn open_socket(&self, token: &str, heads: &[(&str, &str)]) -> (u16, TcpStream) {
        let mut stream = self.connect();
        let mut head = format!(
            "GET /ws?t={token} HTTP/1.1\r\nConnection: Upgrade\r\nUpgrade: websocket\r\nSec-WebSocket-Version: 13\r\nSec-WebSocket-Key: dGhlIHNhbXBsZSBub25jZQ==\r\n"
        );
        heads.iter().for_each(|(name, value)| head += &format!("{name}: {value}\r\n"));
        stream.write_all(format!("{head}\r\n").as_bytes()).unwrap();
        let mut answer = Vec::new();
        while !answer.ends_with(b"\r\n\r\n") {
            let mut byte = [0];
            stream.read_exact(&mut byte).unwrap();
            answer.push(byte[0]);
        }
        let text = String::from_utf8(answer).unwrap();
        (text.split(' ').nth(1).unwrap().parse().unwrap(), stream)
    }
}

/// The next text message of a socket; pings are passed over.
fn next_text(stream: &mut TcpStream) -> Value {
    loop {
        let mut head = [0; 2];
        stream.read_exact(&mut head).unwrap();
        let length = match head[1] & 0x7f {
            126 => {
                let mut long = [0; 2];
                stream.read_exact(&mut long).unwrap();
                usize::from(u16::from_be_bytes(long))
            }
            short => usize::from(short),
        };
        let mut body = vec![0; length];
        stream.read_exact(&mut body).unwrap();
        if head[0] & 0x0f == 1 {
            return serde_json::from_slice(&body).unwrap();
        }
    }
}

fn is_at_rest(state: &Value) -> bool {
    state["drive"]["active"] == false
}

#[test]
fn who_is_not_the_page_changes_nothing() {
    let server = Server::start();
    let own = ("Host", server.host.as_str());
    let bearer = format!("Bearer {}", server.token);
    let known = ("Authorization", bearer.as_str());
    let json_type = ("Content-Type", "application/json");
    let sample = br#"{"sample":"demo"}"#;
    let port = server.host.rsplit_once(':').unwrap().1;
    let origin = format!("http://{}", server.host);
    let post = |heads: &[(&str, &str)]| server.raw("POST /api/photo", heads, sample).0;

    for host in ["evil.example", "127.0.0.1", &format!("evil.example:{port}"), "127.0.0.1:1"] {
        assert_eq!(post(&[("Host", host), known, json_type]), 403, "{host}");
        assert_eq!(server.raw("GET /", &[("Host", host)], b"").0, 403, "{host}");
    }
    for origin in
        ["http://evil.example", "null", "https://127.0.0.1", &format!("http://localhost:{port}")]
    {
        assert_eq!(post(&[own, ("Origin", origin), known, json_type]), 403, "{origin}");
        assert_eq!(
            server.open_socket(&server.token, &[own, ("Origin", origin)]).0,
            403,
            "{origin}"
        );
    }
    for token in ["", "Bearer ", "Bearer 0123456789abcdef0123456789abcdef", &server.token] {
        assert_eq!(post(&[own, ("Authorization", token), json_type]), 401, "{token}");
    }
    assert_eq!(post(&[own, json_type]), 401);
    assert_eq!(server.open_socket("", &[own]).0, 401);
    assert_eq!(post(&[own, known, ("Content-Type", "text/plain")]), 415);
    assert_eq!(post(&[own, known]), 415);
    assert_eq!(server.state()["revision"]["photo"], 0, "nothing has changed");

    assert_eq!(post(&[own, ("Origin", &origin), known, json_type]), 200);
    assert_eq!(server.open_socket(&server.token, &[own, ("Origin", &origin)]).0, 101);
    let (status, page) = server.raw("GET /", &[own], b"");
    assert!(status == 200 && String::from_utf8(page).unwrap().contains(&server.token));
}

#[test]
fn beyond_this_computer_even_the_page_needs_the_token() {
    let server = Server::start_with(&["serve", "--addr", "0.0.0.0:0", "--no-open"]);
    let own = ("Host", server.host.as_str());
    let get = |path: &str| server.raw(&format!("GET {path}"), &[own], b"").0;
    let token = &server.token;
    assert_eq!([get("/"), get("/api/state"), get("/?t=guess")], [401; 3]);
    assert_eq!([get(&format!("/?t={token}")), get(&format!("/api/state?t={token}"))], [200; 2]);
    assert_eq!(get("/page/app.js"), 200, "a module is no secret");
    let other = [("Host", "robot.example")];
    assert_eq!(server.raw(&format!("GET /?t={token}"), &other, b"").0, 403);
}

#[test]
fn what_makes_no_sense_is_refused_with_a_reason() {
    let server = Server::start();
    let code = |(status, document): (u16, Value)| {
        let code = document["error"]["code"].as_str().unwrap_or_default().to_owned();
        assert!(document["error"]["help"].is_string(), "{status} {document}");
        (status, code)
    };
    let refused = |status: u16, name: &str| (status, name.to_owned());
    let photo = |bytes: &[u8]| code(server.send("/api/photo", "application/octet-stream", bytes));
    assert_eq!(photo(b"a text, and no photo"), refused(422, "photo"));
    assert_eq!(photo(b"\x89PNG\r\n\x1a\n and then nothing"), refused(422, "photo"));
    assert_eq!(code(server.post("detect", &json!({}))), refused(409, "photo.none"));
    assert_eq!(code(server.post("plan", &json!({"goal": [1, 1]}))), refused(409, "scene.none"));
    assert_eq!(code(server.post("drive", &json!({}))), refused(409, "plan.none"));
    assert_eq!(code(server.post("pause", &json!({}))), refused(409, "robot.idle"));
    assert_eq!(
        code(server.post("photo", &json!({"sample": "other"}))),
        refused(400, "http.request")
    );
    assert_eq!(code(server.post("jog", &json!({"distance": 1.0}))), refused(400, "http.request"));
    assert_eq!(
        code(server.post("jog", &json!({"distance": 0.01, "turn": 0.1}))),
        refused(400, "http.request")
    );
    assert_eq!(code(server.post("nothing", &json!({}))), refused(404, "http.path"));
    let scene =
        json!({"format": "wmr-scene/1", "arena": {"width": 0, "height": 1}, "obstacles": []});
    assert_eq!(code(server.post("scene", &scene)), refused(422, "scene"));
    for text in ["", "{", "[]", "{\"goal\": 1e999}", "{\"goal\": [0.1]}", "\u{0}", "nul"] {
        let (status, _) = server.send("/api/corners", "application/json", text.as_bytes());
        assert_eq!(status, 400, "{text}");
    }
    let mut picture = Vec::new();
    let pixels = vec![200; 8000 * 5001];
    let encoder = image::codecs::png::PngEncoder::new(&mut picture);
    let grey = image::ExtendedColorType::L8;
    image::ImageEncoder::write_image(encoder, &pixels, 8000, 5001, grey).unwrap();
    let (status, document) = server.send("/api/photo", "image/png", &picture);
    assert_eq!(status, 422);
    assert!(document["error"]["message"].as_str().unwrap().contains("40000000"), "{document}");
    let large = vec![b' '; 2 << 20];
    assert_eq!(server.send("/api/scene", "application/json", &large).0, 413);
    assert_eq!(server.raw("DELETE /api/photo", &[("Host", &server.host)], b"").0, 405);

    server.done("photo", &json!({"sample": "demo"}));
    let size = json!({"arena": {"width": -1, "height": 1}});
    assert_eq!(code(server.post("detect", &size)), refused(422, "photo"));
    assert_eq!(server.state()["scene"], Value::Null);
}

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
fn the_demo_opens_its_photo_and_programs_are_told_where_the_page_is() {
    let server = Server::start_with(&["demo", "--page"]);
    assert_eq!(server.state()["photo"], json!({"width": 640, "height": 480, "type": "image/png"}));
    let mut process = program(&["serve", "--addr", "127.0.0.1:0", "--no-open", "--json"]);
    let mut line = String::new();
    BufReader::new(process.stdout.take().unwrap()).read_line(&mut line).unwrap();
    process.kill().unwrap();
    process.wait().unwrap();
    let document: Value = serde_json::from_str(&line).unwrap();
    let token = document["token"].as_str().unwrap();
    assert!(document["address"].as_str().unwrap().ends_with(token) && token.len() == 32, "{line}");
}

/// Bytes that are no web socket frames, frames of every kind, and a message larger than any: the socket ends,
/// the server and its robot do not.
#[test]
fn nothing_that_a_socket_says_disturbs_a_drive() {
    let server = Server::start_at("2");
    server.plan_sample();
    server.done("drive", &json!({"unattended": true}));
    let mut random = fastrand::Rng::with_seed(7);
    let mut ended = 0;
    while !is_at_rest(&server.state()) {
        let (status, mut socket) = server.open_socket(&server.token, &[("Host", &server.host)]);
        assert_eq!(status, 101);
        for _ in 0..20 {
            let length = random.usize(..120);
            let masked = [random.u8(..), 0x80 | length as u8, 1, 2, 3, 4];
            let body: Vec<u8> = (0..length).map(|_| random.u8(..)).collect();
            let sent = socket.write_all(&masked).and_then(|()| socket.write_all(&body));
            if sent.is_err() {
                break;
            }
        }
        socket.shutdown(std::net::Shutdown::Write).unwrap_or_default();
        let mut rest = Vec::new();
        ended += usize::from(socket.read_to_end(&mut rest).is_ok());
    }
    assert!(ended > 10, "{ended}");
    assert_eq!(server.state()["run"]["report"]["reached"], true);
}

/// Requests of chance, and of a page gone mad, while the robot drives: it arrives all the same.
#[test]
fn nothing_that_is_asked_disturbs_a_drive() {
    const LEAST: usize = 200;
    let server = Server::start_at("2");
    server.plan_sample();
    server.done("drive", &json!({"unattended": true}));
    let mut random = fastrand::Rng::with_seed(15);
    let (mut asked, mut refused) = (0, 0);
    while !is_at_rest(&server.state()) {
        for _ in 0..50 {
            let (status, request) = ask_anything(&server, &mut random);
            assert!(status != 500, "{request}");
            asked += 1;
            refused += usize::from(status >= 400);
        }
    }
    assert!(asked >= LEAST && refused > asked / 4 && refused < asked, "{refused} of {asked}");
    // The last request may have been a jog of the robot that had arrived.
    let state = server.when("at rest", is_at_rest);
    let [x, y] = [0, 1].map(|axis| state["base"]["pose"][axis].as_f64().unwrap());
    assert!((x - 0.996).hypot(y - 0.229) < 0.3, "{state}");
    server.plan_sample();
    server.done("drive", &json!({}));
    let state = server.when("at rest", is_at_rest);
    assert_eq!(state["run"]["report"]["reached"], true, "{}", state["run"]["error"]);
}

/// A request of chance, other than to pause or stop; its status.
fn ask_anything(server: &Server, random: &mut fastrand::Rng) -> (u16, String) {
    let paths = [
        "/",
        "/api/state",
        "/api/photo",
        "/api/corners",
        "/api/detect",
        "/api/scene",
        "/api/plan",
        "/api/drive",
        "/api/jog",
        "/api/run.jsonl",
        "/ws",
        "/page/app.js",
        "/page/../x",
        "/%00",
        "*",
    ];
    let texts = [
        "{}",
        "[]",
        "null",
        r#"{"sample":"demo"}"#,
        r#"{"corners_px":null}"#,
        r#"{"corners_px":[[0,0],[0,0],[0,0],[0,0]]}"#,
        r#"{"goal":[0.5,0.5]}"#,
        r#"{"distance":0.05}"#,
        r#"{"turn":-0.3}"#,
        r#"{"goal":[1e308,-1e308]}"#,
        r#"{"format":"wmr-scene/1","arena":{"width":1,"height":1},"obstacles":[[0.4,0.4,0.6,0.6]]}"#,
    ];
    let kinds = ["application/json", "image/png", "text/plain"];
    let method = ["GET", "POST", "POST", "PUT", "OPTIONS"][random.usize(..5)];
    let path = paths[random.usize(..paths.len())];
    let mut body = texts[random.usize(..texts.len())].as_bytes().to_vec();
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
