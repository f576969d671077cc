//! The host's end of the wire: frames to and from a robot behind any `Read + Write`.
//!
//! ```text
//! mission ─► client ═bytes═ robot
//! ```
//! [`LinkClient`] keeps the session; [`mission::Mission`] brings one plan to its end. Both are driven by
//! [`LinkClient::poll`] with the time as an argument, so they run alike on a wire and in a simulation.

mod arrival;
pub mod clock;
pub mod drive;
mod error;
mod fitness;
pub mod mission;
pub mod monitor;
pub mod parameters;
pub mod port;
pub mod rehearsal;
pub mod reopening;
pub mod resume;
pub mod standing;
mod stop;
mod usb;
mod watch;

pub(crate) use error::describe;
pub use error::{Impossible, LinkError, MissionError, Unfit};
pub use fitness::check_robot;

use clock::RobotClock;
use protocol::frame::{Decoder, Header, MAX_FRAME, encode};
use protocol::message::{
    Command, HEARTBEAT_MILLISECONDS, HostHello, PROTOCOL_VERSION, Report, RobotHello, Telemetry,
};
use protocol::schema::SCHEMA_HASH;
use protocol::session::{Session, WINDOW, session_id};
use protocol::units::Milliseconds;
use std::io::{self, ErrorKind, Read, Write};
use std::time::Duration;
use stop::{Manner, StopRequest};

/// After this long without an answer to hello, the port is taken to have no robot.
const HELLO_TIMEOUT: Duration = Duration::from_secs(2);
/// Hello is said again after this long, milliseconds.
const HELLO_INTERVAL: u32 = 50;
/// A link on which nothing arrives for this long is lost, unless the client is set to wait longer;
/// by then the robot has stopped by itself.
pub const RECEIVE_TIMEOUT: Duration = Duration::from_secs(3);
/// A robot that is heard, but does not hear, is given this much longer: on a bad wire a message may
/// have to be sent many times.
const ACK_TIMEOUT: Duration = Duration::from_secs(1);

/// A computer that was busy or asleep for longer than this between two polls was away: what is beyond
/// says nothing about the robot, whose words may still be on their way, so no timer counts it.
const LONGEST_GAP: Duration = Duration::from_millis(100);

/// Reads of one poll, 4 kB each at most: a peer that sends as fast as it is read must not keep the
/// timers, the heartbeats and the user's stop waiting. A read that finds nothing takes 1 ms.
const MOST_READS: usize = 16;

/// What became of frames on the wire.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct LinkStatistics {
    /// Frames sent and received whole.
    pub frames: u32,
    /// Messages of the reliable channel that this end sent again.
    pub retransmitted: u32,
    /// Frames that arrived damaged.
    pub lost: u32,
}

/// One end of a session with a robot behind `P`.
#[derive(Clone, Debug)]
pub struct LinkClient<P> {
    port: P,
    hello: HostHello,
    patience: Duration,
    decoder: Decoder,
    robot: Option<RobotHello>,
    session: Session<Command, Report>,
    telemetry: Option<Telemetry>,
    clock: RobotClock,
    reports: Vec<Report>,
    started: Option<Milliseconds>,
    polled: Option<Duration>,
    away: Duration,
    heard: Duration,
    sent: Option<Milliseconds>,
    stop: StopRequest,
    pause_wanted: bool,
    bytes: u64,
    received: u32,
    damaged: u32,
}

impl<P: Read + Write> LinkClient<P> {
    /// A client that will say hello with `nonce`, which must differ from connection to connection.
    pub fn new(port: P, nonce: u32) -> Self {
        Self {
            port,
            hello: HostHello { version: PROTOCOL_VERSION, schema: SCHEMA_HASH, nonce },
            patience: RECEIVE_TIMEOUT,
            decoder: Decoder::default(),
            robot: None,
            session: Session::new(0, Milliseconds(0)),
            telemetry: None,
            clock: RobotClock::default(),
            reports: Vec::new(),
            started: None,
            polled: None,
            away: Duration::ZERO,
            heard: Duration::ZERO,
            sent: None,
            stop: StopRequest::default(),
            pause_wanted: false,
            bytes: 0,
            received: 0,
            damaged: 0,
        }
    }

    /// The same, but waits `patience` for a robot that has fallen silent before it gives up: a cable
    /// may come loose and be plugged in again.
    pub fn with_patience(self, patience: Duration) -> Self {
        Self { patience, ..self }
    }

    /// From now on waits `patience` for a robot that has fallen silent.
    pub fn set_patience(&mut self, patience: Duration) {
        self.patience = patience;
    }

    /// The port, for its owner's other business with it.
    pub fn port_mut(&mut self) -> &mut P {
        &mut self.port
    }

    /// The port, given back.
    pub fn into_port(self) -> P {
        self.port
    }

    /// Who answered, once somebody has.
    pub fn robot(&self) -> Option<&RobotHello> {
        self.robot.as_ref()
    }

    /// The last that the robot said of itself.
    pub fn telemetry(&self) -> Option<&Telemetry> {
        self.telemetry.as_ref()
    }

    /// For how long, in all, the robot was there to be heard: silence does not count.
    pub fn heard(&self) -> Duration {
        self.heard
    }

    /// The robot's clock on the host's.
    pub fn clock(&self) -> &RobotClock {
        &self.clock
    }

    /// Whether the robot may be asked to drive: it speaks the same protocol.
    ///
    /// # Errors
    /// [`LinkError::Version`]; then it still reports, stops and restarts.
    pub fn check_protocol(&self) -> Result<(), LinkError> {
        let host = (self.hello.version, self.hello.schema);
        match &self.robot {
            Some(robot) if (robot.version, robot.schema) != host => Err(LinkError::Version {
                firmware: robot.firmware,
                robot: (robot.version, robot.schema),
                host,
            }),
            _ => Ok(()),
        }
    }

    /// Frames so far.
    pub fn statistics(&self) -> LinkStatistics {
        let counters = self.session.counters();
        LinkStatistics {
            frames: counters.frames + self.received,
            retransmitted: counters.retransmitted,
            lost: self.damaged,
        }
    }

    /// Puts a command on the reliable channel; false if the window is full for now, or the robot would
    /// take it for another.
    pub fn send(&mut self, command: Command) -> bool {
        let understood = self.check_protocol().is_ok() || matches!(command, Command::Reboot(_));
        let sent = self.robot.is_some() && understood && self.session.send(command).is_ok();
        if sent {
            self.pause_wanted &= !matches!(command, Command::Resume);
            self.pause_wanted |= matches!(command, Command::Pause);
            self.forget_driven(&command);
        }
        sent
    }

    /// What hello said of a plan holds until there is another.
    fn forget_driven(&mut self, command: &Command) {
        if let (Command::PlanBegin(_), Some(robot)) = (command, &mut self.robot) {
            robot.driven = None;
        }
    }

    /// How many commands of the reliable channel are not yet acknowledged.
    pub fn unacknowledged(&self) -> usize {
        WINDOW - self.session.room()
    }

    /// Whether the last of pause and resume that was sent is a pause.
    pub fn pause_wanted(&self) -> bool {
        self.pause_wanted
    }

    /// Asks the robot to stop on its path, again and again until it says that it has heard.
    pub fn stop(&mut self) {
        self.pause_wanted = false;
        self.stop.ask(Manner::OnPath);
    }

    /// Asks the robot to cut its drive at once, wherever it is, again and again until it says that it
    /// has heard.
    pub fn emergency_stop(&mut self) {
        self.stop.ask(Manner::Cut);
    }

    /// The number of the last stop, 0 for none, and whether the robot has heard of it.
    pub fn last_stop(&self) -> (u8, bool) {
        (self.stop.number(), self.stop.is_heard())
    }

    /// Asks the robot to forget the stops so far, as [`send`](Self::send) does; false also while it
    /// has not yet heard of the last.
    pub fn clear(&mut self) -> bool {
        self.stop.is_heard() && self.send(Command::Clear { stop: self.stop.number() })
    }

    /// Reads what has arrived and writes what is due at `now`; returns the reports of the reliable
    /// lane, each once and in order. To be called every few milliseconds.
    ///
    /// # Errors
    /// [`LinkError`]; the link is then of no further use.
    pub fn poll(&mut self, now: Duration) -> Result<Vec<Report>, LinkError> {
        let gap = now.saturating_sub(self.polled.replace(now).unwrap_or(now));
        self.away += gap.saturating_sub(LONGEST_GAP);
        let clock = self.milliseconds(now);
        let started = *self.started.get_or_insert(clock);
        self.receive(now)?;
        if self.robot.is_some() && self.session.silence(clock) <= LONGEST_GAP.as_millis() as u32 {
            self.heard += gap.min(LONGEST_GAP);
        }
        match &self.robot {
            None if clock.since(started) > HELLO_TIMEOUT.as_millis() as u32 => {
                return Err(match (self.bytes, self.received) {
                    (0, _) => LinkError::NoResponse(HELLO_TIMEOUT),
                    (bytes, 0) => LinkError::NotARobot { bytes, within: HELLO_TIMEOUT },
                    _ => LinkError::NoAck(HELLO_TIMEOUT),
                });
            }
            None => self.say_hello(clock)?,
            Some(_) if self.session.silence(clock) > self.patience.as_millis() as u32 => {
                return Err(LinkError::Lost(self.patience));
            }
            Some(_) if self.unheard(clock) > self.patience + ACK_TIMEOUT => {
                return Err(LinkError::NoAck(self.patience + ACK_TIMEOUT));
            }
            Some(_) => self.transmit(clock)?,
        }
        Ok(std::mem::take(&mut self.reports))
    }

    /// The time that timers count: without that in which this computer was away.
    fn milliseconds(&self, now: Duration) -> Milliseconds {
        Milliseconds(now.saturating_sub(self.away).as_millis() as u32)
    }

    /// How long the robot has not taken notice of a command or stop.
    fn unheard(&self, now: Milliseconds) -> Duration {
        Duration::from_millis(self.session.oldest_wait(now).max(self.stop.wait(now)).into())
    }

    fn receive(&mut self, now: Duration) -> Result<(), LinkError> {
        let mut buffer = [0; 4096];
        // What does not fit waits for the next poll.
        for _ in 0..MOST_READS {
            let length = match self.port.read(&mut buffer) {
                Ok(0) => return Ok(()),
                Ok(length) => length,
                Err(error) if is_nothing_yet(&error) => return Ok(()),
                Err(error) => return Err(error.into()),
            };
            self.bytes += length as u64;
            for byte in &buffer[..length] {
                match self.decoder.push::<Report>(*byte) {
                    None => {}
                    Some(Ok((header, report))) => self.accept(&header, report, now)?,
                    Some(Err(_)) => self.damaged = self.damaged.saturating_add(1),
                }
            }
        }
        Ok(())
    }

    fn accept(&mut self, header: &Header, report: Report, now: Duration) -> Result<(), LinkError> {
        self.received += 1;
        let clock = self.milliseconds(now);
        if let Report::Hello(hello) = report {
            return self.greet(hello, clock);
        }
        if self.robot.is_none() || header.session != self.session.id() {
            return Ok(());
        }
        self.session.accept(header, report, clock);
        match report {
            Report::Telemetry(telemetry) => self.hear_telemetry(telemetry, now),
            Report::Heartbeat { stop } => self.stop.hear(stop),
            _ => {}
        }
        while let Some(report) = self.session.next_message() {
            self.reports.push(report);
        }
        Ok(())
    }

    fn hear_telemetry(&mut self, telemetry: Telemetry, now: Duration) {
        // What later frames have overtaken is no news; half the circle tells later from earlier.
        let newest = self
            .telemetry
            .is_none_or(|last| telemetry.ticks.wrapping_sub(last.ticks) < u32::MAX / 2);
        if newest {
            self.clock.observe(telemetry.ticks, now);
            self.telemetry = Some(telemetry);
        }
    }

    fn greet(&mut self, hello: RobotHello, now: Milliseconds) -> Result<(), LinkError> {
        let to_us = hello.host_nonce == self.hello.nonce;
        match &self.robot {
            // A robot that has restarted knows no host, or this one from a hello that it repeats.
            Some(robot) if robot.nonce != hello.nonce && (to_us || hello.host_nonce == 0) => {
                Err(LinkError::Restarted(hello.reset))
            }
            None if to_us => {
                self.session = Session::new(session_id(self.hello.nonce, hello.nonce), now);
                self.robot = Some(hello);
                Ok(())
            }
            _ => Ok(()),
        }
    }

    fn say_hello(&mut self, now: Milliseconds) -> Result<(), LinkError> {
        if self.sent.is_some_and(|sent| now.since(sent) < HELLO_INTERVAL) {
            return Ok(());
        }
        let mut frame = [0; MAX_FRAME];
        // A zero first: whatever stood on the wire before is no part of this frame.
        self.port.write_all(&[0])?;
        let length =
            encode(&Header::default(), &Command::Hello(self.hello), &mut frame).unwrap_or(0);
        self.write(length, &frame, now)
    }

    fn transmit(&mut self, now: Milliseconds) -> Result<(), LinkError> {
        let mut frame = [0; MAX_FRAME];
        if let Some(stop) = self.stop.due(now) {
            let length = self.session.write_unreliable(&stop, &mut frame);
            return self.write(length, &frame, now);
        }
        loop {
            let length = self.session.poll(now, &mut frame);
            if length == 0 {
                break;
            }
            self.write(length, &frame, now)?;
        }
        let due = self.sent.is_none_or(|sent| now.since(sent) >= HEARTBEAT_MILLISECONDS);
        if due || self.session.ack_due() {
            let length = self.session.write_unreliable(&Command::Heartbeat, &mut frame);
            self.write(length, &frame, now)?;
        }
        Ok(())
    }

    fn write(&mut self, length: usize, frame: &[u8], now: Milliseconds) -> Result<(), LinkError> {
        self.port.write_all(&frame[..length])?;
        self.sent = Some(now);
        Ok(())
    }
}

fn is_nothing_yet(error: &io::Error) -> bool {
    matches!(error.kind(), ErrorKind::WouldBlock | ErrorKind::TimedOut | ErrorKind::Interrupted)
}
