//! What the two ends say to each other: [`Command`] to the robot, [`Report`] from it.
//!
//! | message | lane | why |
//! |---|---|---|
//! | `Hello`, `Heartbeat`, `Stop`, `Telemetry` | unreliable | the next one replaces it; a stop is repeated until its effect is seen |
//! | all others | reliable | each arrives once, in order |
//!
//! A plan is committed as a whole: `PlanBegin`, its legs, `PlanCommit`. Nothing moves before the
//! commit, and nothing at all if the count or the digest differ.

use crate::frame::CASTAGNOLI;
use crate::motion::{Leg, Limits, Pose, Refusal, WheelSpeeds};
use serde::{Deserialize, Serialize};

/// The version of messages and rules; both ends must have the same for the robot to move.
pub const PROTOCOL_VERSION: u16 = 1;

/// The most legs that one plan may have.
pub const MAX_LEGS: usize = 64;

/// The host may be silent for this long while the robot drives.
pub const SILENCE_LIMIT_MILLISECONDS: u32 = 300;

/// While the robot drives, each end sends a frame at least this often.
pub const HEARTBEAT_MILLISECONDS: u32 = 20;

/// What the host asks of the robot.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub enum Command {
    /// Opens a session; answered by [`Report::Hello`].
    Hello(HostHello),
    /// Says nothing but that the host lives.
    Heartbeat,
    /// Announces a plan; what was collected of an earlier one is forgotten.
    PlanBegin(PlanHeader),
    /// The next leg of the announced plan.
    PlanLeg(Leg),
    /// Drives the announced plan, if it is complete and the robot at rest.
    PlanCommit {
        /// The plan announced.
        plan: u32,
    },
    /// Stops on the path within the limits and waits for [`Resume`](Self::Resume).
    Pause,
    /// Goes on after a pause.
    Resume,
    /// Stops on the path within the limits, forgets the plan, and refuses others until [`Clear`](Self::Clear).
    Stop,
    /// Ends the effect of a stop or fault.
    Clear,
    /// Restarts the board, if at rest.
    Reboot(Reboot),
}

/// How the host introduces itself.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct HostHello {
    /// The host's [`PROTOCOL_VERSION`].
    pub version: u16,
    /// Drawn anew for each connection.
    pub nonce: u32,
}

/// What a plan consists of.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct PlanHeader {
    /// Its identity; legs of another are refused.
    pub plan: u32,
    /// How many legs follow.
    pub count: u16,
    /// [`plan_digest`] of the legs.
    pub digest: u32,
    /// Where the robot stands.
    pub start: Pose,
}

/// Into what a board restarts.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum Reboot {
    /// The same firmware.
    Application,
    /// The boot loader that takes a new firmware.
    Bootloader,
}

/// What the robot tells the host.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub enum Report {
    /// Answers a hello, and any frame of a session that the robot does not know.
    Hello(RobotHello),
    /// Where the robot is and what it does.
    Telemetry(Telemetry),
    /// The plan is complete and now drives.
    PlanAccepted {
        /// The plan committed.
        plan: u32,
    },
    /// The plan, or a leg of it, is refused; nothing moves.
    PlanRefused {
        /// The plan announced.
        plan: u32,
        /// Why.
        reason: PlanRefusal,
    },
    /// A leg has ended.
    LegDone(LegResult),
    /// The whole plan has ended and the robot rests.
    PlanDone {
        /// The plan driven.
        plan: u32,
        /// Where the robot believes it stands.
        pose: Pose,
    },
}

/// How the robot introduces itself.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct RobotHello {
    /// The robot's [`PROTOCOL_VERSION`].
    pub version: u16,
    /// The nonce of the host that is answered; 0 if none said hello since the robot started.
    pub host_nonce: u32,
    /// Drawn anew each time the robot starts.
    pub nonce: u32,
    /// What it runs on.
    pub board: Board,
    /// The firmware's version: major, minor, patch.
    pub firmware: [u8; 3],
    /// What its wheels may do.
    pub limits: Limits,
    /// The most legs of a plan.
    pub max_legs: u16,
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

/// Where the robot is and what it does, several times a second.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Telemetry {
    /// Control ticks since the robot started.
    pub ticks: u32,
    /// Where it believes it stands.
    pub pose: Pose,
    /// How fast its wheels turn, measured.
    pub wheels: WheelSpeeds,
    /// What it does.
    pub state: State,
    /// The leg that it drives, or drove last.
    pub leg: u16,
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
    /// A wheel is driven hard and does not turn.
    Stall,
}

/// Why a plan is refused.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub enum PlanRefusal {
    /// The robot still moves, or a plan is still running.
    NotAtRest,
    /// A stop or a fault has not been cleared.
    NotCleared,
    /// Another link's host drives.
    NotOwner,
    /// Fewer or other legs arrived than were announced.
    Incomplete,
    /// More legs than fit.
    TooManyLegs,
    /// No legs at all.
    Empty,
    /// The start pose makes no sense.
    Start,
    /// One leg cannot be driven.
    Leg {
        /// Its place in the plan.
        index: u16,
        /// Why.
        refusal: Refusal,
    },
}

/// How a leg ended.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct LegResult {
    /// The plan that it belongs to.
    pub plan: u32,
    /// Its place in the plan.
    pub index: u16,
    /// How long it took, control ticks.
    pub ticks: u32,
    /// Where the robot believes it stands.
    pub pose: Pose,
}

/// What both ends compute over a plan's legs in order, to know that they mean the same plan.
///
/// ```
/// assert_eq!(protocol::message::plan_digest(&[]), 0);
/// ```
pub fn plan_digest(legs: &[Leg]) -> u32 {
    let mut digest = CASTAGNOLI.digest();
    for leg in legs {
        let mut bytes = [0; LEG_SIZE];
        // LEG_SIZE covers every leg, so nothing is ever cut off.
        if let Ok(bytes) = postcard::to_slice(leg, &mut bytes) {
            digest.update(bytes);
        }
    }
    digest.finalize()
}

/// An upper bound of an encoded leg: varints of at most 5 and 3 bytes, six f32, three tags, one tick count.
const LEG_SIZE: usize = 5 + 3 + 6 * 4 + 3 + 5;
