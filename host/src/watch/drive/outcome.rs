//! How a drive is to be watched, and what comes of it.

use crate::link::LinkError;
use crate::link::drive::{DriveError, DriveEvent};
use crate::link::mission::MissionError;
use crate::track::pose::PoseSigma;
use crate::watch::event::{Reason, WatchEvent};
use crate::watch::route::Router;
use crate::watch::source::SourceError;
use serde::{Deserialize, Serialize};
use std::time::Duration;

/// How a drive is watched.
#[derive(Clone, Debug)]
pub struct WatchOptions {
    /// What plans.
    pub router: Router,
    /// How well the robot's pose is known in one frame.
    pub sigma: PoseSigma,
    /// A robot that is held for longer gives up.
    pub patience: Duration,
    /// Whether things that move are expected where they will be, or only where they are.
    pub foresees: bool,
}

/// Counts of a watched drive.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
pub struct WatchStatistics {
    /// Frames that came.
    pub frames: u32,
    /// Frames that showed the arena.
    pub used: u32,
    /// Poses that the robot was told.
    pub corrections: u32,
    /// Poses that lay too far from the estimate, or that the robot refused.
    pub refused: u32,
    /// How often the robot got other legs.
    pub replans: u32,
    /// How often it was held.
    pub waits: u32,
}

/// Why a watched drive ended before the goal; the robot rests, or has been told to stop.
#[derive(Debug, thiserror::Error, miette::Diagnostic)]
pub enum WatchError {
    /// The drive itself failed.
    #[error(transparent)]
    #[diagnostic(transparent)]
    Drive(#[from] DriveError),
    /// The camera will send nothing more.
    #[error("the robot has stopped, as its camera sends nothing more: {0}")]
    #[diagnostic(forward(0))]
    Source(#[from] SourceError),
    /// The robot was held for too long.
    #[error("the robot has stopped after waiting {:.0} s: {reason}", .waited.as_secs_f64())]
    #[diagnostic(help("{}", remedy(reason)))]
    GaveUp {
        /// Why it waited.
        reason: Reason,
        /// How long.
        waited: Duration,
    },
}

fn remedy(reason: &Reason) -> &'static str {
    match reason {
        Reason::NoWay(_) => "clear the way, then drive again",
        _ => "see what the camera sees with wmr detect, then drive again",
    }
}

impl From<MissionError> for WatchError {
    fn from(error: MissionError) -> Self {
        Self::Drive(error.into())
    }
}

impl From<LinkError> for WatchError {
    fn from(error: LinkError) -> Self {
        Self::Drive(error.into())
    }
}

/// What happens on a watched drive.
#[derive(Clone, Debug, PartialEq)]
pub enum Happening {
    /// Between robot and host.
    Drive(DriveEvent),
    /// Between camera and plan.
    Watch(WatchEvent),
}
