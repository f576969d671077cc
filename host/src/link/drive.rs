//! The drive loop: a mission stepped to its end on a port with a clock.
//!
//! [`Mission`] says what to send, [`LinkClient`] sends it, and [`drive`] steps both until the robot has
//! arrived: it passes on a stop that is asked for, and waits longer for a robot whose port is gone.
//! [`wait_for`] is the same loop for anything else that a robot answers. Time is the port's own, so a
//! simulated port runs as fast as it can. Seconds as [`Duration`]s.

use super::mission::{Mission, MissionEvent, has_stopped};
use super::{LinkClient, LinkError, MissionError, RECEIVE_TIMEOUT};
use protocol::message::{Command, Telemetry};
use protocol::motion::Pose;
use std::io::{self, Read, Write};
use std::time::Duration;

/// Time between two steps of a loop.
pub const POLL_INTERVAL: Duration = Duration::from_millis(2);
/// After a stop is asked for, the robot is given this long to come to rest.
pub const STOP_TIMEOUT: Duration = Duration::from_secs(3);
/// A port that is gone is waited for this long.
pub const REPLUG_TIMEOUT: Duration = Duration::from_secs(30);

/// A port with the clock that goes with it.
pub trait TimedPort: Read + Write {
    /// Time since it was opened.
    fn now(&self) -> Duration;

    /// Lets some time pass.
    ///
    /// # Errors
    /// Those of the port.
    fn wait(&mut self, duration: Duration) -> io::Result<()>;

    /// Whether the port is there; if it is not, it may come back.
    fn is_open(&self) -> bool {
        true
    }
}

impl<P: TimedPort + ?Sized> TimedPort for Box<P> {
    fn now(&self) -> Duration {
        (**self).now()
    }

    fn wait(&mut self, duration: Duration) -> io::Result<()> {
        (**self).wait(duration)
    }

    fn is_open(&self) -> bool {
        (**self).is_open()
    }
}

/// What happens on a drive.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum DriveEvent {
    /// The mission has come further.
    Mission(MissionEvent),
    /// The port is gone; the robot stops by itself, and goes on if the port is back in time.
    PortLost,
    /// The port is back.
    PortBack,
}

/// Why a drive ended before the goal.
#[derive(Debug, thiserror::Error, miette::Diagnostic)]
pub enum DriveError {
    /// The mission has failed.
    #[error(transparent)]
    #[diagnostic(transparent)]
    Mission(#[from] MissionError),
    /// A stop was asked for, and the robot rests.
    #[error("the robot has stopped and rests")]
    #[diagnostic(help("drive again when ready"))]
    Stopped,
    /// A stop was asked for, and the robot did not confirm it within [`STOP_TIMEOUT`].
    #[error("the robot did not say that it rests; it stops by itself after 0.3 s of silence")]
    #[diagnostic(help(
        "look whether it stands; if it does not, pull its cable or switch off its battery"
    ))]
    StopUnconfirmed,
}

/// Steps `mission` to its end; where the robot then believes it stands. `stop_asked` is read at each
/// step; `on_event` also gets the mission as it was after the step that brought the event.
///
/// # Errors
/// [`DriveError`]; [`Mission::progress`] says how far it came.
pub fn drive<P: TimedPort>(
    client: &mut LinkClient<P>,
    mission: &mut Mission,
    stop_asked: impl Fn() -> bool,
    on_event: impl FnMut(DriveEvent, &Mission),
) -> Result<Pose, DriveError> {
    let wish = || if stop_asked() { Wish::Stop } else { Wish::Drive };
    drive_as_wished(client, mission, wish, on_event)
}

/// What a person at the robot wants of it while it drives.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Wish {
    /// To drive on.
    Drive,
    /// To hold on its path until the wish is another.
    Pause,
    /// To end the mission at rest.
    Stop,
}

/// [`drive`], with a pause as well; `wish` is read at each step.
///
/// # Errors
/// [`DriveError`]; [`Mission::progress`] says how far it came.
pub fn drive_as_wished<P: TimedPort>(
    client: &mut LinkClient<P>,
    mission: &mut Mission,
    wish: impl Fn() -> Wish,
    mut on_event: impl FnMut(DriveEvent, &Mission),
) -> Result<Pose, DriveError> {
    let mut driver = Driver::default();
    loop {
        let arrived = driver.step(client, mission, &wish, &mut on_event)?;
        if let Some(pose) = arrived {
            return Ok(pose);
        }
        client
            .port_mut()
            .wait(POLL_INTERVAL)
            .map_err(|error| MissionError::from(LinkError::from(error)))?;
    }
}

/// The steps of a drive, for a loop that does something else between them.
#[derive(Debug, Default)]
pub struct Driver {
    replug: Replug,
    stop_by: Option<Duration>,
}

impl Driver {
    /// One step of `mission` at the port's time; the robot's pose once it has arrived. Between two steps
    /// lies a wait of [`POLL_INTERVAL`].
    ///
    /// # Errors
    /// [`DriveError`]; [`Mission::progress`] says how far it came.
    pub fn step<P: TimedPort>(
        &mut self,
        client: &mut LinkClient<P>,
        mission: &mut Mission,
        wish: &impl Fn() -> Wish,
        on_event: &mut impl FnMut(DriveEvent, &Mission),
    ) -> Result<Option<Pose>, DriveError> {
        let now = client.port_mut().now();
        let wished = wish();
        // Before the robot has the plan there is nothing that it could pause.
        if mission.has_begun() && wished == Wish::Pause && !client.pause_wanted() {
            client.send(Command::Pause);
        }
        if wished == Wish::Drive && client.pause_wanted() {
            client.send(Command::Resume);
        }
        if wished == Wish::Stop {
            client.stop();
            if now > *self.stop_by.get_or_insert(now + STOP_TIMEOUT) {
                return Err(DriveError::StopUnconfirmed);
            }
        }
        if let Some(event) = self.replug.on_port(client.port_mut().is_open(), now) {
            on_event(event, mission);
        }
        client.set_patience(RECEIVE_TIMEOUT + self.replug.lost_for);
        let events = mission.step(client, now).map_err(|error| match error {
            MissionError::Stopped if wish() == Wish::Stop => DriveError::Stopped,
            error => error.into(),
        })?;
        for event in events {
            if matches!(event, MissionEvent::Telemetry(_)) {
                self.replug.lost_for = Duration::ZERO;
            }
            on_event(DriveEvent::Mission(event), mission);
            if let MissionEvent::Done(pose) = event {
                return Ok(Some(pose));
            }
        }
        Ok(None)
    }
}

/// Stops the robot; what it says of itself once it rests. `cancelled` ends the wait for that.
///
/// # Errors
/// [`DriveError::StopUnconfirmed`] if it does not say so within [`STOP_TIMEOUT`].
pub fn stop<P: TimedPort>(
    client: &mut LinkClient<P>,
    cancelled: impl Fn() -> bool,
) -> Result<Telemetry, DriveError> {
    client.stop();
    let give_up = client.port_mut().now() + STOP_TIMEOUT;
    let rests = wait_for(client, cancelled, |client, now| {
        client.poll(now)?;
        let (_, heard) = client.last_stop();
        match client.telemetry().filter(|last| heard && has_stopped(last)) {
            Some(telemetry) => Ok(Some(*telemetry)),
            None if now > give_up => Err(DriveError::StopUnconfirmed),
            None => Ok(None),
        }
    })?;
    rests.ok_or(DriveError::StopUnconfirmed)
}

/// Steps until `step` has a result; `None` if `cancelled` says so first. `step` gets the port's time.
///
/// # Errors
/// Those of `step` and of the port.
pub fn wait_for<P: TimedPort, T, E: From<LinkError>>(
    client: &mut LinkClient<P>,
    cancelled: impl Fn() -> bool,
    mut step: impl FnMut(&mut LinkClient<P>, Duration) -> Result<Option<T>, E>,
) -> Result<Option<T>, E> {
    loop {
        let now = client.port_mut().now();
        if let Some(result) = step(client, now)? {
            return Ok(Some(result));
        }
        if cancelled() {
            return Ok(None);
        }
        client.port_mut().wait(POLL_INTERVAL).map_err(LinkError::from)?;
    }
}

impl From<LinkError> for DriveError {
    fn from(error: LinkError) -> Self {
        MissionError::from(error).into()
    }
}

/// How long a port has been gone.
#[derive(Debug, Default)]
struct Replug {
    lost_since: Option<Duration>,
    /// Added to the receive timeout until the robot is received again.
    lost_for: Duration,
}

impl Replug {
    fn on_port(&mut self, is_open: bool, now: Duration) -> Option<DriveEvent> {
        let event = match (is_open, self.lost_since) {
            (false, None) => {
                self.lost_since = Some(now);
                Some(DriveEvent::PortLost)
            }
            (true, Some(_)) => {
                self.lost_since = None;
                Some(DriveEvent::PortBack)
            }
            _ => None,
        };
        if let Some(since) = self.lost_since {
            self.lost_for = now.saturating_sub(since).min(REPLUG_TIMEOUT);
        }
        event
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_lost_port_is_waited_for_as_long_as_it_is_gone() {
        let mut replug = Replug::default();
        let at = Duration::from_secs;
        assert_eq!(replug.on_port(true, at(1)), None);
        assert_eq!(replug.on_port(false, at(2)), Some(DriveEvent::PortLost));
        assert_eq!(replug.on_port(false, at(7)), None);
        assert_eq!(replug.lost_for, at(5));
        assert_eq!(replug.on_port(true, at(8)), Some(DriveEvent::PortBack));
        assert_eq!(replug.lost_for, at(5), "until the robot is received again");
        replug.on_port(false, at(10));
        replug.on_port(false, at(100));
        assert_eq!(replug.lost_for, REPLUG_TIMEOUT);
    }
}

#[cfg(all(test, feature = "simulation"))]
mod on_a_simulated_robot;
