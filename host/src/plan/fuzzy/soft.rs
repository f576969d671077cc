//! The risk that one obstacle is to a leg: 1 at its core, falling to 0 over the soft band around it. Metres.

use crate::geometry::{Point, Rect};
use crate::plan::clearance::leg_square;
use crate::shape::Shape;

/// One obstacle as the robot's centre sees it.
#[derive(Clone, Debug)]
pub(super) struct Soft {
    pub(super) footprint: Shape,
    pub(super) margin: [f64; 4],
    pub(super) widest: f64,
    /// Around core and band.
    pub(super) bounds: Rect,
}

impl Soft {
    /// The square of the distance between the leg and the footprint grown by a share of its margin.
    pub(super) fn square(&self, a: Point, b: Point, share: f64) -> f64 {
        match &self.footprint {
            Shape::Rect(rect) => {
                leg_square(a, b, &rect.widened(self.margin.map(|edge| share * edge)))
            }
            shape => {
                let distance = if a == b { shape.distance(a) } else { shape.leg_distance(a, b) };
                (distance - share * self.widest).max(0.0).powi(2)
            }
        }
    }

    pub(super) fn greatest(&self, a: Point, b: Point, keep: f64) -> f64 {
        self.greatest_from(self.square(a, b, 0.0).sqrt(), (a, b), keep)
    }

    /// The greatest risk on a leg that comes as near to the footprint as `distance`.
    ///
    /// Of a rectangle with four margins the distance falls as a convex function of the share by which it
    /// grows, so Newton's steps from 0 never overshoot.
    pub(super) fn greatest_from(&self, distance: f64, (a, b): (Point, Point), keep: f64) -> f64 {
        const STEPS: usize = 8;
        const CLOSE: f64 = 1e-9;
        let room = distance - keep;
        if room <= 0.0 {
            return 1.0;
        }
        if room >= self.widest * std::f64::consts::SQRT_2 {
            return 0.0;
        }
        let Shape::Rect(_) = self.footprint else { return (1.0 - room / self.widest).max(0.0) };
        let (mut share, mut room) = (0.0, room);
        for _ in 0..STEPS {
            let step = 1e-6;
            let nearer = self.square(a, b, share + step).sqrt() - keep;
            let slope = (room - nearer) / step;
            if slope <= 0.0 {
                return 0.0;
            }
            share += room / slope;
            if share >= 1.0 {
                return 0.0;
            }
            room = self.square(a, b, share).sqrt() - keep;
            if room <= CLOSE {
                break;
            }
        }
        1.0 - share
    }

    /// The narrowest side of the band that is there at all.
    pub(super) fn narrowest(&self) -> f64 {
        self.margin.into_iter().filter(|&edge| edge > 0.0).fold(f64::INFINITY, f64::min)
    }
}
