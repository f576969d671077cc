//! What the two ends say to each other: [`Command`] to the robot, [`Report`] from it.
//!
//! | message | lane | why |
//! |---|---|---|
//! | `Hello`, `Heartbeat`, `Stop`, `EmergencyStop`, `Telemetry` | unreliable | the next one replaces it; a stop is repeated until the robot echoes it |
//! | all others | reliable | each arrives once, in order |
//!
//! Legs travel in batches: `PlanBegin`, the legs, `PlanCommit`. A batch counts as a whole or not at
//! all: the number of legs and their digest must be those announced. The first batch of a plan
//! starts it, later ones go on behind it or take the place of legs not yet begun.
//!
//! The frame's header and the messages marked *frozen* never change, so that ends of different
//! versions can still greet, report, stop and update each other; everything else is covered by
//! [`SCHEMA_HASH`](crate::schema::SCHEMA_HASH), and the robot moves only where that is the same.

use crate::motion::{Leg, Limits, Pose};
use crate::parameters::{ParameterRefusal, Parameters};
pub use crate::plan::{Driven, LegResult, Placement, PlanHeader, PlanRefusal, plan_digest};
pub use crate::telemetry::Telemetry;
use serde::{Deserialize, Serialize};

/// The version of the rules; both ends must have the same for the robot to move.
pub const PROTOCOL_VERSION: u16 = 4;

/// The most legs that the robot keeps: those not yet driven, and those whose end is not yet reported.
pub const MAX_LEGS: usize = 32;

/// The host may be silent for this long while the robot drives.
pub const SILENCE_LIMIT_MILLISECONDS: u32 = 300;

/// While the robot drives, each end sends a frame at least this often.
pub const HEARTBEAT_MILLISECONDS: u32 = 20;

/// What the host asks of the robot.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub enum Command {
    /// Opens a session; answered by [`Report::Hello`]. *Frozen.*
    Hello(HostHello),
    /// Says nothing but that the host lives. *Frozen.*
    Heartbeat,
    /// Stops on the path within the limits, forgets the plan, and refuses others until
    /// [`Clear`](Self::Clear); obeyed in any session. *Frozen.*
    Stop {
        /// The host's stops in this session, this one included; wraps around.
        number: u8,
    },
    /// Restarts the board if it rests, and is passed over if it does not. *Frozen.*
    Reboot(Reboot),
    /// Announces a batch of legs; what was collected of an earlier one is forgotten.
    PlanBegin(PlanHeader),
    /// The next leg of the announced batch.
    PlanLeg(Leg),
    /// Takes over the announced batch, if it is complete.
    PlanCommit {
        /// The plan announced.
        plan: u32,
    },
    /// Forgets the legs not yet begun; the one under way is driven to its end.
    PlanCancel {
        /// The plan being driven.
        plan: u32,
    },
    /// Stops on the path within the limits and waits for [`Resume`](Self::Resume).
    Pause,
    /// Goes on after a pause.
    Resume,
    /// Ends the effect of a stop or fault, unless a newer stop has overtaken this.
    Clear {
        /// The number of the last stop that the host sent in this session, 0 for none.
        stop: u8,
    },
    /// Cuts the drive at once, wherever the robot is, and faults until [`Clear`](Self::Clear); obeyed
    /// in any session.
    EmergencyStop {
        /// As for [`Stop`](Self::Stop), with which it is counted.
        number: u8,
    },
    /// Says where a camera saw the robot; refused with [`Report::PoseRefused`] where it cannot be right.
    SetPose(CameraPose),
    /// Asks for the robot's numbers; answered by [`Report::Parameters`].
    GetParameters,
    /// Gives the robot other numbers, until it restarts; answered by [`Report::Parameters`].
    SetParameters(Parameters),
    /// Keeps the robot's numbers in flash; answered by [`Report::ParametersSaved`].
    SaveParameters,
    /// Asks which robot it is and whether it knows where it stands; answered by [`Report::Identity`].
    Identify,
    /// Turns one wheel forward by a quarter turn at most, without any control loop, to find out how it is
    /// wired; a robot that is idle at rest answers with [`Report::WheelTurned`], any other not at all.
    TurnWheel {
        /// Which.
        wheel: Wheel,
    },
    /// Asks what the robot measures; answered by [`Report::Measured`], to any link.
    Measure,
}

/// One of the two wheels.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum Wheel {
    /// On the left of a robot that looks away from you.
    Left,
    /// On the right.
    Right,
}

/// What the robot measures, besides what [`Telemetry`] says.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Measurement {
    /// What the encoders of the left and the right wheel have counted since the start; may wrap around.
    pub counts: [i32; 2],
    /// In how many control ticks both channels of the left and of the right input changed at once, so that
    /// a count was lost; may wrap around.
    pub skipped: [u16; 2],
    /// The battery's filtered voltage, volts; `None` where it is not measured.
    pub battery: Option<f32>,
}

/// Which robot it is, and what it knows of itself.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct Identity {
    /// The number of its chip, which no other has; 0 if the board has none.
    pub chip: u64,
    /// Whether it was told since its start where it stands, so that its pose is one in the arena.
    pub placed: bool,
}

/// Where the robot was when a camera looked.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct CameraPose {
    /// The robot's clock at the exposure, as in [`Telemetry::ticks`].
    pub ticks: u32,
    /// The pose seen.
    pub pose: Pose,
}

/// How the host introduces itself.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct HostHello {
    /// The host's [`PROTOCOL_VERSION`].
    pub version: u16,
    /// The host's [`SCHEMA_HASH`](crate::schema::SCHEMA_HASH).
    pub schema: u64,
    /// Drawn for each connection.
    pub nonce: u32,
}

/// Into what a board restarts.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum Reboot {
    /// The same firmware.
    Application,
    /// The boot loader that takes a new firmware.
    Bootloader,
}

/// What the robot reports to the host.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub enum Report {
    /// Answers a hello, and any frame of a session that the robot does not know. *Frozen.*
    Hello(RobotHello),
    /// Acknowledges. *Frozen.*
    Heartbeat {
        /// The number of the last stop that arrived in this session, 0 for none.
        stop: u8,
    },
    /// Where the robot is and what it does. *Frozen.*
    Telemetry(Telemetry),
    /// The batch is complete and its legs are the plan's.
    PlanAccepted {
        /// The plan committed.
        plan: u32,
        /// The index after its last leg.
        end: u16,
    },
    /// The batch, or a leg of it, is refused; the plan is as before.
    PlanRefused {
        /// The plan announced.
        plan: u32,
        /// Why.
        reason: PlanRefusal,
    },
    /// A leg has ended.
    LegDone(LegResult),
    /// All legs of the plan that arrived so far have ended and the robot rests.
    PlanDone {
        /// The plan driven.
        plan: u32,
        /// The index after the last leg driven.
        end: u16,
        /// Where the robot believes it stands.
        pose: Pose,
    },
    /// A stop or fault has ended the plan before its last leg, and the robot has forgotten it.
    PlanStopped {
        /// The plan driven.
        plan: u32,
        /// The first leg that has not ended.
        next: u16,
        /// Stopped, or faulted and why.
        state: State,
        /// Where the robot believes it stands.
        pose: Pose,
        /// The wheel that a fault is about, if it is about one.
        wheel: Option<Wheel>,
    },
    /// A camera's pose is of no use; the robot's own estimate stays.
    PoseRefused {
        /// The exposure that was named.
        ticks: u32,
        /// Why.
        reason: PoseRefusal,
    },
    /// The battery has reached another level.
    Battery(BatteryReport),
    /// The numbers with which the robot now drives.
    Parameters(Parameters),
    /// Parameters were not taken or not kept; nothing has changed.
    ParametersRefused(ParameterRefusal),
    /// The numbers will be the same after a restart.
    ParametersSaved {
        /// How many times parameters have been saved.
        sequence: u32,
    },
    /// Which robot it is.
    Identity(Identity),
    /// A wheel was to turn; its motor rests again.
    WheelTurned {
        /// By how many counts each encoder has gone on meanwhile, left and right.
        counts: [i32; 2],
    },
    /// What the robot measures.
    Measured(Measurement),
}

/// Why a camera's pose is not taken.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum PoseRefusal {
    /// A number is not finite, or out of range.
    NotSane,
    /// The exposure is older than the poses that the robot remembers, 1 s, or than its plan.
    TooOld,
    /// The exposure has not happened yet.
    InFuture,
    /// It lies further from the robot's own estimate at the exposure than the wheels can have led odometry
    /// astray since the last accepted pose, camera errors allowed for.
    Implausible,
}

/// The battery's voltage and what it means.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct BatteryReport {
    /// What it means.
    pub level: BatteryLevel,
    /// The filtered voltage, volts.
    pub volts: f32,
}

/// What the battery's voltage means, from good to bad.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
pub enum BatteryLevel {
    /// Nothing.
    #[default]
    Good,
    /// It should soon be charged.
    Low,
    /// The robot drives more slowly.
    Weak,
    /// The robot stops on its path.
    Empty,
}

/// How the robot introduces itself.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct RobotHello {
    /// The robot's [`PROTOCOL_VERSION`].
    pub version: u16,
    /// The robot's [`SCHEMA_HASH`](crate::schema::SCHEMA_HASH).
    pub schema: u64,
    /// The nonce of the host that is answered; 0 if none said hello since the robot started.
    pub host_nonce: u32,
    /// Drawn each time the robot starts.
    pub nonce: u32,
    /// What it runs on.
    pub board: Board,
    /// The firmware's version: major, minor, patch.
    pub firmware: [u8; 3],
    /// The first eight hexadecimal digits of the commit that the firmware was built from; 0 if unknown.
    pub git: u32,
    /// What its wheels may do.
    pub limits: Limits,
    /// The most legs that it keeps.
    pub max_legs: u16,
    /// The plan that it drives or drove last; `None` after a start or stop.
    pub driven: Option<Driven>,
    /// Why it started.
    pub reset: ResetCause,
}

/// What a robot runs on.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum Board {
    /// A Raspberry Pi Pico (RP2040).
    Pico,
    /// A Raspberry Pi Pico 2 (RP2350).
    Pico2,
    /// The firmware's logic inside the simulator.
    Simulated,
}

/// Why a robot started.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub enum ResetCause {
    /// Power came on, or its reset pin was pulled.
    #[default]
    PowerOn,
    /// The host asked for it.
    Command,
    /// Its control tick or its link task stood still.
    Watchdog,
    /// Its program found itself in a state that cannot be.
    Panic,
    /// Its processor met an instruction or address that cannot be.
    HardFault,
}

impl ResetCause {
    /// In words, after "it has restarted: ".
    pub fn explanation(self) -> &'static str {
        match self {
            Self::PowerOn => "its power came on, or its reset pin was pulled",
            Self::Command => "the host asked for it",
            Self::Watchdog => "its program stood still (watchdog)",
            Self::Panic => "its program failed (panic)",
            Self::HardFault => "its processor failed (hard fault)",
        }
    }
}

/// What the robot does.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum State {
    /// At rest, ready for a plan.
    Idle,
    /// On a leg.
    Driving,
    /// On a leg, held or slowing down, until the host says to go on.
    Paused(PauseReason),
    /// Stopped or stopping by command; needs [`Command::Clear`].
    Stopped,
    /// Stopped by the robot itself; needs [`Command::Clear`].
    Faulted(Fault),
}

/// Why a robot holds on its path.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum PauseReason {
    /// The host asked for it.
    Command,
    /// The host was silent for longer than [`SILENCE_LIMIT_MILLISECONDS`].
    Silence,
}

/// What a robot stops for by itself.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum Fault {
    /// A wheel is driven and does not turn.
    Stall,
    /// The wheels turn, but the robot does not get on.
    NoProgress,
    /// An encoder says what its motor cannot have done.
    Encoder,
    /// The battery is empty.
    Battery,
    /// The control loop was late, so nobody watched the wheels.
    TickOverrun,
    /// The host asked for it by [`Command::EmergencyStop`].
    EmergencyStop,
    /// A camera sees it where its wheels cannot have brought it.
    Displaced,
}

impl Fault {
    /// What has happened, as the end of "the robot stopped by itself: ...".
    pub fn explanation(self) -> &'static str {
        match self {
            Self::Stall => "a wheel is driven and does not turn",
            Self::NoProgress => "the wheels turn, but the robot does not get on",
            Self::Encoder => "an encoder counts what its motor cannot have done",
            Self::Battery => "the battery is empty",
            Self::TickOverrun => "the control loop was late",
            Self::EmergencyStop => "the host asked for an emergency stop",
            Self::Displaced => "the camera sees it where its wheels cannot have brought it",
        }
    }
}
