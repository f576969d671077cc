//! The flashed ELF in the emulated Pico: it drives as the simulated robot does, and fails safely.
#![allow(clippy::unwrap_used, clippy::expect_used, reason = "helpers of tests fail as tests do")]

use hil_sim::base::{BaseParameters, TruePose, WheeledBase};
use hil_sim::emulator::{EmulatedPico, Fault, Step};
use hil_sim::simulation::Simulation;
use protocol::message::{self, Board, Command, Reboot, ResetCause, Telemetry};
use protocol::motion::{Leg, Pose, Timing};
use protocol::parameters::Parameters;
use protocol::units::Metres;
use std::f64::consts::TAU;
use std::path::Path;
use std::time::Duration;
use wmr::geometry::Point;
use wmr::legs::{DEFAULT_LIMITS, LegOptions, to_legs};
use wmr::link::mission::MissionError;
use wmr::link::{LinkClient, LinkError};
use wmr_tests::elf_resets::{Resets, reset_often};
use wmr_tests::lockstep::on_the_python_base;
use wmr_tests::spun::Spun;
use wmr_tests::{POLL, drive, simulated_robot};

const ELF: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/../target/firmware/pico.elf");

const START: Pose = Pose::new(0.2, 0.2, 0.5);
const GOAL: Point = Point::new(0.7, 0.6);
const GOAL_HEADING: f64 = 2.0;
/// As for the robot in process: a few encoder counts on either wheel, and what they turn the base by.
const POSITION_TOLERANCE: f64 = 0.002;
const HEADING_TOLERANCE: f64 = 0.005;

/// From a dead task or processor to motors without voltage: the firmware promises 150 ms.
const FAILURE_LIMIT: Duration = Duration::from_millis(150);
/// The watchdog's 100 ms less one control tick, so that a reset cannot come from elsewhere.
const WATCHDOG_LEAST: Duration = Duration::from_millis(94);

/// A hundredth of the control period.
const TICK_DELAY: Duration = Duration::from_micros(50);

/// Metres that a wheel of the default robot rolls in one count.
const COUNT: f64 = TAU * 0.035 / 1440.0;
const TRACK: f64 = 0.12;

fn pico() -> EmulatedPico {
    EmulatedPico::spawn(Path::new(ELF)).unwrap()
}

fn robot() -> Simulation<EmulatedPico> {
    let pose =
        TruePose { x: START.x.0.into(), y: START.y.0.into(), heading: START.heading.0.into() };
    Simulation::new(pico(), WheeledBase::new(BaseParameters::seeded(4), pose), None)
}

fn legs() -> Vec<Leg> {
    let options = LegOptions { timing: Timing::Limits, reverse: true };
    let way = [Point::new(0.2, 0.2), Point::new(0.6, 0.2), GOAL];
    to_legs(&way, START.heading.0.into(), Some(GOAL_HEADING), &options, &DEFAULT_LIMITS)
}

/// Drives until `after`, does `disturb` once, and returns how the mission ended.
fn disturbed(
    after: Duration,
    mut disturb: impl FnMut(&mut LinkClient<Simulation<EmulatedPico>>),
) -> MissionError {
    let mut done = false;
    drive(robot(), legs(), START, 60, |client, _| {
        if !done && client.port_mut().now() > after {
            done = true;
            disturb(client);
        }
    })
    .expect_err("the mission ended well in spite of all")
}

/// How long the motors still get voltage after a fault, and the state of the chip 0.2 s after it.
fn motors_after(fault: Fault) -> (Duration, Step) {
    let (mut driven, mut last) = (Duration::ZERO, Step::default());
    disturbed(Duration::from_millis(1000), |client| {
        let pico = client.port_mut().firmware_mut();
        let millisecond = Duration::from_millis(1);
        let before = pico.step(millisecond, &[], [400, 400]).unwrap();
        assert_ne!(before.duty, [0.0; 2], "the robot should be driving");
        pico.inject(fault).unwrap();
        for step in 1..=200 {
            last = pico.step(millisecond, &[], [400, 400]).unwrap();
            if last.duty != [0.0; 2] {
                driven = step * millisecond;
            }
        }
    });
    (driven, last)
}

#[test]
fn the_elf_drives_a_mission_to_its_goal_the_same_way_every_time() {
    let run = || {
        let mut poses: Vec<Telemetry> = Vec::new();
        let (_, mut simulation) = drive(robot(), legs(), START, 60, |client, _| {
            assert_eq!(client.robot().map_or(Board::Pico, |robot| robot.board), Board::Pico);
            poses.extend(client.telemetry());
        })
        .unwrap();
        let end = simulation.truth().pose;
        assert!(GOAL.distance(Point::new(end.x, end.y)) < POSITION_TOLERANCE, "{end:?}");
        assert!((end.heading - GOAL_HEADING).abs() < HEADING_TOLERANCE, "{end:?}");
        let counts = [0; 2];
        assert_eq!(simulation.firmware_mut().step(POLL, &[], counts).unwrap().resets, 0);
        poses
    };
    assert_eq!(run(), run());
}

/// What the emulator may differ by from the same logic in this process.
const SAME_POSITION: f64 = 0.0001;

#[test]
fn the_elf_ends_where_the_same_logic_in_process_does() {
    let (_, elf) = drive(robot(), legs(), START, 60, |_, _| {}).unwrap();
    let (_, in_process) = drive(simulated_robot(START, 4), legs(), START, 60, |_, _| {}).unwrap();
    let (elf, in_process) = (elf.truth().pose, in_process.truth().pose);
    let off = (elf.x - in_process.x).hypot(elf.y - in_process.y);
    println!("the ELF ends {:.4} mm from the logic in process", off * 1000.0);
    assert!(off <= SAME_POSITION, "{elf:?} {in_process:?}");
}

#[test]
fn the_elf_drives_somebody_elses_physics() {
    // The example's base begins at its own origin, looking along x.
    let options = LegOptions { timing: Timing::Limits, reverse: false };
    let way = [Point::new(0.0, 0.0), Point::new(0.3, 0.0), Point::new(0.3, 0.2)];
    let legs = to_legs(&way, 0.0, Some(0.0), &options, &DEFAULT_LIMITS);
    let [x, y, heading] = on_the_python_base(pico(), legs, Pose::default()).unwrap();
    assert!((x - 0.3).hypot(y - 0.2) < POSITION_TOLERANCE, "{x} {y}");
    assert!(heading.abs() < HEADING_TOLERANCE, "{heading}");
}

#[test]
fn a_frozen_processor_is_reset_by_the_watchdog() {
    let (driven, last) = motors_after(Fault::Freeze);
    assert!(driven > WATCHDOG_LEAST && driven < FAILURE_LIMIT, "{driven:?}");
    assert_eq!((last.resets, last.duty), (1, [0.0; 2]));
}

#[test]
fn a_frozen_link_task_is_reset_by_the_watchdog() {
    let (driven, last) = motors_after(Fault::FreezeThread);
    assert!(driven > WATCHDOG_LEAST && driven < FAILURE_LIMIT, "{driven:?}");
    assert_eq!((last.resets, last.duty), (1, [0.0; 2]));
}

#[test]
fn a_panic_and_a_hard_fault_switch_the_motors_off_at_once() {
    for fault in [Fault::Panic, Fault::HardFault] {
        let (driven, last) = motors_after(fault);
        assert!(driven <= Duration::from_millis(1), "{fault:?} {driven:?}");
        assert_eq!((last.resets, last.duty), (1, [0.0; 2]), "{fault:?}");
    }
}

#[test]
fn the_host_notices_a_restart_and_hears_why() {
    for (fault, cause) in [
        (None, ResetCause::PowerOn),
        (Some(Fault::Panic), ResetCause::Panic),
        (Some(Fault::HardFault), ResetCause::HardFault),
        (Some(Fault::FreezeThread), ResetCause::Watchdog),
    ] {
        let end = disturbed(Duration::from_millis(1000), |client| {
            let pico = client.port_mut().firmware_mut();
            match fault {
                None => pico.reset().unwrap(),
                Some(fault) => pico.inject(fault).unwrap(),
            }
        });
        assert!(
            matches!(end, MissionError::Link(LinkError::Restarted(said)) if said == cause),
            "{fault:?}: {end:?}"
        );
    }
}

#[test]
fn late_ticks_cut_the_drive_once_there_are_too_many() {
    // The processor stands still while the wheels roll on, and then goes on where it was.
    let late = |standstill: Duration| {
        let mut frozen = false;
        let robot = drive(robot(), legs(), START, 60, |client, _| {
            if !frozen && client.port_mut().now() > Duration::from_millis(1000) {
                frozen = true;
                let pico = client.port_mut().firmware_mut();
                pico.inject(Fault::Freeze).unwrap();
                client.port_mut().wait(standstill).unwrap();
                client.port_mut().firmware_mut().inject(Fault::None).unwrap();
            }
        });
        robot.map(|(_, simulation)| simulation.truth().pose)
    };
    let end = late(Duration::from_millis(17)).unwrap();
    assert!(GOAL.distance(Point::new(end.x, end.y)) < POSITION_TOLERANCE, "{end:?}");
    let end = late(Duration::from_millis(27)).map(|_| ());
    assert!(
        matches!(end, Err(MissionError::Fault { fault: message::Fault::TickOverrun, .. })),
        "{end:?}"
    );
}

/// A few of the fifty of `examples/elf_resets.rs`, one of each cause.
#[test]
fn a_reset_in_the_middle_of_a_leg_leaves_the_robot_at_rest_and_its_mission_to_be_resumed() {
    let tally = reset_often(Path::new(ELF), 3, 1);
    assert_eq!(tally, Resets { noticed: 3, at_rest: 3, resumed: 3, legs: 3 });
}

#[test]
fn the_boot_loader_is_entered_on_command_at_rest() {
    let mut client = LinkClient::new(robot(), 7);
    let mut asked = false;
    for _ in 0..100 {
        let now = client.port_mut().now();
        client.poll(now).unwrap();
        asked = asked || client.send(Command::Reboot(Reboot::Bootloader));
        client.port_mut().wait(POLL).unwrap();
    }
    assert!(asked, "the robot did not answer");
    let step = client.port_mut().firmware_mut().step(POLL, &[], [0; 2]).unwrap();
    assert!(step.boot_loader && !step.driver_enabled, "{step:?}");
}

#[test]
fn the_encoders_count_fifty_thousand_edges_a_second_exactly() {
    let (mut client, mut now) = (Spun::client(pico(), false), Duration::ZERO);
    Spun::turn(&mut client, 20, [0; 2], &mut now);
    Spun::turn(&mut client, 200, [250, 250], &mut now);
    Spun::turn(&mut client, 40, [0; 2], &mut now);
    let straight = client.telemetry().unwrap().pose;
    let way = 200.0 * 250.0 * COUNT;
    assert!((f64::from(straight.x.0) - way).abs() < COUNT / 2.0, "{straight:?} {way}");
    assert_eq!(straight.heading.0, 0.0);

    Spun::turn(&mut client, 200, [-245, 250], &mut now);
    Spun::turn(&mut client, 40, [0; 2], &mut now);
    let turned = client.telemetry().unwrap().pose.heading.0;
    let heading = 200.0 * 495.0 * COUNT / TRACK;
    let error = (f64::from(turned) - heading).rem_euclid(TAU);
    assert!(error.min(TAU - error) < COUNT / TRACK / 2.0, "{turned} {heading}");
}

#[test]
fn the_usb_port_answers_and_its_touch_starts_the_boot_loader() {
    let (mut client, mut now) = (Spun::client(pico(), true), Duration::ZERO);
    client.port_mut().pico.set_usb_line(115_200, true).unwrap();
    Spun::turn(&mut client, 40, [0; 2], &mut now);
    assert!(client.robot().is_some(), "no answer over USB");
    Spun::turn(&mut client, 40, [10, 10], &mut now);
    Spun::turn(&mut client, 40, [0; 2], &mut now);
    let pose = client.telemetry().unwrap().pose;
    assert!((f64::from(pose.x.0) - 400.0 * COUNT).abs() < COUNT / 2.0, "{pose:?}");

    let pico = &mut client.port_mut().pico;
    for open in [true, false] {
        pico.set_usb_line(1200, open).unwrap();
        let step = pico.step(Duration::from_millis(50), &[], [400, 400]).unwrap();
        assert_eq!(step.boot_loader, !open);
    }
}

/// On its own battery a board is not told that its cable is pulled: what waits to be sent waits on.
#[test]
fn a_pulled_usb_cable_leaves_the_other_port_and_comes_back() {
    let (mut client, mut now) = (Spun::client(pico(), true), Duration::ZERO);
    client.port_mut().pico.set_usb_line(115_200, true).unwrap();
    Spun::turn(&mut client, 40, [0; 2], &mut now);
    assert!(client.robot().is_some(), "no answer over USB");
    client.port_mut().pico.unplug_usb().unwrap();
    let mut port = client.into_port();
    (port.usb, port.to_robot) = (false, Vec::new());
    port.to_host.clear();
    let mut client = LinkClient::new(port, 8);
    Spun::turn(&mut client, 40, [0; 2], &mut now);
    assert!(client.robot().is_some(), "no answer over the UART");
    let parameters = Parameters { track: Metres(0.1225), ..Parameters::default() };
    assert!(client.send(Command::SetParameters(parameters)), "it may take the robot over");
    Spun::turn(&mut client, 40, [0; 2], &mut now);

    let mut port = client.into_port();
    (port.usb, port.to_robot) = (true, Vec::new());
    port.to_host.clear();
    port.pico.set_usb_line(115_200, true).unwrap();
    let mut client = LinkClient::new(port, 9);
    Spun::turn(&mut client, 60, [0; 2], &mut now);
    let robot = client.robot().expect("an answer over USB after it was plugged in again");
    assert_eq!(robot.limits.track, Metres(0.1225));
    assert_eq!(client.port_mut().pico.step(POLL, &[], [0; 2]).unwrap().resets, 0);
}

#[test]
fn noise_on_both_ports_delays_no_tick() {
    let mut pico = pico();
    pico.set_usb_line(115_200, true).unwrap();
    let mut noise = (0_u32..).map(|index| (index.wrapping_mul(0x9e37_79b1) >> 24) as u8);
    let mut ticks = Vec::new();
    for _ in 0..200 {
        // As much as the UART's line carries in this time, and more than the firmware takes from USB.
        let uart: Vec<u8> = noise.by_ref().take(57).collect();
        let usb: Vec<u8> = noise.by_ref().take(150).collect();
        pico.send_usb(&usb);
        let step = pico.step(POLL, &uart, [0; 2]).unwrap();
        assert_eq!(step.resets, 0);
        ticks.extend(step.ticks);
    }
    for pair in ticks.windows(2) {
        let period = pair[1].start - pair[0].start;
        assert!(period.abs_diff(POLL) < TICK_DELAY, "{period:?}");
    }
    assert!(ticks.len() >= 198, "{}", ticks.len());
    // Nothing of it is left for the next host to wait behind.
    let (mut client, mut now) = (Spun::client(pico, false), Duration::ZERO);
    Spun::turn(&mut client, 40, [0; 2], &mut now);
    assert!(client.robot().is_some(), "no answer within 0.2 s of the noise");
}

#[test]
fn a_mission_needs_no_alarm_of_the_timer() {
    // One that is lost would freeze whatever waits for any of them.
    let mut lost = false;
    let (_, mut simulation) = drive(robot(), legs(), START, 60, |client, _| {
        if !lost && client.port_mut().now() > Duration::from_millis(1000) {
            lost = true;
            client.port_mut().firmware_mut().inject(Fault::LostAlarms).unwrap();
        }
    })
    .unwrap();
    let end = simulation.truth().pose;
    assert!(GOAL.distance(Point::new(end.x, end.y)) < POSITION_TOLERANCE, "{end:?}");
    assert_eq!(simulation.firmware_mut().step(POLL, &[], [0; 2]).unwrap().resets, 0);
}

#[test]
fn an_encoder_that_is_too_fast_is_known_to_lose_counts() {
    let (mut client, mut now) = (Spun::client(pico(), false), Duration::ZERO);
    let skipped = |client: &mut LinkClient<Spun>, now: &mut Duration| {
        assert!(client.send(Command::Measure));
        for _ in 0..20 {
            let port = client.port_mut();
            let step = port.pico.step(POLL, &std::mem::take(&mut port.to_robot), port.counts);
            port.to_host.extend(step.unwrap().uart_out);
            *now += POLL;
            for report in client.poll(*now).unwrap() {
                if let message::Report::Measured(measured) = report {
                    return measured.skipped;
                }
            }
        }
        unreachable!("no answer")
    };
    Spun::turn(&mut client, 40, [0; 2], &mut now);
    Spun::turn(&mut client, 20, [250, -250], &mut now);
    assert_eq!(skipped(&mut client, &mut now), [0; 2], "50 000 edges a second are slow enough");
    // An edge each 2 us on the right wheel: several within a sample.
    Spun::turn(&mut client, 20, [250, 2500], &mut now);
    let [left, right] = skipped(&mut client, &mut now);
    assert!(left == 0 && (18..=22).contains(&right), "{left} {right}");
}

#[test]
fn saved_parameters_outlive_the_power() {
    let (mut client, mut now) = (Spun::client(pico(), false), Duration::ZERO);
    Spun::turn(&mut client, 40, [0; 2], &mut now);
    let parameters = Parameters { track: Metres(0.1225), ..Parameters::default() };
    assert!(client.send(Command::SetParameters(parameters)));
    assert!(client.send(Command::SaveParameters));
    Spun::turn(&mut client, 60, [0; 2], &mut now);
    let mut port = client.into_port();
    port.pico.reset().unwrap();
    let mut client = LinkClient::new(port, 8);
    Spun::turn(&mut client, 40, [0; 2], &mut now);
    assert_eq!(client.robot().unwrap().limits.track, Metres(0.1225));
}
