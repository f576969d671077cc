//! What is said of things that are kept, and of this computer: `wmr replay`, `export` of a drive, `flash`,
//! `doctor`, `completions`, and `wmr` alone.

use serde::{Deserialize, Serialize};

/// `wmr replay --json`.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
pub struct ReplayDocument {
    /// Where the pictures are.
    pub folder: String,
    /// Their names.
    pub files: Vec<String>,
    /// From the robot's first word to its last, seconds.
    pub duration: f64,
    /// How many words of the robot were kept.
    pub words: usize,
    /// Legs of the plan.
    pub legs: usize,
    /// What the robot did when it was last heard.
    pub last_state: String,
}

/// `wmr export --json` of a drive.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
pub struct TableDocument {
    /// The files that were written.
    pub files: Vec<String>,
    /// How many words of the robot are in it.
    pub rows: usize,
    /// From the first to the last, seconds.
    pub duration: f64,
}

/// `wmr flash --json`.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
pub struct FlashDocument {
    /// The board that took the firmware.
    pub board: String,
    /// Its boot drive, which is gone now.
    pub drive: String,
    /// How many bytes were copied.
    pub bytes: usize,
}

/// `wmr doctor --json`.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
pub struct DoctorDocument {
    /// What was looked at.
    pub checks: Vec<CheckDocument>,
    /// What is set by variables and files.
    pub settings: Vec<SettingDocument>,
    /// How many checks found something that will not work.
    pub to_fix: usize,
}

/// What was looked at, and what was found.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
pub struct CheckDocument {
    /// What was looked at.
    pub name: String,
    /// `ready`, `note` (nothing is wrong) or `fix` (something will not work).
    pub verdict: String,
    /// What was found.
    pub found: String,
    /// What to do, if anything.
    pub advice: Option<String>,
}

/// A setting that is in effect.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
pub struct SettingDocument {
    /// The option's name.
    pub name: String,
    /// Its value.
    pub value: String,
    /// The variable or file that says so.
    pub source: String,
}

/// `wmr completions --json`.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
pub struct CompletionsDocument {
    /// The shell.
    pub shell: String,
    /// What it is to read.
    pub script: String,
}

/// `wmr --json` without a command.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
pub struct WelcomeDocument {
    /// The program's version.
    pub version: String,
    /// Where to read on.
    pub help: String,
}
