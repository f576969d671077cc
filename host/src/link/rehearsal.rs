//! A mission that is disturbed at a chosen moment, to its end, whatever that is.
//!
//! ```text
//! idle ─► first turn ─► drive ─► last turn ─► end        at one of them: disturb
//!                         └─► pause or stop, disturb, a second later go on
//! ```
//! What disturbs is the caller's: this only knows the mission and finds the moment, by what the robot says
//! of itself. Time is the port's own.

use super::drive::{POLL_INTERVAL, TimedPort};
use super::mission::{Mission, MissionEvent, has_stopped};
use super::{LinkClient, LinkError, MissionError};
use crate::geometry::Point;
use crate::legs::{LegOptions, from_wire, to_legs};
use protocol::message::{CameraPose, Command, State, Telemetry};
use protocol::motion::{Limits, Pose, TICK_MILLISECONDS, Timing};
use std::time::Duration;

/// When a mission is disturbed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Moment {
    /// Before anybody talks to the robot.
    Idle,
    /// In the first turn on the spot.
    FirstTurn,
    /// On the straight.
    Drive,
    /// In the turn at the goal.
    LastTurn,
    /// While it is held on its way; it goes on after [`HELD`].
    Paused,
    /// After a stop on its way; it is sent on after [`HELD`].
    Stopped,
}

/// A robot that is held, or has not begun, is left alone for so long after the disturbance.
pub const HELD: Duration = Duration::from_secs(1);
/// A stage of the mission counts when it was seen for so long.
const SEEN: Duration = Duration::from_millis(150);
/// No rehearsal takes longer.
const LONGEST: Duration = Duration::from_secs(120);
/// A camera looks so often.
const FRAME: Duration = Duration::from_millis(200);

/// Who disturbs, and who watches.
pub trait Director<P> {
    /// Disturbs; called once.
    ///
    /// # Errors
    /// Those of the port.
    fn disturb(&mut self, port: &mut P) -> std::io::Result<()>;

    /// Where a camera saw the robot in the newest picture that has come, and when that was exposed, by the
    /// port's clock; `None` if none has come, or none shows it.
    fn look(&mut self, _port: &mut P) -> Option<(Duration, Pose)> {
        None
    }
}

/// What is to be driven.
#[derive(Clone, Debug, PartialEq)]
pub struct Task {
    /// Where the robot stands.
    pub start: Pose,
    /// The points that it drives to.
    pub way: Vec<Point>,
    /// How it should look at the end, rad.
    pub goal_heading: Option<f64>,
    /// The limits of its wheels.
    pub limits: Limits,
}

/// How a rehearsal ended.
#[derive(Debug)]
pub enum Ending {
    /// The robot says that it has arrived here.
    Arrived(Pose),
    /// It has not, and says why.
    Failed(MissionError),
    /// Nobody knows after two minutes.
    Endless,
}

/// What is seen of a robot after its mission has ended.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sight {
    /// How far from its goal it really stands, m.
    pub position_error: f64,
    /// How far it looks past it, rad.
    pub heading_error: f64,
    /// Whether it has touched anything.
    pub collided: bool,
    /// Whether it moves, though it should rest.
    pub moves: bool,
}

/// A robot farther from its goal has missed it, m.
const REACHED_POSITION: f64 = 0.01;
/// Or looking so far past it, rad.
const REACHED_HEADING: f64 = 0.05;

impl Ending {
    /// What the end is called once somebody has looked: an arrival is `reached`, `missed` or `collided`,
    /// and whatever else was said, a robot that does not rest is `moving`.
    pub fn verdict(&self, sight: &Sight) -> &'static str {
        let arrived = matches!(self, Self::Arrived(_));
        let away =
            sight.position_error > REACHED_POSITION || sight.heading_error.abs() > REACHED_HEADING;
        match (arrived, sight) {
            (_, Sight { moves: true, .. }) => "moving",
            (false, _) => self.code(),
            (true, Sight { collided: true, .. }) => "collided",
            (true, _) if away => "missed",
            (true, _) => "reached",
        }
    }

    /// What a program calls the end; a fault has its own name.
    pub fn code(&self) -> &'static str {
        use protocol::message::Fault;
        match self {
            Self::Arrived(_) => "arrived",
            Self::Endless => "endless",
            Self::Failed(MissionError::Fault { fault, .. }) => match fault {
                Fault::Stall => "robot.stall",
                Fault::NoProgress => "robot.no_progress",
                Fault::Encoder => "robot.encoder",
                Fault::Battery => "robot.battery",
                Fault::TickOverrun => "robot.tick_overrun",
                Fault::EmergencyStop => "robot.emergency_stop",
                Fault::Displaced => "robot.displaced",
            },
            Self::Failed(error) => failure(error),
        }
    }
}

fn failure(error: &MissionError) -> &'static str {
    match error {
        MissionError::Link(error) => match error {
            LinkError::Port(_) | LinkError::Lost(_) => "link.lost",
            LinkError::NoResponse(_) => "link.silent",
            LinkError::NotARobot { .. } => "link.not_a_robot",
            LinkError::NoAck(_) => "link.deaf",
            LinkError::Version { .. } => "link.version",
            LinkError::NoAnswer(_) | LinkError::NoTelemetry(_) => "link.no_answer",
            LinkError::ClockStopped(_) => "link.clock_stopped",
            LinkError::Restarted(_) => "link.restarted",
        },
        MissionError::Fault { .. } => "robot.fault",
        MissionError::Refused(_) | MissionError::TooManyLegs { .. } => "robot.refused",
        MissionError::BatteryEmpty { .. } => "robot.battery",
        MissionError::Stopped => "robot.stopped",
        MissionError::NotDriving { .. } | MissionError::NeverRests(_) => "robot.not_driving",
        MissionError::Late { .. } => "robot.late",
        MissionError::Disagrees { .. } | MissionError::Impossible(_) => "robot.contradiction",
        MissionError::Unfit(_) => "robot.unfit",
        MissionError::Cancelled { .. } => "robot.cancelled",
    }
}

/// Runs `task` on the robot behind `port` and lets `director` disturb it at `moment`; gives the port back.
pub fn rehearse<P: TimedPort>(
    port: P,
    task: &Task,
    moment: Moment,
    director: &mut impl Director<P>,
) -> (P, Ending) {
    let mut rehearsal = Rehearsal::new(LinkClient::new(port, 1), director);
    let mut result = rehearsal.run(task, moment);
    let stopped = matches!(result, Err(MissionError::Stopped));
    if stopped && moment == Moment::Stopped && rehearsal.disturbed.is_none() {
        let stands = rehearsal.client.telemetry().map_or(task.start, |last| last.pose);
        result = rehearsal.disturb().and_then(|()| rehearsal.wait(HELD)).map(|()| None);
        if result.is_ok() {
            rehearsal = rehearsal.with_another_program();
            result = rehearsal.drive(task, stands, moment);
        }
    }
    let ending = match result {
        Ok(Some(pose)) => Ending::Arrived(pose),
        Ok(None) => Ending::Endless,
        Err(error) => Ending::Failed(error),
    };
    (rehearsal.client.into_port(), ending)
}

struct Rehearsal<'a, P, D> {
    client: LinkClient<P>,
    director: &'a mut D,
    looked: Duration,
    disturbed: Option<Duration>,
    /// Whether the robot has been on the straight.
    drove: bool,
    /// Since when the moment is seen.
    since: Option<Duration>,
}

impl<'a, P: TimedPort, D: Director<P>> Rehearsal<'a, P, D> {
    fn new(client: LinkClient<P>, director: &'a mut D) -> Self {
        Self {
            client,
            director,
            looked: Duration::ZERO,
            disturbed: None,
            drove: false,
            since: None,
        }
    }

    /// The robot that was stopped is sent on by a program that has not talked to it yet.
    fn with_another_program(self) -> Self {
        let client = LinkClient::new(self.client.into_port(), 2);
        Self { client, ..self }
    }

    fn run(&mut self, task: &Task, moment: Moment) -> Result<Option<Pose>, MissionError> {
        if moment == Moment::Idle {
            self.wait(HELD)?;
            self.disturb()?;
            self.wait(HELD)?;
        }
        self.drive(task, task.start, moment)
    }

    fn drive(
        &mut self,
        task: &Task,
        start: Pose,
        moment: Moment,
    ) -> Result<Option<Pose>, MissionError> {
        let stands = from_wire(start);
        let mut way = vec![stands.position];
        way.extend(&task.way);
        let options = LegOptions { timing: Timing::Limits, reverse: false };
        let legs = to_legs(&way, stands.heading, task.goal_heading, &options, &task.limits);
        let last = legs.last().map_or(0, |leg| leg.index);
        let mut mission = Mission::new(legs, start);
        while self.client.port_mut().now() < LONGEST {
            let now = self.client.port_mut().now();
            self.look(now);
            for event in mission.step(&mut self.client, now)? {
                match event {
                    MissionEvent::Done(pose) => return Ok(Some(pose)),
                    MissionEvent::Telemetry(telemetry) => {
                        self.attend(&telemetry, last, moment, now)?;
                    }
                    _ => {}
                }
            }
            self.wait(POLL_INTERVAL)?;
        }
        Ok(None)
    }

    /// Does what is due at this word of the robot.
    fn attend(
        &mut self,
        telemetry: &Telemetry,
        last: u16,
        moment: Moment,
        now: Duration,
    ) -> Result<(), MissionError> {
        if let Some(disturbed) = self.disturbed {
            if moment == Moment::Paused && now > disturbed + HELD && self.client.pause_wanted() {
                self.client.send(Command::Resume);
            }
            return Ok(());
        }
        if !self.is_at(telemetry, last, moment, now) {
            return Ok(());
        }
        match moment {
            Moment::Idle => {}
            Moment::FirstTurn | Moment::Drive | Moment::LastTurn => self.disturb()?,
            Moment::Paused if self.client.pause_wanted() => {
                if matches!(telemetry.state, State::Paused(_)) && rests(telemetry) {
                    self.disturb()?;
                }
            }
            Moment::Paused => {
                self.client.send(Command::Pause);
            }
            Moment::Stopped => {
                if !has_stopped(telemetry) {
                    self.client.stop();
                }
            }
        }
        Ok(())
    }

    /// Whether the robot has been at the moment for long enough.
    fn is_at(&mut self, telemetry: &Telemetry, last: u16, moment: Moment, now: Duration) -> bool {
        let wheels = telemetry.wheels;
        let driving = telemetry.state == State::Driving;
        let turns = driving && wheels.left.0 * wheels.right.0 < 0.0;
        let drives = driving && wheels.left.0.min(wheels.right.0) > 1.0;
        self.drove |= drives && telemetry.leg == last;
        let is = match moment {
            Moment::Idle => false,
            Moment::FirstTurn => turns && !self.drove,
            Moment::LastTurn => turns && self.drove,
            Moment::Drive => drives,
            // A robot that was told to hold stays at its moment.
            Moment::Paused | Moment::Stopped => drives || self.since.is_some(),
        };
        if !is {
            self.since = None;
            return false;
        }
        now - *self.since.get_or_insert(now) >= SEEN
    }

    fn disturb(&mut self) -> Result<(), MissionError> {
        self.disturbed = Some(self.client.port_mut().now());
        let disturbed = self.director.disturb(self.client.port_mut());
        disturbed.map_err(|error| LinkError::from(error).into())
    }

    /// Tells the robot where a camera has seen it.
    fn look(&mut self, now: Duration) {
        if now < self.looked + FRAME {
            return;
        }
        self.looked = now;
        let Some(telemetry) = self.client.telemetry().copied() else { return };
        let Some(said) = self.client.clock().host_time(telemetry.ticks) else { return };
        let Some((exposed, pose)) = self.director.look(self.client.port_mut()) else { return };
        let ticks = |from: Duration, to: Duration| {
            to.saturating_sub(from).as_millis() as u32 / TICK_MILLISECONDS
        };
        let ticks =
            telemetry.ticks.wrapping_add(ticks(said, exposed)).wrapping_sub(ticks(exposed, said));
        self.client.send(Command::SetPose(CameraPose { ticks, pose }));
    }

    fn wait(&mut self, duration: Duration) -> Result<(), MissionError> {
        self.client.port_mut().wait(duration).map_err(|error| LinkError::from(error).into())
    }
}

fn rests(telemetry: &Telemetry) -> bool {
    telemetry.wheels.left.0 == 0.0 && telemetry.wheels.right.0 == 0.0
}
