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

/// A wheel that slips near the end of a leg leaves no time for a camera of 5 Hz to correct it, so here
/// some miss, and the margin of 10 mm is not always enough; more must not.
#[test]
fn slipping_wheels_are_mostly_borne_with_a_camera() {
    let tally = run(Envelope::B, 1_000_000, MISSIONS);
    assert_eq!(tally.driven, MISSIONS);
    assert!(f64::from(tally.reached) >= 0.9 * f64::from(MISSIONS), "{:?}", tally.others);
    assert!(tally.collided <= 3 && tally.least_gap > -0.005, "{tally:?}");
    assert!(!tally.others.contains_key("endless"));
}
