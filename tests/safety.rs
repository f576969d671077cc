//! What stops the robot over the link, what a camera changes, and what it keeps in its flash.
#![allow(clippy::unwrap_used, clippy::panic, reason = "helpers of tests fail as tests do")]

use hil_sim::base::{BaseParameters, Faults, TruePose, WheeledBase};
use hil_sim::in_process::{Flash, InProcess};
use hil_sim::simulation::{Firmware, Simulation};
use hil_sim::wire::FrameFault;
use protocol::message::{
    CameraPose, Command, Fault, PauseReason, Placement, PlanHeader, PoseRefusal, Report, State,
    plan_digest,
};
use protocol::motion::{Leg, Pose, Timing};
use protocol::parameters::{ParameterRefusal, Parameters};
use protocol::units::Metres;
use std::time::Duration;
use wmr::geometry::Point;
use wmr::legs::{DEFAULT_LIMITS, LegOptions, to_legs};
use wmr::link::LinkClient;
use wmr::link::mission::{MissionError, MissionEvent};
use wmr_tests::{POLL, drive, simulated_robot};

const START: Pose = Pose::new(0.0, 0.0, 0.0);

type Client = LinkClient<Simulation<InProcess>>;

fn two_metres() -> Vec<Leg> {
    let way = [Point::new(0.0, 0.0), Point::new(2.0, 0.0)];
    let options = LegOptions { timing: Timing::Limits, reverse: false };
    to_legs(&way, 0.0, None, &options, &DEFAULT_LIMITS)
}

/// Drives 2 m and lets `disturb` act once after 2 s, in the cruise.
fn drive_and(disturb: impl Fn(&mut Client)) -> (Result<Vec<MissionEvent>, MissionError>, Duration) {
    let mut ended = Duration::ZERO;
    let mut done = false;
    let result = drive(simulated_robot(START, 1), two_metres(), START, 60, |client, _| {
        ended = client.port_mut().now();
        if ended >= Duration::from_secs(2) && !done {
            done = true;
            disturb(client);
        }
    });
    (result.map(|(events, _)| events), ended)
}

fn speed(client: &mut Client) -> f64 {
    let before = client.port_mut().truth().pose.x;
    client.port_mut().wait(POLL).unwrap();
    (client.port_mut().truth().pose.x - before) / POLL.as_secs_f64()
}

#[test]
fn an_emergency_stop_cuts_the_drive_at_once() {
    let (result, ended) = drive_and(|client| {
        client.emergency_stop();
    });
    assert!(
        matches!(result, Err(MissionError::Fault { fault: Fault::EmergencyStop, .. })),
        "{result:?}"
    );
    // One poll to send it, a tick to obey, 20 ms until telemetry says so.
    assert!(ended <= Duration::from_millis(2040), "{ended:?}");
}

#[test]
fn an_emergency_stop_is_said_until_it_is_heard() {
    for lost in 1..10 {
        let (result, ended) = drive_and(|client| {
            client.port_mut().wires()[0].script(vec![FrameFault::Lost; lost]);
            client.emergency_stop();
        });
        assert!(
            matches!(result, Err(MissionError::Fault { fault: Fault::EmergencyStop, .. })),
            "{result:?}"
        );
        // As above, and 20 ms for each that was lost.
        assert!(ended <= Duration::from_millis(2040 + 20 * lost as u64), "{lost} {ended:?}");
    }
}

#[test]
fn a_blocked_wheel_is_a_fault_with_its_reason() {
    let (result, ended) = drive_and(|client| {
        let faults = Faults { blocked: [true, false], ..Faults::default() };
        client.port_mut().base_mut().set_faults(faults);
    });
    assert!(matches!(result, Err(MissionError::Fault { fault: Fault::Stall, .. })), "{result:?}");
    assert!(ended <= Duration::from_millis(2330), "{ended:?}");
}

#[test]
fn wheels_that_spin_before_a_camera_make_no_progress() {
    // Against a wall: all rim travel slips, and the camera says so ten times a second.
    let mut stuck = None;
    let result = drive(simulated_robot(START, 1), two_metres(), START, 60, |client, _| {
        let now = client.port_mut().now();
        if now < Duration::from_secs(2) {
            return;
        }
        stuck.get_or_insert(now);
        let faults = Faults { slip: [1.0; 2], ..Faults::default() };
        client.port_mut().base_mut().set_faults(faults);
        if now.as_millis() % 100 == 0 {
            see(client);
        }
        assert!(now < Duration::from_millis(3300), "still driving");
    });
    assert!(
        matches!(result, Err(MissionError::Fault { fault: Fault::NoProgress, .. })),
        "{:?}",
        result.err()
    );
}

/// Sends the robot its true pose of this moment.
fn see(client: &mut Client) {
    let TruePose { x, y, heading } = client.port_mut().truth().pose;
    let pose = Pose::new(x as f32, y as f32, heading as f32);
    // The simulation ticks every 5 ms from the start, so its clock is the robot's.
    let ticks = (client.port_mut().now().as_millis() / 5) as u32;
    client.send(Command::SetPose(CameraPose { ticks, pose }));
}

#[test]
fn a_camera_brings_a_misplaced_robot_to_its_goal() {
    let mut simulation = simulated_robot(START, 3);
    simulation.base_mut().place(TruePose { x: 0.03, y: -0.05, heading: 0.1 });
    let (_, simulation) = drive(simulation, two_metres(), START, 60, |client, _| {
        if client.port_mut().now().as_millis() % 100 == 0 {
            see(client);
        }
    })
    .unwrap();
    let pose = simulation.truth().pose;
    assert!((pose.x - 2.0).abs() < 0.002 && pose.y.abs() < 0.002, "{pose:?}");
}

#[test]
fn a_sinking_battery_slows_the_robot_and_then_stops_it() {
    let (result, _) = drive_and(|client| {
        assert!(speed(client) > 0.39);
        client.port_mut().firmware_mut().set_battery(4.3);
        client.port_mut().wait(Duration::from_millis(100)).unwrap();
        hear(client);
        client.port_mut().wait(Duration::from_millis(250)).unwrap();
        assert!((speed(client) - 0.24).abs() < 0.01, "{}", speed(client));
        client.port_mut().firmware_mut().set_battery(4.0);
    });
    let Err(MissionError::BatteryEmpty { volts: Some(volts) }) = result else {
        panic!("{result:?}")
    };
    assert!((4.0..4.2).contains(&volts), "{volts} V");
}

/// The battery of the parts list, nearly empty: no plan is begun, and the reason is the battery's.
#[test]
fn an_empty_battery_is_named_with_its_voltage() {
    let mut simulation = simulated_robot(START, 1);
    simulation.firmware_mut().set_battery(4.1);
    simulation.wait(Duration::from_secs(1)).unwrap();
    let result = drive(simulation, two_metres(), START, 20, |_, _| {}).map(|(events, _)| events);
    let Err(error @ MissionError::BatteryEmpty { .. }) = result else { panic!("{result:?}") };
    assert_eq!(error.to_string(), "the battery is empty (4.1 V)");
}

/// Four NiMH cells from freshly charged to nearly empty drive.
#[test]
fn the_battery_of_the_parts_list_drives() {
    for volts in [5.6, 4.8, 4.7] {
        let mut simulation = simulated_robot(START, 1);
        simulation.firmware_mut().set_battery(volts);
        simulation.wait(Duration::from_secs(1)).unwrap();
        assert!(drive(simulation, two_metres(), START, 60, |_, _| {}).is_ok(), "{volts} V");
    }
}

/// A robot that drives its two metres, from a plan sent by hand, so that every report can be seen.
fn driving() -> Client {
    let mut client = connected(Flash::default());
    let legs = two_metres();
    let (plan, count, digest) = (legs[0].plan, legs.len() as u16, plan_digest(&legs));
    let placement = Placement::Start(START);
    assert!(client.send(Command::PlanBegin(PlanHeader {
        plan,
        first: 0,
        count,
        digest,
        placement
    })));
    legs.into_iter().for_each(|leg| assert!(client.send(Command::PlanLeg(leg))));
    let accepted = answer(&mut client, Command::PlanCommit { plan });
    assert_eq!(accepted, Report::PlanAccepted { plan, end: count });
    wait(&mut client, 200);
    assert_eq!(client.telemetry().unwrap().state, State::Driving);
    client
}

fn wait(client: &mut Client, polls: u32) -> Vec<Report> {
    (0..polls).flat_map(|_| hear(client)).collect()
}

/// The robot's true pose now, moved by `dx` along x, as a camera would give it.
fn camera_pose(client: &mut Client, dx: f64) -> CameraPose {
    let TruePose { x, y, heading } = client.port_mut().truth().pose;
    let pose = Pose::new((x + dx) as f32, y as f32, heading as f32);
    CameraPose { ticks: (client.port_mut().now().as_millis() / 5) as u32, pose }
}

#[test]
fn a_robot_without_a_pose_takes_any_at_rest_and_then_only_near_ones() {
    let mut client = connected(Flash::default());
    let first = camera_pose(&mut client, 7.0);
    assert!(client.send(Command::SetPose(first)));
    assert_eq!(wait(&mut client, 10), []);
    assert!((client.telemetry().unwrap().pose.x.0 - 7.0).abs() < 1e-3);
    let far = camera_pose(&mut client, 6.0);
    let refused = answer(&mut client, Command::SetPose(far));
    assert_eq!(refused, Report::PoseRefused { ticks: far.ticks, reason: PoseRefusal::Implausible });
    let near = camera_pose(&mut client, 7.04);
    assert!(client.send(Command::SetPose(near)));
    assert_eq!(wait(&mut client, 10), []);
    assert!((client.telemetry().unwrap().pose.x.0 - 7.04).abs() < 1e-3);
}

#[test]
fn an_implausible_camera_pose_is_refused_and_moves_nothing() {
    let run = |jump: Option<f64>| {
        let mut client = driving();
        let near = camera_pose(&mut client, 0.0);
        assert!(client.send(Command::SetPose(near)));
        assert_eq!(wait(&mut client, 20), []);
        let mut seen = camera_pose(&mut client, jump.unwrap_or_default());
        if jump.is_none() {
            seen = near;
        }
        assert!(client.send(Command::SetPose(seen)));
        // In 0.3 s the limit of 0.8 m/s² lets a speed change by 0.24 m/s, the distance by 36 mm.
        let reports = wait(&mut client, 60);
        (seen.ticks, reports, client.port_mut().truth().pose)
    };
    let (_, reports, undisturbed) = run(None);
    assert_eq!(reports, []);
    // 50 mm and 0.1 s at 0.4 m/s are allowed for.
    for jump in [0.15, -0.15, 1.0] {
        let (ticks, reports, pose) = run(Some(jump));
        let reason = PoseRefusal::Implausible;
        assert_eq!(reports, [Report::PoseRefused { ticks, reason }], "{jump}");
        assert!((pose.x - undisturbed.x).abs() < 1e-3 && (pose.y - undisturbed.y).abs() < 1e-3);
    }
    let (_, reports, pose) = run(Some(0.05));
    assert_eq!(reports, []);
    assert!(undisturbed.x - pose.x > 0.005, "a plausible pose is followed: {pose:?}");
}

#[test]
fn a_robot_that_the_camera_keeps_seeing_elsewhere_stops_while_it_drives() {
    let mut client = driving();
    for refusal in 1..=3 {
        // 0.1 s apart the bounds grow by 40 mm each time.
        let far = camera_pose(&mut client, 0.6);
        assert!(client.send(Command::SetPose(far)));
        let refused = Report::PoseRefused { ticks: far.ticks, reason: PoseRefusal::Implausible };
        assert!(wait(&mut client, 20).contains(&refused));
        let state = client.telemetry().unwrap().state;
        let expected = if refusal < 3 { State::Driving } else { State::Faulted(Fault::Displaced) };
        assert_eq!(state, expected, "after {refusal} refusals");
    }
    // Cut from 0.4 m/s it rolls out.
    wait(&mut client, 200);
    let before = client.port_mut().truth().pose;
    wait(&mut client, 200);
    let after = client.port_mut().truth().pose;
    assert!((before.x - after.x).hypot(before.y - after.y) < 1e-3, "it rests");
}

#[test]
fn a_robot_that_pauses_waits_for_what_the_host_makes_of_refused_poses() {
    let mut client = driving();
    assert!(client.send(Command::Pause));
    for _ in 0..4 {
        let far = camera_pose(&mut client, 1.0);
        assert!(client.send(Command::SetPose(far)));
        let refused = Report::PoseRefused { ticks: far.ticks, reason: PoseRefusal::Implausible };
        assert!(wait(&mut client, 20).contains(&refused));
    }
    assert_eq!(client.telemetry().unwrap().state, State::Paused(PauseReason::Command));
}

#[test]
fn a_robot_that_pauses_stands_while_its_camera_corrects_it_and_goes_on_from_there() {
    let mut client = driving();
    assert!(client.send(Command::Pause));
    // From 0.4 m/s at 0.8 m/s² it rests after half a second.
    wait(&mut client, 200);
    let rests = client.port_mut().truth().pose;
    for dx in [0.01, -0.01, 0.02, 0.0, 0.02] {
        let seen = camera_pose(&mut client, dx);
        assert!(client.send(Command::SetPose(seen)));
        assert_eq!(wait(&mut client, 100), []);
        assert!((client.telemetry().unwrap().pose.x.0 - seen.pose.x.0).abs() < 1e-3, "taken");
        let TruePose { x, y, heading } = client.port_mut().truth().pose;
        // Less than an encoder's count.
        let moved = (x - rests.x).hypot(y - rests.y) + 0.06 * (heading - rests.heading).abs();
        assert!(moved < 1e-4, "{moved} m at {dx}");
    }
    assert!(client.send(Command::Resume));
    wait(&mut client, 2000);
    assert_eq!(client.telemetry().unwrap().state, State::Idle);
    // It took itself to be 20 mm further than it was.
    assert!((client.port_mut().truth().pose.x - 1.98).abs() < 2e-3);
}

fn connected(flash: Flash) -> Client {
    let base = WheeledBase::new(BaseParameters::seeded(1), TruePose::default());
    let robot = InProcess::with_flash(Parameters::default(), 1, flash);
    let mut client = LinkClient::new(Simulation::new(robot, base, None), 42);
    while client.robot().is_none() {
        hear(&mut client);
    }
    client
}

fn hear(client: &mut Client) -> Vec<Report> {
    client.port_mut().wait(POLL).unwrap();
    let now = client.port_mut().now();
    client.poll(now).unwrap()
}

fn answer(client: &mut Client, command: Command) -> Report {
    assert!(client.send(command));
    (0..100).flat_map(|_| hear(client)).next().unwrap()
}

#[test]
fn parameters_are_asked_for_set_and_kept_over_a_restart() {
    let mut client = connected(Flash::default());
    let Report::Parameters(mut parameters) = answer(&mut client, Command::GetParameters) else {
        panic!("no parameters");
    };
    assert_eq!(parameters, Parameters::default());
    parameters.track = Metres(0.1225);
    assert_eq!(
        answer(&mut client, Command::SetParameters(parameters)),
        Report::Parameters(parameters)
    );
    let saved = answer(&mut client, Command::SaveParameters);
    assert_eq!(saved, Report::ParametersSaved { sequence: 1 });
    let flash = client.port_mut().firmware_mut().flash().clone();
    let mut client = connected(flash);
    assert_eq!(client.robot().unwrap().limits.track, Metres(0.1225));
    assert_eq!(answer(&mut client, Command::GetParameters), Report::Parameters(parameters));
}

#[test]
fn parameters_that_make_no_sense_or_come_while_driving_are_refused() {
    let mut client = connected(Flash::default());
    let bad = Parameters { track: Metres(f32::NAN), ..Parameters::default() };
    let refusal = answer(&mut client, Command::SetParameters(bad));
    assert!(
        matches!(refusal, Report::ParametersRefused(ParameterRefusal::OutOfRange { field: 2, .. })),
        "{refusal:?}"
    );
    let mut client = driving();
    let refused = Report::ParametersRefused(ParameterRefusal::NotAtRest);
    let other = Parameters { track: Metres(0.1225), ..Parameters::default() };
    assert_eq!(answer(&mut client, Command::SetParameters(other)), refused);
    assert_eq!(answer(&mut client, Command::SaveParameters), refused);
    let kept = answer(&mut client, Command::GetParameters);
    assert_eq!(kept, Report::Parameters(Parameters::default()));
    assert_eq!(client.telemetry().unwrap().state, State::Driving);
}
