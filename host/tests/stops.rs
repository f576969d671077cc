//! A second `wmr stop` while another program has the robot's port: whatever that does, it stops the robot and says so.
#![allow(clippy::unwrap_used, clippy::panic, reason = "helpers of tests fail as tests do")]
#![cfg(unix)]

mod program;
mod simulated;

use program::{assert_valid, document};
use simulated::{SHORT, Sim, behind_a_socket, distance, wmr};
use std::io::{BufRead, BufReader, Write};
use std::path::Path;
use std::process::{Child, ChildStderr, Command, Output, Stdio};

#[test]
fn a_second_program_stops_the_robot_that_the_first_one_drives() {
    let folder = tempfile::tempdir().unwrap();
    let (scene, link) = (folder.path().join("scene.json"), folder.path().join("robot"));
    std::fs::write(&scene, SHORT).unwrap();
    let (scene, link) = (scene.to_str().unwrap(), link.to_str().unwrap());
    let state = folder.path().join("state");
    for by_socket in [true, false] {
        let (sim, port) = if by_socket {
            behind_a_socket(scene)
        } else {
            (Sim::start(&["--pty", link, "--scene", scene]).0, link.to_owned())
        };
        let run = |words: &[&str]| {
            let mut command = wmr(words);
            command.args(["--port", &port, "--json"]).env("XDG_STATE_HOME", &state);
            command
        };
        let mut drive = run(&["drive", scene]);
        let mut drive = drive.stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().unwrap();
        let mut line = String::new();
        BufReader::new(drive.stderr.take().unwrap()).read_line(&mut line).unwrap();
        assert!(line.contains("robot: "), "{line}");
        // It has opened its socket a moment after it has greeted the robot.
        while !std::fs::read_dir(state.join("wmr")).is_ok_and(|mut files| {
            files.any(|file| file.unwrap().path().extension().is_some_and(|end| end == "sock"))
        }) {
            assert!(drive.try_wait().unwrap().is_none(), "it still drives");
        }
        let busy = run(&["info"]).output().unwrap();
        assert_eq!(document(&busy)["error"]["code"], "port.busy", "{busy:?}");
        assert_eq!(busy.status.code(), Some(5));
        let stopped = run(&["stop"]).output().unwrap();
        assert_eq!(stopped.status.code(), Some(0), "{stopped:?}");
        assert_eq!(document(&stopped)["state"], "stopped");
        assert_valid("stop", &document(&stopped));
        let driven = drive.wait_with_output().unwrap();
        assert_eq!(driven.status.code(), Some(7), "{driven:?}");
        assert_eq!(document(&driven)["error"]["code"], "robot.stopped");
        let again = run(&["stop"]).output().unwrap();
        assert_eq!(document(&again)["state"], "stopped", "nobody drives it now: {again:?}");
        assert!(distance(&sim.end()["true_pose"], 0.8, 0.5) > 0.05);
    }
}

/// The robot behind a pseudo-terminal, and programs of one user that talk to it.
struct Bench {
    folder: tempfile::TempDir,
    sim: Sim,
}

impl Bench {
    fn new() -> Self {
        let folder = tempfile::tempdir().unwrap();
        let (sim, _) = Sim::start(&["--pty", folder.path().join("robot").to_str().unwrap()]);
        Self { folder, sim }
    }

    fn path(&self, name: &str) -> String {
        self.folder.path().join(name).to_str().unwrap().to_owned()
    }

    fn command(&self, words: &[&str]) -> Command {
        let mut command = wmr(words);
        command
            .args(["--port", &self.path("robot"), "--json"])
            .env("XDG_STATE_HOME", self.path("state"))
            .stdin(Stdio::piped())
            .stdout(Stdio::piped())
            .stderr(Stdio::piped());
        command
    }

    /// A program, run until it says `words`.
    fn started(
        &self,
        program: &[&str],
        input: &str,
        words: &str,
    ) -> (Child, BufReader<ChildStderr>) {
        let mut child = self.command(program).spawn().unwrap();
        child.stdin.as_mut().unwrap().write_all(input.as_bytes()).unwrap();
        let mut lines = BufReader::new(child.stderr.take().unwrap());
        let mut said = String::new();
        while !said.contains(words) {
            let before = said.len();
            lines.read_line(&mut said).unwrap();
            assert!(said.len() > before, "{words}: {said}");
        }
        (child, lines)
    }

    /// Ends `child` by a second program; how it ended.
    fn stop(&self, child: Child) -> Output {
        let stopped = self.command(&["stop"]).output().unwrap();
        assert_eq!(stopped.status.code(), Some(0), "{stopped:?}");
        assert_eq!(document(&stopped)["by"], "the program that has its port");
        child.wait_with_output().unwrap()
    }
}

fn assert_stopped(output: &Output) {
    assert_eq!(output.status.code(), Some(7), "{output:?}");
    assert_eq!(document(output)["error"]["code"], "robot.stopped");
}

#[test]
fn a_calibration_is_stopped_on_its_course_and_while_its_person_measures() {
    let bench = Bench::new();
    let calibrate = ["calibrate", "base", "--side", "0.5"];
    // Enter: it drives; the prompt for what was measured has no end of line, so the next never comes.
    let (driving, _lines) = bench.started(&calibrate, "\n", "1 of 6");
    assert_stopped(&bench.stop(driving));
    let (measuring, _lines) = bench.started(&calibrate, "\noops\n", "is no place");
    assert_stopped(&bench.stop(measuring));
    bench.sim.end();
}

#[test]
fn a_check_is_stopped_while_its_person_looks_and_leaves_the_old_wiring() {
    let bench = Bench::new();
    let mut mirrored = bench.command(&["check", "base"]);
    let mut mirrored = mirrored.spawn().unwrap();
    mirrored.stdin.take().unwrap().write_all(b"\nlf\n\nrb\n\n").unwrap();
    assert!(mirrored.wait().unwrap().success());
    let numbers = || document(&bench.command(&["params"]).output().unwrap());
    let before = numbers();
    let (looking, _lines) = bench.started(&["check", "base"], "\nwhat\n", "is not one of them");
    assert_stopped(&bench.stop(looking));
    assert_eq!(numbers(), before, "a check that was cut short has changed nothing");
    bench.sim.end();
}

#[test]
fn whoever_only_looks_passes_a_stop_on_too() {
    let bench = Bench::new();
    let (monitor, _lines) = bench.started(&["monitor"], "", "robot: ");
    let seen = bench.stop(monitor);
    assert_eq!(seen.status.code(), Some(7), "{seen:?}");
    let state = bench.command(&["monitor", "--for", "200ms"]).output().unwrap();
    let text = String::from_utf8(state.stdout).unwrap();
    assert!(text.lines().all(|line| line.contains(r#""state":"stopped""#)), "{text}");
    bench.sim.end();
}

#[cfg(feature = "dashboard")]
#[test]
fn a_page_passes_a_stop_on_and_stays_open() {
    let bench = Bench::new();
    let page = ["serve", "--addr", "127.0.0.1:0", "--no-open"];
    let (mut page, _lines) = bench.started(&page, "", "wmr at ");
    let socket_is_there = || {
        std::fs::read_dir(Path::new(&bench.path("state")).join("wmr")).is_ok_and(|mut files| {
            files.any(|file| file.unwrap().path().extension().is_some_and(|end| end == "sock"))
        })
    };
    while !socket_is_there() {
        assert!(page.try_wait().unwrap().is_none());
    }
    for _ in 0..2 {
        let stopped = bench.command(&["stop"]).output().unwrap();
        assert_eq!(document(&stopped)["by"], "the program that has its port", "{stopped:?}");
    }
    assert!(page.try_wait().unwrap().is_none(), "the page is still served");
    simulated::interrupt(&page);
    assert_eq!(page.wait().unwrap().code(), Some(130));
    bench.sim.end();
}
