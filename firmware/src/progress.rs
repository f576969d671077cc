//! Whether the robot gets on where its wheels say that it should.
//!
//! Wheels that spin on a smooth floor count as if they drove; only an outside pose shows that the
//! robot stands. Over each half second the way commanded is compared with the way that the pose
//! estimate, corrections included, has gone: less than a fifth is no progress. Every camera of 2 Hz
//! and more is thus enough, and a robot without one is never accused.

use protocol::motion::{Pose, Position, TICK, Twist};
use protocol::units::{Metres, Radians};

/// The window, ticks: 500 ms.
const WINDOW: u32 = 100;
/// Less than this share of the way commanded is none.
const LEAST_SHARE: f32 = 0.2;
/// A shorter way commanded says nothing, m at the rim.
const LEAST_WAY: f32 = 0.02;

/// The window that runs.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Progress {
    ticks: u32,
    /// Sums over the window's ticks, m/s and rad/s.
    linear: f32,
    angular: f32,
    from: Pose,
}

impl Progress {
    /// A window that begins at `pose`.
    pub fn new(pose: Pose) -> Self {
        Self { ticks: 0, linear: 0.0, angular: 0.0, from: pose }
    }

    /// Takes in what this tick commands and where the robot is; false if a window has ended in
    /// which it got nowhere.
    pub fn update(&mut self, commanded: Twist, pose: Pose, track: Metres) -> bool {
        self.ticks += 1;
        self.linear += commanded.linear.0;
        self.angular += commanded.angular.0;
        if self.ticks < WINDOW {
            return true;
        }
        let rim = |way: f32, turn: f32| way.abs() + turn.abs() * track.0 / 2.0;
        let expected = rim(self.linear * TICK.0, self.angular * TICK.0);
        let way = self.from.distance(Position { x: pose.x, y: pose.y });
        let turn = Radians(pose.heading.0 - self.from.heading.0).wrapped();
        *self = Self::new(pose);
        expected < LEAST_WAY || rim(way.0, turn.0) >= LEAST_SHARE * expected
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
    fn a_fifth_of_the_way_is_progress_and_less_is_none() {
        assert!(gets_on(0.2, 0.0, 0.25) && !gets_on(0.2, 0.0, 0.15));
        assert!(gets_on(0.0, 2.0, 0.25) && !gets_on(0.0, 2.0, 0.15));
    }

    #[test]
    fn who_is_to_stand_may_stand() {
        assert!(gets_on(0.03, 0.0, 0.0));
    }
}
