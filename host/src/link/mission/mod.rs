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

mod phases;
mod replacement;
mod reports;

pub use super::MissionError;
pub use phases::batch;

use super::LinkClient;
use super::arrival::Arrival;
use super::watch::{Awaited, Watch, braking_ticks};
use protocol::message::{
    BatteryReport, Command, Fault, LegResult, PlanRefusal, PoseRefusal, RobotHello, State,
    Telemetry, Wheel,
};
use protocol::motion::{Leg, Limits, Pose};
use replacement::Replaced;
use std::collections::VecDeque;
use std::io::{Read, Write};
use std::time::Duration;

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
    /// The robot has taken other legs in the place of those not yet begun.
    Replaced {
        /// The index after the last of them that it has by now.
        end: u16,
    },
    /// The robot has not taken them, and drives the legs that it had.
    NotReplaced(PlanRefusal),
    /// The robot has not taken where a camera saw it.
    PoseRefused(PoseRefusal),
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
    /// The leg that the robot was last seen on: the word that the one before has ended may be lost.
    seen_on: u16,
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
    /// What the legs that are under way to the robot take the place of.
    replaced: Option<Replaced>,
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
            seen_on: 0,
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
            replaced: None,
            done: false,
        }
    }

    /// How far the mission has come.
    pub fn progress(&self) -> Progress {
        Progress { next: self.progress.next.max(self.seen_on), ..self.progress }
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
                self.see_leg(telemetry);
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
}

/// Whether a stop or fault is over and can be cleared.
pub(super) fn has_stopped(telemetry: &Telemetry) -> bool {
    matches!(telemetry.state, State::Stopped | State::Faulted(_))
        && telemetry.wheels.left.0 == 0.0
        && telemetry.wheels.right.0 == 0.0
}
