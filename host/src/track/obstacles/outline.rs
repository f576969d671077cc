//! The outline of a tracked obstacle, which does not change with the noise of each frame.
//!
//! Vision sees every edge again in each frame, some millimetres off. What plans with the outline would then
//! plan again each time. So an outline is held until several frames in a row agree that it is another. How
//! far two outlines are apart is how far their tangents are in a number of directions.
//!
//! Not all edges are seen equally well. Those of a box that leans towards the camera keep still to a millimetre; where
//! it ends on the other side is an inference that may jump by centimetres from one frame to the next. So an obstacle
//! lies where its sure edges say ([`Outline::place`]), and does not move when only an unsure one does. Metres.

use crate::geometry::{Point, Rect};
use crate::scene::Obstacle;
use crate::shape::{Circle, Shape};
use std::f64::consts::TAU;

/// Directions in which outlines are compared.
const DIRECTIONS: usize = 16;

/// Outlines that differ by more than so many standard deviations of an edge are not the same.
const SAME: f64 = 3.5;

/// So many frames in a row have to differ before the outline is another.
const AGREEING: u32 = 3;

/// Mean edges are taken over no more frames than this.
const MEAN_OF: f64 = 20.0;

/// The mean of the edges replaces the outline if it has gone so far from it, in standard deviations of an edge.
const MOVED: f64 = 1.5;

/// Where an obstacle is seen, and by how much that may be wrong.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Place {
    pub(super) at: Point,
    /// For either coordinate, by the margins of its two edges: as little as the surer of them leaves, and nothing if
    /// one is known exactly.
    pub(super) doubt: f64,
}

/// The held outline of one obstacle, whose centre was at the origin when it was first seen.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Outline {
    held: Shape,
    /// By how much the edges of the held outline may be wrong: left, lower, right, upper.
    margin: [f64; 4],
    /// The mean of what was seen since the outline was last replaced, where shapes can be averaged.
    mean: Shape,
    seen: f64,
    different: u32,
    /// By how much the last frame's outline reached beyond the held one.
    beyond: f64,
    sigma: f64,
}

impl Outline {
    /// The outline of an obstacle that lies at `place`.
    pub(super) fn new(seen: &Obstacle, place: Point, sigma: f64) -> Self {
        let (held, margin) = (seen.footprint.moved_by(-place.x, -place.y), seen.margin);
        Self { mean: held.clone(), held, margin, seen: 1.0, different: 0, beyond: 0.0, sigma }
    }

    /// The outline of an obstacle that lies at `place`.
    pub(super) fn at(&self, place: Point) -> Shape {
        self.held.moved_by(place.x, place.y)
    }

    /// Where an obstacle lies of which a frame shows this: the mean of where its edges say, each weighted by the
    /// inverse of its variance, which is that of noise and margins in the frame and in the held outline.
    pub(super) fn place(&self, seen: &Obstacle) -> Place {
        let unsure = [0, 1, 2, 3].map(|edge| seen.margin[edge].hypot(self.margin[edge]));
        let variance = |low: usize| 1.0 / (unsure[low].powi(-2) + unsure[low + 2].powi(-2));
        let at = match (&seen.footprint, &self.held) {
            (Shape::Rect(now), Shape::Rect(held)) => {
                let weight = |edge: usize| 1.0 / (self.sigma.powi(2) + unsure[edge].powi(2));
                let mean = |low: usize, offsets: [f64; 2]| {
                    let [a, b] = [weight(low), weight(low + 2)];
                    (a * offsets[0] + b * offsets[1]) / (a + b)
                };
                let x = mean(0, [now.x0 - held.x0, now.x1 - held.x1]);
                Point::new(x, mean(1, [now.y0 - held.y0, now.y1 - held.y1]))
            }
            (now, held) => {
                let (now, held) = (centre(now), centre(held));
                Point::new(now.x - held.x, now.y - held.y)
            }
        };
        Place { at, doubt: variance(0).max(variance(1)).sqrt() }
    }

    /// How much further out the obstacle may reach than the outline: the noise of its edges, or what it
    /// was last seen to do, m.
    pub(super) fn beyond(&self) -> f64 {
        self.beyond
    }

    /// Takes in what a frame shows of an obstacle that lies at `place`; whether the outline is another now.
    pub(super) fn see(&mut self, seen: &Obstacle, place: Point) -> bool {
        let now = seen.footprint.moved_by(-place.x, -place.y);
        let difference = difference(&now, &self.held);
        self.beyond = difference.max(2.0 * self.sigma);
        if difference > SAME * self.sigma {
            self.different += 1;
            if self.different >= AGREEING {
                *self = Self { beyond: self.beyond, ..Self::new(seen, place, self.sigma) };
                return true;
            }
            return false;
        }
        self.different = 0;
        self.seen = (self.seen + 1.0).min(MEAN_OF);
        if let Some(mean) = blended(&self.mean, &now, 1.0 / self.seen) {
            self.mean = mean;
            if self::difference(&self.mean, &self.held) > MOVED * self.sigma {
                self.held = self.mean.clone();
                return true;
            }
        }
        false
    }
}

/// The middle of a shape: of a polygon, of its area.
pub(super) fn centre(shape: &Shape) -> Point {
    match shape {
        Shape::Rect(r) => Point::new((r.x0 + r.x1) / 2.0, (r.y0 + r.y1) / 2.0),
        Shape::Circle(circle) => circle.centre,
        Shape::Polygon(polygon) => {
            let first = polygon.corners().first().copied().unwrap_or(Point::new(0.0, 0.0));
            let (mut x, mut y, mut twice) = (0.0, 0.0, 0.0);
            for (a, b) in polygon.edges() {
                let (ax, ay) = (a.x - first.x, a.y - first.y);
                let (bx, by) = (b.x - first.x, b.y - first.y);
                let cross = ax * by - bx * ay;
                twice += cross;
                x += cross * (ax + bx);
                y += cross * (ay + by);
            }
            Point::new(first.x + x / (3.0 * twice), first.y + y / (3.0 * twice))
        }
    }
}

/// The greatest distance between parallel tangents of two shapes.
fn difference(a: &Shape, b: &Shape) -> f64 {
    let apart = |direction: usize| {
        let (sin, cos) = (TAU * direction as f64 / DIRECTIONS as f64).sin_cos();
        (support(a, cos, sin) - support(b, cos, sin)).abs()
    };
    (0..DIRECTIONS).map(apart).fold(0.0, f64::max)
}

/// How far a shape reaches in a direction.
fn support(shape: &Shape, x: f64, y: f64) -> f64 {
    let along = |points: &[Point]| {
        points.iter().map(|p| p.x * x + p.y * y).fold(f64::NEG_INFINITY, f64::max)
    };
    match shape {
        Shape::Circle(Circle { centre, radius }) => centre.x * x + centre.y * y + radius,
        Shape::Rect(rect) => along(&rect.corners()),
        Shape::Polygon(polygon) => along(polygon.corners()),
    }
}

/// `share` of the way from one shape to another of its kind; polygons have no corners in common that could
/// be averaged.
fn blended(from: &Shape, to: &Shape, share: f64) -> Option<Shape> {
    let between = |a: f64, b: f64| a + share * (b - a);
    match (from, to) {
        (Shape::Rect(a), Shape::Rect(b)) => Some(
            Rect::new(
                between(a.x0, b.x0),
                between(a.y0, b.y0),
                between(a.x1, b.x1),
                between(a.y1, b.y1),
            )
            .into(),
        ),
        (Shape::Circle(a), Shape::Circle(b)) => {
            Some(Circle { radius: between(a.radius, b.radius), ..*a }.into())
        }
        _ => None,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::shape::Polygon;

    const SIGMA: f64 = 0.005;

    #[test]
    fn a_triangles_centre_is_the_mean_of_its_corners() {
        let corners = [[1.0, 1.0], [2.0, 1.0], [1.0, 4.0]].map(Point::from).to_vec();
        let middle = centre(&Polygon::new(corners).unwrap().into());
        assert!(middle.distance(Point::new(4.0 / 3.0, 2.0)) < 1e-12, "{middle:?}");
    }

    #[test]
    fn a_place_by_hand() {
        let first = Obstacle { margin: [0.003; 4], ..Rect::new(0.0, 0.0, 0.2, 0.1).into() };
        let outline = Outline::new(&first, Point::new(0.1, 0.05), SIGMA);
        let at = |rect: [f64; 4], margin| {
            let [x0, y0, x1, y1] = rect;
            outline.place(&Obstacle { margin, ..Rect::new(x0, y0, x1, y1).into() })
        };
        // All edges 20 mm to the right: whatever the margins, so is the obstacle.
        let place = at([0.02, 0.0, 0.22, 0.1], [0.03, 0.004, 0.003, 0.004]).at;
        assert!(place.distance(Point::new(0.12, 0.05)) < 1e-12, "{place:?}");
        // The left edge alone 30 mm to the left, and unsure by 40 mm: variances 25 + 9 + 1600 and 25 + 9 + 16 mm².
        let margin = [0.04, 0.004, 0.004, 0.004];
        let Place { at: place, doubt } = at([-0.03, 0.0, 0.2, 0.1], margin);
        let shift = 0.03 * (1.0 / 1634.0) / (1.0 / 1634.0 + 1.0 / 50.0);
        assert!((place.x - (0.1 - shift)).abs() < 1e-12 && (place.y - 0.05).abs() < 1e-12);
        // Of the coordinates the less sure: hypot(3, 40) and hypot(3, 4) mm, in parallel.
        let both = 0.005 * 1609f64.sqrt() / (25f64 + 1609.0).sqrt();
        assert!((doubt - both).abs() < 1e-9, "{doubt} {both}");
        // Edges that are known exactly leave no doubt.
        let known =
            Outline::new(&Rect::new(0.0, 0.0, 0.2, 0.1).into(), Point::new(0.1, 0.05), SIGMA);
        let found = known.place(&Rect::new(0.0, 0.0, 0.3, 0.1).into());
        assert_eq!((found.doubt, known.place(&first).doubt > 0.0), (0.0, true));
        assert!((found.at.x - 0.15).abs() < 1e-12, "no edge is surer than the other");
    }

    #[test]
    fn tangents_of_a_square_and_a_disc_differ_by_hand() {
        let square = Shape::from(Rect::new(-1.0, -1.0, 1.0, 1.0));
        let disc = Shape::from(Circle { centre: Point::new(0.0, 0.0), radius: 1.0 });
        assert!((difference(&square, &disc) - (2f64.sqrt() - 1.0)).abs() < 1e-12);
    }

    #[test]
    fn noise_settles_and_leaves_the_outline_alone() {
        let mut random = fastrand::Rng::with_seed(3);
        let mut noise = || SIGMA * ((0..12).map(|_| random.f64()).sum::<f64>() - 6.0);
        let mut box_seen = || -> Obstacle {
            Rect::new(1.0 + noise(), 1.0 + noise(), 1.2 + noise(), 1.1 + noise()).into()
        };
        let mut outline = Outline::new(&box_seen(), Point::new(1.1, 1.05), SIGMA);
        let mut see = || {
            let seen = box_seen();
            let place = outline.place(&seen).at;
            outline.see(&seen, place)
        };
        let changes: Vec<bool> = (0..300).map(|_| see()).collect();
        assert!(changes.iter().filter(|&&changed| changed).count() <= 3, "{changes:?}");
        assert!(!changes[20..].contains(&true));
        let bounds = outline.at(Point::new(0.0, 0.0)).bounds();
        assert!((bounds.x1 - 0.1).abs() < 1.5 * SIGMA && (bounds.y1 - 0.05).abs() < 1.5 * SIGMA);
    }

    #[test]
    fn an_outline_that_stays_another_is_taken_over_and_a_single_one_is_not() {
        let (short, long) = (Rect::new(0.0, 0.0, 0.2, 0.2), Rect::new(0.0, 0.0, 0.4, 0.2));
        let mut outline = Outline::new(&short.into(), Point::new(0.1, 0.1), SIGMA);
        let mut see = |rect: Rect| {
            let place = outline.place(&rect.into()).at;
            (outline.see(&rect.into(), place), outline.beyond())
        };
        let (changed, beyond) = see(long);
        assert!(!changed && (beyond - 0.1).abs() < 1e-12);
        assert!(!see(short).0);
        assert_eq!([long; 3].map(|rect| see(rect).0), [false, false, true]);
        let found = outline.at(Point::new(0.2, 0.1)).bounds();
        assert!((found.x0 - long.x0).abs() < 1e-12 && (found.x1 - long.x1).abs() < 1e-12);
    }
}
