//! The way out for a robot that stands where it should not: parked at a wall, or put nearer to an
//! obstacle by the camera's noise than radius and margin allow.
//!
//! The exit leg is straight, ends at a free point, and nowhere comes nearer to a true obstacle than
//! the start is; where it passes other obstacles it keeps the whole distance.

use super::leg_check::crosses;
use crate::geometry::Point;
use crate::grid::{EnlargedArena, LatticePoint, LatticeRect};
use crate::scene::Scene;

/// What a computed distance may lose to rounding, metres.
const ROUNDING: f64 = 1e-9;

/// The nearest free point that a safe exit leg from `start` reaches and that is `useful`; `None` if
/// there is none, or if the start lies in a true obstacle.
pub(super) fn exit_point(
    start: Point,
    scene: &Scene,
    arena: &EnlargedArena,
    free: &[LatticeRect],
    useful: impl Fn(LatticePoint) -> bool,
) -> Option<LatticePoint> {
    let from = LatticePoint::nearest(start)?;
    if !arena.border.contains(from)
        || scene.obstacles.iter().any(|obstacle| obstacle.footprint.distance(start) <= 0.0)
    {
        return None;
    }
    let mut exits: Vec<LatticePoint> = free.iter().map(|rect| rect.clamp(from)).collect();
    exits.sort_unstable_by(|a, b| from.distance(*a).total_cmp(&from.distance(*b)));
    let is_safe = |exit: LatticePoint| {
        let mut boxes = arena.boxes.iter().zip(&arena.owners);
        boxes.all(|(&grown, &owner)| {
            let footprint = &scene.obstacles[owner].footprint;
            !crosses(from, exit, grown)
                || (grown.contains_inside(from)
                    && footprint.leg_distance(start, exit.to_metres())
                        >= footprint.distance(start) - ROUNDING)
        })
    };
    exits.into_iter().find(|&exit| is_safe(exit) && useful(exit))
}

#[cfg(test)]
mod tests {
    use crate::geometry::{Point, Rect};
    use crate::plan::{PlanOptions, Planner, plan};
    use crate::scene::Scene;

    fn scene() -> Scene {
        let mut scene = Scene::new(2.0, 1.0);
        scene.obstacles.push(Rect::new(0.8, 0.0, 1.2, 0.5).into());
        scene
    }

    #[test]
    fn a_robot_at_a_box_first_drives_straight_away_from_it() {
        let way =
            plan(&scene(), Point::new(0.76, 0.2), Point::new(1.8, 0.2), &PlanOptions::default());
        let way = way.unwrap();
        assert_eq!(way.waypoints[1], Point::new(0.725, 0.2));
        assert!((way.exit_leg.unwrap() - 0.035).abs() < 1e-12);
        assert!((way.clearance - 0.04).abs() < 1e-12);
    }

    #[test]
    fn a_robot_in_the_corner_of_the_arena_comes_out_of_it() {
        let way =
            plan(&scene(), Point::new(0.02, 0.03), Point::new(0.3, 0.5), &PlanOptions::default());
        assert_eq!(way.unwrap().waypoints[1], Point::new(0.075, 0.075));
    }

    #[test]
    fn a_robot_that_needs_no_exit_has_none_and_one_inside_a_box_is_refused() {
        let goal = Point::new(0.3, 0.5);
        let free = plan(&scene(), Point::new(0.1, 0.1), goal, &PlanOptions::default()).unwrap();
        assert_eq!(free.exit_leg, None);
        let inside = plan(&scene(), Point::new(0.9, 0.1), goal, &PlanOptions::default());
        assert_eq!(inside.unwrap_err().code(), "start_blocked");
    }

    #[test]
    fn an_exit_never_leads_past_another_box() {
        // The nearest free point lies beyond a second box; the exit goes the longer way.
        let mut scene = scene();
        scene.obstacles.push(Rect::new(0.6, 0.0, 0.7, 0.6).into());
        let start = Point::new(0.75, 0.45);
        let way = plan(&scene, start, Point::new(0.2, 0.2), &PlanOptions::default()).unwrap();
        assert!(way.clearance >= 0.05 - 1e-12, "{}", way.clearance);
    }

    #[test]
    fn the_exit_leads_to_the_goal_s_side_whatever_the_planner() {
        // In a gap too narrow for the robot; the nearer way out leads away from the goal.
        let mut scene = Scene::new(2.0, 1.0);
        scene.obstacles = [Rect::new(0.0, 0.4, 1.0, 0.6), Rect::new(1.13, 0.4, 2.0, 0.6)]
            .map(Into::into)
            .to_vec();
        let start = Point::new(1.065, 0.48);
        for planner in [Planner::Exact, Planner::Grid, Planner::Tree] {
            let options = PlanOptions { planner, ..PlanOptions::default() };
            let way = plan(&scene, start, Point::new(1.6, 0.8), &options).unwrap();
            assert_eq!(way.waypoints[1], Point::new(1.065, 0.675));
            assert!((way.exit_leg.unwrap() - 0.195).abs() < 1e-12);
        }
    }
}
