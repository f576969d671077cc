//! Whether the robot, as a point, can drive a straight leg: an exact test on integers.
//!
//! It knows nothing of areas or cells; it looks at the grown boxes alone, and so serves both the
//! paper's "can go directly" and, independently of the search that found it, the check of every
//! path before it leaves the planner.
//!
//! The rule: touching is allowed, squeezing is not. A leg may run along a box or over its corner,
//! but at every point one of its two sides must be free. Where two boxes touch, or a box touches
//! the border, there is no gap to pass. Lattice units.

use super::box_index::BoxIndex;
use crate::grid::{EnlargedArena, LatticePoint, LatticeRect, turn};

/// The grown boxes, ready to be asked about legs.
#[derive(Clone, Debug)]
pub struct LegTest {
    inside: LatticeRect,
    boxes: Vec<LatticeRect>,
    index: BoxIndex,
}

impl LegTest {
    /// A test against the boxes and the border of `arena`.
    pub fn new(arena: &EnlargedArena) -> Self {
        let index = BoxIndex::new(arena.inside, &arena.boxes);
        Self { inside: arena.inside, boxes: arena.boxes.clone(), index }
    }

    /// The index of the grown boxes.
    pub(super) fn index(&self) -> &BoxIndex {
        &self.index
    }

    /// The grown boxes that touch `range`, and some others.
    fn near(&self, range: LatticeRect) -> impl Iterator<Item = LatticeRect> {
        self.index.near(range).map(|number| self.boxes[number])
    }

    /// Whether the straight leg from `a` to `b` is free.
    ///
    /// ```
    /// use wmr::{geometry::Rect, grid::{LatticePoint, enlarge}, plan::LegTest, scene::Scene};
    /// let mut scene = Scene::new(1.0, 1.0);
    /// scene.obstacles.push(Rect::new(0.4, 0.4, 0.6, 0.6).into());
    /// let arena = enlarge(&scene, 0.0)?;
    /// let test = LegTest::new(&arena);
    /// let [low, edge, high] = [1000, 3250, 9000].map(|y| LatticePoint::new(1000, y));
    /// assert!(test.is_free(low, high));
    /// assert!(test.is_free(edge, LatticePoint::new(9000, 3250))); // along the box
    /// assert!(!test.is_free(low, LatticePoint::new(9000, 9000))); // through it
    /// # Ok::<(), wmr::grid::GridError>(())
    /// ```
    pub fn is_free(&self, a: LatticePoint, b: LatticePoint) -> bool {
        if !(self.inside.contains(a) && self.inside.contains(b)) {
            return false;
        }
        let span = spanned(a, b);
        let mut stops = Vec::new();
        for grown in self.near(span) {
            if !touch(span, grown) {
                continue;
            }
            let corners = grown.corners();
            let sides = corners.map(|corner| turn(a, b, corner));
            if sides.iter().all(|&side| side > 0) || sides.iter().all(|&side| side < 0) {
                continue;
            }
            if crosses(a, b, grown) {
                return false;
            }
            let is_between = |c: LatticePoint| c != a && c != b && span.contains(c);
            let on_line = corners.into_iter().zip(sides).filter(|(_, side)| *side == 0);
            stops.extend(on_line.map(|(corner, _)| corner).filter(|&corner| is_between(corner)));
        }
        // Only at its ends and where it passes a corner does an oblique leg touch anything.
        a == b
            || (stops.is_empty() && a.x != b.x && a.y != b.y)
            || self.has_a_free_side(a, b, stops)
    }

    /// Whether the path over `points` is free, corners between its legs included; the index of the
    /// first leg that is not, otherwise.
    ///
    /// # Errors
    /// The index of the refused leg; a refused corner counts as the leg that leaves it.
    pub fn check_path(&self, points: &[LatticePoint]) -> Result<(), usize> {
        for (leg, pair) in points.windows(2).enumerate() {
            if !self.is_free(pair[0], pair[1]) {
                return Err(leg);
            }
        }
        for (leg, three) in points.windows(3).enumerate() {
            if !self.is_passable(doubled(three[1]), three[1].to(three[0]), three[1].to(three[2])) {
                return Err(leg + 1);
            }
        }
        Ok(())
    }

    /// Whether a way can turn at `point`: it is free, and a box's corner stands there.
    pub(super) fn is_turning_point(&self, point: LatticePoint) -> bool {
        self.inside.contains(point)
            && self.free_quadrants(doubled(point)).iter().filter(|&&free| free).count() == 3
    }

    /// Whether at every point between `a` and `b` the leg's left or its right side is free. Boxes
    /// that it touches change only at the `stops`, where one of their corners lies on the leg: it is
    /// enough to look at those and halfway between them.
    fn has_a_free_side(
        &self,
        a: LatticePoint,
        b: LatticePoint,
        mut stops: Vec<LatticePoint>,
    ) -> bool {
        stops.extend([a, b]);
        stops.sort_unstable();
        stops.dedup();
        let forward = a.to(b);
        let back = b.to(a);
        let halfway = stops.windows(2).map(|pair| {
            let (first, second) = (doubled(pair[0]), doubled(pair[1]));
            ((first.0 + second.0) / 2, (first.1 + second.1) / 2)
        });
        let on_corners = stops.iter().filter(|&&stop| stop != a && stop != b).map(|&p| doubled(p));
        halfway.chain(on_corners).all(|point| self.is_passable(point, back, forward))
    }

    /// Whether a way that comes to `point` (in half units) from the direction `from` and leaves it
    /// towards `to` can go round the point on one of its two sides through free space alone.
    fn is_passable(&self, point: (i64, i64), from: (i64, i64), to: (i64, i64)) -> bool {
        let (from, to) = (octant(from), octant(to));
        let free = self.free_quadrants(point);
        let turns_freely = |from: usize, to: usize| {
            let eighths = (to + 8 - from) % 8;
            (0..=eighths).map(|step| (from + step) % 8).all(|at| at % 2 == 0 || free[at / 2])
        };
        from == to || turns_freely(from, to) || turns_freely(to, from)
    }

    /// Which of the four quadrants around `point` (in half units) are free, counter-clockwise from
    /// the upper right.
    fn free_quadrants(&self, point: (i64, i64)) -> [bool; 4] {
        // Half a unit more on all sides, so that what touches the point is among them.
        let at = |half: i64| (half.div_euclid(2) as i32, (half + 1).div_euclid(2) as i32);
        let ((x0, x1), (y0, y1)) = (at(point.0), at(point.1));
        let mut free = QUADRANTS.map(|towards| reaches_into(self.inside, point, towards));
        let around = LatticeRect::new(x0, y0, x1, y1);
        for grown in self.near(around).filter(|&grown| touch(around, grown)) {
            for (free, &towards) in free.iter_mut().zip(&QUADRANTS) {
                *free &= !reaches_into(grown, point, towards);
            }
        }
        free
    }
}

/// The signs of x and y in each quadrant, counter-clockwise from the upper right.
const QUADRANTS: [(i64, i64); 4] = [(1, 1), (-1, 1), (-1, -1), (1, -1)];

/// Whether `rect` covers the surroundings of `point` (in half units) in one quadrant.
fn reaches_into(rect: LatticeRect, point: (i64, i64), towards: (i64, i64)) -> bool {
    // A quarter of a unit into the quadrant, in quarter units.
    let x = 2 * point.0 + towards.0;
    let y = 2 * point.1 + towards.1;
    let quarter = |value: i32| 4 * i64::from(value);
    quarter(rect.x0) < x && x < quarter(rect.x1) && quarter(rect.y0) < y && y < quarter(rect.y1)
}

/// The direction as eighths of a turn: even along an axis, odd inside a quadrant.
fn octant((x, y): (i64, i64)) -> usize {
    match (x.signum(), y.signum()) {
        (1, 0) => 0,
        (1, 1) => 1,
        (0, 1) => 2,
        (-1, 1) => 3,
        (-1, 0) => 4,
        (-1, -1) => 5,
        (0, -1) => 6,
        _ => 7,
    }
}

/// Whether the leg from `a` to `b` passes through the inside of `rect`.
pub(super) fn crosses(a: LatticePoint, b: LatticePoint, rect: LatticeRect) -> bool {
    let span = spanned(a, b);
    let apart =
        span.x1 <= rect.x0 || rect.x1 <= span.x0 || span.y1 <= rect.y0 || rect.y1 <= span.y0;
    if apart || !rect.has_area() {
        return false;
    }
    let sides = rect.corners().map(|corner| turn(a, b, corner));
    let on_one_side = sides.iter().all(|&side| side >= 0) || sides.iter().all(|&side| side <= 0);
    a == b || !on_one_side
}

/// Whether the two have a point in common.
fn touch(a: LatticeRect, b: LatticeRect) -> bool {
    a.x0 <= b.x1 && b.x0 <= a.x1 && a.y0 <= b.y1 && b.y0 <= a.y1
}

fn spanned(a: LatticePoint, b: LatticePoint) -> LatticeRect {
    LatticeRect::new(a.x.min(b.x), a.y.min(b.y), a.x.max(b.x), a.y.max(b.y))
}

fn doubled(point: LatticePoint) -> (i64, i64) {
    (2 * i64::from(point.x), 2 * i64::from(point.y))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn arena(boxes: &[[i32; 4]]) -> EnlargedArena {
        let whole = LatticeRect::new(0, 0, 10, 10);
        let boxes = boxes.iter().map(|&[a, b, c, d]| LatticeRect::new(a, b, c, d)).collect();
        EnlargedArena::new(whole, whole, boxes)
    }

    fn is_free(boxes: &[[i32; 4]], a: (i32, i32), b: (i32, i32)) -> bool {
        let arena = arena(boxes);
        let test = LegTest::new(&arena);
        let [a, b] = [a, b].map(|(x, y)| LatticePoint::new(x, y));
        assert_eq!(test.is_free(a, b), test.is_free(b, a), "the test depends on the direction");
        test.is_free(a, b)
    }

    #[test]
    fn a_leg_may_touch_corners_and_edges() {
        let square = [[3, 3, 6, 6]];
        assert!(is_free(&square, (0, 3), (10, 3)));
        assert!(is_free(&square, (0, 6), (6, 0)), "over the lower left corner");
        assert!(!is_free(&square, (0, 7), (6, 0)));
        assert!(!is_free(&square, (4, 4), (5, 5)), "wholly inside");
    }

    #[test]
    fn a_zero_gap_is_no_way() {
        assert!(!is_free(&[[2, 2, 8, 5], [2, 5, 8, 8]], (0, 5), (10, 5)), "shared edge");
        assert!(!is_free(&[[2, 2, 8, 5], [2, 5, 8, 8]], (3, 5), (4, 5)), "inside the shared edge");
        assert!(!is_free(&[[2, 0, 8, 5]], (0, 0), (10, 0)), "between box and border");
        assert!(is_free(&[[2, 1, 8, 5]], (0, 0), (10, 0)), "a gap of one unit");
    }

    #[test]
    fn touching_corners_are_no_way_in_any_direction() {
        let touching = [[2, 2, 5, 5], [5, 5, 8, 8]];
        assert!(!is_free(&touching, (2, 8), (8, 2)));
        assert!(!is_free(&touching, (3, 5), (7, 5)), "from one edge to the other");
        assert!(is_free(&touching, (2, 8), (5, 5)), "up to the corner");
    }

    #[test]
    fn a_leg_between_boxes_on_either_side_that_do_not_touch_is_free() {
        assert!(is_free(&[[1, 1, 3, 5], [4, 5, 6, 8]], (0, 5), (10, 5)));
        assert!(!is_free(&[[1, 1, 4, 5], [4, 5, 6, 8]], (0, 5), (10, 5)));
    }

    #[test]
    fn a_path_may_not_change_sides_in_a_corner_where_boxes_touch() {
        let arena = arena(&[[2, 2, 5, 5], [5, 5, 8, 8]]);
        let test = LegTest::new(&arena);
        let path = [(3, 5), (5, 5), (7, 5)].map(|(x, y)| LatticePoint::new(x, y));
        assert_eq!(test.check_path(&path), Err(1));
        let back = [(3, 5), (5, 5), (5, 8)].map(|(x, y)| LatticePoint::new(x, y));
        assert_eq!(test.check_path(&back), Ok(()));
    }
}
