//! Drives a plan on an endpoint, to the end or to rest.

use super::endpoint::Endpoint;
use super::error::{CliError, Exit};
use super::output::Output;
use super::params;
use super::resume::Memory;
use super::run::{Driven, Run, RunClock, count_of_legs};
use super::{ports, stop_desk};
use protocol::message::{Board, Identity, RobotHello, State, Telemetry};
use protocol::motion::{Leg, Limits, WheelSpeeds};
use protocol::parameters::Wiring;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{RecvTimeoutError, sync_channel};
use std::time::Duration;
use wmr::geometry::Pose;
use wmr::legs::{from_wire, to_wire};
use wmr::link::drive::{DriveError, DriveEvent, REPLUG_TIMEOUT, STOP_TIMEOUT, wait_for};
use wmr::link::mission::{Mission, MissionError, MissionEvent};
use wmr::link::parameters::{Answer, Exchange, ParameterError, Request};
use wmr::link::port::PortError;
use wmr::link::standing::{self, Tolerance};
use wmr::link::{self, LinkClient, LinkError, check_robot};

/// While a person types, a stop is looked for so often.
const LINE_INTERVAL: Duration = Duration::from_millis(20);

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

/// Whether whatever goes on is to end: by Ctrl-C, or because another program wants the robot stopped.
pub(crate) fn stop_wanted() -> bool {
    interrupted() || stop_desk::asked()
}

/// Does `work` with the robot behind that port; a robot that another program wants stopped is stopped then.
pub(crate) fn with_robot(
    port: &str,
    work: impl FnOnce(&mut LinkClient<Box<dyn Endpoint>>) -> Result<(), CliError>,
) -> Result<(), CliError> {
    catch_interrupts();
    let mut client = ports::open_client(port)?;
    let result = work(&mut client);
    finish(&mut client, result)
}

/// The end of `result`: if another program has asked for a stop, the robot is stopped and that program told.
pub(crate) fn finish<T>(
    client: &mut LinkClient<Box<dyn Endpoint>>,
    result: Result<T, CliError>,
) -> Result<T, CliError> {
    if !stop_desk::asked() {
        return result;
    }
    link::drive::stop(client, || false)?;
    stop_desk::confirm();
    match result {
        Err(_) if !interrupted() => Err(MissionError::Stopped.into()),
        result => result,
    }
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

/// Where a drive begins.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Beginning {
    /// By the plan.
    pub(crate) start: Pose,
    /// How far from there the robot may know itself to stand; `None` if it was carried there.
    pub(crate) tolerance: Option<Tolerance>,
}

/// Drives on `endpoint` the legs that `legs` makes for the robot's limits, beginning at `beginning`.
pub(crate) fn drive(
    endpoint: Box<dyn Endpoint>,
    beginning: Beginning,
    legs: impl Fn(&Limits) -> Vec<Leg>,
    resume: Resume,
    output: Output,
) -> Result<Driven, CliError> {
    catch_interrupts();
    let nonce = endpoint.nonce();
    let mut client = LinkClient::new(endpoint, nonce);
    let result = drive_on(&mut client, beginning, legs, resume, output);
    finish(&mut client, result)
}

fn drive_on(
    client: &mut LinkClient<Box<dyn Endpoint>>,
    beginning: Beginning,
    legs: impl Fn(&Limits) -> Vec<Leg>,
    resume: Resume,
    output: Output,
) -> Result<Driven, CliError> {
    let robot = connect(client)?;
    client.check_protocol()?;
    check_robot(&robot)?;
    let limits = robot.limits;
    let legs = legs(&limits);
    output.say(&format!("robot: {}; {}", describe_robot(&robot), count_of_legs(legs.len())));
    let mut run = Run::new(legs.clone(), limits, beginning.start);
    if run.legs.is_empty() {
        run.truth = client.port_mut().truth();
        return Ok(Driven { run, error: None });
    }
    let identity = identify(client)?;
    warn_of_wiring(client, identity, output)?;
    let memory =
        if resume == Resume::Never { Memory::none() } else { Memory::of(client, &legs, identity) };
    let mut mission = if resume == Resume::Wanted {
        client.check_protocol()?;
        wait_for_pose(client)?;
        let (mission, first) = memory.take_up(client, legs, output)?;
        run.first = first;
        mission
    } else {
        let start = begin(client, identity, beginning)?;
        Mission::new(legs, to_wire(start))
    };
    let result = follow(client, &mut mission, &mut run, &memory, output);
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

/// Which robot it is; one that does not answer is nobody known.
pub(super) fn identify(client: &mut LinkClient<Box<dyn Endpoint>>) -> Result<Identity, CliError> {
    let mut exchange = Exchange::new(Request::Identify);
    let answer = wait_for(client, stop_wanted, |client, now| match exchange.step(client, now) {
        Err(ParameterError::Link(LinkError::NoAnswer(_))) => {
            Ok(Some(Answer::Identity(Identity::default())))
        }
        result => result,
    })?;
    match answer {
        Some(Answer::Identity(identity)) => Ok(identity),
        _ => Err(interrupted_error("nothing has moved")),
    }
}

/// What the wheels' own counts cannot show is said before a board drives that nobody has checked.
pub(super) fn warn_of_wiring(
    client: &mut LinkClient<Box<dyn Endpoint>>,
    identity: Identity,
    output: Output,
) -> Result<(), CliError> {
    let rests = client.telemetry().is_some_and(|last| last.state == State::Idle);
    if identity.chip == 0 || client.port_mut().truth().is_some() || !rests {
        return Ok(());
    }
    let simulated = client.robot().is_some_and(|robot| robot.board == Board::Simulated);
    if !simulated && !params::read(client)?.wiring.has(Wiring::CHECKED) {
        output.say(
            "nobody has checked how this robot's motors and encoders are connected; if it spins or turns away, stop it and run wmr check base",
        );
    }
    Ok(())
}

/// Where the robot begins a plan: where it knows itself to stand, or else where the plan says.
///
/// # Errors
/// If that is somewhere else than where the plan begins.
fn begin(
    client: &mut LinkClient<Box<dyn Endpoint>>,
    identity: Identity,
    Beginning { start, tolerance }: Beginning,
) -> Result<Pose, CliError> {
    let Some(tolerance) = tolerance.filter(|_| identity.placed) else { return Ok(start) };
    wait_for_pose(client)?;
    let Some(telemetry) = client.telemetry() else { return Ok(start) };
    let stands = from_wire(telemetry.pose);
    standing::check(stands, start, tolerance)
        .map_err(|error| CliError::of(Exit::Robot, "robot.elsewhere", &error))?;
    // A photo is newer than what the wheels have counted; a written start is not.
    Ok(if tolerance == Tolerance::WRITTEN { stands } else { start })
}

/// Drives the mission to its end, and records how.
fn follow(
    client: &mut LinkClient<Box<dyn Endpoint>>,
    mission: &mut Mission,
    run: &mut Run,
    memory: &Memory,
    output: Output,
) -> Result<(), CliError> {
    let progress = output.progress(run.legs.len() as u64);
    progress.set_position(run.first.into());
    let mut clock = RunClock::default();
    let result = link::drive::drive(client, mission, stop_wanted, |event, mission| {
        match event {
        DriveEvent::PortLost => output.say(&format!(
            "the port is gone, so the robot stops and waits; plug it in again within {} s and it goes on",
            REPLUG_TIMEOUT.as_secs()
        )),
        DriveEvent::PortBack => output.say("the port is back"),
        DriveEvent::Mission(event) => {
            if matches!(event, MissionEvent::LegDone(_)) {
                progress.inc(1);
            }
            if matches!(event, MissionEvent::LegDone(_) | MissionEvent::Accepted { .. }) {
                memory.note(mission.progress(), output);
            }
            run.record(event, &mut clock);
        }
    }
    });
    progress.finish_and_clear();
    finish(client, result.map(|_| ()).map_err(CliError::from))
}

/// Polls until the robot has said where it is; if it rolls on after a restart, where it comes to rest.
fn wait_for_pose(client: &mut LinkClient<Box<dyn Endpoint>>) -> Result<(), CliError> {
    let rolls = |telemetry: &Telemetry| {
        telemetry.state == State::Idle && telemetry.wheels != WheelSpeeds::default()
    };
    let give_up = client.heard() + STOP_TIMEOUT;
    let rests = wait_for(client, stop_wanted, |client, now| {
        client.poll(now)?;
        if client.heard() > give_up {
            return Err(match client.telemetry() {
                Some(_) => MissionError::NeverRests(STOP_TIMEOUT),
                None => LinkError::NoTelemetry(STOP_TIMEOUT).into(),
            });
        }
        Ok(client.telemetry().filter(|telemetry| !rolls(telemetry)).copied())
    })?;
    rests.map(|_| ()).ok_or_else(|| interrupted_error("nothing has moved"))
}

/// Says hello until the robot answers; who it is.
pub(crate) fn connect(client: &mut LinkClient<Box<dyn Endpoint>>) -> Result<RobotHello, CliError> {
    let robot = wait_for(client, stop_wanted, |client, now| {
        client.poll(now)?;
        if client.port_mut().is_turned_away() {
            let name = client.port_mut().name().unwrap_or_default().to_owned();
            return Err(PortError::Busy { name }.into());
        }
        Ok::<_, CliError>(client.robot().copied())
    })?;
    robot.ok_or_else(|| interrupted_error("nothing has moved"))
}

/// A line that a person types while the robot rests; where the input ends instead, an error that says `why`
/// and what to do.
pub(crate) fn line_of_person(why: &str, help: &str) -> Result<String, CliError> {
    let (sender, lines) = sync_channel(1);
    // A read cannot be taken back: what ends the program meanwhile leaves the thread behind.
    std::thread::spawn(move || {
        let mut line = String::new();
        let read = std::io::stdin().read_line(&mut line);
        // Nobody waits for it any more.
        let _ = sender.send(matches!(read, Ok(1..)).then_some(line));
    });
    loop {
        match lines.recv_timeout(LINE_INTERVAL) {
            _ if stop_wanted() => return Err(interrupted_error("the robot rests")),
            Err(RecvTimeoutError::Timeout) => {}
            Ok(Some(line)) => return Ok(line.trim().to_owned()),
            Ok(None) | Err(RecvTimeoutError::Disconnected) => {
                return Err(CliError::usage(why, help));
            }
        }
    }
}

pub(crate) fn interrupted_error(message: &str) -> CliError {
    CliError::new(Exit::Interrupted, "interrupted", message, "drive again when ready")
}

impl From<DriveError> for CliError {
    fn from(error: DriveError) -> Self {
        match error {
            DriveError::Mission(error) => error.into(),
            DriveError::Stopped => interrupted_error(&error.to_string()),
            DriveError::StopUnconfirmed => Self::of(Exit::Link, "link.stop_unconfirmed", &error),
        }
    }
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
