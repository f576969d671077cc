//! One wheel slips by 20 % for 0.2 s at full speed; a camera sees the robot ten times a second.

use super::bench::{Bench, TICK, legs_through, robot_pose};
use super::{Figure, Size};
use hil_sim::base::{Faults, TruePose};
use protocol::motion::{Pose, Timing};
use std::collections::VecDeque;

/// Exposures are this many ticks apart, and known to the robot this many ticks later: 100 ms, 40 ms.
const CAMERA_INTERVAL: u32 = 20;
const CAMERA_DELAY: usize = 8;
/// Within this distance the robot is on its path again, m: half the position error of a mission.
const ON_PATH: f64 = 0.0025;
/// The drive is 2 m long; the wheel slips while it cruises.
const SLIP_FROM: f64 = 0.6;
const SLIP_TICKS: u32 = 40;

/// With the camera, at any phase of its exposures; without it, what stays.
pub fn measure(size: Size) -> Vec<Figure> {
    let phases = size.pick(10, 20) as u32;
    let mut back = 0.0f64;
    let mut acceleration = 0.0f64;
    let mut end = 0.0f64;
    let step = CAMERA_INTERVAL / phases.min(CAMERA_INTERVAL);
    for phase in (0..CAMERA_INTERVAL).step_by(step as usize) {
        let run = drive(Some(phase), u64::from(phase));
        back = back.max(run.back);
        acceleration = acceleration.max(run.acceleration);
        end = end.max(run.end);
    }
    let blind = drive(None, 1);
    vec![
        Figure::bounded(
            "slip of 20 % for 0.2 s, camera at 10 Hz: back on the path after",
            back,
            0.3,
            "m",
        ),
        Figure::stated("  end of the 2 m drive", end * 1e3, "mm"),
        Figure::bounded(
            "  commanded acceleration / A when the estimate jumps",
            acceleration,
            1.01,
            "",
        ),
        Figure::stated("  without a camera: end of the drive", blind.end * 1e3, "mm"),
    ]
}

struct Run {
    /// How far the robot drove from the end of the slip until it stayed on its path, m.
    back: f64,
    acceleration: f64,
    /// Distance from the goal, m.
    end: f64,
}

fn drive(camera: Option<u32>, seed: u64) -> Run {
    let start = Pose::default();
    let mut bench = Bench::new(start, seed);
    bench.commit(&legs_through(start, &[(2.0, 0.0)], Timing::Limits), start);
    let mut run = Run { back: 0.0, acceleration: 0.0, end: 0.0 };
    let (mut slipped_at, mut slip_end) = (None, f64::INFINITY);
    let (mut seen, mut last): (VecDeque<TruePose>, _) = (VecDeque::new(), [0.0; 2]);
    bench.run(|bench| {
        let pose = bench.base.pose();
        if pose.x > SLIP_FROM {
            let since = bench.ticks - *slipped_at.get_or_insert(bench.ticks);
            let slip = if since < SLIP_TICKS { [0.2, 0.0] } else { [0.0; 2] };
            bench.base.set_faults(Faults { slip, ..Faults::default() });
            if since == SLIP_TICKS {
                slip_end = pose.x;
            }
        }
        if pose.x > slip_end && pose.y.abs() > ON_PATH {
            run.back = pose.x - slip_end;
        }
        // What the bench shows now is the pose at the next tick's counts.
        seen.push_back(pose);
        if let Some(exposed) = (seen.len() > CAMERA_DELAY).then(|| seen.pop_front()).flatten()
            && camera.is_some_and(|phase| bench.ticks % CAMERA_INTERVAL == phase)
        {
            let _ = bench.controller.set_pose(robot_pose(exposed), CAMERA_DELAY as u32 - 1);
        }
        let rims = bench.rim_speeds();
        for (rim, last) in rims.into_iter().zip(last) {
            run.acceleration = run.acceleration.max((rim - last).abs() / TICK / 0.8);
        }
        last = rims;
    });
    let end = bench.base.pose();
    run.end = (end.x - 2.0).hypot(end.y);
    run
}
