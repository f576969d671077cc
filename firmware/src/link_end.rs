//! One of the robot's two links: bytes to commands, reports to bytes.
//!
//! A host that says hello with a new nonce opens a new session and retires the last; hellos of
//! retired hosts, which a bad wire may still deliver, are passed over. What is sent first: hello,
//! the echo of a stop, reports, telemetry when it is due, and an acknowledgement only where nothing
//! else carries it.

use heapless::Deque;
use protocol::frame::{Decoder, Header, encode};
use protocol::message::{
    Command, Driven, HostHello, PROTOCOL_VERSION, Report, RobotHello, Telemetry,
};
use protocol::motion::Limits;
use protocol::schema::SCHEMA_HASH;
use protocol::session::{Session, session_id};
use protocol::units::Milliseconds;

/// A telemetry frame is sent this often: 50 times a second is what 115 200 baud carries beside all else.
const TELEMETRY_MILLISECONDS: u32 = 20;

/// A wire may deliver a hello late by as many frames as this many hosts have said at least.
const RETIRED_HOSTS: usize = 8;

/// Heartbeats and acknowledgements of a host that follows the rules take less than this in a tick.
const LAWFUL_BYTES: u16 = 12;
/// So much beyond that is a flood: 100 ms of a line of 115 200 baud that is always full.
const FLOOD_BYTES: u16 = 900;
/// More is not remembered, so that a flood is over a second after its end.
const MOST_IDLE_BYTES: u16 = 3000;

/// What a byte from the wire completes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Received {
    /// A host that is not the one before.
    NewHost,
    /// A command that overtakes those of the reliable channel.
    Urgent(Command),
}

/// Decoder and session of one link.
#[derive(Clone, Debug)]
pub(crate) struct LinkEnd {
    decoder: Decoder,
    hello: RobotHello,
    session: Option<Session<Report, Command>>,
    retired: Deque<u32, RETIRED_HOSTS>,
    same_protocol: bool,
    hello_due: bool,
    stop: u8,
    stop_echo_due: bool,
    telemetry_sent: Milliseconds,
    idle_bytes: u16,
}

impl LinkEnd {
    pub(crate) fn new(hello: RobotHello) -> Self {
        Self {
            decoder: Decoder::default(),
            hello,
            session: None,
            retired: Deque::new(),
            same_protocol: false,
            hello_due: false,
            stop: 0,
            stop_echo_due: false,
            telemetry_sent: Milliseconds(0),
            idle_bytes: 0,
        }
    }

    /// What the wheels may do has changed; the next hello says so.
    pub(crate) fn set_limits(&mut self, limits: Limits) {
        self.hello.limits = limits;
    }

    /// Takes one byte; what it completes and cannot wait for the reliable channel is returned at once.
    pub(crate) fn receive(&mut self, byte: u8, now: Milliseconds) -> Option<Received> {
        self.idle_bytes = self.idle_bytes.saturating_add(1).min(MOST_IDLE_BYTES);
        let (header, command) = self.decoder.push::<Command>(byte)?.ok()?;
        if let Command::Hello(hello) = command {
            return self.open(&hello, now).then_some(Received::NewHost);
        }
        match self.session.as_mut().filter(|session| session.id() == header.session) {
            Some(session) => {
                session.accept(&header, command, now);
                if header.sequence.is_some() {
                    return None;
                }
                if let Command::Stop { number } | Command::EmergencyStop { number } = command {
                    self.record_stop(number);
                }
                Some(Received::Urgent(command))
            }
            None => {
                // The host speaks of a session from before a restart: a hello says so. A stop counts anyway.
                self.hello_due = true;
                matches!(command, Command::Stop { .. } | Command::EmergencyStop { .. })
                    .then_some(Received::Urgent(command))
            }
        }
    }

    /// The next command of the reliable channel.
    pub(crate) fn next_command(&mut self) -> Option<Command> {
        let command = self.session.as_mut()?.next_message()?;
        self.idle_bytes = 0;
        Some(command)
    }

    /// One tick has passed.
    pub(crate) fn pass(&mut self) {
        self.idle_bytes = self.idle_bytes.saturating_sub(LAWFUL_BYTES);
    }

    /// Whether so much arrives that says nothing new that a stop may be waiting far behind it.
    pub(crate) fn is_flooded(&self) -> bool {
        self.idle_bytes > FLOOD_BYTES
    }

    /// Whether the host means the same by its commands as this robot.
    pub(crate) fn same_protocol(&self) -> bool {
        self.same_protocol
    }

    /// The number of the last stop in this session, 0 for none.
    pub(crate) fn last_stop(&self) -> u8 {
        self.stop
    }

    /// How long the host has been silent, milliseconds; `None` without a session.
    pub(crate) fn silence(&self, now: Milliseconds) -> Option<u32> {
        self.session.as_ref().map(|session| session.silence(now))
    }

    /// Whether a report could be put on the reliable channel.
    pub(crate) fn has_room(&self) -> bool {
        self.session.as_ref().is_some_and(|session| session.room() > 0)
    }

    /// Puts a report on the reliable channel, if there is a session with room.
    pub(crate) fn report(&mut self, report: Report) -> bool {
        self.session.as_mut().is_some_and(|session| session.send(report).is_ok())
    }

    /// Writes the next frame that is due; 0 if none is.
    pub(crate) fn transmit(
        &mut self,
        telemetry: impl FnOnce() -> Telemetry,
        driven: Option<Driven>,
        now: Milliseconds,
        out: &mut [u8],
    ) -> usize {
        if self.hello_due {
            self.hello_due = false;
            let session = self.session.as_ref().map_or(0, Session::id);
            let header = Header { session, ..Header::default() };
            let hello = RobotHello { driven, ..self.hello };
            return encode(&header, &Report::Hello(hello), out).unwrap_or(0);
        }
        let Some(session) = &mut self.session else { return 0 };
        let echo = Report::Heartbeat { stop: self.stop };
        if core::mem::take(&mut self.stop_echo_due) {
            return session.write_unreliable(&echo, out);
        }
        let length = session.poll(now, out);
        if length > 0 {
            return length;
        }
        if now.since(self.telemetry_sent) >= TELEMETRY_MILLISECONDS {
            self.telemetry_sent = now;
            return session.write_unreliable(&Report::Telemetry(telemetry()), out);
        }
        if session.ack_due() {
            return session.write_unreliable(&echo, out);
        }
        0
    }

    /// Answers a hello; true if it is that of a new host.
    fn open(&mut self, host: &HostHello, now: Milliseconds) -> bool {
        if self.retired.iter().any(|nonce| *nonce == host.nonce) {
            return false;
        }
        self.hello_due = true;
        let id = session_id(host.nonce, self.hello.nonce);
        if self.session.as_ref().is_some_and(|session| session.id() == id) {
            return false;
        }
        if self.session.is_some() {
            if self.retired.is_full() {
                self.retired.pop_front();
            }
            // There is room now.
            let _ = self.retired.push_back(self.hello.host_nonce);
        }
        self.hello.host_nonce = host.nonce;
        self.same_protocol = host.version == PROTOCOL_VERSION && host.schema == SCHEMA_HASH;
        self.stop = 0;
        self.session = Some(Session::new(id, now));
        true
    }

    fn record_stop(&mut self, number: u8) {
        // A stop that others have overtaken is not the newest; half the circle decides which.
        if number.wrapping_sub(self.stop) < 128 {
            self.stop = number;
        }
        self.stop_echo_due = true;
    }
}
