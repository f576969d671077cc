//! Whether the robot moves on where its wheels say that it should.
//!
//! Wheels that spin on a smooth floor count as if they drove; only an outside pose shows that the
//! robot stands. Over each half second the distance commanded is compared with the distance that the
//! pose estimate, corrections included, has moved: less than a fifth is no progress. Every camera of 2 Hz
//! and more is thus enough, and a robot without one is never accused.

use crate::math::approximate_length;
use protocol::motion::{Pose, TICK, Twist};
use protocol::units::{Metres, Radians};

/// The window, ticks: 500 ms.
const WINDOW: u32 = 100;
/// Less than this share of the distance commanded is no progress. The distance moved is approximate,
/// so the share lies between 0.188 and 0.213.
const LEAST_SHARE: f32 = 0.2;
/// A shorter distance commanded says nothing, m at the rim.
const LEAST_DISTANCE: f32 = 0.02;

/// The window that runs.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Progress {
    ticks: u32,
    /// Sums over the window's ticks, m/s and rad/s.
    linear: f32,
    angular: f32,
    from: Pose,
}

impl Progress {
    /// A window that begins at `pose`.
    pub(crate) fn new(pose: Pose) -> Self {
        Self { ticks: 0, linear: 0.0, angular: 0.0, from: pose }
    }

    /// Takes in what this tick commands and where the robot is; false if a window has ended in
    /// which it got nowhere.
    pub(crate) fn update(&mut self, commanded: Twist, pose: Pose, track: Metres) -> bool {
        self.ticks += 1;
        self.linear += commanded.linear.0;
        self.angular += commanded.angular.0;
        if self.ticks < WINDOW {
            return true;
        }
        let rim = |distance: f32, turn: f32| distance.abs() + turn.abs() * track.0 / 2.0;
        let expected = rim(self.linear * TICK.0, self.angular * TICK.0);
        let distance = approximate_length(pose.x.0 - self.from.x.0, pose.y.0 - self.from.y.0);
        let turn = Radians(pose.heading.0 - self.from.heading.0).wrapped();
        *self = Self::new(pose);
        expected < LEAST_DISTANCE || rim(distance, turn.0) >= LEAST_SHARE * expected
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use protocol::units::{MetresPerSecond, RadiansPerSecond};

    /// Drives at 0.2 m/s for two seconds with `share` of it as progress.
    fn gets_on(linear: f32, angular: f32, share: f32) -> bool {
        let twist = Twist { linear: MetresPerSecond(linear), angular: RadiansPerSecond(angular) };
        let mut progress = Progress::new(Pose::default());
        (1..=400u16).all(|tick| {
            let seconds = f32::from(tick) * TICK.0 * share;
            let pose = Pose::new(linear * seconds, 0.0, angular * seconds);
            progress.update(twist, pose, Metres(0.12))
        })
    }

    #[test]
    fn a_fifth_of_the_distance_is_progress_and_less_is_not() {
        assert!(gets_on(0.2, 0.0, 0.25) && !gets_on(0.2, 0.0, 0.15));
        assert!(gets_on(0.0, 2.0, 0.25) && !gets_on(0.0, 2.0, 0.15));
    }

    #[test]
    fn a_robot_commanded_to_stand_may_stand() {
        assert!(gets_on(0.03, 0.0, 0.0));
    }
}
