//! The base with mass against formulas, and its energy.

use std::f64::consts::TAU;
use wmr_sim::base::{Faults, TruePose, WheeledBase};
use wmr_sim::encoder::Encoder;
use wmr_sim::physics::motor::{Gear, Motor, Supply};
use wmr_sim::physics::tyre::Tyre;
use wmr_sim::physics::{Design, Dynamics};
use wmr_sim::presets::Preset;

/// What formulas and simulation may differ by, relative.
const EXACT: f64 = 1e-6;

const MOTOR: Motor = Motor {
    nominal_voltage: 6.0,
    no_load_speed: 18.0,
    stall_torque: 0.1,
    stall_current: 1.0,
    friction_torque: 0.005,
    inertia: 2e-4,
    dead_band: 0.0,
    current_limit: 100.0,
};

/// A base that rolls without slip, its mass over the axle.
const IDEAL: Design = Design {
    mass: 0.5,
    inertia: 0.0012,
    centre_ahead: 0.0,
    caster_ahead: 0.06,
    caster_friction: 0.0,
    track: 0.12,
    wheel_radius: [0.035; 2],
    wheel_inertia: 2e-5,
    tyre: Tyre::IDEAL,
    motor: [MOTOR; 2],
    gear: Gear { backlash: 0.0 },
    supply: Supply { voltage: 6.0, resistance: 0.0 },
};

fn base(design: Design) -> WheeledBase {
    WheeledBase::with_mass(design, Encoder::even(1_000_000, [0.0; 2]), TruePose::default())
}

/// What one wheel has to move on a straight.
fn inertia(design: &Design) -> f64 {
    let [radius, _] = design.wheel_radius;
    design.mass / 2.0 * radius * radius + design.wheel_inertia + design.motor[0].inertia
}

fn close(a: f64, b: f64, what: &str) {
    assert!((a - b).abs() <= EXACT * b.abs().max(a.abs()), "{what}: {a} instead of {b}");
}

/// How far the wheels have turned, rad.
fn turned(base: &WheeledBase) -> [f64; 2] {
    base.counts().map(|count| f64::from(count) / 1e6 * TAU)
}

/// ω(t) = ω_e (1 - e^(-t/τ)), its integral, and friction that lowers ω_e.
#[test]
fn a_motors_step_response_is_an_exponential() {
    let mut base = base(IDEAL);
    let tau = MOTOR.time_constant(inertia(&IDEAL));
    let ideal =
        MOTOR.no_load_speed * (MOTOR.stall_torque + MOTOR.friction_torque) / MOTOR.stall_torque;
    let lost = MOTOR.friction_torque / (MOTOR.stall_torque + MOTOR.friction_torque);
    let end = ideal * (0.5 - lost);
    for step in 1..=100 {
        base.step([0.5, 0.5], 0.01);
        let t = 0.01 * f64::from(step);
        close(base.wheel_speeds()[0], end * (1.0 - (-t / tau).exp()), "speed");
        let angle = end * (t - tau * (1.0 - (-t / tau).exp()));
        // The first step takes hold of friction for a part of it.
        assert!((base.pose().x - 0.035 * angle).abs() < 1e-7 + EXACT * base.pose().x, "{t}");
    }
    // Rounding between two equal wheels.
    assert!(base.pose().y.abs() < 1e-8);
}

/// A braked motor with friction: ω(t) = (ω_0 + ω_f) e^(-t/τ) - ω_f until it rests.
#[test]
fn a_base_that_coasts_down_stops_where_the_formula_says() {
    let mut base = base(IDEAL);
    base.step([1.0, 1.0], 5.0);
    let [start, _] = base.wheel_speeds();
    let x = base.pose().x;
    let tau = MOTOR.time_constant(inertia(&IDEAL));
    let friction = MOTOR.no_load_speed * MOTOR.friction_torque / MOTOR.stall_torque;
    let rest = tau * (1.0 + start / friction).ln();
    base.step([0.0, 0.0], 2.0 * rest);
    let way = 0.035 * (tau * start - friction * rest);
    close(base.pose().x - x, way, "way to rest");
    assert!(base.wheel_speeds()[0].abs() < 1e-6);
    let rests = base.pose();
    base.step([0.0, 0.0], 1.0);
    assert!((base.pose().x - rests.x).abs() < 1e-9);
}

#[test]
fn on_lines_arcs_and_spins_the_pose_is_that_of_the_wheels() {
    for duty in [[0.5, 0.5], [0.3, 0.6], [-0.4, 0.4], [0.0, 0.5], [-0.5, -0.2]] {
        let mut base = base(IDEAL);
        base.step(duty, 1.5);
        // Constant speeds from here on: an arc about the middle that both radii give.
        let (from, before) = (base.pose(), turned(&base));
        base.step(duty, 0.4);
        let [left, right] = [0, 1].map(|wheel| 0.035 * (turned(&base)[wheel] - before[wheel]));
        let mut exact = WheeledBase::with_mass(IDEAL, Encoder::even(1, [0.0; 2]), from);
        let steps = 1000.0;
        (0..1000).for_each(|_| exact.roll([left / steps, right / steps]));
        let (a, b) = (base.pose(), exact.pose());
        let way = left.abs().max(right.abs());
        // One count of a million is 0.2 µm.
        let bound = EXACT * way + 3e-7;
        assert!((a.x - b.x).abs() < bound && (a.y - b.y).abs() < bound, "{duty:?} {a:?} {b:?}");
        let turn = (a.heading - b.heading).sin();
        assert!(turn.abs() < (EXACT * way + 3e-7) / 0.06, "{duty:?} {turn}");
    }
}

/// Without other drag a wide tyre scrubs as if the track were sqrt(b² + w²).
#[test]
fn wide_tyres_make_the_effective_track_wider() {
    for width in [0.008, 0.026, 0.05] {
        let tyre = Tyre { width, least_creep: 1e-9, ..Tyre::IDEAL };
        let mut base = base(Design { tyre, ..IDEAL });
        base.step([-0.5, 0.5], 1.0);
        let [left, right] = base.wheel_speeds();
        let yaw = base.dynamics().unwrap().twist()[2];
        let effective = 0.035 * (right - left) / yaw;
        close(effective, 0.12f64.hypot(width), "effective track");
    }
}

#[test]
fn a_wheel_that_is_larger_drives_an_arc_of_the_radius_that_it_should() {
    let mut base = base(Design { wheel_radius: [0.035, 0.0352], ..IDEAL });
    base.step([0.5, 0.5], 2.0);
    let [left, right] = base.wheel_speeds();
    let [speed, _, yaw] = base.dynamics().unwrap().twist();
    close(yaw, (0.0352 * right - 0.035 * left) / 0.12, "yaw rate");
    close(speed, (0.0352 * right + 0.035 * left) / 2.0, "speed");
    assert!(yaw > 0.0);
}

/// Grip ends at μ N: a base with motors too strong for its tyres spins them, and accelerates by μ g.
#[test]
fn tyres_without_enough_grip_spin() {
    let tyre = Tyre { grip: [0.1, 0.1], ..Tyre::IDEAL };
    let motor = Motor { stall_torque: 1.0, stall_current: 10.0, ..MOTOR };
    let mut base = base(Design { tyre, motor: [motor; 2], ..IDEAL });
    base.step([1.0, 1.0], 0.2);
    let [speed, ..] = base.dynamics().unwrap().twist();
    close(speed, 0.1 * 9.81 * 0.2, "speed");
    assert!(base.wheel_speeds()[0] * 0.035 > 2.0 * speed);
}

#[test]
fn play_of_a_gear_is_lost_when_the_motor_turns_back() {
    let backlash = 0.06;
    let mut base = base(Design { gear: Gear { backlash }, ..IDEAL });
    // Ahead, then so gently back that the wheel rests while the motor crosses its play.
    base.step([0.5, 0.5], 1.0);
    base.step([0.0, 0.0], 2.0);
    let rest = base.pose().x;
    let counted = Encoder { before_gear: true, ..Encoder::even(1_000_000, [0.0; 2]) };
    let mut motors = WheeledBase::with_mass(
        Design { gear: Gear { backlash }, ..IDEAL },
        counted,
        TruePose::default(),
    );
    for duty in [0.5, 0.0] {
        motors.step([duty; 2], if duty > 0.0 { 1.0 } else { 2.0 });
    }
    let before = turned(&motors)[0];
    motors.step([-0.06; 2], 3.0);
    base.step([-0.06; 2], 3.0);
    let (wheel, motor) = ((base.pose().x - rest) / 0.035, turned(&motors)[0] - before);
    assert!(wheel < 0.0);
    let lost = wheel - motor;
    assert!(lost > 0.0 && lost < backlash * (1.0 + EXACT), "{lost}");
}

/// Whatever the duty, the tyres and the faults: what moves never holds more than the motors gave.
#[test]
fn energy_is_never_created() {
    for preset in Preset::ALL {
        for seed in 0..4 {
            let mut random = fastrand::Rng::with_seed(seed);
            let mut dynamics = Dynamics::new(preset.design());
            let mut pose = TruePose::default();
            let (mut duty, mut faults) = ([0.0; 2], Faults::default());
            for step in 0..20_000 {
                if step % 400 == 0 {
                    duty = [2.0 * random.f64() - 1.0, 2.0 * random.f64() - 1.0];
                    faults.lifted = random.f64() < 0.1;
                    faults.blocked = [random.f64() < 0.1, random.f64() < 0.1];
                }
                let (energy, work) = (dynamics.kinetic_energy(), dynamics.motor_work());
                dynamics.step(&mut pose, duty, &faults, 0.0002);
                if random.f64() < 0.01 {
                    dynamics.bump([0.6, 0.8], pose.heading, 0.075);
                }
                let gained = dynamics.kinetic_energy() - energy;
                let given = dynamics.motor_work() - work;
                let rounding = 1e-15;
                assert!(gained <= given + rounding, "{preset:?} {seed} {step}: {gained} {given}");
                assert!(dynamics.kinetic_energy() <= dynamics.motor_work() + 1e-12, "{preset:?}");
            }
        }
    }
}

#[test]
fn the_supply_sags_under_load() {
    let mut base = base(Design { supply: Supply { voltage: 6.0, resistance: 1.0 }, ..IDEAL });
    base.step([1.0, 1.0], 0.0002);
    // 6 Ω each, beside each other, behind 1 Ω.
    close(base.dynamics().unwrap().volts(), 4.5, "voltage");
}
