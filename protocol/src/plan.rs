//! What is said about a plan: its batches of legs, why they are refused, how far they are driven.
//!
//! The messages that carry these are in [`message`](crate::message).

use crate::frame::CASTAGNOLI;
use crate::motion::{Leg, Pose, Refusal};
use serde::{Deserialize, Serialize};

/// What a batch of legs consists of.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct PlanHeader {
    /// The plan's identity; legs of another are refused.
    pub plan: u32,
    /// The index of the first leg that follows.
    pub first: u16,
    /// How many legs follow.
    pub count: u16,
    /// [`plan_digest`] of the legs.
    pub digest: u32,
    /// Where they go.
    pub placement: Placement,
}

/// Where a batch of legs goes.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub enum Placement {
    /// It starts a plan, or a plan again from leg `first`; the robot must be at rest and stands here.
    Start(Pose),
    /// Behind the legs of the same plan that the robot has; `first` must be the next index.
    Append,
    /// In place of the legs of the same plan from `first` on, none of which may have begun.
    Replace,
}

impl Placement {
    /// Whether the batch starts a plan rather than going on with one.
    pub fn is_start(self) -> bool {
        matches!(self, Self::Start(_))
    }
}

/// How far a plan has been driven.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Driven {
    /// The plan.
    pub plan: u32,
    /// The first leg that has not ended.
    pub next: u16,
    /// The index after the last leg that the robot has.
    pub end: u16,
}

/// Why a batch of legs is refused.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub enum PlanRefusal {
    /// The robot still moves, or a plan is still running.
    NotAtRest,
    /// A stop or a fault has not been cleared.
    NotCleared,
    /// Another link's host drives.
    NotOwner,
    /// Host and robot do not speak the same protocol.
    WrongProtocol,
    /// Fewer or other legs arrived than were announced.
    Incomplete,
    /// More legs than fit.
    TooManyLegs {
        /// How many would fit now.
        room: u16,
    },
    /// No legs at all.
    Empty,
    /// The start pose makes no sense.
    Start,
    /// The plan to go on with is not the one that the robot has.
    OtherPlan,
    /// The legs do not fit to those that the robot has: some have begun, or there is a gap.
    OutOfPlace {
        /// The first leg that has not begun.
        begun: u16,
        /// The index after the last leg that the robot has.
        end: u16,
    },
    /// A leg begins beside the end of the one before, or beside the start: further than
    /// [`LARGEST_GAP`](crate::motion::LARGEST_GAP).
    Apart {
        /// Its place in the plan.
        index: u16,
        /// How far, metres.
        gap: f32,
    },
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
/// assert_eq!(wmr_protocol::message::plan_digest(&[]), 0);
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
