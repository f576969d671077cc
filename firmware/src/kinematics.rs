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
use protocol::parameters::Parameters;
use protocol::units::{Metres, MetresPerSecond, RadiansPerSecond};

/// The lengths that tie wheels to body, with the reciprocals by which a control tick multiplies: on a
/// processor without floating point a division costs half as much again as a product.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BaseGeometry {
    /// rL and rR, m.
    radii: [f32; 2],
    /// 1/rL and 1/rR, 1/m.
    per_radius: [f32; 2],
    /// b/2, m.
    half_track: f32,
    /// 1/b, 1/m.
    per_track: f32,
}

impl From<&Parameters> for BaseGeometry {
    fn from(parameters: &Parameters) -> Self {
        Self::new(parameters.wheel_radius, parameters.wheel_ratio, parameters.track)
    }
}

impl BaseGeometry {
    /// The geometry for r, ρ and b.
    pub fn new(wheel_radius: Metres, wheel_ratio: f32, track: Metres) -> Self {
        let left = 2.0 * wheel_radius.0 / (1.0 + wheel_ratio);
        let radii = [left, left * wheel_ratio];
        Self {
            radii,
            per_radius: radii.map(f32::recip),
            half_track: track.0 / 2.0,
            per_track: track.0.recip(),
        }
    }

    /// rL and rR.
    pub fn radii(&self) -> [Metres; 2] {
        self.radii.map(Metres)
    }

    /// The angular velocity of each wheel whose rim moves at `speeds`, rad/s.
    pub fn turning(&self, speeds: [MetresPerSecond; 2]) -> WheelSpeeds {
        let [left, right] = speeds;
        let [per_left, per_right] = self.per_radius;
        WheelSpeeds {
            left: RadiansPerSecond(left.0 * per_left),
            right: RadiansPerSecond(right.0 * per_right),
        }
    }

    /// How fast the rims move where the base moves with `twist`: u1 ∓ u2 b/2.
    pub fn rims(&self, twist: Twist) -> [MetresPerSecond; 2] {
        let (u1, spread) = (twist.linear.0, twist.angular.0 * self.half_track);
        [MetresPerSecond(u1 - spread), MetresPerSecond(u1 + spread)]
    }

    /// u1 = (rR φ̇R + rL φ̇L)/2, u2 = (rR φ̇R - rL φ̇L)/b.
    pub fn twist(&self, wheels: WheelSpeeds) -> Twist {
        let [radius_left, radius_right] = self.radii;
        let (left, right) = (radius_left * wheels.left.0, radius_right * wheels.right.0);
        Twist {
            linear: MetresPerSecond((right + left) * 0.5),
            angular: RadiansPerSecond((right - left) * self.per_track),
        }
    }

    /// The inverse: φ̇R = (u1 + u2 b/2)/rR, φ̇L = (u1 - u2 b/2)/rL.
    ///
    /// ```
    /// use wmr_firmware::kinematics::BaseGeometry;
    /// use protocol::{motion::Twist, units::*};
    /// let base = BaseGeometry::new(Metres(0.05), 1.0, Metres(0.2));
    /// let twist = Twist { linear: MetresPerSecond(0.5), angular: RadiansPerSecond(1.0) };
    /// let wheels = base.wheel_speeds(twist);
    /// assert!((wheels.left.0 - 8.0).abs() < 1e-5 && (wheels.right.0 - 12.0).abs() < 1e-5);
    /// ```
    pub fn wheel_speeds(&self, twist: Twist) -> WheelSpeeds {
        self.turning(self.rims(twist))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn base(wheel_ratio: f32) -> BaseGeometry {
        BaseGeometry::new(Metres(0.05), wheel_ratio, Metres(0.2))
    }

    #[test]
    fn equation_4_by_hand() {
        let wheels = WheelSpeeds { left: RadiansPerSecond(8.0), right: RadiansPerSecond(12.0) };
        let twist = base(1.0).twist(wheels);
        assert!((twist.linear.0 - 0.5).abs() < 1e-6);
        assert!((twist.angular.0 - 1.0).abs() < 1e-6);
    }

    #[test]
    fn a_larger_right_wheel_turns_left_by_hand() {
        // ρ = 1.5: rL = 0.04 m, rR = 0.06 m; at 10 rad/s 0.5 m/s and (0.6 - 0.4)/0.2 = 1 rad/s.
        let wheels = WheelSpeeds { left: RadiansPerSecond(10.0), right: RadiansPerSecond(10.0) };
        let twist = base(1.5).twist(wheels);
        assert!((twist.linear.0 - 0.5).abs() < 1e-6);
        assert!((twist.angular.0 - 1.0).abs() < 1e-6);
    }

    proptest! {
        #[test]
        fn there_and_back(left in -20.0f32..20.0, right in -20.0f32..20.0, wheel_ratio in 0.9f32..1.1) {
            let wheels = WheelSpeeds { left: RadiansPerSecond(left), right: RadiansPerSecond(right) };
            let base = base(wheel_ratio);
            let back = base.wheel_speeds(base.twist(wheels));
            // Two products and a sum of numbers up to 20, in f32.
            prop_assert!((back.left.0 - left).abs() < 2e-5 && (back.right.0 - right).abs() < 2e-5);
        }
    }
}
