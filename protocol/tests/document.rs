//! `PROTOCOL.md` says what the types say: its tables are drawn again from them and compared.
//!
//! `UPDATE_GOLDEN=1 cargo test -p wmr-protocol --test document` rewrites them.
#![allow(clippy::unwrap_used, clippy::panic, reason = "what helps a test fails as a test does")]

use serde::Serialize;
use std::fmt::Write;
use wmr_protocol::frame::{Header, MAX_FRAME, encode};
use wmr_protocol::message::*;
use wmr_protocol::motion::*;
use wmr_protocol::parameters::{ParameterRefusal, Parameters};
use wmr_protocol::schema::SCHEMA_HASH;
use wmr_protocol::session::WINDOW;
use wmr_protocol::units::*;

const BEGIN: &str = "<!-- drawn from the types -->\n";
const END: &str = "<!-- end -->\n";
const SCHEMA: &str = include_str!("../src/schema.txt");

fn path() -> &'static str {
    concat!(env!("CARGO_MANIFEST_DIR"), "/PROTOCOL.md")
}

#[test]
fn the_tables_are_those_of_the_types() {
    let document = std::fs::read_to_string(path()).unwrap();
    let (before, rest) = document.split_once(BEGIN).unwrap();
    let (tables, after) = rest.split_once(END).unwrap();
    let drawn = numbers() + &messages();
    if std::env::var_os("UPDATE_GOLDEN").is_some() {
        std::fs::write(path(), [before, BEGIN, &drawn, END, after].concat()).unwrap();
        return;
    }
    assert!(tables == drawn, "UPDATE_GOLDEN=1 cargo test -p wmr-protocol --test document\n{drawn}");
}

#[test]
fn the_drawing_of_the_robot_names_every_state() {
    let document = std::fs::read_to_string(path()).unwrap();
    let (_, drawing) = document.split_once("## The robot's states").unwrap();
    let states = SCHEMA.split_once("\nState = enum\n").unwrap().1;
    for line in states.lines().take_while(|line| line.starts_with(' ')) {
        let name = line.split_whitespace().nth(1).unwrap();
        assert!(drawing.contains(name), "{name}");
    }
}

/// What ends of any two versions must understand; these bytes never change.
#[test]
fn the_frozen_part_is_frozen() {
    let header = Header { session: 0x0403_0201, sequence: Some(300), ack: 0x0605, ack_bits: 7 };
    let host = HostHello { version: 1, schema: 2, nonce: 3 };
    let robot = RobotHello {
        version: 1,
        schema: 2,
        host_nonce: 3,
        nonce: 4,
        board: Board::Pico2,
        firmware: [5, 6, 7],
        git: 8,
        limits: Limits {
            speed: MetresPerSecond(0.0),
            acceleration: MetresPerSecondSquared(0.0),
            track: Metres(1.0),
        },
        max_legs: 9,
        driven: Some(Driven { plan: 10, next: 11, end: 12 }),
        reset: ResetCause::Watchdog,
    };
    let hello = [&[0, 1, 2, 3, 4, 1, 5, 6, 7, 8][..], &[0; 10], &[0x80, 0x3F, 9, 1, 10, 11, 12, 2]];
    let telemetry = Telemetry {
        ticks: 1,
        pose: Pose::new(0.0001, -0.0001, 0.0),
        wheels: WheelSpeeds::default(),
        state: State::Stopped,
        leg: 2,
    };
    assert_eq!(bytes(&header), [1, 2, 3, 4, 1, 0xAC, 2, 5, 6, 7]);
    assert_eq!(bytes(&Command::Hello(host)), [0, 1, 2, 3]);
    assert_eq!(bytes(&Command::Heartbeat), [1]);
    assert_eq!(bytes(&Command::Stop { number: 9 }), [2, 9]);
    assert_eq!(bytes(&Command::Reboot(Reboot::Bootloader)), [3, 1]);
    assert_eq!(bytes(&Report::Hello(robot)), hello.concat());
    assert_eq!(bytes(&Report::Heartbeat { stop: 9 }), [1, 9]);
    assert_eq!(bytes(&Report::Telemetry(telemetry)), [2, 1, 2, 1, 0, 0, 0, 0, 3, 2]);
}

fn bytes(message: &impl Serialize) -> Vec<u8> {
    postcard::to_slice(message, &mut [0; MAX_FRAME]).unwrap().to_vec()
}

fn numbers() -> String {
    let mut text = String::from("\n| number | value |\n|---|---|\n");
    for (name, value) in [
        ("version of the rules", u64::from(PROTOCOL_VERSION)),
        ("longest frame, bytes with its zero", MAX_FRAME as u64),
        ("messages under way at once (window)", WINDOW as u64),
        ("legs that the robot keeps", MAX_LEGS as u64),
        ("a frame at least every, ms", HEARTBEAT_MILLISECONDS.into()),
        ("the robot stops after silence of, ms", SILENCE_LIMIT_MILLISECONDS.into()),
        ("control tick, ms", TICK_MILLISECONDS.into()),
    ] {
        writeln!(text, "| {name} | {value} |").unwrap();
    }
    writeln!(text, "| schema hash | 0x{SCHEMA_HASH:016x} |").unwrap();
    text
}

fn messages() -> String {
    let mut text = String::from(
        "\n| direction | tag | message | lane | frame, bytes |\n|---|---|---|---|---|\n",
    );
    rows(&mut text, "host → robot", "\nCommand = enum\n", &commands());
    rows(&mut text, "robot → host", "\nReport = enum\n", &reports());
    text + "\n"
}

/// Whether a message is numbered, and its shortest and longest sample.
type Row<T> = (bool, T, T);

fn rows<T: Serialize>(text: &mut String, direction: &str, schema: &str, samples: &[Row<T>]) {
    let listed = SCHEMA.split_once(schema).unwrap().1;
    let names: Vec<&str> = listed
        .lines()
        .take_while(|line| line.starts_with(' '))
        .filter(|line| !line.starts_with("   "))
        .collect();
    assert_eq!(names.len(), samples.len(), "a sample for each of {names:?}");
    for (name, (numbered, short, long)) in names.into_iter().zip(samples) {
        let name = name.split_whitespace().nth(1).unwrap();
        let sizes =
            [(0, 0, short), (u32::MAX, u16::MAX, long)].map(|(session, number, message)| {
                let sequence = numbered.then_some(number);
                let header = Header { session, sequence, ack: number, ack_bits: 0 };
                encode(&header, message, &mut [0; MAX_FRAME]).unwrap()
            });
        let mut content = [0; MAX_FRAME];
        let tag = postcard::to_slice(short, &mut content).unwrap()[0];
        let lane = if *numbered { "reliable" } else { "unreliable" };
        writeln!(text, "| {direction} | {tag} | {name} | {lane} | {}–{} |", sizes[0], sizes[1])
            .unwrap();
    }
}

fn leg(plan: u32, index: u16, goal_heading: Option<Radians>, timing: Timing) -> Leg {
    Leg {
        plan,
        index,
        start: POSE,
        goal: Position::new(1.0, 1.0),
        goal_heading,
        direction: Direction::Reverse,
        timing,
    }
}

const POSE: Pose = Pose::new(1.0, 1.0, 1.0);
const LONG: u32 = u32::MAX;

fn parameters(calibration: u32) -> Parameters {
    Parameters { calibration, ..Parameters::default() }
}

fn commands() -> Vec<Row<Command>> {
    let hello = |nonce| Command::Hello(HostHello { version: 2, schema: SCHEMA_HASH, nonce });
    let begin = |plan, number, placement| {
        let header = PlanHeader { plan, first: number, count: number, digest: plan, placement };
        Command::PlanBegin(header)
    };
    let slow = Timing::Paper { interval_ticks: LONG };
    let [stop, stops] = [1, u8::MAX].map(|number| Command::Stop { number });
    let [cut, cuts] = [1, u8::MAX].map(|number| Command::EmergencyStop { number });
    let [commit, commits] = [1, LONG].map(|plan| Command::PlanCommit { plan });
    let [cancel, cancels] = [1, LONG].map(|plan| Command::PlanCancel { plan });
    let [clear, clears] = [1, u8::MAX].map(|stop| Command::Clear { stop });
    let turn = Command::TurnWheel { wheel: Wheel::Right };
    let reboot = Command::Reboot(Reboot::Bootloader);
    let seen = |ticks| Command::SetPose(CameraPose { ticks, pose: POSE });
    let set = |calibration| Command::SetParameters(parameters(calibration));
    vec![
        (false, hello(1), hello(LONG)),
        (false, Command::Heartbeat, Command::Heartbeat),
        (false, stop, stops),
        (true, reboot, reboot),
        (true, begin(1, 1, Placement::Append), begin(LONG, u16::MAX, Placement::Start(POSE))),
        (
            true,
            Command::PlanLeg(leg(1, 1, None, Timing::Limits)),
            Command::PlanLeg(leg(LONG, u16::MAX, Some(Radians(1.0)), slow)),
        ),
        (true, commit, commits),
        (true, cancel, cancels),
        (true, Command::Pause, Command::Pause),
        (true, Command::Resume, Command::Resume),
        (true, clear, clears),
        (false, cut, cuts),
        (true, seen(1), seen(LONG)),
        (true, Command::GetParameters, Command::GetParameters),
        (true, set(0), set(LONG)),
        (true, Command::SaveParameters, Command::SaveParameters),
        (true, Command::Identify, Command::Identify),
        (true, turn, turn),
        (true, Command::Measure, Command::Measure),
    ]
}

fn reports() -> Vec<Row<Report>> {
    let limits = Limits {
        speed: MetresPerSecond(0.4),
        acceleration: MetresPerSecondSquared(0.8),
        track: Metres(0.12),
    };
    let hello = |nonce, number, driven| {
        Report::Hello(RobotHello {
            version: number,
            schema: SCHEMA_HASH,
            host_nonce: nonce,
            nonce,
            board: Board::Pico2,
            firmware: [1; 3],
            git: nonce,
            limits,
            max_legs: number,
            driven,
            reset: ResetCause::HardFault,
        })
    };
    let driven = Driven { plan: LONG, next: u16::MAX, end: u16::MAX };
    let telemetry = |ticks, distance, state, leg| {
        let wheels =
            WheelSpeeds { left: RadiansPerSecond(distance), right: RadiansPerSecond(distance) };
        let pose = Pose::new(distance, distance, 1.0);
        Report::Telemetry(Telemetry { ticks, pose, wheels, state, leg })
    };
    let done = |plan, end| Report::PlanDone { plan, end, pose: POSE };
    let result = |plan, index, ticks| Report::LegDone(LegResult { plan, index, ticks, pose: POSE });
    let stopped =
        |plan, next, state| Report::PlanStopped { plan, next, state, pose: POSE, wheel: None };
    let too_short = Refusal::TooShort(Infeasible { shortest: Seconds(1.0) });
    let refused = PlanRefusal::Leg { index: u16::MAX, refusal: too_short };
    let [heard, heards] = [1, u8::MAX].map(|stop| Report::Heartbeat { stop });
    let unseen = |ticks| Report::PoseRefused { ticks, reason: PoseRefusal::TooOld };
    let battery = Report::Battery(BatteryReport { level: BatteryLevel::Low, volts: 7.0 });
    let unset = Report::ParametersRefused(ParameterRefusal::NotAtRest);
    let out_of_range = ParameterRefusal::OutOfRange { field: 1, value: 1.0 };
    let identity = |chip| Report::Identity(Identity { chip, placed: true });
    let turned = |count| Report::WheelTurned { counts: [count; 2] };
    let measured = Report::Measured(Measurement {
        counts: [i32::MIN; 2],
        skipped: [u16::MAX; 2],
        battery: Some(7.0),
    });
    let saved = |sequence| Report::ParametersSaved { sequence };
    vec![
        (false, hello(1, 1, None), hello(LONG, u16::MAX, Some(driven))),
        (false, heard, heards),
        (
            false,
            telemetry(1, 0.0, State::Idle, 0),
            telemetry(LONG, 100.0, State::Paused(PauseReason::Silence), u16::MAX),
        ),
        (
            true,
            Report::PlanAccepted { plan: 1, end: 1 },
            Report::PlanAccepted { plan: LONG, end: u16::MAX },
        ),
        (
            true,
            Report::PlanRefused { plan: 1, reason: PlanRefusal::Empty },
            Report::PlanRefused { plan: LONG, reason: refused },
        ),
        (true, result(1, 1, 1), result(LONG, u16::MAX, LONG)),
        (true, done(1, 1), done(LONG, u16::MAX)),
        (
            true,
            stopped(1, 1, State::Stopped),
            Report::PlanStopped {
                plan: LONG,
                next: u16::MAX,
                state: State::Faulted(Fault::Stall),
                pose: POSE,
                wheel: Some(Wheel::Right),
            },
        ),
        (true, unseen(1), unseen(LONG)),
        (true, battery, battery),
        (true, Report::Parameters(parameters(0)), Report::Parameters(parameters(LONG))),
        (true, unset, Report::ParametersRefused(out_of_range)),
        (true, saved(1), saved(LONG)),
        (true, identity(1), identity(u64::MAX)),
        (true, turned(1), turned(i32::MIN)),
        (true, Report::Measured(Measurement::default()), measured),
    ]
}
