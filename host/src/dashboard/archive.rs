//! Drives that have ended, each in a folder of its own: listed, opened again, downloaded.
//!
//! ```text
//! FOLDER/run-0001/  photo  scene.json  plan.json  run.jsonl  report.json  14_path.svg  15_motion.svg …
//! ```

use crate::cli::error::{CliError, Exit};
use crate::cli::folder::Folder;
use crate::cli::input::Input;
use crate::cli::run::Run;
use crate::cli::way::PlannedWay;
use serde_json::{Value, json};
use std::path::{Path, PathBuf};
use std::time::UNIX_EPOCH;

/// The newest so many are listed.
const MOST_LISTED: usize = 100;
/// A file of a run is not larger.
const LARGEST_FILE: u64 = 64 << 20;
const PREFIX: &str = "run-";

/// The folder of all runs.
#[derive(Clone, Debug)]
pub(super) struct Archive(PathBuf);

impl Archive {
    pub(super) fn new(folder: &Path) -> Self {
        Self(folder.to_owned())
    }

    /// Writes down a drive that has ended; the name of its run.
    pub(super) fn keep(
        &self,
        photo: Option<&[u8]>,
        way: &PlannedWay,
        run: &Run,
        report: &Value,
    ) -> Result<String, CliError> {
        let last = self.numbers().into_iter().max().unwrap_or(0);
        let name = format!("{PREFIX}{:04}", last + 1);
        let path = self.0.join(&name);
        let folder = Folder::create(&path)?;
        if let Some(bytes) = photo {
            folder.write("photo", bytes)?;
        }
        folder.plan(way)?;
        folder.run(&Input::Scene(way.file.scene.clone()), way, run)?;
        // The report comes last: a folder with one is whole.
        folder.write("report.json", format!("{report}\n").as_bytes())?;
        Ok(name)
    }

    fn numbers(&self) -> Vec<u32> {
        let Ok(entries) = std::fs::read_dir(&self.0) else { return Vec::new() };
        let names = entries.flatten().filter_map(|entry| entry.file_name().into_string().ok());
        names.filter_map(|name| number(&name)).collect()
    }

    /// The runs that are whole, the newest first.
    pub(super) fn list(&self) -> Value {
        let mut numbers = self.numbers();
        numbers.sort_unstable_by(|one, other| other.cmp(one));
        let runs = numbers.into_iter().take(MOST_LISTED).filter_map(|number| self.line(number));
        json!({"folder": self.0.display().to_string(), "runs": runs.collect::<Vec<_>>()})
    }

    fn line(&self, number: u32) -> Option<Value> {
        let name = format!("{PREFIX}{number:04}");
        let path = self.0.join(&name).join("report.json");
        let ended = path.metadata().and_then(|data| data.modified()).ok()?;
        let ended = ended.duration_since(UNIX_EPOCH).ok()?.as_secs();
        let report: Value = serde_json::from_slice(&self.read(&name, "report.json")?).ok()?;
        Some(json!({
            "name": name, "ended": ended, "reached": report["reached"],
            "duration": report["duration"], "error": report["problem"]["message"],
        }))
    }

    /// Plan and report of a run, and the names of its files.
    pub(super) fn open(&self, name: &str) -> Option<Value> {
        number(name)?;
        let document =
            |file| -> Option<Value> { serde_json::from_slice(&self.read(name, file)?).ok() };
        let (plan, report) = (document("plan.json")?, document("report.json")?);
        let entries = std::fs::read_dir(self.0.join(name)).ok()?;
        let names = entries.flatten().filter_map(|entry| entry.file_name().into_string().ok());
        let mut files: Vec<String> = names.filter(|file| is_file_name(file)).collect();
        files.sort_unstable();
        Some(json!({"name": name, "plan": plan, "report": report, "files": files}))
    }

    /// A file of a run.
    pub(super) fn read(&self, name: &str, file: &str) -> Option<Vec<u8>> {
        number(name)?;
        if !is_file_name(file) {
            return None;
        }
        let path = self.0.join(name).join(file);
        // A link may lead anywhere.
        let data = path.symlink_metadata().ok()?;
        if !data.is_file() || data.len() > LARGEST_FILE {
            return None;
        }
        std::fs::read(path).ok()
    }
}

/// The number of a run, if `name` is one.
fn number(name: &str) -> Option<u32> {
    let digits = name.strip_prefix(PREFIX)?;
    let is_number = digits.len() >= 4 && digits.bytes().all(|byte| byte.is_ascii_digit());
    if is_number { digits.parse().ok() } else { None }
}

/// Whether a name leads nowhere else.
fn is_file_name(name: &str) -> bool {
    let is_plain = |byte: u8| byte.is_ascii_alphanumeric() || matches!(byte, b'_' | b'.' | b'-');
    !name.is_empty() && !name.starts_with('.') && name.bytes().all(is_plain)
}

/// How a browser is told what a file is; a picture of a person's own is shown, never run.
pub(super) fn content_type(file: &str, bytes: &[u8]) -> &'static str {
    match (file.rsplit('.').next(), bytes) {
        (Some("json"), _) => "application/json",
        (Some("jsonl"), _) => "application/jsonl",
        (Some("svg"), _) => "image/svg+xml",
        (_, [0xff, 0xd8, ..]) => "image/jpeg",
        (_, [0x89, b'P', ..]) => "image/png",
        _ => "application/octet-stream",
    }
}

/// A run that could not be kept is no reason to fail a drive that has ended.
pub(super) fn not_there() -> CliError {
    let help = "the list at /api/runs has all that are kept";
    CliError::new(Exit::Usage, "run.none", "there is no such run", help)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_lead_nowhere_else() {
        let folder = tempfile::tempdir().unwrap();
        let archive = Archive::new(&folder.path().join("runs"));
        std::fs::create_dir_all(folder.path().join("runs/run-0001")).unwrap();
        std::fs::write(folder.path().join("secret"), "s").unwrap();
        std::fs::write(folder.path().join("runs/run-0001/report.json"), "{}").unwrap();
        assert!(archive.read("run-0001", "report.json").is_some());
        for (name, file) in [
            ("..", "secret"),
            ("run-0001", "../../secret"),
            ("run-0001/../..", "secret"),
            ("run-0001", ".."),
            ("run-1", "report.json"),
            ("run-000x", "report.json"),
        ] {
            assert_eq!(archive.read(name, file), None, "{name} {file}");
        }
        assert_eq!(archive.list()["runs"].as_array().unwrap().len(), 1);
        assert_eq!(archive.open("run-0001"), None, "it has no plan");
    }

    #[test]
    fn what_is_not_there_is_an_empty_list() {
        let archive = Archive::new(Path::new("/nowhere/at/all"));
        assert_eq!(archive.list()["runs"], json!([]));
    }
}
