//! Bases whose motors and encoders are connected in every possible way: the check finds out how, and
//! then the robot drives where it is told.
#![allow(clippy::unwrap_used, clippy::panic, reason = "helpers of tests fail as tests do")]

use hil_sim::base::{BaseParameters, TruePose, WheeledBase};
use hil_sim::in_process::InProcess;
use hil_sim::simulation::{Firmware, Simulation};
use protocol::message::Wheel;
use protocol::motion::{Leg, Pose, Timing};
use protocol::parameters::{Parameters, Wiring};
use std::collections::VecDeque;
use std::io;
use std::time::Duration;
use wmr::geometry::Point;
use wmr::legs::{DEFAULT_LIMITS, LegOptions, to_legs};
use wmr::link::LinkClient;
use wmr::link::mission::{Mission, MissionEvent};
use wmr::link::parameters::{Answer, Exchange, Request};
use wmr::wiring_check::{Turn, wiring};
use wmr_tests::POLL;

const START: Pose = Pose::new(0.0, 0.0, 0.0);

/// A robot between whose board and base the wires are not as drawn.
#[derive(Clone)]
struct Miswired {
    robot: InProcess,
    wires: Wires,
    /// What the wheels were last driven with.
    duty: [f64; 2],
}

/// How the builder has connected it, wheel by wheel; written apart from what the robot makes of it.
#[derive(Clone, Copy, Debug, Default)]
struct Wires {
    motors_crossed: bool,
    encoders_crossed: bool,
    /// By wheel: its motor turns backward on a positive duty.
    motor_backward: [bool; 2],
    /// By wheel: its encoder counts backward.
    encoder_backward: [bool; 2],
}

impl Wires {
    fn all() -> impl Iterator<Item = Self> {
        (0..64u8).map(|n| {
            let bit = |place: u8| n >> place & 1 == 1;
            Self {
                motors_crossed: bit(0),
                encoders_crossed: bit(1),
                motor_backward: [bit(2), bit(3)],
                encoder_backward: [bit(4), bit(5)],
            }
        })
    }
}

impl Firmware for Miswired {
    const STEP: Duration = InProcess::STEP;

    fn step(
        &mut self,
        received: &[u8],
        counts: [i32; 2],
        sent: &mut VecDeque<u8>,
    ) -> io::Result<[f64; 2]> {
        let Wires { motors_crossed, encoders_crossed, motor_backward, encoder_backward } =
            self.wires;
        let mut inputs = [0, 1]
            .map(|wheel| if encoder_backward[wheel] { -counts[wheel] } else { counts[wheel] });
        if encoders_crossed {
            inputs.reverse();
        }
        let mut duty = self.robot.step(received, inputs, sent)?;
        if motors_crossed {
            duty.reverse();
        }
        self.duty =
            [0, 1].map(|wheel| if motor_backward[wheel] { -duty[wheel] } else { duty[wheel] });
        Ok(self.duty)
    }
}

type Client = LinkClient<Simulation<Miswired>>;

fn client(wires: Wires) -> Client {
    let robot = Miswired { robot: InProcess::default(), wires, duty: [0.0; 2] };
    let base = WheeledBase::new(BaseParameters::seeded(1), TruePose::default());
    let mut client = LinkClient::new(Simulation::new(robot, base, None), 42);
    while client.robot().is_none() {
        poll(&mut client, |_| {});
    }
    client
}

fn poll(client: &mut Client, mut look: impl FnMut(&mut Client)) {
    let now = client.port_mut().now();
    client.poll(now).unwrap();
    look(client);
    client.port_mut().wait(POLL).unwrap();
}

/// Asks the robot, and looks at it until it has answered.
fn ask(client: &mut Client, request: Request, mut look: impl FnMut(&mut Client)) -> Answer {
    let mut exchange = Exchange::new(request);
    loop {
        let now = client.port_mut().now();
        if let Some(answer) = exchange.step(client, now).unwrap() {
            return answer;
        }
        look(client);
        client.port_mut().wait(POLL).unwrap();
    }
}

/// Turns the motor on an output; what somebody sees who looks at the wheels.
fn turn(client: &mut Client, outputs: Wheel) -> Turn {
    let mut seen = None;
    let answer = ask(client, Request::Turn(outputs), |client| {
        let [left, right] = client.port_mut().firmware_mut().duty;
        if left != 0.0 {
            seen = Some((Wheel::Left, left > 0.0));
        }
        if right != 0.0 {
            seen = Some((Wheel::Right, right > 0.0));
        }
    });
    let Answer::Turned(counts) = answer else { panic!("{answer:?}") };
    Turn { seen, counts }
}

fn check(client: &mut Client) -> Wiring {
    let turns = [Wheel::Left, Wheel::Right].map(|outputs| turn(client, outputs));
    let found = wiring(turns).unwrap();
    let parameters = Parameters { wiring: found, ..Parameters::default() };
    ask(client, Request::Change(parameters), |_| {});
    found
}

fn legs() -> Vec<Leg> {
    let way = [Point::new(0.0, 0.0), Point::new(0.6, 0.0), Point::new(0.6, 0.5)];
    let options = LegOptions { timing: Timing::Limits, reverse: false };
    to_legs(&way, 0.0, None, &options, &DEFAULT_LIMITS)
}

/// Drives; whether the robot says that it has arrived.
fn drive(client: &mut Client) -> bool {
    let mut mission = Mission::new(legs(), START);
    loop {
        let now = client.port_mut().now();
        match mission.step(client, now) {
            Err(_) => return false,
            Ok(events) if events.iter().any(|event| matches!(event, MissionEvent::Done(_))) => {
                return true;
            }
            Ok(_) => client.port_mut().wait(POLL).unwrap(),
        }
    }
}

#[test]
fn whatever_the_wires_a_checked_robot_drives_where_it_is_told() {
    for wires in Wires::all() {
        let mut client = client(wires);
        let found = check(&mut client);
        // The check has moved the base; what counts is the way from here on.
        client.port_mut().base_mut().place(TruePose::default());
        assert!(drive(&mut client), "{wires:?} {found:?}");
        let pose = client.port_mut().truth().pose;
        let error = (pose.x - 0.6).hypot(pose.y - 0.5);
        assert!(error < 0.005, "{wires:?} {found:?}: {error} m");
    }
}

#[test]
fn a_quarter_turn_is_one_and_ends_by_itself() {
    let mut client = client(Wires::default());
    let began = client.port_mut().now();
    let Turn { seen, counts: [left, right] } = turn(&mut client, Wheel::Right);
    assert_eq!(seen, Some((Wheel::Right, true)));
    // A quarter of 1440, and what a motor of 60 ms coasts from 6 rad/s: 0.4 rad are 90 counts.
    assert!((360..480).contains(&right) && left == 0, "{left} {right}");
    assert!(client.port_mut().now() - began < Duration::from_millis(1500));
    assert_eq!(client.port_mut().firmware_mut().duty, [0.0; 2]);
}

/// Wrong wires without a check: where the wheels' own counts can show it, the robot stops soon; where they
/// cannot, nothing but the check can.
#[test]
fn wrong_wires_that_odometry_can_see_cut_the_drive_within_60_degrees_and_10_cm() {
    let mirrored = |wires: &Wires| {
        !wires.encoders_crossed
            && !wires.motors_crossed
            && wires.motor_backward == wires.encoder_backward
    };
    let crossed = |wires: &Wires| {
        wires.encoders_crossed && wires.motors_crossed && {
            let [left, right] = wires.motor_backward;
            wires.encoder_backward == [left, right]
        }
    };
    for wires in Wires::all().filter(|wires| !mirrored(wires) && !crossed(wires)) {
        let mut client = client(wires);
        assert!(!drive(&mut client), "{wires:?}");
        let pose = client.port_mut().truth().pose;
        let distance = pose.x.hypot(pose.y);
        assert!(
            distance < 0.10 && pose.heading.abs().to_degrees() < 60.0,
            "{wires:?}: {distance} m, {}°",
            pose.heading.to_degrees()
        );
    }
}
