//! What a base's lengths really are, from where it ends when it believes to be somewhere else.
//!
//! ```text
//! courses ─► legs ─► (robot drives, somebody measures) ─► runs ─► calibrate ─► lengths, before and after
//! ```
//! The courses are those of UMBmark (Borenstein and Feng, 1996): a square driven to the left and to
//! the right, since an error of the track turns both the same way and unequal wheels turn them
//! opposite ways; a straight for the scale; turns on the spot for the track alone.
//!
//! UMBmark's formulas are of first order and take two errors as independent. Here the whole course is
//! computed with trial lengths instead, and Gauss and Newton's rule finds those under which all runs
//! end where they were measured; 2 % of track are then no approximation.
//!
//! | symbol | meaning | unit |
//! |---|---|---|
//! | r, ρ, b | mean wheel radius, right over left radius, track | m, –, m |
//! | x | ln of r, ρ and b over what the robot uses now | – |
//! | J | change of the predicted ends with x | m, rad |

mod course;

pub use course::Course;

use crate::geometry::{Pose, wrap_angle};
use course::Move;
use nalgebra::{DVector, Matrix3, Vector3};
use protocol::parameters::Parameters;
use protocol::units::Metres;

/// One course driven and its end measured.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Run {
    /// What was driven.
    pub course: Course,
    /// Where the robot believes it ended.
    pub believed: Pose,
    /// Where it did end, as seen from where it began.
    pub measured: Pose,
}

/// The lengths that calibration finds.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BaseLengths {
    /// r, m.
    pub wheel_radius: f64,
    /// ρ.
    pub wheel_ratio: f64,
    /// b, m.
    pub track: f64,
}

/// What calibration found.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Calibration {
    /// The lengths.
    pub lengths: BaseLengths,
    /// How far the runs ended from where the robot believed, root mean square, m.
    pub before: f64,
    /// How far they would end with the lengths found, m.
    pub after: f64,
}

/// Why no lengths are found.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error, miette::Diagnostic)]
pub enum CalibrationError {
    /// The runs leave a length open.
    #[error("these runs do not determine all lengths")]
    #[diagnostic(help("drive a square both ways, a straight and a spin"))]
    Undetermined,
    /// A measured end is no number, or no lengths explain the runs.
    #[error("no lengths explain these runs (they still miss by {rms:.3} m)")]
    #[diagnostic(help("measure again"))]
    Unexplained {
        /// What is left, m.
        rms: f64,
    },
    /// A length would be far from what the robot uses now.
    #[error("the {what} would change by {percent:.1} %")]
    #[diagnostic(help("measure again, or set it by hand first"))]
    TooFar {
        /// Which length.
        what: &'static str,
        /// By how much, percent.
        percent: f64,
    },
}

/// Changes beyond this are mistakes of measuring.
const LARGEST_CHANGE: f64 = 0.1;
/// An error of heading of 1 rad weighs as much as one of this many metres: measured on a robot
/// of this size.
const HEADING_ARM: f64 = 0.3;
/// What well-measured runs may leave unexplained, m.
const LARGEST_RMS: f64 = 0.05;
const ITERATIONS: usize = 12;

/// The lengths under which `runs`, driven with `used`, end where they were measured.
///
/// # Errors
/// [`CalibrationError`]
pub fn calibrate(used: BaseLengths, runs: &[Run]) -> Result<Calibration, CalibrationError> {
    let error = |x: &Vector3<f64>| errors(&used, &used.changed(x), runs);
    let before = rms(runs, &used, &used);
    let mut x = Vector3::zeros();
    for _ in 0..ITERATIONS {
        let residual = error(&x);
        let columns = [0, 1, 2].map(|axis| {
            let step = Vector3::from_fn(|row, _| if row == axis { STEP } else { 0.0 });
            (error(&(x + step)) - error(&(x - step))) / (2.0 * STEP)
        });
        x -= solve(&columns, &residual).ok_or(CalibrationError::Undetermined)?;
    }
    let lengths = used.changed(&x);
    let after = rms(runs, &used, &lengths);
    if after.is_nan() || after > LARGEST_RMS {
        return Err(CalibrationError::Unexplained { rms: after });
    }
    for (what, change) in ["wheel radius", "wheel ratio", "track"].into_iter().zip(x.iter()) {
        if change.abs() > LARGEST_CHANGE {
            return Err(CalibrationError::TooFar { what, percent: 100.0 * change.exp_m1() });
        }
    }
    Ok(Calibration { lengths, before, after })
}

/// For the numeric derivative: errors are smooth, and f64 keeps 1e-16.
const STEP: f64 = 1e-5;

/// The least-squares step; `None` where the runs leave a direction open.
fn solve(columns: &[DVector<f64>; 3], residual: &DVector<f64>) -> Option<Vector3<f64>> {
    let normal = Matrix3::from_fn(|row, column| columns[row].dot(&columns[column]));
    let right = Vector3::from_fn(|row, _| columns[row].dot(residual));
    let spread = normal.symmetric_eigenvalues();
    // A change of 1 % must move some end by more than a tenth of a millimetre.
    let determined = spread.min() > 1e-4;
    determined.then(|| normal.lu().solve(&right)).flatten()
}

/// By how much each run misses its measured end: x, y and heading by its arm, m.
fn errors(used: &BaseLengths, lengths: &BaseLengths, runs: &[Run]) -> DVector<f64> {
    let errors = runs.iter().flat_map(|run| {
        let end = run.predicted_end(used, lengths);
        let turn = end.heading - run.measured.heading;
        let (dx, dy) =
            (end.position.x - run.measured.position.x, end.position.y - run.measured.position.y);
        [dx, dy, HEADING_ARM * wrap_angle(turn)]
    });
    DVector::from_iterator(3 * runs.len(), errors)
}

fn rms(runs: &[Run], used: &BaseLengths, lengths: &BaseLengths) -> f64 {
    errors(used, lengths, runs).norm() / (runs.len().max(1) as f64).sqrt()
}

impl Run {
    /// Where the robot ends that drives with lengths `used` and has `real` ones.
    fn predicted_end(&self, used: &BaseLengths, real: &BaseLengths) -> Pose {
        let mut planned = Pose::new(0.0, 0.0, 0.0);
        let mut end = planned;
        for step in self.course.moves() {
            let (way, turn) = match step {
                Move::Drive(way) => (way, 0.0),
                Move::Turn(turn) => (0.0, turn),
            };
            planned = advanced(planned, way, turn);
            let (way, turn) = used.really(real, way, turn);
            end = advanced(end, way, turn);
        }
        // What the robot itself saw of its end's error is no error of its lengths.
        composed(end, seen_from(planned, self.believed))
    }
}

impl BaseLengths {
    /// Those of a robot.
    pub fn of(parameters: &Parameters) -> Self {
        Self {
            wheel_radius: parameters.wheel_radius.0.into(),
            wheel_ratio: parameters.wheel_ratio.into(),
            track: parameters.track.0.into(),
        }
    }

    /// `parameters` with these lengths, under the name `calibration`.
    pub fn applied_to(&self, parameters: &Parameters, calibration: u32) -> Parameters {
        Parameters {
            wheel_radius: Metres(self.wheel_radius as f32),
            wheel_ratio: self.wheel_ratio as f32,
            track: Metres(self.track as f32),
            calibration,
            ..*parameters
        }
    }

    fn changed(&self, x: &Vector3<f64>) -> Self {
        Self {
            wheel_radius: self.wheel_radius * x[0].exp(),
            wheel_ratio: self.wheel_ratio * x[1].exp(),
            track: self.track * x[2].exp(),
        }
    }

    fn radii(&self) -> [f64; 2] {
        let left = 2.0 * self.wheel_radius / (1.0 + self.wheel_ratio);
        [left, self.wheel_ratio * left]
    }

    /// The way and turn of a base with `real` lengths while one with these would do `way` and `turn`.
    fn really(&self, real: &Self, way: f64, turn: f64) -> (f64, f64) {
        let ([left, right], [real_left, real_right]) = (self.radii(), real.radii());
        let left = (way - turn * self.track / 2.0) / left * real_left;
        let right = (way + turn * self.track / 2.0) / right * real_right;
        ((left + right) / 2.0, (right - left) / real.track)
    }
}

/// The end of an arc of length `way` that turns by `turn`.
fn advanced(from: Pose, way: f64, turn: f64) -> Pose {
    let half = turn / 2.0;
    let chord = if half == 0.0 { way } else { way * half.sin() / half };
    composed(from, Pose::new(chord * half.cos(), chord * half.sin(), turn))
}

fn composed(pose: Pose, step: Pose) -> Pose {
    let (sin, cos) = pose.heading.sin_cos();
    let (x, y) = (step.position.x, step.position.y);
    let at = pose.position;
    Pose::new(at.x + cos * x - sin * y, at.y + sin * x + cos * y, pose.heading + step.heading)
}

/// `pose` as seen from `origin`.
pub fn seen_from(origin: Pose, pose: Pose) -> Pose {
    let (sin, cos) = origin.heading.sin_cos();
    let (x, y) = (pose.position.x - origin.position.x, pose.position.y - origin.position.y);
    Pose::new(cos * x + sin * y, cos * y - sin * x, pose.heading - origin.heading)
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;
    use std::f64::consts::FRAC_PI_2;

    const USED: BaseLengths = BaseLengths { wheel_radius: 0.035, wheel_ratio: 1.0, track: 0.12 };

    /// Runs of a robot with `real` lengths that believes to end exactly as planned.
    fn runs(courses: &[Course], real: &BaseLengths) -> Vec<Run> {
        let run = |course: &Course| {
            let start = Pose::new(0.0, 0.0, 0.0);
            let believed = course.moves().into_iter().fold(start, |pose, step| match step {
                Move::Drive(way) => advanced(pose, way, 0.0),
                Move::Turn(turn) => advanced(pose, 0.0, turn),
            });
            let run = Run { course: *course, believed, measured: start };
            Run { measured: run.predicted_end(&USED, real), ..run }
        };
        courses.iter().map(run).collect()
    }

    #[test]
    fn a_straight_and_a_turn_by_hand() {
        // 1 % larger wheels drive 1 % further; a 1 % wider track turns 1/1.01 as far.
        let larger = BaseLengths { wheel_radius: 0.03535, ..USED };
        assert!((USED.really(&larger, 2.0, 0.0).0 - 2.02).abs() < 1e-12);
        let wider = BaseLengths { track: 0.1212, ..USED };
        assert!((USED.really(&wider, 0.0, 1.0).1 - 1.0 / 1.01).abs() < 1e-12);
        // A right wheel 1 % larger: (1.01 - 1)/1.005 of 1 m over 0.12 m.
        let uneven = BaseLengths { wheel_ratio: 1.01, ..USED };
        assert!((USED.really(&uneven, 1.0, 0.0).1 - 0.01 / 1.005 / 0.12).abs() < 1e-12);
    }

    /// UMBmark's own closed form, of first order, as the oracle for small errors.
    #[test]
    fn borenstein_and_fengs_formulas_agree() {
        let real = BaseLengths { wheel_radius: 0.035, wheel_ratio: 1.00005, track: 0.1201 };
        let side = 4.0;
        let squares = runs(&Course::all(side)[2..4], &real);
        let [x_left, x_right] = [0, 1].map(|run| squares[run].measured.position.x);
        let alpha = (x_right + x_left) / (-4.0 * side);
        let beta = (x_right - x_left) / (-4.0 * side);
        // b_actual = 90° / (90° - α) b_nominal; R = (L/2)/sin(β/2), ρ = (R + b/2)/(R - b/2).
        let track = FRAC_PI_2 / (FRAC_PI_2 - alpha) * 0.12;
        let radius = side / 2.0 / (beta / 2.0).sin();
        let ratio = (radius + 0.06) / (radius - 0.06);
        let found = calibrate(USED, &runs(&Course::all(side), &real)).unwrap().lengths;
        // A twentieth of each error: the terms of second order.
        assert!((found.track - track).abs() < 5e-6, "{found:?} {track}");
        assert!((found.wheel_ratio - ratio).abs() < 2.5e-6, "{found:?} {ratio}");
    }

    #[test]
    fn what_cannot_be_known_is_said() {
        let straight = runs(&[Course::Straight { length: 2.0 }], &USED);
        assert_eq!(calibrate(USED, &straight), Err(CalibrationError::Undetermined));
        assert_eq!(calibrate(USED, &[]), Err(CalibrationError::Undetermined));
        let far = BaseLengths { track: 0.15, ..USED };
        let far = calibrate(USED, &runs(&Course::all(2.0), &far));
        assert!(matches!(far, Err(CalibrationError::TooFar { what: "track", .. })), "{far:?}");
    }

    proptest! {
        #[test]
        fn any_lengths_are_found(r in -0.03f64..0.03, ratio in -0.01f64..0.01, b in -0.05f64..0.05) {
            let real = USED.changed(&Vector3::new(r, ratio, b));
            let found = calibrate(USED, &runs(&Course::all(2.0), &real)).unwrap();
            prop_assert!((found.lengths.track / real.track - 1.0).abs() < 1e-6);
            prop_assert!((found.lengths.wheel_ratio / real.wheel_ratio - 1.0).abs() < 1e-6);
            prop_assert!((found.lengths.wheel_radius / real.wheel_radius - 1.0).abs() < 1e-6);
            prop_assert!(found.after < 1e-6);
        }

        #[test]
        fn the_legs_drive_the_course(side in 0.5f64..5.0, left: bool) {
            let limits = crate::legs::DEFAULT_LIMITS;
            for course in [Course::Square { side, left }, Course::Spin { turns: 2 }] {
                let mut turned = 0.0;
                for leg in course.legs() {
                    prop_assert_eq!(leg.check(&limits), Ok(()));
                    let [first, _, last] = leg.intervals(&limits);
                    turned += f64::from(first.change + last.change);
                }
                let planned: f64 = course.moves().iter().map(|step| match step {
                    Move::Drive(_) => 0.0,
                    Move::Turn(turn) => *turn,
                }).sum();
                // A dozen turns in f32.
                prop_assert!((turned - planned).abs() < 1e-5, "{turned} {planned}");
            }
        }
    }
}
