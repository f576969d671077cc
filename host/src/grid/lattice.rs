//! Points and rectangles with integer coordinates, in units of 0.1 mm.
//!
//! On integers a sign is a sign: whether a corner lies left of a leg, on it or right of it has one
//! answer, and no tolerance to tune. Obstacles round outwards, so rounding never costs safety.
//! Coordinates are at most [`COORDINATE_LIMIT`] in size: a cross product of two differences then
//! fits an `i64` four times over.

use crate::geometry::{Point, Rect};

/// Lattice units in one metre.
pub const UNITS_PER_METRE: f64 = 10_000.0;

/// The largest coordinate, units (53 km).
pub const COORDINATE_LIMIT: i32 = 1 << 29;

/// A value this close to a whole unit, in units, is meant to be that unit: 1.466 m is 14660 units
/// although the nearest `f64` lies a little above. Worth 0.1 nm.
const MEANT_WHOLE: f64 = 1e-6;

/// A point on the lattice, in units.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct LatticePoint {
    /// To the right of the arena's lower-left corner.
    pub x: i32,
    /// Above the arena's lower-left corner.
    pub y: i32,
}

impl LatticePoint {
    /// The point at (`x`, `y`) units.
    pub const fn new(x: i32, y: i32) -> Self {
        Self { x, y }
    }

    /// The lattice point nearest to `point`; `None` beyond [`COORDINATE_LIMIT`] or if not a number.
    ///
    /// ```
    /// use wmr::{geometry::Point, grid::LatticePoint};
    /// assert_eq!(LatticePoint::nearest(Point::new(0.12, 1.0)), Some(LatticePoint::new(1200, 10_000)));
    /// ```
    pub fn nearest(point: Point) -> Option<Self> {
        let x = checked((point.x * UNITS_PER_METRE).round())?;
        let y = checked((point.y * UNITS_PER_METRE).round())?;
        Some(Self { x, y })
    }

    /// The same place in metres.
    pub fn to_metres(self) -> Point {
        Point::new(f64::from(self.x) / UNITS_PER_METRE, f64::from(self.y) / UNITS_PER_METRE)
    }

    /// The straight distance to `other`, units.
    pub fn distance(self, other: Self) -> f64 {
        let (x, y) = self.to(other);
        ((x * x + y * y) as f64).sqrt()
    }

    /// The step from here to `other`.
    pub fn to(self, other: Self) -> (i64, i64) {
        (i64::from(other.x) - i64::from(self.x), i64::from(other.y) - i64::from(self.y))
    }
}

/// Twice the signed area of the triangle: positive if `a`, `b`, `c` turn left, 0 if on one line.
///
/// ```
/// use wmr::grid::{LatticePoint, turn};
/// let [a, b, c] = [(0, 0), (2, 0), (2, 1)].map(|(x, y)| LatticePoint::new(x, y));
/// assert_eq!(turn(a, b, c), 2);
/// ```
pub fn turn(a: LatticePoint, b: LatticePoint, c: LatticePoint) -> i64 {
    let (ux, uy) = a.to(b);
    let (vx, vy) = a.to(c);
    ux * vy - uy * vx
}

/// A rectangle on the lattice, in units.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct LatticeRect {
    /// Left edge.
    pub x0: i32,
    /// Lower edge.
    pub y0: i32,
    /// Right edge.
    pub x1: i32,
    /// Upper edge.
    pub y1: i32,
}

impl LatticeRect {
    /// The rectangle between (`x0`, `y0`) and (`x1`, `y1`).
    pub const fn new(x0: i32, y0: i32, x1: i32, y1: i32) -> Self {
        Self { x0, y0, x1, y1 }
    }

    /// `rect` with each edge `[left, lower, right, upper]` metres further out, rounded outwards;
    /// `None` beyond [`COORDINATE_LIMIT`].
    pub fn outwards(rect: Rect, [left, lower, right, upper]: [f64; 4]) -> Option<Self> {
        Some(Self {
            x0: floor(rect.x0 - left)?,
            y0: floor(rect.y0 - lower)?,
            x1: ceil(rect.x1 + right)?,
            y1: ceil(rect.y1 + upper)?,
        })
    }

    /// `rect` with each edge `by` metres further in, rounded inwards; `None` beyond [`COORDINATE_LIMIT`].
    pub fn inwards(rect: Rect, by: f64) -> Option<Self> {
        Some(Self {
            x0: ceil(rect.x0 + by)?,
            y0: ceil(rect.y0 + by)?,
            x1: floor(rect.x1 - by)?,
            y1: floor(rect.y1 - by)?,
        })
    }

    /// Whether `point` lies inside or on the edge.
    pub fn contains(self, point: LatticePoint) -> bool {
        self.x0 <= point.x && point.x <= self.x1 && self.y0 <= point.y && point.y <= self.y1
    }

    /// Whether `point` lies inside and not on the edge.
    pub fn contains_inside(self, point: LatticePoint) -> bool {
        self.x0 < point.x && point.x < self.x1 && self.y0 < point.y && point.y < self.y1
    }

    /// The point of the rectangle nearest to `point`.
    pub fn clamp(self, point: LatticePoint) -> LatticePoint {
        LatticePoint::new(point.x.max(self.x0).min(self.x1), point.y.max(self.y0).min(self.y1))
    }

    /// The part common to both; empty if not [`Self::has_area`].
    pub fn intersection(self, other: Self) -> Self {
        Self {
            x0: self.x0.max(other.x0),
            y0: self.y0.max(other.y0),
            x1: self.x1.min(other.x1),
            y1: self.y1.min(other.y1),
        }
    }

    /// Whether there is anything between the edges.
    pub fn has_area(self) -> bool {
        self.x0 < self.x1 && self.y0 < self.y1
    }

    /// Corners, counter-clockwise from the lower left.
    pub fn corners(self) -> [LatticePoint; 4] {
        [
            LatticePoint::new(self.x0, self.y0),
            LatticePoint::new(self.x1, self.y0),
            LatticePoint::new(self.x1, self.y1),
            LatticePoint::new(self.x0, self.y1),
        ]
    }
}

fn floor(metres: f64) -> Option<i32> {
    checked((metres * UNITS_PER_METRE + MEANT_WHOLE).floor())
}

fn ceil(metres: f64) -> Option<i32> {
    checked((metres * UNITS_PER_METRE - MEANT_WHOLE).ceil())
}

/// A whole number of units as an integer, if it is within the limit.
fn checked(units: f64) -> Option<i32> {
    (units.abs() <= f64::from(COORDINATE_LIMIT)).then_some(units as i32)
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn decimals_that_are_whole_units_stay_exact_and_others_round_outwards() {
        let rect = Rect::new(1.466, 0.1, 1.644, 0.300_01);
        let grown = LatticeRect::outwards(rect, [0.075; 4]).unwrap();
        assert_eq!(grown, LatticeRect::new(13910, 250, 17190, 3751));
    }

    #[test]
    fn what_is_too_far_or_no_number_is_refused() {
        for x in [f64::NAN, f64::INFINITY, 1e6] {
            assert_eq!(LatticePoint::nearest(Point::new(x, 0.0)), None);
        }
    }

    proptest! {
        #[test]
        fn a_rounded_rectangle_covers_the_given_one(x in -9.0..9.0, y in -9.0..9.0, w in 0.001..5.0) {
            let rect = Rect::new(x, y, x + w, y + w);
            let rounded = LatticeRect::outwards(rect, [0.0; 4]).unwrap();
            let slack = 2.0 * MEANT_WHOLE;
            prop_assert!(f64::from(rounded.x0) <= x * UNITS_PER_METRE + slack);
            prop_assert!(f64::from(rounded.y1) >= (y + w) * UNITS_PER_METRE - slack);
        }

        #[test]
        fn turning_the_other_way_round_changes_the_sign(c in proptest::array::uniform6(-9_i32..9)) {
            let [a, b, p] = [(c[0], c[1]), (c[2], c[3]), (c[4], c[5])].map(|(x, y)| LatticePoint::new(x, y));
            prop_assert_eq!(turn(a, b, p), -turn(b, a, p));
        }
    }
}
