//! A base with mass, whose wide tyres scrub in turns and whose wheels differ: what calibration helps on ten legs.
//!
//! Tyres of width w turn a robot as if its track b were b' = sqrt(b² + w²), which no ruler finds.

use super::{Figure, Size};
use hil_sim::base::{TruePose, WheeledBase};
use hil_sim::in_process::InProcess;
use hil_sim::noise::normal;
use hil_sim::physics::Design;
use hil_sim::physics::tyre::Tyre;
use hil_sim::presets::Preset;
use hil_sim::simulation::Simulation;
use protocol::motion::{Leg, Pose as WirePose, Timing};
use protocol::parameters::Parameters;
use wmr::calibration::{BaseLengths, Course, Run, calibrate};
use wmr::geometry::{Point, Pose};
use wmr::legs::{LegOptions, from_wire, to_legs};
use wmr::link::LinkClient;
use wmr::link::drive::drive;
use wmr::link::mission::Mission;

/// b' / b, and how much larger the right wheel is.
const EFFECTIVE_TRACK: f64 = 1.04;
const WHEEL_RATIO: f64 = 1.005;
const SIDE: f64 = 2.0;
/// How well the end is measured: a ruler on the floor, and two of them for the heading.
const RULER: f64 = 0.001;
const PROTRACTOR: f64 = 0.002;
/// Ten legs with turns to both sides, m.
const WAY: [[f64; 2]; 11] = [
    [0.0, 0.0],
    [0.6, 0.0],
    [0.6, 0.5],
    [1.1, 0.5],
    [1.1, 1.0],
    [0.4, 1.2],
    [-0.1, 0.8],
    [0.3, 0.4],
    [-0.3, 0.2],
    [-0.2, -0.4],
    [0.5, -0.5],
];

/// The error after ten legs before and after, the worst of all robots.
pub fn measure(size: Size) -> Vec<Figure> {
    let robots = size.pick(2, 10) as u64;
    let (mut before, mut after, mut gain) = (0.0f64, 0.0f64, f64::INFINITY);
    for seed in 0..robots {
        let parameters = Preset::Romi.parameters();
        let better = calibrated(&parameters, seed);
        let ends = [parameters, better].map(|parameters| error_after_ten_legs(&parameters));
        before = before.max(ends[0]);
        after = after.max(ends[1]);
        gain = gain.min(ends[0] / ends[1]);
    }
    let what = format!("{robots} calibrations of a base that scrubs:");
    vec![
        Figure::stated(format!("{what} ten legs end off by, before"), before * 1000.0, "mm"),
        Figure::stated("  after", after * 1000.0, "mm"),
        Figure::bounded("  after / before, at most", 1.0 / gain, 0.1, ""),
    ]
}

fn base() -> WheeledBase {
    let design = Preset::Romi.design();
    let width = design.track * (EFFECTIVE_TRACK * EFFECTIVE_TRACK - 1.0).sqrt();
    let half = (WHEEL_RATIO - 1.0) / 2.0;
    let [left, right] = design.wheel_radius;
    let design = Design {
        tyre: Tyre { width, ..design.tyre },
        wheel_radius: [left * (1.0 - half), right * (1.0 + half)],
        ..design
    };
    WheeledBase::with_mass(design, Preset::Romi.encoder(), TruePose::default())
}

/// Drives `legs` from the origin; where the robot believes it ended, and where it did.
fn driven(parameters: &Parameters, legs: Vec<Leg>) -> (Pose, TruePose) {
    let simulation = Simulation::new(InProcess::new(*parameters, 1), base(), None);
    let mut client = LinkClient::new(simulation, 1);
    let mut mission = Mission::new(legs, WirePose::default());
    let end = drive(&mut client, &mut mission, || false, |_, _| ());
    end.expect("nothing stands in the way");
    let believed = client.telemetry().expect("a robot that has driven has spoken").pose;
    (from_wire(believed), client.port_mut().truth().pose)
}

fn calibrated(parameters: &Parameters, seed: u64) -> Parameters {
    let mut random = fastrand::Rng::with_seed(seed);
    let run = |course: Course| {
        let (believed, end) = driven(parameters, course.legs());
        let mut off = |value: f64, spread: f64| value + spread * normal(&mut random);
        let measured =
            Pose::new(off(end.x, RULER), off(end.y, RULER), off(end.heading, PROTRACTOR));
        Run { course, believed, measured }
    };
    let runs: Vec<Run> = Course::all(SIDE).into_iter().map(run).collect();
    let found = calibrate(BaseLengths::of(parameters), &runs);
    let found = found.expect("the courses determine all lengths");
    found.lengths.applied_to(parameters, 1)
}

/// How far from the last point the robot really ends, m.
fn error_after_ten_legs(parameters: &Parameters) -> f64 {
    let way = WAY.map(|[x, y]| Point::new(x, y));
    let options = LegOptions { timing: Timing::Limits, reverse: false };
    let legs = to_legs(&way, 0.0, None, &options, &parameters.limits());
    let (_, end) = driven(parameters, legs);
    let [x, y] = WAY[WAY.len() - 1];
    (end.x - x).hypot(end.y - y)
}
