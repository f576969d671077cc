//! A base with mass: motors, gears, tyres that slip and scrub, and a caster, in the plane.
//!
//! ```text
//! duty ─► motor (torque) ─► gear (backlash) ─► wheel ─► tyre (slip) ─► chassis ─► pose
//! ```
//! All friction is written as a force against a velocity, limit · s / |s|. In each step the share
//! 1/|s| is taken from the last guess, the linear equations are solved with the velocities at the
//! step's end, and the guess is renewed until it no longer changes. Whatever the guess, such a force
//! only takes energy out; motors and the turning of the body's frame enter with the step's mean
//! velocity, for which the work done is exact. So energy is never created, however stiff the tyres;
//! what rounding adds where friction takes hold inside a step is taken out.
//!
//! | symbol | meaning | unit |
//! |---|---|---|
//! | u, w | velocity of the centre of mass, ahead and to the left | m/s |
//! | r | yaw rate, counter-clockwise | rad/s |
//! | q | (u, w, r, ω left, ω right) | |
//! | s | slip: velocity of the tyre's contact over the floor | m/s |
//! | c | friction force over slip, limit / \|s\| | N s/m |

pub mod motor;
mod solve;
pub mod tyre;

use crate::base::{Faults, TruePose, wrapped};
use motor::{Gear, Motor, Supply};
use solve::{Equations, U, V, WHEEL, YAW};
use tyre::Tyre;

/// Steps of the integration, s: a three-hundredth of a motor's time constant.
const STEP: f64 = 0.0002;
/// The guess is renewed at most so often in a step; the next step goes on from there.
const MOST_ROUNDS: u32 = 25;
/// Velocities are found when they change by no more than this between two rounds, m/s and rad/s.
const SETTLED: f64 = 1e-13;
/// Friction that holds lets this much through, m/s and rad/s.
const STICKS: f64 = 1e-7;
/// A wheel that is held fast resists turning by this much, N m s.
const HELD: f64 = 1e6;
/// Acceleration of free fall, m/s².
const GRAVITY: f64 = 9.81;
/// Friction between the robot's side and what it bumps against.
const SIDE_FRICTION: f64 = 0.3;

/// What a base with mass is made of. Left and right where there are two.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Design {
    /// Of the whole robot, kg.
    pub mass: f64,
    /// Of the whole robot about the vertical through its centre of mass, kg m².
    pub inertia: f64,
    /// How far the centre of mass lies ahead of the axle, m; negative behind it.
    pub centre_ahead: f64,
    /// How far the caster lies ahead of the axle, m; negative behind it.
    pub caster_ahead: f64,
    /// Friction coefficient of the caster over the floor.
    pub caster_friction: f64,
    /// Distance between the middles of the two tyres, m.
    pub track: f64,
    /// Radius of each wheel, m.
    pub wheel_radius: [f64; 2],
    /// Of one wheel about its axle, kg m².
    pub wheel_inertia: f64,
    /// Both tyres.
    pub tyre: Tyre,
    /// Each motor with its gear.
    pub motor: [Motor; 2],
    /// Both gears' play.
    pub gear: Gear,
    /// What the motors are fed from.
    pub supply: Supply,
}

impl Design {
    /// What presses each wheel, and the caster, on the floor, N.
    pub fn loads(&self) -> (f64, f64) {
        let weight = self.mass * GRAVITY;
        let caster =
            if self.caster_ahead == 0.0 { 0.0 } else { self.centre_ahead / self.caster_ahead };
        let caster = weight * caster.clamp(0.0, 1.0);
        ((weight - caster) / 2.0, caster)
    }

    fn masses(&self) -> [f64; 5] {
        let wheel = self.wheel_inertia;
        [self.mass, self.mass, self.inertia, wheel, wheel]
    }
}

/// A moving base with mass.
#[derive(Clone, Debug)]
pub struct Dynamics {
    design: Design,
    q: [f64; 5],
    /// Speeds of the motors behind their gears, rad/s.
    rotors: [f64; 2],
    /// Where in its play each gear is, rad; `None` while it pushes neither way.
    gaps: [Gap; 2],
    volts: f64,
    work: f64,
}

/// How a motor holds on to its wheel.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Gap {
    /// By how much the motor is ahead of the wheel, 0..=backlash, rad.
    ahead: f64,
    engaged: bool,
}

/// How far one step brought wheels and motors, rad.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Turned {
    /// Each wheel.
    pub wheels: [f64; 2],
    /// Each motor, as seen behind the gear.
    pub motors: [f64; 2],
}

impl Dynamics {
    /// A base at rest, its gears pushing ahead.
    pub fn new(design: Design) -> Self {
        let gap = Gap { ahead: design.gear.backlash, engaged: true };
        Self {
            design,
            q: [0.0; 5],
            rotors: [0.0; 2],
            gaps: [gap; 2],
            volts: design.supply.voltage,
            work: 0.0,
        }
    }

    /// What it is made of.
    pub fn design(&self) -> &Design {
        &self.design
    }

    /// How fast the wheels turn, rad/s.
    pub fn wheel_speeds(&self) -> [f64; 2] {
        [self.q[WHEEL], self.q[WHEEL + 1]]
    }

    /// Velocity of the axle's middle, ahead and to the left, m/s, and the yaw rate, rad/s.
    pub fn twist(&self) -> [f64; 3] {
        let [u, w, r, ..] = self.q;
        [u, w - r * self.design.centre_ahead, r]
    }

    /// What the supply gives under the load of the last step, V.
    pub fn volts(&self) -> f64 {
        self.volts
    }

    /// What moves holds this, J.
    pub fn kinetic_energy(&self) -> f64 {
        let bodies = self.design.masses().into_iter().zip(&self.q).map(|(m, v)| m * v * v / 2.0);
        let rotors = self.design.motor.iter().zip(self.rotors);
        bodies.sum::<f64>() + rotors.map(|(motor, v)| motor.inertia * v * v / 2.0).sum::<f64>()
    }

    /// What the motors have put in since the start, J; less where they braked.
    pub fn motor_work(&self) -> f64 {
        self.work
    }

    /// How many steps make up `seconds`.
    pub(crate) fn steps(seconds: f64) -> u32 {
        (seconds / STEP).round().max(1.0) as u32
    }

    /// One step of `h` seconds with the motors at `duty`; moves `pose`, that of the axle's middle.
    pub fn step(&mut self, pose: &mut TruePose, duty: [f64; 2], faults: &Faults, h: f64) -> Turned {
        let duty = [0, 1].map(|wheel| self.design.motor[wheel].effective(duty[wheel]));
        self.volts = self.design.supply.under_load(&self.design.motor, duty, self.rotors);
        let before = (self.q, self.rotors);
        let held = self.kinetic_energy() - self.work;
        self.q = self.solve(duty, faults, h);
        self.turn_rotors(duty, before, h);
        self.account(duty, before.1, h);
        self.return_excess(held);
        let turned = self.turned(before, h);
        self.mesh(turned);
        self.move_by(pose, before.0, h);
        turned
    }

    /// The velocities at the end of a step.
    fn solve(&self, duty: [f64; 2], faults: &Faults, h: f64) -> [f64; 5] {
        let mut guess = self.q;
        for _ in 0..MOST_ROUNDS {
            let mut equations = Equations::new(self.masses(), self.q);
            equations.turn_frame(self.design.mass, (self.q[YAW] + guess[YAW]) / 2.0, h);
            self.add_drive(&mut equations, duty, faults, &guess, h);
            self.add_floor(&mut equations, faults, &guess, h);
            let found = equations.solve();
            let change = found.iter().zip(&guess).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
            guess = found;
            if change < SETTLED {
                break;
            }
        }
        guess
    }

    /// As [`Design::masses`], with each motor whose gear pushes on its wheel.
    fn masses(&self) -> [f64; 5] {
        let mut masses = self.design.masses();
        for wheel in 0..2 {
            if self.gaps[wheel].engaged {
                masses[WHEEL + wheel] += self.design.motor[wheel].inertia;
            }
        }
        masses
    }

    fn add_drive(
        &self,
        equations: &mut Equations,
        duty: [f64; 2],
        faults: &Faults,
        guess: &[f64; 5],
        h: f64,
    ) {
        let (load, _) = self.loads(faults);
        for (wheel, duty) in duty.into_iter().enumerate() {
            let (motor, place) = (&self.design.motor[wheel], WHEEL + wheel);
            let speed = guess[place].abs().max(STICKS);
            let rolling = self.design.tyre.rolling_resistance * load;
            let mut drag = rolling * self.design.wheel_radius[wheel] / speed;
            if self.gaps[wheel].engaged {
                drag += motor.friction_torque / speed;
                let (torque, slope) = motor.torque(duty * self.volts);
                equations.drive(place, torque, slope, h);
            }
            if faults.blocked[wheel] {
                drag += HELD;
            }
            equations.resist(&unit(place), drag, h);
        }
    }

    fn add_floor(&self, equations: &mut Equations, faults: &Faults, guess: &[f64; 5], h: f64) {
        let (load, caster_load) = self.loads(faults);
        let Design { tyre, track, centre_ahead, caster_ahead, caster_friction, .. } = self.design;
        let side = slip_of(&[(V, 1.0), (YAW, -centre_ahead)]);
        for (wheel, y) in [track / 2.0, -track / 2.0].into_iter().enumerate() {
            let grips = self.design.wheel_radius[wheel] * (1.0 - faults.slip[wheel]);
            let along = slip_of(&[(U, 1.0), (YAW, -y), (WHEEL + wheel, -grips)]);
            let slip = [dot(&along, guess), dot(&side, guess)];
            let rim = (grips * guess[WHEEL + wheel]).abs();
            let [c_along, c_side, c_yaw] = tyre.resistance(load, slip, guess[YAW], rim);
            equations.resist(&along, c_along, h);
            equations.resist(&side, c_side, h);
            equations.resist(&unit(YAW), c_yaw, h);
        }
        let across = slip_of(&[(V, 1.0), (YAW, caster_ahead - centre_ahead)]);
        let speed = guess[U].hypot(dot(&across, guess)).max(STICKS);
        let drag = caster_friction * caster_load / speed;
        equations.resist(&unit(U), drag, h);
        equations.resist(&across, drag, h);
    }

    fn loads(&self, faults: &Faults) -> (f64, f64) {
        if faults.lifted { (0.0, 0.0) } else { self.design.loads() }
    }

    /// Motors in the play of their gears turn alone; the others lose hold where their wheel runs ahead.
    fn turn_rotors(&mut self, duty: [f64; 2], (before, rotors): ([f64; 5], [f64; 2]), h: f64) {
        for wheel in 0..2 {
            let motor = self.design.motor[wheel];
            let (torque, slope) = motor.torque(duty[wheel] * self.volts);
            let gap = &mut self.gaps[wheel];
            if !gap.engaged {
                self.rotors[wheel] = motor.alone(rotors[wheel], torque, slope, h);
                continue;
            }
            let (old, new) = (before[WHEEL + wheel], self.q[WHEEL + wheel]);
            let friction = motor.friction_torque * (new / STICKS).clamp(-1.0, 1.0);
            let own = torque - slope * (old + new) / 2.0 - friction;
            let pushes = own - motor.inertia * (new - old) / h;
            let backlash = self.design.gear.backlash;
            let lost = if gap.ahead > 0.0 { pushes < 0.0 } else { pushes > 0.0 };
            gap.engaged = backlash == 0.0 || !lost;
            self.rotors[wheel] = new;
        }
    }

    fn account(&mut self, duty: [f64; 2], before: [f64; 2], h: f64) {
        for wheel in 0..2 {
            let mean = (before[wheel] + self.rotors[wheel]) / 2.0;
            let (torque, slope) = self.design.motor[wheel].torque(duty[wheel] * self.volts);
            self.work += (torque - slope * mean) * mean * h;
        }
    }

    /// Where a tyre or gear catches hold inside a step, integration is of second order only: what that
    /// would create is taken out again. `held` is the energy, less the work, before the step.
    fn return_excess(&mut self, held: f64) {
        let energy = self.kinetic_energy();
        let excess = energy - self.work - held;
        if excess > 0.0 {
            let share = (1.0 - excess / energy).max(0.0).sqrt();
            self.q.iter_mut().chain(&mut self.rotors).for_each(|speed| *speed *= share);
            // A motor that brakes to rest within the step takes no more than there was.
            self.work = self.work.max(self.kinetic_energy() - held);
        }
    }

    fn turned(&self, (q, rotors): ([f64; 5], [f64; 2]), h: f64) -> Turned {
        Turned {
            wheels: [0, 1].map(|wheel| (q[WHEEL + wheel] + self.q[WHEEL + wheel]) / 2.0 * h),
            motors: [0, 1].map(|wheel| (rotors[wheel] + self.rotors[wheel]) / 2.0 * h),
        }
    }

    /// Gears whose play is used up take hold, as two bodies that stay together after they met.
    fn mesh(&mut self, turned: Turned) {
        for wheel in 0..2 {
            let gap = &mut self.gaps[wheel];
            if gap.engaged {
                continue;
            }
            let backlash = self.design.gear.backlash;
            gap.ahead += turned.motors[wheel] - turned.wheels[wheel];
            if (0.0..=backlash).contains(&gap.ahead) {
                continue;
            }
            gap.ahead = gap.ahead.clamp(0.0, backlash);
            gap.engaged = true;
            let (rotor, wheels) = (self.design.motor[wheel].inertia, self.design.wheel_inertia);
            let speed = &mut self.q[WHEEL + wheel];
            *speed = (rotor * self.rotors[wheel] + wheels * *speed) / (rotor + wheels);
            self.rotors[wheel] = *speed;
        }
    }

    /// Moves along the arc of the mean velocities.
    fn move_by(&self, pose: &mut TruePose, before: [f64; 5], h: f64) {
        let [u, w, r] = [U, V, YAW].map(|place| (before[place] + self.q[place]) / 2.0);
        let w = w - r * self.design.centre_ahead;
        let turn = r * h;
        // The chord of an arc: sin(x)/x of its length, along the mean heading.
        let chord = if turn.abs() < 1e-6 { 1.0 } else { 2.0 * (turn / 2.0).sin() / turn } * h;
        let (sin, cos) = (pose.heading + turn / 2.0).sin_cos();
        pose.x += (u * cos - w * sin) * chord;
        pose.y += (u * sin + w * cos) * chord;
        pose.heading = wrapped(pose.heading + turn);
    }

    /// Takes in the push of what it bumps against, along `normal` of the arena at `heading`: the robot's
    /// side, `radius` from the axle's middle, neither goes on into it nor bounces, and rubs along it.
    pub fn bump(&mut self, normal: [f64; 2], heading: f64, radius: f64) {
        let (sin, cos) = heading.sin_cos();
        let n = [normal[0] * cos + normal[1] * sin, normal[1] * cos - normal[0] * sin];
        let t = [-n[1], n[0]];
        let at = [-self.design.centre_ahead - radius * n[0], -radius * n[1]];
        let arm = |d: [f64; 2]| at[0] * d[1] - at[1] * d[0];
        let (mass, inertia) = (self.design.mass, self.design.inertia);
        let yields = |d: [f64; 2]| 1.0 / mass + arm(d) * arm(d) / inertia;
        let speed = |q: &[f64; 5], d: [f64; 2]| q[U] * d[0] + q[V] * d[1] + q[YAW] * arm(d);
        let mut push = |d: [f64; 2], impulse: f64| {
            self.q[U] += impulse * d[0] / mass;
            self.q[V] += impulse * d[1] / mass;
            self.q[YAW] += impulse * arm(d) / inertia;
            self.q
        };
        let q = push(n, 0.0);
        let impulse = (-speed(&q, n) / yields(n)).max(0.0);
        let q = push(n, impulse);
        let most = SIDE_FRICTION * impulse;
        push(t, (-speed(&q, t) / yields(t)).clamp(-most, most));
    }
}

fn unit(place: usize) -> [f64; 5] {
    slip_of(&[(place, 1.0)])
}

fn slip_of(terms: &[(usize, f64)]) -> [f64; 5] {
    let mut row = [0.0; 5];
    for (place, factor) in terms {
        row[*place] += factor;
    }
    row
}

fn dot(a: &[f64; 5], b: &[f64; 5]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}
