//! Robots that talk and do not get on, and peers that never stop sending: every drive of one ends with
//! its reason, within the planned time and 5 s, and none is taken for having reached its goal.
#![allow(clippy::unwrap_used, clippy::panic, reason = "helpers of tests fail as tests do")]

use protocol::message::{Fault, LegResult, PauseReason, Report, State};
use protocol::motion::{Leg, Limits, Pose, Timing};
use protocol::units::MetresPerSecond;
use std::time::Duration;
use wmr::geometry::Point;
use wmr::legs::{DEFAULT_LIMITS, LegOptions, to_legs};
use wmr::link::drive::{DriveError, TimedPort, drive, stop, wait_for};
use wmr::link::mission::Mission;
use wmr::link::parameters::{Exchange, ParameterError, Request};
use wmr::link::{Impossible, LinkClient, LinkError, MissionError};
use wmr_tests::hostile::{Behaviour, START, TALKER, Talker, Zeros};

/// What the contract allows beyond the planned time.
const PATIENCE: Duration = Duration::from_secs(5);
const GOAL: Pose = Pose::new(1.0, 0.5, std::f32::consts::FRAC_PI_2);

/// Two legs: a metre ahead, and half a metre to the left.
fn legs() -> Vec<Leg> {
    let way = [Point::new(0.0, 0.0), Point::new(1.0, 0.0), Point::new(1.0, 0.5)];
    let options = LegOptions { timing: Timing::Limits, reverse: false };
    to_legs(&way, 0.0, None, &options, &DEFAULT_LIMITS)
}

fn planned() -> Duration {
    let ticks: u32 = legs().iter().map(|leg| leg.ticks(&DEFAULT_LIMITS)).sum();
    Duration::from_millis(u64::from(ticks) * 5)
}

/// How a drive of such a robot ends; it must do so in time.
fn end_of(behaviour: Behaviour) -> MissionError {
    let mut client = LinkClient::new(Talker::new(behaviour), 42);
    let mut mission = Mission::new(legs(), START);
    let give_up = planned() + PATIENCE;
    let result = drive(&mut client, &mut mission, || false, |_, _| {});
    let took = client.port_mut().now();
    assert!(took < give_up, "{took:?}: {result:?}");
    match result {
        Err(DriveError::Mission(error)) => error,
        other => panic!("{other:?}"),
    }
}

fn leg_done(plan: u32, index: u16, ticks: u32, pose: Pose) -> Report {
    Report::LegDone(LegResult { plan, index, ticks, pose })
}

fn both_legs(plan: u32, ticks: u32) -> Vec<Report> {
    let corner = Pose::new(1.0, 0.0, 0.0);
    vec![
        leg_done(plan, 0, ticks, corner),
        leg_done(plan, 1, ticks, GOAL),
        Report::PlanDone { plan, end: 2, pose: GOAL },
    ]
}

#[test]
fn a_leg_that_never_ends_is_late() {
    let error = end_of(TALKER);
    assert!(matches!(error, MissionError::Late { leg: 0, .. }), "{error}");
}

#[test]
fn a_robot_that_does_not_drive_its_plan_is_believed() {
    let after = |state| end_of(Behaviour { after: (state, 0.0), ..TALKER });
    let error = after(State::Idle);
    assert!(matches!(error, MissionError::NotDriving { state: State::Idle, .. }), "{error}");
    let error = after(State::Paused(PauseReason::Silence));
    assert!(matches!(error, MissionError::NotDriving { .. }), "{error}");
    let error = after(State::Stopped);
    assert!(matches!(error, MissionError::Stopped), "{error}");
    let error = after(State::Faulted(Fault::Stall));
    assert!(matches!(error, MissionError::Fault { fault: Fault::Stall, .. }), "{error}");
}

#[test]
fn a_clock_that_stands_still_and_a_robot_that_does_not_answer_end_the_drive() {
    let error = end_of(Behaviour { ticks_a_beat: 0, ..TALKER });
    assert!(matches!(error, MissionError::Link(LinkError::ClockStopped(_))), "{error}");
    let error = end_of(Behaviour { acknowledges: false, ..TALKER });
    assert!(matches!(error, MissionError::Link(LinkError::NoAck(_))), "{error}");
    let error = end_of(Behaviour { before: (State::Stopped, 0.5), ..TALKER });
    assert!(matches!(error, MissionError::NeverRests(_)), "{error}");
}

#[test]
fn a_robot_that_no_plan_fits_is_refused() {
    let slow = Limits { speed: MetresPerSecond(f32::NAN), ..DEFAULT_LIMITS };
    for behaviour in [Behaviour { max_legs: 0, ..TALKER }, Behaviour { limits: slow, ..TALKER }] {
        let error = end_of(behaviour);
        assert!(matches!(error, MissionError::Unfit(_)), "{error}");
    }
}

#[test]
fn an_end_without_its_legs_is_none() {
    let after = |reports| {
        end_of(Behaviour { reports, after: (State::Idle, 0.0), place_after: GOAL, ..TALKER })
    };
    let error = after(|plan| vec![Report::PlanDone { plan, end: 2, pose: GOAL }]);
    assert!(
        matches!(error, MissionError::Impossible(Impossible::End { end: 2, next: 0, of: 2 })),
        "{error}"
    );
    let error = after(|plan| vec![leg_done(plan, u16::MAX, 400, GOAL)]);
    assert!(matches!(error, MissionError::Impossible(Impossible::Leg { .. })), "{error}");
    let error = after(|plan| both_legs(plan, u32::MAX));
    assert!(matches!(error, MissionError::Impossible(Impossible::Time { .. })), "{error}");
    let error = after(|plan| both_legs(plan ^ 1, 1));
    assert!(matches!(error, MissionError::NotDriving { .. }), "{error}");
}

#[test]
fn an_end_that_telemetry_contradicts_is_none() {
    let reports: fn(u32) -> Vec<Report> = |plan| both_legs(plan, 1);
    let far = Pose::new(90.0, -90.0, 0.0);
    for (after, place_after) in [
        ((State::Idle, 0.0), START),
        ((State::Idle, 0.0), far),
        ((State::Idle, 0.5), GOAL),
        ((State::Driving, 0.0), GOAL),
    ] {
        let error = end_of(Behaviour { reports, after, place_after, ..TALKER });
        assert!(matches!(error, MissionError::Disagrees { .. }), "{error}");
    }
    let mut client = LinkClient::new(
        Talker::new(Behaviour { reports, after: (State::Idle, 0.0), place_after: GOAL, ..TALKER }),
        42,
    );
    let end = drive(&mut client, &mut Mission::new(legs(), START), || false, |_, _| {});
    assert_eq!(end.unwrap(), GOAL, "where all agree, it has arrived");
}

#[test]
fn a_peer_that_sends_without_end_delays_neither_timers_nor_the_users_stop() {
    for flood in [&[0_u8] as &[u8], &[1, 2, 3, 255, 0, 17], &[1]] {
        let mut client = LinkClient::new(Talker::new(Behaviour { flood, ..TALKER }), 42);
        let stop_at = Duration::from_secs(1);
        let asked = std::cell::Cell::new(false);
        let result = wait_for(
            &mut client,
            || asked.get(),
            |client, now| {
                asked.set(now >= stop_at);
                client.poll(now)?;
                Ok::<Option<()>, LinkError>(None)
            },
        );
        assert!(matches!(result, Ok(None)), "{result:?}");
        assert!(client.port_mut().now() < stop_at + Duration::from_millis(10));
    }
    // From the first byte on, nothing but zeros.
    let mut client = LinkClient::new(Zeros(Duration::ZERO), 42);
    let error = drive(&mut client, &mut Mission::new(legs(), START), || false, |_, _| {});
    let Err(DriveError::Mission(MissionError::Link(LinkError::NotARobot { .. }))) = error else {
        panic!("{error:?}")
    };
    assert!(client.port_mut().0 < Duration::from_secs(3));
}

#[test]
fn questions_and_stops_end_too() {
    let mut client = LinkClient::new(Talker::new(TALKER), 42);
    let mut exchange = Exchange::new(Request::Read);
    let result = wait_for(&mut client, || false, |client, now| exchange.step(client, now));
    let Err(ParameterError::Link(LinkError::NoAnswer(_))) = result else { panic!("{result:?}") };
    assert!(client.port_mut().now() < PATIENCE);

    let rolling = Behaviour { before: (State::Stopped, 0.5), ..TALKER };
    let mut client = LinkClient::new(Talker::new(rolling), 42);
    let result = stop(&mut client, || false);
    assert!(matches!(result, Err(DriveError::StopUnconfirmed)), "{result:?}");
    assert!(client.port_mut().now() < PATIENCE);
    let resting = Behaviour { before: (State::Stopped, 0.0), ..TALKER };
    let stopped = stop(&mut LinkClient::new(Talker::new(resting), 42), || false).unwrap();
    assert_eq!(stopped.state, State::Stopped);
}
