//! σ, the pace at which a leg's own time runs: 1 as planned, 0 held.
//!
//! A pause, a stop and the host's silence slow that time down, so that the robot comes to rest *on
//! its path* within the limits. With the rims at σ v, their acceleration is σ' v + σ² a; setting that
//! to ±A gives σ' = (±A - σ² a)/v.
//!
//! | symbol | meaning | unit |
//! |---|---|---|
//! | v, a | planned speed and acceleration of the faster rim | m/s, m/s² |
//! | A | the rims' acceleration limit | m/s² |

use protocol::motion::{PHASES_PER_TICK, TICK, Twist};
use protocol::units::{MetresPerSecond, RadiansPerSecond};

/// Below this planned rim speed the pace may change as it likes: nothing moves, m/s.
const CREEP: f32 = 0.005;

/// σ.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Pace(f32);

impl Pace {
    /// σ = 1.
    pub(crate) const FULL: Self = Self(1.0);

    /// σ.
    pub(crate) fn value(self) -> f32 {
        self.0
    }

    /// The twist at this pace of what is planned as `planned`.
    pub(crate) fn scale(self, planned: Twist) -> Twist {
        Twist {
            linear: MetresPerSecond(planned.linear.0 * self.0),
            angular: RadiansPerSecond(planned.angular.0 * self.0),
        }
    }

    /// How many phases a tick is at this pace, if the wheels manage `share` of what is wanted of them.
    pub(crate) fn phases(self, share: f32) -> u32 {
        (self.0 * share * PHASES_PER_TICK as f32) as u32
    }

    /// One tick towards `target`, with the rims planned at (v, a) and allowed A.
    pub(crate) fn towards(self, target: f32, (v, a): (f32, f32), limit: f32) -> Self {
        if self.0 == target || v < CREEP {
            return Self(target);
        }
        let step = (limit.copysign(target - self.0) - self.0 * self.0 * a) / v * TICK.0;
        Self(if target > self.0 {
            (self.0 + step.max(0.0)).min(target)
        } else {
            (self.0 + step.min(0.0)).max(target)
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn a_stop_from_full_speed_by_hand() {
        // 0.8 m/s² takes 0.4 m/s off in half a second, a hundred ticks.
        let pace = (0..100).fold(Pace::FULL, |pace, _| pace.towards(0.0, (0.4, 0.0), 0.8));
        assert!(pace.value() < 1e-3);
        let pace = (0..90).fold(Pace::FULL, |pace, _| pace.towards(0.0, (0.4, 0.0), 0.8));
        assert!((pace.value() - 0.1).abs() < 1e-3);
    }

    proptest! {
        #[test]
        fn the_rims_keep_their_acceleration(
            pace in 0.0f32..1.0, target in 0.0f32..1.0, v in 0.1f32..0.4, a in -0.8f32..0.8,
        ) {
            let next = Pace(pace).towards(target, (v, a), 0.8);
            prop_assert!((0.0..=1.0).contains(&next.value()));
            prop_assert!((next.value() - target).abs() <= (pace - target).abs());
            // Speed now and a tick later, were the pace not at its end.
            let acceleration = (next.value() * (v + a * pace * TICK.0) - pace * v) / TICK.0;
            // Where the plan itself brakes or speeds up harder than the pace could make up for, it is the plan's.
            // The step is one of first order; at 0.1 m/s it errs by σ' a < 0.1 m/s².
            let bound = 0.8f32.max(pace * pace * a.abs()) + 0.1;
            prop_assert!(acceleration.abs() <= bound, "{acceleration}");
        }
    }
}
