//! Keeps the robot on its path: corrects the planned twist by the measured deviation.
//!
//! u1 = u1r cos e_φ + k_x e_x, u2 = u2r + k_y u1r e_y + k_φ sin e_φ (Kanayama et al., 1990).
//!
//! *Deviation:* the paper solves each leg from where it begins and drives it open-loop; what slips remains. The
//! deviation is in the frame of the robot.
//!
//! | symbol | meaning | unit |
//! |---|---|---|
//! | e_x, e_y | where the reference is: ahead, to the left | m |
//! | e_φ | by how much the reference looks further left | rad |
//! | u1r, u2r | planned twist | m/s, rad/s |

use protocol::motion::{Pose, Twist};
use protocol::parameters::TrackerGains;
use protocol::trigonometry::sin_cos;
use protocol::units::{MetresPerSecond, Radians, RadiansPerSecond};

/// The twist that leads back to `reference` while moving along it with `planned`.
pub(crate) fn correct(
    planned: Twist,
    reference: Pose,
    measured: Pose,
    gains: &TrackerGains,
) -> Twist {
    let (dx, dy) = (reference.x.0 - measured.x.0, reference.y.0 - measured.y.0);
    let (sin, cos) = sin_cos(measured.heading.0);
    let (ahead, left) = (cos * dx + sin * dy, cos * dy - sin * dx);
    let turn = Radians(reference.heading.0 - measured.heading.0).wrapped().0;
    let (sin_turn, cos_turn) = sin_cos(turn);
    let u1 = planned.linear.0;
    Twist {
        linear: MetresPerSecond(u1 * cos_turn + gains.along * ahead),
        angular: RadiansPerSecond(
            planned.angular.0 + gains.across * u1 * left + gains.heading * sin_turn,
        ),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn one_centimetre_right_of_the_path_turns_left() {
        let gains = TrackerGains::default();
        let planned = Twist { linear: MetresPerSecond(0.2), angular: RadiansPerSecond(0.0) };
        let twist = correct(planned, Pose::new(1.0, 0.0, 0.0), Pose::new(1.0, -0.01, 0.0), &gains);
        // k_y u1 e_y.
        assert!((twist.angular.0 - gains.across * 0.2 * 0.01).abs() < 1e-6);
        assert!(twist.angular.0 > 0.1);
    }

    #[test]
    fn on_the_path_nothing_is_corrected() {
        let planned = Twist { linear: MetresPerSecond(0.3), angular: RadiansPerSecond(0.1) };
        let pose = Pose::new(0.4, 0.5, 2.0);
        assert_eq!(correct(planned, pose, pose, &TrackerGains::default()), planned);
    }

    #[test]
    fn a_unicycle_beside_the_path_comes_back_in_either_direction() {
        for speed in [0.4f32, -0.4] {
            let planned = Twist { linear: MetresPerSecond(speed), angular: RadiansPerSecond(0.0) };
            let (mut x, mut y, mut heading) = (0.0f32, 0.02f32, 0.1f32);
            for tick in 0..600 {
                let reference = Pose::new(speed * tick as f32 * 0.005, 0.0, 0.0);
                let twist =
                    correct(planned, reference, Pose::new(x, y, heading), &TrackerGains::default());
                x += twist.linear.0 * heading.cos() * 0.005;
                y += twist.linear.0 * heading.sin() * 0.005;
                heading += twist.angular.0 * 0.005;
            }
            assert!(y.abs() < 1e-4 && heading.abs() < 1e-3, "{speed}: {y} {heading}");
        }
    }
}
