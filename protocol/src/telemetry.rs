//! Where the robot is, as often as the wire carries it: units outside, whole numbers on the wire.
//!
//! At 50 frames a second telemetry may take 15 % of 115 200 baud, 34 bytes a frame with header, CRC
//! and COBS. So the wire carries varints in steps that are finer than the encoders': at most 20
//! bytes for a pose within 100 m.
//!
//! | field | step on the wire |
//! |---|---|
//! | x, y | 0.1 mm |
//! | heading | 2π/65536 |
//! | wheel speeds | 0.005 rad/s, up to ±41 rad/s in two bytes |

use crate::message::State;
use crate::motion::{Pose, WheelSpeeds};
use crate::units::RadiansPerSecond;
use core::f32::consts::TAU;
use serde::{Deserialize, Serialize};

/// Where the robot is and what it does, several times a second.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(into = "Packed", from = "Packed")]
pub struct Telemetry {
    /// Control ticks since the robot started.
    pub ticks: u32,
    /// Where it believes it stands.
    pub pose: Pose,
    /// How fast its wheels turn, measured.
    pub wheels: WheelSpeeds,
    /// What it does.
    pub state: State,
    /// The leg that it drives, or drove last.
    pub leg: u16,
}

/// A step of x and y, m.
pub const POSITION_STEP: f32 = 1e-4;
/// A step of the heading, rad.
pub const HEADING_STEP: f32 = TAU / 65_536.0;
/// A step of the wheels' speeds, rad/s.
pub const SPEED_STEP: f32 = 0.005;

#[derive(Serialize, Deserialize)]
#[serde(rename = "Telemetry")]
struct Packed {
    ticks: u32,
    x: i32,
    y: i32,
    #[serde(with = "postcard::fixint::le")]
    heading: i16,
    left: i16,
    right: i16,
    state: State,
    leg: u16,
}

impl From<Telemetry> for Packed {
    fn from(telemetry: Telemetry) -> Self {
        let Telemetry { ticks, pose, wheels, state, leg } = telemetry;
        // `as` saturates, except for the heading, where half a turn either way is the same.
        Self {
            ticks,
            x: libm::roundf(pose.x.0 / POSITION_STEP) as i32,
            y: libm::roundf(pose.y.0 / POSITION_STEP) as i32,
            heading: libm::roundf(pose.heading.0 / HEADING_STEP) as i32 as i16,
            left: libm::roundf(wheels.left.0 / SPEED_STEP) as i16,
            right: libm::roundf(wheels.right.0 / SPEED_STEP) as i16,
            state,
            leg,
        }
    }
}

impl From<Packed> for Telemetry {
    fn from(packed: Packed) -> Self {
        let Packed { ticks, x, y, heading, left, right, state, leg } = packed;
        let [x, y] = [x, y].map(|steps| steps as f32 * POSITION_STEP);
        let [left, right] =
            [left, right].map(|steps| RadiansPerSecond(f32::from(steps) * SPEED_STEP));
        let mut pose = Pose::new(x, y, f32::from(heading) * HEADING_STEP);
        pose.heading = pose.heading.wrapped();
        Self { ticks, pose, wheels: WheelSpeeds { left, right }, state, leg }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::frame::{Header, MAX_FRAME, decode, encode};
    use crate::message::Report;
    use proptest::prelude::*;

    /// 15 % of 115 200 baud at ten bits a byte, for 50 frames a second.
    const BUDGET: usize = 115_200 / 10 * 15 / 100 / 50;

    fn telemetry(pose: Pose, speed: f32) -> Telemetry {
        let wheels = WheelSpeeds { left: RadiansPerSecond(speed), right: RadiansPerSecond(-speed) };
        // Three hours of ticks, the last leg of a long plan.
        Telemetry { ticks: 2_160_000, pose, wheels, state: State::Driving, leg: 999 }
    }

    proptest! {
        #[test]
        fn telemetry_fits_its_share_of_the_wire_and_loses_less_than_a_step(
            x in -100f32..100.0, y in -100f32..100.0, heading in -3.1f32..3.1, speed in -40f32..40.0,
            session: u32, ack: u16,
        ) {
            let sent = telemetry(Pose::new(x, y, heading), speed);
            let header = Header { session, sequence: None, ack, ack_bits: 255 };
            let mut wire = [0; MAX_FRAME];
            let length = encode(&header, &Report::Telemetry(sent), &mut wire).unwrap();
            prop_assert!(length <= BUDGET, "{length} > {BUDGET}");
            let (_, report) = decode::<Report>(&mut wire[..length - 1]).unwrap();
            let Report::Telemetry(read) = report else { panic!("{report:?}") };
            // A coordinate of 100 m is itself only exact to 8 µm.
            prop_assert!((read.pose.x.0 - x).abs() < 0.6 * POSITION_STEP);
            prop_assert!((read.pose.y.0 - y).abs() < 0.6 * POSITION_STEP);
            prop_assert!((read.pose.heading.0 - heading).abs() < 0.6 * HEADING_STEP);
            prop_assert!((read.wheels.left.0 - speed).abs() < 0.6 * SPEED_STEP);
        }
    }

    #[test]
    fn half_a_turn_keeps_its_direction() {
        let sent = telemetry(Pose::new(0.0, 0.0, core::f32::consts::PI), 0.0);
        let read = Telemetry::from(Packed::from(sent));
        assert_eq!(read.pose.heading.0, core::f32::consts::PI);
    }
}
