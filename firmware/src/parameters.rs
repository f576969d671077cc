//! What one robot is: its lengths, its encoders, its motors, its limits and its gains.
//!
//! Every number that differs from robot to robot stands here, with its unit and where its default
//! comes from; no other module holds one.

use crate::kinematics::BaseGeometry;
use crate::tracker::TrackerGains;
use crate::wheel_loop::WheelLoopGains;
use protocol::motion::Limits;
use protocol::units::{Metres, MetresPerSecond, MetresPerSecondSquared};

/// All of one robot's numbers.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Parameters {
    /// Wheel radius and track.
    pub geometry: BaseGeometry,
    /// Encoder counts in one turn of a wheel, all four edges counted.
    pub counts_per_turn: u16,
    /// The greatest speed of a wheel's rim.
    pub speed: MetresPerSecond,
    /// The greatest acceleration of a wheel's rim.
    pub acceleration: MetresPerSecondSquared,
    /// How the wheel loop answers.
    pub wheel_loop: WheelLoopGains,
    /// How deviations from the path are corrected.
    pub tracker: TrackerGains,
}

impl Default for Parameters {
    /// A small robot with 70 mm wheels on N20-class gear motors.
    fn default() -> Self {
        Self {
            geometry: BaseGeometry { wheel_radius: Metres(0.035), track: Metres(0.12) },
            counts_per_turn: 1440,
            speed: MetresPerSecond(0.4),
            acceleration: MetresPerSecondSquared(0.8),
            wheel_loop: WheelLoopGains::default(),
            tracker: TrackerGains::default(),
        }
    }
}

impl Parameters {
    /// What the wheels may do, as the protocol says it.
    pub fn limits(&self) -> Limits {
        Limits { speed: self.speed, acceleration: self.acceleration, track: self.geometry.track }
    }

    /// The angle of a wheel that one encoder count stands for, radians.
    pub fn radians_per_count(&self) -> f32 {
        core::f32::consts::TAU / f32::from(self.counts_per_turn)
    }
}
