//! Whether a disc can drive a straight leg: an exact test on integers, apart from every search.
//!
//! A leg is free if it keeps the disc's radius from every box, and its ends lie inside the shrunk
//! border. The distance of a leg to a box is that of one of its ends, or of a corner that the leg
//! passes: the square of a cross product against that of radius and leg, in `i128`. Lattice units.

use super::super::box_index::BoxIndex;
use super::super::leg_check::crosses;
use crate::grid::{LatticePoint, LatticeRect, turn};

/// The boxes before they grow by the disc.
#[derive(Clone, Debug)]
pub(super) struct DiscTest {
    inside: LatticeRect,
    boxes: Vec<LatticeRect>,
    radius: i32,
    /// By the boxes grown by the radius.
    index: BoxIndex,
}

impl DiscTest {
    pub(super) fn new(inside: LatticeRect, boxes: Vec<LatticeRect>, radius: i32) -> Self {
        let grown: Vec<LatticeRect> = boxes.iter().map(|&rect| grow(rect, radius)).collect();
        Self { inside, radius, index: BoxIndex::new(inside, &grown), boxes }
    }

    /// Whether the disc can stand at `point`; touching is allowed.
    pub(super) fn holds(&self, point: LatticePoint) -> bool {
        self.is_free(point, point)
    }

    /// Whether the disc can drive straight from `a` to `b`.
    pub(super) fn is_free(&self, a: LatticePoint, b: LatticePoint) -> bool {
        let span = LatticeRect::new(a.x.min(b.x), a.y.min(b.y), a.x.max(b.x), a.y.max(b.y));
        let mut near = self.index.near(span);
        self.inside.contains(a) && self.inside.contains(b) && near.all(|k| self.keeps_off(k, a, b))
    }

    /// The index of the first leg over `points` that is not free, as an error.
    pub(super) fn check_path(&self, points: &[LatticePoint]) -> Result<(), usize> {
        match points.windows(2).position(|leg| !self.is_free(leg[0], leg[1])) {
            Some(leg) => Err(leg),
            None => Ok(()),
        }
    }

    /// Whether the leg keeps the radius from the box with the number `index`.
    pub(super) fn keeps_off(&self, index: usize, a: LatticePoint, b: LatticePoint) -> bool {
        let rect = self.boxes[index];
        let radius = i128::from(self.radius).pow(2);
        let is_off = |from: LatticePoint, to: LatticePoint| square(from.to(to)) >= radius;
        let passes_off = |corner: LatticePoint| {
            let (along, to_corner, back) = (a.to(b), a.to(corner), b.to(corner));
            let is_passed = dot(along, to_corner) > 0 && dot(along, back) < 0;
            !is_passed || i128::from(turn(a, b, corner)).pow(2) >= radius * square(along)
        };
        is_off(a, rect.clamp(a))
            && is_off(b, rect.clamp(b))
            && !crosses(a, b, rect)
            && rect.corners().into_iter().all(passes_off)
    }
}

/// `rect` with all its edges `by` units further out.
pub(super) fn grow(rect: LatticeRect, by: i32) -> LatticeRect {
    LatticeRect::new(rect.x0 - by, rect.y0 - by, rect.x1 + by, rect.y1 + by)
}

fn dot(a: (i64, i64), b: (i64, i64)) -> i64 {
    a.0 * b.0 + a.1 * b.1
}

fn square(step: (i64, i64)) -> i128 {
    i128::from(dot(step, step))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_leg_may_touch_the_arc_and_not_cut_it() {
        // A 3-4-5 triangle: the line from (25, 0) to (0, 33) units is 20 from the origin at (16, 12).
        let inside = LatticeRect::new(-100, -100, 100, 100);
        let test = |radius| DiscTest::new(inside, vec![LatticeRect::new(-9, -9, 0, 0)], radius);
        let [a, b] = [(40, -20), (-20, 60)].map(|(x, y)| LatticePoint::new(x, y));
        // 4x + 3y = 100 is exactly 20 from the origin.
        assert!(test(20).is_free(a, b) && !test(21).is_free(a, b));
        assert!(test(20).holds(LatticePoint::new(16, 12)));
        assert!(!test(20).holds(LatticePoint::new(16, 11)));
        assert_eq!(test(21).check_path(&[a, a, b]), Err(1));
    }

    #[test]
    fn a_leg_through_a_box_is_not_free_however_small_the_disc() {
        let inside = LatticeRect::new(0, 0, 100, 100);
        let test = DiscTest::new(inside, vec![LatticeRect::new(40, 0, 60, 90)], 1);
        assert!(!test.is_free(LatticePoint::new(10, 50), LatticePoint::new(90, 50)));
        assert!(!test.is_free(LatticePoint::new(10, 50), LatticePoint::new(-1, 50)));
    }
}
