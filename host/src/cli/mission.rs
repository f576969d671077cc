//! Drives a plan on an endpoint, to the end or to rest.

use super::endpoint::Endpoint;
use super::error::{CliError, Exit};
use super::output::Output;
use super::resume::Memory;
use super::run::{Driven, Run, RunClock, count_of_legs};
use protocol::message::{RobotHello, State, Telemetry};
use protocol::motion::{self, Leg, Limits, WheelSpeeds};
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Duration;
use wmr::geometry::Pose;
use wmr::link::mission::{Mission, MissionError, MissionEvent};
use wmr::link::{LinkClient, PATIENCE};

/// How often the link is looked at.
pub(crate) const POLL: Duration = Duration::from_millis(2);
/// After Ctrl-C the robot is given this long to come to rest.
const STOP_PATIENCE: Duration = Duration::from_secs(3);

/// A cable that came loose may be out for so long.
const CABLE_PATIENCE: Duration = Duration::from_secs(30);

static INTERRUPTED: AtomicBool = AtomicBool::new(false);

/// From now on Ctrl-C asks for a stop instead of ending the program.
pub(crate) fn catch_interrupts() {
    // A second call finds the handler in place.
    let _ = ctrlc::set_handler(|| INTERRUPTED.store(true, Ordering::Relaxed));
}

/// Whether Ctrl-C was pressed.
pub(crate) fn interrupted() -> bool {
    INTERRUPTED.load(Ordering::Relaxed)
}

/// Whether a mission goes on where it was cut short.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Resume {
    /// It begins at its start, and is forgotten when it ends.
    Never,
    /// It begins at its start; if it is cut short, its rest can be driven later.
    Offered,
    /// It is the rest of one that was cut short.
    Wanted,
}

/// Drives on `endpoint` the legs that `legs` makes for the robot's limits, beginning at `start`.
pub(crate) fn drive(
    endpoint: Box<dyn Endpoint>,
    start: Pose,
    legs: impl Fn(&Limits) -> Vec<Leg>,
    resume: Resume,
    output: Output,
) -> Result<Driven, CliError> {
    catch_interrupts();
    let nonce = endpoint.nonce();
    let mut client = LinkClient::new(endpoint, nonce);
    let robot = connect(&mut client)?;
    let limits = robot.limits;
    let legs = legs(&limits);
    output.say(&format!("robot: {}; {}", describe_robot(&robot), count_of_legs(legs.len())));
    let mut run = Run::new(legs.clone(), limits, start);
    if run.legs.is_empty() {
        run.truth = client.port_mut().truth();
        return Ok(Driven { run, error: None });
    }
    let memory =
        if resume == Resume::Never { Memory::none() } else { Memory::of(&mut client, &legs) };
    let mut mission = if resume == Resume::Wanted {
        client.check_protocol()?;
        hear(&mut client)?;
        let (mission, first) = memory.take_up(&client, legs, output)?;
        run.first = first;
        mission
    } else {
        let wire_start = motion::Pose::new(
            start.position.x as f32,
            start.position.y as f32,
            start.heading as f32,
        );
        Mission::new(legs, wire_start)
    };
    let result = follow(&mut client, &mut mission, &mut run, &memory, output);
    let begun = mission.has_begun();
    if begun && result.is_err() {
        memory.note(mission.progress(), output);
    }
    let known = begun || resume == Resume::Wanted;
    let error = result
        .err()
        .map(|error| if known { memory.offer(error, mission.progress()) } else { error });
    if error.is_none() {
        memory.forget();
    }
    run.truth = client.port_mut().truth();
    run.link = client.statistics();
    Ok(Driven { run, error })
}

/// Steps the mission to its end.
fn follow(
    client: &mut LinkClient<Box<dyn Endpoint>>,
    mission: &mut Mission,
    run: &mut Run,
    memory: &Memory,
    output: Output,
) -> Result<(), CliError> {
    let progress = output.progress(run.legs.len() as u64);
    progress.set_position(run.first.into());
    let (mut clock, mut cable) = (RunClock::default(), Cable::default());
    let mut stop_by = None;
    loop {
        let now = client.port_mut().now();
        if interrupted() {
            client.stop();
            if now > *stop_by.get_or_insert(now + STOP_PATIENCE) {
                return Err(interrupted_error(
                    "the robot did not say that it rests; it stops by itself after 0.3 s of silence",
                ));
            }
        }
        let is_open = client.port_mut().is_open();
        client.set_patience(cable.patience(is_open, now, output));
        let events = mission.step(client, now).map_err(|error| match error {
            MissionError::Stopped if interrupted() => {
                interrupted_error("the robot has stopped and rests")
            }
            error => error.into(),
        })?;
        for event in events {
            match event {
                MissionEvent::LegDone(_) => {
                    progress.inc(1);
                    memory.note(mission.progress(), output);
                }
                MissionEvent::Accepted { .. } => memory.note(mission.progress(), output),
                MissionEvent::Telemetry(_) => cable.heard(),
                MissionEvent::Connected(_) | MissionEvent::Done(_) => {}
            }
            if run.note(event, &mut clock) {
                progress.finish_and_clear();
                return Ok(());
            }
        }
        client.port_mut().wait(POLL).map_err(wmr::link::LinkError::from)?;
    }
}

/// A cable that may come loose on the way.
#[derive(Debug, Default)]
struct Cable {
    loose_since: Option<Duration>,
    loose_for: Duration,
}

impl Cable {
    /// How long the robot may be silent: longer by the time that the port has not been there.
    fn patience(&mut self, is_open: bool, now: Duration, output: Output) -> Duration {
        match (is_open, self.loose_since) {
            (false, None) => {
                self.loose_since = Some(now);
                output.say(&format!(
                    "the port is gone, so the robot stops and waits; plug it in again within {} s and it goes on",
                    CABLE_PATIENCE.as_secs()
                ));
            }
            (true, Some(_)) => {
                self.loose_since = None;
                output.say("the port is back");
            }
            _ => {}
        }
        if let Some(since) = self.loose_since {
            self.loose_for = now.saturating_sub(since).min(CABLE_PATIENCE);
        }
        PATIENCE + self.loose_for
    }

    /// The robot is heard.
    fn heard(&mut self) {
        self.loose_for = Duration::ZERO;
    }
}

/// Polls until the robot has said where it is; if it rolls on after a restart, where it comes to rest.
fn hear(client: &mut LinkClient<Box<dyn Endpoint>>) -> Result<(), CliError> {
    let rolls = |telemetry: &Telemetry| {
        telemetry.state == State::Idle && telemetry.wheels != WheelSpeeds::default()
    };
    while client.telemetry().is_none_or(rolls) {
        let now = client.port_mut().now();
        client.poll(now)?;
        client.port_mut().wait(POLL).map_err(wmr::link::LinkError::from)?;
    }
    Ok(())
}

/// Says hello until the robot answers; who it is.
pub(crate) fn connect(client: &mut LinkClient<Box<dyn Endpoint>>) -> Result<RobotHello, CliError> {
    loop {
        let now = client.port_mut().now();
        client.poll(now)?;
        if let Some(robot) = client.robot() {
            return Ok(*robot);
        }
        if interrupted() {
            return Err(interrupted_error("nothing has moved"));
        }
        client.port_mut().wait(POLL).map_err(wmr::link::LinkError::from)?;
    }
}

pub(crate) fn interrupted_error(message: &str) -> CliError {
    CliError::new(Exit::Interrupted, "interrupted", message, "drive again when ready")
}

/// A pose, for people.
pub(crate) fn place(pose: Pose) -> String {
    format!("({:.3}, {:.3}) m, {:.1}°", pose.position.x, pose.position.y, pose.heading.to_degrees())
}

/// A robot, for people.
pub(crate) fn describe_robot(robot: &RobotHello) -> String {
    let ([major, minor, patch], limits) = (robot.firmware, robot.limits);
    format!(
        "{:?}, firmware {major}.{minor}.{patch}, up to {} m/s and {} m/s²",
        robot.board, limits.speed.0, limits.acceleration.0
    )
}
