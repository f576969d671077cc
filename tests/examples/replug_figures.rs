//! Unplugging and plugging in again, in real time; some minutes for a thousand times:
//!
//! ```text
//! cargo run --release -p wmr-tests --example replug_figures -- 1000
//! ```

use std::process::ExitCode;
use std::time::Duration;
use wmr_tests::replug::replug;

/// A robot is back this soon after its cable.
const BACK: Duration = Duration::from_secs(1);

fn main() -> ExitCode {
    let cycles = std::env::args().nth(1).and_then(|text| text.parse().ok()).unwrap_or(1000);
    let link = std::env::temp_dir().join(format!("wmr-replug-{}", std::process::id()));
    let mut times = replug(&link, cycles);
    times.sort();
    let at = |permille: usize| times[(times.len() - 1) * permille / 1000];
    println!("{cycles} cycles, from the cable's return to the robot's second word:");
    for permille in [0, 250, 500, 900, 990, 999, 1000] {
        println!("{:5.1} %: {:6.1} ms", permille as f64 / 10.0, at(permille).as_secs_f64() * 1e3);
    }
    let late = times.iter().filter(|time| **time > BACK).count();
    println!("later than {BACK:?}: {late}");
    if late == 0 { ExitCode::SUCCESS } else { ExitCode::FAILURE }
}
