//! The flashed ELF reset in the middle of its legs, in the emulator; some minutes for fifty times:
//!
//! ```text
//! firmware/build && cargo run --release -p wmr-tests --example elf_resets -- 50
//! ```

use std::path::Path;
use std::process::ExitCode;
use wmr_tests::elf_resets::{Resets, reset_often};

const ELF: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/../target/firmware/pico.elf");

fn main() -> ExitCode {
    let resets = std::env::args().nth(1).and_then(|text| text.parse().ok()).unwrap_or(50);
    let tally = reset_often(Path::new(ELF), resets, 1);
    println!("{resets} resets in the middle of a leg: {tally:?}");
    let flawless =
        Resets { noticed: resets, at_rest: resets, resumed: resets, legs: resets.max(2) as u16 };
    if tally == flawless { ExitCode::SUCCESS } else { ExitCode::FAILURE }
}
