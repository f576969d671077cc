//! Missions that are cut short behind a real pseudo-terminal, and `--resume`.
#![allow(clippy::unwrap_used, clippy::panic, reason = "helpers of tests fail as tests do")]
#![cfg(unix)]

use hil_sim::base::{BaseParameters, TruePose, WheeledBase};
use hil_sim::in_process::InProcess;
use hil_sim::pty::Pty;
use hil_sim::realtime;
use hil_sim::simulation::Simulation;
use serde_json::Value;
use std::io::{self, Read, Write};
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Output, Stdio};
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Duration;
use tempfile::TempDir;

/// Past a box: up, along and down again.
const SCENE: &str = r#"{"format":"wmr-scene/1","arena":{"width":2,"height":1},"obstacles":[[0.8,0,1.1,0.45]],"start":[0.3,0.3,0],"goal":[1.6,0.3]}"#;
const GOAL: (f64, f64) = (1.6, 0.3);

/// As for any drive behind a wire.
const END_POSITION: f64 = 0.005;
/// After a restart: what the robot rolls between its last word and its restart, 20 ms at full speed, more.
const END_AFTER_RESTART: f64 = 0.015;

/// What is done to the robot.
enum Deed {
    /// Its processor starts again.
    Restart,
    /// Its cable is out for so long.
    Unplug(Duration),
    /// The program that drives it is killed.
    Kill,
}

/// A port to which nobody listens.
struct Nobody;

impl Read for Nobody {
    fn read(&mut self, _: &mut [u8]) -> io::Result<usize> {
        Err(io::ErrorKind::WouldBlock.into())
    }
}

impl Write for Nobody {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        Ok(bytes.len())
    }

    fn flush(&mut self) -> io::Result<()> {
        Ok(())
    }
}

/// A folder with plan and port, in which programs remember what they would in the user's.
struct Bench {
    folder: TempDir,
    plan: PathBuf,
    link: PathBuf,
    over: AtomicBool,
}

impl Bench {
    fn new() -> Self {
        let folder = tempfile::tempdir().unwrap();
        let (plan, link) = (folder.path().join("my plan.json"), folder.path().join("robot"));
        let bench = Self { folder, plan, link, over: AtomicBool::new(false) };
        bench.plan(SCENE, &bench.plan);
        bench
    }

    fn plan(&self, scene: &str, plan: &Path) {
        let file = self.folder.path().join("scene.json");
        std::fs::write(&file, scene).unwrap();
        let mut command = self.wmr(&["plan", file.to_str().unwrap(), "--margin", "10mm", "-o"]);
        assert!(command.arg(plan).output().unwrap().status.success());
    }

    fn wmr(&self, arguments: &[&str]) -> Command {
        let mut command = Command::new(env!("CARGO_BIN_EXE_wmr"));
        let state = self.folder.path().join("state");
        command.args(arguments).env_remove("WMR_PORT").env("XDG_STATE_HOME", state);
        command
    }

    fn drive(&self) -> Command {
        let plan = self.plan.to_str().unwrap();
        self.wmr(&["drive", plan, "--json", "--port", self.link.to_str().unwrap()])
    }

    /// Runs `test` beside a robot in real time, to which `deed` is done when it has come past `x`; then
    /// where it truly ended.
    fn run(&self, x: f64, deed: &Deed, test: impl FnOnce(Child)) -> TruePose {
        let start = TruePose { x: 0.3, y: 0.3, heading: 0.0 };
        let base = WheeledBase::new(BaseParameters::seeded(1), start);
        let mut robot = Simulation::new(InProcess::default(), base, None);
        let mut pty = Pty::open(Some(&self.link)).unwrap();
        let child = self.drive().stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().unwrap();
        let id = child.id();
        std::thread::scope(|scope| {
            let robot = scope.spawn(move || {
                let goes_on = || !self.over.load(Ordering::SeqCst);
                realtime::run(&mut robot, &mut pty, |robot| robot.truth().pose.x < x && goes_on())
                    .unwrap();
                match deed {
                    Deed::Restart => *robot.firmware_mut() = InProcess::new(Default::default(), 99),
                    Deed::Kill => kill(id),
                    Deed::Unplug(duration) => {
                        drop(pty);
                        let back = robot.now() + *duration;
                        realtime::run(&mut robot, &mut Nobody, |robot| robot.now() < back).unwrap();
                        pty = Pty::open(Some(&self.link)).unwrap();
                    }
                }
                realtime::run(&mut robot, &mut pty, |_| goes_on()).unwrap();
                robot.truth().pose
            });
            // However the test ends, the robot is to end too.
            let result = std::panic::catch_unwind(std::panic::AssertUnwindSafe(|| test(child)));
            self.over.store(true, Ordering::SeqCst);
            let pose = robot.join().unwrap();
            result.unwrap_or_else(|panic| std::panic::resume_unwind(panic));
            pose
        })
    }
}

fn kill(id: u32) {
    Command::new("kill").args(["-KILL", &id.to_string()]).status().unwrap();
}

fn document(output: &Output) -> Value {
    serde_json::from_slice(&output.stdout).unwrap_or_else(|error| panic!("{error}: {output:?}"))
}

fn from_goal(pose: TruePose) -> f64 {
    (pose.x - GOAL.0).hypot(pose.y - GOAL.1)
}

/// The indices of the legs that a run has driven.
fn driven(run: &Value) -> Vec<u64> {
    let legs = run["legs"].as_array().unwrap_or_else(|| panic!("{run}"));
    legs.iter().map(|leg| leg["index"].as_u64().unwrap()).collect()
}

#[test]
fn a_mission_whose_program_was_killed_goes_on_where_the_robot_waits() {
    let bench = Bench::new();
    let end = bench.run(0.7, &Deed::Kill, |child| {
        let killed = child.wait_with_output().unwrap();
        assert!(killed.stdout.is_empty() && killed.status.code().is_none(), "{killed:?}");

        let other = bench.folder.path().join("other.json");
        bench.plan(&SCENE.replace("[1.6,0.3]", "[1.6,0.4]"), &other);
        let link = bench.link.to_str().unwrap();
        let other = ["drive", other.to_str().unwrap(), "--json", "--port", link, "--resume"];
        let refused = bench.wmr(&other).output().unwrap();
        assert_eq!(refused.status.code(), Some(2), "{refused:?}");
        assert_eq!(document(&refused)["error"]["code"], "resume.other_plan");

        let run = document(&bench.drive().arg("--resume").output().unwrap());
        assert_eq!(run["reached"], true, "{run}");
        assert!(driven(&run).ends_with(&[1, 2]), "{run}");
    });
    assert!(from_goal(end) < END_POSITION, "{end:?}");
}

#[test]
fn a_mission_whose_robot_restarted_goes_on_by_the_command_that_the_error_names() {
    let bench = Bench::new();
    let end = bench.run(1.0, &Deed::Restart, |child| {
        let cut = child.wait_with_output().unwrap();
        assert_eq!(cut.status.code(), Some(6), "{cut:?}");
        let error = &document(&cut)["error"];
        assert_eq!(error["code"], "link.restarted");
        let message = error["message"].as_str().unwrap();
        assert!(
            message.contains("1 of 3 legs are driven, and it was last heard at ("),
            "{message}"
        );
        let help = error["help"].as_str().unwrap();
        let (_, command) = help.split_once("from where it stands: ").unwrap();
        assert!(command.ends_with("--resume"), "{command}");

        let state = bench.folder.path().join("state");
        let mut shell = Command::new("sh");
        shell.args(["-c", command]).env("XDG_STATE_HOME", &state).env_remove("WMR_PORT");
        let resumed = shell.output().unwrap();
        let run = document(&resumed);
        assert_eq!((&run["reached"], driven(&run)), (&true.into(), vec![1, 2]), "{run}");
        let talk = String::from_utf8(resumed.stderr).unwrap();
        assert!(talk.contains("the robot has restarted and lost its place"), "{talk}");

        // Driven to its end, the plan is forgotten by this computer; the robot has it still.
        assert!(std::fs::read_dir(state.join("wmr")).unwrap().next().is_none());
        let run = document(&bench.drive().arg("--resume").output().unwrap());
        assert!(driven(&run).is_empty() && run["reached"] == true, "{run}");
    });
    assert!(from_goal(end) < END_AFTER_RESTART, "{end:?}");
}

#[test]
fn a_cable_that_is_plugged_in_again_does_not_end_the_program() {
    let bench = Bench::new();
    let end = bench.run(0.7, &Deed::Unplug(Duration::from_millis(1500)), |child| {
        let output = child.wait_with_output().unwrap();
        let run = document(&output);
        assert_eq!((&run["reached"], driven(&run)), (&true.into(), vec![0, 1, 2]), "{run}");
        let talk = String::from_utf8(output.stderr).unwrap();
        assert!(talk.contains("the port is gone") && talk.contains("the port is back"), "{talk}");
    });
    assert!(from_goal(end) < END_POSITION, "{end:?}");
}

#[test]
fn what_nobody_remembers_is_not_resumed() {
    let bench = Bench::new();
    let plan = bench.plan.to_str().unwrap();
    let refused =
        bench.wmr(&["drive", plan, "--json", "--port", "sim", "--resume"]).output().unwrap();
    assert_eq!(refused.status.code(), Some(2), "{refused:?}");
    assert_eq!(document(&refused)["error"]["code"], "resume.nothing");
}
