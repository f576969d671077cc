//! Unplugging and plugging in again, in real time; some minutes for a thousand times:
//!
//! ```text
//! cargo run --release -p tests --example replug_figures -- 1000
//! ```

use std::process::ExitCode;
use std::time::Duration;
use tests::replug::replug;

/// A robot is back this soon after its cable.
const BACK: Duration = Duration::from_secs(1);

fn main() -> ExitCode {
    let cycles = std::env::args().nth(1).and_then(|text| text.parse().ok()).unwrap_or(1000);
    let link = std::env::temp_dir().join(format!("wmr-replug-{}", std::process::id()));
    let mut times = replug(&link, cycles);
    times.sort();
    let at = |share: usize| times[(times.len() - 1) * share / 100];
    println!("{cycles} cycles: median {:?}, p99 {:?}, longest {:?}", at(50), at(99), at(100));
    if at(100) <= BACK { ExitCode::SUCCESS } else { ExitCode::FAILURE }
}
