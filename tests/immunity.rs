//! What has gone wrong with robots elsewhere: hosts that die, freeze, or whose old words come late; clocks that
//! wrap; saves under load.
#![allow(clippy::unwrap_used, clippy::panic, reason = "helpers of tests fail as tests do")]

use hil_sim::base::{BaseParameters, TruePose, WheeledBase};
use hil_sim::in_process::InProcess;
use hil_sim::simulation::{Firmware, Simulation};
use protocol::frame::Decoder;
use protocol::message::{Command, Report, State};
use protocol::motion::{Leg, Pose, Timing};
use protocol::parameters::Parameters;
use protocol::units::Metres;
use std::collections::VecDeque;
use std::io::{self, Read, Write};
use std::time::Duration;
use wmr::geometry::Point;
use wmr::legs::{DEFAULT_LIMITS, LegOptions, from_wire, to_legs};
use wmr::link::mission::{Mission, MissionError, MissionEvent, Progress};
use wmr::link::resume::check_beside_leg;
use wmr::link::{LinkClient, LinkError};
use wmr_tests::{POLL, drive, simulated_robot};

const START: Pose = Pose::new(0.2, 0.2, 0.5);
const GOAL: Point = Point::new(1.0, 1.1);
/// A few encoder counts on either wheel.
const AT_GOAL: f64 = 0.002;
/// What the wheel loops still turn at rest to stand where they should: three encoder counts.
const STILL: f64 = 5e-4;
/// And what they bring it to stand at, from where it first rests.
const SETTLES: f64 = 1e-3;
/// Until silence counts, and braking from full speed, and what the wheels lag behind.
const AT_REST: Duration = Duration::from_millis(300 + 500 + 150);

fn legs() -> Vec<Leg> {
    let way = [Point::new(0.2, 0.2), Point::new(0.9, 0.4), GOAL];
    let options = LegOptions { timing: Timing::Limits, reverse: false };
    to_legs(&way, START.heading.0.into(), None, &options, &DEFAULT_LIMITS)
}

fn moved(simulation: &mut Simulation<InProcess>, within: Duration) -> f64 {
    let before = simulation.truth().pose;
    simulation.wait(within).unwrap();
    let after = simulation.truth().pose;
    (after.x - before.x).hypot(after.y - before.y)
}

fn is_at_goal(pose: TruePose) -> bool {
    GOAL.distance(Point::new(pose.x, pose.y)) < AT_GOAL
}

/// Killed, unplugged, or its socket cut: to the robot it is the same.
#[test]
fn whenever_its_host_dies_the_robot_is_soon_at_rest() {
    let mut random = fastrand::Rng::with_seed(11);
    for _ in 0..100 {
        let died = Duration::from_millis(random.u64(100..6000));
        let mut client = LinkClient::new(simulated_robot(START, 1), 42);
        let mut mission = Mission::new(legs(), START);
        while client.port_mut().now() < died {
            let now = client.port_mut().now();
            mission.step(&mut client, now).unwrap();
            client.port_mut().wait(POLL).unwrap();
        }
        let mut simulation = client.into_port();
        simulation.wait(AT_REST).unwrap();
        let way = moved(&mut simulation, Duration::from_secs(2));
        assert!(way < SETTLES, "died at {died:?}: {way}");
    }
}

/// A computer that sleeps, or a program that is held, goes on where it was as if no time had passed.
#[test]
fn a_host_that_was_frozen_finds_the_robot_at_rest_and_goes_on() {
    for seed in 0..30 {
        let mut random = fastrand::Rng::with_seed(seed);
        let moment = Duration::from_millis(random.u64(200..5000));
        let frozen = Duration::from_millis(random.u64(900..5000));
        let mut woken = false;
        let (_, simulation) = drive(simulated_robot(START, 1), legs(), START, 60, |client, _| {
            if woken || client.port_mut().now() < moment {
                return;
            }
            woken = true;
            client.port_mut().wait(frozen - Duration::from_millis(40)).unwrap();
            let way = moved(client.port_mut(), Duration::from_millis(40));
            assert!(frozen < AT_REST || way < STILL, "{moment:?} {frozen:?}: {way}");
        })
        .unwrap();
        assert!(woken && is_at_goal(simulation.truth().pose), "{moment:?} {frozen:?}");
    }
}

/// A port that keeps a copy of every frame to the robot.
struct Recorder {
    simulation: Simulation<InProcess>,
    frames: Vec<Vec<u8>>,
}

impl Read for Recorder {
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        self.simulation.read(buffer)
    }
}

impl Write for Recorder {
    fn write(&mut self, buffer: &[u8]) -> io::Result<usize> {
        self.frames.extend(buffer.split_inclusive(|byte| *byte == 0).map(<[u8]>::to_vec));
        self.simulation.write(buffer)
    }

    fn flush(&mut self) -> io::Result<()> {
        Ok(())
    }
}

impl Recorder {
    /// All that was ever said to the robot comes again, in some order.
    fn replay(&mut self, random: &mut fastrand::Rng) {
        let mut frames = self.frames.clone();
        random.shuffle(&mut frames);
        for frames in frames.chunks(3) {
            frames.iter().for_each(|frame| self.simulation.write_all(frame).unwrap());
            self.simulation.wait(POLL).unwrap();
        }
    }
}

#[test]
fn old_frames_that_come_late_move_no_robot_that_was_stopped_cleared_or_restarted() {
    let mut random = fastrand::Rng::with_seed(3);
    let mut client =
        LinkClient::new(Recorder { simulation: simulated_robot(START, 1), frames: Vec::new() }, 42);
    let mut mission = Mission::new(legs(), START);
    let (pause, stop) = (Duration::from_millis(1500), Duration::from_millis(3500));
    let mut ended = false;
    while !ended {
        let now = client.port_mut().simulation.now();
        ended = mission.step(&mut client, now).is_err();
        if now == pause {
            assert!(client.send(Command::Pause));
        } else if now == pause + Duration::from_millis(1000) {
            assert!(client.send(Command::Resume));
        } else if now >= stop {
            client.stop();
        }
        client.port_mut().simulation.wait(POLL).unwrap();
    }
    assert!(client.port_mut().frames.len() > 100);

    client.port_mut().replay(&mut random);
    assert!(moved(&mut client.port_mut().simulation, Duration::from_secs(1)) < STILL);
    assert_eq!(client.port_mut().simulation.firmware_mut().robot().state(), State::Stopped);

    let mut cleared = false;
    for _ in 0..200 {
        let now = client.port_mut().simulation.now();
        client.poll(now).unwrap();
        cleared = cleared || client.clear();
        client.port_mut().simulation.wait(POLL).unwrap();
    }
    assert_eq!(client.port_mut().simulation.firmware_mut().robot().state(), State::Idle);
    let mut port = client.into_port();
    let before = port.simulation.truth().pose;
    port.replay(&mut random);
    assert!(moved(&mut port.simulation, Duration::from_secs(1)) < STILL);

    port.simulation.firmware_mut().restart().unwrap();
    port.replay(&mut random);
    assert!(moved(&mut port.simulation, Duration::from_secs(1)) < STILL);
    let after = port.simulation.truth().pose;
    assert!((after.x - before.x).hypot(after.y - before.y) < STILL, "{before:?} {after:?}");
}

/// A port on which, from some moment on, the host hears nothing of the robot that would be said again.
struct Forgetful {
    simulation: Simulation<InProcess>,
    forgets: bool,
    heard: VecDeque<u8>,
    frame: Vec<u8>,
}

impl Read for Forgetful {
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        let mut bytes = [0; 512];
        while let Ok(length) = self.simulation.read(&mut bytes) {
            for byte in &bytes[..length] {
                self.frame.push(*byte);
                if *byte == 0 {
                    let frame = std::mem::take(&mut self.frame);
                    let mut decoder = Decoder::default();
                    let decoded = frame.iter().find_map(|byte| decoder.push::<Report>(*byte));
                    let reliable =
                        matches!(decoded, Some(Ok((header, _))) if header.sequence.is_some());
                    if !(self.forgets && reliable) {
                        self.heard.extend(frame);
                    }
                }
            }
        }
        if self.heard.is_empty() {
            return Err(io::ErrorKind::WouldBlock.into());
        }
        self.heard.read(buffer)
    }
}

impl Write for Forgetful {
    fn write(&mut self, buffer: &[u8]) -> io::Result<usize> {
        self.simulation.write(buffer)
    }

    fn flush(&mut self) -> io::Result<()> {
        Ok(())
    }
}

#[test]
fn a_leg_whose_end_was_never_heard_of_is_not_driven_again() {
    let (legs, simulation) = (legs(), simulated_robot(START, 1));
    let port = Forgetful { simulation, forgets: false, heard: VecDeque::new(), frame: Vec::new() };
    let mut client = LinkClient::new(port, 42);
    let mut mission = Mission::new(legs.clone(), START);
    let mut restarted = false;
    let error = loop {
        let port = client.port_mut();
        // On the second leg, well past the corner.
        if !restarted && port.simulation.truth().pose.y > 0.6 {
            restarted = true;
            port.simulation.firmware_mut().restart().unwrap();
        }
        let now = port.simulation.now();
        match mission.step(&mut client, now) {
            Err(error) => break error,
            Ok(events) => {
                assert!(!events.iter().any(|event| matches!(event, MissionEvent::LegDone(_))));
            }
        }
        client.port_mut().forgets = mission.has_begun();
        client.port_mut().simulation.wait(POLL).unwrap();
    };
    assert!(matches!(error, MissionError::Link(LinkError::Restarted(_))), "{error}");
    let Progress { next, pose } = mission.progress();
    assert_eq!(next, 1, "its words since the corner were of the second leg");
    assert_eq!(check_beside_leg(&legs, next, from_wire(pose)), Ok(()));
    assert!(check_beside_leg(&legs, 0, from_wire(pose)).is_err());
}

/// The host's milliseconds wrap after 49.7 days, the robot's control ticks after 248.
#[test]
fn clocks_that_wrap_in_the_middle_of_a_drive_change_nothing() {
    const HOST_WRAPS: Duration = Duration::from_millis(1 << 32);
    let wrap = Duration::from_millis(2500);
    let end = |robot_wraps: bool, host_wraps: bool| {
        let ticks = if robot_wraps { 0_u32.wrapping_sub(500) } else { 0 };
        let ahead = if host_wraps { HOST_WRAPS - wrap } else { Duration::ZERO };
        let pose = TruePose { x: 0.2, y: 0.2, heading: 0.5 };
        let base = WheeledBase::new(BaseParameters::seeded(1), pose);
        let robot = Simulation::new(InProcess::default().aged(ticks), base, None);
        let mut client = LinkClient::new(robot, 42);
        let mut mission = Mission::new(legs(), START);
        loop {
            let now = client.port_mut().now() + ahead;
            let events = mission.step(&mut client, now).unwrap();
            if events.iter().any(|event| matches!(event, MissionEvent::Done(_))) {
                return (client.port_mut().now(), client.into_port().truth().pose);
            }
            client.port_mut().wait(POLL).unwrap();
        }
    };
    let (took, pose) = end(false, false);
    assert!(took > wrap + Duration::from_secs(1) && is_at_goal(pose), "{took:?} {pose:?}");
    for (robot, host) in [(true, false), (false, true), (true, true)] {
        let (other, there) = end(robot, host);
        // Which of the beats of 20 ms comes first depends on the clock.
        assert!(other.abs_diff(took) <= Duration::from_millis(20), "{robot} {host} {other:?}");
        assert_eq!(there, pose, "{robot} {host}");
    }
}

/// A save may not cost a frame, nor a frame a save; what was kept last is what the next start reads.
#[test]
fn a_thousand_saves_on_a_busy_link_are_all_kept() {
    let base = WheeledBase::new(BaseParameters::seeded(1), TruePose::default());
    let mut client = LinkClient::new(Simulation::new(InProcess::default(), base, None), 42);
    let mut heard = VecDeque::new();
    let mut say = |client: &mut LinkClient<Simulation<InProcess>>, command: Command| {
        let mut sent = false;
        for _ in 0..200 {
            sent = sent || client.send(command);
            // Between the question and its answer the link carries all that it can.
            client.send(Command::GetParameters);
            client.port_mut().wait(POLL).unwrap();
            let now = client.port_mut().now();
            heard.extend(client.poll(now).unwrap());
            while let Some(report) = heard.pop_front() {
                match (command, report) {
                    (Command::SaveParameters, Report::ParametersSaved { sequence }) => {
                        return sequence;
                    }
                    (Command::SetParameters(wanted), Report::Parameters(has)) if wanted == has => {
                        return 0;
                    }
                    (_, Report::ParametersRefused(why)) => panic!("{why:?}"),
                    _ => {}
                }
            }
        }
        panic!("no answer to {command:?}")
    };
    for sequence in 1..=1000_u32 {
        let track = Metres(0.1 + 1e-5 * sequence as f32);
        let parameters = Parameters { track, ..Parameters::default() };
        say(&mut client, Command::SetParameters(parameters));
        assert_eq!(say(&mut client, Command::SaveParameters), sequence);
        if sequence % 100 == 0 {
            let flash = client.port_mut().firmware_mut().flash().clone();
            let started = InProcess::with_flash(Parameters::default(), 9, flash);
            let base = WheeledBase::new(BaseParameters::seeded(1), TruePose::default());
            let mut other = LinkClient::new(Simulation::new(started, base, None), 43);
            let answer = say(&mut other, Command::SetParameters(parameters));
            assert_eq!((answer, other.robot().unwrap().limits.track), (0, track));
        }
    }
    assert_eq!(client.statistics().lost, 0);
}
