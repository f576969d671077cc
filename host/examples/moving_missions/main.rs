//! Missions among things that move as real ones did:
//! `cargo run --release --example moving_missions -- FILE.csv [MISSIONS] [SCALE] [FIRST]`.
//!
//! The file has the columns `time_s,id,x_m,y_m`; lengths are multiplied by SCALE, 0.125 where none is given. In
//! each mission one to four tracks that crossed the floor at the same time are replayed by boxes of 0.1 m, and a
//! robot drives from one place to another. Its camera sees ten frames a second, 100 ms late, with an error of 5 mm, and
//! one in fifty is lost. The same missions, from number FIRST on, are driven with predictions, and by replanning around
//! where things are; beside them stands what a planner would do that knows how everything will move. A contact counts
//! if the robot moved.

mod mission;
mod replay;
mod report;

use mission::{Outcome, Task};
use replay::Replay;
use std::error::Error;
use std::panic::resume_unwind;
use std::time::Instant;

fn main() -> Result<(), Box<dyn Error>> {
    let mut arguments = std::env::args().skip(1);
    let file = arguments.next().ok_or("name a CSV file with the columns time_s,id,x_m,y_m")?;
    let missions: u64 = arguments.next().map_or(Ok(1000), |count| count.parse())?;
    let scale = arguments.next().map_or(Ok(0.125), |scale| scale.parse())?;
    let first: u64 = arguments.next().map_or(Ok(0), |first| first.parse())?;
    let replay = Replay::read(&std::fs::read_to_string(&file)?, scale)?;
    let began = Instant::now();
    let outcomes = run(&replay, first..first + missions)?;
    println!(
        "{} missions from number {first} on over {:.2} × {:.2} m, {:.0} s",
        outcomes.len(),
        replay.arena.width,
        replay.arena.height,
        began.elapsed().as_secs_f64()
    );
    report::print(&outcomes);
    Ok(())
}

/// Runs the missions on all cores.
fn run(replay: &Replay, missions: std::ops::Range<u64>) -> Result<Vec<Outcome>, Box<dyn Error>> {
    let workers = std::thread::available_parallelism()?.get();
    Ok(std::thread::scope(|scope| {
        let share = |worker| {
            let mine = missions.clone().skip(worker).step_by(workers);
            scope.spawn(move || {
                mine.map(|seed| Task::new(replay, seed).run()).collect::<Vec<Outcome>>()
            })
        };
        let running: Vec<_> = (0..workers).map(share).collect();
        running
            .into_iter()
            .flat_map(|worker| worker.join().unwrap_or_else(|panic| resume_unwind(panic)))
            .collect()
    }))
}
