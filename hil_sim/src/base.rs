//! A base of motors, wheels and encoders with a true pose.
//!
//! Its kinematics are written from the geometry of two wheels that roll about a common centre, apart
//! from the controller's, so that one sign error cannot hide in both. SI units, arena frame, f64.
//!
//! | symbol | meaning | unit |
//! |---|---|---|
//! | ω | speed of a wheel, τ ω̇ = ω0 d - ω | rad/s |
//! | d | duty left after friction, -1..=1 | – |
//! | R | distance of the turning centre from the middle of the axis, to the left | m |

pub use crate::encoder::EncoderFault;
use crate::encoder::{Encoder, Encoders};
use crate::physics::{Design, Dynamics};
use std::f64::consts::{PI, TAU};

/// What one base is made of; the truth, not what the controller believes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BaseParameters {
    /// Radius of the left and the right wheel, m.
    pub wheel_radius: [f64; 2],
    /// Distance between the wheels' contact points, m.
    pub track: f64,
    /// Encoder counts in one turn of a wheel.
    pub counts_per_turn: u32,
    /// Speed of each wheel at full duty without load, rad/s.
    pub no_load_speed: [f64; 2],
    /// Time constant of the motors, s.
    pub time_constant: f64,
    /// Duty that friction eats up.
    pub friction_duty: f64,
    /// Where inside a count each encoder starts, 0..1.
    pub encoder_phase: [f64; 2],
}

impl BaseParameters {
    /// The default robot, with motors that differ by up to 2 % and encoders at any phase, as `seed` has it.
    pub fn seeded(seed: u64) -> Self {
        let mut random = fastrand::Rng::with_seed(seed);
        let mut motor = || 18.0 * (1.0 + 0.02 * (2.0 * random.f64() - 1.0));
        Self {
            wheel_radius: [0.035; 2],
            track: 0.12,
            counts_per_turn: 1440,
            no_load_speed: [motor(), motor()],
            time_constant: 0.06,
            friction_duty: 0.03,
            encoder_phase: [random.f64(), random.f64()],
        }
    }

    /// The same base with other lengths than the controller believes in: both wheels `scale` times as
    /// large, the right one `ratio` times the left one, the track `track` times as wide.
    pub fn with_wrong_lengths(self, [scale, ratio, track]: [f64; 3]) -> Self {
        let [left, right] = self.wheel_radius;
        let (mean, old_ratio) = ((left + right) / 2.0 * scale, right / left);
        let left = 2.0 * mean / (1.0 + ratio * old_ratio);
        let wheel_radius = [left, ratio * old_ratio * left];
        Self { wheel_radius, track: self.track * track, ..self }
    }
}

/// What goes wrong with a base while it drives; nothing by default. Left and right.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Faults {
    /// The share of each rim's travel that slips: 0.2 moves the robot by 80 % of what the wheel turns.
    pub slip: [f64; 2],
    /// Wheels that something holds fast.
    pub blocked: [bool; 2],
    /// The share of each motor's duty that is lost; 2 turns the motor the other way.
    pub weak: [f64; 2],
    /// Both wheels turn in the air.
    pub lifted: bool,
    /// What each encoder does.
    pub encoders: [EncoderFault; 2],
    /// Whether each encoder counts the other wheel.
    pub encoders_swapped: bool,
}

/// A true pose: metres and radians in (-π, π].
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct TruePose {
    /// To the right of the arena's lower-left corner, m.
    pub x: f64,
    /// Above the arena's lower-left corner, m.
    pub y: f64,
    /// Counter-clockwise from +x, rad.
    pub heading: f64,
}

/// Where a base would overlap something that it cannot pass.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Contact {
    /// How deep, m.
    pub depth: f64,
    /// The way out, of length 1, in the arena.
    pub normal: [f64; 2],
}

/// A base that moves.
#[derive(Clone, Debug)]
pub struct WheeledBase {
    model: Model,
    pose: TruePose,
    encoders: Encoders,
    faults: Faults,
}

/// How a base answers to its motors.
#[derive(Clone, Debug)]
enum Model {
    /// Each wheel follows its motor alone, and the base follows the wheels.
    FirstOrder { parameters: BaseParameters, speeds: [f64; 2] },
    /// All its bodies have mass.
    Dynamic(Box<Dynamics>),
}

/// The motors' equation is integrated in steps of this length, s: a hundredth of their time constant.
const STEP: f64 = 0.0005;

/// Out of a corner a base is pushed in turns by either side, at most so often in a step.
const MOST_PUSHES: u32 = 8;

impl WheeledBase {
    /// A resting base at `pose`.
    pub fn new(parameters: BaseParameters, pose: TruePose) -> Self {
        let encoder = Encoder::even(parameters.counts_per_turn, parameters.encoder_phase);
        let model = Model::FirstOrder { parameters, speeds: [0.0; 2] };
        Self { model, pose, encoders: Encoders::new(encoder), faults: Faults::default() }
    }

    /// A resting base with mass at `pose`.
    pub fn with_mass(design: Design, encoder: Encoder, pose: TruePose) -> Self {
        let model = Model::Dynamic(Box::new(Dynamics::new(design)));
        Self { model, pose, encoders: Encoders::new(encoder), faults: Faults::default() }
    }

    /// Where the base really is.
    pub fn pose(&self) -> TruePose {
        self.pose
    }

    /// Lifts the base and puts it down at `pose`.
    pub fn place(&mut self, pose: TruePose) {
        self.pose = pose;
    }

    /// What goes wrong from now on.
    pub fn set_faults(&mut self, faults: Faults) {
        self.faults = faults;
    }

    /// How fast the wheels really turn, left and right, rad/s.
    pub fn wheel_speeds(&self) -> [f64; 2] {
        match &self.model {
            Model::FirstOrder { speeds, .. } => *speeds,
            Model::Dynamic(dynamics) => dynamics.wheel_speeds(),
        }
    }

    /// Its bodies, if they have mass.
    pub fn dynamics(&self) -> Option<&Dynamics> {
        match &self.model {
            Model::FirstOrder { .. } => None,
            Model::Dynamic(dynamics) => Some(dynamics),
        }
    }

    /// The encoders' counts since the start, left and right.
    pub fn counts(&self) -> [i32; 2] {
        self.encoders.counts()
    }

    /// Lets `seconds` pass with the motors at `duty` (left, right), each in -1..=1.
    ///
    /// ```
    /// use wmr_sim::base::{BaseParameters, TruePose, WheeledBase};
    /// let mut base = WheeledBase::new(BaseParameters::seeded(1), TruePose::default());
    /// base.step([0.5, 0.5], 1.0);
    /// assert!(base.pose().x > 0.2 && base.pose().y.abs() < 0.02);
    /// ```
    pub fn step(&mut self, duty: [f64; 2], seconds: f64) {
        self.step_among(duty, seconds, 0.0, |_| None);
    }

    /// The same where something may stand in the way: `touches` says where the robot's disc, `radius` wide,
    /// overlaps it. The base then stays outside; how deep it was on the way there, m.
    pub fn step_among(
        &mut self,
        duty: [f64; 2],
        seconds: f64,
        radius: f64,
        mut touches: impl FnMut(TruePose) -> Option<Contact>,
    ) -> Option<f64> {
        let duty =
            [0, 1].map(|wheel| duty[wheel].clamp(-1.0, 1.0) * (1.0 - self.faults.weak[wheel]));
        let steps = match &self.model {
            Model::FirstOrder { .. } => (seconds / STEP).round().max(1.0) as u32,
            Model::Dynamic(_) => Dynamics::steps(seconds),
        };
        let h = seconds / f64::from(steps);
        let response = match &self.model {
            Model::FirstOrder { parameters, .. } => 1.0 - (-h / parameters.time_constant).exp(),
            Model::Dynamic(_) => 0.0,
        };
        let mut deepest: Option<f64> = None;
        for _ in 0..steps {
            let before = self.pose;
            self.step_once(duty, h, response);
            let depth = self.keep_out(before, radius, &mut touches);
            deepest = depth.into_iter().chain(deepest).reduce(f64::max);
        }
        self.encoders.shake(self.faults.encoders);
        deepest
    }

    fn step_once(&mut self, duty: [f64; 2], h: f64, response: f64) {
        let Faults { encoders, encoders_swapped, lifted, .. } = self.faults;
        let turned = match &mut self.model {
            Model::FirstOrder { parameters, speeds } => {
                let (turned, rolled) =
                    turn_wheels(parameters, speeds, duty, &self.faults, h, response);
                if !lifted {
                    roll(&mut self.pose, parameters.track, rolled);
                }
                turned
            }
            Model::Dynamic(dynamics) => {
                let turned = dynamics.step(&mut self.pose, duty, &self.faults, h);
                if self.encoders.design().before_gear { turned.motors } else { turned.wheels }
            }
        };
        self.encoders.turn(turned, encoders, encoders_swapped);
    }

    /// Pushes the base out of what it overlaps; where there is no way out it stays where it was `before`.
    fn keep_out(
        &mut self,
        before: TruePose,
        radius: f64,
        touches: &mut impl FnMut(TruePose) -> Option<Contact>,
    ) -> Option<f64> {
        let first = touches(self.pose)?;
        let mut contact = first;
        for _ in 0..MOST_PUSHES {
            let Contact { depth, normal: [x, y] } = contact;
            self.pose.x += depth * x;
            self.pose.y += depth * y;
            if let Model::Dynamic(dynamics) = &mut self.model {
                dynamics.bump([x, y], self.pose.heading, radius);
            }
            match touches(self.pose) {
                Some(next) => contact = next,
                None => return Some(first.depth),
            }
        }
        if touches(before).is_none_or(|was| was.depth <= contact.depth) {
            (self.pose.x, self.pose.y) = (before.x, before.y);
        }
        Some(first.depth)
    }

    /// Moves the base as wheels do whose rims roll by these lengths, left and right, m: both on
    /// circles about the same centre, the left one nearer to it by the track.
    pub fn roll(&mut self, rolled: [f64; 2]) {
        let track = match &self.model {
            Model::FirstOrder { parameters, .. } => parameters.track,
            Model::Dynamic(dynamics) => dynamics.design().track,
        };
        roll(&mut self.pose, track, rolled);
    }
}

/// Angles by which the wheels turn in a step, and lengths by which their rims roll.
fn turn_wheels(
    parameters: &BaseParameters,
    speeds: &mut [f64; 2],
    duty: [f64; 2],
    faults: &Faults,
    h: f64,
    response: f64,
) -> ([f64; 2], [f64; 2]) {
    let BaseParameters { no_load_speed, friction_duty, wheel_radius, .. } = *parameters;
    let (mut turned, mut rolled) = ([0.0; 2], [0.0; 2]);
    for wheel in 0..2 {
        let speed = &mut speeds[wheel];
        if faults.blocked[wheel] {
            *speed = 0.0;
            continue;
        }
        let drive = no_load_speed[wheel] * duty[wheel];
        let drag = no_load_speed[wheel] * friction_duty;
        let before = *speed;
        // Friction opposes motion and holds a resting wheel against a weak motor.
        let pull = if *speed == 0.0 {
            drive.signum() * (drive.abs() - drag).max(0.0)
        } else {
            drive - drag * speed.signum()
        };
        *speed += (pull - *speed) * response;
        if before * *speed < 0.0 && drive.abs() <= drag {
            *speed = 0.0;
        }
        turned[wheel] = (before + *speed) / 2.0 * h;
        rolled[wheel] = turned[wheel] * wheel_radius[wheel] * (1.0 - faults.slip[wheel]);
    }
    (turned, rolled)
}

fn roll(pose: &mut TruePose, track: f64, [left, right]: [f64; 2]) {
    let turn = (right - left) / track;
    if turn.abs() < 1e-12 {
        pose.x += left * pose.heading.cos();
        pose.y += left * pose.heading.sin();
        return;
    }
    let radius = left / turn + track / 2.0;
    let (centre_x, centre_y) =
        (pose.x - radius * pose.heading.sin(), pose.y + radius * pose.heading.cos());
    let heading = pose.heading + turn;
    pose.x = centre_x + radius * heading.sin();
    pose.y = centre_y - radius * heading.cos();
    pose.heading = wrapped(heading);
}

/// The same heading in (-π, π].
pub(crate) fn wrapped(heading: f64) -> f64 {
    heading - TAU * ((heading - PI) / TAU).ceil()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn ideal() -> BaseParameters {
        BaseParameters {
            no_load_speed: [18.0; 2],
            encoder_phase: [0.0; 2],
            ..BaseParameters::seeded(0)
        }
    }

    #[test]
    fn a_quarter_circle_by_hand() {
        let mut base = WheeledBase::new(ideal(), TruePose::default());
        // About a centre 1 m to the left: the left wheel rolls 0.94 π/2, the right one 1.06 π/2.
        for _ in 0..1000 {
            base.roll([0.94 * PI / 2000.0, 1.06 * PI / 2000.0]);
        }
        let pose = base.pose();
        assert!((pose.x - 1.0).abs() < 1e-9 && (pose.y - 1.0).abs() < 1e-9, "{pose:?}");
        assert!((pose.heading - PI / 2.0).abs() < 1e-9);
    }

    #[test]
    fn a_motor_reaches_its_speed_less_friction() {
        let mut base = WheeledBase::new(ideal(), TruePose::default());
        base.step([0.5, 0.5], 2.0);
        let before = base.pose().x;
        base.step([0.5, 0.5], 1.0);
        // 18 (0.5 - 0.03) rad/s on 35 mm.
        assert!((base.pose().x - before - 18.0 * 0.47 * 0.035).abs() < 1e-6);
    }

    #[test]
    fn friction_holds_a_resting_base() {
        let mut base = WheeledBase::new(ideal(), TruePose::default());
        base.step([0.029, -0.029], 1.0);
        assert_eq!(base.pose(), TruePose::default());
        base.step([0.5, 0.5], 1.0);
        base.step([0.0, 0.0], 2.0);
        let rest = base.pose();
        base.step([0.0, 0.0], 1.0);
        assert_eq!(base.pose(), rest);
    }

    #[test]
    fn a_slipping_wheel_turns_the_base_and_a_blocked_one_stands() {
        let mut base = WheeledBase::new(ideal(), TruePose::default());
        base.set_faults(Faults { slip: [0.2, 0.0], ..Faults::default() });
        base.step([0.5, 0.5], 1.0);
        // The rims' difference over the track, with the encoders' agreement.
        let rim = base.encoders.angles()[0] * 0.035;
        assert!((base.pose().heading - 0.2 * rim / 0.12).abs() < 1e-9);
        assert_eq!(base.counts()[0], base.counts()[1]);
        base.set_faults(Faults { blocked: [true, false], ..Faults::default() });
        let before = base.counts();
        base.step([0.5, 0.5], 0.5);
        assert!(base.counts()[0] == before[0] && base.counts()[1] > before[1] + 500);
    }

    #[test]
    fn one_turn_of_a_wheel_is_1440_counts() {
        let mut base = WheeledBase::new(ideal(), TruePose::default());
        base.step([0.5, 0.5], 1.0);
        let [left, _] = base.counts();
        assert_eq!(left, (base.encoders.angles()[0] / TAU * 1440.0).floor() as i32);
        assert!(left > 1000);
    }
}
