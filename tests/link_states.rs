//! Every small history of the link: each ends with the plan driven or with an error, soon.
//!
//! The wire is the adversary. Its choices for the first frames are tried out one and all; after them
//! it is perfect, or dead. So every state that host and robot can reach together within those frames
//! is reached, and none may last. [`search`] tries out fewer faults, but at any moment until the end.
#![allow(clippy::unwrap_used, clippy::panic, reason = "what helps a test fails as a test does")]

use hil_sim::wire::{Fate, Faults, Pace};
use protocol::frame::{Decoder, Header, MAX_FRAME, encode};
use protocol::message::{
    Board, Command, HostHello, PROTOCOL_VERSION, PlanRefusal, Reboot, Report, ResetCause, State,
};
use protocol::motion::TICK_MILLISECONDS;
use protocol::schema::SCHEMA_HASH;
use protocol::session::session_id;
use wmr::link::mission::{Mission, MissionError, MissionEvent};
use wmr_tests::POLL;
use wmr_tests::link::{Client, ORIGIN, STUCK, straight_legs, wired};
use wmr_tests::model::{Begin, search};

use firmware::robot::{Boot, Port, Robot, Sensors};

/// As many frames have every fate; three fates each make 3⁸ = 6561 histories.
const FRAMES: u32 = 8;
const FATES: [Fate; 3] = [Fate::Arrive, Fate::Vanish, Fate::Late(2)];

/// The history of this number: to the robot and to the host, half of the frames each, or all of one.
fn histories() -> impl Iterator<Item = [Vec<Fate>; 2]> {
    (0..3u32.pow(FRAMES)).map(|number| {
        let fate = |frame: u32| FATES[(number / 3u32.pow(frame) % 3) as usize];
        [0, 1].map(|way| (0..FRAMES).filter(|frame| frame % 2 == way).map(fate).collect())
    })
}

/// How a mission of two legs ends.
fn end(client: &mut Client, plan: u32) -> Result<Vec<u16>, MissionError> {
    let mut mission = Mission::new(straight_legs(plan, 2, 0.0), ORIGIN);
    let start = client.port_mut().now();
    let mut ended = Vec::new();
    loop {
        let now = client.port_mut().now();
        for event in mission.step(client, now)? {
            match event {
                MissionEvent::LegDone(result) => ended.push(result.index),
                MissionEvent::Done(_) => return Ok(ended),
                _ => {}
            }
        }
        assert!(now - start < STUCK, "stuck with {ended:?}");
        client.port_mut().wait(POLL).unwrap();
    }
}

#[test]
fn every_history_of_the_first_frames_ends_at_the_goal() {
    for fates in histories() {
        let mut client = wired(Faults::default(), Pace::default(), 1);
        for (wire, fates) in client.port_mut().wires().into_iter().zip(fates.clone()) {
            wire.ordain(fates);
        }
        assert!(matches!(end(&mut client, 1).as_deref(), Ok([0, 1])), "{fates:?}");
    }
}

#[test]
fn every_history_between_two_plans_ends_at_the_goal() {
    for fates in histories() {
        let mut client = wired(Faults::default(), Pace::default(), 1);
        end(&mut client, 1).unwrap();
        for (wire, fates) in client.port_mut().wires().into_iter().zip(fates.clone()) {
            wire.ordain(fates);
        }
        assert!(matches!(end(&mut client, 2).as_deref(), Ok([0, 1])), "{fates:?}");
    }
}

/// Three faults take minutes: `cargo run --release -p wmr-tests --example link_states -- 3`.
#[test]
fn every_history_with_two_faults_at_any_moment_ends_at_the_goal() {
    for begin in [Begin::Fresh, Begin::BetweenPlans] {
        let found = search(begin, 2);
        // A search that met fewer states has not looked everywhere.
        assert!(found.states > 5_000 && found.restarted > 1_000, "{begin:?} {found:?}");
    }
}

/// A whole mission of two legs needs at least this many frames. To the robot: hello, and legs with the
/// start of the plan. To the host: hello, acceptance, the end of the legs.
const LEAST: [usize; 2] = [2, 3];

/// By then a mission of two legs that each take a tick has been over for long.
const MOST: usize = 60;

#[test]
fn a_wire_that_dies_before_the_mission_is_over_is_an_error_and_the_robot_rests() {
    let dead = Faults { loss: 1.0, ..Faults::default() };
    for dying in [[true, false], [false, true], [true, true]] {
        // With every frame more that arrives, the mission comes at least as far.
        let mut enough = None;
        for frames in 0..MOST {
            let mut client = wired(dead, Pace::default(), 1);
            for (wire, dies) in client.port_mut().wires().into_iter().zip(dying) {
                wire.ordain(std::iter::repeat_n(Fate::Arrive, frames));
                if !dies {
                    wire.change(Faults::default(), Pace::default());
                }
            }
            match end(&mut client, 1) {
                Ok(ended) => {
                    assert_eq!(ended, [0, 1], "{dying:?} {frames}");
                    enough.get_or_insert(frames);
                }
                Err(MissionError::Link(_)) => {
                    assert_eq!(enough, None, "{dying:?} {frames}: fewer frames were enough");
                }
                other => panic!("{dying:?} {frames} {other:?}"),
            }
            client.port_mut().wait(STUCK).unwrap();
            let state = client.port_mut().brain_mut().robot().state();
            assert!(
                matches!(state, State::Idle | State::Paused(_)),
                "{dying:?} {frames} {state:?}"
            );
        }
        let least = dying.into_iter().zip(LEAST).filter_map(|(dies, least)| dies.then_some(least));
        let least = least.max().unwrap();
        let enough = enough.unwrap();
        assert!((least..MOST / 2).contains(&enough), "{dying:?} {enough}");
    }
}

#[test]
fn no_clear_that_was_sent_before_a_stop_undoes_it() {
    for late in 1..8 {
        let mut client = wired(Faults::default(), Pace::default(), 1);
        end(&mut client, 1).unwrap();
        client.port_mut().wires()[0].ordain([Fate::Late(late)]);
        assert!(client.clear());
        let now = client.port_mut().now();
        client.poll(now).unwrap();
        client.stop();
        for _ in 0..200 {
            client.port_mut().wait(POLL).unwrap();
            let now = client.port_mut().now();
            client.poll(now).unwrap();
        }
        assert_eq!(client.unacknowledged(), 0);
        assert_eq!(client.port_mut().brain_mut().robot().state(), State::Stopped);
        assert!(client.clear(), "the robot has heard of the stop");
    }
}

/// A robot, and a host whose frames are written by hand.
struct ByHand {
    robot: Robot,
    session: u32,
    sequence: u16,
}

const HOST: u32 = 5;
const BOOT: Boot = Boot { nonce: 6, board: Board::Simulated, reset: ResetCause::PowerOn };

impl ByHand {
    fn new(hello: HostHello) -> Self {
        let robot = Robot::new(Default::default(), BOOT);
        let mut host = Self { robot, session: 0, sequence: 0 };
        host.say(None, Command::Hello(hello));
        host.session = session_id(hello.nonce, BOOT.nonce);
        host
    }

    fn say(&mut self, sequence: Option<u16>, command: Command) {
        let header = Header { session: self.session, sequence, ..Header::default() };
        let mut frame = [0; MAX_FRAME];
        let length = encode(&header, &command, &mut frame).unwrap();
        self.robot.receive(Port::Usb, &frame[..length]);
    }

    fn send(&mut self, command: Command) {
        self.say(Some(self.sequence), command);
        self.sequence += 1;
    }

    /// What the robot says within `milliseconds`, and whether it asks for a restart.
    fn listen(&mut self, milliseconds: u32) -> (Vec<Report>, Option<Reboot>) {
        let (mut reports, mut reboot, mut decoder) = (Vec::new(), None, Decoder::default());
        for _ in 0..milliseconds / TICK_MILLISECONDS {
            reboot = reboot.or(self.robot.tick(&Sensors::default()).reboot);
            let mut frame = [0; MAX_FRAME];
            loop {
                let length = self.robot.transmit(Port::Usb, &mut frame);
                if length == 0 {
                    break;
                }
                let heard = frame[..length].iter().filter_map(|byte| decoder.push::<Report>(*byte));
                reports.extend(heard.map(|frame| frame.unwrap().1));
            }
        }
        (reports, reboot)
    }
}

fn hello() -> HostHello {
    HostHello { version: PROTOCOL_VERSION, schema: SCHEMA_HASH, nonce: HOST }
}

fn start(legs: &[protocol::motion::Leg]) -> impl Iterator<Item = Command> {
    let placement = protocol::message::Placement::Start(ORIGIN);
    wmr::link::mission::batch(1, 0, legs, placement).into_iter()
}

#[test]
fn another_schema_may_look_stop_and_flash_but_not_drive() {
    for wrong in [
        HostHello { schema: SCHEMA_HASH ^ 1, ..hello() },
        HostHello { version: PROTOCOL_VERSION + 1, ..hello() },
    ] {
        let mut host = ByHand::new(wrong);
        start(&straight_legs(1, 1, 0.5)).for_each(|command| host.send(command));
        let (reports, _) = host.listen(100);
        let refused = Report::PlanRefused { plan: 1, reason: PlanRefusal::WrongProtocol };
        assert!(reports.contains(&refused), "{reports:?}");
        assert!(reports.iter().any(|report| matches!(report, Report::Telemetry(_))));
        assert_eq!(host.robot.state(), State::Idle);
        host.say(None, Command::Stop { number: 1 });
        assert_eq!(host.robot.state(), State::Stopped);
        assert!(host.listen(20).0.contains(&Report::Heartbeat { stop: 1 }));
        host.send(Command::Reboot(Reboot::Bootloader));
        assert_eq!(host.listen(20).1, Some(Reboot::Bootloader));
    }
}

#[test]
fn a_hello_of_a_retired_host_opens_nothing() {
    let mut host = ByHand::new(hello());
    let old = host.session;
    let new = HostHello { nonce: 77, ..hello() };
    host.say(None, Command::Hello(new));
    host.session = session_id(77, BOOT.nonce);
    start(&straight_legs(1, 1, 0.5)).for_each(|command| host.send(command));
    host.listen(100);
    assert_eq!(host.robot.state(), State::Driving);
    host.say(None, Command::Hello(hello()));
    host.say(None, Command::Hello(new));
    assert_eq!(host.robot.state(), State::Driving, "a late hello is not a new host");
    host.session = old;
    host.say(None, Command::Heartbeat);
    let (reports, _) = host.listen(20);
    assert!(matches!(reports[..], [Report::Hello(hello), ..] if hello.host_nonce == 77));
    assert!(matches!(reports[0], Report::Hello(hello) if hello.driven.is_some()));
}
