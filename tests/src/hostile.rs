//! Robots that are none of ours, as ports in virtual time: what they say is theirs to choose.
//!
//! A [`Talker`] keeps a lawful session and says what its [`Behaviour`] tells it; [`Zeros`] is no robot at all.
#![allow(clippy::unwrap_used, reason = "what helps a test fails as a test does")]

use protocol::frame::{Decoder, Header, MAX_FRAME, encode};
use protocol::message::{
    Board, Command, Driven, MAX_LEGS, PROTOCOL_VERSION, Report, ResetCause, RobotHello, State,
    Telemetry,
};
use protocol::motion::{Limits, Pose, WheelSpeeds};
use protocol::schema::SCHEMA_HASH;
use protocol::session::{Session, session_id};
use protocol::units::{Milliseconds, RadiansPerSecond};
use std::collections::VecDeque;
use std::io::{self, ErrorKind, Read, Write};
use std::time::Duration;
use wmr::legs::DEFAULT_LIMITS;
use wmr::link::drive::TimedPort;

/// Where it says that it stands.
pub const START: Pose = Pose::new(0.0, 0.0, 0.0);
/// A robot's word comes this often.
pub const BEAT: Duration = Duration::from_millis(20);

/// How a robot of this protocol introduces itself.
pub fn hello(
    host_nonce: u32,
    nonce: u32,
    limits: Limits,
    max_legs: u16,
    driven: Option<Driven>,
) -> RobotHello {
    RobotHello {
        version: PROTOCOL_VERSION,
        schema: SCHEMA_HASH,
        host_nonce,
        nonce,
        board: Board::Pico,
        firmware: [0, 1, 0],
        git: 0,
        limits,
        max_legs,
        driven,
        reset: ResetCause::PowerOn,
    }
}

/// What a robot does that is no robot of ours.
#[derive(Clone, Copy, Debug)]
pub struct Behaviour {
    /// In hello.
    pub max_legs: u16,
    /// In hello.
    pub limits: Limits,
    /// Whether it takes notice of the reliable lane.
    pub acknowledges: bool,
    /// How its clock goes.
    pub ticks_a_beat: u32,
    /// State and wheel speed, rad/s, without a plan.
    pub before: (State, f32),
    /// The same once it has a plan.
    pub after: (State, f32),
    /// Where it says that it stands once it has a plan.
    pub place_after: Pose,
    /// What it reports once it has the plan.
    pub reports: fn(u32) -> Vec<Report>,
    /// What it sends besides, as fast as it is read.
    pub flood: &'static [u8],
}

const NOTHING: fn(u32) -> Vec<Report> = |_| Vec::new();

/// A robot that takes a plan and then drives for ever without getting on.
pub const TALKER: Behaviour = Behaviour {
    max_legs: MAX_LEGS as u16,
    limits: DEFAULT_LIMITS,
    acknowledges: true,
    ticks_a_beat: 4,
    before: (State::Idle, 0.0),
    after: (State::Driving, 0.0),
    place_after: START,
    reports: NOTHING,
    flood: &[],
};

/// The robot, and the wire to it.
#[derive(Debug)]
pub struct Talker {
    behaviour: Behaviour,
    now: Duration,
    beaten: Duration,
    ticks: u32,
    decoder: Decoder,
    session: Option<Session<Report, Command>>,
    plan: Option<u32>,
    legs: u16,
    stop: u8,
    out: VecDeque<u8>,
    reads: u32,
}

impl Talker {
    /// One that behaves so.
    pub fn new(behaviour: Behaviour) -> Self {
        Self {
            behaviour,
            now: Duration::ZERO,
            beaten: Duration::ZERO,
            ticks: 100,
            decoder: Decoder::default(),
            session: None,
            plan: None,
            legs: 0,
            stop: 0,
            out: VecDeque::new(),
            reads: 0,
        }
    }

    fn milliseconds(&self) -> Milliseconds {
        Milliseconds(self.now.as_millis() as u32)
    }

    fn greet(&mut self, host_nonce: u32) {
        let Behaviour { limits, max_legs, .. } = self.behaviour;
        let hello = hello(host_nonce, 7, limits, max_legs, None);
        let now = self.milliseconds();
        self.session.get_or_insert_with(|| Session::new(session_id(host_nonce, 7), now));
        let mut frame = [0; MAX_FRAME];
        let length = encode(&Header::default(), &Report::Hello(hello), &mut frame).unwrap();
        self.out.extend(&frame[..length]);
    }

    fn hear(&mut self, command: Command) {
        match command {
            Command::PlanBegin(header) => self.legs = header.count,
            Command::PlanCommit { plan } => {
                self.plan = Some(plan);
                self.report(Report::PlanAccepted { plan, end: self.legs });
                for report in (self.behaviour.reports)(plan) {
                    self.report(report);
                }
            }
            Command::Stop { number } => self.stop = number,
            _ => {}
        }
    }

    fn report(&mut self, report: Report) {
        let _ = self.session.as_mut().unwrap().send(report);
    }

    fn say(&mut self, report: &Report) {
        let mut frame = [0; MAX_FRAME];
        let length = self.session.as_mut().unwrap().write_unreliable(report, &mut frame);
        self.out.extend(&frame[..length]);
    }

    fn beat(&mut self) {
        let Behaviour { before, after, place_after, ticks_a_beat, .. } = self.behaviour;
        let ((state, speed), pose) =
            if self.plan.is_some() { (after, place_after) } else { (before, START) };
        self.ticks = self.ticks.wrapping_add(ticks_a_beat);
        let wheels = WheelSpeeds { left: RadiansPerSecond(speed), right: RadiansPerSecond(speed) };
        self.say(&Report::Telemetry(Telemetry { ticks: self.ticks, pose, wheels, state, leg: 0 }));
        self.say(&Report::Heartbeat { stop: self.stop });
        let mut frame = [0; MAX_FRAME];
        let now = self.milliseconds();
        loop {
            let length = self.session.as_mut().unwrap().poll(now, &mut frame);
            if length == 0 {
                break;
            }
            self.out.extend(&frame[..length]);
        }
    }
}

impl Write for Talker {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        for byte in bytes {
            let Some(Ok((header, command))) = self.decoder.push::<Command>(*byte) else { continue };
            if let Command::Hello(hello) = command {
                self.greet(hello.nonce);
                continue;
            }
            let now = self.milliseconds();
            let Some(session) = self.session.as_mut() else { continue };
            if !self.behaviour.acknowledges && header.sequence.is_some() {
                continue;
            }
            session.accept(&header, command, now);
            if header.sequence.is_none() {
                self.hear(command);
            }
            while let Some(command) = self.session.as_mut().unwrap().next_message() {
                self.hear(command);
            }
        }
        Ok(bytes.len())
    }

    fn flush(&mut self) -> io::Result<()> {
        Ok(())
    }
}

impl Read for Talker {
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        self.reads += 1;
        assert!(self.reads < 1000, "one poll never ends");
        for (place, byte) in buffer.iter_mut().enumerate() {
            *byte = match self.out.pop_front() {
                Some(byte) => byte,
                None if !self.behaviour.flood.is_empty() => {
                    self.behaviour.flood[place % self.behaviour.flood.len()]
                }
                None if place == 0 => return Err(ErrorKind::WouldBlock.into()),
                None => return Ok(place),
            };
        }
        Ok(buffer.len())
    }
}

impl TimedPort for Talker {
    fn now(&self) -> Duration {
        self.now
    }

    fn wait(&mut self, duration: Duration) -> io::Result<()> {
        self.reads = 0;
        self.now += duration;
        assert!(self.now < Duration::from_secs(60), "it does not end");
        if self.session.is_some() && self.now - self.beaten >= BEAT {
            self.beaten = self.now;
            self.beat();
        }
        Ok(())
    }
}

/// A port full of zeros.
#[derive(Debug)]
pub struct Zeros(
    /// Its clock.
    pub Duration,
);

impl Read for Zeros {
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        buffer.fill(0);
        Ok(buffer.len())
    }
}

impl Write for Zeros {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        Ok(bytes.len())
    }

    fn flush(&mut self) -> io::Result<()> {
        Ok(())
    }
}

impl TimedPort for Zeros {
    fn now(&self) -> Duration {
        self.0
    }

    fn wait(&mut self, duration: Duration) -> io::Result<()> {
        self.0 += duration;
        Ok(())
    }
}
