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

/// Which way round motors and encoders are connected: one bit each, none of them on a robot that is
/// wired as the drawing has it.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct Wiring(pub u8);

impl Wiring {
    /// The motor on the left outputs rolls its wheel backward on a positive duty.
    pub const LEFT_MOTOR_REVERSED: Self = Self(1);
    /// The same on the right outputs.
    pub const RIGHT_MOTOR_REVERSED: Self = Self(2);
    /// The encoder on the left inputs counts down as its wheel rolls forward.
    pub const LEFT_ENCODER_REVERSED: Self = Self(4);
    /// The same on the right inputs.
    pub const RIGHT_ENCODER_REVERSED: Self = Self(8);
    /// The right motor is on the left outputs, and the left one on the right.
    pub const MOTORS_SWAPPED: Self = Self(16);
    /// The right encoder is on the left inputs, and the left one on the right.
    pub const ENCODERS_SWAPPED: Self = Self(32);
    /// A person has seen that all this is right.
    pub const CHECKED: Self = Self(64);

    /// Whether `bit` is set.
    pub fn has(self, bit: Self) -> bool {
        self.0 & bit.0 != 0
    }

    /// The same with `bit` set or not.
    pub fn with(self, bit: Self, set: bool) -> Self {
        Self(if set { self.0 | bit.0 } else { self.0 & !bit.0 })
    }

    /// What the inputs count as counts of the left and the right wheel.
    pub fn wheels(self, inputs: [i32; 2]) -> [i32; 2] {
        let [left, right] = inputs;
        let counts = [
            if self.has(Self::LEFT_ENCODER_REVERSED) { left.wrapping_neg() } else { left },
            if self.has(Self::RIGHT_ENCODER_REVERSED) { right.wrapping_neg() } else { right },
        ];
        swapped_if(self.has(Self::ENCODERS_SWAPPED), counts)
    }

    /// The inputs behind what [`wheels`](Self::wheels) made of them.
    pub fn inputs(self, wheels: [i32; 2]) -> [i32; 2] {
        let swap = Self::ENCODERS_SWAPPED;
        self.with(swap, false).wheels(swapped_if(self.has(swap), wheels))
    }

    /// The duty of the left and the right outputs that turns the wheels with `duty`.
    pub fn outputs(self, duty: [f32; 2]) -> [f32; 2] {
        let [left, right] = swapped_if(self.has(Self::MOTORS_SWAPPED), duty);
        [
            if self.has(Self::LEFT_MOTOR_REVERSED) { -left } else { left },
            if self.has(Self::RIGHT_MOTOR_REVERSED) { -right } else { right },
        ]
    }
}

fn swapped_if<T>(swap: bool, [left, right]: [T; 2]) -> [T; 2] {
    if swap { [right, left] } else { [left, right] }
}

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

/// One number of [`Parameters`], for those who show or change it by name.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Field {
    /// What it is called.
    pub name: &'static str,
    /// Its unit; empty for a plain number.
    pub unit: &'static str,
    /// The least that makes sense.
    pub least: f32,
    /// The most that makes sense.
    pub most: f32,
}

const fn field(name: &'static str, unit: &'static str, least: f32, most: f32) -> Field {
    Field { name, unit, least, most }
}

/// The numbers in the order of [`Parameters::values`].
pub static FIELDS: [Field; 25] = [
    field("wheel-radius", "m", 0.005, 0.5),
    field("wheel-ratio", "", 0.9, 1.1),
    field("track", "m", 0.02, 2.0),
    field("counts-per-turn", "", 4.0, 65_535.0),
    field("speed", "m/s", 0.01, 5.0),
    field("acceleration", "m/s2", 0.01, 20.0),
    field("no-load-speed", "rad/s", 0.5, 500.0),
    field("time-constant", "s", 0.0, 1.0),
    field("breakaway-duty", "", 0.0, 0.5),
    field("velocity-gain", "s/rad", 0.0, 10.0),
    field("angle-gain", "1/rad", 0.0, 100.0),
    field("along-gain", "1/s", 0.0, 30.0),
    field("across-gain", "rad/m2", 0.0, 2000.0),
    field("heading-gain", "1/s", 0.0, 30.0),
    field("battery-warn", "V", 0.0, 60.0),
    field("battery-derate", "V", 0.0, 60.0),
    field("battery-stop", "V", 0.0, 60.0),
    field("left-motor-reversed", "", 0.0, 1.0),
    field("right-motor-reversed", "", 0.0, 1.0),
    field("left-encoder-reversed", "", 0.0, 1.0),
    field("right-encoder-reversed", "", 0.0, 1.0),
    field("motors-swapped", "", 0.0, 1.0),
    field("encoders-swapped", "", 0.0, 1.0),
    field("wiring-checked", "", 0.0, 1.0),
    field("battery-divider", "", 0.0, 12.75),
];

/// The bits of [`Wiring`] in the order of [`FIELDS`].
const WIRING_BITS: [Wiring; 7] = [
    Wiring::LEFT_MOTOR_REVERSED,
    Wiring::RIGHT_MOTOR_REVERSED,
    Wiring::LEFT_ENCODER_REVERSED,
    Wiring::RIGHT_ENCODER_REVERSED,
    Wiring::MOTORS_SWAPPED,
    Wiring::ENCODERS_SWAPPED,
    Wiring::CHECKED,
];

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
    /// The robot moves, or drives a plan.
    NotAtRest,
    /// Another link's host drives.
    NotOwner,
    /// The flash does not hold what was written.
    NotStored,
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

    /// The numbers in the order of [`FIELDS`].
    pub fn values(&self) -> [f32; FIELDS.len()] {
        let (wheel, tracker, battery) = (&self.wheel_loop, &self.tracker, &self.battery);
        let [lm, rm, le, re, motors, encoders, checked] =
            WIRING_BITS.map(|bit| f32::from(u8::from(self.wiring.has(bit))));
        [
            self.wheel_radius.0,
            self.wheel_ratio,
            self.track.0,
            self.counts_per_turn.into(),
            self.speed.0,
            self.acceleration.0,
            wheel.no_load_speed,
            wheel.time_constant,
            wheel.breakaway_duty,
            wheel.velocity_gain,
            wheel.angle_gain,
            tracker.along,
            tracker.across,
            tracker.heading,
            battery.warn,
            battery.derate,
            battery.stop,
            lm,
            rm,
            le,
            re,
            motors,
            encoders,
            checked,
            self.divider(),
        ]
    }

    /// The same robot with other numbers, in the order of [`FIELDS`].
    pub fn with_values(&self, values: [f32; FIELDS.len()]) -> Self {
        let [radius, ratio, track, counts, speed, acceleration, rest @ ..] = values;
        let [no_load_speed, time_constant, breakaway_duty, velocity_gain, angle_gain, rest @ ..] =
            rest;
        let [along, across, heading, warn, derate, stop, rest @ ..] = rest;
        let [bits @ .., divider] = rest;
        let wiring = WIRING_BITS
            .into_iter()
            .zip(bits)
            .fold(Wiring::default(), |wiring, (bit, set)| wiring.with(bit, set >= 0.5));
        Self {
            wheel_radius: Metres(radius),
            wheel_ratio: ratio,
            track: Metres(track),
            counts_per_turn: counts as u16,
            speed: MetresPerSecond(speed),
            acceleration: MetresPerSecondSquared(acceleration),
            wheel_loop: WheelLoopGains {
                no_load_speed,
                time_constant,
                breakaway_duty,
                velocity_gain,
                angle_gain,
            },
            tracker: TrackerGains { along, across, heading },
            battery: BatteryLevels { warn, derate, stop },
            calibration: self.calibration,
            wiring,
            battery_divider: (divider / DIVIDER_STEP + 0.5) as u8,
        }
    }

    /// What the divider before the battery pin divides by; 0 for none fitted.
    pub fn divider(&self) -> f32 {
        f32::from(self.battery_divider) * DIVIDER_STEP
    }

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
        Ok(())
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
    fn wiring_by_hand() {
        let built = Wiring::default();
        assert_eq!((built.wheels([3, 5]), built.outputs([0.3, 0.5])), ([3, 5], [0.3, 0.5]));
        let mirrored = built
            .with(Wiring::RIGHT_MOTOR_REVERSED, true)
            .with(Wiring::RIGHT_ENCODER_REVERSED, true);
        assert_eq!((mirrored.wheels([3, 5]), mirrored.outputs([0.3, 0.5])), ([3, -5], [0.3, -0.5]));
        // The right wheel's encoder is on the left inputs, and counts backward there.
        let swapped =
            built.with(Wiring::ENCODERS_SWAPPED, true).with(Wiring::LEFT_ENCODER_REVERSED, true);
        assert_eq!(swapped.wheels([-5, 3]), [3, 5]);
        // The same for its motor.
        let swapped =
            built.with(Wiring::MOTORS_SWAPPED, true).with(Wiring::LEFT_MOTOR_REVERSED, true);
        assert_eq!(swapped.outputs([0.3, 0.5]), [-0.5, 0.3]);
    }

    proptest! {
        #[test]
        fn inputs_are_what_the_wheels_were_made_of(bits in 0u8..128, left: i32, right: i32) {
            let wiring = Wiring(bits);
            prop_assert_eq!(wiring.inputs(wiring.wheels([left, right])), [left, right]);
        }

        #[test]
        fn every_number_has_its_own_place(place in 0usize..FIELDS.len(), value in 5.0f32..60_000.0) {
            let mut values = Parameters::default().values();
            values[place] = match FIELDS[place].most {
                1.0 => 1.0,
                12.75 => 4.0,
                _ => value.floor(),
            };
            prop_assert_eq!(Parameters::default().with_values(values).values(), values);
        }

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
