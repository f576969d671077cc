//! What is remembered of a mission that was cut short, so that `--resume` can go on with it.
//!
//! ```text
//! the robot still has the plan ─────────────────────► its own word holds: leg, pose
//! it was stopped, but not restarted ─► leg as noted ─► its own pose
//! it was restarted ──────────────────► leg as noted ─► where it was last heard, and how far it rolled on since
//! ```
//! A robot that restarts takes its place for the origin and counts its wheels' turns from there, so what
//! it says of itself is the way that it rolled on. What it rolled between its last word and its restart
//! nobody knows: some 20 ms, 8 mm at the default robot's full speed, and the time of the restart itself.
//!
//! One small file a plan and robot lies in the user's state folder for as long as the plan is not driven to its
//! end. Metres and radians, arena frame.

use super::endpoint::Endpoint;
use super::error::{CliError, Exit};
use super::mission::place;
use super::output::Output;
use protocol::message::Identity;
use protocol::motion::Leg;
use serde::{Deserialize, Serialize};
use std::env;
use std::fs;
use std::io::Read;
use std::path::PathBuf;
use wmr::geometry::Pose;
use wmr::legs::{from_wire, to_wire};
use wmr::link::LinkClient;
use wmr::link::mission::{Mission, Progress};
use wmr::link::resume::{ResumeError, after_restart, check_beside_leg};

/// No note is longer, bytes.
const LONGEST_NOTE: u64 = 4096;

/// What is written down of a mission.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
struct Note {
    format: NoteFormat,
    /// The plan's name, which is drawn from its legs.
    plan: u32,
    /// The first leg that is not known to have ended.
    next: u16,
    /// Where the robot was last heard.
    pose: Pose,
    /// The start of the robot that drove it.
    boot: u32,
    /// The robot that drove it; 0 if it has no number.
    #[serde(default)]
    chip: u64,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
enum NoteFormat {
    #[serde(rename = "wmr-resume/1")]
    Resume,
}

/// The memory of one plan on one robot.
#[derive(Debug)]
pub(crate) struct Memory {
    /// `None` where nothing can be resumed: the robot ends with the program, or there is no folder.
    file: Option<PathBuf>,
    plan: u32,
    legs: usize,
    boot: u32,
    chip: u64,
}

impl Memory {
    /// The memory of a mission of which nothing is to be remembered.
    pub(crate) fn none() -> Self {
        Self { file: None, plan: 0, legs: 0, boot: 0, chip: 0 }
    }

    /// The memory of `legs` on the robot that `client` has greeted.
    pub(crate) fn of(
        client: &mut LinkClient<Box<dyn Endpoint>>,
        legs: &[Leg],
        identity: Identity,
    ) -> Self {
        let plan = legs.first().map_or(0, |leg| leg.plan);
        let name = match identity.chip {
            0 => format!("{plan:08x}.json"),
            chip => format!("{plan:08x}-{chip:016x}.json"),
        };
        let file = state_folder().map(|folder| folder.join(name));
        Self {
            file: file.filter(|_| client.port_mut().outlives_the_program()),
            plan,
            legs: legs.len(),
            boot: client.robot().map_or(0, |robot| robot.nonce),
            chip: identity.chip,
        }
    }

    /// Writes down how far the mission has come. A mission is not ended because that fails.
    pub(crate) fn note(&self, progress: Progress, output: Output) {
        let Some(file) = &self.file else { return };
        let (format, pose) = (NoteFormat::Resume, from_wire(progress.pose));
        let chip = self.chip;
        let note =
            Note { format, plan: self.plan, next: progress.next, pose, boot: self.boot, chip };
        let written = serde_json::to_vec(&note).map_err(Into::into).and_then(|bytes| {
            file.parent().map_or(Ok(()), fs::create_dir_all)?;
            // Whole or not at all, whenever this program may be killed.
            let new = file.with_extension(std::process::id().to_string());
            fs::write(&new, bytes)?;
            fs::rename(&new, file)
        });
        if let Err(error) = written {
            output.say(&format!("{}: {error}; --resume may not work", file.display()));
        }
    }

    /// Forgets a mission that has reached its end.
    pub(crate) fn forget(&self) {
        if let Some(file) = &self.file {
            // Not there is as good as removed.
            let _ = fs::remove_file(file);
        }
    }

    /// The mission that drives the rest of `legs`, and its first leg.
    ///
    /// # Errors
    /// If nobody knows how far they were driven, the robot drove something else, or it stands
    /// somewhere else.
    pub(crate) fn take_up(
        &self,
        client: &LinkClient<Box<dyn Endpoint>>,
        legs: Vec<Leg>,
        output: Output,
    ) -> Result<(Mission, u16), CliError> {
        let here = client.telemetry().map(|telemetry| telemetry.pose).unwrap_or_default();
        match client.robot().and_then(|robot| robot.driven) {
            Some(driven) if driven.plan == self.plan => {
                self.say_rest(driven.next, output, "the robot still has the plan");
                let progress = Progress { next: driven.next, pose: here };
                return Ok((Mission::resume_from(legs, progress), driven.next));
            }
            Some(_) => {
                return Err(cannot(
                    "resume.other_plan",
                    "the robot has driven another plan since",
                    "resume that one, or drive this one from its start without --resume",
                ));
            }
            None => {}
        }
        let note = self.read().ok_or_else(|| {
            cannot(
                "resume.nothing",
                "neither the robot nor this computer remembers that this plan was begun and cut short",
                "drive it from its start without --resume; a plan is known again only with the same options",
            )
        })?;
        let restarted = note.boot != self.boot;
        let here = from_wire(here);
        let pose =
            if restarted { after_restart(note.pose, here).map_err(elsewhere)? } else { here };
        check_beside_leg(&legs, note.next, pose).map_err(elsewhere)?;
        let how = if restarted {
            format!(
                "the robot has restarted and lost its place; from where it was last heard and how it rolled on, it is taken to stand at {}",
                place(pose)
            )
        } else {
            format!("the robot stands at {}", place(pose))
        };
        self.say_rest(note.next, output, &how);
        let progress = Progress { next: note.next, pose: to_wire(pose) };
        Ok((Mission::resume_from(legs, progress), note.next))
    }

    fn say_rest(&self, next: u16, output: Output, how: &str) {
        output.say(&format!("{how}; {next} of {} legs are driven", self.legs));
    }

    fn read(&self) -> Option<Note> {
        // A note is a hundred bytes; what is longer is none.
        let mut bytes = Vec::new();
        fs::File::open(self.file.as_ref()?)
            .ok()?
            .take(LONGEST_NOTE)
            .read_to_end(&mut bytes)
            .ok()?;
        let note: Note = serde_json::from_slice(&bytes).ok()?;
        let fits =
            note.plan == self.plan && note.chip == self.chip && usize::from(note.next) <= self.legs;
        fits.then_some(note)
    }

    /// `error`, with what was driven and the command that goes on from there.
    pub(crate) fn offer(&self, error: CliError, progress: Progress) -> CliError {
        if self.file.is_none() {
            return error;
        }
        let message = format!(
            "{}; {} of {} legs are driven, and it was last heard at {}",
            error.message,
            progress.next,
            self.legs,
            place(from_wire(progress.pose))
        );
        let help = format!("{}, or go on from where it stands: {}", error.help, command());
        CliError { message, help, ..error }
    }
}

/// The robot does not stand where the rest of the plan begins.
fn elsewhere(error: ResumeError) -> CliError {
    CliError::of(Exit::Usage, "resume.elsewhere", &error)
}

fn cannot(code: &str, message: impl std::fmt::Display, help: &str) -> CliError {
    CliError::new(Exit::Usage, code, message, help)
}

/// Where programs keep what a user would not miss: after the XDG base directories, or as Windows has it.
pub(crate) fn state_folder() -> Option<PathBuf> {
    // The XDG rule: what is not absolute is passed over.
    let set = |name| env::var_os(name).map(PathBuf::from).filter(|path| path.is_absolute());
    let home = || set("HOME").map(|home| home.join(".local").join("state"));
    let base = set("XDG_STATE_HOME").or_else(|| set("LOCALAPPDATA")).or_else(home)?;
    Some(base.join("wmr"))
}

/// The command that was typed, with `--resume`, as a shell reads it.
fn command() -> String {
    let mut words: Vec<String> = env::args().collect();
    if !words.iter().any(|word| word == "--resume") {
        words.push("--resume".into());
    }
    words.iter().map(|word| quoted(word)).collect::<Vec<_>>().join(" ")
}

fn quoted(word: &str) -> String {
    let plain = |c: char| c.is_alphanumeric() || "-_./:=,@+%".contains(c);
    if !word.is_empty() && word.chars().all(plain) {
        word.to_owned()
    } else {
        format!("'{}'", word.replace('\'', r"'\''"))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_shell_reads_the_words_as_they_were_typed() {
        assert_eq!(quoted("--port=/dev/ttyACM0"), "--port=/dev/ttyACM0");
        assert_eq!(quoted("my plan.json"), "'my plan.json'");
        assert_eq!(quoted("it's"), r"'it'\''s'");
        assert_eq!(quoted(""), "''");
    }
}
