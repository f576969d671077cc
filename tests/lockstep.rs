//! Somebody else's physics in the base's place.
#![allow(clippy::unwrap_used, reason = "helpers of tests fail as tests do")]

use hil_sim::base::{BaseParameters, TruePose, WheeledBase};
use hil_sim::in_process::InProcess;
use protocol::motion::{Leg, Pose, Timing};
use std::io::{BufRead, BufReader, Write};
use std::net::{TcpListener, TcpStream};
use std::time::Duration;
use wmr::geometry::Point;
use wmr::legs::{DEFAULT_LIMITS, LegOptions, to_legs};
use wmr::link::mission::MissionEvent;
use wmr_tests::lockstep::{drive_lockstep, on_the_python_base};
use wmr_tests::{drive, simulated_robot};

const START: Pose = Pose::new(0.0, 0.0, 0.0);

fn legs() -> Vec<Leg> {
    let way = [Point::new(0.0, 0.0), Point::new(0.4, 0.0), Point::new(0.4, 0.3)];
    let options = LegOptions { timing: Timing::Limits, reverse: false };
    to_legs(&way, 0.0, Some(0.0), &options, &DEFAULT_LIMITS)
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
    let (robot, step) = (InProcess::default(), Duration::from_millis(5));
    let believed = drive_lockstep(robot, stream, step, legs(), START);
    let (events, simulation) =
        drive(simulated_robot(START, 5), legs(), START, 30, |_, _| {}).unwrap();
    assert!(events.contains(&MissionEvent::Done(believed)), "{believed:?}");
    let (pose, truth) = (physics.join().unwrap(), simulation.truth().pose);
    let off = (pose.x - truth.x).abs().max((pose.y - truth.y).abs());
    assert!(off.max((pose.heading - truth.heading).abs()) < ROUNDING, "{pose:?} {truth:?}");
}

#[test]
fn the_python_base_reaches_the_goal() {
    let Some([x, y, heading]) = on_the_python_base(InProcess::default(), legs(), START) else {
        println!("no python3 here: the example is not tried");
        return;
    };
    // Two encoder counts of 0.15 mm, and what they turn the base by over 0.4 m.
    assert!((x - 0.4).hypot(y - 0.3) < 0.002 && heading.abs() < 0.005, "{x} {y} {heading}");
}
