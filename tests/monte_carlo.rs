//! Random arenas driven on bases that are slightly off; the example of the same name drives more.

use wmr_tests::monte_carlo::{Envelope, run};

const MISSIONS: u32 = 250;

/// No collision, 99.5 % within 10 mm, and the others end too.
#[test]
fn small_errors_are_borne_without_a_camera() {
    let tally = run(Envelope::A, 0, MISSIONS);
    assert_eq!((tally.driven, tally.collided), (MISSIONS, 0), "{tally:?}");
    assert!(f64::from(tally.reached) >= 0.995 * f64::from(MISSIONS), "{:?}", tally.others);
    assert!(!tally.others.contains_key("endless"));
}

/// The same with slipping wheels: a way as far from shapes as a slip pushes the robot aside, and a camera that is
/// asked once more at the end.
#[test]
fn slipping_wheels_are_borne_with_a_camera() {
    let tally = run(Envelope::B, 1_000_000, MISSIONS);
    assert_eq!((tally.driven, tally.collided), (MISSIONS, 0), "{tally:?}");
    assert!(f64::from(tally.reached) >= 0.995 * f64::from(MISSIONS), "{:?}", tally.others);
    assert!(!tally.others.contains_key("endless"));
}

/// V = 0.4 m/s, b = 0.12 m: 16 mm lost in a slip turn the robot by 0.1333; 0.4 s at 0.4 m/s are 160 mm.
#[test]
fn the_margin_of_a_slip_by_hand() {
    assert!((Envelope::B.margin() - 0.01 - 0.16 * 0.016 / 0.12).abs() < 1e-6);
}
