//! Points, rectangles and poses in the arena frame, in metres and radians, as `f64`.
//!
//! These are the words that vision, grid and plan share; the robot's own `f32` types live in
//! [`protocol::motion`] and the conversion is in one place, the legs.

mod side;

use serde::{Deserialize, Serialize};
pub use side::{PerSide, Side};
use std::f64::consts::{PI, TAU};

/// A point of the arena, metres. In JSON: `[x, y]`.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
#[serde(from = "[f64; 2]", into = "[f64; 2]")]
pub struct Point {
    /// To the right of the arena's lower-left corner, metres.
    pub x: f64,
    /// Above the arena's lower-left corner, metres.
    pub y: f64,
}

impl Point {
    /// The point at (`x`, `y`) metres.
    pub const fn new(x: f64, y: f64) -> Self {
        Self { x, y }
    }

    /// The straight distance to `other`, metres.
    pub fn distance(self, other: Self) -> f64 {
        (other.x - self.x).hypot(other.y - self.y)
    }
}

/// The square of the distance between a point and the straight leg from `a` to `b`, m².
pub(crate) fn square_to_leg(point: Point, a: Point, b: Point) -> f64 {
    let (dx, dy) = (b.x - a.x, b.y - a.y);
    let square = dx * dx + dy * dy;
    let along = if square == 0.0 {
        0.0
    } else {
        (((point.x - a.x) * dx + (point.y - a.y) * dy) / square).clamp(0.0, 1.0)
    };
    let (x, y) = (a.x + along * dx - point.x, a.y + along * dy - point.y);
    x * x + y * y
}

impl From<[f64; 2]> for Point {
    fn from([x, y]: [f64; 2]) -> Self {
        Self { x, y }
    }
}

impl From<Point> for [f64; 2] {
    fn from(point: Point) -> Self {
        [point.x, point.y]
    }
}

/// The floor's size, metres.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
pub struct Arena {
    /// Along x, metres.
    pub width: f64,
    /// Along y, metres.
    pub height: f64,
}

/// A rectangle with sides parallel to the arena's, metres. In JSON: `[x0, y0, x1, y1]`.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
#[serde(from = "[f64; 4]", into = "[f64; 4]")]
pub struct Rect {
    /// Left edge, metres.
    pub x0: f64,
    /// Lower edge, metres.
    pub y0: f64,
    /// Right edge, metres.
    pub x1: f64,
    /// Upper edge, metres.
    pub y1: f64,
}

impl Rect {
    /// The rectangle between the lower-left corner (`x0`, `y0`) and the upper-right corner (`x1`, `y1`).
    pub const fn new(x0: f64, y0: f64, x1: f64, y1: f64) -> Self {
        Self { x0, y0, x1, y1 }
    }

    /// The smallest rectangle around `points`; inside out if there are none.
    pub fn around(points: &[Point]) -> Self {
        let nothing = Self::new(f64::INFINITY, f64::INFINITY, f64::NEG_INFINITY, f64::NEG_INFINITY);
        points.iter().fold(nothing, |around, at| Self {
            x0: around.x0.min(at.x),
            y0: around.y0.min(at.y),
            x1: around.x1.max(at.x),
            y1: around.y1.max(at.y),
        })
    }

    /// The point in the middle.
    pub const fn centre(self) -> Point {
        Point::new(f64::midpoint(self.x0, self.x1), f64::midpoint(self.y0, self.y1))
    }

    /// The corners, counter-clockwise from the lower left.
    pub fn corners(self) -> [Point; 4] {
        let Self { x0, y0, x1, y1 } = self;
        [Point::new(x0, y0), Point::new(x1, y0), Point::new(x1, y1), Point::new(x0, y1)]
    }

    /// The area, m².
    pub fn area(self) -> f64 {
        (self.x1 - self.x0) * (self.y1 - self.y0)
    }

    /// The rectangle with its left, lower, right and upper edge so many metres further out.
    pub fn widened(self, [left, lower, right, upper]: [f64; 4]) -> Self {
        Self { x0: self.x0 - left, y0: self.y0 - lower, x1: self.x1 + right, y1: self.y1 + upper }
    }

    /// The smallest rectangle that holds both.
    pub fn union(self, other: Self) -> Self {
        let (x0, y0) = (self.x0.min(other.x0), self.y0.min(other.y0));
        Self { x0, y0, x1: self.x1.max(other.x1), y1: self.y1.max(other.y1) }
    }

    /// Whether the two have more than an edge in common.
    pub fn overlaps(self, other: Self) -> bool {
        self.x0 < other.x1 && other.x0 < self.x1 && self.y0 < other.y1 && other.y0 < self.y1
    }

    /// Whether `point` lies strictly inside.
    pub fn contains(self, point: Point) -> bool {
        self.x0 < point.x && point.x < self.x1 && self.y0 < point.y && point.y < self.y1
    }

    /// The distance from `point` to the rectangle, metres; 0 inside.
    pub fn distance(self, point: Point) -> f64 {
        let dx = (self.x0 - point.x).max(point.x - self.x1).max(0.0);
        let dy = (self.y0 - point.y).max(point.y - self.y1).max(0.0);
        dx.hypot(dy)
    }
}

impl From<[f64; 4]> for Rect {
    fn from([x0, y0, x1, y1]: [f64; 4]) -> Self {
        Self { x0, y0, x1, y1 }
    }
}

impl From<Rect> for [f64; 4] {
    fn from(rect: Rect) -> Self {
        [rect.x0, rect.y0, rect.x1, rect.y1]
    }
}

/// Where a robot stands and looks: metres and radians. In JSON: `[x, y, heading]`.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
#[serde(from = "[f64; 3]", into = "[f64; 3]")]
pub struct Pose {
    /// The centre of the wheel axis, metres.
    pub position: Point,
    /// Counter-clockwise from +x, radians, in (-π, π].
    pub heading: f64,
}

impl Pose {
    /// The pose at (`x`, `y`) metres with `heading` radians.
    pub const fn new(x: f64, y: f64, heading: f64) -> Self {
        Self { position: Point::new(x, y), heading }
    }

    /// The pose that is `next` as seen from this one.
    ///
    /// ```
    /// use std::f64::consts::FRAC_PI_2;
    /// use wmr::geometry::Pose;
    /// let there = Pose::new(1.0, 2.0, FRAC_PI_2).then(Pose::new(0.5, 0.0, FRAC_PI_2));
    /// assert!((there.position.y - 2.5).abs() < 1e-12 && (there.heading - 2.0 * FRAC_PI_2).abs() < 1e-12);
    /// ```
    pub fn then(self, next: Self) -> Self {
        let (sin, cos) = self.heading.sin_cos();
        let Point { x, y } = next.position;
        Self::new(
            self.position.x + cos * x - sin * y,
            self.position.y + sin * x + cos * y,
            wrap_angle(self.heading + next.heading),
        )
    }

    /// The pose from which the arena's origin is seen as the arena's origin sees this one:
    /// `pose.inverse().then(pose)` is the origin.
    pub fn inverse(self) -> Self {
        let (sin, cos) = self.heading.sin_cos();
        let Point { x, y } = self.position;
        Self::new(-cos * x - sin * y, sin * x - cos * y, wrap_angle(-self.heading))
    }
}

impl From<[f64; 3]> for Pose {
    fn from([x, y, heading]: [f64; 3]) -> Self {
        Self::new(x, y, heading)
    }
}

impl From<Pose> for [f64; 3] {
    fn from(pose: Pose) -> Self {
        [pose.position.x, pose.position.y, pose.heading]
    }
}

/// The same direction in (-π, π], radians; a half turn is +π.
///
/// ```
/// use std::f64::consts::PI;
/// use wmr::geometry::wrap_angle;
/// assert_eq!(wrap_angle(-PI), PI);
/// assert!((wrap_angle(7.0) - (7.0 - 2.0 * PI)).abs() < 1e-12);
/// ```
pub fn wrap_angle(angle: f64) -> f64 {
    if angle > -PI && angle <= PI {
        return angle;
    }
    let turned = angle.rem_euclid(TAU);
    if turned > PI { turned - TAU } else { turned }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn a_wrapped_angle_is_the_same_direction_within_a_half_turn(angle in -1e4..1e4) {
            let wrapped = wrap_angle(angle);
            prop_assert!(wrapped > -PI && wrapped <= PI);
            // Rounding of the angle itself, at 1e4.
            prop_assert!((wrapped.sin() - angle.sin()).abs() < 1e-9);
            prop_assert!((wrapped.cos() - angle.cos()).abs() < 1e-9);
        }
    }

    #[test]
    fn distance_to_a_leg_is_measured_to_its_nearest_point() {
        let (a, b) = (Point::new(0.0, 0.0), Point::new(3.0, 4.0));
        let distance = |x, y| square_to_leg(Point::new(x, y), a, b).sqrt();
        assert_eq!(distance(1.5, 2.0), 0.0);
        assert!((distance(-0.8, 0.6) - 1.0).abs() < 1e-12, "before its start");
        assert!((distance(3.0 + 0.6, 4.0 + 0.8) - 1.0).abs() < 1e-12, "behind its end");
        assert!((distance(1.5 - 0.08, 2.0 + 0.06) - 0.1).abs() < 1e-12, "beside it");
        assert_eq!(square_to_leg(b, a, a), 25.0);
    }

    #[test]
    fn distance_to_a_rectangle_is_measured_to_its_nearest_edge_or_corner() {
        let rect = Rect::new(1.0, 1.0, 2.0, 3.0);
        assert_eq!(rect.distance(Point::new(1.5, 2.0)), 0.0);
        assert_eq!(rect.distance(Point::new(0.0, 2.0)), 1.0);
        assert_eq!(rect.distance(Point::new(5.0, 7.0)), 5.0);
    }
}
