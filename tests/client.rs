//! A client in another language, written from the protocol's document, drives a leg through a
//! pseudo-terminal; and a cable that is pulled and plugged in again.
//! `cargo run --release -p wmr-tests --example replug_figures` does that a thousand times.
#![cfg(unix)]

use hil_sim::pty::Pty;
use hil_sim::realtime;
use std::process::{Command, Stdio};
use std::time::Duration;
use wmr_tests::link::ORIGIN;
use wmr_tests::replug::replug;
use wmr_tests::simulated_robot;

/// Two encoder counts on each wheel.
const TOLERANCE: f64 = 0.002;

#[test]
fn a_client_in_python_drives_a_leg() {
    let directory = tempfile::tempdir().unwrap();
    let link = directory.path().join("robot");
    let mut pty = Pty::open(Some(&link)).unwrap();
    let script = concat!(env!("CARGO_MANIFEST_DIR"), "/client.py");
    let mut python = Command::new("python3")
        .args([script, link.to_str().unwrap(), "0.3", "0.2"])
        .stdout(Stdio::piped())
        .spawn()
        .expect("python3 must be installed, as tests/run sees to");
    let mut simulation = simulated_robot(ORIGIN, 1);
    let mut status = None;
    realtime::run(&mut simulation, &mut pty, |_| {
        status = python.try_wait().unwrap();
        status.is_none()
    })
    .unwrap();
    assert!(status.unwrap().success());
    let truth = simulation.truth().pose;
    assert!((truth.x - 0.3).hypot(truth.y - 0.2) < TOLERANCE, "{truth:?}");
}

/// A machine that does much else at once may be slow; how quick it is, `replug_figures` measures.
const PATIENCE: Duration = Duration::from_secs(60);

#[test]
fn a_robot_is_back_after_its_cable_was_pulled() {
    let directory = tempfile::tempdir().unwrap();
    let times = replug(&directory.path().join("robot"), 5);
    assert!(times.len() == 5 && times.iter().all(|time| *time <= PATIENCE), "{times:?}");
}
