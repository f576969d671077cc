//! Every small history of the link: each ends with the plan driven or with an error, soon.
//!
//! The wire is the adversary. Its choices for the first frames are tried out one and all; after them
//! it is perfect, or dead. So every state that host and robot can reach together within those frames
//! is reached, and none may last. [`search`] tries out fewer faults, but at any moment until the end.
#![allow(clippy::unwrap_used, clippy::panic, reason = "what helps a test fails as a test does")]

use hil_sim::wire::{Faults, FrameFault, Pace};
use protocol::frame::{Decoder, Header, MAX_FRAME, encode};
use protocol::message::{
    BatteryLevel, Board, Command, HostHello, Identity, PROTOCOL_VERSION, PauseReason, PlanRefusal,
    Reboot, Report, ResetCause, State,
};
use protocol::motion::TICK_MILLISECONDS;
use protocol::schema::SCHEMA_HASH;
use protocol::session::session_id;
use wmr::link::mission::{Mission, MissionError, MissionEvent};
use wmr_tests::POLL;
use wmr_tests::link::{Client, ORIGIN, STUCK, straight_legs, wired};
use wmr_tests::model::{Begin, search};

use firmware::robot::{Boot, Port, Robot, Sensors};

/// As many frames have every fault; three each make 3⁸ = 6561 histories.
const FRAMES: u32 = 8;
const FRAME_FAULTS: [FrameFault; 3] = [FrameFault::None, FrameFault::Lost, FrameFault::Delayed(2)];

/// The history of this number: to the robot and to the host, half of the frames each, or all of one.
fn histories() -> impl Iterator<Item = [Vec<FrameFault>; 2]> {
    (0..3u32.pow(FRAMES)).map(|number| {
        let fault = |frame: u32| FRAME_FAULTS[(number / 3u32.pow(frame) % 3) as usize];
        [0, 1].map(|way| (0..FRAMES).filter(|frame| frame % 2 == way).map(fault).collect())
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
    for script in histories() {
        let mut client = wired(Faults::default(), Pace::default(), 1);
        for (wire, script) in client.port_mut().wires().into_iter().zip(script.clone()) {
            wire.script(script);
        }
        assert!(matches!(end(&mut client, 1).as_deref(), Ok([0, 1])), "{script:?}");
    }
}

#[test]
fn every_history_between_two_plans_ends_at_the_goal() {
    for script in histories() {
        let mut client = wired(Faults::default(), Pace::default(), 1);
        end(&mut client, 1).unwrap();
        for (wire, script) in client.port_mut().wires().into_iter().zip(script.clone()) {
            wire.script(script);
        }
        assert!(matches!(end(&mut client, 2).as_deref(), Ok([0, 1])), "{script:?}");
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

#[test]
fn a_wire_that_dies_at_any_frame_is_an_error_and_the_robot_rests() {
    let dead = Faults { loss: 1.0, ..Faults::default() };
    for ways in [[true, false], [false, true], [true, true]] {
        let mut enough = false;
        for frames in 0..60 {
            let mut client = wired(dead, Pace::default(), 1);
            for (wire, dies) in client.port_mut().wires().into_iter().zip(ways) {
                wire.script(std::iter::repeat_n(FrameFault::None, frames));
                if !dies {
                    wire.change(Faults::default(), Pace::default());
                }
            }
            let end = end(&mut client, 1);
            // A mission that was not heard to its end is never taken for one, and frames only help.
            match &end {
                Ok(legs) => assert_eq!(legs, &[0, 1], "{ways:?} {frames}"),
                Err(error) => {
                    assert!(matches!(error, MissionError::Link(_)), "{ways:?} {frames} {error:?}");
                    assert!(!enough, "{ways:?}: fewer than {frames} frames were enough");
                }
            }
            enough = end.is_ok();
            assert!(frames > 0 || !enough, "{ways:?}: a mission without a frame");
            client.port_mut().wait(STUCK).unwrap();
            let state = client.port_mut().firmware_mut().robot().state();
            assert!(matches!(state, State::Idle | State::Paused(_)), "{ways:?} {frames} {state:?}");
        }
        assert!(enough, "{ways:?}: a whole mission takes fewer than 60 frames");
    }
}

#[test]
fn no_clear_that_was_sent_before_a_stop_undoes_it() {
    for late in 1..8 {
        let mut client = wired(Faults::default(), Pace::default(), 1);
        end(&mut client, 1).unwrap();
        client.port_mut().wires()[0].script([FrameFault::Delayed(late)]);
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
        assert_eq!(client.port_mut().firmware_mut().robot().state(), State::Stopped);
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
const BOOT: Boot = Boot { nonce: 6, board: Board::Simulated, reset: ResetCause::PowerOn, chip: 1 };

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

#[test]
fn a_restart_is_not_kept_for_the_end_of_a_drive() {
    let mut host = ByHand::new(hello());
    start(&straight_legs(1, 1, 0.5)).for_each(|command| host.send(command));
    host.listen(100);
    host.send(Command::Reboot(Reboot::Application));
    assert_eq!(host.listen(20).1, None);
    host.say(None, Command::Stop { number: 1 });
    assert_eq!(host.listen(1000).1, None, "its drive has ended");
    host.send(Command::Reboot(Reboot::Application));
    assert_eq!(host.listen(20).1, Some(Reboot::Application));
}

/// A line of 115 200 baud that is always full brings 57 bytes a tick.
#[test]
fn a_flood_stops_the_robot_before_a_stop_behind_it_arrives() {
    for flood in [&[0_u8; 57] as &[u8], &[1; 57], &[2, 3, 255, 0, 9, 1, 77]] {
        let mut host = ByHand::new(hello());
        start(&straight_legs(1, 1, 2.0)).for_each(|command| host.send(command));
        host.listen(20);
        assert_eq!(host.robot.state(), State::Driving);
        let mut ticks = 0;
        while host.robot.state() == State::Driving {
            // It lives, and so does the watch over silence.
            host.say(None, Command::Heartbeat);
            for piece in flood.iter().cycle().take(57).copied().collect::<Vec<_>>().chunks(7) {
                host.robot.receive(Port::Usb, piece);
            }
            host.listen(5);
            ticks += 1;
            assert!(ticks < 20, "100 ms");
        }
        assert!(ticks > 5, "a burst is no flood");
        assert_eq!(host.robot.state(), State::Paused(PauseReason::Silence));
    }
}

#[test]
fn a_robot_says_who_it_is_and_whether_it_was_told_where_it_stands() {
    let mut host = ByHand::new(hello());
    let identity = |placed| Report::Identity(Identity { chip: 1, placed });
    host.send(Command::Identify);
    assert!(host.listen(20).0.contains(&identity(false)));
    start(&straight_legs(1, 1, 0.01)).for_each(|command| host.send(command));
    host.listen(20);
    host.say(None, Command::Stop { number: 1 });
    host.send(Command::Identify);
    assert!(host.listen(20).0.contains(&identity(true)), "a stop does not move it");
}

#[test]
fn whoever_takes_a_robot_over_hears_of_its_empty_battery() {
    let mut robot = Robot::new(Default::default(), BOOT);
    for _ in 0..100 {
        robot.tick(&Sensors { battery: Some(4.1), ..Sensors::default() });
    }
    let mut host = ByHand { robot, session: 0, sequence: 0 };
    host.say(None, Command::Hello(hello()));
    host.session = session_id(HOST, BOOT.nonce);
    start(&straight_legs(1, 1, 0.5)).for_each(|command| host.send(command));
    let (reports, _) = host.listen(50);
    let said = reports.iter().position(|report| {
        matches!(report, Report::Battery(battery) if battery.level == BatteryLevel::Empty && (battery.volts - 4.1).abs() < 0.01)
    });
    let refused = Report::PlanRefused { plan: 1, reason: PlanRefusal::NotCleared };
    let refused = reports.iter().position(|report| *report == refused);
    assert!(said.is_some() && said < refused, "{reports:?}");
}
