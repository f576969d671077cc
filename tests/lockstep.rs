//! Somebody else's physics in the base's place.
#![allow(clippy::unwrap_used, reason = "helpers of tests fail as tests do")]

use hil_sim::base::{BaseParameters, TruePose, WheeledBase};
use hil_sim::in_process::InProcess;
use hil_sim::lockstep::Lockstep;
use host::geometry::Point;
use host::legs::{DEFAULT_LIMITS, LegOptions, to_legs};
use host::link::LinkClient;
use host::link::mission::{Mission, MissionEvent};
use protocol::motion::{Leg, Pose, Timing};
use std::io::{BufRead, BufReader, Write};
use std::net::{TcpListener, TcpStream};
use std::process::{Command, Stdio};
use std::time::Duration;
use tests::{POLL, drive, simulated_robot};

const START: Pose = Pose::new(0.0, 0.0, 0.0);

fn legs() -> Vec<Leg> {
    let way = [Point::new(0.0, 0.0), Point::new(0.4, 0.0), Point::new(0.4, 0.3)];
    let options = LegOptions { timing: Timing::Limits, reverse: false };
    to_legs(&way, 0.0, Some(0.0), &options, &DEFAULT_LIMITS)
}

/// Drives the legs on whatever answers at `stream`; where the robot believes it ended.
fn drive_lockstep(stream: TcpStream, step: Duration) -> Pose {
    let lockstep = Lockstep::new(InProcess::default(), stream, step).unwrap();
    let mut client = LinkClient::new(lockstep, 42);
    let mut mission = Mission::new(legs(), START);
    loop {
        let now = client.port_mut().now();
        assert!(now < Duration::from_secs(30), "still driving");
        for event in mission.step(&mut client, now).unwrap() {
            if let MissionEvent::Done(pose) = event {
                return pose;
            }
        }
        client.port_mut().wait(POLL).unwrap();
    }
}

/// A duty read from JSON may differ in its last place; over some thousand steps that stays far below.
const ROUNDING: f64 = 1e-9;

/// The simulator's own base behind the socket: the same mission.
#[test]
fn lockstep_drives_as_the_simulation_does() {
    let listener = TcpListener::bind("127.0.0.1:0").unwrap();
    let address = listener.local_addr().unwrap();
    let physics = std::thread::spawn(move || {
        let stream = TcpStream::connect(address).unwrap();
        stream.set_nodelay(true).unwrap();
        let mut base = WheeledBase::new(BaseParameters::seeded(5), TruePose::default());
        let mut lines = BufReader::new(stream.try_clone().unwrap());
        let (mut line, mut stream) = (String::new(), stream);
        while lines.read_line(&mut line).unwrap() > 0 {
            let step: serde_json::Value = serde_json::from_str(&line).unwrap();
            let duty = [0, 1].map(|wheel| step["duty"][wheel].as_f64().unwrap());
            base.step(duty, 0.005);
            let [left, right] = base.counts();
            writeln!(stream, "{{\"counts\":[{left},{right}]}}").unwrap();
            line.clear();
        }
        base.pose()
    });
    let (stream, _) = listener.accept().unwrap();
    let believed = drive_lockstep(stream, Duration::from_millis(5));
    let (events, simulation) =
        drive(simulated_robot(START, 5), legs(), START, 30, |_, _| {}).unwrap();
    assert!(events.contains(&MissionEvent::Done(believed)), "{believed:?}");
    let (pose, truth) = (physics.join().unwrap(), simulation.truth().pose);
    let off = (pose.x - truth.x).abs().max((pose.y - truth.y).abs());
    assert!(off.max((pose.heading - truth.heading).abs()) < ROUNDING, "{pose:?} {truth:?}");
}

#[test]
fn the_python_base_reaches_the_goal() {
    if Command::new("python3").arg("--version").output().is_err() {
        println!("no python3 here: the example is not tried");
        return;
    }
    let listener = TcpListener::bind("127.0.0.1:0").unwrap();
    let port = listener.local_addr().unwrap().port().to_string();
    let script = concat!(env!("CARGO_MANIFEST_DIR"), "/lockstep_base.py");
    let base = Command::new("python3")
        .args([script, "127.0.0.1", &port])
        .stdout(Stdio::piped())
        .spawn()
        .unwrap();
    let (stream, _) = listener.accept().unwrap();
    drive_lockstep(stream, Duration::from_millis(1));
    let printed = base.wait_with_output().unwrap().stdout;
    let [x, y, heading]: [f64; 3] = serde_json::from_slice(&printed).unwrap();
    // Two encoder counts of 0.15 mm, and what they turn the base by over 0.4 m.
    assert!((x - 0.4).hypot(y - 0.3) < 0.002 && heading.abs() < 0.005, "{x} {y} {heading}");
}
