//! What came of a drive: `wmr drive`, `wmr demo`, and the lines of a log.

use super::WatchDocument;
use crate::geometry::Pose;
use crate::link::LinkStatistics;
use serde::{Deserialize, Serialize};

/// `wmr drive --json`.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
pub struct DriveDocument {
    /// Whether the robot ended at the goal.
    pub reached: bool,
    /// Where it believes to be.
    pub pose: Pose,
    /// Where it is, if it is simulated.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub true_pose: Option<Pose>,
    /// How far from the goal it ended: by its true pose if that is known, else by what it believes.
    pub error: PoseError,
    /// How long the legs took, seconds of the robot's clock.
    pub duration: f64,
    /// The legs that were driven.
    pub legs: Vec<LegDocument>,
    /// How often the robot came upon an obstacle or the border, if it is simulated in a scene.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub collisions: Option<u32>,
    /// How near it came to one, metres; negative where it overlapped one.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub min_clearance: Option<f64>,
    /// How the link fared.
    pub link: LinkDocument,
    /// What the camera saw, if one watched.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub watch: Option<WatchDocument>,
}

/// The difference of two poses.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
pub struct PoseError {
    /// How far apart, metres.
    pub position: f64,
    /// The angle between their headings, radians, without its sign.
    pub heading: f64,
}

/// A leg that was driven.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
pub struct LegDocument {
    /// Its place in the plan, from 0.
    pub index: u16,
    /// How long it took, seconds.
    pub duration: f64,
    /// How far from its end it ended, by the robot's own pose.
    pub error: PoseError,
}

/// How the link fared.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
pub struct LinkDocument {
    /// Frames sent and received whole.
    pub frames: u32,
    /// Messages that were sent again.
    pub retransmitted: u32,
    /// Frames that arrived damaged.
    pub lost: u32,
}

impl PoseError {
    /// `position` metres, and `heading` radians of either sign.
    pub fn new(position: f64, heading: f64) -> Self {
        Self { position, heading: heading.abs() }
    }
}

impl From<LinkStatistics> for LinkDocument {
    fn from(LinkStatistics { frames, retransmitted, lost }: LinkStatistics) -> Self {
        Self { frames, retransmitted, lost }
    }
}

/// A line of `run.jsonl` in a log.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
pub struct RunLine {
    /// Seconds since the plan was accepted.
    pub t: f64,
    /// Where the robot believed to be.
    pub pose: Pose,
    /// How fast its left and right wheel turned, rad/s.
    pub wheels: [f32; 2],
    /// The leg it drove, from 0.
    pub leg: u16,
    /// What it did: `idle`, `driving`, `paused`, `stopped` or `faulted`.
    pub state: String,
}
