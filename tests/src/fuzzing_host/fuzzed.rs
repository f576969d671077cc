//! The robot that the bytes move: four of them a word, over and over.

use super::{LEGS, PLAN};
use crate::hostile::{BEAT, hello};
use protocol::frame::{Decoder, Header, MAX_FRAME, encode};
use protocol::message::{
    BatteryLevel, BatteryReport, Command, Driven, Fault, Identity, LegResult, PauseReason,
    PlanRefusal, Report, State, Telemetry, Wheel,
};
use protocol::motion::{Pose, WheelSpeeds};
use protocol::session::{Session, session_id};
use protocol::units::{Milliseconds, RadiansPerSecond};
use std::cell::Cell;
use std::collections::VecDeque;
use std::io::{self, ErrorKind, Read, Write};
use std::rc::Rc;
use std::time::Duration;
use wmr::legs::DEFAULT_LIMITS;
use wmr::link::drive::TimedPort;

/// The robot's own number, said in hello.
const NONCE: u32 = 7;
/// Places that it may name: along the legs, and elsewhere.
const PLACES: [(f32, f32); 8] = [
    (0.0, 0.0),
    (0.5, 0.0),
    (1.0, 0.0),
    (1.0, 0.015),
    (1.0, 0.03),
    (0.7, 0.0),
    (99.0, -99.0),
    (f32::NAN, f32::INFINITY),
];

/// The robot and the wire to it.
#[derive(Debug)]
pub(super) struct Fuzzed {
    data: Vec<u8>,
    place: usize,
    clock: Rc<Cell<Duration>>,
    budget: Duration,
    beaten: Duration,
    silent_until: Duration,
    ticks: u32,
    decoder: Decoder,
    session: Option<Session<Report, Command>>,
    out: VecDeque<u8>,
    /// Legs whose end it has reported in their turn.
    pub(super) reported: u16,
    /// What it has said last of itself.
    pub(super) shown: Option<Telemetry>,
}

impl Fuzzed {
    pub(super) fn new(data: &[u8], budget: Duration) -> Self {
        Self {
            data: data.to_vec(),
            place: 0,
            clock: Rc::default(),
            budget,
            beaten: Duration::ZERO,
            silent_until: Duration::ZERO,
            ticks: 100,
            decoder: Decoder::default(),
            session: None,
            out: VecDeque::new(),
            reported: 0,
            shown: None,
        }
    }

    /// Its time, for others to look at.
    pub(super) fn clock(&self) -> Rc<Cell<Duration>> {
        Rc::clone(&self.clock)
    }

    fn milliseconds(&self) -> Milliseconds {
        Milliseconds(self.clock.get().as_millis() as u32)
    }

    fn next(&mut self) -> u8 {
        let byte = self.data.get(self.place).copied().unwrap_or(0);
        self.place = (self.place + 1) % self.data.len().max(1);
        byte
    }

    fn greet(&mut self, host_nonce: u32, nonce: u32, driven: Option<Driven>) {
        let report = Report::Hello(hello(host_nonce, nonce, DEFAULT_LIMITS, 32, driven));
        self.put(|frame| encode(&Header::default(), &report, frame).unwrap_or(0));
    }

    fn put(&mut self, write: impl FnOnce(&mut [u8]) -> usize) {
        let mut frame = [0; MAX_FRAME];
        let length = write(&mut frame);
        self.out.extend(&frame[..length]);
    }

    fn report(&mut self, report: Report) {
        if let Some(session) = &mut self.session {
            // What finds no room is not said.
            let sent = session.send(report).is_ok();
            if let (true, Report::LegDone(LegResult { plan: PLAN, index, .. })) = (sent, report) {
                self.reported += u16::from(index == self.reported);
            }
        }
    }

    fn say(&mut self, report: Report) {
        let mut frame = [0; MAX_FRAME];
        let Some(session) = &mut self.session else { return };
        let length = session.write_unreliable(&report, &mut frame);
        self.out.extend(&frame[..length]);
        if let Report::Telemetry(telemetry) = report {
            self.shown = Some(telemetry);
        }
    }

    fn beat(&mut self) {
        let [what, b, c, d] = [(); 4].map(|()| self.next());
        let (x, y) = PLACES[usize::from(d % 8)];
        let pose = Pose::new(x, y, 0.0);
        let plan = if b & 1 == 0 { PLAN } else { PLAN + 1 };
        self.ticks = self.ticks.wrapping_add(u32::from(what >> 5));
        match what % 16 {
            0..=4 => self.telemetry(b, c, pose),
            5 | 6 => {
                let index = if c < 200 { u16::from(c % 3) } else { u16::from(c) * 257 };
                let ticks = u32::from(d >> 3) * 20;
                self.report(Report::LegDone(LegResult { plan, index, ticks, pose }));
            }
            7 => self.report(Report::PlanDone { plan, end: u16::from(c % 4), pose }),
            8 => self.report(Report::PlanAccepted { plan, end: u16::from(c % 4) }),
            9 => {
                let reason = match c % 4 {
                    0 => PlanRefusal::NotCleared,
                    1 => PlanRefusal::NotAtRest,
                    _ => PlanRefusal::TooManyLegs { room: c.into() },
                };
                self.report(Report::PlanRefused { plan, reason });
            }
            10 => {
                let (state, next) = (state(c), u16::from(c % 4));
                let wheel = Some(Wheel::Left);
                self.report(Report::PlanStopped { plan, next, state, pose, wheel });
            }
            11 => self.out.extend([b, c, d].into_iter().cycle().take(usize::from(d) * 8)),
            12 => {
                let driven = Driven { plan, next: u16::from(c % 4), end: LEGS };
                self.greet(42, u32::from(b % 2) + NONCE, (d & 1 == 0).then_some(driven));
            }
            13 => self.say(Report::Heartbeat { stop: b }),
            14 => {
                let level = if c & 1 == 0 { BatteryLevel::Empty } else { BatteryLevel::Good };
                self.report(Report::Battery(BatteryReport { level, volts: f32::from(d) - 9.0 }));
                self.report(Report::Identity(Identity::default()));
            }
            _ => self.silent_until = self.clock.get() + 10 * Duration::from_millis(b.into()),
        }
    }

    fn telemetry(&mut self, kind: u8, speed: u8, pose: Pose) {
        self.ticks = self.ticks.wrapping_add(u32::from(kind >> 5));
        let speed = RadiansPerSecond(f32::from(speed.saturating_sub(200)) / 20.0);
        let wheels = WheelSpeeds { left: speed, right: speed };
        let (ticks, state) = (self.ticks, state(kind));
        self.say(Report::Telemetry(Telemetry { ticks, pose, wheels, state, leg: 0 }));
    }

    fn send_due(&mut self) {
        let now = self.milliseconds();
        let mut frame = [0; MAX_FRAME];
        let Some(session) = &mut self.session else { return };
        loop {
            let length = session.poll(now, &mut frame);
            if length == 0 {
                return;
            }
            self.out.extend(&frame[..length]);
        }
    }
}

fn state(kind: u8) -> State {
    match kind % 8 {
        0..=2 => State::Idle,
        3 | 4 => State::Driving,
        5 => State::Paused(PauseReason::Silence),
        6 => State::Stopped,
        _ => State::Faulted(Fault::Stall),
    }
}

impl Write for Fuzzed {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        let now = self.milliseconds();
        for byte in bytes {
            let Some(Ok((header, command))) = self.decoder.push::<Command>(*byte) else { continue };
            if let Command::Hello(host) = command {
                let id = session_id(host.nonce, NONCE);
                self.session.get_or_insert_with(|| Session::new(id, now));
                self.greet(host.nonce, NONCE, None);
            } else if let Some(session) = &mut self.session {
                session.accept(&header, command, now);
                while session.next_message().is_some() {}
            }
        }
        Ok(bytes.len())
    }

    fn flush(&mut self) -> io::Result<()> {
        Ok(())
    }
}

impl Read for Fuzzed {
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        if self.out.is_empty() { Err(ErrorKind::WouldBlock.into()) } else { self.out.read(buffer) }
    }
}

impl TimedPort for Fuzzed {
    fn now(&self) -> Duration {
        self.clock.get()
    }

    fn wait(&mut self, duration: Duration) -> io::Result<()> {
        let now = self.clock.get() + duration;
        self.clock.set(now);
        assert!(now < self.budget, "no end within {:?}", self.budget);
        if self.session.is_some() && now >= self.silent_until && now - self.beaten >= BEAT {
            self.beaten = now;
            self.beat();
            self.say(Report::Heartbeat { stop: 0 });
            self.send_due();
        }
        Ok(())
    }
}
