//! How long turns, drives and whole legs take at least: what orders a search.
//!
//! | symbol | meaning | unit |
//! |---|---|---|
//! | D | travel of the faster rim | m |
//! | V, A | limits of the rims | m/s, m/s² |
//! | δ | the least length of a leg | m |
//!
//! A drive takes √(2πD/A), or D/V + πV/(2A) where it cruises, so two drives take longer than one of the
//! same length together: by at least what one of δ adds.

use crate::geometry::wrap_angle;
use protocol::motion::{Limits, TICK, Timing};
use std::f64::consts::{FRAC_PI_2, PI, TAU};

/// Durations within limits.
#[derive(Clone, Copy, Debug)]
pub(super) struct Times {
    speed: f64,
    acceleration: f64,
    rim: f64,
    /// By the paper's timing every leg takes as long.
    leg: Option<f64>,
    shortest: f64,
}

impl Times {
    /// For legs no shorter than `shortest`.
    pub(super) fn new(limits: Limits, timing: Timing, shortest: f64) -> Self {
        let leg = match timing {
            Timing::Limits => None,
            Timing::Paper { interval_ticks } => {
                Some(3.0 * f64::from(interval_ticks) * f64::from(TICK.0))
            }
        };
        Self {
            speed: limits.speed.0.into(),
            acceleration: limits.acceleration.0.into(),
            rim: f64::from(limits.track.0) / 2.0,
            leg,
            shortest,
        }
    }

    /// A drive over a distance.
    pub(super) fn drive(&self, distance: f64) -> f64 {
        let (v, a) = (self.speed, self.acceleration);
        if distance * a <= FRAC_PI_2 * v * v {
            (TAU * distance / a).sqrt()
        } else {
            distance / v + FRAC_PI_2 * v / a
        }
    }

    /// A turn on the spot.
    pub(super) fn turn(&self, change: f64) -> f64 {
        if self.leg.is_some() {
            return 0.0;
        }
        self.drive(self.rim * wrap_angle(change).abs())
    }

    /// A leg of two turns and a drive.
    pub(super) fn leg(&self, first: f64, distance: f64, last: f64) -> f64 {
        self.leg.unwrap_or_else(|| self.turn(first) + self.drive(distance) + self.turn(last))
    }

    /// Two legs or more over a distance, at least.
    pub(super) fn by_two(&self, distance: f64) -> f64 {
        if let Some(leg) = self.leg {
            return 2.0 * leg;
        }
        let first = self.shortest.min(distance / 2.0);
        self.drive(first) + self.drive(distance - first)
    }

    /// The legs over a distance to the goal, which lies `turn` from where the robot looks, at least.
    pub(super) fn rest(&self, turn: f64, distance: f64, is_reversible: bool) -> f64 {
        let forward = self.turn(turn);
        let turned = if is_reversible { forward.min(self.turn(turn + PI)) } else { forward };
        self.leg.unwrap_or(turned + self.drive(distance)).min(self.by_two(distance))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::legs::DEFAULT_LIMITS;
    use proptest::prelude::*;
    use protocol::motion::Profile;
    use protocol::units::Metres;

    /// A profile is rounded up to a tick of 5 ms.
    const ROUNDED: f64 = 0.0051;

    proptest! {
        #[test]
        fn drives_take_what_their_profiles_take(distance in 0.01f64..3.0) {
            let times = Times::new(DEFAULT_LIMITS, Timing::Limits, 0.05);
            let real = f64::from(Profile::shortest(Metres(distance as f32), &DEFAULT_LIMITS).duration().0);
            let hoped = times.drive(distance);
            prop_assert!(hoped <= real + 1e-4 && real <= hoped + ROUNDED, "{hoped} {real}");
        }

        #[test]
        fn two_legs_take_no_less_than_hoped(first in 0.05f64..2.0, second in 0.05f64..2.0) {
            let times = Times::new(DEFAULT_LIMITS, Timing::Limits, 0.05);
            let real = times.drive(first) + times.drive(second);
            prop_assert!(times.by_two(first + second) <= real + 1e-9);
            prop_assert!(times.by_two(first.max(second)) <= real + 1e-9, "a detour");
        }
    }
}
