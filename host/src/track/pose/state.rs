//! The state of the pose filter, its prediction by odometry and its correction by a camera's pose.
//!
//! | symbol | meaning | unit |
//! |---|---|---|
//! | x, y, φ | pose | m, m, rad |
//! | s | both wheels are 1 + s times as large as odometry believes | – |
//! | ρ | the right wheel is 1 + ρ times as large as the left, beyond what odometry believes | – |
//! | τ | the track is 1 + τ times as wide as odometry believes | – |
//! | d, θ | path and turn of a step as odometry has it | m, rad |
//! | b | the track as odometry believes it | m |
//!
//! The rims of the believed base run d ∓ bθ/2; those of the true base (1 + s)(1 ∓ ρ/2) times as far, on a
//! track of (1 + τ) b. So, to first order in ρ,
//!
//! ```text
//! d' = (1 + s)(d + ρ b θ/4)        θ' = (1 + s)/(1 + τ) · (θ + ρ d/b)
//! ```
//! and the pose moves along an arc of length d' that turns by θ'.

use super::PoseSigma;
use crate::geometry::{Pose, wrap_angle};
use nalgebra::{Matrix3, Matrix3x6, Matrix6, Matrix6x3, Vector3, Vector6};

/// A wheel slips along its way: the path's error, m for each √m.
const PATH_NOISE: f64 = 0.003;
/// A tyre slips sideways, m for each √m.
const SIDE_NOISE: f64 = 0.001;
/// The heading's error by driving, rad for each √m, and by turning, rad for each √rad.
const HEADING_NOISE: [f64; 2] = [0.01, 0.008];
/// How wheels and track change while the robot drives (tyres scrub, one floor is not the other), for each
/// √s of motion.
const DRIFT: f64 = 1e-4;

/// How far off the base may be from what the robot believes of it before anything is known: scale, ratio,
/// track.
const FIRST_SIGMAS: [f64; 3] = [0.02, 0.005, 0.04];

/// What odometry says of a stretch of time.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Step {
    /// How long it took, s.
    pub(super) seconds: f64,
    /// d, forward, m.
    pub(super) path: f64,
    /// θ, rad.
    pub(super) turn: f64,
}

impl Step {
    /// The step's end as seen from its begin.
    pub(super) fn as_pose(self) -> Pose {
        let half = self.turn / 2.0;
        let chord = self.path * sinc(half);
        Pose::new(chord * half.cos(), chord * half.sin(), self.turn)
    }

    /// The step along an arc that ends at `relative`, as seen from its begin.
    pub(super) fn along_arc(relative: Pose, seconds: f64) -> Self {
        let half = relative.heading / 2.0;
        let chord = relative.position.x * half.cos() + relative.position.y * half.sin();
        Self { seconds, path: chord / sinc(half), turn: relative.heading }
    }

    /// The part of an even step.
    pub(super) fn part(self, share: f64) -> Self {
        Self { seconds: self.seconds * share, path: self.path * share, turn: self.turn * share }
    }
}

/// Mean and covariance of (x, y, φ, s, ρ, τ).
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct State {
    pub(super) mean: Vector6<f64>,
    pub(super) covariance: Matrix6<f64>,
}

/// By how much a camera's pose differs from the state.
#[derive(Clone, Copy, Debug)]
pub(super) struct Innovation {
    difference: Vector3<f64>,
    covariance: Matrix3<f64>,
    inverse: Matrix3<f64>,
}

impl State {
    /// A robot at `pose` whose base nobody has measured.
    pub(super) fn new(pose: Pose, sigma: PoseSigma) -> Self {
        let mut state = Self { mean: Vector6::zeros(), covariance: Matrix6::zeros() };
        for (index, sigma) in FIRST_SIGMAS.into_iter().enumerate() {
            state.covariance[(3 + index, 3 + index)] = sigma * sigma;
        }
        state.place(pose, sigma);
        state
    }

    /// Puts the robot somewhere else; what is known of the base stays.
    pub(super) fn place(&mut self, pose: Pose, sigma: PoseSigma) {
        let noise = sigma.covariance();
        self.mean.fixed_rows_mut::<3>(0).copy_from(&vector(pose));
        self.covariance.fixed_view_mut::<3, 3>(0, 0).copy_from(&noise);
        self.covariance.fixed_view_mut::<3, 3>(0, 3).fill(0.0);
        self.covariance.fixed_view_mut::<3, 3>(3, 0).fill(0.0);
    }

    pub(super) fn pose(&self) -> Pose {
        Pose::new(self.mean[0], self.mean[1], wrap_angle(self.mean[2]))
    }

    pub(super) fn pose_covariance(&self) -> Matrix3<f64> {
        self.covariance.fixed_view::<3, 3>(0, 0).into_owned()
    }

    /// Follows odometry over a step of a base with the track `b`.
    pub(super) fn predict(&mut self, step: Step, b: f64) {
        let Step { seconds, path: d, turn } = step;
        if d == 0.0 && turn == 0.0 {
            return;
        }
        let (s, ratio, track) = (1.0 + self.mean[3], self.mean[4], 1.0 + self.mean[5]);
        let path = s * (d + ratio * b * turn / 4.0);
        let angle = s / track * (turn + ratio * d / b);
        let (sin, cos) = (self.mean[2] + angle / 2.0).sin_cos();
        let chord = sinc(angle / 2.0);
        self.mean[0] += path * chord * cos;
        self.mean[1] += path * chord * sin;
        self.mean[2] = wrap_angle(self.mean[2] + angle);

        // By (path, side, angle); the arc is short, so that its chord is as long as itself.
        let by_motion = Matrix3::new(
            cos,
            -sin,
            -path * sin / 2.0, //
            sin,
            cos,
            path * cos / 2.0, //
            0.0,
            0.0,
            1.0,
        );
        let motion_by_base = Matrix3::new(
            path / s,
            s * b * turn / 4.0,
            0.0, //
            0.0,
            0.0,
            0.0, //
            angle / s,
            s / track * d / b,
            -angle / track,
        );
        let mut transition = Matrix6::identity();
        transition[(0, 2)] = -path * sin;
        transition[(1, 2)] = path * cos;
        transition.fixed_view_mut::<3, 3>(0, 3).copy_from(&(by_motion * motion_by_base));

        let noise = Matrix3::from_diagonal(&Vector3::new(
            PATH_NOISE.powi(2) * path.abs(),
            SIDE_NOISE.powi(2) * path.abs(),
            HEADING_NOISE[0].powi(2) * path.abs() + HEADING_NOISE[1].powi(2) * angle.abs(),
        ));
        self.covariance = transition * self.covariance * transition.transpose();
        let mut added = self.covariance.fixed_view_mut::<3, 3>(0, 0);
        added += by_motion * noise * by_motion.transpose();
        for index in 3..6 {
            self.covariance[(index, index)] += DRIFT * DRIFT * seconds;
        }
    }

    /// By how much `seen` differs from the state.
    pub(super) fn innovation(&self, seen: Pose, sigma: PoseSigma) -> Option<Innovation> {
        let mut difference = vector(seen) - self.mean.fixed_rows::<3>(0);
        difference[2] = wrap_angle(difference[2]);
        let covariance = self.pose_covariance() + sigma.covariance();
        Some(Innovation { difference, covariance, inverse: covariance.try_inverse()? })
    }

    /// Takes in what a camera saw.
    pub(super) fn correct(&mut self, innovation: &Innovation, sigma: PoseSigma) {
        let by_pose: Matrix6x3<f64> = self.covariance.fixed_columns::<3>(0).into_owned();
        let gain = by_pose * innovation.inverse;
        self.mean += gain * innovation.difference;
        self.mean[2] = wrap_angle(self.mean[2]);
        // Joseph's form: stays positive however small the noise.
        let seen: Matrix3x6<f64> = Matrix3x6::identity();
        let rest = Matrix6::identity() - gain * seen;
        self.covariance = rest * self.covariance * rest.transpose()
            + gain * sigma.covariance() * gain.transpose();
    }
}

impl Innovation {
    /// The squared Mahalanobis distance, three degrees of freedom.
    pub(super) fn squared(&self) -> f64 {
        (self.difference.transpose() * self.inverse * self.difference)[0]
    }

    /// The distance on the floor, m, and the turn, rad.
    pub(super) fn parts(&self) -> (f64, f64) {
        (self.difference[0].hypot(self.difference[1]), self.difference[2])
    }

    /// The standard deviation expected of the distance on the floor, m.
    pub(super) fn expected(&self) -> f64 {
        largest(self.covariance[(0, 0)], self.covariance[(0, 1)], self.covariance[(1, 1)]).sqrt()
    }
}

/// The larger eigenvalue of [[a, b], [b, c]].
pub(super) fn largest(a: f64, b: f64, c: f64) -> f64 {
    (a + c) / 2.0 + ((a - c) / 2.0).hypot(b)
}

fn vector(pose: Pose) -> Vector3<f64> {
    Vector3::new(pose.position.x, pose.position.y, pose.heading)
}

/// sin(a)/a.
fn sinc(a: f64) -> f64 {
    if a.abs() < 1e-4 { 1.0 - a * a / 6.0 } else { a.sin() / a }
}
