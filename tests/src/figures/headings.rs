//! Every start and end heading relative to the direction of the drive: no singularity anywhere.

use super::bench::angle_between;
use super::{Figure, Size};
use protocol::motion::{Direction, Interval, IntervalMotion, Leg, Limits, Pose, Position, Timing};
use protocol::parameters::Parameters;
use protocol::units::Radians;
use std::f64::consts::{PI, TAU};

/// Places in an interval at which the rate of a turn is looked at.
const LOOKS: u32 = 12;

/// Headings on an even grid that includes 0, ±90° and ±180°, with the drive's direction drawn again
/// for each pair, in both timings.
pub fn measure(size: Size) -> Vec<Figure> {
    let grid = size.pick(72, 720);
    let limits = Parameters::default().limits();
    let mut random = fastrand::Rng::with_seed(7);
    let (mut end, mut heading_law, mut tan_law) = (0.0f64, 0.0f64, 0.0f64);
    for (from, to) in (0..grid * grid).map(|pair| (pair / grid, pair % grid)) {
        let step = TAU / grid as f64;
        let (from, to) = (from as f64 * step - PI, to as f64 * step - PI);
        let bearing = random.f64() * TAU;
        for timing in [Timing::Limits, Timing::Paper { interval_ticks: 600 }] {
            let leg = leg(bearing, from, to, timing);
            let [first, drive, last] = leg.intervals(&limits);
            let reached = f64::from(last.end().heading.0);
            end = end.max(angle_between(reached, bearing + to).abs());
            let aligned = angle_between(drive.end().heading.0.into(), bearing);
            end = end.max(aligned.abs());
            let rate = excess_rate(&first).max(excess_rate(&last));
            let worst = if timing == Timing::Limits { &mut heading_law } else { &mut tan_law };
            *worst = worst.max(rate);
            assert_eq!(leg.check(&slow(limits)), Ok(()));
        }
    }
    let what = format!("{grid} × {grid} headings:");
    vec![
        Figure::bounded(format!("{what} error of direction and end heading"), end, 1e-4, "rad"),
        Figure::bounded(format!("{what} peak rate over 2Δ/e, limits"), heading_law, 1.001, ""),
        // tan(60°)/(60°), for parts of up to 120°.
        Figure::bounded(format!("{what} peak rate over 2Δ/e, paper"), tan_law, 1.655, ""),
    ]
}

fn leg(bearing: f64, from: f64, to: f64, timing: Timing) -> Leg {
    let start = Pose::new(1.0, 1.0, Radians((bearing + from) as f32).wrapped().0);
    Leg {
        plan: 1,
        index: 0,
        start,
        goal: Position::new((1.0 + bearing.cos()) as f32, (1.0 + bearing.sin()) as f32),
        goal_heading: Some(Radians((bearing + to) as f32).wrapped()),
        direction: Direction::Forward,
        timing,
    }
}

/// Limits that the paper's 3 s intervals keep for any turn and a metre.
fn slow(limits: Limits) -> Limits {
    let (speed, acceleration) = (limits.speed.0 * 4.0, limits.acceleration.0 * 4.0);
    Limits {
        speed: protocol::units::MetresPerSecond(speed),
        acceleration: protocol::units::MetresPerSecondSquared(acceleration),
        ..limits
    }
}

/// The largest rate of a turn, seen over a hundredth of it, as a multiple of the pure cosine's 2Δ/e;
/// infinite if a heading on the way is no number.
fn excess_rate(turn: &IntervalMotion) -> f64 {
    let n = turn.profile.phases();
    // A turn below a degree is all rounding.
    if turn.interval == Interval::Drive || turn.change.abs() < 0.02 {
        return 0.0;
    }
    let span = n / 100;
    let rate = |look: u32| {
        let k = (n - span) / LOOKS * look + (n - span) / (2 * LOOKS);
        let heading = |k: u32| f64::from(turn.pose_at(k).heading.0);
        let turned = angle_between(heading(k + span), heading(k)).abs();
        let average = f64::from(turn.change.abs()) * f64::from(span) / f64::from(n);
        if turned.is_finite() { turned / average / 2.0 } else { f64::INFINITY }
    };
    (0..LOOKS).map(rate).fold(0.0, f64::max)
}
