//! The outline of a tracked obstacle, which does not change with the noise of each frame.
//!
//! Vision sees every edge again in each frame, some millimetres off. What plans with the outline would then
//! plan again each time. So an outline is held until several frames in a row agree that it is another. How
//! far two outlines are apart is how far their tangents are in a number of directions. Metres.

use crate::geometry::{Point, Rect};
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

/// The held outline of one obstacle, its centre at the origin.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Outline {
    held: Shape,
    /// The mean of what was seen since the outline was last replaced, where shapes can be averaged.
    mean: Shape,
    seen: f64,
    different: u32,
    /// By how much the last frame's outline reached beyond the held one.
    beyond: f64,
    sigma: f64,
}

impl Outline {
    pub(super) fn new(shape: &Shape, sigma: f64) -> Self {
        let held = centred(shape);
        Self { mean: held.clone(), held, seen: 1.0, different: 0, beyond: 0.0, sigma }
    }

    /// The outline with its centre at `centre`.
    pub(super) fn at(&self, centre: Point) -> Shape {
        self.held.moved_by(centre.x, centre.y)
    }

    /// How much further out the obstacle may reach than the outline: the noise of its edges, or what it
    /// was last seen to do, m.
    pub(super) fn beyond(&self) -> f64 {
        self.beyond
    }

    /// Takes in what a frame shows; whether the outline is another now.
    pub(super) fn see(&mut self, shape: &Shape) -> bool {
        let now = centred(shape);
        let difference = difference(&now, &self.held);
        self.beyond = difference.max(2.0 * self.sigma);
        if difference > SAME * self.sigma {
            self.different += 1;
            if self.different >= AGREEING {
                *self = Self { beyond: self.beyond, ..Self::new(shape, self.sigma) };
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

fn centred(shape: &Shape) -> Shape {
    let Point { x, y } = centre(shape);
    shape.moved_by(-x, -y)
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
    fn tangents_of_a_square_and_a_disc_differ_by_hand() {
        let square = Shape::from(Rect::new(-1.0, -1.0, 1.0, 1.0));
        let disc = Shape::from(Circle { centre: Point::new(0.0, 0.0), radius: 1.0 });
        assert!((difference(&square, &disc) - (2f64.sqrt() - 1.0)).abs() < 1e-12);
    }

    #[test]
    fn noise_settles_and_leaves_the_outline_alone() {
        let mut random = fastrand::Rng::with_seed(3);
        let mut noise = || SIGMA * ((0..12).map(|_| random.f64()).sum::<f64>() - 6.0);
        let mut box_seen =
            || Rect::new(1.0 + noise(), 1.0 + noise(), 1.2 + noise(), 1.1 + noise()).into();
        let mut outline = Outline::new(&box_seen(), SIGMA);
        let changes: Vec<bool> = (0..300).map(|_| outline.see(&box_seen())).collect();
        assert!(changes.iter().filter(|&&changed| changed).count() <= 3, "{changes:?}");
        assert!(!changes[20..].contains(&true));
        let bounds = outline.at(Point::new(0.0, 0.0)).bounds();
        assert!((bounds.x1 - 0.1).abs() < 1.5 * SIGMA && (bounds.y1 - 0.05).abs() < 1.5 * SIGMA);
    }

    #[test]
    fn an_outline_that_stays_another_is_taken_over_and_a_single_one_is_not() {
        let mut outline = Outline::new(&Rect::new(0.0, 0.0, 0.2, 0.2).into(), SIGMA);
        let long = Rect::new(0.0, 0.0, 0.4, 0.2).into();
        assert!(!outline.see(&long) && (outline.beyond() - 0.1).abs() < 1e-12);
        assert!(!outline.see(&Rect::new(0.0, 0.0, 0.2, 0.2).into()));
        assert_eq!([0; 3].map(|_| outline.see(&long)), [false, false, true]);
        assert_eq!(outline.at(Point::new(0.2, 0.1)), long);
    }
}
