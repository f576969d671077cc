//! One plan from upload to arrival, as a state machine over a [`LinkClient`].
//!
//! ```text
//! greeting ─► halting (if the robot is not idle) ─► clearing ─► driving ─► done
//!     └─────────── resuming (it still has this plan) ──────────────▲
//! ```
//! Legs go to the robot in batches, each taken over as a whole: the first starts the plan, later
//! ones go behind it while the robot drives. So a plan may be longer than the robot's queue, and its
//! queue never runs dry for want of a round trip. Which legs have ended is known at every moment, and
//! a mission that was cut short can be resumed behind them.

pub use super::MissionError;
use super::arrival::Arrival;
use super::watch::{Awaited, Watch, braking_ticks};
use super::{Impossible, LinkClient, check_robot};
use protocol::message::{
    BatteryLevel, BatteryReport, Command, Driven, Fault, LegResult, PauseReason, Placement,
    PlanHeader, PlanRefusal, Report, RobotHello, State, Telemetry, Wheel, plan_digest,
};
use protocol::motion::{Leg, Limits, Pose};
use protocol::units::Metres;
use std::collections::VecDeque;
use std::io::{Read, Write};
use std::time::Duration;

/// While more follow, so many legs at least go together: the header and commit of a batch cost as
/// much of the wire as two legs.
const BATCH: usize = 8;

/// Telemetry from before the robot took the plan over may arrive so late, control ticks: eight frames
/// that overtake it, 20 ms each, rounded up.
const STALE_TICKS: u32 = 40;

/// A robot that is not cleared after so many attempts does not come to rest.
const MOST_CLEARINGS: u32 = 10;

/// After a vain attempt the robot is given so long, control ticks: its wheels may stand already while
/// it still brings them to where they should, for 0.3 s.
const CLEARING_TICKS: u32 = 20;

/// A robot that still waits so long after it was told to go on is told again, control ticks: 0.5 s.
const RESUME_TICKS: u32 = 100;

/// What happens on the way.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum MissionEvent {
    /// A robot has answered.
    Connected(RobotHello),
    /// The robot has taken the plan and begins.
    Accepted {
        /// The robot's clock, control ticks.
        ticks: u32,
    },
    /// The robot has said where it is.
    Telemetry(Telemetry),
    /// A leg has ended.
    LegDone(LegResult),
    /// The mission has ended where the robot believes it stands.
    Done(Pose),
}

/// How far a mission has come; enough to resume it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Progress {
    /// The first leg that is not known to have ended.
    pub next: u16,
    /// Where the robot was last known to stand.
    pub pose: Pose,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Phase {
    Greeting,
    Halting,
    Clearing,
    Driving,
}

/// One plan on its way to a robot and then to its goal.
#[derive(Clone, Debug)]
pub struct Mission {
    plan: u32,
    legs: Vec<Leg>,
    progress: Progress,
    resuming: bool,
    phase: Phase,
    commands: VecDeque<Command>,
    announced: usize,
    max_legs: usize,
    greeted: Option<u32>,
    /// The robot has driven this plan, so its own word for where it stands holds.
    knows_pose: bool,
    accepted: Option<u32>,
    accepted_end: u16,
    own_stop: u8,
    clearings: u32,
    /// When the robot last refused to be cleared, control ticks of its clock.
    refused: Option<u32>,
    /// When the robot was last asked to go on after its silence, control ticks.
    resume_asked: Option<u32>,
    ticks: Option<u32>,
    limits: Option<Limits>,
    battery: Option<BatteryReport>,
    arrival: Arrival,
    watch: Watch,
    done: bool,
}

impl Mission {
    /// The mission that drives `legs`, which begin at `start`. A robot that is paused on another
    /// plan, or stopped, is brought to rest and cleared first.
    pub fn new(legs: Vec<Leg>, start: Pose) -> Self {
        Self::with(legs, Progress { next: 0, pose: start }, false)
    }

    /// The mission that drives the rest of `legs`. A robot that still has this plan goes on with it,
    /// whatever `progress` says; any other begins at `progress`.
    pub fn resume_from(legs: Vec<Leg>, progress: Progress) -> Self {
        Self::with(legs, progress, true)
    }

    fn with(legs: Vec<Leg>, progress: Progress, resuming: bool) -> Self {
        Self {
            plan: legs.first().map_or(0, |leg| leg.plan),
            announced: usize::from(progress.next),
            legs,
            progress,
            resuming,
            phase: Phase::Greeting,
            commands: VecDeque::new(),
            max_legs: 0,
            greeted: None,
            knows_pose: false,
            accepted: None,
            accepted_end: 0,
            own_stop: 0,
            clearings: 0,
            refused: None,
            resume_asked: None,
            ticks: None,
            limits: None,
            battery: None,
            arrival: Arrival::default(),
            watch: Watch::default(),
            done: false,
        }
    }

    /// How far the mission has come.
    pub fn progress(&self) -> Progress {
        self.progress
    }

    /// Whether the robot has taken the plan over, so that there is something to resume.
    pub fn has_begun(&self) -> bool {
        self.accepted.is_some()
    }

    /// One step at `now`: polls `client` and says what has happened since the last.
    ///
    /// # Errors
    /// [`MissionError`]; the mission has then ended, and [`progress`](Self::progress) says where.
    pub fn step<P: Read + Write>(
        &mut self,
        client: &mut LinkClient<P>,
        now: Duration,
    ) -> Result<Vec<MissionEvent>, MissionError> {
        let reports = client.poll(now)?;
        let mut events = Vec::new();
        self.advance(client, &mut events)?;
        for report in reports {
            events.extend(self.hear(report)?);
        }
        if let Some(telemetry) =
            client.telemetry().filter(|telemetry| Some(telemetry.ticks) != self.ticks)
        {
            self.ticks = Some(telemetry.ticks);
            // Before the plan is accepted the robot does not know where it stands: the mission does.
            if self.phase == Phase::Driving && self.accepted.is_some() {
                self.progress.pose = telemetry.pose;
            }
            events.push(MissionEvent::Telemetry(*telemetry));
            let own = self.accepted.filter(|_| !self.knows_pose);
            events.extend(self.arrival.confirm(telemetry, own)?.map(MissionEvent::Done));
        }
        self.done |= events.iter().any(|event| matches!(event, MissionEvent::Done(_)));
        self.watch_over(client)?;
        Ok(events)
    }

    /// Makes sure that a robot that talks also gets on.
    fn watch_over<P: Read + Write>(&mut self, client: &LinkClient<P>) -> Result<(), MissionError> {
        let stopping = self.phase != Phase::Greeting && self.own_stop != client.last_stop().0;
        if client.robot().is_none() || self.done || stopping {
            return Ok(());
        }
        let next = self.progress.next;
        let awaited = match (self.phase, &self.limits) {
            (Phase::Halting, Some(limits)) => Awaited::Rest { braking: braking_ticks(limits) },
            (Phase::Driving, _) if self.arrival.awaited().is_some() => Awaited::Agreement,
            (Phase::Driving, Some(limits)) if self.accepted.is_some() => {
                let leg = self.legs.get(usize::from(next));
                Awaited::Leg { next, planned: leg.map_or(0, |leg| leg.ticks(limits)) }
            }
            _ => Awaited::Answer,
        };
        let busy = !self.commands.is_empty() || client.unacknowledged() > 0;
        let flags = (busy, client.pause_wanted());
        self.watch.observe(awaited, client.telemetry(), client.heard(), flags).map_err(|error| {
            match error {
                MissionError::Fault { fault, wheel } => self.fault(fault, wheel),
                error => error,
            }
        })
    }

    /// A fault, with the voltage if it is the battery's.
    fn fault(&self, fault: Fault, wheel: Option<Wheel>) -> MissionError {
        match fault {
            Fault::Battery => {
                MissionError::BatteryEmpty { volts: self.battery.map(|battery| battery.volts) }
            }
            fault => MissionError::Fault { fault, wheel },
        }
    }

    fn advance<P: Read + Write>(
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

    fn is_behind_all_legs(&self) -> bool {
        usize::from(self.progress.next) == self.legs.len()
    }

    /// Goes on with a plan that the robot still has.
    fn take_up(&mut self, driven: Driven, ticks: u32) {
        self.announced = usize::from(driven.end);
        self.accepted_end = driven.end;
        self.accepted = Some(ticks);
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

    fn hear(&mut self, report: Report) -> Result<Option<MissionEvent>, MissionError> {
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
            Report::PlanRefused { plan, reason } if plan == self.plan => {
                Err(MissionError::Refused(reason))
            }
            Report::PlanAccepted { plan, end } if plan == self.plan => {
                let begins = self.accepted.is_none();
                let ticks = *self.accepted.get_or_insert(self.ticks.unwrap_or(0));
                self.accepted_end = end;
                Ok(begins.then_some(MissionEvent::Accepted { ticks }))
            }
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

/// Whether the robot said so after the moment of `since`, when its last word may have been on its way.
fn is_fresh(telemetry: &Telemetry, since: u32) -> bool {
    telemetry.ticks.wrapping_sub(since) >= STALE_TICKS
}

/// Whether a stop or fault is over and can be cleared.
pub(super) fn has_stopped(telemetry: &Telemetry) -> bool {
    matches!(telemetry.state, State::Stopped | State::Faulted(_))
        && telemetry.wheels.left.0 == 0.0
        && telemetry.wheels.right.0 == 0.0
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
