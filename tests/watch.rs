//! Drives that a simulated camera watches, in virtual time: frames are rendered, seen and answered to.
#![allow(clippy::unwrap_used, reason = "helpers of tests fail as tests do")]

use hil_sim::base::BaseParameters;
use std::f64::consts::{FRAC_PI_2, PI};
use wmr::watch::{Reason, WatchEvent};
use wmr_tests::watched::{Case, Outcome, drive, goal_at};

/// What a watched robot's end may differ from its goal, m and rad: 5 mm and 1°.
const END: (f64, f64) = (0.005, 0.01745);
/// The least time between one judgement and the next, and two frames, seconds.
const TWO_FRAMES: f64 = 0.2;
/// From a frame's exposure to its judgement, and to a change of the wheels' speeds, seconds.
const LATENCY: f64 = 0.15;

fn across() -> Case {
    Case::new([0.3, 0.75, 0.0], [1.7, 0.75, 0.0])
}

fn assert_arrived(outcome: &Outcome, case: &Case) {
    assert!(outcome.result.is_ok(), "{}", outcome.story());
    let (distance, turn) = outcome.error(case);
    assert!(distance < END.0 && turn < END.1, "{distance} {turn}\n{}", outcome.story());
    assert_eq!(outcome.collisions.collisions, 0, "{}", outcome.story());
}

#[test]
fn an_empty_arena_is_crossed_without_a_stop() {
    let outcome = drive(&across());
    assert_arrived(&outcome, &across());
    let counts = outcome.statistics;
    assert_eq!((counts.waits, counts.refused, counts.replans), (0, 0, 0), "{}", outcome.story());
    assert!(
        counts.used > 40 && counts.used == counts.frames && counts.corrections > 0,
        "{counts:?}"
    );
}

/// The box's face is 0.3 m before the robot's edge, which drives at full speed, when it is set down.
#[test]
fn a_box_set_down_close_ahead_is_not_touched() {
    let shape = "shape,rect=[1.175, 0.6, 1.3, 0.9],place=[0.8, 0.75, 0.01]".into();
    let case = Case { faults: vec![shape], ..across() };
    let outcome = drive(&case);
    assert_arrived(&outcome, &case);
    let blocked =
        |event: &_| matches!(event, WatchEvent::Held(Reason::Blocked { moves: false, .. }));
    assert!(outcome.told(blocked) >= 1, "{}", outcome.story());
    assert!(outcome.told(|event| matches!(event, WatchEvent::Rerouted { .. })) >= 1);
}

/// A wall leaves no way; it is taken away, and within two frames the robot knows.
#[test]
fn what_is_taken_away_is_free_within_two_frames() {
    let away = 6.0;
    let wall = format!("shape,rect=[1.1, 0.0, 1.2, 1.5],at=0.5,for={}", away - 0.5);
    let case = Case { faults: vec![wall], ..across() };
    let outcome = drive(&case);
    assert_arrived(&outcome, &case);
    let no_way = |event: &_| matches!(event, WatchEvent::Held(Reason::NoWay(_)));
    assert!(outcome.told(no_way) >= 1, "it waited: {}", outcome.story());
    let on = outcome.events.iter().find(|(at, event)| {
        at.as_secs_f64() > away
            && matches!(event, WatchEvent::Resumed { .. } | WatchEvent::Rerouted { .. })
    });
    let after = on.unwrap().0.as_secs_f64() - away;
    assert!(after < TWO_FRAMES + LATENCY, "{after} s\n{}", outcome.story());
}

/// Dark for this long from 2 s on; the outcome, and the true speed at each tenth of a second of that.
fn dark(seconds: f64) -> (Outcome, Vec<f64>) {
    let case = Case { faults: vec![format!("camera-dark,at=1.5,for={seconds}")], ..across() };
    let outcome = drive(&case);
    assert_arrived(&outcome, &case);
    let tenths = (10.0 * seconds) as u32;
    let speeds = (0..tenths).map(|tenth| outcome.speed(1.5 + 0.1 * f64::from(tenth))).collect();
    (outcome, speeds)
}

fn unsure(event: &WatchEvent) -> bool {
    matches!(event, WatchEvent::Held(Reason::Unsure(_)))
}

#[test]
fn a_camera_dark_for_a_second_changes_nothing() {
    let (outcome, speeds) = dark(1.0);
    assert_eq!(outcome.told(unsure), 0, "{}", outcome.story());
    assert!(speeds.iter().all(|speed| *speed > 0.35), "{speeds:?}");
}

#[test]
fn a_camera_dark_for_three_seconds_slows_the_robot_down() {
    let (outcome, speeds) = dark(3.0);
    assert_eq!(outcome.told(unsure), 1, "{}", outcome.story());
    let slow = |event: &_| matches!(event, WatchEvent::Rerouted { slow: true, .. });
    assert_eq!(outcome.told(slow), 1, "{}", outcome.story());
    let later = &speeds[18..];
    assert!(later.iter().all(|speed| *speed < 0.25), "{speeds:?}");
    assert!(later.iter().any(|speed| *speed > 0.02), "it drives on: {speeds:?}");
}

#[test]
fn a_camera_dark_for_ten_seconds_stops_the_robot_until_it_sees_again() {
    let (outcome, speeds) = dark(10.0);
    assert!(outcome.told(unsure) >= 1, "{}", outcome.story());
    assert!(speeds[70..].iter().all(|speed| *speed < 0.001), "{speeds:?}");
}

/// A camera that sends one picture again and again shows the robot where it was; nobody believes that.
#[test]
fn a_camera_that_hangs_is_not_believed() {
    let case = Case { faults: vec!["camera-frozen,at=1.5,for=8".into()], ..across() };
    let outcome = drive(&case);
    assert_arrived(&outcome, &case);
    let (hangs, lifted) = (
        |event: &_| matches!(event, WatchEvent::Trouble(why) if why.contains("stays the same")),
        |event: &_| matches!(event, WatchEvent::Held(Reason::Lifted(_))),
    );
    assert!(outcome.told(hangs) >= 1 && outcome.told(unsure) >= 1, "{}", outcome.story());
    assert_eq!(outcome.told(lifted), 0, "{}", outcome.story());
}

/// Four goals round the arena, on a base whose wheels and track are not as the robot believes.
#[test]
fn a_wrong_base_ends_at_the_goal() {
    let corners = [[1.6, 0.4, 0.0], [1.6, 1.1, FRAC_PI_2], [0.4, 1.1, PI], [0.4, 0.4, -FRAC_PI_2]];
    let case = Case {
        goals: corners.map(goal_at).to_vec(),
        base: BaseParameters::seeded(1).with_wrong_lengths([1.01, 1.0, 1.02]),
        ..Case::new([0.4, 0.4, 0.0], corners[0])
    };
    let outcome = drive(&case);
    assert_arrived(&outcome, &case);
}
