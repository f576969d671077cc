//! What the command line says when something fails: what, why, and what to type next.

use super::port_rights::join_group;
use hil_sim::emulator::EmulatorError;
use miette::Diagnostic;
use serde_json::{Map, Value, json};
use std::fmt::Display;
use std::path::Path;
use wmr::calibration::CalibrationError;
use wmr::document::{Failure, FailureDocument};
use wmr::link::LinkError;
use wmr::link::mission::MissionError;
use wmr::link::parameters::ParameterError;
use wmr::link::port::PortError;
use wmr::plan::{PlanError, Side};
use wmr::plan_file::PlanFileError;
use wmr::scene::SceneError;
use wmr::vision::VisionError;

/// How the program ends; other programs rely on the numbers.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Exit {
    /// A bug of this program.
    Bug = 1,
    /// The command makes no sense.
    Usage = 2,
    /// A photo or file cannot be used.
    File = 3,
    /// There is no way to the goal.
    NoPath = 4,
    /// The port cannot be opened.
    Port = 5,
    /// The link failed.
    Link = 6,
    /// The robot stopped.
    Robot = 7,
    /// The user pressed Ctrl-C, and the robot has stopped.
    Interrupted = 130,
}

/// One failure.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct CliError {
    pub(crate) exit: Exit,
    /// A stable name for programs: stage, dot, kind.
    pub(crate) code: String,
    pub(crate) message: String,
    pub(crate) help: String,
    /// What else programs can use: fields beside the message.
    pub(crate) details: Map<String, Value>,
    /// The command's document is printed already: a second one would break `--json`.
    pub(crate) after_result: bool,
}

impl CliError {
    pub(crate) fn new(exit: Exit, code: &str, message: impl Display, help: impl Display) -> Self {
        Self {
            exit,
            code: code.into(),
            message: message.to_string(),
            help: help.to_string(),
            details: Map::new(),
            after_result: false,
        }
    }

    /// An error of the library, with the help that it carries.
    pub(crate) fn of(exit: Exit, code: &str, error: &impl Diagnostic) -> Self {
        match error.help() {
            Some(help) => Self::new(exit, code, error, help),
            None => Self::new(exit, code, error, "wmr doctor looks for what is wrong here"),
        }
    }

    /// The same, said of the file in which it was found.
    pub(crate) fn in_file(self, path: &Path) -> Self {
        Self { message: format!("{}: {}", path.display(), self.message), ..self }
    }

    pub(crate) fn usage(message: impl Display, help: impl Display) -> Self {
        Self::new(Exit::Usage, "usage", message, help)
    }

    /// The two lines that a person reads.
    pub(crate) fn text(&self) -> String {
        let Self { code, message, help, .. } = self;
        format!("error[{code}]: {message}\nhelp: {help}")
    }

    /// The document that `--json` prints.
    pub(crate) fn document(&self) -> FailureDocument {
        FailureDocument { error: self.failure() }
    }

    /// What the document holds.
    pub(crate) fn failure(&self) -> Failure {
        Failure {
            code: self.code.clone(),
            message: self.message.clone(),
            help: self.help.clone(),
            details: self.details.clone(),
        }
    }
}

impl From<VisionError> for CliError {
    fn from(error: VisionError) -> Self {
        Self::of(Exit::File, "photo", &error)
    }
}

impl From<SceneError> for CliError {
    fn from(error: SceneError) -> Self {
        Self::of(Exit::File, "scene", &error)
    }
}

impl From<PlanFileError> for CliError {
    fn from(error: PlanFileError) -> Self {
        let exit =
            if matches!(error, PlanFileError::Touches { .. }) { Exit::NoPath } else { Exit::File };
        Self::of(exit, "plan.file", &error)
    }
}

impl From<PlanError> for CliError {
    fn from(error: PlanError) -> Self {
        let exit = match &error {
            PlanError::Grid(_) => Exit::File,
            PlanError::Unsafe { .. } => Exit::Bug,
            PlanError::DiscNeedsExact
            | PlanError::FuzzyAlone
            | PlanError::RiskWeight { .. }
            | PlanError::Areas { .. } => Exit::Usage,
            _ => Exit::NoPath,
        };
        let details = plan_details(&error);
        Self { details, ..Self::of(exit, &format!("plan.{}", error.code()), &error) }
    }
}

/// The numbers behind a plan's failure; obstacles are counted from 0, as in the scene, and the border
/// is `null`.
fn plan_details(error: &PlanError) -> Map<String, Value> {
    let (name, value) = match error {
        PlanError::NoPath { gap: Some(gap) } => {
            let between = gap.between.map(|side| match side {
                Side::Obstacle(index) => json!(index),
                Side::Border => json!(null),
            });
            ("gap", json!({"width": gap.width, "need": gap.need, "between": between}))
        }
        PlanError::Blocked { nearest: Some(nearest), .. } => ("nearest", json!(nearest)),
        _ => return Map::new(),
    };
    Map::from_iter([(name.to_owned(), value)])
}

impl From<PortError> for CliError {
    fn from(error: PortError) -> Self {
        let code = match &error {
            // Only this computer knows which group may open the device.
            PortError::Denied { name } => {
                return Self::new(Exit::Port, "port.denied", &error, join_group(name));
            }
            PortError::Missing { .. } | PortError::NobodyListens { .. } => "port.missing",
            PortError::Busy { .. } => "port.busy",
            PortError::NotOne { found: 0, .. } => "port.none",
            PortError::NotOne { .. } => "port.several",
            PortError::BootLoader { .. } => "port.boot_loader",
            PortError::Other { .. } => "port.other",
        };
        Self::of(Exit::Port, code, &error)
    }
}

impl From<EmulatorError> for CliError {
    fn from(error: EmulatorError) -> Self {
        Self::of(Exit::Port, "port.elf", &error)
    }
}

impl From<LinkError> for CliError {
    fn from(error: LinkError) -> Self {
        let code = match &error {
            LinkError::Port(_) | LinkError::Lost(_) => "link.lost",
            LinkError::NoResponse(_) => "link.silent",
            LinkError::NoAck(_) => "link.deaf",
            LinkError::NotARobot { .. } => "link.not_a_robot",
            LinkError::Version { .. } => "link.version",
            LinkError::NoAnswer(_) | LinkError::NoTelemetry(_) => "link.no_answer",
            LinkError::ClockStopped(_) => "link.clock_stopped",
            LinkError::Restarted(_) => "link.restarted",
        };
        Self::of(Exit::Link, code, &error)
    }
}

impl From<ParameterError> for CliError {
    fn from(error: ParameterError) -> Self {
        match error {
            ParameterError::Link(error) => error.into(),
            ParameterError::Refused(_) => Self::of(Exit::Robot, "robot.refused", &error),
        }
    }
}

impl From<CalibrationError> for CliError {
    fn from(error: CalibrationError) -> Self {
        Self::of(Exit::Robot, "calibrate", &error)
    }
}

impl From<MissionError> for CliError {
    fn from(error: MissionError) -> Self {
        let (exit, code) = match error {
            MissionError::Link(error) => return error.into(),
            MissionError::Refused(_) | MissionError::TooManyLegs { .. } => {
                (Exit::Robot, "robot.refused")
            }
            MissionError::Fault { .. } => (Exit::Robot, "robot.fault"),
            MissionError::BatteryEmpty { .. } => (Exit::Robot, "robot.battery"),
            MissionError::NotDriving { .. } | MissionError::NeverRests(_) => {
                (Exit::Robot, "robot.not_driving")
            }
            MissionError::Late { .. } => (Exit::Link, "robot.late"),
            MissionError::Disagrees { .. } | MissionError::Impossible(_) => {
                (Exit::Robot, "robot.contradiction")
            }
            MissionError::Unfit(_) => (Exit::Robot, "robot.unfit"),
            MissionError::Cancelled { .. } => (Exit::Robot, "robot.cancelled"),
            MissionError::Stopped => (Exit::Robot, "robot.stopped"),
        };
        Self::of(exit, code, &error)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_port_error_says_what_to_do() {
        let name = || "tty".to_owned();
        let errors = [
            (PortError::Missing { name: name() }, "port.missing"),
            (PortError::Busy { name: name() }, "port.busy"),
            (PortError::Denied { name: name() }, "port.denied"),
            (PortError::BootLoader { name: name() }, "port.boot_loader"),
            (PortError::NotOne { found: 0, looked_at: 2 }, "port.none"),
            (PortError::NotOne { found: 2, looked_at: 2 }, "port.several"),
        ];
        for (error, code) in errors {
            let error = CliError::from(error);
            assert_eq!((error.exit, error.code.as_str()), (Exit::Port, code));
            assert!(error.help.len() > 20, "{error:?}");
        }
    }

    /// What only a device can bring about is in the guide as it is said here.
    #[test]
    fn the_guide_shows_what_is_said_of_devices() {
        let guide = include_str!("../../book/src/mistakes.md");
        // On a computer with a robot, the guide's device may belong to another group.
        let name = || "/dev/ttyNoRobot".to_owned();
        let (robot, host) = ((3, 0x1234_5678_9abc_def0), (4, 0x0fed_cba9_8765_4321));
        let errors: [CliError; 5] = [
            PortError::Denied { name: name() }.into(),
            PortError::Busy { name: name() }.into(),
            PortError::BootLoader { name: "the robot".into() }.into(),
            LinkError::Version { firmware: [0, 1, 0], robot, host }.into(),
            LinkError::Lost(std::time::Duration::from_secs(30)).into(),
        ];
        for error in errors {
            let shown = format!("? {}\n{}\n```", error.exit as u8, error.text());
            let shown = shown.replace("ttyNoRobot", "ttyACM0");
            assert!(guide.contains(&shown), "{shown}");
        }
    }

    #[test]
    fn programs_get_the_numbers_of_a_gap() {
        let between = [Side::Obstacle(2), Side::Border];
        let gap = wmr::plan::Gap { width: 0.11, need: 0.15, between };
        let document = CliError::from(PlanError::NoPath { gap: Some(gap) }).failure();
        let gap = json!({"width": 0.11, "need": 0.15, "between": [2, null]});
        assert_eq!(document.details["gap"], gap);
        assert_eq!(document.code, "plan.no_path");
    }

    #[test]
    fn what_and_why_is_told_from_what_to_do() {
        let error = CliError::from(PlanError::NoPath { gap: None });
        assert_eq!(error.exit, Exit::NoPath);
        assert_eq!(error.code, "plan.no_path");
        let why = "no way leads from the start to the goal: obstacles that touch each other or the border shut it off";
        assert_eq!([error.message.as_str(), &error.help], [why, "move one of them"]);
    }
}
