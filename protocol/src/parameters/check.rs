//! Whether a robot can be driven with its numbers: each in its range, and all of them together.
//!
//! Gains are stable where what they correct dies away. The wheel loop closes over a speed that is measured
//! across 20 ms, 200 times a second; its bounds keep all poles of that loop inside the unit circle, for
//! every time constant, with a tenth of the gain to spare (the test's oracle computes it step by step). The
//! tracker's cross-track error swings as s² + k_φ s + k_y V², damped by at least 0.3, at no more than 20 rad/s,
//! which the wheel loop can follow:
//!
//! ```text
//! ω0 k_v ≤ 1.6 + 80 τ      ω0 k_i ≤ 30 (1 + ω0 k_v)      k_y V² ≤ 400      k_φ² ≥ 0.36 k_y V²
//! ```
//!
//! | symbol | meaning | unit |
//! |---|---|---|
//! | ω0, τ | no-load speed and time constant of a motor | rad/s, s |
//! | k_v, k_i | velocity and angle gain of the wheel loop | s/rad, 1/rad |
//! | k_y, k_φ | across and heading gain of the tracker | rad/m², 1/s |
//! | V | greatest speed of a rim | m/s |

use super::{BatteryLevels, FIELDS, Parameters};
use serde::{Deserialize, Serialize};

/// Why parameters are not taken.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub enum ParameterRefusal {
    /// A number is outside its range.
    OutOfRange {
        /// Its place in [`FIELDS`].
        field: u8,
        /// The number.
        value: f32,
    },
    /// The motors cannot turn the wheels as fast as the limits ask for.
    TooFast,
    /// The battery would have to stop the robot before it warns.
    BatteryLevels,
    /// The wheel loop would not settle: velocity-gain or angle-gain is too high for this motor.
    UnstableWheels,
    /// The path would be overshot again and again: across-gain is too high at this speed, or heading-gain
    /// too low.
    UnstableTracker,
    /// The robot moves, or drives a plan.
    NotAtRest,
    /// Another link's host drives.
    NotOwner,
    /// The flash does not hold what was written.
    NotStored,
}

impl Parameters {
    /// Whether a robot can be driven with these numbers.
    ///
    /// ```
    /// use wmr_protocol::{parameters::*, units::Metres};
    /// let bad = Parameters { track: Metres(0.0), ..Parameters::default() };
    /// assert_eq!(bad.check(), Err(ParameterRefusal::OutOfRange { field: 2, value: 0.0 }));
    /// ```
    ///
    /// # Errors
    /// [`ParameterRefusal`] with the first that makes no sense.
    pub fn check(&self) -> Result<(), ParameterRefusal> {
        // By reference: a copy of the table would lie on the robot's stack.
        for (place, (value, field)) in self.values().into_iter().zip(&FIELDS).enumerate() {
            // NaN is in no range.
            if !(field.least..=field.most).contains(&value) {
                return Err(ParameterRefusal::OutOfRange { field: place as u8, value });
            }
        }
        if self.speed.0 > self.wheel_radius.0 * self.wheel_loop.no_load_speed {
            return Err(ParameterRefusal::TooFast);
        }
        let BatteryLevels { warn, derate, stop } = self.battery;
        if !(warn >= derate && derate >= stop) {
            return Err(ParameterRefusal::BatteryLevels);
        }
        self.check_gains()
    }

    fn check_gains(&self) -> Result<(), ParameterRefusal> {
        let wheel = &self.wheel_loop;
        let velocity = wheel.no_load_speed * wheel.velocity_gain;
        let angle = wheel.no_load_speed * wheel.angle_gain;
        if velocity > 1.6 + 80.0 * wheel.time_constant || angle > 30.0 * (1.0 + velocity) {
            return Err(ParameterRefusal::UnstableWheels);
        }
        let across = self.tracker.across * self.speed.0 * self.speed.0;
        let heading = self.tracker.heading;
        if across > 400.0 || heading * heading < 0.36 * across {
            return Err(ParameterRefusal::UnstableTracker);
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::parameters::WheelLoopGains;
    use crate::units::MetresPerSecond;
    use proptest::prelude::*;

    #[test]
    fn numbers_that_contradict_each_other_are_refused() {
        let fast = Parameters { speed: MetresPerSecond(0.7), ..Parameters::default() };
        assert_eq!(fast.check(), Err(ParameterRefusal::TooFast));
        let mut upside_down = Parameters::default();
        upside_down.battery.stop = 7.2;
        assert_eq!(upside_down.check(), Err(ParameterRefusal::BatteryLevels));
        let nan = Parameters { wheel_ratio: f32::NAN, ..Parameters::default() };
        assert!(matches!(nan.check(), Err(ParameterRefusal::OutOfRange { field: 1, .. })));
    }

    #[test]
    fn gains_by_hand() {
        let with = |field: &str, value: f32| {
            let mut values = Parameters::default().values();
            values[FIELDS.iter().position(|known| known.name == field).unwrap()] = value;
            Parameters::default().with_values(values).check()
        };
        // 1.6 + 80 * 0.06 = 6.4 = 18 * 0.3556.
        assert_eq!(with("velocity-gain", 0.355), Ok(()));
        assert_eq!(with("velocity-gain", 0.357), Err(ParameterRefusal::UnstableWheels));
        // 30 * (1 + 18 * 0.144) = 107.76 = 18 * 5.987.
        assert_eq!(with("angle-gain", 5.98), Ok(()));
        assert_eq!(with("angle-gain", 5.99), Err(ParameterRefusal::UnstableWheels));
        // 0.36 * 225 * 0.4^2 = 12.96 = 3.6^2.
        assert_eq!(with("heading-gain", 3.61), Ok(()));
        assert_eq!(with("heading-gain", 3.59), Err(ParameterRefusal::UnstableTracker));
        // 400 / 0.4^2 = 2500 is out of range anyway; 2000 needs a heading gain of 10.7.
        assert_eq!(with("across-gain", 2000.0), Ok(()));
        assert_eq!(with("across-gain", 0.0), Ok(()));
    }

    /// What is left of a wheel's disturbance after so many ticks: τ ω̇ = ω0 duty - ω in closed form from
    /// tick to tick, speed measured over four of them.
    fn left_over(no_load: f64, tau: f64, velocity_gain: f64, angle_gain: f64, ticks: usize) -> f64 {
        let tick = 0.005;
        let (mut speed, mut angles) = (1.0, [0.0; 5]);
        let decay = if tau > 0.0 { (-tick / tau).exp() } else { 0.0 };
        let mut largest: f64 = 0.0;
        for n in 0..ticks {
            let [.., newest] = angles;
            let measured = (newest - angles[0]) / (4.0 * tick);
            let end = no_load * (-velocity_gain * measured - angle_gain * newest);
            let way = end * tick + (speed - end) * tau * (1.0 - decay);
            speed = end + (speed - end) * decay;
            angles.rotate_left(1);
            angles[4] = newest + way;
            if n + 200 > ticks {
                largest = largest.max(speed.abs());
            }
        }
        largest
    }

    proptest! {
        #[test]
        fn what_accepted_gains_correct_dies_away(
            exponent in -3.5f32..0.0,
            velocity in 0.0f32..1.0,
            angle in 0.0f32..1.0,
            no_load_speed in 12.0f32..200.0,
        ) {
            let time_constant = 10f32.powf(exponent);
            let most = 1.6 + 80.0 * time_constant;
            let velocity_gain = (velocity * 1.2 * most / no_load_speed).min(10.0);
            let most = 30.0 * (1.0 + no_load_speed * velocity_gain);
            let angle_gain = ((0.1 + 1.1 * angle) * most / no_load_speed).min(100.0);
            let wheel_loop = WheelLoopGains {
                no_load_speed,
                time_constant,
                velocity_gain,
                angle_gain,
                ..WheelLoopGains::default()
            };
            let taken = Parameters { wheel_loop, ..Parameters::default() };
            if taken.check().is_ok() {
                let [w, t, v, i] = [no_load_speed, time_constant, velocity_gain, angle_gain].map(f64::from);
                let left = left_over(w, t, v, i, 20_000);
                prop_assert!(left < 0.05, "{left}: {wheel_loop:?}");
            } else {
                prop_assert_eq!(taken.check(), Err(ParameterRefusal::UnstableWheels));
            }
        }
    }
}
