//! Start and goal on the lattice, or why the robot cannot stand there.

use super::{Blocker, End, PlanError};
use crate::geometry::{Arena, Point};
use crate::grid::{EnlargedArena, LatticePoint, LatticeRect, UNITS_PER_METRE};
use crate::scene::Scene;

/// A decimal that is a whole unit is none but that one, however its `f64` is rounded.
const LESS_THAN_A_UNIT: f64 = 1.0 - 1e-6;

/// The lattice point at which the way from or to `point` ends: a free one less than a unit away.
///
/// `free` are the rectangles in which the robot's centre may be, their edges included; `is_free` says
/// whether one of them holds a point.
///
/// # Errors
/// [`PlanError::Outside`] or [`PlanError::Blocked`] with the nearest free point.
pub(super) fn locate(
    end: End,
    point: Point,
    scene: &Scene,
    arena: &EnlargedArena,
    is_free: impl Fn(LatticePoint) -> bool,
    free: &[LatticeRect],
) -> Result<LatticePoint, PlanError> {
    check_within(end, point, scene.arena)?;
    let outside = PlanError::Outside { end, point, arena: scene.arena };
    let nearest = LatticePoint::nearest(point).ok_or(outside)?;
    // A point on an edge that is no whole unit rounds to either side of it; one of these is free.
    let around = [(0, 0), (1, 0), (0, 1), (-1, 0), (0, -1), (1, 1), (-1, 1), (-1, -1), (1, -1)]
        .map(|(dx, dy)| LatticePoint::new(nearest.x + dx, nearest.y + dy));
    let is_near = |at: &&LatticePoint| {
        (f64::from(at.x) - point.x * UNITS_PER_METRE).abs() < LESS_THAN_A_UNIT
            && (f64::from(at.y) - point.y * UNITS_PER_METRE).abs() < LESS_THAN_A_UNIT
    };
    match around.iter().filter(is_near).find(|&&at| is_free(at)) {
        Some(&at) => Ok(at),
        None => Err(PlanError::Blocked {
            end,
            point,
            by: blocker(nearest, arena),
            nearest: nearest_free(nearest, free).map(LatticePoint::to_metres),
        }),
    }
}

/// Makes sure that an end of the way lies in the arena.
///
/// # Errors
/// [`PlanError::Outside`].
pub(super) fn check_within(end: End, point: Point, arena: Arena) -> Result<(), PlanError> {
    let within = (0.0..=arena.width).contains(&point.x) && (0.0..=arena.height).contains(&point.y);
    if within { Ok(()) } else { Err(PlanError::Outside { end, point, arena }) }
}

/// The point of the `free` rectangles that is nearest to `point`.
fn nearest_free(point: LatticePoint, free: &[LatticeRect]) -> Option<LatticePoint> {
    let nearest_in = |rect: &LatticeRect| rect.clamp(point);
    free.iter().map(nearest_in).min_by(|a, b| point.distance(*a).total_cmp(&point.distance(*b)))
}

/// The obstacle that `point` lies deepest in, or else the border, or else a gap without room.
fn blocker(point: LatticePoint, arena: &EnlargedArena) -> Blocker {
    let metres = |units: i32| f64::from(units) / UNITS_PER_METRE;
    let depth = |rect: &LatticeRect| {
        let x = (point.x - rect.x0).min(rect.x1 - point.x);
        let y = (point.y - rect.y0).min(rect.y1 - point.y);
        (x, y)
    };
    let inside = arena.boxes.iter().enumerate().filter(|(_, grown)| grown.contains_inside(point));
    let deepest = inside.max_by_key(|(_, grown)| {
        let (x, y) = depth(grown);
        x.min(y)
    });
    if let Some((index, grown)) = deepest {
        let (x, y) = depth(grown);
        return Blocker::Obstacle { index: arena.owners[index], depth: [metres(x), metres(y)] };
    }
    let (x, y) = depth(&arena.inside);
    if x.min(y) < 0 { Blocker::Border { depth: metres(-x.min(y)) } } else { Blocker::Gap }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::Rect;
    use crate::grid::enlarge;
    use miette::Diagnostic;

    fn at(x: f64, y: f64) -> Result<LatticePoint, PlanError> {
        let mut scene = Scene::new(1.0, 1.0);
        scene.obstacles.push(Rect::new(0.5, 0.0, 0.6, 1.0).into());
        let arena = enlarge(&scene, 0.0).unwrap();
        let free =
            [LatticeRect::new(750, 750, 4250, 9250), LatticeRect::new(6750, 750, 9250, 9250)];
        let is_free = |at: LatticePoint| free.iter().any(|rect| rect.contains(at));
        locate(End::Goal, Point::new(x, y), &scene, &arena, is_free, &free)
    }

    #[test]
    fn a_point_in_a_grown_box_is_told_how_deep_and_where_to_go() {
        let error = at(0.445, 0.5).unwrap_err();
        let expected = PlanError::Blocked {
            end: End::Goal,
            point: Point::new(0.445, 0.5),
            by: Blocker::Obstacle { index: 0, depth: [0.02, 0.575] },
            nearest: Some(Point::new(0.425, 0.5)),
        };
        assert_eq!(error, expected);
        assert_eq!(
            error.to_string(),
            "the goal (0.4450, 0.5000) m lies 2.0 by 57.5 cm inside obstacle 1 grown by the robot's \
             radius and margin"
        );
        let help = error.help().unwrap().to_string();
        assert_eq!(help, "the nearest free point is (0.4250, 0.5000)");
    }

    #[test]
    fn a_point_outside_or_near_the_border_is_told_apart() {
        assert!(matches!(at(1.5, 0.5), Err(PlanError::Outside { .. })));
        assert!(matches!(at(f64::NAN, 0.5), Err(PlanError::Outside { .. })));
        let border = at(0.2, 0.05).unwrap_err();
        assert!(matches!(border, PlanError::Blocked { by: Blocker::Border { depth: 0.025 }, .. }));
    }

    #[test]
    fn a_point_on_an_edge_is_free_whichever_way_it_rounds() {
        assert_eq!(at(0.425, 0.5), Ok(LatticePoint::new(4250, 5000)));
        assert_eq!(at(0.425_03, 0.5), Ok(LatticePoint::new(4250, 5000)));
        assert_eq!(at(0.425_07, 0.5), Ok(LatticePoint::new(4250, 5000)));
        assert!(at(0.4251, 0.5).is_err() && at(0.4252, 0.5).is_err());
    }
}
