//! How far a path keeps from the true obstacles and the arena's border, metres.

use super::LegTest;
use crate::geometry::{Point, Rect, square_to_leg};
use crate::grid::{EnlargedArena, LatticeRect, UNITS_PER_METRE};
use crate::scene::{Obstacle, Scene};
use crate::shape::Shape;

/// The least distance of the path over `waypoints` to the obstacles and the border of `scene`,
/// metres; 0 if it touches or crosses one, negative beyond the border.
///
/// ```
/// use wmr::{geometry::{Point, Rect}, plan::clearance, scene::Scene};
/// let mut scene = Scene::new(2.0, 1.0);
/// scene.obstacles.push(Rect::new(0.9, 0.0, 1.1, 0.5).into());
/// let path = [Point::new(0.3, 0.7), Point::new(1.7, 0.7)];
/// assert!((clearance(&path, &scene) - 0.2).abs() < 1e-12);
/// ```
pub fn clearance(waypoints: &[Point], scene: &Scene) -> f64 {
    waypoints
        .windows(2)
        .fold(to_border(waypoints, scene), |least, leg| nearest(leg, scene.obstacles.iter(), least))
}

/// As [`clearance`], looking only at obstacles whose boxes in `arena` the index of `test` finds nearby.
pub(super) fn clearance_by(
    test: &LegTest,
    arena: &EnlargedArena,
    waypoints: &[Point],
    scene: &Scene,
) -> f64 {
    let mut least = to_border(waypoints, scene);
    for leg in waypoints.windows(2) {
        // Most legs touch a grown box; where nothing is that near, look twice as far around.
        let mut reach = 2.0 * scene.robot_radius + LEAST_REACH;
        loop {
            let around = range(leg, reach.min(least));
            let owner = |number: usize| arena.owners.get(number);
            let near = test.index().near(around).filter_map(owner);
            let near = near.filter_map(|&number| scene.obstacles.get(number));
            least = nearest(leg, near, least);
            if least <= reach {
                break;
            }
            reach *= 2.0;
        }
    }
    least
}

/// The first radius to look around a leg for a robot without width, metres.
const LEAST_REACH: f64 = 0.05;

fn to_border(waypoints: &[Point], scene: &Scene) -> f64 {
    let to_border =
        |p: &Point| p.x.min(scene.arena.width - p.x).min(p.y).min(scene.arena.height - p.y);
    waypoints.iter().map(to_border).fold(f64::INFINITY, f64::min)
}

/// The least of `least` and the distances between the leg and the obstacles.
fn nearest<'a>(leg: &[Point], obstacles: impl Iterator<Item = &'a Obstacle>, least: f64) -> f64 {
    let &[a, b] = leg else { return least };
    // A negative distance, beyond the border, is not made less by an obstacle.
    let bound = least.max(0.0);
    let square = obstacles.fold(bound * bound, |square, obstacle| {
        let bounds = obstacle.footprint.bounds();
        if span_square(a, b, &bounds) >= square {
            return square;
        }
        square.min(match &obstacle.footprint {
            Shape::Rect(rect) => leg_square(a, b, rect),
            shape => shape.leg_distance(a, b).powi(2),
        })
    });
    if square < bound * bound { square.sqrt() } else { least }
}

/// The lattice rectangle that reaches `reach` metres further than the leg on every side.
fn range(leg: &[Point], reach: f64) -> LatticeRect {
    // A cast stops at the largest integer, which is far beyond every arena.
    let units = |metres: f64| (metres * UNITS_PER_METRE) as i32;
    let least = |of: fn(&Point) -> f64| leg.iter().map(of).fold(f64::INFINITY, f64::min) - reach;
    let most = |of: fn(&Point) -> f64| leg.iter().map(of).fold(f64::NEG_INFINITY, f64::max) + reach;
    LatticeRect::new(
        units(least(|p| p.x)) - 1,
        units(least(|p| p.y)) - 1,
        units(most(|p| p.x)).saturating_add(1),
        units(most(|p| p.y)).saturating_add(1),
    )
}

/// The square of a lower bound of the distance: that of the rectangle around the leg.
fn span_square(a: Point, b: Point, rect: &Rect) -> f64 {
    let dx = (rect.x0 - a.x.max(b.x)).max(a.x.min(b.x) - rect.x1).max(0.0);
    let dy = (rect.y0 - a.y.max(b.y)).max(a.y.min(b.y) - rect.y1).max(0.0);
    dx * dx + dy * dy
}

/// The square of the distance between a straight leg and a rectangle.
///
/// Two convex shapes apart are nearest at an end of the leg, or where the leg passes the corner that
/// lies least far to its side.
pub(super) fn leg_square(a: Point, b: Point, rect: &Rect) -> f64 {
    let (dx, dy) = (b.x - a.x, b.y - a.y);
    let side = |x: f64, y: f64| dx * (y - a.y) - dy * (x - a.x);
    // The corners furthest to the right and to the left of the leg's direction.
    let (right_x, left_x) = if dy >= 0.0 { (rect.x1, rect.x0) } else { (rect.x0, rect.x1) };
    let (right_y, left_y) = if dx >= 0.0 { (rect.y0, rect.y1) } else { (rect.y1, rect.y0) };
    let nearest = if side(right_x, right_y) > 0.0 {
        Point::new(right_x, right_y)
    } else if side(left_x, left_y) < 0.0 {
        Point::new(left_x, left_y)
    } else if span_square(a, b, rect) == 0.0 {
        return 0.0;
    } else {
        // The line meets the rectangle, but the leg ends before.
        return span_square(a, a, rect).min(span_square(b, b, rect));
    };
    let from_ends = span_square(a, a, rect).min(span_square(b, b, rect));
    from_ends.min(square_to_leg(nearest, a, b))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::grid::enlarge;
    use proptest::prelude::*;

    #[test]
    fn a_leg_past_a_corner_is_as_near_as_the_corner() {
        let rect = Rect::new(0.0, 0.0, 1.0, 1.0);
        let square = leg_square(Point::new(1.0, 3.0), Point::new(3.0, 1.0), &rect);
        assert!((square - 2.0).abs() < 1e-12);
        assert_eq!(leg_square(Point::new(-1.0, 0.5), Point::new(2.0, 0.5), &rect), 0.0);
    }

    proptest! {
        #[test]
        fn the_index_changes_nothing(
            boxes in proptest::collection::vec(proptest::array::uniform2(0.1..9.5_f64), 0..60),
            path in proptest::collection::vec(proptest::array::uniform2(0.1..9.9_f64), 2..5),
        ) {
            let mut scene = Scene::new(10.0, 10.0);
            scene.obstacles = boxes.iter().map(|&[x, y]| Rect::new(x, y, x + 0.3, y + 0.2).into()).collect();
            let grown = enlarge(&scene, 0.0).unwrap();
            let test = LegTest::new(&grown);
            let path: Vec<Point> = path.into_iter().map(Point::from).collect();
            prop_assert_eq!(clearance_by(&test, &grown, &path, &scene), clearance(&path, &scene));
        }

        #[test]
        fn no_sampled_point_of_the_leg_is_nearer(
            [ax, ay, bx, by] in proptest::array::uniform4(0.0..4.0_f64),
            [x, y, w, h] in proptest::array::uniform4(0.1..2.0_f64),
        ) {
            let rect = Rect::new(x, y, x + w, y + h);
            let (a, b) = (Point::new(ax, ay), Point::new(bx, by));
            let exact = leg_square(a, b, &rect).sqrt();
            let general = Shape::Rect(rect).leg_distance(a, b);
            prop_assert!((exact - general).abs() < 1e-12);
            let sampled = (0..=1000)
                .map(|i| f64::from(i) / 1000.0)
                .map(|t| rect.distance(Point::new(ax + t * (bx - ax), ay + t * (by - ay))))
                .fold(f64::INFINITY, f64::min);
            let step = a.distance(b) / 1000.0;
            prop_assert!(exact <= sampled + 1e-12 && sampled <= exact + step);
        }
    }
}
