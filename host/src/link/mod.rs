//! The host's end of the wire: frames to and from a robot behind any `Read + Write`.
//!
//! ```text
//! mission ─► client ═bytes═ robot
//! ```
//! [`LinkClient`] keeps the session; [`mission::Mission`] brings one plan to its end. Both are driven by
//! [`LinkClient::poll`] with the time as an argument, so they run alike on a wire and in a simulation.

pub mod mission;
pub mod port;

use protocol::frame::{Decoder, Header, MAX_FRAME, encode};
use protocol::message::{
    Command, HEARTBEAT_MILLISECONDS, HostHello, PROTOCOL_VERSION, Report, RobotHello, State,
    Telemetry,
};
use protocol::session::{Session, session_id};
use protocol::units::Milliseconds;
use std::io::{self, ErrorKind, Read, Write};
use std::time::Duration;

/// A robot that does not answer hello for this long is none.
const HELLO_TIMEOUT: Duration = Duration::from_secs(2);
/// Hello is said again after this long, milliseconds.
const HELLO_INTERVAL: u32 = 100;
/// A link on which nothing arrives for this long is lost; the robot has long stopped by itself.
const LOST_TIMEOUT: Duration = Duration::from_secs(3);

/// What became of frames on the wire.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct LinkStatistics {
    /// Frames sent and received whole.
    pub frames: u32,
    /// Messages of the reliable lane that this end sent again.
    pub retransmitted: u32,
    /// Frames that arrived damaged.
    pub lost: u32,
}

/// Why the link cannot be used.
#[derive(Debug, thiserror::Error)]
pub enum LinkError {
    /// The port failed.
    #[error("the port failed: {0}")]
    Port(#[from] io::Error),
    /// Nothing answered hello.
    #[error("no robot answered within {0:?}")]
    Silent(Duration),
    /// The robot fell silent.
    #[error("nothing heard from the robot for {0:?}; it stops by itself after 0.3 s of silence")]
    Lost(Duration),
    /// The robot speaks another version of the protocol.
    #[error("the robot speaks protocol {robot}, this program {host}")]
    Version {
        /// The robot's.
        robot: u16,
        /// This program's.
        host: u16,
    },
    /// The robot began anew, so it has forgotten its plan.
    #[error("the robot has restarted; it is at rest and has forgotten the plan")]
    Restarted,
}

/// One end of a session with a robot behind `P`.
#[derive(Debug)]
pub struct LinkClient<P> {
    port: P,
    nonce: u32,
    decoder: Decoder,
    robot: Option<RobotHello>,
    session: Session<Command, Report>,
    telemetry: Option<Telemetry>,
    reports: Vec<Report>,
    started: Option<Milliseconds>,
    sent: Option<Milliseconds>,
    stopping: bool,
    received: u32,
    damaged: u32,
}

impl<P: Read + Write> LinkClient<P> {
    /// A client that will say hello with `nonce`, which must differ from connection to connection.
    pub fn new(port: P, nonce: u32) -> Self {
        Self {
            port,
            nonce,
            decoder: Decoder::default(),
            robot: None,
            session: Session::new(0, Milliseconds(0)),
            telemetry: None,
            reports: Vec::new(),
            started: None,
            sent: None,
            stopping: false,
            received: 0,
            damaged: 0,
        }
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

    /// Frames so far.
    pub fn statistics(&self) -> LinkStatistics {
        let counters = self.session.counters();
        LinkStatistics {
            frames: counters.frames + self.received,
            retransmitted: counters.retransmitted,
            lost: self.damaged,
        }
    }

    /// Puts a command on the reliable lane; false if the window is full for now.
    pub fn send(&mut self, command: Command) -> bool {
        self.robot.is_some() && self.session.send(command).is_ok()
    }

    /// Asks the robot to stop, again and again until it says that it does.
    pub fn stop(&mut self) {
        self.stopping = true;
    }

    /// Reads what has arrived and writes what is due at `now`; returns the reports of the reliable
    /// lane, each once and in order. To be called every few milliseconds.
    ///
    /// # Errors
    /// [`LinkError`]; the link is then of no further use.
    pub fn poll(&mut self, now: Duration) -> Result<Vec<Report>, LinkError> {
        let clock = Milliseconds(now.as_millis() as u32);
        let started = *self.started.get_or_insert(clock);
        self.receive(clock)?;
        match &self.robot {
            None if clock.since(started) > HELLO_TIMEOUT.as_millis() as u32 => {
                return Err(LinkError::Silent(HELLO_TIMEOUT));
            }
            None => self.say_hello(clock)?,
            Some(_) if self.session.silence(clock) > LOST_TIMEOUT.as_millis() as u32 => {
                return Err(LinkError::Lost(LOST_TIMEOUT));
            }
            Some(_) => self.transmit(clock)?,
        }
        Ok(std::mem::take(&mut self.reports))
    }

    fn receive(&mut self, now: Milliseconds) -> Result<(), LinkError> {
        let mut buffer = [0; 4096];
        loop {
            let length = match self.port.read(&mut buffer) {
                Ok(0) => return Ok(()),
                Ok(length) => length,
                Err(error) if is_nothing_yet(&error) => return Ok(()),
                Err(error) => return Err(error.into()),
            };
            for byte in &buffer[..length] {
                match self.decoder.push::<Report>(*byte) {
                    None => {}
                    Some(Ok((header, report))) => self.accept(&header, report, now)?,
                    Some(Err(_)) => self.damaged += 1,
                }
            }
        }
    }

    fn accept(
        &mut self,
        header: &Header,
        report: Report,
        now: Milliseconds,
    ) -> Result<(), LinkError> {
        self.received += 1;
        if let Report::Hello(hello) = report {
            return self.greet(hello, now);
        }
        if self.robot.is_none() || header.session != self.session.id() {
            return Ok(());
        }
        self.session.accept(header, report, now);
        if let Report::Telemetry(telemetry) = report {
            self.stopping &= !matches!(telemetry.state, State::Stopped | State::Faulted(_));
            self.telemetry = Some(telemetry);
        }
        while let Some(report) = self.session.next_message() {
            self.reports.push(report);
        }
        Ok(())
    }

    fn greet(&mut self, hello: RobotHello, now: Milliseconds) -> Result<(), LinkError> {
        if self.robot.is_some_and(|robot| robot.nonce != hello.nonce) {
            return Err(LinkError::Restarted);
        }
        if self.robot.is_some() || hello.host_nonce != self.nonce {
            return Ok(());
        }
        if hello.version != PROTOCOL_VERSION {
            return Err(LinkError::Version { robot: hello.version, host: PROTOCOL_VERSION });
        }
        self.robot = Some(hello);
        self.session = Session::new(session_id(self.nonce, hello.nonce), now);
        Ok(())
    }

    fn say_hello(&mut self, now: Milliseconds) -> Result<(), LinkError> {
        if self.sent.is_some_and(|sent| now.since(sent) < HELLO_INTERVAL) {
            return Ok(());
        }
        let hello = Command::Hello(HostHello { version: PROTOCOL_VERSION, nonce: self.nonce });
        let mut frame = [0; MAX_FRAME];
        // A zero first: whatever stood on the wire before is no part of this frame.
        self.port.write_all(&[0])?;
        let length = encode(&Header::default(), &hello, &mut frame).unwrap_or(0);
        self.write(length, &frame, now)
    }

    fn transmit(&mut self, now: Milliseconds) -> Result<(), LinkError> {
        let mut frame = [0; MAX_FRAME];
        let due = self.sent.is_none_or(|sent| now.since(sent) >= HEARTBEAT_MILLISECONDS);
        if self.stopping && due {
            let length = self.session.write_unreliable(&Command::Stop, &mut frame);
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
