//! How long legs take against the quickest that V and A allow: full acceleration, full brake.

use super::bench::legs_through;
use super::{Figure, Size};
use protocol::motion::{Interval, IntervalMotion, Leg, Limits, Pose, Timing};
use protocol::units::{Metres, MetresPerSecond, MetresPerSecondSquared};
use std::f64::consts::TAU;

/// The limits at which the anchors' figures were computed.
const LIMITS: Limits = Limits {
    speed: MetresPerSecond(0.4),
    acceleration: MetresPerSecondSquared(0.8),
    track: Metres(0.15),
};
const TICK: f64 = 0.005;
const LEGS: usize = 10;

/// Missions of ten chained legs in both timings, and the worst interval.
pub fn measure(size: Size) -> Vec<Figure> {
    let missions = size.pick(500, 20_000) as u64;
    let mut worst = f64::NEG_INFINITY;
    let mut figures = Vec::new();
    for (range, bound) in [((0.1, 2.0), Some(1.15)), ((0.1, 0.5), None)] {
        let mut limited = Vec::new();
        let mut paper = Vec::new();
        for seed in 0..missions {
            let legs = mission(seed, range);
            let motions: Vec<_> = legs.iter().flat_map(|leg| leg.intervals(&LIMITS)).collect();
            let best: f64 = motions.iter().map(bang_bang).sum();
            limited.push(motions.iter().map(duration).sum::<f64>() / best);
            paper.push(legs.iter().map(paper_duration).sum::<f64>() / best);
            let excess = |motion: &IntervalMotion| duration(motion) - 1.2534 * bang_bang(motion);
            worst = motions.iter().map(excess).fold(worst, f64::max);
        }
        let what = format!("10 legs of {}-{} m, time / bang-bang, median:", range.0, range.1);
        let limited =
            Figure { most: bound, ..Figure::stated(format!("{what} limits"), median(limited), "") };
        figures.push(limited);
        figures.push(Figure::stated(format!("{what} paper, T/3 each"), median(paper), ""));
    }
    let ticks = worst / TICK;
    figures.push(Figure::bounded("worst interval beyond 1.2534 × bang-bang", ticks, 1.0, "ticks"));
    figures
}

fn mission(seed: u64, (shortest, longest): (f64, f64)) -> Vec<Leg> {
    let mut random = fastrand::Rng::with_seed(seed);
    let start = Pose::new(0.0, 0.0, random.f32() * 6.0 - 3.0);
    let (mut x, mut y) = (0.0, 0.0);
    let points: Vec<_> = (0..LEGS)
        .map(|_| {
            let (bearing, length) =
                (random.f64() * TAU, shortest + (longest - shortest) * random.f64());
            (x, y) = (x + length * bearing.cos(), y + length * bearing.sin());
            (x, y)
        })
        .collect();
    legs_through(start, &points, Timing::Limits)
}

/// The way of the rims, m.
fn rim_travel(motion: &IntervalMotion) -> f64 {
    let change = f64::from(motion.change.abs());
    if motion.interval == Interval::Drive { change } else { change * 0.15 / 2.0 }
}

fn bang_bang(motion: &IntervalMotion) -> f64 {
    let (d, v, a) = (rim_travel(motion), 0.4, 0.8);
    if d <= v * v / a { 2.0 * (d / a).sqrt() } else { d / v + v / a }
}

fn duration(motion: &IntervalMotion) -> f64 {
    f64::from(motion.profile.ticks()) * TICK
}

/// Three intervals as long as the longest needs under the pure cosine, e = max(2D/V, √(2πD/A)).
fn paper_duration(leg: &Leg) -> f64 {
    let needed = leg.intervals(&LIMITS).map(|motion| {
        let d = rim_travel(&motion);
        (2.0 * d / 0.4).max((TAU * d / 0.8).sqrt())
    });
    3.0 * needed.into_iter().fold(0.0, f64::max)
}

fn median(mut values: Vec<f64>) -> f64 {
    values.sort_by(f64::total_cmp);
    values[values.len() / 2]
}
