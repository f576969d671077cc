//! A blocked wheel cuts the drive; ordinary legs never do.

use super::bench::{Bench, TICK, random_legs};
use super::{Figure, Size};
use firmware::signals::Event;
use hil_sim::base::{BaseParameters, EncoderFault, Faults};
use protocol::message::State;
use protocol::motion::Pose;

/// A wheel that is wanted slower than this is not driven: it may stand, rad/s.
const DRIVEN: f32 = 0.5;

/// The share of runs that may time nothing: legs creep, or end, in less than a hundredth of their time.
const UNTIMED: f64 = 0.01;

/// Blocked wheels and broken encoders at random moments; and legs of robots that are only imperfect.
pub fn measure(size: Size) -> Vec<Figure> {
    let runs = size.pick(60, 3000) as u64;
    let mut figures = Vec::new();
    figures.extend(cuts(runs, "blocked wheels", blocked));
    figures.extend(cuts(runs, "dead encoders", stuck));
    figures.extend(cuts(runs, "swapped encoders", swapped));
    let plans = size.pick(40, 10_000) as u64;
    let alarms = (0..plans).filter(|seed| ordinary_plan_fails(*seed)).count();
    figures.push(Figure::bounded(
        format!("{} ordinary legs: false alarms", plans * LEGS as u64),
        alarms as f64,
        0.0,
        "",
    ));
    figures
}

/// The longest time to a cut, and in how many runs there was none to be timed.
fn cuts(runs: u64, what: &str, fault: fn(usize) -> Faults) -> [Figure; 2] {
    let times: Vec<f64> = (0..runs).filter_map(|seed| time_to_cut(seed, fault)).collect();
    // No time at all is no bound kept.
    let longest = times.iter().copied().reduce(f64::max).unwrap_or(f64::INFINITY);
    let untimed = runs as usize - times.len();
    [
        Figure::bounded(
            format!("{runs} {what}: until the drive is cut"),
            longest * 1e3,
            300.0,
            "ms",
        ),
        Figure::bounded(
            format!("{runs} {what}: cut while creeping, or mission over"),
            untimed as f64,
            UNTIMED * runs as f64,
            "",
        ),
    ]
}

fn blocked(wheel: usize) -> Faults {
    let mut faults = Faults::default();
    faults.blocked[wheel] = true;
    faults
}

fn stuck(wheel: usize) -> Faults {
    let mut faults = Faults::default();
    faults.encoders[wheel] = EncoderFault::Stuck;
    faults
}

fn swapped(wheel: usize) -> Faults {
    let mut faults = Faults::default();
    faults.encoders[wheel] = EncoderFault::Reversed;
    faults
}

const LEGS: usize = 10;

/// The time from the fault, or from when that wheel is next driven, to the cut, s; `None` if the
/// mission ended before the fault or the drive was cut while the wheel crept.
fn time_to_cut(seed: u64, fault: fn(usize) -> Faults) -> Option<f64> {
    let mut random = fastrand::Rng::with_seed(seed);
    let start = Pose::default();
    let mut bench = Bench::new(start, seed);
    bench.commit(&random_legs(start, LEGS, 0.02..0.62, &mut random), start);
    let (wheel, at) = (random.usize(..2), random.u32(2..2000));
    let (mut driven_since, mut cut) = (None, None);
    let events = bench.run(|bench| {
        if bench.ticks == at {
            bench.base.set_faults(fault(wheel));
        }
        let wheels = bench.controller.commanded_speeds();
        let driven = [wheels.left, wheels.right][wheel].0.abs() > DRIVEN;
        if bench.ticks >= at && driven {
            driven_since.get_or_insert(bench.ticks);
        } else if !matches!(bench.controller.state(), State::Faulted(_)) {
            driven_since = None;
        }
        if let State::Faulted(_) = bench.controller.state() {
            cut.get_or_insert(bench.ticks);
        }
    });
    let reached = events.iter().any(|event| matches!(event, Event::PlanDone { .. }));
    match (driven_since, cut) {
        (Some(since), Some(cut)) => Some(f64::from(cut - since) * TICK),
        (None, None) if bench.ticks <= at + 40 => None,
        (None, Some(_)) => None,
        _ => panic!(
            "{seed}: {:?} {driven_since:?} {cut:?} reached {reached}",
            bench.controller.state()
        ),
    }
}

/// Motors apart by up to 10 %, more friction, a little slip: nothing that should stop a robot.
fn ordinary_plan_fails(seed: u64) -> bool {
    let mut random = fastrand::Rng::with_seed(seed);
    let mut parameters = BaseParameters::seeded(seed);
    let mut motor = || 18.0 * (1.0 + 0.1 * (2.0 * random.f64() - 1.0));
    parameters.no_load_speed = [motor(), motor()];
    parameters.friction_duty = 0.02 + 0.04 * random.f64();
    parameters.time_constant = 0.04 + 0.04 * random.f64();
    let start = Pose::default();
    let mut bench = Bench::with(Default::default(), parameters, start);
    bench.commit(&random_legs(start, LEGS, 0.02..0.62, &mut random), start);
    let events = bench.run(|bench| {
        if bench.ticks % 50 == 0 {
            let slip = [0.1 * random.f64(), 0.1 * random.f64()];
            bench.base.set_faults(Faults { slip, ..Faults::default() });
        }
    });
    !events.iter().any(|event| matches!(event, Event::PlanDone { .. }))
}
