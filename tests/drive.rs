//! Legs on the simulated base: where it ends, how long it takes, and what stops it.
#![allow(clippy::unwrap_used, reason = "helpers of tests fail as tests do")]

use hil_sim::base::TruePose;
use hil_sim::in_process::InProcess;
use hil_sim::simulation::Simulation;
use protocol::message::{Command, PauseReason, PlanRefusal, State};
use protocol::motion::{Leg, Pose, Timing};
use protocol::units::Seconds;
use std::time::Duration;
use wmr::geometry::Point;
use wmr::legs::{DEFAULT_LIMITS, LegOptions, duration, paper_timing, to_legs};
use wmr::link::LinkClient;
use wmr::link::mission::{Mission, MissionError, MissionEvent};
use wmr_tests::{POLL, drive, simulated_robot};

const LIMITS: LegOptions = LegOptions { timing: Timing::Limits, reverse: true };
const START: Pose = Pose::new(0.2, 0.2, 0.5);
const GOAL: Point = Point::new(0.4, 1.2);
const GOAL_HEADING: f64 = -2.0;

/// A few encoder counts (0.15 mm of rim each) on either wheel, and what they turn the base by.
const POSITION_TOLERANCE: f64 = 0.002;
const HEADING_TOLERANCE: f64 = 0.005;

fn legs(options: &LegOptions) -> Vec<Leg> {
    let way = [Point::new(0.2, 0.2), Point::new(0.9, 0.4), Point::new(1.0, 1.1), GOAL];
    to_legs(&way, START.heading.0.into(), Some(GOAL_HEADING), options, &DEFAULT_LIMITS)
}

fn assert_at_goal(pose: TruePose) {
    assert!(GOAL.distance(Point::new(pose.x, pose.y)) < POSITION_TOLERANCE, "{pose:?}");
    assert!((pose.heading - GOAL_HEADING).abs() < HEADING_TOLERANCE, "{pose:?}");
}

#[test]
fn a_mission_ends_at_its_goal_whatever_the_motors() {
    for seed in 0..10 {
        let legs = legs(&LIMITS);
        let planned = duration(&legs, &DEFAULT_LIMITS);
        let (events, simulation) =
            drive(simulated_robot(START, seed), legs, START, 60, |_, _| {}).unwrap();
        assert_at_goal(simulation.truth().pose);
        let ticks: u32 = events.iter().map(leg_ticks).sum();
        // Legs are solved again from where they really begin: some ticks more or less.
        assert!((f64::from(ticks) * 0.005 - planned).abs() < 0.1, "{ticks} {planned}");
    }
}

#[test]
fn a_mission_begins_where_it_says_however_irregularly_the_host_looks() {
    for seed in 0..300 {
        let mut random = fastrand::Rng::with_seed(seed);
        let robot = simulated_robot(START, seed);
        let (_, simulation) = drive(robot, legs(&LIMITS), START, 60, |client, _| {
            // A busy computer: up to 250 ms between two looks while the plan is under way.
            if client.port_mut().now() < Duration::from_secs(2) {
                let pause = Duration::from_millis(random.u64(0..250));
                client.port_mut().wait(pause).unwrap();
            }
        })
        .unwrap();
        assert_at_goal(simulation.truth().pose);
    }
}

#[test]
fn paper_legs_take_the_time_they_are_given() {
    let legs = legs(&LegOptions { timing: paper_timing(Seconds(12.0)), reverse: false });
    let (events, simulation) =
        drive(simulated_robot(START, 3), legs, START, 60, |_, _| {}).unwrap();
    assert_at_goal(simulation.truth().pose);
    let ticks: Vec<_> = events.iter().map(leg_ticks).filter(|ticks| *ticks > 0).collect();
    assert_eq!(ticks, [2400; 3]);
}

#[test]
fn a_plan_too_fast_for_the_wheels_moves_nothing() {
    let legs = legs(&LegOptions { timing: paper_timing(Seconds(3.0)), reverse: false });
    let mut poses = Vec::new();
    let end = drive(simulated_robot(START, 1), legs, START, 60, |client, _| {
        poses.push(client.port_mut().truth().pose);
    });
    assert!(
        matches!(end, Err(MissionError::Refused(PlanRefusal::Leg { index: 0, .. }))),
        "{end:?}"
    );
    assert!(poses.iter().all(|pose| *pose == poses[0]));
}

#[test]
fn a_stop_ends_on_the_path_within_the_limits() {
    let mut stop_pose = None;
    let end = drive(simulated_robot(START, 1), legs(&LIMITS), START, 60, |client, _| {
        if client.port_mut().now() > Duration::from_millis(1500) {
            client.stop();
            stop_pose.get_or_insert(client.port_mut().truth().pose);
        }
        if let Some(start) = stop_pose {
            let now = client.port_mut().truth().pose;
            let way = (now.x - start.x).hypot(now.y - start.y);
            // V²/2A = 0.1 m, and V for the 25 ms until the robot hears of it and a tick.
            assert!(way < 0.115, "{way}");
        }
    });
    assert!(matches!(end, Err(MissionError::Stopped)));
}

#[test]
fn a_paused_mission_goes_on_to_its_goal() {
    let (mut paused, mut resumed) = (false, false);
    let (_, simulation) =
        drive(simulated_robot(START, 2), legs(&LIMITS), START, 60, |client, _| {
            let now = client.port_mut().now();
            if now > Duration::from_secs(2) && !paused {
                paused = client.send(Command::Pause);
            }
            if now > Duration::from_secs(4) && !resumed {
                let state = client.telemetry().map(|telemetry| telemetry.state);
                assert_eq!(state, Some(State::Paused(PauseReason::Command)));
                resumed = client.send(Command::Resume);
            }
        })
        .unwrap();
    assert_at_goal(simulation.truth().pose);
}

#[test]
fn a_silent_host_stops_the_robot_until_it_speaks_again() {
    let mut silent = false;
    let (_, simulation) =
        drive(simulated_robot(START, 2), legs(&LIMITS), START, 60, |client, _| {
            if client.port_mut().now() > Duration::from_millis(1500) && !silent {
                silent = true;
                // 0.3 s until the silence counts, 0.5 s to brake from V with A.
                client.port_mut().wait(Duration::from_millis(900)).unwrap();
                let rest = client.port_mut().truth().pose;
                client.port_mut().wait(Duration::from_millis(90)).unwrap();
                let later = client.port_mut().truth().pose;
                let moved = (later.x - rest.x).hypot(later.y - rest.y);
                // What the wheel loops still turn to stand where they should: three encoder counts.
                assert!(moved < 5e-4, "{moved}");
            }
            if silent
                && client
                    .telemetry()
                    .is_some_and(|t| t.state == State::Paused(PauseReason::Silence))
            {
                client.send(Command::Resume);
            }
        })
        .unwrap();
    assert_at_goal(simulation.truth().pose);
}

/// Drives until `until` or to the end; whether it has ended.
fn drive_until(
    client: &mut LinkClient<Simulation<InProcess>>,
    until: Duration,
) -> Result<bool, MissionError> {
    let mut mission = Mission::new(legs(&LIMITS), START);
    while client.port_mut().now() < until {
        let now = client.port_mut().now();
        let events = mission.step(client, now)?;
        if events.iter().any(|event| matches!(event, MissionEvent::Done(_))) {
            return Ok(true);
        }
        client.port_mut().wait(POLL).unwrap();
    }
    Ok(false)
}

#[test]
fn a_host_that_died_may_be_followed_by_one_with_the_same_plan() {
    for (died, gap) in [(900, 0), (900, 150), (900, 2000), (2000, 10), (3000, 400)] {
        let mut first = LinkClient::new(simulated_robot(START, 2), 42);
        assert!(!drive_until(&mut first, Duration::from_millis(died)).unwrap());
        let mut port = first.into_port();
        port.wait(Duration::from_millis(gap)).unwrap();
        let mut second = LinkClient::new(port, 43);
        let end = drive_until(&mut second, Duration::from_secs(60));
        assert!(matches!(end, Ok(true)), "died at {died}, followed {gap} ms later: {end:?}");
    }
}

fn leg_ticks(event: &MissionEvent) -> u32 {
    if let MissionEvent::LegDone(result) = event { result.ticks } else { 0 }
}
