//! The loop on the simulated robot: to the goal, stopped, held, and with other legs on the way.

use super::*;
use crate::geometry::Point;
use crate::legs::{DEFAULT_LIMITS, LegOptions, to_legs};
use hil_sim::base::{BaseParameters, TruePose, WheeledBase};
use hil_sim::in_process::InProcess;
use hil_sim::simulation::Simulation;
use protocol::message::{PauseReason, State};
use std::cell::Cell;

fn client() -> LinkClient<Simulation<InProcess>> {
    let start = TruePose { x: 0.2, y: 0.5, heading: 0.0 };
    let base = WheeledBase::new(BaseParameters::seeded(1), start);
    LinkClient::new(Simulation::new(InProcess::default(), base, None), 1)
}

/// A path of 0.6 m in one leg.
fn mission() -> Mission {
    let path = [Point::new(0.2, 0.5), Point::new(0.8, 0.5)];
    let options = LegOptions { timing: protocol::motion::Timing::Limits, reverse: false };
    Mission::new(to_legs(&path, 0.0, None, &options, &DEFAULT_LIMITS), Pose::new(0.2, 0.5, 0.0))
}

/// Within 10 mm of the goal by the robot's own word: what a drive is allowed to miss.
#[test]
fn a_mission_is_driven_to_its_goal() {
    let (mut client, mut mission, mut done) = (client(), mission(), 0);
    let pose = drive(
        &mut client,
        &mut mission,
        || false,
        |event, _| {
            done += u32::from(matches!(event, DriveEvent::Mission(MissionEvent::LegDone(_))));
        },
    )
    .unwrap();
    assert_eq!(done, 1);
    assert!((pose.x.0 - 0.8).abs() < 0.01 && (pose.y.0 - 0.5).abs() < 0.01, "{pose:?}");
}

#[test]
fn a_stop_ends_it_on_the_way() {
    let (mut client, mut mission) = (client(), mission());
    let stop = Cell::new(false);
    let result = drive(
        &mut client,
        &mut mission,
        || stop.get(),
        |_, mission| {
            stop.set(mission.progress().pose.x.0 > 0.4);
        },
    );
    assert!(matches!(result, Err(DriveError::Stopped)), "{result:?}");
    let reached = mission.progress().pose.x.0;
    assert!((0.4..0.7).contains(&reached), "{reached}");
    assert_eq!(mission.progress().next, 0);
}

#[test]
fn a_pause_holds_the_robot_until_it_is_to_drive_on() {
    let (mut client, mut mission) = (client(), mission());
    let (wish, held, paused) = (Cell::new(Wish::Drive), Cell::new(0), Cell::new(0.0));
    let pose = drive_as_wished(
        &mut client,
        &mut mission,
        || wish.get(),
        |event, mission| {
            let DriveEvent::Mission(MissionEvent::Telemetry(telemetry)) = event else { return };
            let x = mission.progress().pose.x.0;
            if x > 0.4 && held.get() == 0 {
                wish.set(Wish::Pause);
            }
            if telemetry.state == State::Paused(PauseReason::Command)
                && telemetry.wheels == protocol::motion::WheelSpeeds::default()
            {
                if held.get() > 0 {
                    assert!((x - paused.get()).abs() < 1e-3, "moves while paused");
                }
                paused.set(x);
                held.set(held.get() + 1);
            }
            if held.get() == 50 {
                wish.set(Wish::Drive);
            }
        },
    )
    .unwrap();
    assert!(held.get() >= 50 && paused.get() < 0.7, "{held:?} {paused:?}");
    assert!((pose.x.0 - 0.8).abs() < 0.01, "{pose:?}");
}

/// The second leg is replaced while the first is driven, and again when it is too late.
#[test]
fn legs_not_yet_begun_are_replaced_while_the_robot_drives() {
    let options = LegOptions { timing: protocol::motion::Timing::Limits, reverse: false };
    let to = |path: &[Point]| to_legs(path, 0.0, None, &options, &DEFAULT_LIMITS);
    let corner = Point::new(0.6, 0.5);
    let legs = to(&[Point::new(0.2, 0.5), corner, Point::new(0.6, 1.0)]);
    let others = to(&[corner, Point::new(0.9, 0.5), Point::new(0.9, 0.2)]);
    let (mut client, mut driver) = (client(), Driver::default());
    let mut mission = Mission::new(legs, Pose::new(0.2, 0.5, 0.0));
    let (mut replaced, mut tries, mut done) = (0, 0, None);
    while done.is_none() {
        let asked = mission.progress().pose.x.0 > 0.4 && tries == 0;
        if asked {
            assert!(mission.replace(&others) && !mission.replace(&others));
            tries += 1;
        }
        done = driver
            .step(&mut client, &mut mission, &|| Wish::Drive, &mut |event, _| {
                let is = matches!(event, DriveEvent::Mission(MissionEvent::Replaced { end: 3 }));
                replaced += u32::from(is);
            })
            .unwrap();
        client.port_mut().wait(POLL_INTERVAL).unwrap();
    }
    assert_eq!((replaced, mission.legs().len(), mission.progress().next), (1, 3, 3));
    let pose = done.unwrap();
    assert!((pose.x.0 - 0.9).abs() < 0.01 && (pose.y.0 - 0.2).abs() < 0.01, "{pose:?}");
}

#[test]
fn legs_that_do_not_follow_the_one_under_way_are_not_taken() {
    let options = LegOptions { timing: protocol::motion::Timing::Limits, reverse: false };
    let apart = [Point::new(0.3, 0.3), Point::new(0.3, 0.9)];
    let apart = to_legs(&apart, 0.0, None, &options, &DEFAULT_LIMITS);
    let (mut client, mut driver) = (client(), Driver::default());
    let (mut mission, mut refused, mut done) = (mission(), 0, None);
    while done.is_none() {
        if mission.progress().pose.x.0 > 0.4 && refused == 0 {
            mission.replace(&apart);
        }
        done = driver
            .step(&mut client, &mut mission, &|| Wish::Drive, &mut |event, _| {
                let is = matches!(event, DriveEvent::Mission(MissionEvent::NotReplaced(_)));
                refused += u32::from(is);
            })
            .unwrap();
        client.port_mut().wait(POLL_INTERVAL).unwrap();
    }
    assert_eq!((refused, mission.legs().len()), (1, 1));
    assert!((done.unwrap().x.0 - 0.8).abs() < 0.01, "drives what it had");
}

#[test]
fn waiting_ends_when_cancelled() {
    let mut client = client();
    let robot = wait_for(
        &mut client,
        || false,
        |client, now| {
            client.poll(now)?;
            Ok::<_, LinkError>(client.robot().copied())
        },
    );
    assert!(robot.unwrap().is_some());
    let never = |_: &mut LinkClient<Simulation<InProcess>>, _| Ok::<Option<()>, LinkError>(None);
    assert_eq!(wait_for(&mut client, || true, never).unwrap(), None);
}
