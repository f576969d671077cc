//! Ideal wheels: the legs' reference itself, rolled out by the simulator's kinematics in f64; and f32
//! against f64. No encoder and no loop: one count of 1440 alone is 0.06°.

use super::bench::{TICK, angle_between, legs_through, robot_pose, true_pose};
use super::{Figure, Size};
use firmware::odometry::{Odometry, Rims};
use hil_sim::base::{BaseParameters, TruePose, WheeledBase};
use protocol::motion::{Interval, IntervalMotion, Leg, PHASES_PER_TICK, Pose, Timing};
use protocol::parameters::Parameters;
use protocol::units::Radians;
use std::f64::consts::TAU;

const PAPER: Timing = Timing::Paper { interval_ticks: 600 };
/// The track as the robot's f32 has it, so that only the motion is measured.
const TRACK: f64 = 0.12;

/// The paper's mission, by ideal wheels, in both timings; and what f32 costs over 2 m.
pub fn measure(size: Size) -> Vec<Figure> {
    let mut figures = Vec::new();
    for (name, timing) in [("paper", PAPER), ("limits", Timing::Limits)] {
        let (position, heading) = paper_mission(timing);
        let what = format!("paper's mission, {name} timing, ideal wheels: end");
        figures.push(Figure::bounded(format!("{what} position"), position * 1e3, 0.05, "mm"));
        figures.push(Figure::bounded(format!("{what} heading"), heading.to_degrees(), 0.005, "°"));
    }
    let runs = size.pick(20, 2000);
    let reference = (0..runs as u64).map(reference_error).fold(0.0, f64::max);
    figures.push(Figure::bounded("reference in f32 against f64, 2 m", reference * 1e3, 0.1, "mm"));
    let odometry = (0..runs as u64).map(odometry_error).fold(0.0, f64::max);
    figures.push(Figure::bounded("odometry in f32 against f64, 2 m", odometry * 1e3, 0.1, "mm"));
    figures
}

/// Errors of position, m, and heading, rad, at the end of the paper's three legs.
fn paper_mission(timing: Timing) -> (f64, f64) {
    let start = Pose::new(1.4, 0.35, 0.0);
    let mut legs = legs_through(start, &[(0.875, 0.475), (0.875, 1.525), (1.4, 1.75)], timing);
    if let Some(last) = legs.last_mut() {
        last.goal_heading = Some(Radians(0.0));
    }
    let mut base = ideal_base(start);
    legs.iter().for_each(|leg| roll_out(leg, &mut base));
    let TruePose { x, y, heading } = base.pose();
    ((x - 1.4).hypot(y - 1.75), angle_between(heading, 0.0).abs())
}

fn ideal_base(start: Pose) -> WheeledBase {
    WheeledBase::new(BaseParameters { track: TRACK, ..BaseParameters::seeded(0) }, true_pose(start))
}

/// Rolls the rims by what the reference moves from tick to tick, each interval solved from the true pose.
fn roll_out(leg: &Leg, base: &mut WheeledBase) {
    let limits = Parameters::default().limits();
    for interval in Interval::ALL {
        let motion = leg.interval(interval, robot_pose(base.pose()), &limits);
        let mut before = motion.pose_at(0);
        for tick in 1..=motion.profile.ticks() {
            let now = motion.pose_at(tick * PHASES_PER_TICK);
            let (dx, dy) = (f64::from(now.x.0 - before.x.0), f64::from(now.y.0 - before.y.0));
            let heading = f64::from(now.heading.0);
            let (way, turn) = (
                dx * heading.cos() + dy * heading.sin(),
                angle_between(heading, before.heading.0.into()),
            );
            base.roll([way - turn * TRACK / 2.0, way + turn * TRACK / 2.0]);
            before = now;
        }
    }
}

/// The largest distance between a 2 m drive's reference and the same formula in f64, m.
fn reference_error(seed: u64) -> f64 {
    let mut random = fastrand::Rng::with_seed(seed);
    let bearing = random.f64() * TAU;
    let start = Pose::new(random.f32() * 4.0, random.f32() * 4.0, bearing as f32);
    let goal =
        (f64::from(start.x.0) + 2.0 * bearing.cos(), f64::from(start.y.0) + 2.0 * bearing.sin());
    let timing = if seed.is_multiple_of(2) {
        Timing::Limits
    } else {
        Timing::Paper { interval_ticks: 2400 }
    };
    let leg = legs_through(start, &[goal], timing)[0];
    let drive = leg.interval(Interval::Drive, start, &Parameters::default().limits());
    let oracle = |tick: u32| {
        let travel = drive_travel(&drive, f64::from(tick) * TICK);
        let (x, y) = (f64::from(start.x.0), f64::from(start.y.0));
        (x + travel * bearing.cos(), y + travel * bearing.sin())
    };
    let error = |tick: u32| {
        let (pose, (x, y)) = (drive.pose_at(tick * PHASES_PER_TICK), oracle(tick));
        (f64::from(pose.x.0) - x).hypot(f64::from(pose.y.0) - y)
    };
    (0..=drive.profile.ticks()).map(error).fold(0.0, f64::max)
}

/// How far 2 m have been driven after `t` seconds: cosine ramps of `r` seconds around a cruise.
fn drive_travel(drive: &IntervalMotion, t: f64) -> f64 {
    let e = f64::from(drive.profile.ticks()) * TICK;
    let peak = f64::from(drive.profile.peak_rate());
    // The ramps take half the rate's area each: (e - r) peak = 1.
    let r = e - 1.0 / peak;
    let ramp = |t: f64| peak / 2.0 * (t - r / (TAU / 2.0) * (TAU / 2.0 * t / r).sin());
    let fraction = match t {
        _ if t < r => ramp(t),
        _ if t > e - r => 1.0 - ramp(e - t),
        _ => ramp(r) + peak * (t - r),
    };
    2.0 * fraction
}

/// How far odometry is from the same counts summed up in f64 after 2 m of winding way, m.
fn odometry_error(seed: u64) -> f64 {
    let mut random = fastrand::Rng::with_seed(seed);
    let rims = Rims::from(&Parameters::default());
    let start = Pose::new(random.f32() * 4.0, random.f32() * 4.0, random.f32() * 6.0 - 3.0);
    let mut odometry = Odometry::new(start, [0, 0]);
    let mut oracle = ideal_base(start);
    let per_count = TAU / 1440.0 * 0.035;
    let (mut counts, mut driven) = ([0i32; 2], 0.0);
    while driven < 2.0 {
        // Up to 0.4 m/s: 13 counts a tick.
        let moved = [random.i32(0..=13), random.i32(0..=13)];
        counts = [counts[0] + moved[0], counts[1] + moved[1]];
        odometry.update(counts, &rims);
        oracle.roll(moved.map(|count| f64::from(count) * per_count));
        driven += f64::from(moved[0] + moved[1]) / 2.0 * per_count;
    }
    let (pose, truth) = (odometry.pose(), oracle.pose());
    (f64::from(pose.x.0) - truth.x).hypot(f64::from(pose.y.0) - truth.y)
}
