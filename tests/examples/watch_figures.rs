//! Figures of watched drives: how they end on a wrong base with and without the camera, what the camera has then
//! learnt of the base, and how long a frame takes.
//!
//! `cargo run --release -p wmr-tests --example watch_figures`

use hil_sim::base::{BaseParameters, Faults};
use std::f64::consts::{FRAC_PI_2, PI};
use std::time::Duration;
use wmr_tests::watched::{Case, Outcome, drive, drive_blind, goal_at};

/// Five rounds of four legs.
const ROUNDS: usize = 5;

fn main() {
    println!(
        "twenty legs, 1 % too large wheels, 2 % too wide a track, the left wheel slips by 0.5 %"
    );
    println!("{:<22}{:>12}{:>10}", "", "end, mm", "turn, °");
    let case = rounds();
    let (distance, turn) = drive_blind(&case);
    row("odometry alone", distance, turn);
    let outcome = drive(&case);
    let (distance, turn) = outcome.error(&case);
    row("with the camera", distance, turn);
    if let Err(error) = &outcome.result {
        println!("  ended early: {error}");
    }
    learnt(&outcome);
    times(&outcome);
}

/// Round the arena, again and again.
fn rounds() -> Case {
    let corners = [[1.6, 0.4, 0.0], [1.6, 1.1, FRAC_PI_2], [0.4, 1.1, PI], [0.4, 0.4, -FRAC_PI_2]];
    Case {
        goals: corners.map(goal_at).repeat(ROUNDS),
        base: BaseParameters::seeded(1).with_wrong_lengths([1.01, 1.0, 1.02]),
        slips: Faults { slip: [0.005, 0.0], ..Faults::default() },
        ..Case::new([0.4, 0.4, 0.0], corners[0])
    }
}

fn row(name: &str, distance: f64, turn: f64) {
    println!("{name:<22}{:>12.1}{:>10.2}", 1000.0 * distance, turn.to_degrees());
}

fn learnt(outcome: &Outcome) {
    let Some(learnt) = outcome.calibration else { return };
    for (name, factor) in
        [("scale", learnt.scale), ("ratio", learnt.ratio), ("track", learnt.track)]
    {
        println!("{name:<22}{:>12.4} ± {:.4}", factor.value, factor.sigma);
    }
}

fn times(outcome: &Outcome) {
    let mut times = outcome.frame_times.clone();
    times.sort_unstable();
    let at = |share: f64| times.get((share * times.len() as f64) as usize).copied();
    for (name, share) in [("median", 0.5), ("95 %", 0.95), ("slowest", 0.999)] {
        let milliseconds = at(share).unwrap_or(Duration::ZERO).as_secs_f64() * 1000.0;
        println!("frame, {name:<15}{milliseconds:>12.1} ms");
    }
    println!("frames{:>28}", times.len());
}
