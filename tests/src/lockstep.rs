//! A robot on somebody else's physics, in virtual time.

use crate::POLL;
use hil_sim::lockstep::Lockstep;
use hil_sim::simulation::Firmware;
use protocol::motion::{Leg, Pose};
use std::net::{TcpListener, TcpStream};
use std::process::{Command, Stdio};
use std::time::Duration;
use wmr::link::LinkClient;
use wmr::link::mission::{Mission, MissionEvent};

/// Drives `legs` with `robot` on whatever answers at `stream`; where the robot believes it ended.
///
/// # Panics
/// If it has not ended after half a minute.
pub fn drive_lockstep<B: Firmware>(
    robot: B,
    stream: TcpStream,
    step: Duration,
    legs: Vec<Leg>,
    start: Pose,
) -> Pose {
    let mut client = LinkClient::new(Lockstep::new(robot, stream, step).unwrap(), 42);
    let mut mission = Mission::new(legs, start);
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

/// Drives `legs` with `robot` on the example in Python; x, y and heading where that base says it ended,
/// or none without Python.
///
/// # Panics
/// If the mission or the example fails.
pub fn on_the_python_base<B: Firmware>(robot: B, legs: Vec<Leg>, start: Pose) -> Option<[f64; 3]> {
    Command::new("python3").arg("--version").output().ok()?;
    let listener = TcpListener::bind("127.0.0.1:0").unwrap();
    let port = listener.local_addr().unwrap().port().to_string();
    let script = concat!(env!("CARGO_MANIFEST_DIR"), "/lockstep_base.py");
    let base = Command::new("python3")
        .args([script, "127.0.0.1", &port])
        .stdout(Stdio::piped())
        .spawn()
        .unwrap();
    let (stream, _) = listener.accept().unwrap();
    drive_lockstep(robot, stream, Duration::from_millis(1), legs, start);
    let printed = base.wait_with_output().unwrap().stdout;
    Some(serde_json::from_slice(&printed).unwrap())
}
