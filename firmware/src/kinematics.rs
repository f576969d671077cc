//! Wheels to body and back [Alghannam, Eq. 4].
//!
//! | symbol | meaning | unit |
//! |---|---|---|
//! | u1, u2 | linear and angular velocity of the base | m/s, rad/s |
//! | φ̇R, φ̇L | angular velocity of the right and left wheel | rad/s |
//! | r | wheel radius | m |
//! | b | track: distance between the wheels' contact points | m |

use protocol::motion::{Twist, WheelSpeeds};
use protocol::units::{Metres, MetresPerSecond, RadiansPerSecond};

/// The two lengths that tie wheels to body.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BaseGeometry {
    /// r.
    pub wheel_radius: Metres,
    /// b.
    pub track: Metres,
}

impl BaseGeometry {
    /// u1 = r/2 (φ̇R + φ̇L), u2 = r/b (φ̇R - φ̇L).
    pub fn twist(&self, wheels: WheelSpeeds) -> Twist {
        let (r, b) = (self.wheel_radius.0, self.track.0);
        let (left, right) = (wheels.left.0, wheels.right.0);
        Twist {
            linear: MetresPerSecond(r / 2.0 * (right + left)),
            angular: RadiansPerSecond(r / b * (right - left)),
        }
    }

    /// The inverse: φ̇R = (u1 + u2 b/2)/r, φ̇L = (u1 - u2 b/2)/r.
    ///
    /// ```
    /// use firmware::kinematics::BaseGeometry;
    /// use protocol::{motion::Twist, units::*};
    /// let base = BaseGeometry { wheel_radius: Metres(0.05), track: Metres(0.2) };
    /// let twist = Twist { linear: MetresPerSecond(0.5), angular: RadiansPerSecond(1.0) };
    /// let wheels = base.wheel_speeds(twist);
    /// assert!((wheels.left.0 - 8.0).abs() < 1e-5 && (wheels.right.0 - 12.0).abs() < 1e-5);
    /// ```
    pub fn wheel_speeds(&self, twist: Twist) -> WheelSpeeds {
        let (r, b) = (self.wheel_radius.0, self.track.0);
        let (u1, u2) = (twist.linear.0, twist.angular.0);
        WheelSpeeds {
            left: RadiansPerSecond((u1 - u2 * b / 2.0) / r),
            right: RadiansPerSecond((u1 + u2 * b / 2.0) / r),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    const BASE: BaseGeometry = BaseGeometry { wheel_radius: Metres(0.05), track: Metres(0.2) };

    #[test]
    fn equation_4_by_hand() {
        let wheels = WheelSpeeds { left: RadiansPerSecond(8.0), right: RadiansPerSecond(12.0) };
        let twist = BASE.twist(wheels);
        assert!((twist.linear.0 - 0.5).abs() < 1e-6);
        assert!((twist.angular.0 - 1.0).abs() < 1e-6);
    }

    proptest! {
        #[test]
        fn there_and_back(left in -20.0f32..20.0, right in -20.0f32..20.0) {
            let wheels = WheelSpeeds { left: RadiansPerSecond(left), right: RadiansPerSecond(right) };
            let back = BASE.wheel_speeds(BASE.twist(wheels));
            // Two products and a sum of numbers up to 20, in f32.
            prop_assert!((back.left.0 - left).abs() < 2e-5 && (back.right.0 - right).abs() < 2e-5);
        }
    }
}
