//! Why a link cannot be used, and why a mission did not reach its goal: what happened, with its values.

use protocol::message::{Fault, PlanRefusal, ResetCause};
use protocol::motion::{Infeasible, Refusal};
use std::io;
use std::time::Duration;

/// Why the link cannot be used.
#[derive(Debug, thiserror::Error)]
pub enum LinkError {
    /// The port failed.
    #[error("the port failed: {0}")]
    Port(#[from] io::Error),
    /// Nothing answered hello.
    #[error("no robot answered within {0:?}")]
    NoResponse(Duration),
    /// Something answered, but not in this protocol.
    #[error("{bytes} bytes arrived within {within:?}, but no frame of a robot of ours")]
    NotARobot {
        /// Bytes that arrived.
        bytes: u64,
        /// How long was waited.
        within: Duration,
    },
    /// The robot fell silent.
    #[error("nothing heard from the robot for {0:?}; it stops by itself after 0.3 s of silence")]
    Lost(Duration),
    /// The robot is heard, but does not hear.
    #[error("the robot is heard, but took no notice of this program for {0:?}")]
    NoAck(Duration),
    /// The robot speaks another version of the protocol, so it may report and stop, but not drive.
    #[error(
        "the robot's firmware {} speaks protocol {} ({:016x}), this program {} ({:016x}); it does not drive",
        dotted(.firmware), .robot.0, .robot.1, .host.0, .host.1
    )]
    Version {
        /// The firmware's version.
        firmware: [u8; 3],
        /// The robot's version and schema hash.
        robot: (u16, u64),
        /// This program's.
        host: (u16, u64),
    },
    /// The robot began anew, so it has forgotten its plan.
    #[error("the robot has restarted: {}; it is at rest and has forgotten the plan", .0.explanation())]
    Restarted(ResetCause),
}

fn dotted([major, minor, patch]: &[u8; 3]) -> String {
    format!("{major}.{minor}.{patch}")
}

/// Why a mission did not reach its goal.
#[derive(Debug, thiserror::Error)]
pub enum MissionError {
    /// The link failed.
    #[error(transparent)]
    Link(#[from] LinkError),
    /// The robot refused the plan, or the rest of it.
    #[error("the robot refused the plan: {}", describe(.0))]
    Refused(PlanRefusal),
    /// The robot stopped by itself.
    #[error("the robot stopped by itself: {}", .0.explanation())]
    Fault(Fault),
    /// The robot was told to stop.
    #[error("the robot was told to stop and has stopped")]
    Stopped,
    /// The rest of the plan was cancelled.
    #[error("the plan was cancelled; it ended after {legs} legs")]
    Cancelled {
        /// The legs driven.
        legs: u16,
    },
    /// The plan has more legs than can be numbered.
    #[error("the plan has {legs} legs; a plan may have {most}")]
    TooManyLegs {
        /// The plan's.
        legs: usize,
        /// As many as there are numbers.
        most: u16,
    },
}

fn describe(refusal: &PlanRefusal) -> String {
    match refusal {
        PlanRefusal::NotAtRest => "it is still moving".into(),
        PlanRefusal::NotCleared => "it was stopped and not cleared".into(),
        PlanRefusal::NotOwner => "another link drives it".into(),
        PlanRefusal::WrongProtocol => "its firmware speaks another protocol".into(),
        PlanRefusal::Incomplete => "not all legs arrived as announced".into(),
        PlanRefusal::TooManyLegs { room } => format!("it has room for {room} legs"),
        PlanRefusal::Empty => "it has no legs".into(),
        PlanRefusal::Start => "its start pose is not finite or beyond 100 m".into(),
        PlanRefusal::OtherPlan => "it has another plan, or none".into(),
        PlanRefusal::OutOfPlace { begun, end } => {
            format!("it has legs up to {end}, and those before {} have begun", begun + 1)
        }
        PlanRefusal::Leg { index, refusal } => {
            format!("leg {}: {}", index + 1, describe_leg(refusal))
        }
    }
}

fn describe_leg(refusal: &Refusal) -> String {
    match refusal {
        Refusal::NotSane => "a number is not finite or beyond 100 m".into(),
        Refusal::TooLong => "an interval would take longer than 300 s".into(),
        Refusal::TooShort(Infeasible { shortest }) => format!(
            "its time is too short for the wheels; it needs --leg-time {:.2} or more",
            shortest.0
        ),
    }
}
