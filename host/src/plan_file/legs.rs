//! The legs of a plan file, and what they were made for. Metres, radians and seconds.

use crate::geometry::Pose;
use crate::legs::{LegOptions, duration, from_wire, paper_timing, shortest, to_wire};
use protocol::motion::{self, Leg, Limits, Timing};
use protocol::units::{Metres, MetresPerSecond, MetresPerSecondSquared, Radians, Seconds};
use serde::{Deserialize, Serialize};
use std::fmt;

/// What limits and times of a leg may be, in SI units: far beyond any robot's.
const LEAST_LIMIT: f64 = 1e-3;
const LARGEST_LIMIT: f64 = 1e4;

/// One leg, as planned.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
pub struct PlannedLeg {
    /// Where it begins: x, y, heading.
    pub start: Pose,
    /// Where it ends: x, y, and the heading there if one is wanted.
    pub goal: (f64, f64, Option<f64>),
    /// Which end of the robot goes first.
    pub direction: PlannedDirection,
    /// How long it takes, seconds.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub duration: Option<f64>,
}

/// What legs were made for: what a robot's wheels may do, and how the time of a leg is chosen.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
pub struct MadeFor {
    /// The greatest speed of a wheel's rim, m/s.
    pub speed: f64,
    /// The greatest acceleration of a wheel's rim, m/s².
    pub acceleration: f64,
    /// The distance between the wheels, metres.
    pub track: f64,
    /// How long each leg takes in the paper's three equal intervals, seconds; absent where each takes as long
    /// as the limits need.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub leg_time: Option<f64>,
    /// Whether the robot may drive backwards.
    pub reverse: bool,
}

impl MadeFor {
    /// Legs for a robot with `limits`, made as `options` say.
    pub fn new(options: &LegOptions, limits: &Limits) -> Self {
        let seconds =
            |ticks: u32| 3.0 * f64::from(ticks) * f64::from(motion::TICK_MILLISECONDS) / 1000.0;
        Self {
            speed: shortest(limits.speed.0),
            acceleration: shortest(limits.acceleration.0),
            track: shortest(limits.track.0),
            leg_time: match options.timing {
                Timing::Limits => None,
                Timing::Paper { interval_ticks } => Some(seconds(interval_ticks)),
            },
            reverse: options.reverse,
        }
    }

    /// How they are made.
    pub fn options(&self) -> LegOptions {
        let paper = self.leg_time.map(|seconds| paper_timing(Seconds(seconds as f32)));
        LegOptions { timing: paper.unwrap_or(Timing::Limits), reverse: self.reverse }
    }

    /// What the robot's wheels may do.
    pub fn limits(&self) -> Limits {
        Limits {
            speed: MetresPerSecond(self.speed as f32),
            acceleration: MetresPerSecondSquared(self.acceleration as f32),
            track: Metres(self.track as f32),
        }
    }

    pub(super) fn is_sane(&self) -> bool {
        let numbers = [self.speed, self.acceleration, self.track, self.leg_time.unwrap_or(1.0)];
        numbers.iter().all(|number| (LEAST_LIMIT..=LARGEST_LIMIT).contains(number))
    }
}

impl fmt::Display for MadeFor {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { speed, acceleration, track, leg_time, reverse } = self;
        write!(out, "{speed} m/s, {acceleration} m/s² and a track of {track} m")?;
        if let Some(seconds) = leg_time {
            write!(out, ", {seconds} s a leg")?;
        } else if !reverse {
            write!(out, ", never backwards")?;
        }
        Ok(())
    }
}

/// Which end of the robot goes first.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
#[serde(rename_all = "lowercase")]
pub enum PlannedDirection {
    /// Towards the heading.
    Forward,
    /// Away from the heading.
    Reverse,
}

impl PlannedLeg {
    /// A leg, and how long a robot with `limits` takes.
    pub(super) fn new(leg: &Leg, limits: &Limits) -> Self {
        Self {
            start: from_wire(leg.start),
            goal: (
                leg.goal.x.0.into(),
                leg.goal.y.0.into(),
                leg.goal_heading.map(|heading| heading.0.into()),
            ),
            direction: match leg.direction {
                motion::Direction::Forward => PlannedDirection::Forward,
                motion::Direction::Reverse => PlannedDirection::Reverse,
            },
            duration: Some(duration(std::slice::from_ref(leg), limits)),
        }
    }

    /// The leg of that number as the robot gets it, of a plan that has no name yet.
    pub(super) fn to_wire(self, index: u16, timing: Timing) -> Leg {
        let (x, y, heading) = self.goal;
        Leg {
            plan: 0,
            index,
            start: to_wire(self.start),
            goal: motion::Position::new(x as f32, y as f32),
            goal_heading: heading.map(|heading| Radians(heading as f32).wrapped()),
            direction: match self.direction {
                PlannedDirection::Forward => motion::Direction::Forward,
                PlannedDirection::Reverse => motion::Direction::Reverse,
            },
            timing,
        }
    }
}
