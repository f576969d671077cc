//! Brushed motors with gears, as their data sheets describe them, and what feeds them.
//!
//! T = k_t (d V - k ω) / R behind the gear, less its friction. The constants follow from the data sheet;
//! a lossless gear would have k_t = k.
//!
//! | symbol | meaning | unit |
//! |---|---|---|
//! | d, V | duty, voltage of the supply under load | –, V |
//! | ω, T | speed and torque behind the gear | rad/s, N m |
//! | k | back-EMF of a rad/s | V s |
//! | k_t | torque of an ampere | N m/A |
//! | R | resistance of the winding | Ω |
//! | T_f | friction of the gear | N m |

/// A motor with its gear; speeds and torques behind the gear.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Motor {
    /// The voltage that the data sheet's numbers are for, V.
    pub nominal_voltage: f64,
    /// Speed without load, rad/s.
    pub no_load_speed: f64,
    /// Torque at a standstill, N m.
    pub stall_torque: f64,
    /// Current at a standstill, A.
    pub stall_current: f64,
    /// T_f, N m.
    pub friction_torque: f64,
    /// Of rotor and gear, kg m².
    pub inertia: f64,
    /// Duty below which the driver gives nothing.
    pub dead_band: f64,
    /// The most that the driver gives, A.
    pub current_limit: f64,
}

impl Motor {
    /// k, V s: at the no-load speed what is left of the voltage moves the friction.
    pub fn constant(&self) -> f64 {
        let ideal = 1.0 + self.friction_torque / self.stall_torque;
        self.nominal_voltage / (self.no_load_speed * ideal)
    }

    /// k_t, N m/A: the torque at a standstill, friction overcome, is that of the data sheet.
    fn torque_constant(&self) -> f64 {
        (self.stall_torque + self.friction_torque) / self.stall_current
    }

    /// R, Ω.
    pub fn resistance(&self) -> f64 {
        self.nominal_voltage / self.stall_current
    }

    /// How long the motor with a body of this inertia takes for 63 % of a change of speed, s.
    pub fn time_constant(&self, inertia: f64) -> f64 {
        inertia * self.resistance() / (self.constant() * self.torque_constant())
    }

    /// The duty that reaches the winding.
    pub(super) fn effective(&self, duty: f64) -> f64 {
        let duty = duty.clamp(-1.0, 1.0);
        if duty.abs() < self.dead_band { 0.0 } else { duty }
    }

    /// At `volts` on the winding: torque at a standstill, and by how much it falls with a rad/s.
    pub(super) fn torque(&self, volts: f64) -> (f64, f64) {
        let torque = self.torque_constant() / self.resistance();
        // The driver chops as soon as the current is too large: at low speed only.
        let most = self.current_limit.max(0.0) * self.resistance();
        (torque * volts.clamp(-most, most), torque * self.constant())
    }

    /// The speed after `h` seconds of a motor that turns nothing but itself.
    pub(super) fn alone(&self, speed: f64, torque: f64, slope: f64, h: f64) -> f64 {
        // Friction stops a motor, but does not turn it back.
        let pulled = self.inertia * speed + h * (torque - slope * speed / 2.0);
        let slowed = (pulled.abs() - h * self.friction_torque).max(0.0);
        slowed.copysign(pulled) / (self.inertia + h * slope / 2.0)
    }
}

/// The play of a gear.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Gear {
    /// How far the wheel turns while its motor stands, rad.
    pub backlash: f64,
}

/// A battery with its wires.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Supply {
    /// Without load, V.
    pub voltage: f64,
    /// Of cells and wires, Ω.
    pub resistance: f64,
}

impl Supply {
    /// What is left of the voltage while `motors` at `duty` and `speeds` draw their current; a motor at
    /// duty d draws d times its own current from the supply, for that share of the time.
    pub(super) fn under_load(&self, motors: &[Motor; 2], duty: [f64; 2], speeds: [f64; 2]) -> f64 {
        let (mut given, mut drawn) = (self.voltage, 1.0);
        for ((motor, duty), speed) in motors.iter().zip(duty).zip(speeds) {
            let share = self.resistance / motor.resistance();
            given += share * duty * motor.constant() * speed;
            drawn += share * duty * duty;
        }
        (given / drawn).max(0.0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const MOTOR: Motor = Motor {
        nominal_voltage: 6.0,
        no_load_speed: 20.0,
        stall_torque: 0.1,
        stall_current: 1.0,
        friction_torque: 0.01,
        inertia: 1e-4,
        dead_band: 0.02,
        current_limit: 100.0,
    };

    #[test]
    fn the_data_sheet_comes_back() {
        let (torque, slope) = MOTOR.torque(6.0);
        // At a standstill less its friction; without load just its friction is left.
        assert!((torque - MOTOR.friction_torque - 0.1).abs() < 1e-12);
        assert!((torque - slope * 20.0 - MOTOR.friction_torque).abs() < 1e-12);
    }

    #[test]
    fn two_stalled_motors_pull_the_supply_down() {
        let supply = Supply { voltage: 6.0, resistance: 0.5 };
        let both = supply.under_load(&[MOTOR; 2], [1.0; 2], [0.0; 2]);
        // 6 Ω each, beside each other.
        let motors = 3.0;
        assert!((both - 6.0 * motors / (motors + 0.5)).abs() < 1e-12);
        assert_eq!(supply.under_load(&[MOTOR; 2], [0.0; 2], [5.0; 2]), 6.0);
    }

    #[test]
    fn a_small_duty_is_none() {
        assert_eq!(
            [0.019, -0.019, 0.5, 3.0].map(|duty| MOTOR.effective(duty)),
            [0.0, -0.0, 0.5, 1.0]
        );
    }
}
