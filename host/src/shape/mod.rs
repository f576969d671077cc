//! Shapes of obstacles in the arena frame: upright rectangles, simple polygons and discs.
//!
//! The paper's obstacles are upright rectangles and it names other forms as its limit
//! [Alghannam, Sec. VI]; vision finds these shapes, the grid covers them with rectangles, the exact
//! planner inflates them as they are. Metres.

mod polygon;

pub use polygon::{CORNER_LIMIT, Polygon};

use crate::geometry::{Point, Rect, square_to_leg};
use polygon::{edges, meet};
use serde::{Deserialize, Serialize};
use std::f64::consts::TAU;

/// The outline of one obstacle.
///
/// In JSON `[x0, y0, x1, y1]`, `{"polygon": [[x, y], …]}` or `{"circle": [x, y, r]}`.
#[derive(Clone, Debug, PartialEq)]
pub enum Shape {
    /// A rectangle with sides parallel to the arena's.
    Rect(Rect),
    /// A simple polygon, concave ones included.
    Polygon(Polygon),
    /// A disc.
    Circle(Circle),
}

/// A disc.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
#[serde(from = "[f64; 3]", into = "[f64; 3]")]
pub struct Circle {
    /// Its centre, metres.
    pub centre: Point,
    /// Its radius, metres.
    pub radius: f64,
}

/// Why numbers make no shape.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error, miette::Diagnostic)]
pub enum ShapeError {
    /// Too few different corners.
    #[error("a polygon has three corners or more, this one has {count} different ones")]
    #[diagnostic(help("give at least three different corners"))]
    FewCorners {
        /// How many there are.
        count: usize,
    },
    /// Too many corners.
    #[error("a polygon has at most {CORNER_LIMIT} corners, this one has {count}")]
    #[diagnostic(help("leave out corners that hardly matter, or give several polygons"))]
    ManyCorners {
        /// How many there are.
        count: usize,
    },
    /// Two edges cross or touch.
    #[error("its outline crosses or touches itself: edge {} meets edge {}", .edges[0] + 1, .edges[1] + 1)]
    #[diagnostic(help("list the corners in the order in which they follow each other around it"))]
    Crossing {
        /// The indices of the corners at which the two edges begin.
        edges: [usize; 2],
    },
    /// A coordinate is infinite or no number.
    #[error("{value} is no coordinate")]
    #[diagnostic(help("give a finite number of metres"))]
    NotFinite {
        /// What was given.
        value: f64,
    },
    /// A length that has to be above 0 is not.
    #[error("its {what} is {value} m")]
    #[diagnostic(help("it must be above 0"))]
    NoSize {
        /// What it is that has no size.
        what: &'static str,
        /// What was given, metres.
        value: f64,
    },
}

impl From<[f64; 3]> for Circle {
    fn from([x, y, radius]: [f64; 3]) -> Self {
        Self { centre: Point::new(x, y), radius }
    }
}

impl From<Circle> for [f64; 3] {
    fn from(circle: Circle) -> Self {
        [circle.centre.x, circle.centre.y, circle.radius]
    }
}

impl From<Rect> for Shape {
    fn from(rect: Rect) -> Self {
        Self::Rect(rect)
    }
}

impl From<Polygon> for Shape {
    fn from(polygon: Polygon) -> Self {
        Self::Polygon(polygon)
    }
}

impl From<Circle> for Shape {
    fn from(circle: Circle) -> Self {
        Self::Circle(circle)
    }
}

/// Tangents that replace a circle where a polygon is needed; its corners lie 0.5 % of the radius outside.
const CIRCLE_TANGENTS: u32 = 32;

impl Shape {
    /// The rectangle, if the shape is an upright one.
    pub fn as_rect(&self) -> Option<Rect> {
        match self {
            Self::Rect(rect) => Some(*rect),
            Self::Polygon(_) | Self::Circle(_) => None,
        }
    }

    /// Makes sure that the numbers make a shape; polygons do so when they are made.
    ///
    /// # Errors
    /// [`ShapeError`] if a coordinate is not finite or a size not above 0.
    pub fn check(&self) -> Result<(), ShapeError> {
        let numbers: &[f64] = match self {
            Self::Rect(r) => &[r.x0, r.y0, r.x1, r.y1],
            Self::Circle(c) => &[c.centre.x, c.centre.y, c.radius],
            Self::Polygon(_) => &[],
        };
        if let Some(&value) = numbers.iter().find(|value| !value.is_finite()) {
            return Err(ShapeError::NotFinite { value });
        }
        let sizes: &[(&'static str, f64)] = match self {
            Self::Rect(r) => &[("width", r.x1 - r.x0), ("height", r.y1 - r.y0)],
            Self::Circle(c) => &[("radius", c.radius)],
            Self::Polygon(_) => &[],
        };
        match sizes.iter().find(|(_, size)| *size <= 0.0) {
            Some(&(what, value)) => Err(ShapeError::NoSize { what, value }),
            None => Ok(()),
        }
    }

    /// The upright rectangle around the shape.
    pub fn bounds(&self) -> Rect {
        match self {
            Self::Rect(rect) => *rect,
            Self::Circle(Circle { centre, radius }) => {
                let (x, y) = (centre.x, centre.y);
                Rect::new(x - radius, y - radius, x + radius, y + radius)
            }
            Self::Polygon(polygon) => Rect::around(polygon.corners()),
        }
    }

    /// The area, m².
    pub fn area(&self) -> f64 {
        match self {
            Self::Rect(rect) => rect.area(),
            Self::Polygon(polygon) => polygon.area(),
            Self::Circle(circle) => TAU / 2.0 * circle.radius * circle.radius,
        }
    }

    /// Whether `point` lies inside.
    pub fn contains(&self, point: Point) -> bool {
        match self {
            Self::Rect(rect) => rect.contains(point),
            Self::Polygon(polygon) => polygon.contains(point),
            Self::Circle(circle) => circle.centre.distance(point) < circle.radius,
        }
    }

    /// The distance from `point` to the shape, metres; 0 inside.
    pub fn distance(&self, point: Point) -> f64 {
        self.leg_distance(point, point)
    }

    /// The distance between the shape and the straight leg from `a` to `b`, metres; 0 where they meet.
    ///
    /// ```
    /// use wmr::{geometry::Point, shape::{Circle, Shape}};
    /// let disc = Shape::from(Circle { centre: Point::new(1.0, 1.0), radius: 0.25 });
    /// assert_eq!(disc.leg_distance(Point::new(0.0, 0.0), Point::new(2.0, 0.0)), 0.75);
    /// ```
    pub fn leg_distance(&self, a: Point, b: Point) -> f64 {
        match self {
            Self::Circle(circle) => {
                (square_to_leg(circle.centre, a, b).sqrt() - circle.radius).max(0.0)
            }
            Self::Rect(rect) => outline_distance(&rect.corners(), rect.contains(a), a, b),
            Self::Polygon(polygon) => {
                outline_distance(polygon.corners(), polygon.contains(a), a, b)
            }
        }
    }

    /// The shape `x` and `y` metres further.
    pub fn moved_by(&self, x: f64, y: f64) -> Self {
        let point = |at: &Point| Point::new(at.x + x, at.y + y);
        match self {
            Self::Rect(r) => Rect::new(r.x0 + x, r.y0 + y, r.x1 + x, r.y1 + y).into(),
            Self::Polygon(polygon) => {
                Polygon { corners: polygon.corners.iter().map(point).collect() }.into()
            }
            Self::Circle(c) => Circle { centre: point(&c.centre), ..*c }.into(),
        }
    }

    /// The corners of a polygon that covers the shape, counter-clockwise; of a disc, of tangents.
    pub fn outline(&self) -> Vec<Point> {
        match self {
            Self::Rect(rect) => rect.corners().to_vec(),
            Self::Polygon(polygon) => polygon.corners.clone(),
            Self::Circle(Circle { centre, radius }) => {
                let half = TAU / f64::from(2 * CIRCLE_TANGENTS);
                let reach = radius / half.cos();
                let corner = |index: u32| {
                    let angle = half * f64::from(2 * index + 1);
                    Point::new(centre.x + reach * angle.cos(), centre.y + reach * angle.sin())
                };
                (0..CIRCLE_TANGENTS).map(corner).collect()
            }
        }
    }

    /// Upright rectangles that together cover the shape and reach at most `step` metres beyond it in y:
    /// its rows between multiples of `step`. One for an upright rectangle.
    ///
    /// ```
    /// use wmr::{geometry::{Point, Rect}, shape::{Polygon, Shape}};
    /// let corners = [[0.0, 0.0], [2.0, 0.0], [2.0, 2.0]].map(Point::from).to_vec();
    /// let cover = Shape::from(Polygon::new(corners)?).cover(1.0);
    /// assert_eq!(cover, [Rect::new(0.0, 0.0, 2.0, 1.0), Rect::new(1.0, 1.0, 2.0, 2.0)]);
    /// # Ok::<(), wmr::shape::ShapeError>(())
    /// ```
    pub fn cover(&self, step: f64) -> Vec<Rect> {
        if let Self::Rect(rect) = self {
            return vec![*rect];
        }
        let outline = self.outline();
        let bounds = Rect::around(&outline);
        let mut levels: Vec<f64> = outline.iter().map(|corner| corner.y).collect();
        let (first, last) = ((bounds.y0 / step).ceil(), (bounds.y1 / step).floor());
        levels.extend((0..=(last - first).max(-1.0) as usize).map(|i| (first + i as f64) * step));
        levels.retain(|y| (bounds.y0..=bounds.y1).contains(y));
        levels.sort_by(f64::total_cmp);
        levels.dedup();
        levels.windows(2).flat_map(|row| row_cover(&outline, row[0], row[1])).collect()
    }
}

/// Rectangles over the part of the outline between `low` and `high`, where no corner lies between.
fn row_cover(outline: &[Point], low: f64, high: f64) -> Vec<Rect> {
    let middle = (low + high) / 2.0;
    let at = |(a, b): (Point, Point), y: f64| a.x + (y - a.y) / (b.y - a.y) * (b.x - a.x);
    let mut crossing: Vec<(Point, Point)> =
        edges(outline).filter(|(a, b)| (a.y > middle) != (b.y > middle)).collect();
    crossing.sort_by(|&a, &b| at(a, middle).total_cmp(&at(b, middle)));
    let spans = crossing.chunks_exact(2).map(|pair| {
        let (left, right) = (pair[0], pair[1]);
        let x0 = at(left, low).min(at(left, high));
        let x1 = at(right, low).max(at(right, high));
        Rect::new(x0, low, x1, high)
    });
    spans.collect()
}

/// The distance between the leg from `a` to `b` and what the outline encloses.
fn outline_distance(corners: &[Point], starts_inside: bool, a: Point, b: Point) -> f64 {
    if starts_inside {
        return 0.0;
    }
    let to_edge = |(p, q): (Point, Point)| {
        if meet((a, b), (p, q)) {
            return 0.0;
        }
        let ends = square_to_leg(a, p, q).min(square_to_leg(b, p, q));
        ends.min(square_to_leg(p, a, b)).min(square_to_leg(q, a, b))
    };
    edges(corners).map(to_edge).fold(f64::INFINITY, f64::min).sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn polygon(points: &[[f64; 2]]) -> Result<Polygon, ShapeError> {
        Polygon::new(points.iter().map(|&point| Point::from(point)).collect())
    }

    /// An L of three unit squares.
    fn ell() -> Shape {
        let corners = [[0.0, 0.0], [2.0, 0.0], [2.0, 1.0], [1.0, 1.0], [1.0, 2.0], [0.0, 2.0]];
        polygon(&corners).unwrap().into()
    }

    #[test]
    fn distances_to_a_concave_shape() {
        let ell = ell();
        assert_eq!(ell.distance(Point::new(1.5, 1.75)), 0.5);
        assert_eq!(ell.distance(Point::new(0.5, 1.5)), 0.0);
        assert!(ell.contains(Point::new(0.5, 1.5)) && !ell.contains(Point::new(1.5, 1.5)));
        // Across the notch, corner to corner, and past its inner corner.
        let leg = ell.leg_distance(Point::new(2.5, 1.5), Point::new(1.5, 2.5));
        assert!((leg - 2_f64.sqrt() / 2.0 * 1.0).abs() < 1e-12, "{leg}");
        assert_eq!(ell.leg_distance(Point::new(-1.0, 0.5), Point::new(3.0, 0.5)), 0.0);
    }

    proptest! {
        #[test]
        fn a_cover_covers_the_shape_and_little_more(
            [x, y, radius, step] in proptest::array::uniform4(0.1..1.0_f64),
            [u, v] in proptest::array::uniform2(-1.2..1.2_f64),
        ) {
            let disc = Shape::from(Circle { centre: Point::new(x, y), radius });
            for shape in [disc, ell()] {
                let cover = shape.cover(step);
                let bounds = shape.bounds();
                let at = Point::new(bounds.x0 + (u + 1.2) * radius, bounds.y0 + (v + 1.2) * radius);
                let is_covered = cover.iter().any(|rect| rect.distance(at) <= 1e-12);
                prop_assert!(is_covered || !shape.contains(at));
                // Tangents reach 0.5 % of the radius beyond a disc.
                prop_assert!(!is_covered || shape.distance(at) <= step + 0.005 * radius + 1e-9);
            }
        }

        #[test]
        fn no_sampled_point_of_the_leg_is_nearer(
            [ax, ay, bx, by] in proptest::array::uniform4(-1.0..4.0_f64),
        ) {
            let (a, b) = (Point::new(ax, ay), Point::new(bx, by));
            let shape = ell();
            let exact = shape.leg_distance(a, b);
            let cells = [[0.0, 0.0, 2.0, 1.0], [0.0, 1.0, 1.0, 2.0]].map(Rect::from);
            let sampled = (0..=1000)
                .map(|i| f64::from(i) / 1000.0)
                .map(|t| Point::new(ax + t * (bx - ax), ay + t * (by - ay)))
                .map(|at| cells.iter().map(|cell| cell.distance(at)).fold(f64::INFINITY, f64::min))
                .fold(f64::INFINITY, f64::min);
            prop_assert!(exact <= sampled + 1e-12 && sampled <= exact + a.distance(b) / 1000.0);
        }
    }
}
