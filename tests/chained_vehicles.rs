//! The chained form in n dimensions steers a car and a car with a trailer.

use wmr_tests::vehicles::{Car, CarWithTrailer, ChainedVehicle, steer};

/// The vehicles are integrated by a rule of second order in 2000 steps an interval.
const INTEGRATION: f64 = 1e-4;

const CAR: Car = Car { wheel_base: 0.3 };
const TRAIN: CarWithTrailer = CarWithTrailer { wheel_base: 0.3, drawbar: 0.4 };

fn assert_near<const N: usize>(real: [f64; N], wanted: [f64; N]) {
    let off = real.iter().zip(wanted).map(|(real, wanted)| (real - wanted).abs());
    assert!(off.fold(0.0, f64::max) < INTEGRATION, "{real:?} {wanted:?}");
}

#[test]
fn a_car_changes_its_lane_and_turns() {
    let start = [0.0, 0.0, 0.0, 0.0];
    for end in [[2.0, 0.5, 0.0, 0.0], [2.0, -0.3, 0.4, 0.1], [-1.5, 0.2, -0.3, 0.0]] {
        assert_near(steer(&CAR, [&start, &end], 2.0, |_, _| {}).unwrap(), end);
    }
}

#[test]
fn a_car_with_a_trailer_changes_its_lane_and_backs_up() {
    let start = [0.0, 0.0, 0.1, 0.05, 0.0];
    for end in [[3.0, 0.5, 0.0, 0.0, 0.0], [-3.0, -0.3, 0.2, 0.1, 0.05]] {
        assert_near(steer(&TRAIN, [&start, &end], 2.0, |_, _| {}).unwrap(), end);
    }
}

#[test]
fn a_configuration_and_its_chained_state_are_the_same() {
    for phi in [-0.6, 0.0, 0.4] {
        let car = [1.0, 2.0, 0.7, phi];
        assert_near(CAR.configuration(&CAR.chained(&car)), car);
        let train = [1.0, 2.0, -0.7, 0.3, phi];
        assert_near(TRAIN.configuration(&TRAIN.chained(&train)), train);
    }
}
