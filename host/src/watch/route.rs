//! From what stands on the floor now to legs: the planner, asked again and again.

use crate::geometry::{Point, Pose};
use crate::legs::{LegOptions, from_wire, named, to_legs};
use crate::plan::{PlanError, PlanOptions, with_margin_fallback};
use crate::scene::{Goal, Obstacle, Scene};
use protocol::motion::{Leg, Limits, Timing};
use std::time::Duration;

/// A slower leg takes so many times as long in each of its intervals, at least.
const SLOWER: u32 = 2;

/// What every plan of a drive has in common.
#[derive(Clone, Debug)]
pub struct Router {
    /// Arena and robot; its obstacles are those of each plan.
    pub scene: Scene,
    /// Where to.
    pub goal: Goal,
    /// How.
    pub plan: PlanOptions,
    /// The margins to try, widest first, m.
    pub margins: Vec<f64>,
    /// How waypoints become legs.
    pub legs: LegOptions,
}

/// A way, as legs.
#[derive(Clone, Debug, PartialEq)]
pub struct Route {
    /// The legs.
    pub legs: Vec<Leg>,
    /// The way's length, m.
    pub length: f64,
    /// The margin that it keeps beyond the radius, m.
    pub margin: f64,
}

impl Router {
    /// The route from `from` around `obstacles`, at margins wider by `extra`; `slow` legs take twice as long.
    ///
    /// # Errors
    /// [`PlanError`] if there is none.
    pub fn route(
        &self,
        obstacles: &[Obstacle],
        from: Pose,
        (extra, slow): (f64, bool),
        limits: &Limits,
    ) -> Result<Route, PlanError> {
        let scene = Scene { obstacles: obstacles.to_vec(), ..self.scene.clone() };
        let margins: Vec<f64> = self.margins.iter().map(|margin| margin + extra).collect();
        let goal = self.goal.position;
        let nobody_asks = || Duration::ZERO;
        let found =
            with_margin_fallback(&scene, from.position, goal, &margins, &self.plan, nobody_asks)?;
        let ways = &found.plan.waypoints;
        let mut legs = to_legs(ways, from.heading, self.goal.heading, &self.legs, limits);
        if slow {
            legs = named(legs.iter().map(|leg| slower(leg, limits)).collect());
        }
        Ok(Route { legs, length: found.plan.length, margin: found.margin - extra })
    }
}

/// The same leg at half the pace or less, by the paper's timing.
fn slower(leg: &Leg, limits: &Limits) -> Leg {
    let quick = Leg { timing: Timing::Limits, ..*leg };
    let longest = quick.intervals(limits).map(|motion| motion.profile.ticks()).into_iter().max();
    let interval_ticks = SLOWER * longest.unwrap_or(0).max(1);
    let slow = Leg { timing: Timing::Paper { interval_ticks }, ..*leg };
    // The paper's law may need longer for a turn: then the quickest is slow enough.
    if slow.check(limits).is_ok() { slow } else { quick }
}

/// Where a leg ends.
pub(super) fn end_of(leg: &Leg, limits: &Limits) -> Pose {
    from_wire(leg.intervals(limits)[2].end())
}

/// The goals of legs, as points.
pub(super) fn goals(legs: &[Leg]) -> Vec<Point> {
    legs.iter().map(|leg| Point::new(leg.goal.x.0.into(), leg.goal.y.0.into())).collect()
}

/// The length of the way from `from` along `goals`, m.
pub(super) fn length(from: Point, goals: &[Point]) -> f64 {
    goals.iter().fold((0.0, from), |(sum, at), goal| (sum + at.distance(*goal), *goal)).0
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::Rect;
    use crate::legs::{DEFAULT_LIMITS, duration};

    fn router() -> Router {
        Router {
            scene: Scene::new(2.0, 1.0),
            goal: Goal { position: Point::new(1.8, 0.5), heading: Some(0.0) },
            plan: PlanOptions::default(),
            margins: vec![0.01, 0.0],
            legs: LegOptions { timing: Timing::Limits, reverse: false },
        }
    }

    #[test]
    fn a_route_goes_round_what_is_seen_and_keeps_wider_of_it_if_asked() {
        let boxes = [Rect::new(0.9, 0.4, 1.1, 0.6).into()];
        let route = |extra, slow| {
            router()
                .route(&boxes, Pose::new(0.2, 0.5, 0.0), (extra, slow), &DEFAULT_LIMITS)
                .unwrap()
        };
        let (usual, wide, slow) = (route(0.0, false), route(0.05, false), route(0.0, true));
        let highest = |route: &Route| {
            route.legs.iter().map(|leg| (leg.goal.y.0 - 0.5).abs()).fold(0.0, f32::max)
        };
        assert!((highest(&usual) - 0.185).abs() < 1e-3 && (highest(&wide) - 0.235).abs() < 1e-3);
        assert!((usual.margin - 0.01).abs() < 1e-9 && (wide.margin - 0.01).abs() < 1e-9);
        let [usual, slow] = [usual, slow].map(|route| duration(&route.legs, &DEFAULT_LIMITS));
        assert!(slow > 1.9 * usual, "{usual} {slow}");
    }

    #[test]
    fn a_wall_leaves_no_route() {
        let wall = [Rect::new(0.9, 0.0, 1.1, 0.9).into()];
        let result = router().route(&wall, Pose::new(0.2, 0.5, 0.0), (0.0, false), &DEFAULT_LIMITS);
        assert!(matches!(result, Err(PlanError::NoPath { .. })));
    }
}
