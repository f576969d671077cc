//! The plan as a file, `wmr-plan/1`: what was planned, in which scene, and the legs that drive it.
//!
//! It stands after the legs and before the link: [`PlanFile::new`] writes down a plan,
//! [`PlanFile::from_json`] reads one back and [`PlanFile::check`] makes sure that it is whole, so that a
//! plan edited by hand, or mixed up with another arena, moves nothing. Metres and radians.

use crate::geometry::{Point, Pose};
use crate::plan::{FuzzyStages, GridStages, Inflation, Plan, clearance};
use crate::scene::{Scene, SceneError};
use protocol::motion::{self, Leg};
use serde::{Deserialize, Serialize};

/// A plan with its scene. Its points are in the arena frame in memory, and in a file in the frame of
/// the scene's map, if it has one, as those of the scene are.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
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
    /// How long the default robot takes, seconds.
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
pub enum PlanFormat {
    /// The only version so far.
    #[serde(rename = "wmr-plan/1")]
    Plan,
}

/// Areas by their numbers: from 1, row by row from the top left, the dead ring included.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
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
pub struct PlanTiming {
    /// Preparing the arena.
    pub build: f64,
    /// Finding the way in it.
    pub query: f64,
}

/// One leg, as planned.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct PlannedLeg {
    /// Where it begins: x, y, heading.
    pub start: Pose,
    /// Where it ends: x, y, and the heading there if one is wanted.
    pub goal: (f64, f64, Option<f64>),
    /// Which end of the robot goes first.
    pub direction: PlannedDirection,
}

/// Which end of the robot goes first.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum PlannedDirection {
    /// Towards the heading.
    Forward,
    /// Away from the heading.
    Reverse,
}

/// Why a plan file cannot be driven.
#[derive(Debug, thiserror::Error)]
pub enum PlanFileError {
    /// The text is not JSON of the plan format.
    #[error("this is no plan: {0}; plan again with wmr plan")]
    Format(#[from] serde_json::Error),
    /// The scene in it makes no sense.
    #[error("the plan's scene: {0}; plan again with wmr plan")]
    Scene(#[from] SceneError),
    /// Legs and waypoints do not belong together.
    #[error("the plan's legs do not follow its waypoints ({reason}); plan again with wmr plan")]
    Torn {
        /// What does not fit.
        reason: String,
    },
    /// The way touches something in the scene.
    #[error(
        "the plan's way comes as near as {clearance:.4} m to an obstacle or the border of its scene, and the robot's radius is {radius} m; plan again with wmr plan"
    )]
    Touches {
        /// The least distance of the way to the scene's obstacles and border.
        clearance: f64,
        /// The robot's radius.
        radius: f64,
    },
}

/// Half a lattice step: what rounding outwards and back may cost, metres.
const CLEARANCE_TOLERANCE: f64 = 1e-4;
/// Legs are f32: within 100 m they resolve 8 µm, so a tenth of a millimetre tells a leg from another.
const LEG_TOLERANCE: f64 = 1e-4;

impl PlanFile {
    /// Writes down `plan`, made in `scene`, with the `legs` that drive it in `duration` seconds.
    pub fn new(
        plan: &Plan,
        scene: &Scene,
        legs: &[Leg],
        duration: f64,
        timing_us: PlanTiming,
    ) -> Self {
        Self {
            format: PlanFormat::Plan,
            planner: plan.planner.name().to_owned(),
            inflation: plan.inflation,
            waypoints: plan.waypoints.clone(),
            length: plan.length,
            clearance: plan.clearance,
            legs: legs.iter().map(PlannedLeg::from).collect(),
            duration,
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

impl From<&Leg> for PlannedLeg {
    fn from(leg: &Leg) -> Self {
        Self {
            start: crate::legs::from_wire(leg.start),
            goal: (
                leg.goal.x.0.into(),
                leg.goal.y.0.into(),
                leg.goal_heading.map(|heading| heading.0.into()),
            ),
            direction: match leg.direction {
                motion::Direction::Forward => PlannedDirection::Forward,
                motion::Direction::Reverse => PlannedDirection::Reverse,
            },
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
