//! What is asked of a place at a time: how far the robot's centre must be from things that move.
//!
//! | distance d of the centre to where a thing most likely is | meaning |
//! |---|---|
//! | d < k + h | forbidden |
//! | k + h ≤ d < k + r | possible, at the risk ((k + r - d) / r)² |
//! | k + r ≤ d | free |
//!
//! k is the robot's radius and margin, r how far off the thing may be then, and h = r up to a time
//! ahead that is sure, from then on r at that time: what is further ahead will be predicted anew, and is as sure when
//! the robot is there. Metres, seconds.

use super::Future;
use crate::geometry::Point;

/// Distances beyond the fuzzy edge are of no interest from here on, m.
const FAR: f64 = 0.5;

/// What is asked.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Demand {
    /// k: the robot's radius and margin, m.
    pub keep: f64,
    /// Up to this time ahead the whole of a set is forbidden, s.
    pub sure: f64,
}

/// How a place at a time meets what is asked.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Band {
    /// How far the place is from what is forbidden, m; negative inside.
    pub gap: f64,
    /// How far it is from any risk, m; negative where there is some.
    pub slack: f64,
    /// The greatest risk, 0 to 1.
    pub risk: f64,
    /// The thing that `gap` is about.
    pub nearest: Option<usize>,
}

impl Demand {
    /// How far h off a thing must be reckoned with, m.
    fn hard(&self, future: &Future, time: f64) -> f64 {
        future.reach(time.min(self.sure))
    }

    /// How `point` is at `time`.
    pub fn at(&self, futures: &[Future], point: Point, time: f64) -> Band {
        let mut band = Band { gap: f64::INFINITY, slack: f64::INFINITY, risk: 0.0, nearest: None };
        for (index, future) in futures.iter().enumerate() {
            let reach = future.reach(time);
            let edge = self.keep + reach;
            let distance = future.distance(point, time, edge + FAR);
            let need = self.keep + self.hard(future, time);
            if distance - need < band.gap {
                (band.gap, band.nearest) = (distance - need, Some(index));
            }
            band.slack = band.slack.min(distance - edge);
            if distance < edge && reach > 0.0 {
                let risk = ((edge - distance) / reach).clamp(0.0, 1.0);
                band.risk = band.risk.max(risk * risk);
            }
        }
        band
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::shape::{Circle, Shape};

    fn disc() -> Shape {
        Circle { centre: Point::new(0.0, 0.0), radius: 0.05 }.into()
    }

    #[test]
    fn forbidden_risky_and_free_by_hand() {
        // Its reach grows by 0.1 m a second.
        let moves = (0..=20).map(|layer| ([0.0; 2], 0.01 * f64::from(layer)));
        let futures = [Future::new(disc(), moves)];
        let demand = Demand { keep: 0.08, sure: 1.0 };
        let at = |x, time| demand.at(&futures, Point::new(x, 0.0), time);
        // At 2 s: forbidden up to 0.05 + 0.08 + 0.1, risky up to 0.33 m.
        let band = at(0.28, 2.0);
        assert!((band.gap - 0.05).abs() < 1e-9 && (band.slack + 0.05).abs() < 1e-9, "{band:?}");
        assert!((band.risk - 0.0625).abs() < 1e-9, "(0.05 / 0.2)²");
        assert!(at(0.22, 2.0).gap < 0.0 && at(0.34, 2.0).risk == 0.0);
        assert!((at(0.34, 0.5).gap - 0.16).abs() < 1e-9, "all of the set is sure: 0.05 m");
    }
}
