//! Wheels to body and back [Alghannam, Eq. 4].
//!
//! | symbol | meaning | unit |
//! |---|---|---|
//! | u1, u2 | linear and angular velocity of the base | m/s, rad/s |
//! | φ̇R, φ̇L | angular velocity of the right and left wheel | rad/s |
//! | r | mean radius of the wheels | m |
//! | ρ | radius of the right wheel over that of the left | – |
//! | b | track: distance between the wheels' contact points | m |
//!
//! *Deviation:* the paper's wheels are equal. Real ones differ by up to a percent, which bends a
//! straight line into a circle, so each wheel has its own radius: rL = 2r/(1 + ρ), rR = ρ rL. With
//! ρ = 1 the formulas are the paper's.

use protocol::motion::{Twist, WheelSpeeds};
use protocol::units::{Metres, MetresPerSecond, RadiansPerSecond};

/// The lengths that tie wheels to body.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BaseGeometry {
    /// r.
    pub wheel_radius: Metres,
    /// ρ.
    pub wheel_ratio: f32,
    /// b.
    pub track: Metres,
}

impl BaseGeometry {
    /// rL and rR.
    pub fn radii(&self) -> [Metres; 2] {
        let left = 2.0 * self.wheel_radius.0 / (1.0 + self.wheel_ratio);
        [Metres(left), Metres(left * self.wheel_ratio)]
    }

    /// u1 = (rR φ̇R + rL φ̇L)/2, u2 = (rR φ̇R - rL φ̇L)/b.
    pub fn twist(&self, wheels: WheelSpeeds) -> Twist {
        let [radius_left, radius_right] = self.radii();
        let (left, right) = (radius_left.0 * wheels.left.0, radius_right.0 * wheels.right.0);
        Twist {
            linear: MetresPerSecond((right + left) / 2.0),
            angular: RadiansPerSecond((right - left) / self.track.0),
        }
    }

    /// The inverse: φ̇R = (u1 + u2 b/2)/rR, φ̇L = (u1 - u2 b/2)/rL.
    ///
    /// ```
    /// use firmware::kinematics::BaseGeometry;
    /// use protocol::{motion::Twist, units::*};
    /// let base = BaseGeometry { wheel_radius: Metres(0.05), wheel_ratio: 1.0, track: Metres(0.2) };
    /// let twist = Twist { linear: MetresPerSecond(0.5), angular: RadiansPerSecond(1.0) };
    /// let wheels = base.wheel_speeds(twist);
    /// assert!((wheels.left.0 - 8.0).abs() < 1e-5 && (wheels.right.0 - 12.0).abs() < 1e-5);
    /// ```
    pub fn wheel_speeds(&self, twist: Twist) -> WheelSpeeds {
        let [radius_left, radius_right] = self.radii();
        let (u1, spread) = (twist.linear.0, twist.angular.0 * self.track.0 / 2.0);
        WheelSpeeds {
            left: RadiansPerSecond((u1 - spread) / radius_left.0),
            right: RadiansPerSecond((u1 + spread) / radius_right.0),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    const BASE: BaseGeometry =
        BaseGeometry { wheel_radius: Metres(0.05), wheel_ratio: 1.0, track: Metres(0.2) };

    #[test]
    fn equation_4_by_hand() {
        let wheels = WheelSpeeds { left: RadiansPerSecond(8.0), right: RadiansPerSecond(12.0) };
        let twist = BASE.twist(wheels);
        assert!((twist.linear.0 - 0.5).abs() < 1e-6);
        assert!((twist.angular.0 - 1.0).abs() < 1e-6);
    }

    #[test]
    fn a_larger_right_wheel_turns_left_by_hand() {
        // ρ = 1.5: rL = 0.04 m, rR = 0.06 m; at 10 rad/s 0.5 m/s and (0.6 - 0.4)/0.2 = 1 rad/s.
        let base = BaseGeometry { wheel_ratio: 1.5, ..BASE };
        let wheels = WheelSpeeds { left: RadiansPerSecond(10.0), right: RadiansPerSecond(10.0) };
        let twist = base.twist(wheels);
        assert!((twist.linear.0 - 0.5).abs() < 1e-6);
        assert!((twist.angular.0 - 1.0).abs() < 1e-6);
    }

    proptest! {
        #[test]
        fn there_and_back(left in -20.0f32..20.0, right in -20.0f32..20.0, wheel_ratio in 0.9f32..1.1) {
            let wheels = WheelSpeeds { left: RadiansPerSecond(left), right: RadiansPerSecond(right) };
            let base = BaseGeometry { wheel_ratio, ..BASE };
            let back = base.wheel_speeds(base.twist(wheels));
            // Two products and a sum of numbers up to 20, in f32.
            prop_assert!((back.left.0 - left).abs() < 2e-5 && (back.right.0 - right).abs() < 2e-5);
        }
    }
}
