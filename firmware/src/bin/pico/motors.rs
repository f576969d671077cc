//! Two DC motors on a TB6612FNG: one PWM and two direction inputs each, and a common standby.
//!
//! | IN1 | IN2 | PWM | motor |
//! |-----|-----|-----|-------|
//! | high | low | duty | forward, braking in the pauses |
//! | low | high | duty | backward, braking in the pauses |
//! | either | the other | low | short-circuit brake |
//!
//! Standby low switches every output off; the chip pulls all its inputs low itself, so the motors
//! are dead while the Pico's pins float in reset. A DRV8833 module has another truth table (PWM on
//! the direction inputs) and needs another version of this file.

use embassy_rp::gpio::Output;
use embassy_rp::pwm::{self, Pwm};

/// The direction inputs of one half of the driver chip.
pub(crate) struct Direction {
    /// High drives forward.
    pub(crate) in1: Output<'static>,
    /// High drives backward.
    pub(crate) in2: Output<'static>,
}

impl Direction {
    fn set(&mut self, forward: bool) {
        self.in1.set_level(forward.into());
        self.in2.set_level((!forward).into());
    }
}

/// Both motors: the left one on output A of the PWM slice, the right one on output B.
pub(crate) struct Motors {
    /// Produces both duty cycles.
    pub(crate) pwm: Pwm<'static>,
    /// The setting of `pwm`, with the two duty cycles in it.
    pub(crate) setting: pwm::Config,
    /// Left, right.
    pub(crate) directions: [Direction; 2],
    /// High lets the driver chip work.
    pub(crate) standby: Output<'static>,
}

impl Motors {
    /// Drives the left and the right motor with a duty in -1..=1 each, the share of the battery's
    /// voltage; positive is forward.
    pub(crate) fn drive(&mut self, duty: [f32; 2]) {
        for (direction, duty) in self.directions.iter_mut().zip(duty) {
            direction.set(duty >= 0.0);
        }
        let period = self.setting.top.saturating_add(1);
        // A float cast saturates, and turns NaN into zero.
        let [left, right] = duty.map(|duty| (duty.abs().min(1.0) * f32::from(period)) as u16);
        self.setting.compare_a = left;
        self.setting.compare_b = right;
        self.pwm.set_config(&self.setting);
        self.standby.set_high();
    }

    /// Switches the driver chip off.
    pub(crate) fn off(&mut self) {
        self.standby.set_low();
    }
}
