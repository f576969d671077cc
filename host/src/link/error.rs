//! Why a link cannot be used, and why a mission did not reach its goal: what happened, with its values,
//! and what to do.

use protocol::message::{Fault, PauseReason, PlanRefusal, ResetCause, State, Wheel};
use protocol::motion::{Infeasible, Pose, Refusal};
use std::io;
use std::time::Duration;

/// Why the link cannot be used.
#[derive(Debug, thiserror::Error, miette::Diagnostic)]
pub enum LinkError {
    /// The port failed.
    #[error("the port failed: {0}")]
    #[diagnostic(help("check the cable, then drive again"))]
    Port(#[from] io::Error),
    /// Nothing answered hello.
    #[error("no robot answered within {0:?}")]
    #[diagnostic(help("is it the right port, and does a robot with wmr firmware listen there?"))]
    NoResponse(Duration),
    /// Something answered, but not in this protocol.
    #[error("{bytes} bytes arrived within {within:?}, but no frame of a robot of ours")]
    #[diagnostic(help(
        "another device or another firmware answers there (wmr ports lists what is there), or a radio or adapter on the way is not set to 115200 baud"
    ))]
    NotARobot {
        /// Bytes that arrived.
        bytes: u64,
        /// How long was waited.
        within: Duration,
    },
    /// The robot fell silent.
    #[error("nothing heard from the robot for {0:?}; it stops by itself after 0.3 s of silence")]
    #[diagnostic(help("check the cable, then drive again"))]
    Lost(Duration),
    /// The robot is heard, but does not hear.
    #[error("the robot is heard, but took no notice of this program for {0:?}")]
    #[diagnostic(help(
        "check the wire from this computer to the robot (its RX pin), then drive again"
    ))]
    NoAck(Duration),
    /// The robot speaks another version of the protocol, so it may report and stop, but not drive.
    #[error(
        "the robot's firmware {} speaks protocol {} ({:016x}), this program {} ({:016x}); it does not drive",
        dotted(.firmware), .robot.0, .robot.1, .host.0, .host.1
    )]
    #[diagnostic(help(
        "flash the firmware that belongs to this program: wmr flash target/firmware/pico.uf2"
    ))]
    Version {
        /// The firmware's version.
        firmware: [u8; 3],
        /// The robot's version and schema hash.
        robot: (u16, u64),
        /// This program's.
        host: (u16, u64),
    },
    /// The robot acknowledges, and does not answer.
    #[error("the robot is heard and hears, but gave no answer for {0:?}")]
    #[diagnostic(help(
        "unplug the robot and plug it in again; if that does not help, flash its firmware again"
    ))]
    NoAnswer(Duration),
    /// The robot is heard, but does not say where it is and what it does.
    #[error("the robot is heard, but said nothing of itself for {0:?}")]
    #[diagnostic(help(
        "unplug the robot and plug it in again; if that does not help, flash its firmware again"
    ))]
    NoTelemetry(Duration),
    /// The robot is heard, and says the same moment again and again.
    #[error("the robot is heard, but its clock has stood still for {0:?}")]
    #[diagnostic(help("something repeats old words; unplug the robot and plug it in again"))]
    ClockStopped(Duration),
    /// The robot restarted, so it has forgotten its plan.
    #[error("the robot has restarted: {}; it is at rest and has forgotten the plan", .0.explanation())]
    #[diagnostic(help("check its battery, put it at the start, and drive again"))]
    Restarted(ResetCause),
}

fn dotted([major, minor, patch]: &[u8; 3]) -> String {
    format!("{major}.{minor}.{patch}")
}

/// Why a mission did not reach its goal.
#[derive(Debug, thiserror::Error, miette::Diagnostic)]
pub enum MissionError {
    /// The link failed.
    #[error(transparent)]
    #[diagnostic(transparent)]
    Link(#[from] LinkError),
    /// The robot refused the plan, or the rest of it.
    #[error("the robot refused the plan: {}", describe(.0))]
    #[diagnostic(help("nothing has moved; change the plan and drive again"))]
    Refused(PlanRefusal),
    /// The robot stopped by itself.
    #[error("the robot stopped by itself: {}{}", .fault.explanation(), of_wheel(*wheel))]
    #[diagnostic(help("{}", remedy(*.fault)))]
    Fault {
        /// Why.
        fault: Fault,
        /// The wheel that the fault is about, if the robot named one.
        wheel: Option<Wheel>,
    },
    /// The robot stopped, or refuses to begin, because its battery is empty.
    #[error("the battery is empty{}", volts.map_or(String::new(), |volts| format!(" ({volts:.1} V)")))]
    #[diagnostic(help(
        "charge it or change the cells; wmr params shows battery-stop, the voltage that counts as empty"
    ))]
    BatteryEmpty {
        /// The voltage that the robot measures, if it said so.
        volts: Option<f32>,
    },
    /// The robot was told to stop.
    #[error("the robot was told to stop and has stopped")]
    #[diagnostic(help("put it at the start and drive again"))]
    Stopped,
    /// The robot says that it does not drive, though it has taken the plan and not said that it ended.
    #[error("the robot took the plan, but says that it {} for {since:?}", describe_state(.state))]
    #[diagnostic(help("look at the robot; wmr stop and then wmr drive start again"))]
    NotDriving {
        /// What it does.
        state: State,
        /// For how long.
        since: Duration,
    },
    /// A leg takes far longer than planned.
    #[error("leg {} is planned to take {planned:.1?}, and has not ended after {driven:.1?}", u32::from(*.leg) + 1)]
    #[diagnostic(help(
        "look for wheels that slip or drag and for a weak battery; drive more slowly with wmr params speed=0.2"
    ))]
    Late {
        /// The leg, counted from 0.
        leg: u16,
        /// How long it should take.
        planned: Duration,
        /// How long the robot says that it has driven it.
        driven: Duration,
    },
    /// A stop is heard, and the wheels go on turning.
    #[error("the robot has heard the stop, but its wheels do not rest after {0:?}")]
    #[diagnostic(help("look at the robot; wmr stop and then wmr drive start again"))]
    NeverRests(Duration),
    /// What the robot reports as the end is not what it says of itself afterwards.
    #[error(
        "the robot reported the plan's end, but says that it {} at ({:.3}, {:.3}) m",
        describe_state(.state), .pose.x.0, .pose.y.0
    )]
    #[diagnostic(help(
        "look where the robot really stands before you drive again; flash its firmware again if this repeats"
    ))]
    Disagrees {
        /// Where it says that it is.
        pose: Pose,
        /// What it says that it does.
        state: State,
    },
    /// The robot reports what cannot be.
    #[error("the robot reports what cannot be: {0}")]
    #[diagnostic(help(
        "look where the robot really stands before you drive again; flash its firmware again if this repeats"
    ))]
    Impossible(Impossible),
    /// What the robot says of itself in hello allows no plan.
    #[error("the robot cannot drive any plan: {0}")]
    #[diagnostic(help(
        "nothing has moved; set its numbers with wmr params, or flash its firmware again"
    ))]
    Unfit(Unfit),
    /// The rest of the plan was cancelled.
    #[error("the plan was cancelled; it ended after {legs} legs")]
    #[diagnostic(help("drive the rest with another plan"))]
    Cancelled {
        /// The legs driven.
        legs: u16,
    },
    /// The plan has more legs than can be numbered.
    #[error("the plan has {legs} legs; a plan may have {most}")]
    #[diagnostic(help("nothing has moved; change the plan and drive again"))]
    TooManyLegs {
        /// The plan's.
        legs: usize,
        /// As many as there are numbers.
        most: u16,
    },
}

/// A report that contradicts the others.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub enum Impossible {
    /// A leg out of its turn, or one that the plan does not have.
    #[error("the end of leg {}, when leg {} of {of} was to end next", u32::from(*.leg) + 1, u32::from(*.next) + 1)]
    Leg {
        /// The leg reported, counted from 0.
        leg: u16,
        /// The one whose turn it was.
        next: u16,
        /// Legs of the plan.
        of: usize,
    },
    /// The end of the plan, without the ends of its legs.
    #[error("the end of the plan after {end} legs, when {next} of {of} had ended")]
    End {
        /// Legs after which the plan has ended, as reported.
        end: u16,
        /// Legs whose end was reported.
        next: u16,
        /// Legs of the plan.
        of: usize,
    },
    /// Legs that took longer than the robot's own clock went on.
    #[error("legs that took {legs:?} within {since:?} of its own clock")]
    Time {
        /// All legs together.
        legs: Duration,
        /// Since it took the plan.
        since: Duration,
    },
}

/// What is wrong with a robot's description of itself.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub enum Unfit {
    /// It has no room for legs.
    #[error("it has room for no leg at all")]
    NoRoom,
    /// A number of its limits is none, or far from any robot's.
    #[error("its {name} is {value:?} {unit}, and must be from {least} to {most}")]
    Limit {
        /// Which.
        name: &'static str,
        /// What it says.
        value: f32,
        /// The unit.
        unit: &'static str,
        /// The least that makes sense.
        least: f32,
        /// The most.
        most: f32,
    },
}

fn remedy(fault: Fault) -> &'static str {
    match fault {
        Fault::Encoder => {
            "put it on a block and run wmr check base, which finds wires that are crossed or reversed; see that counts-per-turn is right in wmr params, and watch the counts in wmr monitor"
        }
        _ => "free the robot, put it at the start, and drive again",
    }
}

fn of_wheel(wheel: Option<Wheel>) -> &'static str {
    match wheel {
        Some(Wheel::Left) => " (the left wheel)",
        Some(Wheel::Right) => " (the right wheel)",
        None => "",
    }
}

fn describe_state(state: &State) -> &'static str {
    match state {
        State::Idle => "is idle",
        State::Driving => "drives",
        State::Paused(PauseReason::Silence) => "waits for a word from this program",
        State::Paused(PauseReason::Command) => "is held by another program",
        State::Stopped => "is stopped",
        State::Faulted(_) => "has a fault",
    }
}

/// What is wrong with a plan, in words that follow one about it.
pub(crate) fn describe(refusal: &PlanRefusal) -> String {
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
        PlanRefusal::Apart { index, gap } => {
            format!(
                "leg {} begins {gap:.2} m beside the place where the robot is by then",
                index + 1
            )
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
