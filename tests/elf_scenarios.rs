//! Cells of the suite on the flashed ELF: the same ends as the logic in process has.
#![allow(clippy::unwrap_used, reason = "helpers of tests fail as tests do")]

use hil_sim::emulator::EmulatedPico;
use hil_sim::scenario::Moment;
use std::path::Path;
use wmr_tests::scenarios::{all, run};

const ELF: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/../target/firmware/pico.elf");

/// What only a board can get wrong is at the border to it: wire, power, battery, encoders, motors.
const FAULTS: [&str; 12] = [
    "battery_empty",
    "battery_weak",
    "encoder_reversed",
    "encoder_stuck",
    "encoders_swapped",
    "link_break",
    "link_cut",
    "link_half_lost",
    "pushed_seen",
    "robot_brown_out",
    "robot_reset",
    "wheel_blocked",
];

fn run_at(moment: Moment) {
    let scenarios = all();
    for fault in FAULTS {
        let (_, scenario) = scenarios.iter().find(|(name, _)| name == fault).unwrap();
        let simulation = scenario.with(EmulatedPico::spawn(Path::new(ELF)).unwrap());
        let outcome = run(scenario, moment, simulation, scenario.parameters().limits());
        let expected = scenario.expect.iter().find(|(at, _)| *at == moment).unwrap();
        println!("{fault} at {moment:?}: {} after {:?}", outcome.code, outcome.duration);
        assert_eq!(outcome.code, expected.1, "{fault} at {moment:?}: {outcome:?}");
    }
}

#[test]
fn twelve_faults_in_the_first_turn_end_as_their_files_say() {
    run_at(Moment::FirstTurn);
}

#[test]
fn twelve_faults_on_the_straight_end_as_their_files_say() {
    run_at(Moment::Drive);
}

#[test]
fn twelve_faults_in_a_pause_end_as_their_files_say() {
    run_at(Moment::Paused);
}
