//! One of the robot's two links: bytes to commands, reports to bytes.

use protocol::frame::{Decoder, Header, encode};
use protocol::message::{Command, Report, RobotHello, Telemetry};
use protocol::session::{Session, session_id};
use protocol::units::Milliseconds;

/// A telemetry frame is sent this often: 50 times a second is what 115 200 baud carries beside all else.
const TELEMETRY_MILLISECONDS: u32 = 20;

/// Decoder and session of one link.
#[derive(Clone, Debug)]
pub(crate) struct LinkEnd {
    decoder: Decoder,
    hello: RobotHello,
    session: Option<Session<Report, Command>>,
    hello_due: bool,
    telemetry_sent: Milliseconds,
}

impl LinkEnd {
    pub(crate) fn new(hello: RobotHello) -> Self {
        Self {
            decoder: Decoder::default(),
            hello,
            session: None,
            hello_due: false,
            telemetry_sent: Milliseconds(0),
        }
    }

    /// Takes one byte; a command of the unreliable lane that it completes is returned at once.
    pub(crate) fn receive(&mut self, byte: u8, now: Milliseconds) -> Option<Command> {
        let (header, command) = self.decoder.push::<Command>(byte)?.ok()?;
        if let Command::Hello(hello) = command {
            self.open(hello.nonce, now);
            return Some(command);
        }
        match self.session.as_mut().filter(|session| session.id() == header.session) {
            Some(session) => {
                session.accept(&header, command, now);
                header.sequence.is_none().then_some(command)
            }
            None => {
                // The host speaks of a session from before a restart: tell it. A stop counts anyway.
                self.hello_due = true;
                (command == Command::Stop).then_some(command)
            }
        }
    }

    /// The next command of the reliable lane.
    pub(crate) fn next_command(&mut self) -> Option<Command> {
        self.session.as_mut()?.next_message()
    }

    /// How long the host has been silent, milliseconds; `None` without a session.
    pub(crate) fn silence(&self, now: Milliseconds) -> Option<u32> {
        self.session.as_ref().map(|session| session.silence(now))
    }

    /// Puts a report on the reliable lane, if there is a session with room.
    pub(crate) fn report(&mut self, report: Report) -> bool {
        self.session.as_mut().is_some_and(|session| session.send(report).is_ok())
    }

    /// Writes the next frame that is due; 0 if none is.
    pub(crate) fn transmit(
        &mut self,
        telemetry: Telemetry,
        now: Milliseconds,
        out: &mut [u8],
    ) -> usize {
        if self.hello_due {
            self.hello_due = false;
            let session = self.session.as_ref().map_or(0, Session::id);
            let header = Header { session, ..Header::default() };
            return encode(&header, &Report::Hello(self.hello), out).unwrap_or(0);
        }
        let Some(session) = &mut self.session else { return 0 };
        let length = session.poll(now, out);
        if length > 0 {
            return length;
        }
        if now.since(self.telemetry_sent) < TELEMETRY_MILLISECONDS && !session.ack_due() {
            return 0;
        }
        self.telemetry_sent = now;
        session.write_unreliable(&Report::Telemetry(telemetry), out)
    }

    fn open(&mut self, host_nonce: u32, now: Milliseconds) {
        self.hello_due = true;
        let id = session_id(host_nonce, self.hello.nonce);
        if self.session.as_ref().is_none_or(|session| session.id() != id) {
            self.hello.host_nonce = host_nonce;
            self.session = Some(Session::new(id, now));
        }
    }
}
