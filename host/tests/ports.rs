//! `wmr sim` behind a pseudo-terminal and a socket, and `wmr drive` through them in real time.
#![allow(clippy::unwrap_used, clippy::panic, reason = "helpers of tests fail as tests do")]
#![cfg(unix)]

mod program;
mod simulated;

use program::{assert_valid, document};
use serde_json::Value;
use simulated::{SHORT, Sim, behind_a_socket, distance, interrupt, wmr};
use std::io::{BufRead, BufReader, Write};
use std::process::{Command, Output, Stdio};

const PHOTO: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/assets/demo.png");

#[test]
fn the_demos_mission_through_a_pseudo_terminal() {
    let folder = tempfile::tempdir().unwrap();
    let (link, plan) = (folder.path().join("robot"), folder.path().join("plan.json"));
    let (link, plan) = (link.to_str().unwrap(), plan.to_str().unwrap());
    let planned = wmr(&[
        "plan",
        PHOTO,
        "--arena",
        "1.3x1.55",
        "--goal",
        "0.996,0.229",
        "--margin",
        "10mm",
        "-o",
        plan,
    ]);
    assert!({ planned }.output().unwrap().status.success());
    let (sim, _) = Sim::start(&["--pty", link, "--scene", plan]);

    let mut drive = wmr(&["drive", plan, "--port", link, "--json"]);
    let mut drive = drive.stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().unwrap();
    let mut line = String::new();
    BufReader::new(drive.stderr.take().unwrap()).read_line(&mut line).unwrap();
    assert!(line.contains("robot: "), "{line}");
    // The port answers one program at a time; whoever comes second is told so, and disturbs nothing.
    let refused = wmr(&["info", "--port", link, "--json"]).output().unwrap();
    assert_eq!(refused.status.code(), Some(5));
    assert_eq!(document(&refused)["error"]["code"], "port.busy");

    let driven = document(&drive.wait_with_output().unwrap());
    assert_eq!(driven["reached"], true, "{driven}");
    assert!(driven.get("true_pose").is_none(), "nobody can know it through a wire");
    let truth = sim.end();
    assert!(distance(&truth["true_pose"], 0.996, 0.229) < 0.005, "{truth}");
    assert_eq!(truth["collisions"], 0);
}

#[test]
fn ctrl_c_stops_the_robot_behind_a_socket_before_the_program_ends() {
    let folder = tempfile::tempdir().unwrap();
    let scene = folder.path().join("scene.json");
    std::fs::write(&scene, SHORT).unwrap();
    let scene = scene.to_str().unwrap();
    let (sim, line) = Sim::start(&["--tcp", "127.0.0.1:0", "--scene", scene]);
    let address = line
        .split_whitespace()
        .find(|word| word.starts_with("tcp://"))
        .unwrap()
        .trim_end_matches(';');

    let log = folder.path().join("log");
    let mut drive = wmr(&["drive", scene, "--port", address, "--json", "--log"])
        .arg(&log)
        .stdout(Stdio::piped())
        .spawn()
        .unwrap();
    // A second: half-way. If the machine is slow and it is not, the stop comes earlier; never later than the goal.
    std::thread::sleep(std::time::Duration::from_secs(1));
    assert!(drive.try_wait().unwrap().is_none(), "the drive takes more than a second");
    interrupt(&drive);
    let output = drive.wait_with_output().unwrap();
    assert_eq!(output.status.code(), Some(130), "{output:?}");
    let lines = std::fs::read_to_string(log.join("run.jsonl")).unwrap();
    assert!(lines.lines().count() > 1, "what was driven is kept: {lines}");
    assert_eq!(document(&output)["error"]["code"], "interrupted");

    let stopped = document(&wmr(&["stop", "--port", address, "--json"]).output().unwrap());
    assert_eq!(stopped["state"], "stopped");
    let truth = sim.end();
    assert!(distance(&truth["true_pose"], 0.8, 0.5) > 0.05, "{truth}");
}

#[test]
fn somebody_elses_physics_take_the_bases_place() {
    let folder = tempfile::tempdir().unwrap();
    let scene = folder.path().join("scene.json");
    std::fs::write(&scene, SHORT).unwrap();
    let mut sim = wmr(&["sim", "--lockstep", "127.0.0.1:0", "--tcp", "127.0.0.1:0"]);
    let mut sim = sim.stderr(Stdio::piped()).spawn().unwrap();
    let mut lines = BufReader::new(sim.stderr.take().unwrap()).lines().map(Result::unwrap);
    let port = |line: &str| {
        line.split(['/', ' ', ';']).find(|word| word.starts_with("127.")).unwrap().to_owned()
    };
    let (robot, physics) = (port(&lines.next().unwrap()), port(&lines.next().unwrap()));
    let (host, number) = physics.split_once(':').unwrap();
    let script = concat!(env!("CARGO_MANIFEST_DIR"), "/../tests/lockstep_base.py");
    let base = Command::new("python3")
        .args([script, host, number])
        .stdout(Stdio::piped())
        .spawn()
        .unwrap();

    let robot = format!("tcp://{robot}");
    let driven =
        wmr(&["drive", scene.to_str().unwrap(), "--port", &robot, "--json"]).output().unwrap();
    assert_eq!(document(&driven)["reached"], true, "{driven:?}");
    interrupt(&sim);
    assert!(sim.wait().unwrap().success());
    // The base's own frame: it began at its origin, half a metre before the goal.
    let pose = document(&base.wait_with_output().unwrap());
    assert!(distance(&pose, 0.5, 0.0) < 0.005, "{pose}");
}

#[test]
fn a_person_who_measures_is_asked_again_and_may_leave() {
    let folder = tempfile::tempdir().unwrap();
    let link = folder.path().join("robot");
    let link = link.to_str().unwrap();
    let (sim, _) = Sim::start(&["--pty", link]);
    let mut calibrate = wmr(&["calibrate", "base", "--side", "0.3", "--port", link, "--json"])
        .stdin(Stdio::piped())
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .unwrap();
    // Enter; no pose; no angle; the end of the straight; and then nothing more.
    calibrate.stdin.take().unwrap().write_all(b"\noops\n0.3,0\n0.3,0,0\n").unwrap();
    let output = calibrate.wait_with_output().unwrap();
    assert_eq!(output.status.code(), Some(2), "{output:?}");
    assert!(document(&output)["error"]["message"].as_str().unwrap().contains("input ended"));
    let asked = String::from_utf8(output.stderr).unwrap();
    assert!(asked.contains("is no place") && asked.contains("the angle is missing"), "{asked}");
    assert!(asked.contains("2 of 6"), "{asked}");
    let end = sim.end();
    assert!(distance(&end["true_pose"], 0.3, 0.0) < 0.005, "{end}");
}

#[test]
fn silent_physics_do_not_hold_the_program_that_is_interrupted() {
    let mut sim = wmr(&["sim", "--lockstep", "127.0.0.1:0", "--tcp", "127.0.0.1:0", "--json"]);
    let mut sim = sim.stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().unwrap();
    let lines = BufReader::new(sim.stderr.take().unwrap()).lines().map(Result::unwrap);
    let waiting = lines.take(2).last().unwrap();
    let mut physics =
        std::net::TcpStream::connect(waiting.split_whitespace().last().unwrap()).unwrap();
    // The first step has come: the program waits for its answer.
    BufReader::new(&mut physics).read_line(&mut String::new()).unwrap();
    interrupt(&sim);
    let output = sim.wait_with_output().unwrap();
    assert!(output.status.success(), "{output:?}");
    assert_valid("sim-lockstep", &document(&output));
}

#[test]
fn a_plan_that_begins_elsewhere_than_the_robot_stands_is_refused() {
    let folder = tempfile::tempdir().unwrap();
    let scene = folder.path().join("scene.json");
    std::fs::write(&scene, SHORT).unwrap();
    let scene = scene.to_str().unwrap();
    let (sim, port) = behind_a_socket(scene);
    let drive = |more: &[&str]| {
        let mut command = wmr(&[&["drive", scene, "--port", &port, "--json"], more].concat());
        command.env("XDG_STATE_HOME", folder.path()).output().unwrap()
    };
    assert_eq!(drive(&[]).status.code(), Some(0));
    let again = drive(&[]);
    assert_eq!(again.status.code(), Some(7), "{again:?}");
    let error = document(&again)["error"].clone();
    assert_eq!(error["code"], "robot.elsewhere");
    let [message, help] = ["message", "help"].map(|part| error[part].as_str().unwrap().to_owned());
    assert!(message.contains("(0.8") && message.contains("(0.300, 0.500)"), "{message}");
    assert!(help.contains("--start 0.8") && help.contains("--from-start"), "{help}");
    // The first way on: from where it stands, back to where it began.
    let place = help.split("--start ").nth(1).unwrap().split(';').next().unwrap();
    let back = drive(&["--start", place, "--goal", "0.3,0.5"]);
    assert_eq!(document(&back)["reached"], true, "{back:?}");
    // The second: it looks the other way now, and nobody turned it; it is believed all the same.
    assert_eq!(drive(&["--from-start"]).status.code(), Some(0));
    assert!(sim.end()["collisions"].is_number());
}

#[test]
fn a_robot_is_checked_by_whoever_looks_at_it() {
    let folder = tempfile::tempdir().unwrap();
    let link = folder.path().join("robot");
    let link = link.to_str().unwrap();
    let (sim, _) = Sim::start(&["--pty", link]);
    let check = |answers: &str| {
        let mut check = wmr(&["check", "base", "--port", link, "--json"])
            .stdin(Stdio::piped())
            .stdout(Stdio::piped())
            .stderr(Stdio::piped())
            .spawn()
            .unwrap();
        check.stdin.take().unwrap().write_all(answers.as_bytes()).unwrap();
        check.wait_with_output().unwrap()
    };
    // The simulated base is wired as drawn; whoever says otherwise gets what follows from it.
    let found = check("\nlf\n\nwhat\nrf\n\n");
    assert_eq!(found.status.code(), Some(0), "{found:?}");
    assert_valid("check-base", &document(&found));
    let wiring = document(&found)["wiring"].clone();
    assert_eq!(wiring["motor_reversed"], serde_json::json!([false, false]), "{wiring}");
    assert_eq!(wiring["motors_swapped"], false);
    assert!(String::from_utf8_lossy(&found.stderr).contains("is not one of them"));
    let numbers = document(&wmr(&["params", "--port", link, "--json"]).output().unwrap());
    assert_eq!(numbers["parameters"]["wiring-checked"], 1.0, "{numbers}");
    let mirrored = check("\nlf\n\nrb\n\n");
    assert_eq!(
        document(&mirrored)["wiring"]["encoder_reversed"],
        serde_json::json!([false, true]),
        "{mirrored:?}"
    );
    let none = check("\nlf\n\nn\n");
    assert_eq!(none.status.code(), Some(7), "{none:?}");
    assert_eq!(document(&none)["error"]["code"], "check.wiring");
    let early = check("\n");
    assert_eq!(early.status.code(), Some(2), "{early:?}");
    sim.end();
}

#[test]
fn a_robot_is_watched_through_a_pseudo_terminal_until_ctrl_c() {
    let folder = tempfile::tempdir().unwrap();
    let link = folder.path().join("robot");
    let link = link.to_str().unwrap();
    let (sim, _) = Sim::start(&["--pty", link]);
    let lines = |output: &Output| -> Vec<Value> {
        let text = String::from_utf8(output.stdout.clone()).unwrap();
        text.lines().map(|line| serde_json::from_str(line).unwrap()).collect()
    };
    let watched = wmr(&["monitor", "--port", link, "--json", "--for", "500ms"]).output().unwrap();
    assert_eq!(watched.status.code(), Some(0), "{watched:?}");
    let seen = lines(&watched);
    assert!((1..=6).contains(&seen.len()), "ten a second: {seen:?}");
    assert_eq!(seen[0]["counts"], serde_json::json!([0, 0]));
    assert_eq!((&seen[0]["state"], &seen[0]["skipped"][1]), (&"idle".into(), &0.into()));

    // Somebody turns the left wheel by hand: here, the check does.
    let mut check = wmr(&["check", "base", "--port", link, "--json"])
        .stdin(Stdio::piped())
        .stdout(Stdio::null())
        .stderr(Stdio::null())
        .spawn()
        .unwrap();
    check.stdin.take().unwrap().write_all(b"\nlf\n\nrf\n\n").unwrap();
    assert!(check.wait().unwrap().success());
    let mut watch =
        wmr(&["monitor", "--port", link, "--json"]).stdout(Stdio::piped()).spawn().unwrap();
    let mut stdout = BufReader::new(watch.stdout.take().unwrap());
    let mut line = String::new();
    stdout.read_line(&mut line).unwrap();
    let counts = serde_json::from_str::<Value>(&line).unwrap()["counts"].clone();
    // Two quarter turns of 360 counts each, and what the motor coasts.
    assert!(counts[0].as_i64().unwrap() >= 720, "{counts}");
    interrupt(&watch);
    assert_eq!(watch.wait().unwrap().code(), Some(0));
    let text = wmr(&["monitor", "--port", link, "--for", "1s"]).output().unwrap();
    let text = String::from_utf8(text.stdout).unwrap();
    assert!(text.starts_with("idle") && text.contains("battery"), "{text}");
    sim.end();
}
