//! Shapes of obstacles in the arena frame: upright rectangles, simple polygons and discs.
//!
//! The paper's obstacles are upright rectangles and it names other forms as its limit
//! [Alghannam, Sec. VI]; vision finds these shapes, the grid covers them with rectangles, the exact
//! planner inflates them as they are. Metres.

use crate::geometry::{Point, Rect};
use serde::{Deserialize, Serialize};
use std::f64::consts::TAU;

/// The most corners that a polygon may have: whether edges cross is asked of all pairs.
pub const CORNER_LIMIT: usize = 4096;

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

/// A polygon whose edges touch only at the corners that they share; its corners are kept
/// counter-clockwise.
#[derive(Clone, Debug, PartialEq)]
pub struct Polygon {
    corners: Vec<Point>,
}

/// A disc.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(from = "[f64; 3]", into = "[f64; 3]")]
pub struct Circle {
    /// Its centre, metres.
    pub centre: Point,
    /// Its radius, metres.
    pub radius: f64,
}

/// Why numbers make no shape.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub enum ShapeError {
    /// Too few different corners.
    #[error("a polygon has three corners or more, this one has {count} different ones")]
    FewCorners {
        /// How many there are.
        count: usize,
    },
    /// Too many corners.
    #[error("a polygon has at most {CORNER_LIMIT} corners, this one has {count}")]
    ManyCorners {
        /// How many there are.
        count: usize,
    },
    /// Two edges cross or touch.
    #[error("its outline crosses or touches itself: edge {} meets edge {}", .edges[0] + 1, .edges[1] + 1)]
    Crossing {
        /// The indices of the corners at which the two edges begin.
        edges: [usize; 2],
    },
    /// A coordinate is infinite or no number.
    #[error("{value} is no coordinate")]
    NotFinite {
        /// What was given.
        value: f64,
    },
    /// A length that has to be above 0 is not.
    #[error("its {what} is {value} m; it must be above 0")]
    NoSize {
        /// What it is that has no size.
        what: &'static str,
        /// What was given, metres.
        value: f64,
    },
}

impl Polygon {
    /// The polygon with these corners, in either direction; repeated ones count once.
    ///
    /// # Errors
    /// [`ShapeError`] if there are too few corners or too many, one is not finite, or edges cross.
    ///
    /// ```
    /// use wmr::{geometry::Point, shape::{Polygon, ShapeError}};
    /// let at = |points: &[[f64; 2]]| Polygon::new(points.iter().map(|&p| Point::from(p)).collect());
    /// assert_eq!(at(&[[0.0, 0.0], [0.0, 1.0], [2.0, 0.0]])?.area(), 1.0);
    /// let bow_tie = at(&[[0.0, 0.0], [1.0, 1.0], [1.0, 0.0], [0.0, 1.0]]);
    /// assert_eq!(bow_tie, Err(ShapeError::Crossing { edges: [0, 2] }));
    /// # Ok::<(), ShapeError>(())
    /// ```
    pub fn new(mut corners: Vec<Point>) -> Result<Self, ShapeError> {
        if let Some(value) = corners.iter().flat_map(|p| [p.x, p.y]).find(|v| !v.is_finite()) {
            return Err(ShapeError::NotFinite { value });
        }
        corners.dedup();
        while corners.len() > 1 && corners.first() == corners.last() {
            corners.pop();
        }
        match corners.len() {
            count @ ..=2 => return Err(ShapeError::FewCorners { count }),
            count if count > CORNER_LIMIT => return Err(ShapeError::ManyCorners { count }),
            _ => {}
        }
        if let Some(edges) = first_crossing(&corners) {
            return Err(ShapeError::Crossing { edges });
        }
        let mut polygon = Self { corners };
        if polygon.signed_area() < 0.0 {
            polygon.corners.reverse();
        }
        if polygon.area() > 0.0 {
            Ok(polygon)
        } else {
            Err(ShapeError::NoSize { what: "area", value: polygon.area() })
        }
    }

    /// The corners, counter-clockwise, metres.
    pub fn corners(&self) -> &[Point] {
        &self.corners
    }

    /// The area, m².
    pub fn area(&self) -> f64 {
        self.signed_area().abs()
    }

    /// The edges from corner to corner, counter-clockwise.
    pub fn edges(&self) -> impl Iterator<Item = (Point, Point)> {
        edges(&self.corners)
    }

    fn signed_area(&self) -> f64 {
        self.edges().map(|(a, b)| a.x * b.y - b.x * a.y).sum::<f64>() / 2.0
    }

    /// Whether `point` lies inside, by the number of edges to its right (even-odd).
    fn contains(&self, point: Point) -> bool {
        let is_right = |(a, b): (Point, Point)| {
            (a.y > point.y) != (b.y > point.y)
                && point.x < a.x + (point.y - a.y) / (b.y - a.y) * (b.x - a.x)
        };
        self.edges().filter(|&edge| is_right(edge)).count() % 2 == 1
    }
}

fn edges(corners: &[Point]) -> impl Iterator<Item = (Point, Point)> {
    corners.iter().copied().zip(corners.iter().copied().cycle().skip(1))
}

/// The indices of the first two edges that have more in common than the corner between neighbours.
fn first_crossing(corners: &[Point]) -> Option<[usize; 2]> {
    let all: Vec<(Point, Point)> = edges(corners).collect();
    let count = all.len();
    for i in 0..count {
        for j in i + 1..count {
            let (a, b) = (all[i], all[j]);
            let meets = if j == i + 1 {
                folds_back(a.0, a.1, b.1)
            } else if i == 0 && j == count - 1 {
                folds_back(b.0, b.1, a.1)
            } else {
                meet(a, b)
            };
            if meets {
                return Some([i, j]);
            }
        }
    }
    None
}

/// Twice the signed area of the triangle, m²; positive if it turns left.
fn turn(a: Point, b: Point, c: Point) -> f64 {
    (b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x)
}

/// Whether the way from `a` over `b` to `c` goes back on itself.
fn folds_back(a: Point, b: Point, c: Point) -> bool {
    turn(a, b, c) == 0.0 && (b.x - a.x) * (c.x - b.x) + (b.y - a.y) * (c.y - b.y) < 0.0
}

/// Whether the two segments have a point in common.
fn meet(a: (Point, Point), b: (Point, Point)) -> bool {
    let apart = |p: f64, q: f64, r: f64, s: f64| p.max(q) < r.min(s) || r.max(s) < p.min(q);
    if apart(a.0.x, a.1.x, b.0.x, b.1.x) || apart(a.0.y, a.1.y, b.0.y, b.1.y) {
        return false;
    }
    let sides =
        |of: (Point, Point), p: (Point, Point)| (turn(of.0, of.1, p.0), turn(of.0, of.1, p.1));
    let splits = |(p, q): (f64, f64)| !((p > 0.0 && q > 0.0) || (p < 0.0 && q < 0.0));
    splits(sides(a, b)) && splits(sides(b, a))
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
                (segment_distance(circle.centre, a, b) - circle.radius).max(0.0)
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
        let ends = segment_distance(a, p, q).min(segment_distance(b, p, q));
        ends.min(segment_distance(p, a, b)).min(segment_distance(q, a, b))
    };
    edges(corners).map(to_edge).fold(f64::INFINITY, f64::min)
}

/// The distance between `point` and the straight leg from `a` to `b`.
fn segment_distance(point: Point, a: Point, b: Point) -> f64 {
    let (dx, dy) = (b.x - a.x, b.y - a.y);
    let square = dx * dx + dy * dy;
    let along = if square == 0.0 {
        0.0
    } else {
        (((point.x - a.x) * dx + (point.y - a.y) * dy) / square).clamp(0.0, 1.0)
    };
    point.distance(Point::new(a.x + along * dx, a.y + along * dy))
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
    fn what_is_no_polygon_is_refused_with_the_reason() {
        assert_eq!(polygon(&[[0.0, 0.0], [1.0, 0.0]]), Err(ShapeError::FewCorners { count: 2 }));
        let twice = [[0.0, 0.0], [1.0, 0.0], [0.0, 0.0]];
        assert_eq!(polygon(&twice), Err(ShapeError::FewCorners { count: 2 }));
        let spike = [[0.0, 0.0], [2.0, 0.0], [1.0, 0.0], [1.0, 1.0]];
        assert_eq!(polygon(&spike), Err(ShapeError::Crossing { edges: [0, 1] }));
        let touching = [[0.0, 0.0], [2.0, 0.0], [2.0, 2.0], [1.0, 0.0], [0.0, 2.0]];
        assert_eq!(polygon(&touching), Err(ShapeError::Crossing { edges: [0, 2] }));
        assert!(matches!(
            polygon(&[[0.0, f64::NAN], [1.0, 0.0], [0.0, 1.0]]),
            Err(ShapeError::NotFinite { .. })
        ));
        assert!(polygon(&[[0.0, 0.0], [1.0, 0.0], [2.0, 0.0]]).is_err());
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
