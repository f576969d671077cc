//! What the command line says when something fails: what, why, and what to type next.

use hil_sim::emulator::EmulatorError;
use protocol::message::Fault;
use serde_json::json;
use std::fmt::Display;
use wmr::calibration::CalibrationError;
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
    pub(crate) details: Option<serde_json::Value>,
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
            details: None,
            after_result: false,
        }
    }

    /// An error of the library: its text says what, and after a semicolon what to do.
    pub(crate) fn advised(exit: Exit, code: &str, error: &impl Display, help: &str) -> Self {
        let text = error.to_string();
        match text.split_once("; ") {
            Some((message, advice)) => Self::new(exit, code, message, advice),
            None => Self::new(exit, code, text, help),
        }
    }

    pub(crate) fn usage(message: impl Display, help: impl Display) -> Self {
        Self::new(Exit::Usage, "usage", message, help)
    }

    /// The document that `--json` prints.
    pub(crate) fn json(&self) -> serde_json::Value {
        let mut error = json!({"code": self.code, "message": self.message, "help": self.help});
        if let (Some(serde_json::Value::Object(details)), Some(fields)) =
            (&self.details, error.as_object_mut())
        {
            details.iter().for_each(|(name, value)| {
                fields.entry(name.clone()).or_insert_with(|| value.clone());
            });
        }
        json!({ "error": error })
    }
}

impl From<VisionError> for CliError {
    fn from(error: VisionError) -> Self {
        let help = "take another photo, or describe the arena in a scene file";
        Self::advised(Exit::File, "photo", &error, help)
    }
}

impl From<SceneError> for CliError {
    fn from(error: SceneError) -> Self {
        Self::advised(Exit::File, "scene", &error, "see the README for the scene format")
    }
}

impl From<PlanFileError> for CliError {
    fn from(error: PlanFileError) -> Self {
        let exit =
            if matches!(error, PlanFileError::Touches { .. }) { Exit::NoPath } else { Exit::File };
        Self::advised(exit, "plan.file", &error, "plan again with wmr plan")
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
        let help = "move an obstacle, or try a smaller --radius or --margin";
        let details = plan_details(&error);
        Self { details, ..Self::advised(exit, &format!("plan.{}", error.code()), &error, help) }
    }
}

/// The numbers behind a plan's failure; obstacles are counted from 0, as in the scene, and the border
/// is `null`.
fn plan_details(error: &PlanError) -> Option<serde_json::Value> {
    match error {
        PlanError::NoPath { gap: Some(gap) } => {
            let between = gap.between.map(|side| match side {
                Side::Obstacle(index) => json!(index),
                Side::Border => json!(null),
            });
            Some(json!({"gap": {"width": gap.width, "need": gap.need, "between": between}}))
        }
        PlanError::Blocked { nearest: Some(nearest), .. } => Some(json!({"nearest": nearest})),
        _ => None,
    }
}

impl From<PortError> for CliError {
    fn from(error: PortError) -> Self {
        let (code, help) = match &error {
            PortError::Missing { .. } => (
                "port.missing",
                "wmr ports lists what is there; without a robot: --port sim".to_owned(),
            ),
            PortError::Busy { .. } => (
                "port.busy",
                "close the other program (a serial monitor? a second wmr? press Ctrl-C there); to stop the robot at once pull its cable: it stops within 0.3 s of silence".to_owned(),
            ),
            PortError::Denied { .. } => {
                ("port.denied", "sudo usermod -aG dialout $USER, then log out and in".to_owned())
            }
            PortError::NotOne { found: 0, .. } => (
                "port.none",
                "plug the robot in with a data cable, or try without one: --port sim".to_owned(),
            ),
            PortError::NotOne { .. } => {
                ("port.several", "choose one with --port; wmr ports lists them".to_owned())
            }
            PortError::BootLoader { .. } => (
                "port.boot_loader",
                "plug it in again without holding BOOTSEL, or copy target/firmware/pico.uf2 onto its drive"
                    .to_owned(),
            ),
            PortError::Other { .. } => ("port.other", "wmr ports lists what is there".to_owned()),
        };
        Self::new(Exit::Port, code, error, help)
    }
}

impl From<EmulatorError> for CliError {
    fn from(error: EmulatorError) -> Self {
        Self::advised(Exit::Port, "port.elf", &error, "build the firmware with firmware/build")
    }
}

impl From<LinkError> for CliError {
    fn from(error: LinkError) -> Self {
        let (code, help) = match &error {
            LinkError::Port(_) | LinkError::Lost(_) => {
                ("link.lost", "check the cable, then drive again")
            }
            LinkError::NoResponse(_) => (
                "link.silent",
                "is it the right port, and does a robot with wmr firmware listen there?",
            ),
            LinkError::NoAck(_) => (
                "link.deaf",
                "check the wire from this computer to the robot (its RX pin), then drive again",
            ),
            LinkError::NotARobot { .. } => (
                "link.not_a_robot",
                "another device or another firmware answers there; wmr ports lists what is there",
            ),
            LinkError::Version { .. } => {
                ("link.version", "flash the firmware that belongs to this program")
            }
            LinkError::NoAnswer(_) | LinkError::NoTelemetry(_) => (
                "link.no_answer",
                "unplug the robot and plug it in again; if that does not help, flash its firmware anew",
            ),
            LinkError::ClockStopped(_) => (
                "link.clock_stopped",
                "something repeats old words; unplug the robot and plug it in again",
            ),
            LinkError::Restarted(_) => {
                ("link.restarted", "check its battery, put it at the start, and drive again")
            }
        };
        Self::new(Exit::Link, code, error, help)
    }
}

impl From<ParameterError> for CliError {
    fn from(error: ParameterError) -> Self {
        match error {
            ParameterError::Link(error) => error.into(),
            ParameterError::Refused(_) => {
                let help = "nothing has changed; wmr params shows all numbers and their ranges";
                Self::advised(Exit::Robot, "robot.refused", &error, help)
            }
        }
    }
}

impl From<CalibrationError> for CliError {
    fn from(error: CalibrationError) -> Self {
        let help = "the robot keeps its old lengths; calibrate again";
        Self::advised(Exit::Robot, "calibrate", &error, help)
    }
}

impl From<MissionError> for CliError {
    fn from(error: MissionError) -> Self {
        match error {
            MissionError::Link(error) => error.into(),
            MissionError::Refused(_) | MissionError::TooManyLegs { .. } => Self::new(
                Exit::Robot,
                "robot.refused",
                error,
                "nothing has moved; change the plan and drive again",
            ),
            MissionError::Fault { fault: Fault::Encoder, .. } => Self::new(
                Exit::Robot,
                "robot.fault",
                error,
                "put it on a block and run wmr check base, which finds wires that are crossed or reversed; see that counts-per-turn is right in wmr params, and watch the counts in wmr monitor",
            ),
            MissionError::Fault { .. } => Self::new(
                Exit::Robot,
                "robot.fault",
                error,
                "free the robot, put it at the start, and drive again",
            ),
            MissionError::BatteryEmpty { .. } => Self::new(
                Exit::Robot,
                "robot.battery",
                error,
                "charge it or change the cells; wmr params shows battery-stop, the voltage that counts as empty",
            ),
            MissionError::NotDriving { .. } | MissionError::NeverRests(_) => Self::new(
                Exit::Robot,
                "robot.not_driving",
                error,
                "look at the robot; wmr stop and then wmr drive begin anew",
            ),
            MissionError::Late { .. } => Self::new(
                Exit::Link,
                "robot.late",
                error,
                "look for wheels that slip or drag and for a weak battery; drive more slowly with wmr params speed=0.2",
            ),
            MissionError::Disagrees { .. } | MissionError::Impossible(_) => Self::new(
                Exit::Robot,
                "robot.contradiction",
                error,
                "look where the robot really stands before you drive again; flash its firmware anew if this repeats",
            ),
            MissionError::Unfit(_) => Self::new(
                Exit::Robot,
                "robot.unfit",
                error,
                "nothing has moved; set its numbers with wmr params, or flash its firmware anew",
            ),
            MissionError::Cancelled { .. } => {
                Self::new(Exit::Robot, "robot.cancelled", error, "drive the rest with another plan")
            }
            MissionError::Stopped => Self::new(
                Exit::Robot,
                "robot.stopped",
                error,
                "put it at the start and drive again",
            ),
        }
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

    #[test]
    fn programs_get_the_numbers_of_a_gap() {
        let between = [Side::Obstacle(2), Side::Border];
        let gap = wmr::plan::Gap { width: 0.11, need: 0.15, between };
        let document = CliError::from(PlanError::NoPath { gap: Some(gap) }).json();
        let gap = json!({"width": 0.11, "need": 0.15, "between": [2, null]});
        assert_eq!(document["error"]["gap"], gap);
        assert_eq!(document["error"]["code"], "plan.no_path");
    }

    #[test]
    fn advice_stands_after_the_semicolon() {
        let error = CliError::from(PlanError::NoPath { gap: None });
        assert_eq!(error.exit, Exit::NoPath);
        assert_eq!(error.code, "plan.no_path");
        assert!(!error.help.is_empty() && !error.message.contains(';'), "{error:?}");
    }
}
