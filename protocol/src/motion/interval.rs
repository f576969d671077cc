//! One interval of a leg: from which pose, by how much, and where the robot is at phase k.
//!
//! Because an interval is solved from a pose, the robot solves each one again from the *measured*
//! pose when its turn comes, and the host chains the three from the planned poses; the formulas are
//! the same.
//!
//! | symbol | meaning | unit |
//! |---|---|---|
//! | β | heading of the robot while it drives | rad |
//! | Δ | change of heading in a turn | rad |
//! | ψ | heading relative to the middle of a turn | rad |
//! | z2 | tan ψ, the paper's second chained state | – |
//! | D | displacement of a drive, negative in reverse | m |
//!
//! *Deviation:* the paper takes φ from the frame's x axis, where tan φ is singular at ±90°. During a
//! turn v1 = 0, so X and Y do not matter and each turn may have its own frame, along its middle
//! heading: z2 runs from -tan(Δ/2) to tan(Δ/2). Turns of more than 120° run in equal parts.

use super::{Direction, Interval, Leg, Limits, Pose, Profile, TICK, Timing};
use crate::trigonometry::sin_cos;
use crate::units::{Metres, Radians, Seconds};
use core::f32::consts::{PI, TAU};
use serde::{Deserialize, Serialize};

/// How a turn's heading follows the profile.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum TurnLaw {
    /// The heading itself runs along the cosine.
    Heading,
    /// z2 = tan ψ runs along the cosine, in this many equal parts [Alghannam, Eq. 7, 8].
    TanHeading {
        /// The parts, each below 120°.
        parts: u32,
    },
}

/// One interval, solved from a pose.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct IntervalMotion {
    /// Which part of the leg it is.
    pub interval: Interval,
    /// Where it begins. A drive's origin looks along the drive.
    pub origin: Pose,
    /// The whole change: Δ in radians for a turn, D in metres for a drive.
    pub change: f32,
    /// How a turn's heading follows the profile.
    pub law: TurnLaw,
    /// How the change is spread over time.
    pub profile: Profile,
}

/// Why a leg cannot be driven.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub enum Refusal {
    /// A number is not finite, or a coordinate is beyond [`FARTHEST`](super::FARTHEST).
    NotSane,
    /// The leg would take too long to count in phases.
    TooLong,
    /// The time asked for is too short for the limits.
    TooShort(Infeasible),
}

/// The shortest time in which the paper's three equal intervals keep the limits.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Infeasible {
    /// T for the whole leg.
    pub shortest: Seconds,
}

/// A shorter drive counts as no drive: its direction would be noise.
pub(super) const SHORTEST_DRIVE: Metres = Metres(0.001);

/// The largest part of a turn under the law on tan ψ; there its peak rate is 1.65 times that of
/// the law on the heading, and it grows without bound towards a half turn.
const LARGEST_PART: f32 = TAU / 3.0;

/// Phases must fit 24 bits to be exact in f32: 300 s are 15.4 million.
const LONGEST_INTERVAL_TICKS: u32 = 60_000;

impl Leg {
    /// Solves one interval of this leg from `pose`.
    ///
    /// The first turn goes to the direction of the drive, the drive to the goal's position, the last
    /// turn to the goal's heading, each from wherever the robot really is.
    pub fn interval(&self, interval: Interval, pose: Pose, limits: &Limits) -> IntervalMotion {
        match interval {
            Interval::FirstTurn => {
                let heading = self.drive_heading(pose);
                self.turn(interval, pose, heading, limits)
            }
            Interval::Drive => self.drive(pose, limits),
            Interval::LastTurn => {
                let heading = self.goal_heading.unwrap_or(pose.heading);
                self.turn(interval, pose, heading, limits)
            }
        }
    }

    /// The three intervals from the pose at which the plan expects the leg to begin.
    pub fn intervals(&self, limits: &Limits) -> [IntervalMotion; 3] {
        let first = self.interval(Interval::FirstTurn, self.start, limits);
        let drive = self.interval(Interval::Drive, first.end(), limits);
        let last = self.interval(Interval::LastTurn, drive.end(), limits);
        [first, drive, last]
    }

    /// How long the leg takes as planned, control ticks.
    pub fn ticks(&self, limits: &Limits) -> u32 {
        self.intervals(limits).iter().map(|motion| motion.profile.ticks()).sum()
    }

    /// Whether the leg makes sense and can be driven within `limits` in the time that it asks for.
    ///
    /// # Errors
    /// [`Refusal`] with the reason; a time too short comes with the shortest possible one.
    pub fn check(&self, limits: &Limits) -> Result<(), Refusal> {
        let heading_sane = self.goal_heading.is_none_or(|heading| heading.0.is_finite());
        if !(self.start.is_sane() && self.goal.is_sane() && heading_sane) {
            return Err(Refusal::NotSane);
        }
        // Before anything is computed with it: its phases might not fit their number.
        if matches!(self.timing, Timing::Paper { interval_ticks } if interval_ticks > LONGEST_INTERVAL_TICKS)
        {
            return Err(Refusal::TooLong);
        }
        let intervals = self.intervals(limits);
        if intervals.iter().any(|motion| motion.profile.ticks() > LONGEST_INTERVAL_TICKS) {
            return Err(Refusal::TooLong);
        }
        let Timing::Paper { interval_ticks } = self.timing else { return Ok(()) };
        let needed = intervals.iter().map(|motion| motion.shortest(limits)).fold(0.0, f32::max);
        if needed > interval_ticks as f32 * TICK.0 {
            return Err(Refusal::TooShort(Infeasible { shortest: Seconds(3.0 * needed) }));
        }
        Ok(())
    }

    fn drive_heading(&self, pose: Pose) -> Radians {
        if pose.distance(self.goal).0 < SHORTEST_DRIVE.0 {
            return pose.heading;
        }
        let bearing = libm::atan2f(self.goal.y.0 - pose.y.0, self.goal.x.0 - pose.x.0);
        match self.direction {
            Direction::Forward => Radians(bearing),
            Direction::Reverse => Radians(bearing + PI).wrapped(),
        }
    }

    fn drive(&self, pose: Pose, limits: &Limits) -> IntervalMotion {
        let distance = pose.distance(self.goal).0;
        let change = match self.direction {
            _ if distance < SHORTEST_DRIVE.0 => 0.0,
            Direction::Forward => distance,
            Direction::Reverse => -distance,
        };
        let profile = match self.timing {
            Timing::Limits => Profile::shortest(Metres(change), limits),
            Timing::Paper { interval_ticks } => Profile::cosine(interval_ticks),
        };
        let origin = Pose { heading: self.drive_heading(pose), ..pose };
        IntervalMotion { interval: Interval::Drive, origin, change, law: TurnLaw::Heading, profile }
    }

    fn turn(
        &self,
        interval: Interval,
        origin: Pose,
        to: Radians,
        limits: &Limits,
    ) -> IntervalMotion {
        let change = Radians(to.0 - origin.heading.0).wrapped().0;
        let (law, profile) = match self.timing {
            Timing::Limits => {
                let rim_travel = Metres(change * limits.track.0 / 2.0);
                (TurnLaw::Heading, Profile::shortest(rim_travel, limits))
            }
            Timing::Paper { interval_ticks } => {
                let parts = libm::ceilf(change.abs() / LARGEST_PART).max(1.0) as u32;
                (TurnLaw::TanHeading { parts }, Profile::cosine(interval_ticks))
            }
        };
        IntervalMotion { interval, origin, change, law, profile }
    }
}

impl IntervalMotion {
    /// Where the robot should be at phase `k`; at the end and after, exactly the end.
    pub fn pose_at(&self, k: u32) -> Pose {
        match self.interval {
            Interval::Drive => {
                let displacement = self.change * self.profile.fraction(k);
                let (sin, cos) = sin_cos(self.origin.heading.0);
                Pose {
                    x: Metres(self.origin.x.0 + displacement * cos),
                    y: Metres(self.origin.y.0 + displacement * sin),
                    heading: self.origin.heading,
                }
            }
            Interval::FirstTurn | Interval::LastTurn => {
                let heading = Radians(self.origin.heading.0 + self.turned(k)).wrapped();
                Pose { heading, ..self.origin }
            }
        }
    }

    /// Where the robot should be at the end.
    pub fn end(&self) -> Pose {
        self.pose_at(self.profile.phases())
    }

    /// z2's whole change in one part of a turn, 2 tan(Δ/2); for the law on the heading, Δ itself.
    pub fn chained_change(&self) -> f32 {
        match self.law {
            TurnLaw::Heading => self.change,
            TurnLaw::TanHeading { parts } => {
                // Parts are below 120°, so the cosine of their half is above 1/2.
                let (sin, cos) = sin_cos(self.change / parts as f32 / 2.0);
                2.0 * sin / cos
            }
        }
    }

    /// ψ, the phase inside the running part and that part's number, for the law on tan ψ.
    pub fn within_part(&self, k: u32, parts: u32) -> (f32, u32, u32) {
        let n = self.profile.phases().max(1);
        let part = (k * parts / n).min(parts - 1);
        let local = k * parts - part * n;
        let z2 = self.chained_change() * (self.profile.fraction(local) - 0.5);
        (libm::atanf(z2), local, part)
    }

    fn turned(&self, k: u32) -> f32 {
        if k >= self.profile.phases() {
            return self.change;
        }
        match self.law {
            TurnLaw::Heading => self.change * self.profile.fraction(k),
            TurnLaw::TanHeading { parts } => {
                let (psi, _, part) = self.within_part(k, parts);
                self.change / parts as f32 * (part as f32 + 0.5) + psi
            }
        }
    }

    /// The shortest time for this interval under the paper's law, seconds.
    ///
    /// For tan ψ the acceleration is bounded by z̈2 + 2 ż2² max(sin ψ cos³ψ), max = 3√3/16.
    fn shortest(&self, limits: &Limits) -> f32 {
        const TURN_TERM: f32 = 0.324_76;
        let (v, a) = (limits.speed.0, limits.acceleration.0);
        let z = self.chained_change().abs();
        let (travel, slope, parts) = match self.law {
            TurnLaw::TanHeading { parts } => {
                let rim = limits.track.0 / 2.0;
                (rim * z, rim * z * (TAU + 8.0 * TURN_TERM * z), parts as f32)
            }
            TurnLaw::Heading => (z, TAU * z, 1.0),
        };
        parts * (2.0 * travel / v).max(libm::sqrtf(slope / a))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::motion::Position;
    use crate::units::{MetresPerSecond, MetresPerSecondSquared};
    use core::f32::consts::FRAC_PI_2;
    use proptest::prelude::*;

    const LIMITS: Limits = Limits {
        speed: MetresPerSecond(0.4),
        acceleration: MetresPerSecondSquared(0.8),
        track: Metres(0.12),
    };
    /// Poses within 3 m of the origin in f32.
    const ROUNDING: f32 = 2e-6;

    fn leg(start: Pose, goal: (f32, f32), heading: Option<f32>, timing: Timing) -> Leg {
        Leg {
            plan: 1,
            index: 0,
            start,
            goal: Position::new(goal.0, goal.1),
            goal_heading: heading.map(Radians),
            direction: Direction::Forward,
            timing,
        }
    }

    #[test]
    fn a_leg_by_hand() {
        // From (0, 0) looking along +x to (0, 1) looking along -x: a quarter turn, 1 m, a quarter turn.
        let leg = leg(Pose::new(0.0, 0.0, 0.0), (0.0, 1.0), Some(PI), Timing::Limits);
        let [first, drive, last] = leg.intervals(&LIMITS);
        assert!((first.change - FRAC_PI_2).abs() < ROUNDING);
        assert!((drive.change - 1.0).abs() < ROUNDING);
        assert!((last.change - FRAC_PI_2).abs() < ROUNDING);
        // Rim travel π/2 × 0.06 m = 0.0942 m: √(2π 0.0942 / 0.8) = 0.8603 s.
        assert_eq!(first.profile.ticks(), 173);
        let end = last.end();
        assert!((end.y.0 - 1.0).abs() < ROUNDING && end.x.0.abs() < ROUNDING);
        assert!((end.heading.0.abs() - PI).abs() < ROUNDING);
    }

    #[test]
    fn in_reverse_the_robot_looks_away_from_the_goal() {
        let mut leg = leg(Pose::new(0.0, 0.0, PI), (1.0, 0.0), None, Timing::Limits);
        leg.direction = Direction::Reverse;
        let [first, drive, last] = leg.intervals(&LIMITS);
        assert_eq!(first.change, 0.0);
        assert_eq!(drive.change, -1.0);
        assert_eq!(last.profile, Profile::EMPTY);
    }

    #[test]
    fn nonsense_is_refused() {
        let mut bad = leg(Pose::new(f32::NAN, 0.0, 0.0), (1.0, 0.0), None, Timing::Limits);
        assert_eq!(bad.check(&LIMITS), Err(Refusal::NotSane));
        bad = leg(Pose::default(), (1000.0, 0.0), None, Timing::Limits);
        assert_eq!(bad.check(&LIMITS), Err(Refusal::NotSane));
        bad = leg(Pose::default(), (1.0, 0.0), None, Timing::Paper { interval_ticks: u32::MAX });
        assert_eq!(bad.check(&LIMITS), Err(Refusal::TooLong));
    }

    #[test]
    fn a_leg_time_too_short_names_the_shortest() {
        // 1 m at 0.4 m/s: 2 D / V = 5 s an interval, 15 s a leg.
        let short = leg(Pose::default(), (1.0, 0.0), None, Timing::Paper { interval_ticks: 600 });
        let Err(Refusal::TooShort(infeasible)) = short.check(&LIMITS) else { panic!("accepted") };
        assert!((infeasible.shortest.0 - 15.0).abs() < 1e-3);
        let enough = leg(Pose::default(), (1.0, 0.0), None, Timing::Paper { interval_ticks: 1000 });
        assert_eq!(enough.check(&LIMITS), Ok(()));
    }

    proptest! {
        #[test]
        fn every_leg_ends_at_its_goal(
            x in -2.0f32..2.0, y in -2.0f32..2.0, from in -PI..PI, to in -PI..PI, paper: bool, reverse: bool,
        ) {
            let timing = if paper { Timing::Paper { interval_ticks: 400 } } else { Timing::Limits };
            let mut leg = leg(Pose::new(0.3, -0.2, from), (x, y), Some(to), timing);
            leg.direction = if reverse { Direction::Reverse } else { Direction::Forward };
            let end = leg.intervals(&LIMITS)[2].end();
            prop_assert!(end.distance(leg.goal).0 <= SHORTEST_DRIVE.0.max(ROUNDING));
            prop_assert!(Radians(end.heading.0 - to).wrapped().0.abs() < 1e-5);
        }

        #[test]
        fn the_law_on_tan_turns_monotonically_and_ends_where_the_law_on_the_heading_does(
            to in -PI..PI, at in 0.0f32..1.0,
        ) {
            let leg = leg(Pose::default(), (0.0, 0.0), Some(to), Timing::Paper { interval_ticks: 600 });
            let turn = leg.interval(Interval::LastTurn, Pose::default(), &LIMITS);
            let k = (at * turn.profile.phases() as f32) as u32;
            let (now, later) = (turn.turned(k), turn.turned(k + 2560));
            prop_assert!((later - now) * turn.change.signum() >= -1e-5);
            prop_assert!(now.abs() <= turn.change.abs() + 1e-5);
        }
    }
}
