//! What the other commands made: `wmr tags`, `export` and `sim`.

use super::PoseError;
use crate::geometry::Pose;
use serde::{Deserialize, Serialize};

/// `wmr tags --json`.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
pub struct TagsDocument {
    /// The sheet.
    pub file: String,
    /// The dictionary of its tags.
    pub dictionary: String,
    /// Their numbers.
    pub ids: Vec<usize>,
    /// Their side, metres.
    pub size: f64,
}

/// `wmr export --json`.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
pub struct ExportDocument {
    /// The files that were written.
    pub files: Vec<String>,
    /// Cells in a row.
    pub columns: usize,
    /// Rows of cells.
    pub rows: usize,
    /// The side of a cell, metres.
    pub resolution: f64,
}

/// `wmr sim --json`, once it has ended.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
pub struct SimulationDocument {
    /// Where the robot really is.
    pub true_pose: Pose,
    /// How often it came upon an obstacle or the border, if there is a scene.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub collisions: Option<u32>,
    /// How near it came to one, metres; negative where it overlapped one.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub min_clearance: Option<f64>,
}

/// A line of `frames.jsonl`, which `wmr sim --camera-out` writes beside the pictures.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
pub struct FrameLine {
    /// The picture.
    pub file: String,
    /// When it was exposed, simulated seconds.
    pub exposed: f64,
    /// When whoever looks had it, simulated seconds.
    pub delivered: f64,
    /// Where the robot really was.
    pub true_pose: Option<Pose>,
    /// The corners of each shape that moves, metres.
    pub moving: Vec<Vec<[f64; 2]>>,
}

/// `wmr sim --lockstep --json`, once the physics has gone.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
pub struct PhysicsDocument {
    /// How far its time got, seconds.
    pub t: f64,
}

/// `wmr sim --scenario --json`.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
pub struct ScenarioDocument {
    /// The scenario's title.
    pub title: String,
    /// How it ended.
    pub end: String,
    /// How it should have ended, if the file says so.
    pub expected: Option<String>,
    /// How long it took, simulated seconds.
    pub duration: f64,
    /// Where the robot really ended.
    pub true_pose: Pose,
    /// How far that is from the goal.
    pub error: PoseError,
    /// Whether it came upon something on the way.
    pub collided: bool,
}
