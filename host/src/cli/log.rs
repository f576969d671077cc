//! A folder that `wmr drive --log` or the page has written, read back.

use super::error::{CliError, Exit};
use super::input::read_bytes;
use std::path::Path;
use wmr::plan_file::PlanFile;
use wmr::run_log::{RunLog, RunLogError};

/// The robot's words on a drive.
pub(crate) const RUN: &str = "run.jsonl";
const PLAN: &str = "plan.json";

impl From<RunLogError> for CliError {
    fn from(error: RunLogError) -> Self {
        Self::of(Exit::File, "log", &error)
    }
}

/// A drive and the plan that it followed, both in the arena frame.
#[derive(Debug)]
pub(crate) struct Log {
    pub(crate) plan: PlanFile,
    pub(crate) run: RunLog,
}

impl Log {
    /// Reads the folder of a drive.
    pub(crate) fn read(folder: &Path) -> Result<Self, CliError> {
        if !folder.is_dir() {
            let message = format!("{} is no folder", folder.display());
            let help =
                "give a folder that wmr drive --log has written, such as wmr-out of wmr demo";
            return Err(CliError::new(Exit::File, "log.none", message, help));
        }
        let plan = PlanFile::from_json(&text(&folder.join(PLAN))?)?;
        let run = read_run(&folder.join(RUN))?;
        let run = run.in_arena_frame(super::way::origin(&plan.scene));
        Ok(Self { plan, run })
    }
}

/// Reads a run alone, in the frame that it is written in.
pub(crate) fn read_run(path: &Path) -> Result<RunLog, CliError> {
    Ok(RunLog::from_jsonl(&text(path)?)?)
}

fn text(path: &Path) -> Result<String, CliError> {
    String::from_utf8(read_bytes(path)?).map_err(|_| {
        let message = format!("{} is no text", path.display());
        CliError::new(Exit::File, "log", message, "give a folder that wmr drive --log has written")
    })
}
