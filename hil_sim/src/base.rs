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
        let no_load_speed = [motor(), motor()];
        Self {
            wheel_radius: [0.035; 2],
            track: 0.12,
            counts_per_turn: 1440,
            no_load_speed,
            time_constant: 0.06,
            friction_duty: 0.03,
            encoder_phase: [random.f64(), random.f64()],
        }
    }
}

impl BaseParameters {
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
    /// What each encoder does.
    pub encoders: [EncoderFault; 2],
}

/// What an encoder may do instead of counting.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum EncoderFault {
    /// Nothing: it counts.
    #[default]
    None,
    /// Its wire is off: it stands still.
    Stuck,
    /// Its wires are swapped: it counts backwards.
    Reversed,
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

/// A base that moves.
#[derive(Clone, Debug)]
pub struct WheeledBase {
    parameters: BaseParameters,
    pose: TruePose,
    speeds: [f64; 2],
    angles: [f64; 2],
    counted: [f64; 2],
    faults: Faults,
}

/// The motors' equation is integrated in steps of this length, s: a hundredth of their time constant.
const STEP: f64 = 0.0005;

impl WheeledBase {
    /// A resting base at `pose`.
    pub fn new(parameters: BaseParameters, pose: TruePose) -> Self {
        Self {
            parameters,
            pose,
            speeds: [0.0; 2],
            angles: [0.0; 2],
            counted: [0.0; 2],
            faults: Faults::default(),
        }
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
        self.speeds
    }

    /// The encoders' counts since the start, left and right.
    pub fn counts(&self) -> [i32; 2] {
        let per_radian = f64::from(self.parameters.counts_per_turn) / TAU;
        let [left, right] = self.counted;
        let [left_phase, right_phase] = self.parameters.encoder_phase;
        [
            (left * per_radian + left_phase).floor() as i32,
            (right * per_radian + right_phase).floor() as i32,
        ]
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
        let steps = (seconds / STEP).round().max(1.0);
        let h = seconds / steps;
        let response = 1.0 - (-h / self.parameters.time_constant).exp();
        for _ in 0..steps as u32 {
            self.step_once(duty, h, response);
        }
    }

    fn step_once(&mut self, duty: [f64; 2], h: f64, response: f64) {
        let BaseParameters { no_load_speed, friction_duty, wheel_radius, .. } = self.parameters;
        let Faults { slip, blocked, encoders } = self.faults;
        let mut rolled = [0.0; 2];
        for wheel in 0..2 {
            if blocked[wheel] {
                self.speeds[wheel] = 0.0;
                continue;
            }
            let speed = &mut self.speeds[wheel];
            let drive = no_load_speed[wheel] * duty[wheel].clamp(-1.0, 1.0);
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
            let angle = (before + *speed) / 2.0 * h;
            self.angles[wheel] += angle;
            self.counted[wheel] += encoders[wheel].counted(angle);
            rolled[wheel] = angle * wheel_radius[wheel] * (1.0 - slip[wheel]);
        }
        self.roll(rolled);
    }

    /// Moves the base as wheels do whose rims roll by these lengths, left and right, m: both on
    /// circles about the same centre, the left one `track` nearer to it.
    pub fn roll(&mut self, [left, right]: [f64; 2]) {
        let turn = (right - left) / self.parameters.track;
        let pose = &mut self.pose;
        if turn.abs() < 1e-12 {
            pose.x += left * pose.heading.cos();
            pose.y += left * pose.heading.sin();
            return;
        }
        let radius = left / turn + self.parameters.track / 2.0;
        let (centre_x, centre_y) =
            (pose.x - radius * pose.heading.sin(), pose.y + radius * pose.heading.cos());
        let heading = pose.heading + turn;
        pose.x = centre_x + radius * heading.sin();
        pose.y = centre_y - radius * heading.cos();
        pose.heading = heading - TAU * ((heading - PI) / TAU).ceil();
    }
}

impl EncoderFault {
    fn counted(self, angle: f64) -> f64 {
        match self {
            Self::None => angle,
            Self::Stuck => 0.0,
            Self::Reversed => -angle,
        }
    }
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
        let rim = base.angles[0] * 0.035;
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
        assert_eq!(left, (base.angles[0] / TAU * 1440.0).floor() as i32);
        assert!(left > 1000);
    }
}
