//! Poses, twists, legs and how a leg runs over time; both ends of the link need them.
//!
//! ```text
//! Leg ─► IntervalMotion (turn, drive, turn) ─► Pose at phase k/N
//!               ▲
//!           Profile (how long, how fast)
//! ```
//! A leg is the paper's n = 3 manoeuvre [Alghannam, Sec. IV]: three intervals, in which only the
//! heading, only the displacement, and only the heading again change. Arena frame, SI.
//!
//! Time inside an interval is counted in *phases* of 1/256 control tick and never summed up as a
//! float, so that an interval ends exactly where it should; the fine step lets a pause scale time.

mod interval;
mod joint;
mod profile;

pub use interval::{Infeasible, IntervalMotion, Refusal, TurnLaw};
pub use joint::LARGEST_GAP;
pub use profile::Profile;

use crate::trigonometry::sin_cos;
use crate::units::{
    Metres, MetresPerSecond, MetresPerSecondSquared, Radians, RadiansPerSecond, Seconds,
};
use serde::{Deserialize, Serialize};

/// Control ticks per second.
pub const TICKS_PER_SECOND: u32 = 200;
/// The control period, 5 ms.
pub const TICK: Seconds = Seconds(0.005);
/// The control period in whole milliseconds.
pub const TICK_MILLISECONDS: u32 = 5;
/// Phases in one control tick.
pub const PHASES_PER_TICK: u32 = 256;

/// Where the robot stands and looks, arena frame.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Pose {
    /// The middle of the wheel axis, to the right of the arena's lower-left corner.
    pub x: Metres,
    /// The middle of the wheel axis, above the arena's lower-left corner.
    pub y: Metres,
    /// Counter-clockwise from +x, in (-π, π].
    pub heading: Radians,
}

/// Where a leg ends, arena frame.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Position {
    /// To the right of the arena's lower-left corner.
    pub x: Metres,
    /// Above the arena's lower-left corner.
    pub y: Metres,
}

/// How fast the robot moves along and turns about its own centre: u1 and u2 of [Alghannam, Eq. 3].
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Twist {
    /// u1: along the heading.
    pub linear: MetresPerSecond,
    /// u2: about the vertical axis.
    pub angular: RadiansPerSecond,
}

/// How fast the wheels turn; positive drives forward.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct WheelSpeeds {
    /// The left wheel.
    pub left: RadiansPerSecond,
    /// The right wheel.
    pub right: RadiansPerSecond,
}

/// What the wheels' rims may do, and how far apart they stand.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Limits {
    /// V: the fastest a rim may move.
    pub speed: MetresPerSecond,
    /// A: the fastest a rim may change its speed.
    pub acceleration: MetresPerSecondSquared,
    /// b: the distance between the wheels' contact points.
    pub track: Metres,
}

/// Which end of the robot goes first.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum Direction {
    /// Towards the heading.
    Forward,
    /// Away from the heading.
    Reverse,
}

/// How the time of a leg is chosen.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum Timing {
    /// Each interval as short as the limits allow.
    Limits,
    /// Three equal intervals [Alghannam, Eq. 6, n = 3], and the law applied to tan φ.
    Paper {
        /// N: control ticks of each interval; the leg takes T = 3 N ticks.
        interval_ticks: u32,
    },
}

/// The three parts of a leg, in the order in which they run.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum Interval {
    /// On the spot, to the direction of the drive.
    FirstTurn,
    /// Straight, to the goal's position.
    Drive,
    /// On the spot, to the goal's heading.
    LastTurn,
}

impl Interval {
    /// All three, in the order in which they run.
    pub const ALL: [Self; 3] = [Self::FirstTurn, Self::Drive, Self::LastTurn];

    /// The one that runs next, if any.
    pub fn next(self) -> Option<Self> {
        match self {
            Self::FirstTurn => Some(Self::Drive),
            Self::Drive => Some(Self::LastTurn),
            Self::LastTurn => None,
        }
    }
}

/// One straight piece of a mission, in absolute terms: sent twice, it moves the robot once.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Leg {
    /// The plan that it belongs to.
    pub plan: u32,
    /// Its place in the plan, from 0.
    pub index: u16,
    /// Where the plan expects it to begin.
    pub start: Pose,
    /// Where it ends.
    pub goal: Position,
    /// The heading at its end; `None` arrives along the drive and leaves the last turn empty.
    pub goal_heading: Option<Radians>,
    /// Which end of the robot goes first.
    pub direction: Direction,
    /// How long it takes.
    pub timing: Timing,
}

impl Pose {
    /// The pose at (`x`, `y`) metres with `heading` radians.
    pub const fn new(x: f32, y: f32, heading: f32) -> Self {
        Self { x: Metres(x), y: Metres(y), heading: Radians(heading) }
    }

    /// The straight distance to `goal`.
    pub fn distance(self, goal: Position) -> Metres {
        let (dx, dy) = (goal.x.0 - self.x.0, goal.y.0 - self.y.0);
        // No squares overflow below [`FARTHEST`], and `hypotf` would compute in f64.
        Metres(libm::sqrtf(dx * dx + dy * dy))
    }

    /// Where one stands who goes `step`, as seen from here: self ∘ step.
    ///
    /// ```
    /// use wmr_protocol::motion::Pose;
    /// // Looking along +y, one metre ahead is one metre up.
    /// let end = Pose::new(1.0, 0.0, core::f32::consts::FRAC_PI_2).then(Pose::new(1.0, 0.0, 0.1));
    /// assert!((end.x.0 - 1.0).abs() < 1e-6 && (end.y.0 - 1.0).abs() < 1e-6);
    /// ```
    pub fn then(self, step: Self) -> Self {
        let (sin, cos) = sin_cos(self.heading.0);
        Self {
            x: Metres(self.x.0 + cos * step.x.0 - sin * step.y.0),
            y: Metres(self.y.0 + sin * step.x.0 + cos * step.y.0),
            heading: Radians(self.heading.0 + step.heading.0).wrapped(),
        }
    }

    /// The step that leads from here back to the origin: self⁻¹.
    pub fn inverse(self) -> Self {
        let (sin, cos) = sin_cos(self.heading.0);
        Self {
            x: Metres(-cos * self.x.0 - sin * self.y.0),
            y: Metres(sin * self.x.0 - cos * self.y.0),
            heading: Radians(-self.heading.0).wrapped(),
        }
    }

    /// Whether every number is finite and no farther out than [`FARTHEST`].
    pub fn is_sane(self) -> bool {
        Position { x: self.x, y: self.y }.is_sane() && self.heading.0.is_finite()
    }
}

impl Position {
    /// The position at (`x`, `y`) metres.
    pub const fn new(x: f32, y: f32) -> Self {
        Self { x: Metres(x), y: Metres(y) }
    }

    /// Whether both coordinates are finite and no farther out than [`FARTHEST`].
    pub fn is_sane(self) -> bool {
        // NaN fails both comparisons.
        self.x.0.abs() <= FARTHEST.0 && self.y.0.abs() <= FARTHEST.0
    }
}

/// The greatest coordinate that a leg may name: f32 then still resolves 8 µm.
pub const FARTHEST: Metres = Metres(100.0);

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    /// Coordinates up to 5 m, through two products each.
    const ROUNDING: f32 = 5e-6;

    proptest! {
        #[test]
        fn a_pose_and_its_inverse_cancel(x in -5.0f32..5.0, y in -5.0f32..5.0, heading in -3.1f32..3.1) {
            let pose = Pose::new(x, y, heading);
            for origin in [pose.then(pose.inverse()), pose.inverse().then(pose)] {
                prop_assert!(origin.distance(Position::default()).0 < ROUNDING);
                prop_assert!(origin.heading.0.abs() < ROUNDING);
            }
        }
    }
}
