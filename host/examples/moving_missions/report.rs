//! What became of all missions, in a table. Times are told in times of the same mission without things that move.

use crate::mission::{Drive, Outcome};

/// Prints it.
pub(crate) fn print(outcomes: &[Outcome]) {
    let crossed = outcomes.iter().filter(|outcome| outcome.alone.contacts > 0).count();
    println!(
        "{:.1} % of the missions are crossed: driven blindly they touch something",
        percent(crossed, outcomes.len())
    );
    println!(
        "                  contacts  reached %  time: median   p90   crossed: median   p90  holds  replans"
    );
    print_drives("predictions", outcomes, |outcome| &outcome.predicted);
    print_drives("where things are", outcomes, |outcome| &outcome.replanned);
    print_drives("blind", outcomes, |outcome| &outcome.alone);
    let reached = outcomes.iter().filter(|outcome| outcome.oracle.is_finite()).count();
    print_times("knows all", (0, percent(reached, outcomes.len())), outcomes, |outcome| {
        outcome.oracle
    });
    println!();
    print_judging(outcomes);
    print_predictions(outcomes);
    for outcome in outcomes.iter().filter(|outcome| outcome.predicted.contacts > 0) {
        println!("contact in mission {}", outcome.seed);
    }
    for outcome in outcomes.iter().filter(|outcome| !outcome.predicted.reached) {
        println!("goal not reached in mission {}", outcome.seed);
    }
}

fn print_drives(name: &str, outcomes: &[Outcome], drive: fn(&Outcome) -> &Drive) {
    let drives: Vec<&Drive> = outcomes.iter().map(drive).collect();
    let contacts = drives.iter().map(|drive| drive.contacts).sum();
    let reached = drives.iter().filter(|drive| drive.reached).count();
    print_times(name, (contacts, percent(reached, drives.len())), outcomes, |outcome| {
        let drive = drive(outcome);
        if drive.reached { drive.time / outcome.alone.time } else { f64::INFINITY }
    });
    let mean = |count: fn(&Drive) -> u32| {
        drives.iter().map(|drive| f64::from(count(drive))).sum::<f64>() / drives.len() as f64
    };
    println!("  {:5.2}  {:7.2}", mean(|drive| drive.holds), mean(|drive| drive.replans));
}

fn print_times(
    name: &str,
    (contacts, reached): (u32, f64),
    outcomes: &[Outcome],
    time: impl Fn(&Outcome) -> f64,
) {
    let crossed = outcomes.iter().filter(|outcome| outcome.alone.contacts > 0);
    let [median, p90] = quantiles(outcomes.iter().map(&time).collect(), [0.5, 0.9]);
    let [crossed_median, crossed_p90] = quantiles(crossed.map(&time).collect(), [0.5, 0.9]);
    print!(
        "{name:17} {contacts:8}  {reached:9.1}  {median:12.2}  {p90:4.2}  {crossed_median:16.2}  {crossed_p90:4.2}"
    );
}

/// How long the host takes from a frame to what it tells the robot.
fn print_judging(outcomes: &[Outcome]) {
    let judging = |drive: fn(&Outcome) -> &Drive| {
        outcomes.iter().flat_map(move |outcome| drive(outcome).judging.iter().copied())
    };
    let all: Vec<f64> = judging(|outcome| &outcome.predicted).collect();
    let count = all.len();
    let [median, p95, p99, most] = quantiles(all, [0.5, 0.95, 0.99, 1.0]);
    println!(
        "from a frame to the answer, {count} frames: median {median:.2} ms, p95 {p95:.1} ms, p99 {p99:.1} ms, at most {most:.1} ms"
    );
}

/// How good predictions are, of what has not left the file by then.
fn print_predictions(outcomes: &[Outcome]) {
    let all: Vec<(f64, f64)> =
        outcomes.iter().flat_map(|outcome| outcome.predictions.iter().copied()).collect();
    let held = all.iter().filter(|(error, reach)| error <= reach).count();
    let area = all.iter().map(|(_, reach)| reach * reach).sum::<f64>() / all.len() as f64;
    let [p99] = quantiles(all.iter().map(|(error, _)| *error).collect(), [0.99]);
    println!(
        "sets of 2 s hold the truth in {:.2} % of {} samples; mean area {:.2} times the disc that holds 99 %, {:.0} mm",
        percent(held, all.len()),
        all.len(),
        area / (p99 * p99),
        1000.0 * p99
    );
}

fn percent(part: usize, whole: usize) -> f64 {
    100.0 * part as f64 / whole as f64
}

fn quantiles<const N: usize>(mut numbers: Vec<f64>, shares: [f64; N]) -> [f64; N] {
    numbers.sort_by(f64::total_cmp);
    let last = numbers.len().saturating_sub(1);
    shares.map(|share| numbers.get((last as f64 * share) as usize).copied().unwrap_or(f64::NAN))
}
