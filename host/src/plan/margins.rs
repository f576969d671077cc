//! The margin fall-back: the widest of several margins that still leaves a path.
//!
//! It stands on top of [`PreparedArena`] and is what a drive plans with: a margin keeps a robot safe
//! from the errors of camera and wheels, but a narrower gap is better than no path. Metres.

use super::{Plan, PlanError, PlanOptions, PreparedArena};
use crate::geometry::Point;
use crate::scene::Scene;
use std::time::Duration;

/// The margins to try for a drive, widest first, metres: what a real robot needs to be safe from the
/// errors of camera and wheels, then less where no path would exist.
pub const DRIVE_MARGINS: [f64; 4] = [0.010, 0.005, 0.002, 0.0];

/// A plan with the margin that it keeps.
#[derive(Clone, Debug, PartialEq)]
pub struct MarginPlan {
    /// The plan.
    pub plan: Plan,
    /// The uniform margin that it was planned with, metres.
    pub margin: f64,
    /// How long preparing the arena took, by the caller's clock.
    pub preparing: Duration,
    /// How long the search took, by the caller's clock.
    pub searching: Duration,
}

/// Plans with the first of `margins` (metres) that leaves a path. `options.margin` is
/// replaced by each of them in turn; the obstacles' own margins are kept. `clock` is read for
/// [`MarginPlan::preparing`] and [`MarginPlan::searching`] alone.
///
/// A margin for which the robot would first have to be led away from an obstacle is used only if
/// every smaller margin needs that as well.
///
/// # Errors
/// The [`PlanError`] of the last margin if none leaves a path; of the first one that fails for
/// another reason than lack of room.
///
/// ```
/// use std::time::Duration;
/// use wmr::geometry::{Point, Rect};
/// use wmr::plan::{DRIVE_MARGINS, PlanOptions, with_margin_fallback};
/// let mut scene = wmr::scene::Scene::new(1.0, 1.0);
/// // The gap is 164 mm wide: the robot's 150 mm and a margin of 5 mm on both sides, not of 10 mm.
/// scene.obstacles.push(Rect::new(0.4, 0.0, 0.6, 0.836).into());
/// let (start, goal) = (Point::new(0.1, 0.5), Point::new(0.9, 0.5));
/// let options = PlanOptions::default();
/// let found =
///     with_margin_fallback(&scene, start, goal, &DRIVE_MARGINS, &options, || Duration::ZERO)?;
/// assert_eq!(found.margin, 0.005);
/// # Ok::<(), wmr::plan::PlanError>(())
/// ```
pub fn with_margin_fallback(
    scene: &Scene,
    start: Point,
    goal: Point,
    margins: &[f64],
    options: &PlanOptions,
    clock: impl Fn() -> Duration,
) -> Result<MarginPlan, PlanError> {
    let mut last = PlanError::NoPath { gap: None };
    let mut led_away = None;
    for &margin in margins {
        let options = PlanOptions { margin, ..options.clone() };
        let began = clock();
        let mut arena = match PreparedArena::new(scene, &options) {
            Ok(arena) => arena,
            // An arena without room for robot and margin may have room for the robot alone.
            Err(error) => {
                last = error;
                continue;
            }
        };
        let prepared = clock();
        match arena.plan(start, goal) {
            Ok(plan) => {
                let preparing = prepared.saturating_sub(began);
                let searching = clock().saturating_sub(prepared);
                let found = MarginPlan { plan, margin, preparing, searching };
                if found.plan.exit_leg.is_none() {
                    return Ok(found);
                }
                led_away.get_or_insert(found);
            }
            Err(error @ (PlanError::NoPath { .. } | PlanError::Blocked { .. })) => last = error,
            Err(error) => return Err(error),
        }
    }
    led_away.ok_or(last)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::Rect;

    fn margin_in(scene: &Scene, start: Point) -> Result<MarginPlan, PlanError> {
        let (goal, options) = (Point::new(0.9, 0.5), PlanOptions::default());
        with_margin_fallback(scene, start, goal, &DRIVE_MARGINS, &options, || Duration::ZERO)
    }

    /// A wall across an arena of 1 m by 1 m that leaves a gap of that width at the top.
    fn gap(width: f64) -> Scene {
        let mut scene = Scene::new(1.0, 1.0);
        scene.obstacles.push(Rect::new(0.4, 0.0, 0.6, 1.0 - width).into());
        scene
    }

    /// The gap takes the robot's 150 mm and twice the margin; 1 mm more is beyond all rounding.
    #[test]
    fn the_widest_margin_that_fits_is_kept() {
        let start = Point::new(0.1, 0.5);
        for margin in DRIVE_MARGINS {
            let found = margin_in(&gap(0.151 + 2.0 * margin), start).unwrap();
            assert_eq!(found.margin, margin);
            assert!(found.plan.clearance >= 0.075 + margin - 1e-4, "{found:?}");
        }
        let error = margin_in(&gap(0.149), start).unwrap_err();
        assert!(matches!(error, PlanError::NoPath { .. }), "{error:?}");
    }

    /// 80 mm from the border there are 5 mm beyond the radius, so a margin of 10 mm would lead away.
    #[test]
    fn a_smaller_margin_is_better_than_an_exit_leg() {
        let found = margin_in(&Scene::new(1.0, 1.0), Point::new(0.0805, 0.5)).unwrap();
        assert_eq!((found.margin, found.plan.exit_leg), (0.005, None));
        // At 60 mm every margin leads away, so the first is kept.
        let found = margin_in(&Scene::new(1.0, 1.0), Point::new(0.060, 0.5)).unwrap();
        assert_eq!(found.margin, 0.010);
        assert!(found.plan.exit_leg.is_some());
    }
}
