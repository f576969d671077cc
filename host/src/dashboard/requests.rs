//! What a page asks for, as JSON. A name that is not known is refused, so that a slip of the pen does not
//! drive with a default.

use super::error::Failure;
use super::live::Hold;
use super::reading::{Reading, named};
use crate::cli::args::WayArgs;
use serde::Deserialize;
use serde_json::Value;
use std::collections::BTreeMap;
use wmr::geometry::Arena;
use wmr::scene::Goal;

/// `POST /api/photo`, where the photo is not the body itself.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct SampleRequest {
    /// `demo`, the bundled one, or `camera`, the newest frame of the camera over the arena.
    pub(super) sample: String,
}

/// `POST /api/corners`.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct CornersRequest {
    /// Lower left, lower right, upper right, upper left; `null` looks for them again.
    pub(super) corners_px: Option<[[f64; 2]; 4]>,
}

/// `POST /api/detect`.
#[derive(Debug, Default, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct DetectRequest {
    pub(super) arena: Option<Arena>,
    pub(super) robot_radius: Option<f64>,
    /// Takes the place of the last one as a whole.
    pub(super) reading: Option<Reading>,
    /// Whether to forget what a person has corrected.
    #[serde(default)]
    pub(super) afresh: bool,
}

/// `POST /api/plan`; what is not given stays as it was.
#[derive(Debug, Default, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct PlanRequest {
    pub(super) scene: Option<Value>,
    pub(super) start: Option<Goal>,
    pub(super) goal: Option<Goal>,
    pub(super) margin: Option<f64>,
    pub(super) planner: Option<String>,
    pub(super) cost: Option<String>,
    pub(super) inflation: Option<String>,
    pub(super) timing: Option<String>,
    pub(super) leg_time: Option<f64>,
    pub(super) no_reverse: Option<bool>,
}

/// `POST /api/drive`.
#[derive(Debug, Default, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct DriveRequest {
    /// The revision of the plan that the person saw.
    pub(super) plan: Option<u64>,
    /// Whether to drive on when the last page is closed.
    #[serde(default)]
    pub(super) unattended: bool,
}

/// `POST /api/connect`.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct ConnectRequest {
    pub(super) port: String,
}

/// `POST /api/parameters`.
#[derive(Debug, Default, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub(super) struct ParametersRequest {
    /// Numbers to change, by their names; none only reads.
    pub(super) values: BTreeMap<String, f64>,
    /// Whether the robot is to keep them when it loses power.
    pub(super) keep: bool,
}

/// `POST /api/jog`: a step, or a button that is held or let go.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct JogRequest {
    /// Metres ahead; behind if negative.
    pub(super) distance: Option<f64>,
    /// Radians to the left; to the right if negative.
    pub(super) turn: Option<f64>,
    /// A button that is held, to be said again before 0.3 s have passed; `"none"` lets it go.
    pub(super) hold: Option<HoldName>,
    /// Whether it was pressed just now.
    #[serde(default)]
    pub(super) begin: bool,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize)]
#[serde(untagged)]
pub(super) enum HoldName {
    Held(Hold),
    LetGo(LetGo),
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "lowercase")]
pub(super) enum LetGo {
    None,
}

impl PlanRequest {
    /// The same as the options of `wmr plan`.
    pub(super) fn way_args(&self) -> Result<WayArgs, Failure> {
        let mut args = WayArgs { start: self.start, goal: self.goal, ..WayArgs::default() };
        args.margin = self.margin;
        if let Some(margin) = self.margin
            && !(0.0..=MOST_MARGIN).contains(&margin)
        {
            return Err(Failure::bad_request(format!(
                "a margin of {margin} m is not possible; 0 to {MOST_MARGIN} m"
            )));
        }
        args.planner = named(&self.planner)?.unwrap_or(args.planner);
        args.cost = named(&self.cost)?.unwrap_or(args.cost);
        args.inflation = named(&self.inflation)?;
        args.timing = named(&self.timing)?;
        args.no_reverse = self.no_reverse.unwrap_or(false);
        if let Some(seconds) = self.leg_time {
            if !(seconds > 0.0 && seconds <= MOST_LEG_TIME) {
                return Err(Failure::bad_request(format!("a leg of {seconds} s is not possible")));
            }
            args.leg_time = Some(seconds);
        }
        Ok(args)
    }
}

/// More than this is no margin but another arena, metres.
const MOST_MARGIN: f64 = 10.0;
/// As on the command line, seconds.
const MOST_LEG_TIME: f64 = 900.0;

#[cfg(test)]
mod tests {
    use super::*;
    use crate::cli::args::{CostName, PlannerName};

    #[test]
    fn names_are_those_of_the_command_line() {
        let request: PlanRequest =
            serde_json::from_str(r#"{"planner":"tree","cost":"turns","goal":[1,2,0.5]}"#).unwrap();
        let args = request.way_args().unwrap();
        assert_eq!((args.planner, args.cost), (PlannerName::Tree, CostName::Turns));
        assert_eq!(args.goal.unwrap().heading, Some(0.5));
    }

    #[test]
    fn what_makes_no_sense_is_refused_with_what_is_known() {
        for text in [
            r#"{"planner":"Exact"}"#,
            r#"{"margin":-0.001}"#,
            r#"{"margin":1e9}"#,
            r#"{"leg_time":0}"#,
        ] {
            let request: PlanRequest = serde_json::from_str(text).unwrap();
            assert!(request.way_args().is_err(), "{text}");
        }
        let request: PlanRequest = serde_json::from_str(r#"{"planner":"a*"}"#).unwrap();
        let message = request.way_args().unwrap_err().error.message;
        assert!(message.contains("exact, grid, tree"), "{message}");
        assert!(serde_json::from_str::<PlanRequest>(r#"{"planer":"grid"}"#).is_err());
        assert!(serde_json::from_str::<JogRequest>(r#"{"distance":"far"}"#).is_err());
    }
}
