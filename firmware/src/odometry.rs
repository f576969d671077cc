//! Where the robot is, from encoder counts.
//!
//! Between two ticks both wheels turn evenly, so the base runs along a circular arc: its chord has
//! the direction of the heading half-way, and the length of the arc times sin(Δ/2)/(Δ/2). The
//! heading itself is computed from whole counts since the last known pose, so it does not drift by
//! rounding however long the robot drives.
//!
//! | symbol | meaning | unit |
//! |---|---|---|
//! | s | path of the middle of the axis in this tick | m |
//! | Δ | change of heading in this tick | rad |

use crate::kinematics::BaseGeometry;
use crate::parameters::Parameters;
use protocol::motion::Pose;
use protocol::trigonometry::sin_cos;
use protocol::units::{Metres, Radians};

/// The pose that the encoders tell.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Odometry {
    pose: Pose,
    /// The heading and right-minus-left counts when the pose was last set.
    heading_origin: Radians,
    spread_origin: i32,
    counts: [i32; 2],
}

impl Odometry {
    /// Begins at `pose` with the encoders at `counts` (left, right).
    pub fn new(pose: Pose, counts: [i32; 2]) -> Self {
        Self { pose, heading_origin: pose.heading, spread_origin: spread(counts), counts }
    }

    /// Where the robot is.
    pub fn pose(&self) -> Pose {
        self.pose
    }

    /// Takes in the encoders' counts (left, right) of this tick; they may wrap around.
    pub fn update(&mut self, counts: [i32; 2], parameters: &Parameters) {
        let BaseGeometry { wheel_radius, track } = parameters.geometry;
        let metres_per_count = parameters.radians_per_count() * wheel_radius.0;
        let [left, right] = counts;
        let [old_left, old_right] = self.counts;
        let (left, right) = (left.wrapping_sub(old_left), right.wrapping_sub(old_right));
        self.counts = counts;

        let turned = spread(counts).wrapping_sub(self.spread_origin);
        let heading = self.heading_origin.0 + turned as f32 * (metres_per_count / track.0);
        let s = (left + right) as f32 * (metres_per_count / 2.0);
        let delta = (right - left) as f32 * (metres_per_count / track.0);
        // sin(Δ/2)/(Δ/2) to fourth order; one tick turns by far less than 0.1 rad.
        let chord = s * (1.0 - delta * delta / 24.0);
        let (sin, cos) = sin_cos(heading - delta / 2.0);
        self.pose = Pose {
            x: Metres(self.pose.x.0 + chord * cos),
            y: Metres(self.pose.y.0 + chord * sin),
            heading: Radians(heading).wrapped(),
        };
    }
}

fn spread([left, right]: [i32; 2]) -> i32 {
    right.wrapping_sub(left)
}

#[cfg(test)]
mod tests {
    use super::*;
    use core::f32::consts::{FRAC_PI_2, PI};

    #[test]
    fn a_quarter_turn_on_the_spot_by_hand() {
        let parameters = Parameters::default();
        // Each rim runs b/2 · π/2: 0.06 · π/2 / (0.035 · 2π / 1440) counts = 617.14.
        let mut odometry = Odometry::new(Pose::default(), [0, 0]);
        for tick in 1..=617 {
            odometry.update([-tick, tick], &parameters);
        }
        assert!((odometry.pose().heading.0 - FRAC_PI_2).abs() < 1e-3);
        assert_eq!(odometry.pose().x, Metres(0.0));
    }

    #[test]
    fn a_full_circle_of_arcs_closes() {
        let parameters = Parameters::default();
        let mut odometry = Odometry::new(Pose::default(), [i32::MAX - 100, i32::MAX - 100]);
        let (mut left, mut right) = (i32::MAX - 100, i32::MAX - 100);
        // Left 1, right 3 counts a tick: a circle of radius b (1 + 3)/(3 - 1)/2 = 0.12 m, through the wrap.
        let per_tick = 2.0 * parameters.radians_per_count() * 0.035 / 0.12;
        let ticks = (2.0 * PI / per_tick).round() as i32;
        for tick in 0..ticks {
            (left, right) = (left.wrapping_add(1), right.wrapping_add(3));
            odometry.update([left, right], &parameters);
            if tick == ticks / 2 {
                assert!((odometry.pose().y.0 - 0.24).abs() < 1e-4);
            }
        }
        // Whole ticks miss the full circle by at most half a tick: 0.15 mm along the arc.
        assert!(libm::hypotf(odometry.pose().x.0, odometry.pose().y.0) < 2e-4);
    }
}
