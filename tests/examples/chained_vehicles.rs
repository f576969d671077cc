//! Steers a car (n = 4) and a car with a trailer (n = 5) and prints their ways.
//!
//! ```text
//! cargo run --release -p wmr-tests --example chained_vehicles
//! ```

use std::process::ExitCode;
use wmr_tests::vehicles::{Car, CarWithTrailer, ChainedVehicle, steer};

/// Rows are printed this far apart, s.
const ROW: f64 = 0.5;
const EPSILON: f64 = 2.0;

fn show<const N: usize>(
    title: &str,
    columns: &str,
    vehicle: &impl ChainedVehicle<N>,
    ends: [&[f64; N]; 2],
) -> bool {
    println!("\n{title}\n    t [s]{columns}");
    let mut next = 0.0;
    let row = |t: f64, configuration: &[f64; N]| {
        if t + 1e-9 >= next {
            next += ROW;
            let numbers: Vec<_> =
                configuration.iter().map(|value| format!("{value:9.4}")).collect();
            println!("{t:9.2}{}", numbers.concat());
        }
    };
    match steer(vehicle, ends, EPSILON, row) {
        Ok(end) => {
            let off = end.iter().zip(ends[1]).map(|(end, wanted)| (end - wanted).abs());
            println!("largest error at the end: {:.1e}", off.fold(0.0, f64::max));
            true
        }
        Err(error) => {
            eprintln!("{title}: {error:?}");
            false
        }
    }
}

fn main() -> ExitCode {
    let car = Car { wheel_base: 0.3 };
    let lane = [&[0.0; 4], &[2.0, 0.5, 0.0, 0.0]];
    let shown =
        show("Car, n = 4: a lane to the left", "    x [m]    y [m]  θ [rad]  φ [rad]", &car, lane);
    let train = CarWithTrailer { wheel_base: 0.3, drawbar: 0.4 };
    let lane = [&[0.0; 5], &[-3.0, 0.5, 0.0, 0.0, 0.0]];
    let columns = "    x [m]    y [m]  θ [rad]  β [rad]  φ [rad]";
    let backed = show("Car with trailer, n = 5: backing up", columns, &train, lane);
    if shown && backed { ExitCode::SUCCESS } else { ExitCode::FAILURE }
}
