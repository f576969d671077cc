//! A base whose lengths are wrong drives UMBmark's courses; what calibration finds, and what it helps.

use super::bench::Bench;
use super::{Figure, Size};
use hil_sim::base::{BaseParameters, TruePose};
use hil_sim::noise::normal;
use protocol::motion;
use protocol::parameters::Parameters;
use wmr::calibration::{BaseLengths, Course, Run, calibrate};
use wmr::geometry::Pose;
use wmr::legs::from_wire;

/// What is wrong: scale, wheel ratio and track.
const WRONG: [f64; 3] = [1.01, 1.005, 1.02];
const SIDE: f64 = 4.0;
/// How well the end is measured: a ruler on the floor, and two of them for the heading.
const RULER: f64 = 0.001;
const PROTRACTOR: f64 = 0.002;

/// Errors of the lengths found, and of the square driven with them.
pub fn measure(size: Size) -> Vec<Figure> {
    let robots = size.pick(2, 40) as u64;
    let (mut worst, mut gain) = ([0.0f64; 3], f64::INFINITY);
    for seed in 0..robots {
        let (errors, before, after) = calibrated(seed);
        worst = [0, 1, 2].map(|length| worst[length].max(errors[length]));
        gain = gain.min(before / after);
    }
    let what = format!("{robots} robots, 6 courses each, worst:");
    let percent = |value: f64| value * 100.0;
    vec![
        Figure::bounded(format!("{what} error of scale"), percent(worst[0]), 0.1, "%"),
        Figure::bounded("  error of wheel ratio", percent(worst[1]), 0.1, "%"),
        Figure::bounded("  error of track", percent(worst[2]), 0.1, "%"),
        Figure::bounded(
            "  return error of a 4 m square, after / before",
            1.0 / gain,
            1.0 / 15.0,
            "",
        ),
        Figure::stated("  that is, it falls by a factor of", gain, ""),
    ]
}

/// Errors of the lengths, and the return error before and after, m.
fn calibrated(seed: u64) -> ([f64; 3], f64, f64) {
    let base = BaseParameters::seeded(seed).with_wrong_lengths(WRONG);
    let parameters = Parameters::default();
    let used = BaseLengths::of(&parameters);
    let mut random = fastrand::Rng::with_seed(seed);
    let courses = Course::all(SIDE);
    let runs: Vec<_> = courses
        .into_iter()
        .map(|course| {
            let (believed, end) = drive(&parameters, base, course);
            let mut off = |value: f64, spread: f64| value + spread * normal(&mut random);
            let measured =
                Pose::new(off(end.x, RULER), off(end.y, RULER), off(end.heading, PROTRACTOR));
            Run { course, believed, measured }
        })
        .collect();
    let found = calibrate(used, &runs).expect("the courses determine all lengths").lengths;
    let errors = [
        found.wheel_radius / (used.wheel_radius * WRONG[0]) - 1.0,
        found.wheel_ratio / WRONG[1] - 1.0,
        found.track / (used.track * WRONG[2]) - 1.0,
    ];
    let better = found.applied_to(&parameters, 1);
    let before = return_error(&parameters, base);
    (errors.map(f64::abs), before, return_error(&better, base))
}

/// Where the robot believes it ended, and where it did.
fn drive(parameters: &Parameters, base: BaseParameters, course: Course) -> (Pose, TruePose) {
    let start = motion::Pose::default();
    let mut bench = Bench::with(*parameters, base, start);
    bench.commit(&course.legs(), start);
    bench.run(|_| {});
    (from_wire(bench.controller.pose()), bench.base.pose())
}

/// The distance from the start after a square, the worse of both ways, m.
fn return_error(parameters: &Parameters, base: BaseParameters) -> f64 {
    let ways = [true, false].map(|left| {
        let (_, end) = drive(parameters, base, Course::Square { side: SIDE, left });
        end.x.hypot(end.y)
    });
    ways[0].max(ways[1])
}
