//! What a robot sees through a portal: cones of integer rays, their sides, and a lower bound.
//!
//! A ray is the step from the root to the corner that bounds the view. On which side of it a point
//! lies is the sign of a cross product, which fits an `i64`. Lattice units.

use super::mesh::{Portal, PortalEnd};
use crate::grid::LatticePoint;

/// A direction, in units. Coordinates are at most 2^29, so that a difference fits.
pub(super) type Ray = (i32, i32);

pub(super) fn ray(from: LatticePoint, to: LatticePoint) -> Ray {
    (to.x - from.x, to.y - from.y)
}

pub(super) fn cross(a: Ray, b: Ray) -> i64 {
    i64::from(a.0) * i64::from(b.1) - i64::from(a.1) * i64::from(b.0)
}

pub(super) fn dot(a: Ray, b: Ray) -> i64 {
    i64::from(a.0) * i64::from(b.0) + i64::from(a.1) * i64::from(b.1)
}

/// What can be seen from a root through a portal.
#[derive(Clone, Copy, Debug)]
pub(super) struct View {
    /// The rays that bound the view.
    pub(super) right: Ray,
    pub(super) left: Ray,
    /// Whether a ray passes exactly through the portal's right and left end.
    pub(super) right_at_end: bool,
    pub(super) left_at_end: bool,
}

/// On which side of a view's rays the ends of a portal lie: the signs of cross products with the right
/// and the left ray, positive to the left of the ray.
pub(super) struct Sides {
    pub(super) right_end: (i64, i64),
    pub(super) left_end: (i64, i64),
}

impl Sides {
    pub(super) fn of(root: LatticePoint, view: &View, portal: &Portal) -> Self {
        let sides = |end: &PortalEnd| {
            let towards = ray(root, end.at);
            (cross(view.right, towards), cross(view.left, towards))
        };
        Self { right_end: sides(&portal.right), left_end: sides(&portal.left) }
    }

    /// Whether a part of the portal lies to the right of the right ray; `is_same_end` says that the
    /// portal begins where that ray enters the piece.
    pub(super) fn right_of_right(&self, is_same_end: bool) -> bool {
        self.right_end.0 < 0 || (is_same_end && self.left_end.0 < 0)
    }

    /// What `view` shows of the portal, seen from `root`; `None` if nothing.
    pub(super) fn narrow(&self, root: LatticePoint, view: &View, portal: &Portal) -> Option<View> {
        let (u, w) = (self.right_end, self.left_end);
        (w.0 > 0 && u.1 < 0).then(|| View {
            right: if u.0 > 0 { ray(root, portal.right.at) } else { view.right },
            left: if w.1 < 0 { ray(root, portal.left.at) } else { view.left },
            right_at_end: u.0 >= 0,
            left_at_end: w.1 <= 0,
        })
    }

    /// Whether the portal lies along one of the view's rays.
    pub(super) fn is_in_line(&self) -> bool {
        let (u, w) = (self.right_end, self.left_end);
        (u.0 == 0 && w.0 == 0) || (u.1 == 0 && w.1 == 0)
    }

    /// As [`Self::right_of_right`], mirrored.
    pub(super) fn left_of_left(&self, is_same_end: bool) -> bool {
        self.left_end.1 > 0 || (is_same_end && self.right_end.1 > 0)
    }
}

/// The least length from `root` through what `view` shows of `portal` (all of the piece behind it, if
/// `None`) to `goal`: a lower bound of the rest.
pub(super) fn least_length(
    root: LatticePoint,
    view: Option<&View>,
    portal: &Portal,
    goal: LatticePoint,
) -> f64 {
    let float = |(x, y): Ray| (f64::from(x), f64::from(y));
    let norm = |x: f64, y: f64| (x * x + y * y).sqrt();
    let target = float(ray(root, goal));
    let Some(view) = view else { return norm(target.0, target.1) };
    let (u, w) = (float(ray(root, portal.right.at)), float(ray(root, portal.left.at)));
    let along = (w.0 - u.0, w.1 - u.1);
    // Seen from the portal's line, the root lies at −area and the goal at side.
    let area = along.0 * u.1 - along.1 * u.0;
    let side = along.0 * (target.1 - u.1) - along.1 * (target.0 - u.0);
    let target = if side * area > 0.0 {
        target
    } else {
        // On the root's own side of the portal the goal is as far as its mirror image.
        let scale = 2.0 * side / (along.0 * along.0 + along.1 * along.1);
        (target.0 + scale * along.1, target.1 - scale * along.0)
    };
    let meet = |(x, y): (f64, f64)| {
        let scale = area / (along.0 * y - along.1 * x);
        (x * scale, y * scale)
    };
    let by_way_of = |(x, y): (f64, f64)| norm(x, y) + norm(target.0 - x, target.1 - y);
    let (right, left) = (float(view.right), float(view.left));
    if right.0 * target.1 - right.1 * target.0 < 0.0 {
        by_way_of(if view.right_at_end { u } else { meet(right) })
    } else if left.0 * target.1 - left.1 * target.0 > 0.0 {
        by_way_of(if view.left_at_end { w } else { meet(left) })
    } else {
        norm(target.0, target.1)
    }
}

#[cfg(test)]
mod tests {
    use super::super::mesh::NO_CORNER;
    use super::*;

    fn portal(right: (i32, i32), left: (i32, i32)) -> Portal {
        let end = |(x, y): (i32, i32)| PortalEnd { at: LatticePoint::new(x, y), corner: NO_CORNER };
        Portal::new(end(right), end(left), 0)
    }

    /// From the origin through the portal from (4, −3) to (4, 3).
    fn bound(goal: (i32, i32)) -> f64 {
        let portal = portal((4, -3), (4, 3));
        let view = View { right: (4, -3), left: (4, 3), right_at_end: true, left_at_end: true };
        least_length(
            LatticePoint::new(0, 0),
            Some(&view),
            &portal,
            LatticePoint::new(goal.0, goal.1),
        )
    }

    #[test]
    fn the_bound_is_straight_bent_or_mirrored() {
        assert_eq!(bound((8, 6)), 10.0, "straight, over the portal's end");
        assert_eq!(bound((4, 8)), 10.0, "5 to the end and 5 along the portal's line");
        assert_eq!(bound((0, 0)), 8.0, "to the portal and back");
    }

    #[test]
    fn a_portal_in_line_with_a_ray_is_on_no_side_of_it() {
        let view = View { right: (4, 0), left: (4, 3), right_at_end: true, left_at_end: true };
        let sides = Sides::of(LatticePoint::new(0, 0), &view, &portal((5, 0), (7, 0)));
        assert_eq!((sides.right_end.0, sides.left_end.0), (0, 0));
        assert!(!sides.right_of_right(false) && !sides.left_of_left(false));
    }
}
