//! The program as tests run it, and what its documents hold.
#![allow(dead_code, reason = "each test file uses a part")]
#![allow(clippy::unwrap_used, clippy::panic, reason = "helpers of tests fail as tests do")]

use serde_json::Value;
use std::path::Path;
use std::process::{Command, Output};

pub(crate) const PAPER: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/assets/paper.json");

pub(crate) const PAPER_PHOTO: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/assets/paper.png");

pub(crate) const PHOTO: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/assets/demo.png");

pub(crate) const PHOTO_ARENA: &str = "1.3x1.55";

pub(crate) const PHOTO_GOAL: &str = "0.996,0.229";

/// What a newcomer is promised: metres and radians (1°).
pub(crate) const END_POSITION: f64 = 0.005;

pub(crate) const END_HEADING: f64 = 0.0175;

pub(crate) fn wmr(arguments: &[&str]) -> Output {
    let mut command = Command::new(env!("CARGO_BIN_EXE_wmr"));
    command.args(arguments).env_remove("WMR_PORT").env("WMR_CONFIG", "").output().unwrap()
}

pub(crate) fn document(output: &Output) -> Value {
    let text = String::from_utf8(output.stdout.clone()).unwrap();
    serde_json::from_str(&text).unwrap_or_else(|error| panic!("{error}: {text}"))
}

pub(crate) fn succeed(arguments: &[&str]) -> Value {
    let output = wmr(arguments);
    assert!(output.status.success(), "{arguments:?}: {output:?}");
    let document = document(&output);
    assert_valid(&schema_of(arguments), &document);
    document
}

/// The name of the schema of what `wmr` prints with these arguments.
fn schema_of(arguments: &[&str]) -> String {
    let has = |option: &str| arguments.contains(&option);
    match arguments {
        ["demo", ..] => "drive".into(),
        ["plan", ..] if has("--queries") => "plan-queries".into(),
        ["export", .., "--json"] if arguments.iter().any(|word| word.ends_with(".csv")) => {
            "export-drive".into()
        }
        ["sim", ..] if has("--scenario") => "sim-scenario".into(),
        ["calibrate" | "check", what, ..] => format!("{}-{what}", arguments[0]),
        [command, ..] => (*command).into(),
        [] => panic!("no command"),
    }
}

/// A document must be what its schema in `host/schemas/` says.
pub(crate) fn assert_valid(name: &str, document: &Value) {
    let path = format!("{}/schemas/{name}.schema.json", env!("CARGO_MANIFEST_DIR"));
    let schema = read_json(Path::new(&path));
    if let Err(error) = jsonschema::validate(&schema, document) {
        panic!("{name} at {}: {error}\n{document:#}", error.instance_path());
    }
}

pub(crate) fn number(value: &Value) -> f64 {
    value.as_f64().unwrap_or_else(|| panic!("{value} is no number"))
}

pub(crate) fn numbers(value: &Value) -> Vec<f64> {
    value.as_array().unwrap().iter().map(number).collect()
}

pub(crate) fn assert_arrived(run: &Value) {
    assert_eq!(run["reached"], true, "{run}");
    assert!(number(&run["error"]["position"]) < END_POSITION, "{run}");
    assert!(number(&run["error"]["heading"]) < END_HEADING, "{run}");
    assert_eq!(run["collisions"], 0, "{run}");
    assert_eq!(run["link"]["lost"], 0, "{run}");
    assert_eq!(numbers(&run["true_pose"]).len(), 3);
    assert!(number(&run["min_clearance"]) > 0.0);
}

pub(crate) fn read_json(path: &Path) -> Value {
    serde_json::from_str(&std::fs::read_to_string(path).unwrap()).unwrap()
}

/// Exit code, error code, and the arguments that must lead to them.
pub(crate) fn assert_refused(exit: i32, code: &str, arguments: &[&str]) {
    let output = wmr(&[arguments, &["--json"]].concat());
    assert_eq!(output.status.code(), Some(exit), "{arguments:?}: {output:?}");
    let document = document(&output);
    assert_valid("error", &document);
    let error = &document["error"];
    assert_eq!(error["code"], code, "{arguments:?}: {error}");
    assert!(
        error["message"].as_str().unwrap().len() > 5 && error["help"].as_str().unwrap().len() > 5,
        "{error}"
    );
    let output = wmr(arguments);
    assert_eq!(output.status.code(), Some(exit));
    assert!(output.stdout.is_empty(), "talk on standard output: {output:?}");
    assert!(!output.stderr.is_empty());
}

pub(crate) fn write(folder: &tempfile::TempDir, name: &str, text: &str) -> String {
    let path = folder.path().join(name);
    std::fs::write(&path, text).unwrap();
    path.to_str().unwrap().to_owned()
}

/// A floor of 2 m by 1 m without obstacles, with `ends` as its start and goal.
pub(crate) fn floor(ends: &str) -> String {
    format!(r#"{{"format":"wmr-scene/1","arena":{{"width":2,"height":1}},"obstacles":[],{ends}}}"#)
}

pub(crate) const ENDS: &str = r#""start":[0.6,0.5,0],"goal":[1.4,0.5]"#;
