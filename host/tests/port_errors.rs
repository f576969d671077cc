//! Ports behind which no robot of ours is, or none that drives: each has an error of its own that helps.
#![allow(clippy::unwrap_used, clippy::panic, reason = "helpers of tests fail as tests do")]
#![cfg(unix)]

use hil_sim::pty::Pty;
use protocol::frame::{Decoder, Header, MAX_FRAME, encode};
use protocol::message::{
    Board, Command as Asked, MAX_LEGS, PROTOCOL_VERSION, Report, ResetCause, RobotHello,
};
use protocol::parameters::Parameters;
use protocol::schema::SCHEMA_HASH;
use serde_json::Value;
use std::io::{Read, Write};
use std::path::Path;
use std::process::Command;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Duration;

const SCENE: &str = r#"{"format":"wmr-scene/1","arena":{"width":2,"height":1},"obstacles":[],"start":[0.3,0.5,0],"goal":[0.8,0.5]}"#;

/// How `wmr drive` fails on `port`: its exit code, and its error's code and help.
fn failure(folder: &Path, port: &str) -> (i32, String, String) {
    let scene = folder.join("scene.json");
    std::fs::write(&scene, SCENE).unwrap();
    let mut command = Command::new(env!("CARGO_BIN_EXE_wmr"));
    command.arg("drive").arg(scene).args(["--port", port, "--json"]);
    let output = command.output().unwrap();
    let document: Value = serde_json::from_slice(&output.stdout).unwrap();
    let text = |name| document["error"][name].as_str().unwrap().to_owned();
    (output.status.code().unwrap(), text("code"), text("help"))
}

/// How it fails on a pseudo-terminal where `answer` says what comes back for some bytes.
fn failure_behind(mut answer: impl FnMut(&[u8]) -> Vec<u8> + Send) -> (i32, String, String) {
    let folder = tempfile::tempdir().unwrap();
    let link = folder.path().join("port");
    let mut pty = Pty::open(Some(&link)).unwrap();
    let over = AtomicBool::new(false);
    std::thread::scope(|scope| {
        scope.spawn(|| {
            let mut buffer = [0; 256];
            while !over.load(Ordering::SeqCst) {
                match pty.read(&mut buffer) {
                    // Who is gone does not hear the rest.
                    Ok(length) => drop(pty.write(&answer(&buffer[..length]))),
                    Err(_) => std::thread::sleep(Duration::from_millis(1)),
                }
            }
        });
        let failure = failure(folder.path(), link.to_str().unwrap());
        over.store(true, Ordering::SeqCst);
        failure
    })
}

#[test]
fn a_port_that_is_not_there() {
    let folder = tempfile::tempdir().unwrap();
    let nowhere = folder.path().join("nowhere");
    let (exit, code, help) = failure(folder.path(), nowhere.to_str().unwrap());
    assert_eq!((exit, code.as_str()), (5, "port.missing"));
    assert!(help.contains("wmr ports"), "{help}");
}

#[test]
fn nobody_answers() {
    let (exit, code, help) = failure_behind(|_| Vec::new());
    assert_eq!((exit, code.as_str()), (6, "link.silent"));
    assert!(help.contains("right port"), "{help}");
}

#[test]
fn another_device_answers() {
    let (exit, code, help) = failure_behind(|_| b"ok\r\n".to_vec());
    assert_eq!((exit, code.as_str()), (6, "link.not_a_robot"));
    assert!(help.contains("another firmware"), "{help}");
}

#[test]
fn another_firmware_answers() {
    let mut decoder = Decoder::default();
    let (exit, code, help) = failure_behind(|bytes| {
        let mut wire = Vec::new();
        for byte in bytes {
            let Some(Ok((_, Asked::Hello(host)))) = decoder.push::<Asked>(*byte) else { continue };
            let hello = RobotHello {
                version: PROTOCOL_VERSION + 1,
                schema: !SCHEMA_HASH,
                host_nonce: host.nonce,
                nonce: 9,
                board: Board::Pico,
                firmware: [9, 9, 9],
                git: 0,
                limits: Parameters::default().limits(),
                max_legs: MAX_LEGS as u16,
                driven: None,
                reset: ResetCause::PowerOn,
            };
            let mut frame = [0; MAX_FRAME];
            let length = encode(&Header::default(), &Report::Hello(hello), &mut frame).unwrap();
            wire.extend_from_slice(&frame[..length]);
        }
        wire
    });
    assert_eq!((exit, code.as_str()), (6, "link.version"));
    assert!(help.contains("flash"), "{help}");
}
