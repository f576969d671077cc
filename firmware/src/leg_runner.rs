//! One leg while it runs: which interval, which phase, where the robot should be and how fast.
//!
//! Each interval is solved from the pose measured when it begins, so what the one before left
//! undone is not carried on. The feed-forward goes the paper's way: interval → chained input
//! (v1, v2) [Alghannam, Eq. 7, 9] → twist (u1, u2) [Eq. 5].

use crate::chained_form::ChainedInput;
use protocol::message::LegResult;
use protocol::motion::{
    Interval, IntervalMotion, Leg, Limits, PHASES_PER_TICK, Pose, TICK, TurnLaw, Twist,
};
use protocol::trigonometry::sin_cos;
use protocol::units::{MetresPerSecond, RadiansPerSecond};

/// A leg on its way.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct LegRunner {
    leg: Leg,
    motion: IntervalMotion,
    phase: u32,
    ticks: u32,
}

impl LegRunner {
    /// Begins `leg` at `pose`.
    pub(crate) fn new(leg: Leg, pose: Pose, limits: &Limits) -> Self {
        Self { leg, motion: leg.interval(Interval::FirstTurn, pose, limits), phase: 0, ticks: 0 }
    }

    /// The leg.
    pub(crate) fn leg(&self) -> &Leg {
        &self.leg
    }

    /// Where the robot should be.
    pub(crate) fn reference(&self) -> Pose {
        self.motion.pose_at(self.phase)
    }

    /// Goes `phases` further, into the next interval where one ends; false when the leg has ended.
    pub(crate) fn advance(&mut self, phases: u32, measured: Pose, limits: &Limits) -> bool {
        self.ticks += 1;
        self.phase += phases;
        while self.phase >= self.motion.profile.phases() {
            let Some(next) = self.motion.interval.next() else { return false };
            self.phase -= self.motion.profile.phases();
            self.motion = self.leg.interval(next, measured, limits);
        }
        true
    }

    /// How the leg ended, with the robot at `pose`.
    pub(crate) fn result(&self, pose: Pose) -> LegResult {
        LegResult { plan: self.leg.plan, index: self.leg.index, ticks: self.ticks, pose }
    }

    /// The planned twist at full pace.
    pub(crate) fn twist(&self) -> Twist {
        self.twist_at(self.phase)
    }

    /// The planned speed of the faster rim, m/s, and its acceleration, m/s², at full pace.
    pub(crate) fn rim_motion(&self, limits: &Limits) -> (f32, f32) {
        let speed =
            |twist: Twist| twist.linear.0.abs() + twist.angular.0.abs() * limits.track.0 / 2.0;
        let now = speed(self.twist());
        (now, (speed(self.twist_at(self.phase + PHASES_PER_TICK)) - now) / TICK.0)
    }

    fn twist_at(&self, phase: u32) -> Twist {
        let motion = &self.motion;
        let turn = match motion.law {
            _ if motion.interval == Interval::Drive => {
                // The frame lies along the drive, so cos φ = 1 and u1 = v1.
                let v1 = motion.change * motion.profile.rate(phase);
                return ChainedInput { v1, v2: 0.0 }.twist(1.0);
            }
            TurnLaw::Heading => motion.change * motion.profile.rate(phase),
            TurnLaw::TanHeading { .. } if phase >= motion.profile.phases() => 0.0,
            TurnLaw::TanHeading { parts } => {
                let (psi, local, _) = motion.within_part(phase, parts);
                let rate = parts as f32 * motion.profile.rate(local);
                let v2 = motion.chained_change() * rate;
                return ChainedInput { v1: 0.0, v2 }.twist(sin_cos(psi).1);
            }
        };
        Twist { linear: MetresPerSecond(0.0), angular: RadiansPerSecond(turn) }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::chained_form::ChainedState;
    use crate::cosine_switch::CosineSwitch;
    use proptest::prelude::*;
    use protocol::motion::{Direction, Position, Timing};
    use protocol::parameters::Parameters;

    fn paper_leg(goal: (f32, f32), heading: f32) -> Leg {
        Leg {
            plan: 1,
            index: 0,
            start: Pose::default(),
            goal: Position::new(goal.0, goal.1),
            goal_heading: Some(protocol::units::Radians(heading)),
            direction: Direction::Forward,
            timing: Timing::Paper { interval_ticks: 600 },
        }
    }

    /// The midpoint rule over 5 ms and f32 over 2000 ticks; an approximate cosine (1.1e-3) misses by 6 mm.
    const POSITION_TOLERANCE: f64 = 2e-4;
    /// The same; the approximate cosine misses by 2e-2 rad.
    const HEADING_TOLERANCE: f64 = 2e-4;

    proptest! {
        /// The paper's own form is the oracle: z at every switch, in the frame of the arena, and the
        /// twist integrated in f64, while all headings stay within ±80°.
        #[test]
        fn the_leg_ends_where_the_chained_form_says(y in -1.0f32..1.0, heading in -1.4f32..1.4) {
            let limits = Parameters::default().limits();
            let leg = paper_leg((0.8, y), heading);
            let start = ChainedState([0.0, 0.0, 0.0]);
            let end = ChainedState([0.8f32.into(), f64::from(heading).tan(), y.into()]);
            let switch = CosineSwitch::between(&start, &end, 3.0).unwrap();
            let after_turn = switch.state_at(&start, 3.0);
            let [first, drive, last] = leg.intervals(&limits);
            prop_assert!((f64::from(first.end().heading.0).tan() - after_turn.0[1]).abs() < 1e-5);
            let after_drive = switch.state_at(&start, 6.0);
            prop_assert!((f64::from(drive.end().y.0) - after_drive.0[2]).abs() < 1e-6);
            prop_assert!((f64::from(last.end().heading.0).tan() - end.0[1]).abs() < 1e-4);
        }

        #[test]
        fn the_planned_twist_leads_along_the_planned_poses(
            x in -1.0f32..1.0, y in -1.0f32..1.0, heading in -3.1f32..3.1, limited: bool,
        ) {
            let limits = Parameters::default().limits();
            let mut leg = paper_leg((x, y), heading);
            if limited {
                leg.timing = Timing::Limits;
            }
            let mut runner = LegRunner::new(leg, leg.start, &limits);
            let mut pose = [0.0f64; 3];
            let mut planned = leg.start;
            loop {
                // The middle of the tick: second order.
                let twist = runner.twist_at(runner.phase + PHASES_PER_TICK / 2);
                let turned = f64::from(twist.angular.0) * 0.005;
                let s = f64::from(twist.linear.0) * 0.005;
                pose[0] += s * (pose[2] + turned / 2.0).cos();
                pose[1] += s * (pose[2] + turned / 2.0).sin();
                pose[2] += turned;
                let interval = runner.motion.interval;
                if runner.phase + PHASES_PER_TICK >= runner.motion.profile.phases() {
                    planned = runner.motion.end();
                }
                if !runner.advance(PHASES_PER_TICK, planned, &limits) {
                    break;
                }
                if runner.motion.interval == interval {
                    let reference = runner.reference();
                    prop_assert!((f64::from(reference.x.0) - pose[0]).abs() < POSITION_TOLERANCE);
                    prop_assert!((f64::from(reference.y.0) - pose[1]).abs() < POSITION_TOLERANCE);
                }
            }
            prop_assert!((pose[2] - f64::from(heading)).sin().abs() < HEADING_TOLERANCE);
        }
    }
}
