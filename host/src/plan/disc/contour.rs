//! A shape inflated by a disc, as one closed contour on a lattice.
//!
//! ```text
//!      ______        Edges move out by the disc's radius; a corner that turns left becomes tangents of
//!    /       \       its arc, outside of it. At a corner that turns right the contour goes back to the
//!   |   ___   |      corner itself: what it encloses more than once counts once, and is the union of
//!   |  |   |__|      the shape, a strip along each edge and a wedge at each corner.
//! ```
//! Coordinates are in units of the lattice that [`Fine`] names.

use crate::geometry::Point;
use crate::grid::{COORDINATE_LIMIT, LatticePoint, UNITS_PER_METRE};
use crate::scene::Obstacle;
use crate::shape::Shape;
use std::f64::consts::{PI, TAU};

/// How far from the true arc a contour may lie, metres.
pub(super) const TOLERANCE: f64 = 0.0005;

/// What rounding a contour to the lattice and cutting it with others may move it, units.
const SLACK: f64 = 2.0;

/// The finest lattice has so many units in 0.1 mm.
const FINEST: i32 = 1 << 10;

/// A lattice finer than the grid's 0.1 mm, so that where two contours cross it is rounded by less than
/// anybody can measure.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Fine {
    per_metre: f64,
}

impl Fine {
    /// The finest lattice on which nothing lies further out than `reach` metres; `None` if none is.
    pub(super) fn for_reach(reach: f64) -> Option<Self> {
        let fits = |scale: &i32| {
            // Half the limit: what a contour adds to the reach is far less than the other half.
            reach * UNITS_PER_METRE * f64::from(*scale) < f64::from(COORDINATE_LIMIT / 2)
        };
        let scales = std::iter::successors(Some(FINEST), |scale| (*scale > 1).then_some(scale / 2));
        scales
            .into_iter()
            .find(fits)
            .map(|scale| Self { per_metre: UNITS_PER_METRE * f64::from(scale) })
    }

    pub(super) fn units(self, metres: f64) -> f64 {
        metres * self.per_metre
    }

    pub(super) fn nearest(self, point: Point) -> LatticePoint {
        // A cast stops at the largest integer; what is that far out is no part of the arena.
        let unit = |metres: f64| self.units(metres).round() as i32;
        LatticePoint::new(unit(point.x), unit(point.y))
    }

    pub(super) fn to_metres(self, point: LatticePoint) -> Point {
        Point::new(f64::from(point.x) / self.per_metre, f64::from(point.y) / self.per_metre)
    }

    /// Whether the coordinate is a whole number of units but for the rounding of decimals.
    fn is_whole(self, metres: f64) -> bool {
        const MEANT_WHOLE: f64 = 1e-3;
        let units = self.units(metres);
        (units - units.round()).abs() < MEANT_WHOLE
    }
}

/// A shape on the lattice and the radius that the robot's centre has to keep from it.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Inflated {
    /// Corners, counter-clockwise; a single one is the centre of a disc.
    pub(super) corners: Vec<LatticePoint>,
    /// The radius to keep from these corners and the edges between them, units.
    pub(super) radius: i32,
}

impl Inflated {
    /// `obstacle` with its margin, inflated by `radius` metres.
    pub(super) fn new(obstacle: &Obstacle, radius: f64, fine: Fine) -> Self {
        let (points, around) = match &obstacle.footprint {
            Shape::Rect(rect) => (rect.widened(obstacle.margin).corners().to_vec(), 0.0),
            Shape::Polygon(polygon) => (polygon.corners().to_vec(), obstacle.largest_margin()),
            Shape::Circle(circle) => {
                (vec![circle.centre], circle.radius + obstacle.largest_margin())
            }
        };
        let is_exact = points.iter().all(|p| fine.is_whole(p.x) && fine.is_whole(p.y));
        let mut corners: Vec<LatticePoint> = points.iter().map(|&p| fine.nearest(p)).collect();
        corners.dedup();
        const MEANT_WHOLE: f64 = 1e-3;
        let whole = (fine.units(radius + around) - MEANT_WHOLE).ceil().max(0.0) as i32;
        // Rounding moves a corner by less than a unit; the radius makes up for it.
        Self { corners, radius: whole + i32::from(!is_exact) }
    }

    /// The closed contour around all points nearer than the radius, counter-clockwise; the shape's own
    /// corners if the radius is 0.
    pub(super) fn contour(&self, fine: Fine) -> Vec<LatticePoint> {
        if self.radius == 0 {
            return self.corners.clone();
        }
        let radius = f64::from(self.radius) + SLACK;
        // The vertices of tangents are radius / cos(half the angle between them) from the corner.
        let reach = radius + fine.units(TOLERANCE) - 2.0 * SLACK;
        let half = (radius / reach.max(radius + SLACK)).acos();
        let mut contour = Vec::new();
        let count = self.corners.len();
        for (index, &corner) in self.corners.iter().enumerate() {
            let [before, after] = [index + count - 1, index + 1].map(|i| self.corners[i % count]);
            let at = |distance: f64, angle: f64| step(corner, distance, angle);
            if count == 1 {
                contour.extend(tangents(0.0, TAU, half, radius).map(|(d, a)| at(d, a)));
                continue;
            }
            let [from, to] = [normal(before, corner), normal(corner, after)];
            let turn = (to - from).rem_euclid(TAU);
            if turn <= PI {
                contour.extend(tangents(from, turn, half, radius).map(|(d, a)| at(d, a)));
            } else {
                contour.extend([at(radius, from), corner, at(radius, to)]);
            }
        }
        contour.dedup();
        contour
    }
}

/// The vertices of tangents over an arc of `turn` radians that begins at the angle `from`, as distance
/// and angle, at most twice `half` radians apart.
fn tangents(from: f64, turn: f64, half: f64, radius: f64) -> impl Iterator<Item = (f64, f64)> {
    let count = (turn / (2.0 * half)).ceil().max(1.0);
    let half = turn / (2.0 * count);
    (0..count as u32).map(move |i| (radius / half.cos(), from + half * f64::from(2 * i + 1)))
}

/// The direction straight out of the edge from `a` to `b` of a counter-clockwise outline, radians.
fn normal(a: LatticePoint, b: LatticePoint) -> f64 {
    let (x, y) = a.to(b);
    (-x as f64).atan2(y as f64)
}

fn step(from: LatticePoint, distance: f64, angle: f64) -> LatticePoint {
    let (sin, cos) = angle.sin_cos();
    LatticePoint::new(
        (f64::from(from.x) + distance * cos).round() as i32,
        (f64::from(from.y) + distance * sin).round() as i32,
    )
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::Rect;
    use crate::shape::{Circle, Polygon};
    use proptest::prelude::*;

    fn fine() -> Fine {
        Fine::for_reach(2.0).unwrap()
    }

    #[test]
    fn the_lattice_is_as_fine_as_the_arena_allows() {
        assert_eq!(Fine::for_reach(2.0).unwrap().per_metre, 10_240_000.0);
        assert_eq!(Fine::for_reach(10_000.0).unwrap().per_metre, 20_000.0);
        assert_eq!(Fine::for_reach(1e6), None);
    }

    #[test]
    fn without_a_radius_a_shape_is_its_own_contour_if_it_lies_on_the_lattice() {
        let rect = Rect::new(0.1, 0.2, 0.3, 0.4);
        let inflated = Inflated::new(&rect.into(), 0.0, fine());
        assert_eq!(inflated.radius, 0);
        assert_eq!(inflated.contour(fine()).len(), 4);
        let odd = Inflated::new(&Rect::new(1.0 / 3.0, 0.2, 0.4, 0.4).into(), 0.0, fine());
        assert_eq!(odd.radius, 1);
    }

    proptest! {
        #[test]
        fn a_contour_keeps_the_radius_and_stays_within_the_tolerance(
            [x, y, by, size] in proptest::array::uniform4(0.02..0.5_f64), turn in 0.0..TAU,
        ) {
            let corners = [0.3, 2.0, 4.4].map(|part| {
                Point::new(x + size * (turn + part).cos(), y + size * (turn + part).sin())
            });
            let triangle = Shape::from(Polygon::new(corners.to_vec()).unwrap());
            let disc = Shape::from(Circle { centre: Point::new(x, y), radius: size });
            for shape in [triangle, disc] {
                let obstacle: Obstacle =
                    Obstacle { footprint: shape.clone(), margin: [0.0; 4], height: None };
                let contour = Inflated::new(&obstacle, by, fine()).contour(fine());
                for (index, &vertex) in contour.iter().enumerate() {
                    let (at, next) = (
                        fine().to_metres(vertex),
                        fine().to_metres(contour[(index + 1) % contour.len()]),
                    );
                    prop_assert!(shape.distance(at) <= by + TOLERANCE, "{}", shape.distance(at) - by);
                    prop_assert!(shape.leg_distance(at, next) >= by, "{}", shape.leg_distance(at, next) - by);
                }
            }
        }
    }
}
