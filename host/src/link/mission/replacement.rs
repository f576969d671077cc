//! Other legs in the place of those not yet begun, while the robot drives.
//!
//! The leg under way ends at rest, and there the new ones begin. The robot takes a batch over as a whole or not
//! at all: where it has begun the next leg meanwhile it says so, and the mission goes on with the legs it had.

use super::{Mission, batch};
use protocol::message::Placement;
use protocol::motion::Leg;

/// What was to be driven before.
#[derive(Clone, Debug)]
pub(super) struct Replaced {
    legs: Vec<Leg>,
    announced: usize,
}

impl Mission {
    /// All legs, those already driven included.
    pub fn legs(&self) -> &[Leg] {
        &self.legs
    }

    /// Whether other legs are on their way to the robot.
    pub fn is_replacing(&self) -> bool {
        self.replaced.is_some()
    }

    /// Puts `legs`, which begin where the leg under way ends, in the place of all that follow it. Ends with
    /// [`Replaced`](super::MissionEvent::Replaced) or [`NotReplaced`](super::MissionEvent::NotReplaced).
    ///
    /// False, and nothing happens, if there are no legs, or no leg is under way, or the robot still has to answer
    /// to what was sent before.
    pub fn replace(&mut self, legs: &[Leg]) -> bool {
        let first = usize::from(self.progress.next) + 1;
        let waits = self.replaced.is_some() || !self.commands.is_empty();
        let under_way = self.accepted.is_some() && first <= self.announced && !self.done;
        let fits = u16::try_from(first + legs.len()).is_ok();
        if waits || !under_way || !fits || legs.is_empty() {
            return false;
        }
        self.replaced = Some(Replaced { legs: self.legs.clone(), announced: self.announced });
        let plan = self.plan;
        let named = legs.iter().zip(first as u16..).map(|(leg, index)| Leg { plan, index, ..*leg });
        self.legs.truncate(first);
        self.legs.extend(named);
        // The leg under way takes one place in the robot's queue.
        let end = self.legs.len().min(first + self.max_legs.saturating_sub(1).max(1));
        self.commands = batch(plan, first as u16, &self.legs[first..end], Placement::Replace);
        self.announced = end;
        true
    }

    /// Goes back to the legs that the robot has, if it was to take others; false if it was not.
    pub(super) fn restore(&mut self) -> bool {
        let Some(Replaced { legs, announced }) = self.replaced.take() else { return false };
        (self.legs, self.announced) = (legs, announced);
        if self.is_behind_all_legs() {
            self.arrival.end_plan(self.progress.pose);
        }
        true
    }
}
