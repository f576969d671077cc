//! The wheel speeds that are commanded for a wanted twist: never beyond V, never changing faster than A.
//!
//! Both wheels are slowed alike where one would be too fast, so that the curve stays; then each goes
//! no further from the last tick's speed than A allows. Feedback included.

use crate::kinematics::BaseGeometry;
use protocol::motion::{Limits, TICK, Twist, WheelSpeeds};
use protocol::units::{MetresPerSecond, RadiansPerSecond};

/// The speeds commanded, and how much of the wanted ones they are.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct WheelCommand {
    /// For the wheel loops.
    pub(crate) wheels: WheelSpeeds,
    /// The share of the wanted speed that V leaves, 0..=1; a reference must wait by as much.
    pub(crate) share: f32,
}

impl WheelCommand {
    /// Nothing moves.
    pub(crate) const REST: Self = Self {
        wheels: WheelSpeeds { left: RadiansPerSecond(0.0), right: RadiansPerSecond(0.0) },
        share: 1.0,
    };

    /// The next tick's command after this one, for `wanted`.
    pub(crate) fn towards(&self, wanted: Twist, geometry: &BaseGeometry, limits: &Limits) -> Self {
        let [left, right] = geometry.rims(wanted).map(|speed| speed.0);
        let fastest = left.abs().max(right.abs());
        let share = if fastest > limits.speed.0 { limits.speed.0 / fastest } else { 1.0 };
        let wanted = geometry.turning([left, right].map(|speed| MetresPerSecond(speed * share)));
        let change = MetresPerSecond(limits.acceleration.0 * TICK.0);
        let change = geometry.turning([change; 2]);
        let step = |wanted: RadiansPerSecond, last: RadiansPerSecond, change: RadiansPerSecond| {
            RadiansPerSecond(last.0 + (wanted.0 - last.0).clamp(-change.0, change.0))
        };
        let wheels = WheelSpeeds {
            left: step(wanted.left, self.wheels.left, change.left),
            right: step(wanted.right, self.wheels.right, change.right),
        };
        Self { wheels, share }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;
    use protocol::parameters::Parameters;

    #[test]
    fn the_first_tick_towards_twice_the_limit_by_hand() {
        let parameters = Parameters::default();
        let wanted = Twist { linear: MetresPerSecond(0.8), angular: RadiansPerSecond(0.0) };
        let next = WheelCommand::REST.towards(wanted, &(&parameters).into(), &parameters.limits());
        // 0.8 m/s² for 5 ms on 35 mm, and half of the speed wanted.
        assert!((next.wheels.left.0 - 0.8 * 0.005 / 0.035).abs() < 1e-6);
        assert_eq!(next.share, 0.5);
    }

    proptest! {
        #[test]
        fn neither_limit_is_ever_passed(
            wanted in prop::collection::vec((-2.0f32..2.0, -20.0f32..20.0), 1..200), ratio in 0.95f32..1.05,
        ) {
            let parameters = Parameters { wheel_ratio: ratio, ..Parameters::default() };
            let (geometry, limits) = (BaseGeometry::from(&parameters), parameters.limits());
            let [left_radius, right_radius] = geometry.radii();
            let rims = |command: &WheelCommand| {
                [command.wheels.left.0 * left_radius.0, command.wheels.right.0 * right_radius.0]
            };
            let mut command = WheelCommand::REST;
            for (linear, angular) in wanted {
                let twist = Twist { linear: MetresPerSecond(linear), angular: RadiansPerSecond(angular) };
                let next = command.towards(twist, &geometry, &limits);
                for (now, before) in rims(&next).into_iter().zip(rims(&command)) {
                    // A few roundings of f32.
                    prop_assert!(now.abs() <= 0.4 * (1.0 + 1e-5));
                    prop_assert!((now - before).abs() <= 0.8 * 0.005 * (1.0 + 1e-4));
                }
                command = next;
            }
        }
    }
}
