//! What odometry says since the last corrected moment, and where the robot believes itself to be.
//!
//! A camera's pose is some hundred milliseconds old when it arrives: steps are kept so that they can be
//! replayed from the exposure on. The robot's own pose jumps when it takes a correction, though the
//! robot does not; the jump is taken out of the steps where it is expected (somebody said that the robot was told) or
//! where no wheel could have done it.

use super::state::Step;
use crate::geometry::Pose;
use std::collections::VecDeque;
use std::time::Duration;

/// Steps older than this are folded into the state: nobody asks for exposures as old, the robot itself
/// forgets its poses after a second.
pub(super) const KEPT: Duration = Duration::from_secs(2);

/// A correction that has not shown after this time was not taken.
const PATIENCE: Duration = Duration::from_millis(600);

/// Beyond what wheels can do between two poses, a jump is no motion: m and rad.
const JUMP: (f64, f64) = (0.01, 0.1);

/// What counts as much as a metre when two explanations of a pose are compared, rad.
const RADIANS_PER_METRE: f64 = 5.0;

/// Odometry goes on at its last speed for so long when asked for a later time.
const EXTRAPOLATED: f64 = 0.1;

/// One step and where the robot believed to be after it.
#[derive(Clone, Copy, Debug)]
struct Stop {
    until: Duration,
    step: Step,
    /// Before any correction that came after the step.
    believed: Pose,
}

/// A change of the robot's frame that was sent and has not yet shown: new pose = change ∘ old pose.
#[derive(Clone, Copy, Debug)]
struct Change {
    change: Pose,
    until: Duration,
}

/// The steps of odometry from `since` on.
#[derive(Clone, Debug)]
pub(super) struct Driven {
    since: Duration,
    /// The robot's own pose at `since`.
    first: Pose,
    stops: VecDeque<Stop>,
    change: Option<Change>,
    /// V in m/s, and 2V/b in rad/s.
    fastest: (f64, f64),
}

impl Driven {
    pub(super) fn new(time: Duration, believed: Pose, fastest: (f64, f64)) -> Self {
        Self { since: time, first: believed, stops: VecDeque::new(), change: None, fastest }
    }

    /// The moment before which everything is forgotten.
    pub(super) fn since(&self) -> Duration {
        self.since
    }

    /// The moment and the robot's own pose of the last telemetry.
    pub(super) fn last(&self) -> (Duration, Pose) {
        self.stops.back().map_or((self.since, self.first), |stop| (stop.until, stop.believed))
    }

    /// Takes in the robot's own pose; older than the last is of no use.
    pub(super) fn push(&mut self, time: Duration, believed: Pose) {
        let (before, from) = self.last();
        if time <= before {
            return;
        }
        let seconds = (time - before).as_secs_f64();
        let expected = self.stops.back().map_or(Step::default(), |stop| {
            stop.step.part((seconds / stop.step.seconds).min(EXTRAPOLATED / stop.step.seconds))
        });
        let since = |pose: Pose| Step::along_arc(from.inverse().then(pose), seconds);
        let plain = since(believed);
        let step = match self.change {
            Some(Change { change, .. }) => {
                let undone = since(change.inverse().then(believed));
                if surprise(undone, expected) < surprise(plain, expected) {
                    self.take(change);
                    undone
                } else {
                    plain
                }
            }
            None => plain,
        };
        let (path, turn) = (self.fastest.0 * seconds + JUMP.0, self.fastest.1 * seconds + JUMP.1);
        let step = if step.path.abs() > path || step.turn.abs() > turn {
            // Put down elsewhere by a plan's first pose that nobody announced here.
            self.take(believed.then(from.then(expected.as_pose()).inverse()));
            Step { seconds, ..expected }
        } else {
            step
        };
        self.change = self.change.filter(|change| time < change.until);
        self.stops.push_back(Stop { until: time, step, believed });
    }

    /// The robot was told that it was at `pose` at `time`.
    pub(super) fn told(&mut self, time: Duration, pose: Pose) {
        if let Some(believed) = self.believed(time) {
            let until = self.last().0 + PATIENCE;
            self.change = Some(Change { change: pose.then(believed.inverse()), until });
        }
    }

    /// The robot has not taken what it was told.
    pub(super) fn refused(&mut self) {
        self.change = None;
    }

    /// Whether the robot was told something that has not shown yet.
    pub(super) fn is_waiting(&self) -> bool {
        self.change.is_some()
    }

    fn take(&mut self, change: Pose) {
        self.change = None;
        self.first = change.then(self.first);
        for stop in &mut self.stops {
            stop.believed = change.then(stop.believed);
        }
    }

    /// Where the robot believes to have been at `time`, as of now; `None` if that is forgotten or to come.
    pub(super) fn believed(&self, time: Duration) -> Option<Pose> {
        if time < self.since || time > self.last().0 {
            return None;
        }
        let mut from = (self.since, self.first);
        for stop in &self.stops {
            if time <= stop.until {
                let share = share(from.0, stop.until, time);
                return Some(from.1.then(stop.step.part(share).as_pose()));
            }
            from = (stop.until, stop.believed);
        }
        Some(from.1)
    }

    /// The steps from the first moment to `time`, one of them in part; beyond the last telemetry the speed
    /// stays for a while.
    pub(super) fn steps_to(&self, time: Duration) -> impl Iterator<Item = Step> {
        let begins = std::iter::once(self.since).chain(self.stops.iter().map(|stop| stop.until));
        let known = self.stops.iter().zip(begins).map_while(move |(stop, begin)| {
            (begin < time).then(|| stop.step.part(share(begin, stop.until, time)))
        });
        let beyond = self.stops.back().filter(|stop| stop.until < time).map(|stop| {
            let ahead = (time - stop.until).as_secs_f64().min(EXTRAPOLATED);
            stop.step.part(ahead / stop.step.seconds)
        });
        known.chain(beyond)
    }

    /// Forgets what was before `time`, which is not after the last telemetry.
    pub(super) fn forget(&mut self, time: Duration) {
        let Some(believed) = self.believed(time) else { return };
        while let Some(stop) = self.stops.front_mut() {
            if stop.until > time {
                let left = 1.0 - share(self.since, stop.until, time);
                stop.step = stop.step.part(left);
                break;
            }
            self.since = stop.until;
            self.stops.pop_front();
        }
        (self.since, self.first) = (time, believed);
    }
}

/// The share of the time from `begin` to `end` that has passed at `time`, at most 1.
fn share(begin: Duration, end: Duration, time: Duration) -> f64 {
    let whole = (end - begin).as_secs_f64();
    (time.saturating_sub(begin).as_secs_f64() / whole).min(1.0)
}

/// How badly a step fits what was expected, m.
fn surprise(step: Step, expected: Step) -> f64 {
    (step.path - expected.path).abs() + (step.turn - expected.turn).abs() / RADIANS_PER_METRE
}
