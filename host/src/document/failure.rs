//! A failure as a document: what `--json` prints in place of the command's own.

use serde::{Deserialize, Serialize};
use serde_json::{Map, Value};

/// `{"error": …}`, with an exit code that is not 0.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
pub struct FailureDocument {
    /// What failed.
    pub error: Failure,
}

/// What failed, why, and what to do.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
pub struct Failure {
    /// A stable name for programs: stage, dot, kind.
    pub code: String,
    /// What happened, with its numbers.
    pub message: String,
    /// What to type or do next.
    pub help: String,
    /// More numbers, by code: `plan.no_path` has `gap` (`width` and `need` in metres, `between` the
    /// numbers of two obstacles from 0, `null` for the border), `plan.blocked` has `nearest`.
    #[serde(flatten)]
    pub details: Map<String, Value>,
}
