//! The plan as a file, `wmr-plan/1`: what was planned, in which scene, and the legs that drive it.
//!
//! It stands after the legs and before the link: [`PlanFile::new`] writes down a plan,
//! [`PlanFile::from_json`] reads one back and [`PlanFile::check`] makes sure that it is whole, so that a
//! plan edited by hand, or mixed up with another arena, moves nothing. Its legs are what is driven, unless
//! the robot is another than [`MadeFor`] says. Metres and radians.

mod legs;

use crate::geometry::{Point, Pose, wrap_angle};
use crate::legs::{DEFAULT_LIMITS, LegOptions, duration, named, to_legs};
use crate::plan::{FuzzyStages, GridStages, Inflation, Plan, clearance};
use crate::scene::{Scene, SceneError};
pub use legs::{MadeFor, PlannedDirection, PlannedLeg};
use protocol::motion::{Leg, Limits, Timing};
use serde::{Deserialize, Serialize};

/// A plan with its scene. Its points are in the arena frame in memory, and in a file in the frame of
/// the scene's map, if it has one, as those of the scene are.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
#[serde(remote = "Self")]
pub struct PlanFile {
    /// Names the format and its version.
    pub format: PlanFormat,
    /// Which planner found it.
    pub planner: String,
    /// How the obstacles were inflated.
    #[serde(default = "square")]
    pub inflation: Inflation,
    /// Where the robot turns, start and goal included.
    pub waypoints: Vec<Point>,
    /// The way's length.
    pub length: f64,
    /// The least distance of the way to the true obstacles and the border.
    pub clearance: f64,
    /// The way as turn, drive and turn.
    pub legs: Vec<PlannedLeg>,
    /// What the legs were made for; absent in plans that were written before it was said.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub made_for: Option<MadeFor>,
    /// How long such a robot takes, seconds.
    pub duration: f64,
    /// The grid method's matrix without its dead ring, its top row first as in the picture:
    /// 0 dead, 1 available, 2 start or goal.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub mini_matrix: Option<Vec<Vec<u8>>>,
    /// The numbers of special areas in the grid method.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub areas: Option<AreaNumbers>,
    /// What the fuzzy planner weighed.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub fuzzy: Option<FuzzyFigures>,
    /// How long planning took.
    pub timing_us: PlanTiming,
    /// The arena that it was planned in.
    pub scene: Scene,
}

/// The tag at the head of a plan file.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
pub enum PlanFormat {
    /// The only version so far.
    #[serde(rename = "wmr-plan/1")]
    Plan,
}

/// Areas by their numbers: from 1, row by row from the top left, the dead ring included.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
pub struct AreaNumbers {
    /// Areas in a row, the dead ring included.
    pub columns: usize,
    /// Areas in a column, the dead ring included.
    pub rows: usize,
    /// The area that holds the start.
    pub start: usize,
    /// The area that holds the goal.
    pub goal: usize,
    /// Areas closed because they would trap the robot, in the order of closing.
    pub traps: Vec<usize>,
}

/// What the fuzzy planner weighed.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
pub struct FuzzyFigures {
    /// How many metres of detour a metre at full risk is worth.
    pub risk_weight: f64,
    /// The side of an area, metres.
    pub area: f64,
    /// The length and the weighted integral of the risk together, metres.
    pub cost: f64,
    /// The greatest risk on the way, 0 to 1.
    pub greatest_risk: f64,
}

impl From<&FuzzyStages> for FuzzyFigures {
    fn from(stages: &FuzzyStages) -> Self {
        Self {
            risk_weight: stages.weight,
            area: stages.grid.side(),
            cost: stages.cost,
            greatest_risk: stages.greatest_risk,
        }
    }
}

/// How long planning took, microseconds.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
pub struct PlanTiming {
    /// Preparing the arena.
    pub build: f64,
    /// Finding the way in it.
    pub query: f64,
}

/// Why a plan file cannot be driven.
#[derive(Debug, thiserror::Error, miette::Diagnostic)]
pub enum PlanFileError {
    /// The text is not JSON of the plan format.
    #[error("this is no plan: {0}")]
    #[diagnostic(help("plan again with wmr plan"))]
    Format(#[from] serde_json::Error),
    /// The scene in it makes no sense.
    #[error("the plan's scene: {0}")]
    #[diagnostic(help("plan again with wmr plan"))]
    Scene(#[from] SceneError),
    /// Legs and waypoints do not belong together.
    #[error("the plan's legs do not follow its waypoints ({reason})")]
    #[diagnostic(help("plan again with wmr plan"))]
    Torn {
        /// What does not fit.
        reason: String,
    },
    /// The way touches something in the scene.
    #[error(
        "the plan's way comes as near as {clearance:.4} m to an obstacle or the border of its scene, and the robot's radius is {radius} m"
    )]
    #[diagnostic(help("plan again with wmr plan"))]
    Touches {
        /// The least distance of the way to the scene's obstacles and border.
        clearance: f64,
        /// The robot's radius.
        radius: f64,
    },
}

/// A leg begins as the one before ends, to this, radians.
const HEADING_TOLERANCE: f64 = 1e-3;
/// Half a lattice step: what rounding outwards and back may cost, metres.
const CLEARANCE_TOLERANCE: f64 = 1e-4;
/// Legs are f32: within 100 m they resolve 8 µm, so a tenth of a millimetre tells a leg from another.
const LEG_TOLERANCE: f64 = 1e-4;

impl PlanFile {
    /// Writes down `plan`, made in `scene` from its start to its goal, with the legs that drive it.
    pub fn new(plan: &Plan, scene: &Scene, made_for: MadeFor, timing_us: PlanTiming) -> Self {
        let (options, limits) = (made_for.options(), made_for.limits());
        let heading = scene.start.map_or(0.0, |start| start.heading);
        let goal_heading = scene.goal.and_then(|goal| goal.heading);
        let legs = to_legs(&plan.waypoints, heading, goal_heading, &options, &limits);
        Self {
            format: PlanFormat::Plan,
            planner: plan.planner.name().to_owned(),
            inflation: plan.inflation,
            waypoints: plan.waypoints.clone(),
            length: plan.length,
            clearance: plan.clearance,
            legs: legs.iter().map(|leg| PlannedLeg::new(leg, &limits)).collect(),
            made_for: Some(made_for),
            duration: duration(&legs, &limits),
            mini_matrix: plan.grid.as_ref().map(matrix_rows),
            areas: plan.grid.as_ref().map(AreaNumbers::from),
            fuzzy: plan.fuzzy.as_deref().map(FuzzyFigures::from),
            timing_us,
            scene: scene.clone(),
        }
    }

    /// Reads a plan and checks it.
    ///
    /// # Errors
    /// [`PlanFileError`] if it is no plan, or no whole one, or one that would touch something.
    ///
    /// ```
    /// assert!(wmr::plan_file::PlanFile::from_json("{}").is_err());
    /// ```
    pub fn from_json(text: &str) -> Result<Self, PlanFileError> {
        let plan: Self = serde_json::from_str(text)?;
        plan.check()?;
        Ok(plan)
    }

    /// The heading with which the way begins.
    pub fn start_heading(&self) -> f64 {
        self.legs.first().map_or(0.0, |leg| leg.start.heading)
    }

    /// The heading wanted at the goal, if any.
    pub fn goal_heading(&self) -> Option<f64> {
        self.legs.last().and_then(|leg| leg.goal.2)
    }

    /// The legs as they stand in the plan, with the timing they were made for; `None` if it does not say that.
    pub fn planned_legs(&self) -> Option<Vec<Leg>> {
        let timing = self.made_for?.options().timing;
        let legs = (0..).zip(&self.legs).map(|(index, leg)| leg.to_wire(index, timing));
        Some(named(legs.collect()))
    }

    /// The legs for a robot with `limits`, made as `options` say: those of the plan where it was made for
    /// just that, others along the same way where it was not. Legs of a given time are the same for every
    /// robot; one that is too slow for them refuses them.
    pub fn legs_for(&self, options: &LegOptions, limits: &Limits) -> Vec<Leg> {
        let wanted = MadeFor::new(options, limits);
        let fits = |made_for: MadeFor| {
            made_for == wanted || made_for.leg_time.is_some() && made_for.options() == *options
        };
        let planned = self.planned_legs().filter(|_| self.made_for.is_some_and(fits));
        planned.unwrap_or_else(|| {
            to_legs(&self.waypoints, self.start_heading(), self.goal_heading(), options, limits)
        })
    }

    /// Makes sure that legs, waypoints and scene belong together and the way is free.
    ///
    /// # Errors
    /// [`PlanFileError`] with what does not fit.
    pub fn check(&self) -> Result<(), PlanFileError> {
        self.scene.check()?;
        let finite = self.waypoints.iter().all(|point| point.x.is_finite() && point.y.is_finite());
        if !finite || self.waypoints.is_empty() {
            return Err(torn("a waypoint is missing or not finite"));
        }
        let mut corners = self.waypoints.clone();
        corners.dedup();
        if self.legs.len() + 1 != corners.len().max(self.legs.len().min(1) + 1) {
            return Err(torn(&format!("{} legs for {} waypoints", self.legs.len(), corners.len())));
        }
        for (index, leg) in self.legs.iter().enumerate() {
            let from = corners[index];
            let to = corners.get(index + 1).copied().unwrap_or(from);
            let goal = Point::new(leg.goal.0, leg.goal.1);
            let (off_start, off_goal) = (leg.start.position.distance(from), goal.distance(to));
            // NaN fails the comparison, as it should.
            if !(off_start <= LEG_TOLERANCE
                && off_goal <= LEG_TOLERANCE
                && leg.start.heading.is_finite())
            {
                return Err(torn(&format!("leg {}", index + 1)));
            }
        }
        self.check_legs()?;
        // A robot parked at a wall is led away from it: nowhere is it nearer than where it stands.
        let parked = clearance(&self.waypoints[..1], &self.scene);
        let radius = self.scene.robot_radius;
        let clearance = clearance(&self.waypoints, &self.scene);
        if clearance + CLEARANCE_TOLERANCE < radius.min(parked) || parked <= 0.0 {
            return Err(PlanFileError::Touches { clearance, radius });
        }
        Ok(())
    }
}

impl PlanFile {
    /// Makes sure that each leg begins as the one before ends, and that times and limits are some.
    fn check_legs(&self) -> Result<(), PlanFileError> {
        if self.made_for.is_some_and(|made_for| !made_for.is_sane()) {
            return Err(torn("no robot has the limits that the legs were made for"));
        }
        let limits = self.made_for.map_or(DEFAULT_LIMITS, |made_for| made_for.limits());
        let mut ended: Option<f64> = None;
        for (index, leg) in self.legs.iter().enumerate() {
            let turn = ended.map_or(0.0, |heading| wrap_angle(leg.start.heading - heading));
            let goal_heading = leg.goal.2.unwrap_or(0.0);
            let takes = leg.duration.unwrap_or(0.0);
            if !(turn.abs() <= HEADING_TOLERANCE && goal_heading.is_finite() && takes >= 0.0) {
                return Err(torn(&format!("the heading or time of leg {}", index + 1)));
            }
            let wire = leg.to_wire(0, Timing::Limits);
            ended = Some(wire.intervals(&limits)[2].end().heading.0.into());
        }
        Ok(())
    }
}

impl Serialize for PlanFile {
    fn serialize<S: serde::Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        match self.scene.origin {
            Some(origin) => Self::serialize(&self.moved_by(origin.x, origin.y), serializer),
            None => Self::serialize(self, serializer),
        }
    }
}

impl<'de> Deserialize<'de> for PlanFile {
    fn deserialize<D: serde::Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        let plan = Self::deserialize(deserializer)?;
        Ok(match plan.scene.origin {
            Some(origin) => plan.moved_by(-origin.x, -origin.y),
            None => plan,
        })
    }
}

impl PlanFile {
    /// The same plan with waypoints and legs `x` and `y` metres further; its scene moves itself.
    fn moved_by(&self, x: f64, y: f64) -> Self {
        let point = |at: &Point| Point::new(at.x + x, at.y + y);
        let leg = |leg: &PlannedLeg| PlannedLeg {
            start: Pose { position: point(&leg.start.position), ..leg.start },
            goal: (leg.goal.0 + x, leg.goal.1 + y, leg.goal.2),
            ..*leg
        };
        Self {
            waypoints: self.waypoints.iter().map(point).collect(),
            legs: self.legs.iter().map(leg).collect(),
            ..self.clone()
        }
    }
}

impl From<&GridStages> for AreaNumbers {
    fn from(stages: &GridStages) -> Self {
        let path = &stages.global_path.areas;
        Self {
            columns: stages.closed.columns(),
            rows: stages.closed.rows(),
            start: path.first().map_or(0, |area| area.number()),
            goal: path.last().map_or(0, |area| area.number()),
            traps: stages.traps.iter().map(|area| area.number()).collect(),
        }
    }
}

/// The matrix with traps closed; the ring that the robot's radius keeps free along the border is no
/// part of it, if there is one.
fn matrix_rows(stages: &GridStages) -> Vec<Vec<u8>> {
    let mut rows = stages.closed.elements();
    let (border, inside) = (stages.arena.border, stages.arena.inside);
    if border != inside {
        rows = rows.into_iter().skip(1).collect();
        rows.pop();
        for row in &mut rows {
            row.remove(0);
            row.pop();
        }
    }
    rows
}

/// The inflation of plans that were written before they named one.
fn square() -> Inflation {
    Inflation::Square
}

fn torn(reason: &str) -> PlanFileError {
    PlanFileError::Torn { reason: reason.to_owned() }
}

#[cfg(test)]
mod tests;
