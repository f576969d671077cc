//! `wmr serve` over real sockets: who may ask, and what cannot be asked.
#![allow(clippy::unwrap_used, clippy::panic, reason = "helpers of tests fail as tests do")]
#![cfg(feature = "dashboard")]

mod server;

use serde_json::{Value, json};
use server::{Server, program};
use std::io::{BufRead, BufReader};

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

/// Two rows of modules a line, the light ones drawn.
#[test]
fn a_phone_in_the_network_gets_the_address_as_a_code() {
    let mut process = program(&["serve", "--addr", "127.0.0.1:0", "--lan", "--no-open"]);
    let mut lines = BufReader::new(process.stderr.take().unwrap()).lines().map(Result::unwrap);
    let here = lines.next().unwrap();
    assert!(here.contains("http://127.0.0.1:"), "{here}");
    // A computer without a network has no address to show.
    if std::net::UdpSocket::bind("0.0.0.0:0").unwrap().connect("192.0.2.1:9").is_err() {
        process.kill().unwrap();
        process.wait().unwrap();
        return;
    }
    let there = lines.next().unwrap();
    let mut code = vec![lines.next().unwrap()];
    code.extend(lines.take(code[0].chars().count().div_ceil(2) - 1));
    process.kill().unwrap();
    process.wait().unwrap();
    let token = here.split("t=").nth(1).unwrap().split(' ').next().unwrap();
    assert!(there.contains(token), "{there}");
    let width = code[0].chars().count();
    // Version 3 has 29 modules and a light margin of four on each side.
    assert!(width >= 29 + 8 && code.iter().all(|line| line.chars().count() == width), "{code:?}");
    assert!(code[0].chars().all(|tile| tile == '█'), "a light margin: {}", code[0]);
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
fn a_job_that_is_given_up_answers_at_once_and_leaves_the_desk_as_it_was() {
    let server = Server::start();
    server.done("photo", &json!({"sample": "demo"}));
    assert_eq!(server.done("cancel", &json!({}))["cancelled"], false);
    // Large enough that it is still being read when it is given up.
    let mut picture = Vec::new();
    let encoder = image::codecs::png::PngEncoder::new(&mut picture);
    let grey = image::ExtendedColorType::L8;
    let pixels = vec![200; 8000 * 5000];
    image::ImageEncoder::write_image(encoder, &pixels, 8000, 5000, grey).unwrap();
    std::thread::scope(|scope| {
        let upload = scope.spawn(|| server.send("/api/photo", "image/png", &picture));
        while server.done("cancel", &json!({}))["cancelled"] == false {
            assert!(!upload.is_finished(), "it was read before it could be given up");
        }
        let (status, document) = upload.join().unwrap();
        assert_eq!((status, &document["error"]["code"]), (409, &json!("http.cancelled")));
    });
    let state = server.state();
    assert_eq!((&state["photo"]["width"], &state["revision"]["photo"]), (&json!(640), &json!(1)));
    // The next one has its turn when the step that was under way is done.
    let detected = std::iter::repeat_with(|| server.post("detect", &json!({})));
    let (status, document) = detected.into_iter().find(|(status, _)| *status != 429).unwrap();
    assert_eq!((status, document["obstacles"].as_array().unwrap().len()), (200, 8));
}

#[test]
fn the_demo_opens_its_mission_and_programs_are_told_where_the_page_is() {
    let server = Server::start_with(&["demo", "--page"]);
    let state = server.state();
    assert_eq!(
        state["photo"],
        json!({"width": 640, "height": 480, "type": "image/png", "note": null})
    );
    assert_eq!(state["scene"]["obstacles"].as_array().unwrap().len(), 8);
    assert_eq!(
        (&state["plan"]["planner"], &state["run"]["active"]),
        (&json!("grid"), &json!(false))
    );
    let mut process = program(&["serve", "--addr", "127.0.0.1:0", "--no-open", "--json"]);
    let mut line = String::new();
    BufReader::new(process.stdout.take().unwrap()).read_line(&mut line).unwrap();
    process.kill().unwrap();
    process.wait().unwrap();
    let document: Value = serde_json::from_str(&line).unwrap();
    let token = document["token"].as_str().unwrap();
    assert!(document["address"].as_str().unwrap().ends_with(token) && token.len() == 32, "{line}");
}
