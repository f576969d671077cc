//! Every number of a robot by name, with its unit and range, for those who show, change or check them.

use super::{BatteryLevels, DIVIDER_STEP, Parameters, TrackerGains, WheelLoopGains, Wiring};
use crate::units::{Metres, MetresPerSecond, MetresPerSecondSquared};

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

impl Parameters {
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
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
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
    }
}
