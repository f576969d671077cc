//! A blocked wheel cuts the drive; ordinary legs never do.

use super::bench::{Bench, TICK, random_legs};
use super::{Figure, Size};
use firmware::signals::Event;
use hil_sim::base::{BaseParameters, EncoderFault, Faults};
use protocol::message::State;
use protocol::motion::Pose;

/// A wheel that is wanted slower than this is not driven: it may stand, rad/s.
const DRIVEN: f32 = 0.5;

/// The most faults that may time nothing, %: the figures above are then maxima of real cases.
const WITHOUT_CUT: f64 = 10.0;

/// Blocked wheels and broken encoders at random moments; and legs of robots that are only imperfect.
pub fn measure(size: Size) -> Vec<Figure> {
    let runs = size.pick(60, 3000) as u64;
    let mut without_cut = 0;
    let mut slowest = |fault| {
        let cuts: Vec<f64> = (0..runs).filter_map(|seed| time_to_cut(seed, fault)).collect();
        without_cut += runs - cuts.len() as u64;
        cuts.into_iter().fold(0.0, f64::max)
    };
    let (blocked, stuck, swapped) = (slowest(blocked), slowest(stuck), slowest(swapped));
    let plans = size.pick(40, 10_000) as u64;
    let alarms = (0..plans).filter(|seed| ordinary_plan_fails(*seed)).count();
    vec![
        Figure::bounded(
            format!("{runs} blocked wheels: until the drive is cut"),
            blocked * 1e3,
            300.0,
            "ms",
        ),
        Figure::bounded(
            format!("{runs} dead encoders: until the drive is cut"),
            stuck * 1e3,
            300.0,
            "ms",
        ),
        Figure::bounded(
            format!("{runs} swapped encoders: until the drive is cut"),
            swapped * 1e3,
            300.0,
            "ms",
        ),
        // Faults that came after the mission, or to a wheel that crept, time nothing.
        Figure::bounded(
            format!("of these {} faults: share that timed no cut", 3 * runs),
            without_cut as f64 / (3 * runs) as f64 * 1e2,
            WITHOUT_CUT,
            "%",
        ),
        Figure::bounded(
            format!("{} ordinary legs: false alarms", plans * LEGS as u64),
            alarms as f64,
            0.0,
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

/// The time from the fault, or from when that wheel is next driven, to the cut, s; `None` if the fault
/// came after the mission, or while the wheel crept.
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
    // A mission that ended before the fault is no case.
    match (driven_since, cut) {
        (Some(since), Some(cut)) => Some(f64::from(cut - since) * TICK),
        (None, None) if bench.ticks <= at + 40 => None,
        // Cut while the wheel crept.
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
