//! What the commands print with `--json` is what the schemas in `host/schemas/` say, each command once;
//! every other test that reads a document holds it against its schema as well.
#![allow(clippy::unwrap_used, clippy::panic, reason = "helpers of tests fail as tests do")]

mod program;

use program::{
    ENDS, PAPER, PHOTO, PHOTO_ARENA, assert_valid, floor, read_json, succeed, wmr, write,
};
use serde_json::{Value, json};

#[test]
fn documents_of_photos_scenes_and_ways() {
    let folder = tempfile::tempdir().unwrap();
    let path = |name: &str| folder.path().join(name).to_str().unwrap().to_owned();
    let seen = succeed(&["detect", PHOTO, "--arena", PHOTO_ARENA, "--json"]);
    assert_valid("scene", &seen);
    for planner in ["exact", "grid", "tree", "fuzzy"] {
        succeed(&["plan", PAPER, "--planner", planner, "--json"]);
    }
    let arena = json!({
        "format": "wmr-arena/1", "arena": {"width": 2, "height": 1}, "obstacles": [[0.9, 0, 1.1, 1]],
        "queries": [{"start": [0.2, 0.5], "goal": [0.6, 0.5]}, {"start": [0.2, 0.5], "goal": [1.5, 0.5]}],
    });
    let arena = write(&folder, "arena.json", &arena.to_string());
    let answers = succeed(&["plan", &arena, "--queries", "--json"]);
    assert!(
        answers["queries"][0]["length"].is_number() && answers["queries"][1]["error"].is_object()
    );
    succeed(&["export", PAPER, "-o", &path("map.yaml"), "--json"]);
    succeed(&["tags", "--out", &path("tags.svg"), "--json"]);
    let camera = path("camera.json");
    let arena = ["--arena", "1.6x2.0", "--height", "3"];
    let words = ["calibrate", "camera", program::PAPER_PHOTO, "--out", &camera, "--json"];
    succeed(&[&words[..], &arena].concat());
    assert_valid("calibrate-camera", &read_json(camera.as_ref()));
}

#[test]
fn documents_of_robots() {
    let folder = tempfile::tempdir().unwrap();
    for words in [&["ports"][..], &["info"], &["stop"], &["params"], &["calibrate", "base"]] {
        let port = if words[0] == "ports" { &[][..] } else { &["--port", "sim"] };
        succeed(&[words, port, &["--json"]].concat());
    }
    let lines = wmr(&["monitor", "--port", "sim", "--for", "300ms", "--json"]).stdout;
    let lines = String::from_utf8(lines).unwrap();
    let lines: Vec<Value> = lines.lines().map(|line| serde_json::from_str(line).unwrap()).collect();
    assert!(!lines.is_empty());
    lines.iter().for_each(|line| assert_valid("monitor-line", line));
    let scene = write(&folder, "scene.json", &floor(ENDS));
    succeed(&["drive", &scene, "--port", "sim", "--json"]);
    let scenario = concat!(env!("CARGO_MANIFEST_DIR"), "/../tests/scenarios/romi.toml");
    succeed(&["sim", "--scenario", scenario, "--json"]);
}
