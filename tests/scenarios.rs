//! The suite: every fault at every moment ends as its file says, in a named state.

use hil_sim::scenario::Moment;
use std::fs;
use std::path::Path;
use wmr_tests::scenarios::{all, run_all, table};

/// A cell that ends so has not ended.
const NO_END: [&str; 2] = ["endless", "moving"];

#[test]
fn every_fault_at_every_moment_ends_as_its_file_says() {
    let outcomes = run_all();
    let written = table(&outcomes);
    let golden = Path::new(env!("CARGO_MANIFEST_DIR")).join("golden/scenarios.txt");
    if std::env::var_os("UPDATE_GOLDEN").is_some() {
        fs::write(&golden, &written).unwrap();
    }
    let mut cells = 0;
    for ((name, scenario), (_, row)) in all().iter().zip(&outcomes) {
        for ((moment, expected), outcome) in scenario.expect.iter().zip(row) {
            assert_eq!(&outcome.code, expected, "{name} at {moment:?}: {outcome:?}");
            assert!(!NO_END.contains(&outcome.code.as_str()), "{name} at {moment:?}");
            cells += 1;
        }
        assert_eq!(scenario.expect.len(), Moment::ALL.len(), "{name}");
    }
    assert!(outcomes.len() >= 24 && cells >= 144, "{cells}");
    assert_eq!(written, fs::read_to_string(golden).unwrap());
}

#[test]
fn the_same_scenario_ends_the_same_way_to_the_last_bit() {
    let (_, scenario) = all().into_iter().find(|(name, _)| name == "pushed_seen").unwrap();
    let limits = scenario.parameters().limits();
    let run = || wmr_tests::scenarios::run(&scenario, Moment::Drive, scenario.in_process(), limits);
    assert_eq!(run(), run());
}
