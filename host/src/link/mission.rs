//! One plan from upload to arrival, as a state machine over a [`LinkClient`].
//!
//! Hello, then the plan's header, its legs and the commit; from then on the robot drives by itself
//! and the host only listens and stays alive.

use super::{LinkClient, LinkError};
use protocol::message::{
    Command, Fault, LegResult, PauseReason, PlanHeader, PlanRefusal, Report, RobotHello, State,
    Telemetry, plan_digest,
};
use protocol::motion::{Leg, Pose};
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
    /// The mission has ended where the robot believes it stands.
    Done(Pose),
}

/// Why a mission did not reach its goal.
#[derive(Debug, thiserror::Error)]
pub enum MissionError {
    /// The link failed.
    #[error(transparent)]
    Link(#[from] LinkError),
    /// The robot refused the plan; nothing moved.
    #[error("the robot refused the plan: {}", describe(.0))]
    Refused(PlanRefusal),
    /// The robot stopped by itself.
    #[error("the robot stopped by itself: {}", match .0 { Fault::Stall => "a wheel is driven and does not turn" })]
    Fault(Fault),
    /// The robot was told to stop.
    #[error("the robot was told to stop and has stopped")]
    Stopped,
    /// The plan has more legs than the robot takes.
    #[error("the plan has {legs} legs; this robot takes {most}")]
    TooManyLegs {
        /// The plan's.
        legs: usize,
        /// The robot's.
        most: u16,
    },
}

/// One plan on its way to a robot and then to its goal.
#[derive(Clone, Debug)]
pub struct Mission {
    legs: Vec<Leg>,
    start: Pose,
    upload: Option<VecDeque<Command>>,
    accepted: bool,
    resumed: bool,
    ticks: Option<u32>,
}

impl Mission {
    /// The mission that drives `legs`, which begin at `start`.
    pub fn new(legs: Vec<Leg>, start: Pose) -> Self {
        Self { legs, start, upload: None, accepted: false, resumed: false, ticks: None }
    }

    /// One step at `now`: polls `client` and says what has happened since the last.
    ///
    /// # Errors
    /// [`MissionError`]; the mission has then ended.
    pub fn step<P: Read + Write>(
        &mut self,
        client: &mut LinkClient<P>,
        now: Duration,
    ) -> Result<Vec<MissionEvent>, MissionError> {
        let reports = client.poll(now)?;
        let mut events = Vec::new();
        self.upload(client, &mut events)?;
        for report in reports {
            events.extend(self.hear(report, client)?);
        }
        if let Some(telemetry) =
            client.telemetry().filter(|telemetry| Some(telemetry.ticks) != self.ticks)
        {
            let telemetry = *telemetry;
            self.ticks = Some(telemetry.ticks);
            events.push(MissionEvent::Telemetry(telemetry));
            self.check(&telemetry)?;
            self.go_on(&telemetry, client);
        }
        Ok(events)
    }

    fn upload<P: Read + Write>(
        &mut self,
        client: &mut LinkClient<P>,
        events: &mut Vec<MissionEvent>,
    ) -> Result<(), MissionError> {
        let Some(robot) = client.robot().copied() else { return Ok(()) };
        if self.upload.is_none() {
            events.push(MissionEvent::Connected(robot));
            if self.legs.len() > usize::from(robot.max_legs) {
                return Err(MissionError::TooManyLegs {
                    legs: self.legs.len(),
                    most: robot.max_legs,
                });
            }
        }
        let (legs, start) = (&self.legs, self.start);
        let commands = self.upload.get_or_insert_with(|| plan_commands(legs, start));
        while let Some(command) = commands.front() {
            if !client.send(*command) {
                break;
            }
            commands.pop_front();
        }
        Ok(())
    }

    fn hear<P: Read + Write>(
        &mut self,
        report: Report,
        client: &LinkClient<P>,
    ) -> Result<Option<MissionEvent>, MissionError> {
        let plan = self.legs.first().map_or(0, |leg| leg.plan);
        match report {
            Report::PlanRefused { reason, .. } => Err(MissionError::Refused(reason)),
            Report::PlanAccepted { plan: accepted } if accepted == plan => {
                self.accepted = true;
                let ticks = client.telemetry().map_or(0, |telemetry| telemetry.ticks);
                Ok(Some(MissionEvent::Accepted { ticks }))
            }
            Report::LegDone(result) if result.plan == plan => {
                Ok(Some(MissionEvent::LegDone(result)))
            }
            Report::PlanDone { plan: done, pose } if done == plan => {
                Ok(Some(MissionEvent::Done(pose)))
            }
            _ => Ok(None),
        }
    }

    /// A robot that paused because this host was silent, or its words were lost, goes on now that
    /// they hear each other again.
    fn go_on<P: Read + Write>(&mut self, telemetry: &Telemetry, client: &mut LinkClient<P>) {
        let waits = self.accepted && telemetry.state == State::Paused(PauseReason::Silence);
        if !waits {
            self.resumed = false;
        } else if !self.resumed {
            self.resumed = client.send(Command::Resume);
        }
    }

    fn check(&self, telemetry: &Telemetry) -> Result<(), MissionError> {
        match telemetry.state {
            State::Faulted(fault) if self.accepted => Err(MissionError::Fault(fault)),
            // Not before the wheels rest: a stop takes as long as the limits need.
            State::Stopped if self.accepted && at_rest(telemetry) => Err(MissionError::Stopped),
            _ => Ok(()),
        }
    }
}

fn at_rest(telemetry: &Telemetry) -> bool {
    telemetry.wheels.left.0 == 0.0 && telemetry.wheels.right.0 == 0.0
}

fn plan_commands(legs: &[Leg], start: Pose) -> VecDeque<Command> {
    let plan = legs.first().map_or(0, |leg| leg.plan);
    let header = PlanHeader { plan, count: legs.len() as u16, digest: plan_digest(legs), start };
    // Whoever starts a mission means to drive: an earlier stop no longer holds.
    let mut commands = VecDeque::from([Command::Clear, Command::PlanBegin(header)]);
    commands.extend(legs.iter().map(|leg| Command::PlanLeg(*leg)));
    commands.push_back(Command::PlanCommit { plan });
    commands
}

fn describe(refusal: &PlanRefusal) -> String {
    use protocol::motion::{Infeasible, Refusal};
    match refusal {
        PlanRefusal::NotAtRest => "it is still moving".into(),
        PlanRefusal::NotCleared => "it was stopped and not cleared".into(),
        PlanRefusal::NotOwner => "another link drives it".into(),
        PlanRefusal::Incomplete => "not all legs arrived as announced".into(),
        PlanRefusal::TooManyLegs => "it has too many legs".into(),
        PlanRefusal::Empty => "it has no legs".into(),
        PlanRefusal::Start => "its start pose is not finite or beyond 100 m".into(),
        PlanRefusal::Leg { index, refusal } => {
            let reason = match refusal {
                Refusal::NotSane => "a number is not finite or beyond 100 m".into(),
                Refusal::TooLong => "an interval would take longer than 300 s".into(),
                Refusal::TooShort(Infeasible { shortest }) => {
                    format!(
                        "its time is too short for the wheels; it needs --leg-time {:.2} or more",
                        shortest.0
                    )
                }
            };
            format!("leg {}: {reason}", index + 1)
        }
    }
}
