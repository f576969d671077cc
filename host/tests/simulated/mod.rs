//! A running `wmr sim`, and the programs that talk to it.
#![allow(dead_code, reason = "each test file uses a part")]
#![allow(clippy::unwrap_used, clippy::panic, reason = "helpers of tests fail as tests do")]

use crate::program::{assert_valid, document};
use serde_json::Value;
use std::io::{BufRead, BufReader};
use std::process::{Child, Command, Stdio};

/// A drive of half a metre: long enough to be interrupted, short enough to wait for.
pub(crate) const SHORT: &str = r#"{"format":"wmr-scene/1","arena":{"width":2,"height":1},"obstacles":[[0.4,0.7,0.6,1]],"start":[0.3,0.5,0],"goal":[0.8,0.5]}"#;

pub(crate) fn wmr(arguments: &[&str]) -> Command {
    let mut command = Command::new(env!("CARGO_BIN_EXE_wmr"));
    command.args(arguments).env_remove("WMR_PORT");
    command
}

/// A running `wmr sim`, ended by Ctrl-C.
pub(crate) struct Sim {
    child: Child,
}

impl Sim {
    /// Starts one and waits until it says that it is there; returns that line too.
    pub(crate) fn start(arguments: &[&str]) -> (Self, String) {
        let mut child = wmr(&[&["sim", "--json"], arguments].concat())
            .stdout(Stdio::piped())
            .stderr(Stdio::piped())
            .spawn()
            .unwrap();
        let mut line = String::new();
        BufReader::new(child.stderr.take().unwrap()).read_line(&mut line).unwrap();
        assert!(line.contains("simulated robot at"), "{line}");
        (Self { child }, line)
    }

    pub(crate) fn end(self) -> Value {
        interrupt(&self.child);
        let output = self.child.wait_with_output().unwrap();
        assert!(output.status.success(), "{output:?}");
        let document = document(&output);
        assert_valid("sim", &document);
        document
    }
}

pub(crate) fn interrupt(child: &Child) {
    Command::new("kill").args(["-INT", &child.id().to_string()]).status().unwrap();
}

pub(crate) fn distance(pose: &Value, x: f64, y: f64) -> f64 {
    (pose[0].as_f64().unwrap() - x).hypot(pose[1].as_f64().unwrap() - y)
}

/// Starts a robot behind a socket; it, and the name of its port.
pub(crate) fn behind_a_socket(scene: &str) -> (Sim, String) {
    let (sim, line) = Sim::start(&["--tcp", "127.0.0.1:0", "--scene", scene]);
    let port = line.split_whitespace().find(|word| word.starts_with("tcp://")).unwrap();
    let port = port.trim_end_matches(';').to_owned();
    (sim, port)
}
