//! What the robot's reports mean for a mission.

use super::{Mission, MissionEvent, Phase, Progress};
use crate::link::{Impossible, MissionError};
use protocol::message::{BatteryLevel, Fault, PlanRefusal, Report, State};

/// A robot that is not cleared after so many attempts does not come to rest.
const MOST_CLEARINGS: u32 = 10;

impl Mission {
    /// Takes a report in.
    pub(super) fn hear(&mut self, report: Report) -> Result<Option<MissionEvent>, MissionError> {
        match report {
            Report::Battery(battery) => {
                self.battery = Some(battery);
                Ok(None)
            }
            Report::PlanRefused { reason: PlanRefusal::NotCleared, .. }
                if self.battery.is_some_and(|battery| battery.level == BatteryLevel::Empty) =>
            {
                Err(self.fault(Fault::Battery, None))
            }
            Report::PlanRefused { reason: PlanRefusal::NotCleared, .. }
                if self.accepted.is_none() && self.clearings < MOST_CLEARINGS =>
            {
                // The wheels stood still for a moment, but had not come to rest.
                self.phase = Phase::Halting;
                self.refused = self.ticks;
                self.announced = usize::from(self.progress.next);
                Ok(None)
            }
            Report::PlanRefused { plan, reason } if plan == self.plan && self.restore() => {
                Ok(Some(MissionEvent::NotReplaced(reason)))
            }
            Report::PlanRefused { plan, reason } if plan == self.plan => {
                Err(MissionError::Refused(reason))
            }
            Report::PlanAccepted { plan, end } if plan == self.plan => {
                let begins = self.accepted.is_none();
                let ticks = *self.accepted.get_or_insert(self.ticks.unwrap_or(0));
                self.accepted_end = end;
                let replaced = self.replaced.take().map(|_| MissionEvent::Replaced { end });
                Ok(replaced.or(begins.then_some(MissionEvent::Accepted { ticks })))
            }
            Report::PoseRefused { reason, .. } => Ok(Some(MissionEvent::PoseRefused(reason))),
            // The robot may have driven the same plan before, for another host; what it says of that
            // is not about this mission.
            Report::LegDone(_) | Report::PlanDone { .. } | Report::PlanStopped { .. }
                if self.accepted.is_none() =>
            {
                Ok(None)
            }
            Report::LegDone(result) if result.plan == self.plan => {
                let (next, of) = (self.progress.next, self.legs.len());
                let ended =
                    self.arrival.end_leg(result.index, (next, of), result.ticks, self.knows_pose);
                if !ended.map_err(MissionError::Impossible)? {
                    return Ok(None);
                }
                self.progress = Progress { next: result.index + 1, pose: result.pose };
                Ok(Some(MissionEvent::LegDone(result)))
            }
            Report::PlanDone { plan, end, pose } if plan == self.plan => {
                let (next, of) = (self.progress.next, self.legs.len());
                let passed = self.knows_pose && end > next && usize::from(end) <= of;
                if end != next && !passed {
                    return Err(MissionError::Impossible(Impossible::End { end, next, of }));
                }
                self.progress = Progress { next: end, pose };
                if end < self.accepted_end {
                    return Err(MissionError::Cancelled { legs: end });
                }
                // The robot may have run dry while the next legs are on their way.
                if self.is_behind_all_legs() {
                    self.arrival.end_plan(pose);
                }
                Ok(None)
            }
            Report::PlanStopped { plan, next, state, pose, wheel } if plan == self.plan => {
                self.progress = Progress { next, pose };
                Err(match state {
                    State::Faulted(fault) => self.fault(fault, wheel),
                    _ => MissionError::Stopped,
                })
            }
            _ => Ok(None),
        }
    }
}
