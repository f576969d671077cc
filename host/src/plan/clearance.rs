//! How far a path keeps from the true obstacles and the arena's border, metres.

use crate::geometry::{Point, Rect};
use crate::scene::Scene;

/// The least distance of the path over `waypoints` to the obstacles and the border of `scene`,
/// metres; 0 if it touches or crosses one, negative beyond the border.
///
/// ```
/// use host::{geometry::{Point, Rect}, plan::clearance, scene::Scene};
/// let mut scene = Scene::new(2.0, 1.0);
/// scene.obstacles.push(Rect::new(0.9, 0.0, 1.1, 0.5));
/// let path = [Point::new(0.3, 0.7), Point::new(1.7, 0.7)];
/// assert!((clearance(&path, &scene) - 0.2).abs() < 1e-12);
/// ```
pub fn clearance(waypoints: &[Point], scene: &Scene) -> f64 {
    let to_border =
        |p: &Point| p.x.min(scene.arena.width - p.x).min(p.y).min(scene.arena.height - p.y);
    let mut least = waypoints.iter().map(to_border).fold(f64::INFINITY, f64::min);
    for leg in waypoints.windows(2) {
        for rect in &scene.obstacles {
            if span_distance(leg[0], leg[1], rect) < least {
                least = least.min(leg_distance(leg[0], leg[1], rect));
            }
        }
    }
    least
}

/// A lower bound of the distance: that of the rectangle around the leg.
fn span_distance(a: Point, b: Point, rect: &Rect) -> f64 {
    let dx = (rect.x0 - a.x.max(b.x)).max(a.x.min(b.x) - rect.x1).max(0.0);
    let dy = (rect.y0 - a.y.max(b.y)).max(a.y.min(b.y) - rect.y1).max(0.0);
    dx.hypot(dy)
}

/// The distance between a straight leg and a rectangle, metres.
pub(super) fn leg_distance(a: Point, b: Point, rect: &Rect) -> f64 {
    let corners = [(rect.x0, rect.y0), (rect.x1, rect.y0), (rect.x1, rect.y1), (rect.x0, rect.y1)]
        .map(|(x, y)| Point::new(x, y));
    let side = |c: &Point| (b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x);
    let left = corners.iter().any(|c| side(c) >= 0.0);
    let right = corners.iter().any(|c| side(c) <= 0.0);
    if left && right && span_distance(a, b, rect) == 0.0 {
        return 0.0;
    }
    let from_ends = rect.distance(a).min(rect.distance(b));
    corners.iter().map(|&corner| point_to_leg(corner, a, b)).fold(from_ends, f64::min)
}

fn point_to_leg(point: Point, a: Point, b: Point) -> f64 {
    let (dx, dy) = (b.x - a.x, b.y - a.y);
    let square = dx * dx + dy * dy;
    if square == 0.0 {
        return point.distance(a);
    }
    let along = (((point.x - a.x) * dx + (point.y - a.y) * dy) / square).clamp(0.0, 1.0);
    point.distance(Point::new(a.x + along * dx, a.y + along * dy))
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn a_leg_past_a_corner_is_as_near_as_the_corner() {
        let rect = Rect::new(0.0, 0.0, 1.0, 1.0);
        let distance = leg_distance(Point::new(1.0, 3.0), Point::new(3.0, 1.0), &rect);
        assert!((distance - 2_f64.sqrt()).abs() < 1e-12);
        assert_eq!(leg_distance(Point::new(-1.0, 0.5), Point::new(2.0, 0.5), &rect), 0.0);
    }

    proptest! {
        #[test]
        fn no_sampled_point_of_the_leg_is_nearer(
            [ax, ay, bx, by] in proptest::array::uniform4(0.0..4.0_f64),
            [x, y, w, h] in proptest::array::uniform4(0.1..2.0_f64),
        ) {
            let rect = Rect::new(x, y, x + w, y + h);
            let (a, b) = (Point::new(ax, ay), Point::new(bx, by));
            let exact = leg_distance(a, b, &rect);
            let sampled = (0..=1000)
                .map(|i| f64::from(i) / 1000.0)
                .map(|t| rect.distance(Point::new(ax + t * (bx - ax), ay + t * (by - ay))))
                .fold(f64::INFINITY, f64::min);
            let step = a.distance(b) / 1000.0;
            prop_assert!(exact <= sampled + 1e-12 && sampled <= exact + step);
        }
    }
}
