//! What one robot is: its lengths, its encoders, its motors, its limits and its gains.
//!
//! Every number that differs from robot to robot stands here, with its unit, its range and where its
//! default comes from; no other module holds one. The host reads and writes them over the link, the
//! robot keeps them in flash.
//!
//! | symbol | meaning | unit |
//! |---|---|---|
//! | r | mean radius of the two wheels | m |
//! | ρ | radius of the right wheel over that of the left | – |
//! | b | track: distance between the wheels' contact points | m |
//! | ω0, τ | no-load speed and time constant of a motor | rad/s, s |

mod check;
mod fields;
mod wiring;

pub use check::ParameterRefusal;
pub use fields::{FIELDS, Field};
pub use wiring::Wiring;

use crate::motion::Limits;
use crate::units::{Metres, MetresPerSecond, MetresPerSecondSquared};
use serde::{Deserialize, Serialize};

/// All of one robot's numbers.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Parameters {
    /// r.
    pub wheel_radius: Metres,
    /// ρ.
    pub wheel_ratio: f32,
    /// b.
    pub track: Metres,
    /// Encoder counts in one turn of a wheel, all four edges counted.
    pub counts_per_turn: u16,
    /// V: the greatest speed of a wheel's rim.
    pub speed: MetresPerSecond,
    /// A: the greatest acceleration of a wheel's rim.
    pub acceleration: MetresPerSecondSquared,
    /// How the wheel loop answers.
    pub wheel_loop: WheelLoopGains,
    /// How deviations from the path are corrected.
    pub tracker: TrackerGains,
    /// What the battery's voltage means.
    pub battery: BatteryLevels,
    /// Which calibration the lengths come from; 0 for none.
    pub calibration: u32,
    /// Which way round motors and encoders are connected.
    pub wiring: Wiring,
    /// What the divider before the battery pin divides by, in steps of [`DIVIDER_STEP`]; 0 for none fitted.
    pub battery_divider: u8,
}

/// A step of [`Parameters::battery_divider`].
pub const DIVIDER_STEP: f32 = 0.05;

/// How a wheel's velocity loop answers; the same for both wheels.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct WheelLoopGains {
    /// ω0, rad/s.
    pub no_load_speed: f32,
    /// τ, s.
    pub time_constant: f32,
    /// The duty at which a resting wheel begins to turn.
    pub breakaway_duty: f32,
    /// k_v, duty per rad/s.
    pub velocity_gain: f32,
    /// k_i, duty per rad.
    pub angle_gain: f32,
}

/// How strongly deviations from the path are corrected.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct TrackerGains {
    /// k_x, 1/s.
    pub along: f32,
    /// k_y, rad/m².
    pub across: f32,
    /// k_φ, 1/s.
    pub heading: f32,
}

/// Below which voltages the robot warns, slows down and stops, volts.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct BatteryLevels {
    /// It says so.
    pub warn: f32,
    /// It drives more slowly.
    pub derate: f32,
    /// It stops on the path and refuses plans.
    pub stop: f32,
}

impl Default for Parameters {
    /// A small robot with 70 mm wheels on N20-class gear motors and four NiMH cells behind a divider of
    /// 2.2 kΩ and 1 kΩ.
    fn default() -> Self {
        Self {
            wheel_radius: Metres(0.035),
            wheel_ratio: 1.0,
            track: Metres(0.12),
            counts_per_turn: 1440,
            speed: MetresPerSecond(0.4),
            acceleration: MetresPerSecondSquared(0.8),
            wheel_loop: WheelLoopGains::default(),
            tracker: TrackerGains::default(),
            battery: BatteryLevels::default(),
            calibration: 0,
            wiring: Wiring::default(),
            battery_divider: 64,
        }
    }
}

impl Default for WheelLoopGains {
    /// For ω0 = 18 rad/s and τ = 60 ms: a closed loop of 30 rad/s, critically damped,
    /// τ s² + (1 + ω0 k_v) s + ω0 k_i = τ (s + 30)².
    fn default() -> Self {
        Self {
            no_load_speed: 18.0,
            time_constant: 0.06,
            breakaway_duty: 0.03,
            velocity_gain: 0.144,
            angle_gain: 3.0,
        }
    }
}

impl Default for TrackerGains {
    /// Slower than the wheel loop's 30 rad/s by a factor of five, critically damped at 0.4 m/s:
    /// s² + k_φ s + k_y u² with k_φ² = 4 k_y u².
    fn default() -> Self {
        Self { along: 6.0, across: 225.0, heading: 12.0 }
    }
}

impl Default for BatteryLevels {
    /// Four NiMH cells in series: 1.15, 1.1 and 1.05 V each under load, where little is left.
    fn default() -> Self {
        Self { warn: 4.6, derate: 4.4, stop: 4.2 }
    }
}

impl Parameters {
    /// What the wheels may do.
    pub fn limits(&self) -> Limits {
        Limits { speed: self.speed, acceleration: self.acceleration, track: self.track }
    }

    /// The angle of a wheel that one encoder count stands for, radians.
    pub fn radians_per_count(&self) -> f32 {
        core::f32::consts::TAU / f32::from(self.counts_per_turn)
    }

    /// What the divider before the battery pin divides by; 0 for none fitted.
    pub fn divider(&self) -> f32 {
        f32::from(self.battery_divider) * DIVIDER_STEP
    }

    /// The parameters as bytes, for a store; returns how many of `out` they take.
    ///
    /// `None` if `out` is shorter than [`ENCODED_SIZE`].
    pub fn encode(&self, out: &mut [u8]) -> Option<usize> {
        postcard::to_slice(self, out).ok().map(|bytes| bytes.len())
    }

    /// The parameters that [`encode`](Self::encode) wrote; `None` if it did not write these bytes.
    pub fn decode(bytes: &[u8]) -> Option<Self> {
        match postcard::take_from_bytes(bytes) {
            Ok((parameters, [])) => Some(parameters),
            _ => None,
        }
    }
}

/// No encoding is longer: 16 f32, varints of at most 3 and 5 bytes, and two bytes.
pub const ENCODED_SIZE: usize = 16 * 4 + 3 + 5 + 2;

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn the_defaults_make_sense() {
        assert_eq!(Parameters::default().check(), Ok(()));
    }

    proptest! {
        #[test]
        fn bytes_bring_the_same_back(values in prop::array::uniform25(-1e6f32..1e6), calibration: u32) {
            let parameters = Parameters { calibration, ..Parameters::default().with_values(values) };
            let mut bytes = [0; ENCODED_SIZE];
            let length = parameters.encode(&mut bytes).unwrap();
            prop_assert_eq!(Parameters::decode(&bytes[..length]), Some(parameters));
            prop_assert_eq!(Parameters::decode(&bytes[..length - 1]), None);
        }
    }
}
