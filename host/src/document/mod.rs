//! What the commands print with `--json`, as types: one document per command, and one for every failure.
//!
//! They stand at the end of the flow and hold what the stages found, so that a program in Rust reads a
//! document with `serde_json::from_str` and one in another language checks it against its JSON Schema in
//! `host/schemas/`. Two documents are files as well and live with their stage: [`Scene`](crate::scene::Scene)
//! and [`PlanFile`](crate::plan_file::PlanFile). Metres, radians and seconds; poses are `[x, y, heading]`,
//! in the frame of the map where the input is one.

mod drive;
mod failure;
mod kept;
mod photo;
mod plan;
mod robot;
#[cfg(test)]
mod schemas;
mod tools;
mod watch;

pub use drive::{DriveDocument, LegDocument, LinkDocument, PoseError, RunLine};
pub use failure::{Failure, FailureDocument};
pub use kept::{
    CheckDocument, CompletionsDocument, DoctorDocument, FlashDocument, ReplayDocument,
    SettingDocument, TableDocument, WelcomeDocument,
};
pub use photo::{CameraDocument, CamerasDocument, DetectionDocument, DetectionTiming};
pub use plan::{BuildTiming, FoundWay, QueriesDocument, QueryAnswer};
pub use robot::{
    BaseCalibrationDocument, BaseCalibrationState, LimitsDocument, MonitorLine, ParametersDocument,
    PortDocument, PortsDocument, RobotDocument, StopDocument, WiringBits, WiringDocument,
};
pub use tools::{
    ExportDocument, FrameLine, PhysicsDocument, ScenarioDocument, SimulationDocument, TagsDocument,
};
pub use watch::{EventDocument, ThingDocument, ViewDocument, WatchDocument};

pub use crate::legs::shortest;
