//! Pause, resume and stop at any moment of a mission: on the path, and within V and A.

use super::bench::{Bench, TICK, legs_through, off_line, true_pose};
use super::{Figure, Size};
use firmware::signals::Event;
use hil_sim::base::TruePose;
use protocol::message::PauseReason;
use protocol::motion::{Pose, Timing};

const START: Pose = Pose::new(0.0, 0.0, 0.4);
const CORNERS: [(f64, f64); 3] = [(0.0, 0.0), (0.8, 0.0), (0.8, 0.6)];

/// Pauses and stops drawn over the mission's time, by real motors and encoders.
pub fn measure(size: Size) -> Vec<Figure> {
    let runs = size.pick(60, 3000) as u64;
    let (mut off, mut truly_off, mut acceleration, mut end) = (0.0f64, 0.0f64, 0.0f64, 0.0f64);
    for seed in 0..runs {
        let run = drive(seed);
        off = off.max(run.off_path);
        truly_off = truly_off.max(run.truly_off);
        acceleration = acceleration.max(run.acceleration);
        end = end.max(run.end.unwrap_or(0.0));
    }
    let what = format!("{runs} pauses and stops:");
    vec![
        Figure::bounded(format!("{what} off the path"), off * 1e3, 1.0, "mm"),
        // Half a count of 1440 at each switch turns the base by 0.04° that nobody sees.
        Figure::stated("  by the true pose, encoders' resolution included", truly_off * 1e3, "mm"),
        Figure::bounded(format!("{what} commanded acceleration / A"), acceleration, 1.01, ""),
        Figure::bounded(format!("{what} resumed missions end"), end * 1e3, 2.0, "mm"),
    ]
}

struct Run {
    /// By the robot's own estimate, m.
    off_path: f64,
    truly_off: f64,
    acceleration: f64,
    /// Distance from the goal, if the mission was resumed.
    end: Option<f64>,
}

fn drive(seed: u64) -> Run {
    let mut random = fastrand::Rng::with_seed(seed);
    let mut bench = Bench::new(START, seed);
    bench.commit(&legs_through(START, &CORNERS[1..], Timing::Limits), START);
    // The mission takes 6.5 s.
    let (stop, at) = (seed.is_multiple_of(3), random.u32(20..1250));
    let (mut run, mut last) =
        (Run { off_path: 0.0, truly_off: 0.0, acceleration: 0.0, end: None }, [0.0; 2]);
    let events = bench.run(|bench| {
        match bench.ticks {
            tick if tick == at && stop => bench.controller.stop(),
            tick if tick == at => bench.controller.pause(PauseReason::Command),
            tick if tick == at + 300 => bench.controller.resume(),
            _ => {}
        }
        run.off_path = run.off_path.max(off_path(true_pose(bench.controller.pose())));
        run.truly_off = run.truly_off.max(off_path(bench.base.pose()));
        let rims = bench.rim_speeds();
        for (rim, last) in rims.into_iter().zip(last) {
            run.acceleration = run.acceleration.max((rim - last).abs() / TICK / 0.8);
        }
        last = rims;
    });
    let done = events.iter().any(|event| matches!(event, Event::PlanDone { .. }));
    assert!(done || stop, "{seed}: {events:?}");
    let pose = bench.base.pose();
    run.end = done.then(|| (pose.x - CORNERS[2].0).hypot(pose.y - CORNERS[2].1));
    run
}

fn off_path(pose: TruePose) -> f64 {
    off_line(pose, CORNERS[0], CORNERS[1]).min(off_line(pose, CORNERS[1], CORNERS[2]))
}
