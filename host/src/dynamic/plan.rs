//! A way over time: legs, and when each begins.

use super::{Demand, LegMotion, Quest};
use protocol::motion::{Leg, Limits};

/// What a second at full risk costs, s.
pub(crate) const RISK_WEIGHT: f64 = 1.0;

/// A leg, and when it begins.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TimedLeg {
    /// The leg.
    pub leg: Leg,
    /// When it begins, s.
    pub begins: f64,
    /// How long the robot waits for that at rest, s.
    pub wait: f64,
}

/// A way over time.
#[derive(Clone, Debug, PartialEq)]
pub struct DynamicPlan {
    /// The legs, in their order.
    pub legs: Vec<TimedLeg>,
    /// When the robot has arrived, s.
    pub arrival: f64,
    /// The integral of the risk on the way, s.
    pub risk: f64,
    /// `None` if the way leads to the goal; else it leads to where the robot best waits, and this thing is in the
    /// way, if it was one.
    pub waits_for: Option<Option<usize>>,
}

impl DynamicPlan {
    /// When the robot has arrived, with what risks cost, s.
    pub fn cost(&self) -> f64 {
        self.arrival + RISK_WEIGHT * self.risk
    }

    /// The legs alone.
    pub fn legs(&self) -> Vec<Leg> {
        self.legs.iter().map(|timed| timed.leg).collect()
    }

    /// The length of the way, m.
    pub fn length(&self) -> f64 {
        let long = |timed: &TimedLeg| {
            let Leg { start, goal, .. } = timed.leg;
            f64::from(start.distance(goal).0)
        };
        self.legs.iter().map(long).sum()
    }

    /// How long the robot waits before the first leg, s.
    pub fn first_wait(&self) -> f64 {
        self.legs.first().map_or(0.0, |timed| timed.wait)
    }

    /// Whether no leg is ever nearer to a thing than asked, tried every `step` seconds.
    pub fn is_free(&self, quest: &Quest, demand: Demand, limits: &Limits, step: f64) -> bool {
        self.legs.iter().all(|timed| {
            let motion = LegMotion::new(&timed.leg, limits);
            let steps = (motion.times()[2] / step).ceil() as u32;
            (0..=steps).map(|at| (f64::from(at) * step).min(motion.times()[2])).all(|at| {
                let place = motion.position(at);
                demand.at(quest.futures, place, timed.begins + at).gap >= 0.0
            })
        })
    }
}
