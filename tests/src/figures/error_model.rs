//! Forty legs of a metre on a floor that does not do what the wheels say, with perfect odometry.
//!
//! | error | spread | drawn |
//! |---|---|---|
//! | turn noise | 0.01 rad | each turn |
//! | turn scale | 0.5 % | each run |
//! | length | 0.5 % | each run |
//! | curvature | 0.01 rad/m | each run |
//!
//! The wheels' encoders know nothing of these errors; "perfect odometry" is the true pose, told to
//! the controller in every tick.

use super::bench::{Bench, angle_between, legs_through, robot_pose};
use super::{Figure, Size};
use hil_sim::base::{BaseParameters, Faults};
use hil_sim::noise::normal;
use protocol::motion::{Pose, Timing};
use std::f64::consts::FRAC_PI_2;

const TURN_NOISE: f64 = 0.01;
const SCALE: f64 = 0.005;
const CURVATURE: f64 = 0.01;
const LEGS: usize = 40;
const TRACK: f64 = 0.12;

/// Root mean squares of the end's position and heading, closed loop and open.
pub fn measure(size: Size) -> Vec<Figure> {
    let runs = size.pick(6, 400) as u64;
    let closed: Vec<_> = (0..runs).map(closed_loop).collect();
    let open: Vec<_> = (0..runs.max(400)).map(open_loop).collect();
    let what = format!("{LEGS} legs of 1 m, errors of the floor, rms of {runs}:");
    let position = |runs: &[(f64, f64)]| rms(runs.iter().map(|run| run.0)) * 1e3;
    let heading = |runs: &[(f64, f64)]| rms(runs.iter().map(|run| run.1)).to_degrees();
    vec![
        Figure::bounded(format!("{what} position"), position(&closed), 5.0, "mm"),
        Figure::bounded(format!("{what} heading"), heading(&closed), 0.6, "°"),
        Figure::stated("  the same driven open: position", position(&open), "mm"),
        Figure::stated("  the same driven open: heading", heading(&open), "°"),
    ]
}

/// What the floor does to one leg.
#[derive(Clone, Copy)]
struct Floor {
    turn: f64,
    length: f64,
    curvature: f64,
}

fn floors(seed: u64) -> Vec<Floor> {
    let mut random = fastrand::Rng::with_seed(seed);
    let [turn, length, curvature] =
        [SCALE, SCALE, CURVATURE].map(|spread| spread * normal(&mut random));
    let floor =
        |_| Floor { turn: turn + TURN_NOISE / FRAC_PI_2 * normal(&mut random), length, curvature };
    (0..LEGS).map(floor).collect()
}

/// Errors of position, m, and heading, rad, after forty sides of a square.
fn closed_loop(seed: u64) -> (f64, f64) {
    let corners = [(1.0, 0.0), (1.0, 1.0), (0.0, 1.0), (0.0, 0.0)];
    let points: Vec<_> = corners.into_iter().cycle().take(LEGS).collect();
    let start = Pose::default();
    let mut bench = Bench::with(Default::default(), BaseParameters::seeded(seed), start);
    bench.commit(&legs_through(start, &points, Timing::Limits), start);
    let floors = floors(seed);
    bench.run(|bench| {
        let _ = bench.controller.set_pose(robot_pose(bench.base.pose()), 0);
        let Floor { turn, length, curvature } = floors[usize::from(bench.controller.leg())];
        let [left, right] = bench.base.wheel_speeds();
        // Rims that run against each other turn the robot.
        let slip = if left * right < 0.0 {
            [-turn; 2]
        } else {
            let bend = curvature * TRACK / 2.0;
            [bend - length, -bend - length]
        };
        bench.base.set_faults(Faults { slip, ..Faults::default() });
    });
    let end = bench.base.pose();
    // The last side leads down along -y.
    (end.x.hypot(end.y), angle_between(end.heading, -FRAC_PI_2))
}

/// The same floor under a robot that only counts its wheels.
fn open_loop(seed: u64) -> (f64, f64) {
    let (mut x, mut y, mut heading) = (0.0f64, 0.0f64, 0.0f64);
    for (index, floor) in floors(seed).into_iter().enumerate() {
        let turn = if index == 0 { 0.0 } else { FRAC_PI_2 };
        heading += turn * (1.0 + floor.turn);
        let (length, bend) = (1.0 + floor.length, floor.curvature);
        x += length * (heading + bend / 2.0).cos();
        y += length * (heading + bend / 2.0).sin();
        heading += bend;
    }
    (x.hypot(y), angle_between(heading, -FRAC_PI_2))
}

fn rms(values: impl ExactSizeIterator<Item = f64>) -> f64 {
    let count = values.len() as f64;
    (values.map(|value| value * value).sum::<f64>() / count).sqrt()
}
