//! Robots by name: what the controller believes of each, and the base that it drives.
//!
//! [`paper_robot`] and [`BaseParameters::paper`] belong together: both are the default one with motors
//! twice as fast [Alghannam, Sec. V]. [`Preset`] has bases that can be bought. SI units.
//!
//! | | Romi | 3pi+ Turtle | TT kit | from |
//! |---|---|---|---|---|
//! | wheel | 70 mm | 32 mm | 65 mm | Pololu, Romi chassis 3500; 3pi+ 32U4 guide 0J83; kits |
//! | track | 141 mm | 85 mm | 130 mm | WPILib's Romi; drawings; measured on kits |
//! | no-load speed | 150 rpm, 4.5 V | 180 rpm, 6 V | 160 rpm, 6 V | Pololu 1520; 0J83/5.3; DFRobot FIT0450 |
//! | stall | 1.25 A, 1.8 kg cm | 0.36 A, 0.64 kg cm | 2.8 A, 0.8 kg cm | the same |
//! | counts a turn | 12 · 119.76 | 12 · 75.81 | 960 | Pololu 3542; 0J83/5.4; FIT0450 |
//!
//! Nobody publishes rotor inertia, play, friction, creep or edges that come late: those are
//! estimates for parts of that class. Tyres grip as rubber on smooth wood does.

use crate::base::{BaseParameters, TruePose, WheeledBase};
use crate::encoder::Encoder;
use crate::physics::Design;
use crate::physics::motor::{Gear, Motor, Supply};
use crate::physics::tyre::Tyre;
use protocol::parameters::{Parameters, TrackerGains, WheelLoopGains};
use protocol::units::{Metres, MetresPerSecond, MetresPerSecondSquared};

/// How much faster the paper's robot is than the default one.
const PAPER_SPEED_UP: f32 = 2.0;

/// The robot of the paper's experiment, as far as its figures show.
///
/// *Deviation:* the paper names no limits of its robot, but its mission of three legs in 9 s each has a
/// drive of 1.05 m in 3 s, which peaks at 2 D/ε = 0.7 m/s; the default robot allows 0.4 m/s and could
/// reach 0.63 m/s. So this one has motors twice as fast, and limits to match.
pub fn paper_robot() -> Parameters {
    let default = Parameters::default();
    let wheel_loop = WheelLoopGains {
        no_load_speed: PAPER_SPEED_UP * default.wheel_loop.no_load_speed,
        ..default.wheel_loop
    };
    let speed = MetresPerSecond(PAPER_SPEED_UP * default.speed.0);
    Parameters { speed, wheel_loop, ..default }
}

impl BaseParameters {
    /// The base that goes with [`paper_robot`]: motors twice as fast.
    pub fn paper(seed: u64) -> Self {
        let default = Self::seeded(seed);
        let no_load_speed = default.no_load_speed.map(|speed| speed * f64::from(PAPER_SPEED_UP));
        Self { no_load_speed, ..default }
    }
}

/// A base that can be bought.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Preset {
    /// Pololu Romi chassis with its motors, encoders and six NiMH cells.
    Romi,
    /// Pololu 3pi+ 32U4, Turtle Edition.
    ThreePiPlus,
    /// A kit for 30 euros: plastic TT motors with encoders, wheels with soft tyres.
    TtKit,
}

/// rad/s in one turn a minute.
const RPM: f64 = std::f64::consts::TAU / 60.0;
/// N m in one kg cm.
const KG_CM: f64 = 0.0980665;

impl Preset {
    /// All of them.
    pub const ALL: [Self; 3] = [Self::Romi, Self::ThreePiPlus, Self::TtKit];

    /// What it is called on a command line and in files.
    pub fn name(self) -> &'static str {
        match self {
            Self::Romi => "romi",
            Self::ThreePiPlus => "3pi+",
            Self::TtKit => "tt-kit",
        }
    }

    /// The base of that name.
    pub fn named(name: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|preset| preset.name() == name)
    }

    /// What it is made of, as drawn and sold.
    pub fn design(self) -> Design {
        match self {
            Self::Romi => Design {
                mass: 0.6,
                inertia: 0.6 * 0.055 * 0.055,
                centre_ahead: 0.012,
                caster_ahead: 0.068,
                caster_friction: 0.15,
                track: 0.141,
                wheel_radius: [0.035; 2],
                wheel_inertia: 0.02 * 0.03 * 0.03,
                tyre: Tyre { width: 0.008, ..RUBBER },
                motor: [ROMI_MOTOR; 2],
                gear: Gear { backlash: 0.02 },
                supply: Supply { voltage: 7.2, resistance: 0.3 },
            },
            Self::ThreePiPlus => Design {
                mass: 0.2,
                inertia: 0.2 * 0.033 * 0.033,
                centre_ahead: 0.005,
                caster_ahead: 0.04,
                caster_friction: 0.15,
                track: 0.085,
                wheel_radius: [0.016; 2],
                wheel_inertia: 0.003 * 0.014 * 0.014,
                tyre: Tyre { width: 0.0065, ..RUBBER },
                motor: [TURTLE_MOTOR; 2],
                gear: Gear { backlash: 0.015 },
                supply: Supply { voltage: 4.8, resistance: 0.25 },
            },
            Self::TtKit => Design {
                mass: 0.55,
                inertia: 0.55 * 0.06 * 0.06,
                centre_ahead: -0.02,
                caster_ahead: -0.09,
                caster_friction: 0.15,
                track: 0.13,
                wheel_radius: [0.0325; 2],
                wheel_inertia: 0.035 * 0.028 * 0.028,
                tyre: Tyre { width: 0.026, creep: 0.02, rolling_resistance: 0.02, ..RUBBER },
                motor: [TT_MOTOR; 2],
                gear: Gear { backlash: 0.06 },
                supply: Supply { voltage: 6.0, resistance: 0.4 },
            },
        }
    }

    /// Its encoders.
    pub fn encoder(self) -> Encoder {
        let (counts_per_turn, late) = match self {
            Self::Romi => (1437, [0.0, 0.1, 0.05, 0.15]),
            Self::ThreePiPlus => (910, [0.0, 0.1, 0.05, 0.1]),
            Self::TtKit => (960, [0.0, 0.25, 0.1, 0.3]),
        };
        Encoder { late, before_gear: true, ..Encoder::even(counts_per_turn, [0.0; 2]) }
    }

    /// One of many such bases, as `seed` has it: motors differ by up to 4 % in speed, wheels by up to
    /// 0.3 % in size, the track by up to 1 mm, and encoders start anywhere.
    pub fn base(self, seed: u64, pose: TruePose) -> WheeledBase {
        let mut random = fastrand::Rng::with_seed(seed);
        let mut spread = |share: f64| 1.0 + share * (2.0 * random.f64() - 1.0);
        let mut design = self.design();
        for motor in &mut design.motor {
            motor.no_load_speed *= spread(0.04);
            motor.friction_torque *= spread(0.2);
        }
        design.wheel_radius = design.wheel_radius.map(|radius| radius * spread(0.003));
        design.track += spread(0.001) - 1.0;
        let phase = [random.f64(), random.f64()];
        WheeledBase::with_mass(design, Encoder { phase, ..self.encoder() }, pose)
    }

    /// What a careful person tells the controller of it: the data sheet's lengths and speeds, limits
    /// with some reserve, and a loop of `1/τ` that is critically damped as the default one is.
    pub fn parameters(self) -> Parameters {
        let design = self.design();
        let [motor, _] = design.motor;
        let [radius, _] = design.wheel_radius;
        let carried = design.mass / 2.0 * radius * radius;
        let time_constant = motor.time_constant(carried + design.wheel_inertia + motor.inertia);
        let volts = design.supply.voltage / motor.nominal_voltage;
        let no_load_speed = motor.no_load_speed * volts;
        let breakaway_duty = motor.friction_torque / (motor.stall_torque * volts);
        let speed = (0.55 * no_load_speed * radius).min(0.4);
        Parameters {
            wheel_radius: Metres(radius as f32),
            track: Metres(design.track as f32),
            counts_per_turn: self.encoder().counts_per_turn as u16,
            speed: MetresPerSecond(speed as f32),
            acceleration: MetresPerSecondSquared((2.0 * speed) as f32),
            wheel_loop: loop_for(no_load_speed, time_constant, breakaway_duty),
            tracker: TrackerGains::default(),
            ..Parameters::default()
        }
    }
}

/// The loop's own frequency, rad/s, as that of the default robot.
const LOOP: f64 = 30.0;

/// τ s² + (1 + ω0 k_v) s + ω0 k_i = τ (s + 30)², as for the default robot's gains.
fn loop_for(no_load_speed: f64, time_constant: f64, breakaway_duty: f64) -> WheelLoopGains {
    WheelLoopGains {
        no_load_speed: no_load_speed as f32,
        time_constant: time_constant as f32,
        breakaway_duty: breakaway_duty as f32,
        velocity_gain: ((2.0 * LOOP * time_constant - 1.0).max(0.1) / no_load_speed) as f32,
        angle_gain: (LOOP * LOOP * time_constant / no_load_speed) as f32,
    }
}

const RUBBER: Tyre = Tyre {
    width: 0.0,
    grip: [0.9, 0.8],
    creep: 0.01,
    least_creep: 1e-4,
    rolling_resistance: 0.015,
};

const ROMI_MOTOR: Motor = Motor {
    nominal_voltage: 4.5,
    no_load_speed: 150.0 * RPM,
    stall_torque: 1.8 * KG_CM,
    stall_current: 1.25,
    friction_torque: 0.012,
    inertia: 1e-3,
    dead_band: 0.01,
    current_limit: 1.8,
};

const TURTLE_MOTOR: Motor = Motor {
    nominal_voltage: 6.0,
    no_load_speed: 180.0 * RPM,
    stall_torque: 0.64 * KG_CM,
    stall_current: 0.36,
    friction_torque: 0.004,
    inertia: 7.5e-5,
    dead_band: 0.01,
    current_limit: 1.8,
};

const TT_MOTOR: Motor = Motor {
    nominal_voltage: 6.0,
    no_load_speed: 160.0 * RPM,
    stall_torque: 0.8 * KG_CM,
    stall_current: 2.8,
    friction_torque: 0.008,
    inertia: 8e-4,
    dead_band: 0.03,
    current_limit: 2.0,
};

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_preset_has_parameters_that_a_robot_takes_and_a_name_that_is_found() {
        for preset in Preset::ALL {
            assert_eq!(preset.parameters().check(), Ok(()), "{preset:?}");
            assert_eq!(Preset::named(preset.name()), Some(preset));
        }
    }

    /// A base at full duty on its own supply is as fast as its motors' sheet says, within what
    /// friction, sag and creep take.
    #[test]
    fn every_preset_reaches_the_speed_of_its_data_sheet() {
        for preset in Preset::ALL {
            let design = preset.design();
            let mut base = preset.base(1, TruePose::default());
            base.step([1.0; 2], 2.0);
            let volts = design.supply.voltage / design.motor[0].nominal_voltage;
            let sheet = design.motor[0].no_load_speed * volts * design.wheel_radius[0];
            let before = base.pose();
            base.step([1.0; 2], 0.5);
            let after = base.pose();
            let speed = (after.x - before.x).hypot(after.y - before.y) / 0.5;
            assert!((0.6..1.05).contains(&(speed / sheet)), "{preset:?}: {speed} of {sheet} m/s");
        }
    }
}
