//! The outline of a box grown by a disc: its edges further out, each corner an arc cut into tangents.
//!
//! ```text
//!      ______        The polygon holds the grown box: its sides touch the arc from outside, and its
//!    /                vertices are rounded away from the box to the lattice. A way that keeps out of
//!   |    r            it keeps the disc's radius.
//!   |   +---- box
//! ```
//! Lattice units.

use crate::grid::{LatticePoint, LatticeRect, turn};
use std::f64::consts::FRAC_PI_4;

/// By how much a way keeps off the outline in x and y, so that it never runs between two that touch.
const STANDOFF: i32 = 1;

/// What rounding to the lattice and [`STANDOFF`] take of the tolerance at most.
const ROUNDING: f64 = 3.0;

/// The outline of one grown box and the vertices at which ways turn around it.
#[derive(Clone, Debug)]
pub(super) struct Outline {
    /// Vertices, counter-clockwise; at each the outline turns left.
    pub(super) hull: Vec<LatticePoint>,
    /// Where ways turn: beside each vertex, a unit further out.
    pub(super) turns: Vec<LatticePoint>,
}

/// The vertices that replace a corner in the first quadrant, as steps from the corner,
/// counter-clockwise; none is further than radius and tolerance from it, [`STANDOFF`] included.
///
/// With m tangents over the quarter, vertices are radius / cos(π/4m) from the corner.
pub(super) fn arc(radius: i32, tolerance: i32) -> Vec<(i32, i32)> {
    let radius = f64::from(radius);
    let room = (f64::from(tolerance) - ROUNDING).max(1.0);
    let reach = |count: u32| radius / (FRAC_PI_4 / f64::from(count)).cos();
    let count = (1..).find(|&count| reach(count) <= radius + room).unwrap_or(1);
    let vertex = |index: u32| {
        let angle = FRAC_PI_4 * f64::from(2 * index + 1) / f64::from(count);
        let up = |part: f64| (reach(count) * part).ceil() as i32;
        (up(angle.cos()), up(angle.sin()))
    };
    (0..count).map(vertex).collect()
}

impl Outline {
    /// The outline of `rect` whose corners are replaced by `arc`.
    pub(super) fn new(rect: LatticeRect, arc: &[(i32, i32)]) -> Self {
        let quarter = |x: i32, y: i32, sign: (i32, i32)| {
            arc.iter().map(move |step| {
                (LatticePoint::new(x + sign.0 * step.0, y + sign.1 * step.1), sign)
            })
        };
        let mut vertices: Vec<(LatticePoint, (i32, i32))> = Vec::with_capacity(4 * arc.len());
        vertices.extend(quarter(rect.x1, rect.y1, (1, 1)));
        vertices.extend(quarter(rect.x0, rect.y1, (-1, 1)).rev());
        vertices.extend(quarter(rect.x0, rect.y0, (-1, -1)));
        vertices.extend(quarter(rect.x1, rect.y0, (1, -1)).rev());
        keep_convex(&mut vertices);
        let beside = |&(at, sign): &(LatticePoint, (i32, i32))| {
            LatticePoint::new(at.x + STANDOFF * sign.0, at.y + STANDOFF * sign.1)
        };
        Self {
            turns: vertices.iter().map(beside).collect(),
            hull: vertices.into_iter().map(|(at, _)| at).collect(),
        }
    }

    /// The rectangle around all of it.
    pub(super) fn span(&self) -> LatticeRect {
        let empty = LatticeRect::new(i32::MAX, i32::MAX, i32::MIN, i32::MIN);
        self.turns.iter().fold(empty, |span, at| {
            LatticeRect::new(
                span.x0.min(at.x),
                span.y0.min(at.y),
                span.x1.max(at.x),
                span.y1.max(at.y),
            )
        })
    }

    /// The hull's sides, counter-clockwise.
    fn sides(&self) -> impl Iterator<Item = (LatticePoint, LatticePoint)> {
        self.hull.iter().copied().zip(self.hull.iter().copied().cycle().skip(1))
    }

    /// Whether `point` lies inside the hull or on it.
    pub(super) fn holds(&self, point: LatticePoint) -> bool {
        self.sides().all(|(from, to)| turn(from, to, point) >= 0)
    }

    /// Whether the leg from `a` to `b` touches or crosses the hull: no line separates the two.
    pub(super) fn meets(&self, a: LatticePoint, b: LatticePoint) -> bool {
        let is_left = |at: &LatticePoint| turn(a, b, *at) > 0;
        let is_right = |at: &LatticePoint| turn(a, b, *at) < 0;
        let is_beside = self.hull.iter().all(is_left) || self.hull.iter().all(is_right);
        let is_beyond = |(from, to): (LatticePoint, LatticePoint)| {
            turn(from, to, a) < 0 && turn(from, to, b) < 0
        };
        !(is_beside || self.sides().any(is_beyond))
    }

    /// The vertices before and after number `at`, where ways turn.
    pub(super) fn beside(&self, at: usize) -> [usize; 2] {
        let count = self.turns.len();
        [(at + count - 1) % count, (at + 1) % count]
    }

    /// Whether a way from `from` over turn `at` passes the outline without cutting it.
    pub(super) fn is_tangent(&self, from: LatticePoint, at: usize) -> bool {
        let sides = self.beside(at).map(|beside| turn(from, self.turns[at], self.turns[beside]));
        sides.iter().all(|&side| side >= 0) || sides.iter().all(|&side| side <= 0)
    }
}

/// Drops vertices at which the polygon does not turn left: rounding may have made some.
fn keep_convex(vertices: &mut Vec<(LatticePoint, (i32, i32))>) {
    let is_idle = |vertices: &[(LatticePoint, (i32, i32))], at: usize| {
        let count = vertices.len();
        let [before, here, after] = [at + count - 1, at, at + 1].map(|i| vertices[i % count].0);
        turn(before, here, after) <= 0
    };
    while let Some(at) = (0..vertices.len()).find(|&at| is_idle(vertices, at)) {
        if vertices.len() <= 3 {
            return;
        }
        vertices.remove(at);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn a_radius_of_75_mm_needs_seven_tangents_for_a_millimetre() {
        // 750 / cos(π/4m) ≤ 757 for m = 6: 756.47; for m = 5: 759.35.
        assert_eq!((arc(750, 10).len(), arc(750, 20).len()), (6, 4));
        assert_eq!(arc(0, 10), [(0, 0)]);
    }

    proptest! {
        #[test]
        fn vertices_are_between_radius_and_tolerance(radius in 1..5000_i32, tolerance in 4..200_i32) {
            let rect = LatticeRect::new(-3000, -2000, 3000, 2000);
            let outline = Outline::new(rect, &arc(radius, tolerance));
            for (hull, turn) in outline.hull.iter().zip(&outline.turns) {
                let off = |at: &LatticePoint| rect.clamp(*at).distance(*at);
                prop_assert!(off(hull) >= f64::from(radius) - 1e-9);
                prop_assert!(off(turn) <= f64::from(radius + tolerance) + 1e-9, "{}", off(turn));
                prop_assert!(!outline.holds(*turn) && outline.holds(*hull));
            }
        }

        #[test]
        fn the_hull_holds_every_point_within_the_radius(
            radius in 1..5000_i32, angle in 0.0..std::f64::consts::TAU, part in 0.0..1.0_f64,
        ) {
            let rect = LatticeRect::new(0, 0, 300, 200);
            let outline = Outline::new(rect, &arc(radius, 10));
            for corner in rect.corners() {
                let reach = f64::from(radius) * part.sqrt();
                let at = LatticePoint::new(
                    corner.x + (reach * angle.cos()).trunc() as i32,
                    corner.y + (reach * angle.sin()).trunc() as i32,
                );
                prop_assert!(outline.holds(at) && outline.meets(at, at));
            }
        }
    }
}
