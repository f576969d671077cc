//! Robots that talk and do not get on, and peers that never stop sending: every drive of one ends with
//! its reason, within the planned time and 5 s, and none is taken for having reached its goal.
#![allow(clippy::unwrap_used, clippy::panic, reason = "helpers of tests fail as tests do")]

use protocol::frame::{Decoder, Header, MAX_FRAME, encode};
use protocol::message::{
    Board, Command, Fault, LegResult, MAX_LEGS, PROTOCOL_VERSION, PauseReason, Report, ResetCause,
    RobotHello, State, Telemetry,
};
use protocol::motion::{Leg, Limits, Pose, Timing, WheelSpeeds};
use protocol::schema::SCHEMA_HASH;
use protocol::session::{Session, session_id};
use protocol::units::{MetresPerSecond, Milliseconds, RadiansPerSecond};
use std::collections::VecDeque;
use std::io::{self, ErrorKind, Read, Write};
use std::time::Duration;
use wmr::geometry::Point;
use wmr::legs::{DEFAULT_LIMITS, LegOptions, to_legs};
use wmr::link::drive::{DriveError, TimedPort, drive, stop, wait_for};
use wmr::link::mission::Mission;
use wmr::link::parameters::{Exchange, ParameterError, Request};
use wmr::link::{Impossible, LinkClient, LinkError, MissionError};

const START: Pose = Pose::new(0.0, 0.0, 0.0);
const GOAL: Pose = Pose::new(1.0, 0.5, std::f32::consts::FRAC_PI_2);
/// What the contract allows beyond the planned time.
const PATIENCE: Duration = Duration::from_secs(5);
/// A robot's word comes this often.
const BEAT: Duration = Duration::from_millis(20);

/// What a robot does that is no robot of ours.
#[derive(Clone, Copy)]
struct Behaviour {
    max_legs: u16,
    limits: Limits,
    acknowledges: bool,
    ticks_a_beat: u32,
    before: (State, f32),
    after: (State, f32),
    place_after: Pose,
    /// What it reports once it has the plan.
    reports: fn(u32) -> Vec<Report>,
    /// What it sends besides, as fast as it is read.
    flood: &'static [u8],
}

const NOTHING: fn(u32) -> Vec<Report> = |_| Vec::new();

const TALKER: Behaviour = Behaviour {
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

struct Talker {
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
    fn new(behaviour: Behaviour) -> Self {
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
        let hello = RobotHello {
            version: PROTOCOL_VERSION,
            schema: SCHEMA_HASH,
            host_nonce,
            nonce: 7,
            board: Board::Pico,
            firmware: [0, 1, 0],
            git: 0,
            limits,
            max_legs,
            driven: None,
            reset: ResetCause::PowerOn,
        };
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

/// Two legs: a metre ahead, and half a metre to the left.
fn legs() -> Vec<Leg> {
    let way = [Point::new(0.0, 0.0), Point::new(1.0, 0.0), Point::new(1.0, 0.5)];
    let options = LegOptions { timing: Timing::Limits, reverse: false };
    to_legs(&way, 0.0, None, &options, &DEFAULT_LIMITS)
}

fn planned() -> Duration {
    let ticks: u32 = legs().iter().map(|leg| leg.ticks(&DEFAULT_LIMITS)).sum();
    Duration::from_millis(u64::from(ticks) * 5)
}

/// How a drive of such a robot ends; it must do so in time.
fn end_of(behaviour: Behaviour) -> MissionError {
    let mut client = LinkClient::new(Talker::new(behaviour), 42);
    let mut mission = Mission::new(legs(), START);
    let give_up = planned() + PATIENCE;
    let result = drive(&mut client, &mut mission, || false, |_, _| {});
    let took = client.port_mut().now();
    assert!(took < give_up, "{took:?}: {result:?}");
    match result {
        Err(DriveError::Mission(error)) => error,
        other => panic!("{other:?}"),
    }
}

fn leg_done(plan: u32, index: u16, ticks: u32, pose: Pose) -> Report {
    Report::LegDone(LegResult { plan, index, ticks, pose })
}

fn both_legs(plan: u32, ticks: u32) -> Vec<Report> {
    let corner = Pose::new(1.0, 0.0, 0.0);
    vec![
        leg_done(plan, 0, ticks, corner),
        leg_done(plan, 1, ticks, GOAL),
        Report::PlanDone { plan, end: 2, pose: GOAL },
    ]
}

#[test]
fn a_leg_that_never_ends_is_late() {
    let error = end_of(TALKER);
    assert!(matches!(error, MissionError::Late { leg: 0, .. }), "{error}");
}

#[test]
fn a_robot_that_does_not_drive_its_plan_is_believed() {
    let after = |state| end_of(Behaviour { after: (state, 0.0), ..TALKER });
    let error = after(State::Idle);
    assert!(matches!(error, MissionError::NotDriving { state: State::Idle, .. }), "{error}");
    let error = after(State::Paused(PauseReason::Silence));
    assert!(matches!(error, MissionError::NotDriving { .. }), "{error}");
    let error = after(State::Stopped);
    assert!(matches!(error, MissionError::Stopped), "{error}");
    let error = after(State::Faulted(Fault::Stall));
    assert!(matches!(error, MissionError::Fault { fault: Fault::Stall, .. }), "{error}");
}

#[test]
fn a_clock_that_stands_still_and_a_robot_that_does_not_answer_end_the_drive() {
    let error = end_of(Behaviour { ticks_a_beat: 0, ..TALKER });
    assert!(matches!(error, MissionError::Link(LinkError::ClockStopped(_))), "{error}");
    let error = end_of(Behaviour { acknowledges: false, ..TALKER });
    assert!(matches!(error, MissionError::Link(LinkError::NoAck(_))), "{error}");
    let error = end_of(Behaviour { before: (State::Stopped, 0.5), ..TALKER });
    assert!(matches!(error, MissionError::NeverRests(_)), "{error}");
}

#[test]
fn a_robot_that_no_plan_fits_is_refused() {
    let slow = Limits { speed: MetresPerSecond(f32::NAN), ..DEFAULT_LIMITS };
    for behaviour in [Behaviour { max_legs: 0, ..TALKER }, Behaviour { limits: slow, ..TALKER }] {
        let error = end_of(behaviour);
        assert!(matches!(error, MissionError::Unfit(_)), "{error}");
    }
}

#[test]
fn an_end_without_its_legs_is_none() {
    let after = |reports| {
        end_of(Behaviour { reports, after: (State::Idle, 0.0), place_after: GOAL, ..TALKER })
    };
    let error = after(|plan| vec![Report::PlanDone { plan, end: 2, pose: GOAL }]);
    assert!(
        matches!(error, MissionError::Impossible(Impossible::End { end: 2, next: 0, of: 2 })),
        "{error}"
    );
    let error = after(|plan| vec![leg_done(plan, u16::MAX, 400, GOAL)]);
    assert!(matches!(error, MissionError::Impossible(Impossible::Leg { .. })), "{error}");
    let error = after(|plan| both_legs(plan, u32::MAX));
    assert!(matches!(error, MissionError::Impossible(Impossible::Time { .. })), "{error}");
    let error = after(|plan| both_legs(plan ^ 1, 1));
    assert!(matches!(error, MissionError::NotDriving { .. }), "{error}");
}

#[test]
fn an_end_that_telemetry_contradicts_is_none() {
    let reports: fn(u32) -> Vec<Report> = |plan| both_legs(plan, 1);
    let far = Pose::new(90.0, -90.0, 0.0);
    for (after, place_after) in [
        ((State::Idle, 0.0), START),
        ((State::Idle, 0.0), far),
        ((State::Idle, 0.5), GOAL),
        ((State::Driving, 0.0), GOAL),
    ] {
        let error = end_of(Behaviour { reports, after, place_after, ..TALKER });
        assert!(matches!(error, MissionError::Disagrees { .. }), "{error}");
    }
    let mut client = LinkClient::new(
        Talker::new(Behaviour { reports, after: (State::Idle, 0.0), place_after: GOAL, ..TALKER }),
        42,
    );
    let end = drive(&mut client, &mut Mission::new(legs(), START), || false, |_, _| {});
    assert_eq!(end.unwrap(), GOAL, "where all agree, it has arrived");
}

#[test]
fn a_peer_that_sends_without_end_delays_neither_timers_nor_the_users_stop() {
    for flood in [&[0_u8] as &[u8], &[1, 2, 3, 255, 0, 17], &[1]] {
        let mut client = LinkClient::new(Talker::new(Behaviour { flood, ..TALKER }), 42);
        let stop_at = Duration::from_secs(1);
        let asked = std::cell::Cell::new(false);
        let result = wait_for(
            &mut client,
            || asked.get(),
            |client, now| {
                asked.set(now >= stop_at);
                client.poll(now)?;
                Ok::<Option<()>, LinkError>(None)
            },
        );
        assert!(matches!(result, Ok(None)), "{result:?}");
        assert!(client.port_mut().now() < stop_at + Duration::from_millis(10));
    }
    // From the first byte on, nothing but zeros.
    let mut client = LinkClient::new(Zeros(Duration::ZERO), 42);
    let error = drive(&mut client, &mut Mission::new(legs(), START), || false, |_, _| {});
    let Err(DriveError::Mission(MissionError::Link(LinkError::NotARobot { .. }))) = error else {
        panic!("{error:?}")
    };
    assert!(client.port_mut().0 < Duration::from_secs(3));
}

/// A port full of zeros.
struct Zeros(Duration);

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

#[test]
fn questions_and_stops_end_too() {
    let mut client = LinkClient::new(Talker::new(TALKER), 42);
    let mut exchange = Exchange::new(Request::Read);
    let result = wait_for(&mut client, || false, |client, now| exchange.step(client, now));
    let Err(ParameterError::Link(LinkError::NoAnswer(_))) = result else { panic!("{result:?}") };
    assert!(client.port_mut().now() < PATIENCE);

    let rolling = Behaviour { before: (State::Stopped, 0.5), ..TALKER };
    let mut client = LinkClient::new(Talker::new(rolling), 42);
    let result = stop(&mut client, || false);
    assert!(matches!(result, Err(DriveError::StopUnconfirmed)), "{result:?}");
    assert!(client.port_mut().now() < PATIENCE);
    let resting = Behaviour { before: (State::Stopped, 0.0), ..TALKER };
    let stopped = stop(&mut LinkClient::new(Talker::new(resting), 42), || false).unwrap();
    assert_eq!(stopped.state, State::Stopped);
}
