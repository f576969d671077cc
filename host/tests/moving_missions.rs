//! Missions among things that walk, in virtual time: none touches anything while it moves, and they reach their goals.
#![allow(clippy::unwrap_used, reason = "helpers of tests fail as tests do")]
#![allow(dead_code, reason = "the example tells more of a mission than is asked of here")]

#[path = "../examples/moving_missions/mission.rs"]
mod mission;
#[path = "../examples/moving_missions/replay.rs"]
mod replay;

use mission::{Drive, Task};
use replay::Replay;
use std::f64::consts::{FRAC_PI_3, TAU};
use std::fmt::Write;

const FLOOR: [f64; 2] = [2.4, 1.8];
const MISSIONS: u64 = 24;
/// The median time in times of the same mission alone.
const MEDIAN: f64 = 1.3;

/// Walkers that come in over one of two opposite borders, sway, and turn once on their way.
fn walkers(count: u32) -> String {
    let mut random = fastrand::Rng::with_seed(7);
    let mut between = |low: f64, high: f64| low + (high - low) * random.f64();
    let mut text = String::from("time_s,id,x_m,y_m\n");
    for id in 0..count {
        let side = if id % 2 == 0 { 0.0 } else { FLOOR[0] };
        let towards = if id % 2 == 0 { 0.0 } else { TAU / 2.0 };
        let (mut x, mut y) = (side, between(0.1, FLOOR[1] - 0.1));
        let mut heading = towards + between(-0.4, 0.4);
        let (speed, sway, period) = (between(0.1, 0.25), between(0.1, 0.3), between(2.0, 4.0));
        let (began, turns, turn) =
            (between(0.0, 60.0), between(3.0, 8.0), between(-FRAC_PI_3, FRAC_PI_3));
        for step in 0..30 {
            let time = 0.4 * f64::from(step);
            writeln!(text, "{:.3},{id},{x:.4},{y:.4}", began + time).unwrap();
            let swayed = heading + sway * (TAU * time / period).sin();
            (x, y) = (x + 0.4 * speed * swayed.cos(), y + 0.4 * speed * swayed.sin());
            if (time - turns).abs() < 0.2 {
                heading += turn;
            }
        }
    }
    text
}

#[test]
fn missions_among_walkers_touch_nothing_and_arrive() {
    let replay = Replay::read(&walkers(60), 1.0).unwrap();
    let drives: Vec<(Drive, Drive)> = (0..MISSIONS)
        .map(|seed| Task::new(&replay, seed))
        .map(|task| (task.foreseeing(), task.alone()))
        .collect();
    for (seed, (drive, _)) in drives.iter().enumerate() {
        assert_eq!(drive.contacts, 0, "mission {seed}: {drive:?}");
        assert!(drive.reached, "mission {seed}: {drive:?}");
    }
    let mut ratios: Vec<f64> =
        drives.iter().map(|(drive, alone)| drive.time / alone.time).collect();
    ratios.sort_by(f64::total_cmp);
    assert!(ratios[ratios.len() / 2] <= MEDIAN, "{ratios:?}");
}
