//! The link's figures by the million, on virtual time:
//!
//! ```text
//! cargo run --release -p wmr-tests --example link_figures -- --legs 1000000 --frames 100000000 --seed 1
//! ```
//! Prints one line a figure and fails if one of them is not met.

use hil_sim::wire::{Faults, Pace};
use std::process::ExitCode;
use std::time::Duration;
use wmr_tests::damage::damage_frames;
use wmr_tests::link::drive_many;

fn main() -> ExitCode {
    let legs = argument("--legs").unwrap_or(1_000_000) as u32;
    let frames = argument("--frames").unwrap_or(100_000_000);
    let seed = argument("--seed").unwrap_or(1);
    let pace = Pace { latency: Duration::from_millis(5), ..Pace::default() };
    println!("wires: {:?}, {pace:?}, seed {seed}", Faults::HARSH);
    let tally = match drive_many(legs, Faults::HARSH, pace, seed) {
        Ok(tally) => tally,
        Err(error) => {
            eprintln!("{error}");
            return ExitCode::FAILURE;
        }
    };
    println!("legs: {tally:?}");
    let verdicts = damage_frames(frames, seed);
    println!("damaged frames: {verdicts:?}");
    let flawless = [tally.lost, tally.doubled, tally.out_of_order, tally.stuck, tally.silent];
    if flawless == [0; 5] && tally.driven == legs && verdicts.misread == 0 {
        ExitCode::SUCCESS
    } else {
        ExitCode::FAILURE
    }
}

/// The number behind an option.
fn argument(name: &str) -> Option<u64> {
    let mut arguments = std::env::args().skip_while(|argument| argument != name);
    arguments.nth(1)?.replace('_', "").parse().ok()
}
