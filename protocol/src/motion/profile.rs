//! The cosine switch's course over time: how much of an interval's change is done at phase k of N.
//!
//! The paper drives each interval with c (1 - cos wt), w = 2π/ε [Alghannam, Eq. 7, 9]. Integrated
//! and divided by the whole change c ε, that is the fraction s - sin(2πs)/(2π) with s = t/ε.
//!
//! *Deviation:* under [`Timing::Limits`](super::Timing::Limits) a long interval is cut in the middle
//! of the cosine, at its fastest moment, and cruises there: the same ramps, up to half the time.
//! Without a cruise the two forms are the same.
//!
//! | symbol | meaning | unit |
//! |---|---|---|
//! | n | phases of the interval | 1/256 tick |
//! | r | phases of one ramp, n/2 where there is no cruise | 1/256 tick |
//! | k | phase now, 0..=n | 1/256 tick |
//! | D | travel of the wheels' rims | m |
//! | V, A | speed and acceleration limits of the rims | m/s, m/s² |

use super::{Limits, PHASES_PER_TICK, TICK};
use crate::trigonometry::sin_cos;
use crate::units::{Metres, Seconds};
use core::f32::consts::{FRAC_PI_2, PI, TAU};

/// Duration and ramps of one interval.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Profile {
    ticks: u32,
    ramp: u32,
}

/// Rounding in the two formulas below must not cost a tick: one part in 10⁵ is far below what any
/// limit is known to.
const SLACK: f32 = 1e-5;

impl Profile {
    /// The interval that changes nothing and takes no time.
    pub const EMPTY: Self = Self { ticks: 0, ramp: 0 };

    /// The paper's pure cosine over `ticks` control ticks.
    pub fn cosine(ticks: u32) -> Self {
        Self { ticks, ramp: ticks.saturating_mul(PHASES_PER_TICK) / 2 }
    }

    /// The shortest interval in which the rims travel `travel` within `limits`.
    ///
    /// Up to D A / V² = π/2 it is a pure cosine of e = √(2πD/A); above, it cruises:
    /// e = D/V + πV/(2A). Rounded up to whole ticks.
    ///
    /// ```
    /// use wmr_protocol::{motion::{Limits, Profile}, units::*};
    /// let limits = Limits {
    ///     speed: MetresPerSecond(0.4),
    ///     acceleration: MetresPerSecondSquared(0.8),
    ///     track: Metres(0.12),
    /// };
    /// // 1 m: 1/0.4 + π 0.4 / 1.6 = 3.2854 s = 657.08 ticks, rounded up.
    /// assert_eq!(Profile::shortest(Metres(1.0), &limits).ticks(), 658);
    /// ```
    pub fn shortest(travel: Metres, limits: &Limits) -> Self {
        let (d, v, a) = (travel.0.abs(), limits.speed.0, limits.acceleration.0);
        if d == 0.0 {
            return Self::EMPTY;
        }
        if d * a <= FRAC_PI_2 * v * v {
            let seconds = libm::sqrtf(TAU * d / a);
            return Self::cosine(whole_ticks(seconds));
        }
        let ramp_seconds = FRAC_PI_2 * v / a;
        let ramp = libm::ceilf(ramp_seconds / TICK.0 * PHASES_PER_TICK as f32);
        let ticks = whole_ticks(d / v + ramp * TICK.0 / PHASES_PER_TICK as f32);
        Self { ticks, ramp: ramp as u32 }
    }

    /// How long it takes, control ticks.
    pub fn ticks(self) -> u32 {
        self.ticks
    }

    /// How long it takes.
    pub fn duration(self) -> Seconds {
        Seconds(self.ticks as f32 * TICK.0)
    }

    /// n: how long it takes, phases.
    pub fn phases(self) -> u32 {
        self.ticks.saturating_mul(PHASES_PER_TICK)
    }

    /// The part of the change that is done at phase `k`: 0 at 0, exactly 1 at the end and after.
    pub fn fraction(self, k: u32) -> f32 {
        let n = self.phases();
        if k >= n {
            return 1.0;
        }
        if k > n / 2 {
            return 1.0 - self.first_half(n - k);
        }
        self.first_half(k)
    }

    fn first_half(self, k: u32) -> f32 {
        let (n, r, k) = (self.phases() as f32, self.ramp as f32, k as f32);
        if k < r {
            (k - r / PI * sin_cos(PI * k / r).0) / (2.0 * (n - r))
        } else {
            (k - r / 2.0) / (n - r)
        }
    }

    /// How fast the fraction grows at phase `k`, per second: c (1 - cos wt) over c ε.
    pub fn rate(self, k: u32) -> f32 {
        let n = self.phases();
        if k >= n {
            return 0.0;
        }
        let from_end = k.min(n - k);
        let peak = self.peak_rate();
        if from_end < self.ramp {
            peak * 0.5 * (1.0 - sin_cos(PI * from_end as f32 / self.ramp as f32).1)
        } else {
            peak
        }
    }

    /// The greatest [`rate`](Self::rate), per second; 0 if empty.
    pub fn peak_rate(self) -> f32 {
        let cruise = self.phases() - self.ramp;
        if cruise == 0 { 0.0 } else { PHASES_PER_TICK as f32 / (cruise as f32 * TICK.0) }
    }

    /// The greatest change of [`rate`](Self::rate), per second squared; 0 if empty.
    pub fn peak_slope(self) -> f32 {
        if self.ramp == 0 {
            return 0.0;
        }
        let ramp_seconds = self.ramp as f32 * TICK.0 / PHASES_PER_TICK as f32;
        self.peak_rate() * FRAC_PI_2 / ramp_seconds
    }
}

fn whole_ticks(seconds: f32) -> u32 {
    libm::ceilf(seconds / TICK.0 * (1.0 - SLACK)) as u32
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::units::{MetresPerSecond, MetresPerSecondSquared};
    use proptest::prelude::*;

    /// The fractions are f32 computed from terms of order 1.
    const ROUNDING: f32 = 1e-6;

    fn limits(v: f32, a: f32) -> Limits {
        Limits {
            speed: MetresPerSecond(v),
            acceleration: MetresPerSecondSquared(a),
            track: Metres(0.12),
        }
    }

    #[test]
    fn the_pure_cosine_by_hand() {
        let profile = Profile::cosine(4);
        // s - sin(2πs)/(2π) at s = 1/4 is 1/4 - 1/(2π).
        assert!((profile.fraction(256) - (0.25 - 1.0 / TAU)).abs() < ROUNDING);
        assert!((profile.fraction(512) - 0.5).abs() < ROUNDING);
        assert_eq!(profile.fraction(1024), 1.0);
        // Fastest in the middle: 2 / (4 × 5 ms).
        assert!((profile.rate(512) - 100.0).abs() < 1e-3);
    }

    #[test]
    fn an_empty_profile_is_done_at_once() {
        assert_eq!(Profile::EMPTY.fraction(0), 1.0);
        assert_eq!(Profile::EMPTY.rate(0), 0.0);
        assert_eq!(Profile::shortest(Metres(0.0), &limits(0.4, 0.8)), Profile::EMPTY);
    }

    #[test]
    fn a_way_of_a_thousand_kilometres_overflows_nothing() {
        let profile = Profile::shortest(Metres(1e6), &limits(0.4, 0.8));
        assert!(profile.fraction(profile.phases() / 2 + 1) >= 0.5);
        assert!(profile.rate(profile.phases() - 1) >= 0.0);
    }

    proptest! {
        #[test]
        fn within_the_limits_and_close_to_bang_bang(d in 0.001f32..3.0, v in 0.05f32..1.0, a in 0.1f32..3.0) {
            let profile = Profile::shortest(Metres(d), &limits(v, a));
            prop_assert!(d * profile.peak_rate() <= v * 1.001);
            prop_assert!(d * profile.peak_slope() <= a * 1.001);
            let bang_bang = if d <= v * v / a { 2.0 * (d / a).sqrt() } else { d / v + v / a };
            // √(π/2), the worst ratio of the cosine to the time optimum, plus the rounding up to a tick.
            prop_assert!(profile.duration().0 <= 1.2534 * bang_bang + 1.01 * TICK.0);
        }

        #[test]
        fn the_rate_is_the_derivative_of_the_fraction(d in 0.05f32..2.0, at in 0.02f32..0.98) {
            let profile = Profile::shortest(Metres(d), &limits(0.4, 0.8));
            let k = (at * profile.phases() as f32) as u32;
            let step = PHASES_PER_TICK;
            let seconds = 2.0 * TICK.0;
            let slope = (profile.fraction(k + step) - profile.fraction(k.saturating_sub(step))) / seconds;
            // A central difference over two ticks of a function whose second derivative jumps by at most peak_slope.
            let tolerance = profile.peak_slope() * TICK.0 + 1e-3;
            prop_assert!(k < step || (slope - profile.rate(k)).abs() <= tolerance);
        }

        #[test]
        fn the_fraction_never_falls(ticks in 1u32..2000, at in 0.0f32..1.0) {
            let profile = Profile::cosine(ticks);
            let k = (at * profile.phases() as f32) as u32;
            prop_assert!(profile.fraction(k) <= profile.fraction(k + 64) + ROUNDING);
        }
    }
}
