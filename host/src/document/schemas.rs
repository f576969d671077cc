//! The JSON Schemas in `host/schemas/` are those of the types.
//!
//! `UPDATE_GOLDEN=1 cargo test -p wmr --lib document` writes them.

use super::*;
use crate::plan_file::PlanFile;
use crate::scene::Scene;
use schemars::{Schema, schema_for};
use std::path::Path;

const FOLDER: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/schemas");

fn schemas() -> Vec<(&'static str, Schema)> {
    vec![
        ("calibrate-base", schema_for!(BaseCalibrationDocument)),
        ("calibrate-camera", schema_for!(CamerasDocument)),
        ("check-base", schema_for!(WiringDocument)),
        ("completions", schema_for!(CompletionsDocument)),
        ("detect", schema_for!(DetectionDocument)),
        ("doctor", schema_for!(DoctorDocument)),
        ("drive", schema_for!(DriveDocument)),
        ("error", schema_for!(FailureDocument)),
        ("export", schema_for!(ExportDocument)),
        ("export-drive", schema_for!(TableDocument)),
        ("flash", schema_for!(FlashDocument)),
        ("frame-line", schema_for!(FrameLine)),
        ("info", schema_for!(RobotDocument)),
        ("monitor-line", schema_for!(MonitorLine)),
        ("params", schema_for!(ParametersDocument)),
        ("plan", schema_for!(PlanFile)),
        ("plan-queries", schema_for!(QueriesDocument)),
        ("ports", schema_for!(PortsDocument)),
        ("replay", schema_for!(ReplayDocument)),
        ("run-line", schema_for!(RunLine)),
        ("scene", schema_for!(Scene)),
        ("sim", schema_for!(SimulationDocument)),
        ("sim-lockstep", schema_for!(PhysicsDocument)),
        ("sim-scenario", schema_for!(ScenarioDocument)),
        ("stop", schema_for!(StopDocument)),
        ("tags", schema_for!(TagsDocument)),
        ("watch-view", schema_for!(ViewDocument)),
        ("welcome", schema_for!(WelcomeDocument)),
    ]
}

#[test]
fn the_schemas_in_the_repository_are_those_of_the_types() {
    let update = std::env::var_os("UPDATE_GOLDEN").is_some();
    let known = schemas();
    for (name, schema) in &known {
        let path = Path::new(FOLDER).join(format!("{name}.schema.json"));
        let text = format!("{:#}\n", schema.as_value());
        if update {
            std::fs::write(&path, text).unwrap();
            continue;
        }
        let kept = std::fs::read_to_string(&path).unwrap();
        assert_eq!(kept, text, "{}: UPDATE_GOLDEN=1 writes it", path.display());
    }
    let files = std::fs::read_dir(FOLDER).unwrap().count();
    assert_eq!(files, known.len(), "a schema in {FOLDER} is of no document");
}
