//! Prints the controller's figures at the size promised; some minutes.
//!
//! ```text
//! cargo run --release -p wmr-tests --example figures            all
//! cargo run --release -p wmr-tests --example figures slip time  some
//! ```

use std::process::ExitCode;
use wmr_tests::figures::{self, Figure, Size};

type Measure = fn(Size) -> Vec<Figure>;

/// Name, title and measurement of each table.
const TABLES: [(&str, &str, Measure); 10] = [
    ("accuracy", "Ideal wheels and single precision", figures::accuracy::measure),
    ("headings", "All headings", figures::headings::measure),
    ("time", "Time against bang-bang", figures::time::measure),
    ("error_model", "Errors of the floor", figures::error_model::measure),
    ("slip", "Slip and camera", figures::slip::measure),
    ("pause", "Pause and stop", figures::pause::measure),
    ("stall", "Stall, encoders and false alarms", figures::stall::measure),
    ("calibration", "Calibration of the base", figures::calibration::measure),
    ("scrub", "Calibration of a base that scrubs", figures::scrub::measure),
    ("limits", "Limits of speed and acceleration", figures::limits::measure),
];

fn main() -> ExitCode {
    let wanted: Vec<String> = std::env::args().skip(1).collect();
    let mut kept = true;
    for (name, title, measure) in TABLES {
        if wanted.is_empty() || wanted.iter().any(|wanted| wanted == name) {
            let table = measure(Size::Full);
            figures::print(title, &table);
            kept &= table.iter().all(Figure::is_kept);
        }
    }
    if kept { ExitCode::SUCCESS } else { ExitCode::FAILURE }
}
