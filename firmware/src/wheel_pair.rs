//! Both wheels: from the twist that is wanted of the base to the motors' duty.
//!
//! ```text
//! twist ─► speed limiter ─► command ─► wheel loops ─► duty
//!                              └─ share: how much of the wanted speed it is
//! ```
//! Wheels are in the order left, right.

use crate::effort::misfit;
use crate::kinematics::BaseGeometry;
use crate::speed_limiter::WheelCommand;
use crate::wheel_loop::{WheelLoop, WheelModel};
use protocol::message::{Fault, Wheel};
use protocol::motion::{Limits, Twist, WheelSpeeds};
use protocol::parameters::Parameters;
use protocol::units::RadiansPerSecond;

/// The wheels of one robot.
#[derive(Clone, Debug)]
pub(crate) struct WheelPair {
    geometry: BaseGeometry,
    model: WheelModel,
    limits: Limits,
    loops: [WheelLoop; 2],
    command: WheelCommand,
}

impl WheelPair {
    /// Resting wheels whose encoders stand at `counts`.
    pub(crate) fn new(parameters: &Parameters, counts: [i32; 2]) -> Self {
        Self {
            geometry: BaseGeometry::from(parameters),
            model: WheelModel::from(parameters),
            limits: parameters.limits(),
            loops: counts.map(WheelLoop::new),
            command: WheelCommand::REST,
        }
    }

    /// How fast they turn, measured.
    pub(crate) fn speeds(&self) -> WheelSpeeds {
        let [left, right] = self.loops.each_ref().map(|wheel| wheel.speed(&self.model));
        WheelSpeeds { left: RadiansPerSecond(left), right: RadiansPerSecond(right) }
    }

    /// How fast they are commanded to turn, feedback included.
    pub(crate) fn commanded(&self) -> WheelSpeeds {
        self.command.wheels
    }

    /// How the base moves if they do as commanded.
    pub(crate) fn commanded_twist(&self) -> Twist {
        self.geometry.twist(self.command.wheels)
    }

    /// The share of the wanted speed that the limits leave, 0..=1.
    pub(crate) fn share(&self) -> f32 {
        self.command.share
    }

    /// Whether they are commanded to stand.
    pub(crate) fn are_to_stand(&self) -> bool {
        self.command.wheels == WheelCommand::REST.wheels
    }

    /// Cuts the drive, and forgets all up to `counts`.
    pub(crate) fn rest(&mut self, counts: [i32; 2]) {
        self.loops = counts.map(WheelLoop::new);
        self.command = WheelCommand::REST;
    }

    /// One tick: the duty in -1..=1 of each motor that brings the base to `wanted` within the limits,
    /// with the encoders at `counts`.
    pub(crate) fn tick(&mut self, wanted: Twist, counts: [i32; 2]) -> [f32; 2] {
        self.command = self.command.towards(wanted, &self.geometry, &self.limits);
        let WheelSpeeds { left, right } = self.command.wheels;
        let ([left_wheel, right_wheel], [left_count, right_count]) = (&mut self.loops, counts);
        [
            left_wheel.tick(left.0, left_count, &self.model),
            right_wheel.tick(right.0, right_count, &self.model),
        ]
    }

    /// What is wrong with a wheel, if anything, and with which.
    pub(crate) fn fault(&mut self) -> Option<(Fault, Wheel)> {
        let mut wheels = self.loops.iter().zip([Wheel::Left, Wheel::Right]);
        let fault = wheels.find_map(|(wheel, name)| Some((wheel.fault()?, name)));
        let [left, right] = &mut self.loops;
        let misfit = misfit([left.effort(), right.effort()]);
        fault.or(misfit.map(|wheel| (Fault::Encoder, wheel)))
    }
}
