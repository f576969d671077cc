//! From areas to points: where the path enters and leaves each area, and which of these points it
//! can do without [Alghannam, Sec. III].
//!
//! The entry point of the first area is the start, the exit point of the last the goal; the exit
//! point of one area is the entry point of the next. To a neighbour beside or above, the way is the
//! shortest straight line to the shared border; to a diagonal one, the straight line to the corner.
//! Lattice units.

use super::LegTest;
use crate::grid::{Area, LatticePoint, MiniMatrix};
use std::collections::HashMap;

/// The exit point of `from` and entry point of its neighbour `next`, for a robot at `point` in `from`.
pub(super) fn exit_point(
    matrix: &MiniMatrix,
    point: LatticePoint,
    from: Area,
    next: Area,
) -> LatticePoint {
    // The shared border, or the shared corner, is what the two rectangles have in common.
    matrix.rect(from).intersection(matrix.rect(next)).clamp(point)
}

/// The points of the way through `areas`: start, entry and exit points, goal.
///
/// ```
/// use wmr::{geometry::Rect, grid::{LatticePoint, MiniMatrix, enlarge}, plan, scene::Scene};
/// let mut scene = Scene::new(1.0, 1.0);
/// scene.obstacles.push(Rect::new(0.4, 0.0, 0.6, 0.5).into());
/// let mut matrix = MiniMatrix::from_borders(&enlarge(&scene, 0.0)?)?;
/// let [start, goal] = [1000, 9000].map(|x| LatticePoint::new(x, 3000));
/// let ends = (matrix.mark_terminal(start).unwrap(), matrix.mark_terminal(goal).unwrap());
/// let path = plan::shortest_path(&matrix, ends, (start, goal)).unwrap();
/// let points = plan::entry_exit_points(&matrix, &path.areas, start, goal);
/// assert_eq!(points[1], LatticePoint::new(3250, 5750));
/// # Ok::<(), wmr::grid::GridError>(())
/// ```
pub fn entry_exit_points(
    matrix: &MiniMatrix,
    areas: &[Area],
    start: LatticePoint,
    goal: LatticePoint,
) -> Vec<LatticePoint> {
    let mut points = vec![start];
    let mut point = start;
    for pair in areas.windows(2) {
        point = exit_point(matrix, point, pair[0], pair[1]);
        points.push(point);
    }
    points.push(goal);
    points.dedup();
    points
}

/// Remembers between which points the robot can go directly.
#[derive(Debug)]
pub(super) struct Sight<'a> {
    test: &'a LegTest,
    known: HashMap<(LatticePoint, LatticePoint), bool>,
}

impl<'a> Sight<'a> {
    pub(super) fn new(test: &'a LegTest) -> Self {
        Self { test, known: HashMap::new() }
    }

    fn is_free(&mut self, a: LatticePoint, b: LatticePoint) -> bool {
        *self.known.entry((a, b)).or_insert_with(|| self.test.is_free(a, b))
    }
}

/// Drops the interim points that the robot does not need because it can go directly, so that what
/// is left is the shortest path over `points` in their order.
///
/// Deviation: the paper drops one point after the other and leaves open which goes first; the
/// shortest choice is taken.
pub fn drop_useless_points(points: &[LatticePoint], test: &LegTest) -> Vec<LatticePoint> {
    shortest_over(points, &mut Sight::new(test))
}

/// Lengths that differ by less than this part are sums of the same straight way, rounded differently.
const TIE: f64 = 1e-12;

/// As [`drop_useless_points`], for many paths over the same points.
pub(super) fn shortest_over(points: &[LatticePoint], sight: &mut Sight) -> Vec<LatticePoint> {
    // By point: the length of the best way there, its legs, and the point before.
    let mut best = vec![(0.0, 0, 0)];
    for (index, &point) in points.iter().enumerate().skip(1) {
        let via = |before: usize| {
            let (length, legs, _) = best[before];
            (length + points[before].distance(point), legs + 1, before)
        };
        // The point just before is always in sight: both lie in one area, which is convex.
        let mut found = via(index - 1);
        for way in (0..index - 1).map(via) {
            let shorter = way.0 < found.0 * (1.0 - TIE);
            let simpler = way.0 <= found.0 * (1.0 + TIE) && way.1 < found.1;
            if (shorter || simpler) && sight.is_free(points[way.2], point) {
                found = way;
            }
        }
        best.push(found);
    }
    let mut at = points.len() - 1;
    let mut kept = vec![points[at]];
    while at > 0 {
        at = best[at].2;
        kept.push(points[at]);
    }
    kept.reverse();
    kept
}

/// The length of the path over `points`, units.
pub(super) fn length(points: &[LatticePoint]) -> f64 {
    points.windows(2).map(|leg| leg[0].distance(leg[1])).sum()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::grid::{EnlargedArena, LatticeRect};

    fn around_one_box() -> EnlargedArena {
        let whole = LatticeRect::new(0, 0, 9, 9);
        EnlargedArena::new(whole, whole, vec![LatticeRect::new(3, 3, 6, 6)])
    }

    fn points<const N: usize>(of: [(i32, i32); N]) -> [LatticePoint; N] {
        of.map(|(x, y)| LatticePoint::new(x, y))
    }

    #[test]
    fn the_way_leaves_straight_to_a_border_and_to_a_corner_diagonally() {
        let mut matrix = MiniMatrix::from_borders(&around_one_box()).unwrap();
        let [start, right, up] = points([(1, 2), (5, 1), (2, 5)]);
        let [here, right, up] = [start, right, up].map(|p| matrix.mark_terminal(p).unwrap());
        assert_eq!(exit_point(&matrix, start, here, right), LatticePoint::new(3, 2));
        assert_eq!(exit_point(&matrix, start, here, up), LatticePoint::new(1, 3));
        assert_eq!(
            exit_point(&matrix, LatticePoint::new(2, 5), up, right),
            LatticePoint::new(3, 3)
        );
    }

    #[test]
    fn useless_points_go_and_needed_corners_stay() {
        let arena = around_one_box();
        let test = LegTest::new(&arena);
        let straight = points([(0, 0), (3, 0), (6, 0), (9, 0)]);
        assert_eq!(drop_useless_points(&straight, &test), points([(0, 0), (9, 0)]));
        let corner = points([(1, 8), (1, 6), (1, 3), (3, 3), (6, 2), (8, 2)]);
        assert_eq!(drop_useless_points(&corner, &test), points([(1, 8), (3, 3), (8, 2)]));
    }
}
