//! What a mission asks of the robot next: greeting, coming to rest, clearing, and the plan's legs in
//! batches.

use super::{Mission, MissionEvent, Phase, Progress, has_stopped};
use crate::link::{LinkClient, MissionError, check_robot};
use protocol::message::{
    Command, Driven, PauseReason, Placement, PlanHeader, PlanRefusal, RobotHello, State, Telemetry,
    plan_digest,
};
use protocol::motion::Leg;
use protocol::units::Metres;
use std::collections::VecDeque;
use std::io::{Read, Write};

/// While more follow, so many legs at least go together: the header and commit of a batch cost as
/// much of the wire as two legs.
const BATCH: usize = 8;

/// Telemetry from before the robot took the plan over may arrive so late, control ticks: eight frames
/// that overtake it, 20 ms each, rounded up.
const STALE_TICKS: u32 = 40;

/// After a vain attempt the robot is given so long, control ticks: its wheels may stand already while
/// it still brings them to where they should, for 0.3 s.
const CLEARING_TICKS: u32 = 20;

/// A robot that still waits so long after it was told to go on is told again, control ticks: 0.5 s.
const RESUME_TICKS: u32 = 100;

impl Mission {
    /// Sends what is due.
    pub(super) fn advance<P: Read + Write>(
        &mut self,
        client: &mut LinkClient<P>,
        events: &mut Vec<MissionEvent>,
    ) -> Result<(), MissionError> {
        if self.phase != Phase::Greeting && self.own_stop != client.last_stop().0 {
            return self.yield_to_stop(client);
        }
        match self.phase {
            Phase::Greeting => self.greet(client, events)?,
            Phase::Halting => {
                // Idle if somebody else has cleared it already.
                let rests = |last: &&Telemetry| {
                    (has_stopped(last) || last.state == State::Idle)
                        && self.refused.is_none_or(|refused| {
                            last.ticks.wrapping_sub(refused) >= CLEARING_TICKS
                        })
                };
                if let Some(telemetry) = client.telemetry().filter(rests) {
                    self.phase = Phase::Clearing;
                    if self.knows_pose {
                        self.progress.pose = telemetry.pose;
                    }
                }
            }
            Phase::Clearing => {
                if client.clear() {
                    self.clearings += 1;
                    self.phase = Phase::Driving;
                    if self.is_behind_all_legs() {
                        events.push(MissionEvent::Done(self.progress.pose));
                    }
                }
            }
            Phase::Driving => {
                self.announce();
                self.go_on_after_silence(client);
            }
        }
        while let Some(command) = self.commands.front() {
            if !client.send(*command) {
                break;
            }
            self.commands.pop_front();
        }
        Ok(())
    }

    /// The user has asked for a stop: nothing more is sent. A plan that was not yet accepted never
    /// will be; any other ends with a report.
    fn yield_to_stop<P: Read + Write>(
        &mut self,
        client: &LinkClient<P>,
    ) -> Result<(), MissionError> {
        self.commands.clear();
        let (_, heard) = client.last_stop();
        let rests = client.telemetry().is_some_and(has_stopped);
        let no_report_follows = self.accepted.is_none() || self.arrival.awaited().is_some();
        if no_report_follows && heard && rests { Err(MissionError::Stopped) } else { Ok(()) }
    }

    fn greet<P: Read + Write>(
        &mut self,
        client: &mut LinkClient<P>,
        events: &mut Vec<MissionEvent>,
    ) -> Result<(), MissionError> {
        client.check_protocol()?;
        let (Some(robot), Some(telemetry)) = (client.robot().copied(), client.telemetry()) else {
            return Ok(());
        };
        let driven = robot.driven.filter(|driven| self.resuming && driven.plan == self.plan);
        let since = *self.greeted.get_or_insert(telemetry.ticks);
        let (state, ticks) = (telemetry.state, telemetry.ticks);
        if telemetry.state == State::Driving && driven.is_none() && !is_fresh(telemetry, since) {
            // The last mission on this link may have ended since.
            return Ok(());
        }
        events.push(MissionEvent::Connected(robot));
        check_robot(&robot)?;
        self.check_legs(&robot)?;
        self.limits = Some(robot.limits);
        self.max_legs = usize::from(robot.max_legs);
        if let Some(driven) = driven {
            self.knows_pose = true;
            self.progress = Progress { next: driven.next, pose: telemetry.pose };
            self.announced = usize::from(driven.next);
        }
        self.phase = match (state, driven) {
            (State::Idle | State::Driving | State::Paused(_), Some(driven)) => {
                self.take_up(driven, ticks);
                if matches!(state, State::Paused(_)) {
                    // To resume the mission is to end its pause, whoever asked for that.
                    self.commands.push_back(Command::Resume);
                }
                Phase::Driving
            }
            (State::Idle, None) => Phase::Clearing,
            (State::Driving, None) => return Err(MissionError::Refused(PlanRefusal::NotOwner)),
            (State::Paused(_) | State::Stopped | State::Faulted(_), _) => {
                client.stop();
                Phase::Halting
            }
        };
        self.own_stop = client.last_stop().0;
        if driven.is_some() && self.is_behind_all_legs() && state == State::Idle {
            events.push(MissionEvent::Done(self.progress.pose));
        }
        Ok(())
    }

    pub(super) fn is_behind_all_legs(&self) -> bool {
        usize::from(self.progress.next) == self.legs.len()
    }

    /// Goes on with a plan that the robot still has.
    fn take_up(&mut self, driven: Driven, ticks: u32) {
        self.announced = usize::from(driven.end);
        self.accepted_end = driven.end;
        self.accepted = Some(ticks);
    }

    /// Takes in on which leg the robot says that it is; what it said before it had the plan is about another one.
    pub(super) fn see_leg(&mut self, telemetry: &Telemetry) {
        let under_way = matches!(telemetry.state, State::Driving | State::Paused(_));
        let own = self.accepted.is_some_and(|accepted| is_fresh(telemetry, accepted));
        if under_way && own && usize::from(telemetry.leg) < self.legs.len() {
            self.seen_on = self.seen_on.max(telemetry.leg);
        }
    }

    fn check_legs(&self, robot: &RobotHello) -> Result<(), MissionError> {
        let most = u16::MAX;
        if self.legs.len() > usize::from(most) {
            return Err(MissionError::TooManyLegs { legs: self.legs.len(), most });
        }
        for pair in self.legs.windows(2) {
            if let [before, leg] = pair {
                let apart = |gap: Metres| PlanRefusal::Apart { index: leg.index, gap: gap.0 };
                leg.follows(before.goal).map_err(|gap| MissionError::Refused(apart(gap)))?;
            }
        }
        for leg in &self.legs {
            let refused = |refusal| PlanRefusal::Leg { index: leg.index, refusal };
            leg.check(&robot.limits).map_err(|refusal| MissionError::Refused(refused(refusal)))?;
        }
        Ok(())
    }

    /// Announces the next batch as soon as the robot has room for it.
    fn announce(&mut self) {
        let rest = self.legs.len().saturating_sub(self.announced);
        let kept = self.announced.saturating_sub(usize::from(self.progress.next));
        let room = self.max_legs.saturating_sub(kept);
        if !self.commands.is_empty() || rest == 0 || room < rest.min(BATCH) {
            return;
        }
        let end = self.announced + rest.min(room);
        let legs = &self.legs[self.announced..end];
        let placement = match self.accepted {
            None => Placement::Start(self.progress.pose),
            Some(_) => Placement::Append,
        };
        self.commands = batch(self.plan, self.announced as u16, legs, placement);
        self.announced = end;
    }

    /// A robot that waits because nobody was heard hears somebody now; only what the user has paused
    /// stays so. It is asked again where it fell silent a second time unseen.
    fn go_on_after_silence<P: Read + Write>(&mut self, client: &mut LinkClient<P>) {
        // Until it has said that it has the plan, there is nothing of this mission to go on with.
        let waits = client
            .telemetry()
            .filter(|last| {
                self.accepted.is_some() && last.state == State::Paused(PauseReason::Silence)
            })
            .map(|last| last.ticks);
        let Some(now) = waits else {
            self.resume_asked = None;
            return;
        };
        let due = self.resume_asked.is_none_or(|asked| now.wrapping_sub(asked) >= RESUME_TICKS);
        if due && !client.pause_wanted() && client.send(Command::Resume) {
            self.resume_asked = Some(now);
        }
    }
}

/// Whether the robot said so after the moment of `since`, when its last word may have been on its way.
fn is_fresh(telemetry: &Telemetry, since: u32) -> bool {
    telemetry.ticks.wrapping_sub(since) >= STALE_TICKS
}

/// The commands that make `legs`, the first of which is `first`, part of `plan`.
pub fn batch(plan: u32, first: u16, legs: &[Leg], placement: Placement) -> VecDeque<Command> {
    let (count, digest) = (legs.len() as u16, plan_digest(legs));
    let header = PlanHeader { plan, first, count, digest, placement };
    let mut commands = VecDeque::from([Command::PlanBegin(header)]);
    commands.extend(legs.iter().map(|leg| Command::PlanLeg(*leg)));
    commands.push_back(Command::PlanCommit { plan });
    commands
}
