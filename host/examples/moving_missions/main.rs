//! Missions among things that move as real ones did:
//! `cargo run --release --example moving_missions -- FILE.csv [MISSIONS] [SCALE]`.
//!
//! The file has the columns `time_s,id,x_m,y_m`; lengths are multiplied by SCALE, 0.125 where none is given. In
//! each mission one to four tracks that crossed the floor at the same time are replayed by boxes of 0.1 m, and a
//! robot drives from one place to another. Its camera sees ten frames a second, 100 ms late, with an error of 5 mm, and
//! one in fifty is lost. The same missions are driven with predictions, and by replanning around where things are;
//! beside them stands what a planner would do that knows how everything will move. Times are told in times of
//! the same mission without things that move. A contact counts if the robot moved.

mod mission;
mod replay;

use mission::{Outcome, Task};
use replay::Replay;
use std::error::Error;
use std::time::Instant;

fn main() -> Result<(), Box<dyn Error>> {
    let mut arguments = std::env::args().skip(1);
    let file = arguments.next().ok_or("name a CSV file with the columns time_s,id,x_m,y_m")?;
    let missions: u64 = arguments.next().map_or(Ok(1000), |count| count.parse())?;
    let scale = arguments.next().map_or(Ok(0.125), |scale| scale.parse())?;
    let replay = Replay::read(&std::fs::read_to_string(&file)?, scale)?;
    let began = Instant::now();
    let count = std::thread::available_parallelism()?.get() as u64;
    let outcomes: Vec<Outcome> = std::thread::scope(|scope| {
        let share = |first| {
            let replay = &replay;
            scope.spawn(move || {
                (first..missions)
                    .step_by(count as usize)
                    .map(|seed| Task::new(replay, seed).run())
                    .collect::<Vec<_>>()
            })
        };
        let workers: Vec<_> = (0..count).map(share).collect();
        workers.into_iter().flat_map(|worker| worker.join().unwrap_or_default()).collect()
    });
    println!(
        "{} missions over {:.2} × {:.2} m, {:.0} s",
        outcomes.len(),
        replay.arena.width,
        replay.arena.height,
        began.elapsed().as_secs_f64()
    );
    println!("                     contacts  reached %  median time  p90   holds  replans");
    let drives: [(&str, fn(&Outcome) -> &mission::Drive); 2] =
        [("with predictions", |o| &o.predicted), ("where things are", |o| &o.replanned)];
    for (name, drive) in drives {
        print(name, &outcomes, drive);
    }
    let oracle: Vec<f64> = outcomes.iter().map(|outcome| outcome.oracle).collect();
    let reached = oracle.iter().filter(|ratio| ratio.is_finite()).count();
    let [median, p90] = quantiles(oracle.clone());
    println!(
        "knows all            {:8}  {:9.1}  {median:11.2}  {p90:.2}",
        0,
        percent(reached, oracle.len())
    );
    let mut planning: Vec<f64> = outcomes.iter().map(|outcome| outcome.planning).collect();
    planning.sort_by(f64::total_cmp);
    let at = |share: f64| planning[((planning.len() - 1) as f64 * share) as usize];
    println!("a plan takes {:.1} ms, p99 {:.1} ms, at most {:.1} ms", at(0.5), at(0.99), at(1.0));
    for outcome in outcomes.iter().filter(|outcome| outcome.predicted.contacts > 0) {
        println!("contact in mission {}", outcome.seed);
    }
    Ok(())
}

fn print(name: &str, outcomes: &[Outcome], drive: fn(&Outcome) -> &mission::Drive) {
    let drives: Vec<&mission::Drive> = outcomes.iter().map(drive).collect();
    let contacts: u32 = drives.iter().map(|drive| drive.contacts).sum();
    let reached = drives.iter().filter(|drive| drive.reached).count();
    let ratios = outcomes.iter().map(|outcome| {
        let drive = drive(outcome);
        if drive.reached { drive.time / outcome.alone.time } else { f64::INFINITY }
    });
    let [median, p90] = quantiles(ratios.collect());
    let mean = |count: fn(&mission::Drive) -> u32| {
        drives.iter().map(|drive| f64::from(count(drive))).sum::<f64>() / drives.len() as f64
    };
    println!(
        "{name:20} {contacts:8}  {:9.1}  {median:11.2}  {p90:.2}  {:5.2}  {:7.2}",
        percent(reached, drives.len()),
        mean(|drive| drive.holds),
        mean(|drive| drive.replans)
    );
}

fn percent(part: usize, whole: usize) -> f64 {
    100.0 * part as f64 / whole as f64
}

fn quantiles(mut numbers: Vec<f64>) -> [f64; 2] {
    numbers.sort_by(f64::total_cmp);
    [0.5, 0.9].map(|share| numbers[((numbers.len() - 1) as f64 * share) as usize])
}
