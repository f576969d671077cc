//! Quantities with their units: SI, radians, single precision as the robot computes and the wire carries.
//!
//! A quantity is a plain number in a named wrapper. Formulas take the number out (`.0`) and use the
//! paper's letters; public signatures keep the wrapper, so that metres are never mixed with radians.

use core::f32::consts::{PI, TAU};
use serde::{Deserialize, Serialize};

/// A length or coordinate, metres.
#[derive(Clone, Copy, Debug, Default, PartialEq, PartialOrd, Serialize, Deserialize)]
pub struct Metres(pub f32);

/// An angle, radians, counter-clockwise.
#[derive(Clone, Copy, Debug, Default, PartialEq, PartialOrd, Serialize, Deserialize)]
pub struct Radians(pub f32);

/// A duration, seconds.
#[derive(Clone, Copy, Debug, Default, PartialEq, PartialOrd, Serialize, Deserialize)]
pub struct Seconds(pub f32);

/// A speed along a line, metres per second.
#[derive(Clone, Copy, Debug, Default, PartialEq, PartialOrd, Serialize, Deserialize)]
pub struct MetresPerSecond(pub f32);

/// An acceleration along a line, metres per second squared.
#[derive(Clone, Copy, Debug, Default, PartialEq, PartialOrd, Serialize, Deserialize)]
pub struct MetresPerSecondSquared(pub f32);

/// A speed of rotation, radians per second, counter-clockwise.
#[derive(Clone, Copy, Debug, Default, PartialEq, PartialOrd, Serialize, Deserialize)]
pub struct RadiansPerSecond(pub f32);

/// A moment on the clock of whoever names it, milliseconds; wraps after 49 days.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct Milliseconds(pub u32);

impl Radians {
    /// The same direction in (-π, π]; a half turn is +π, so that it is always driven the same way.
    ///
    /// ```
    /// use wmr_protocol::units::Radians;
    /// use core::f32::consts::PI;
    /// assert_eq!(Radians(-PI).wrapped(), Radians(PI));
    /// assert!((Radians(7.0).wrapped().0 - (7.0 - 2.0 * PI)).abs() < 1e-6);
    /// ```
    pub fn wrapped(self) -> Self {
        // The most usual case, and on a processor without floating point a division is slow.
        if self.0 > -PI && self.0 <= PI {
            return self;
        }
        let turns = libm::floorf((PI - self.0) / TAU);
        let angle = self.0 + turns * TAU;
        // Rounding may leave the half-open range by one unit in the last place.
        if angle <= -PI || angle > PI { Self(PI) } else { Self(angle) }
    }
}

impl Milliseconds {
    /// How long ago `earlier` was, as seen from `self`, milliseconds.
    pub fn since(self, earlier: Self) -> u32 {
        self.0.wrapping_sub(earlier.0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    /// f32 keeps 24 bits; angles up to 100 rad are exact to 8e-6.
    const ROUNDING: f32 = 2e-5;

    proptest! {
        #[test]
        fn wrapping_keeps_the_direction(angle in -100.0f32..100.0) {
            let wrapped = Radians(angle).wrapped().0;
            prop_assert!(wrapped > -PI && wrapped <= PI);
            prop_assert!((f64::from(wrapped).sin() - f64::from(angle).sin()).abs() < f64::from(ROUNDING));
            prop_assert!((f64::from(wrapped).cos() - f64::from(angle).cos()).abs() < f64::from(ROUNDING));
        }
    }

    #[test]
    fn a_moment_before_the_wrap_is_still_earlier() {
        assert_eq!(Milliseconds(4).since(Milliseconds(u32::MAX - 5)), 10);
    }
}
