//! Many ways in one arena: `wmr plan --queries`. A single way is a [`PlanFile`](crate::plan_file::PlanFile).

use super::FailureDocument;
use crate::geometry::Point;
use serde::{Deserialize, Serialize};

/// `wmr plan --queries --json`.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
pub struct QueriesDocument {
    /// An answer to each query of the file, in its order.
    pub queries: Vec<QueryAnswer>,
    /// How long it took to prepare the arena.
    pub timing_us: BuildTiming,
}

/// A way, or why there is none.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
#[serde(untagged)]
pub enum QueryAnswer {
    /// A way.
    Found(FoundWay),
    /// Why there is none.
    Failed(FailureDocument),
}

/// A way in an arena that was prepared before.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
pub struct FoundWay {
    /// Its length, metres.
    pub length: f64,
    /// Where the robot turns, start and goal included.
    pub waypoints: Vec<Point>,
    /// How long it took to find, microseconds.
    pub timing_us: f64,
}

/// How long preparing took.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
pub struct BuildTiming {
    /// Microseconds.
    pub build: f64,
}
