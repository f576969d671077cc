//! Whether a camera's pose may be right: how far it lies from the robot's own estimate.
//!
//! Since the last accepted pose, odometry can have gone wrong by no more than the wheels can turn: a
//! robot whose wheels spin stands still while odometry drives at V, or turns at 2V/b. The camera and the
//! pose that the plan began with have errors of their own, the allowances. Beyond
//!
//! ```text
//! |Δp| ≤ POSITION_ALLOWANCE + V t        |Δφ| ≤ HEADING_ALLOWANCE + (2V/b) t
//! ```
//! the camera has seen something else (another robot, a reflection, the top turned by half a turn),
//! and following it would drive the robot off its path. A robot whose pose nobody has given yet takes
//! any. The bounds grow with time, so a robot that was moved by hand is found again after a while. Until then
//! it would drive where nobody planned: while it drives, several refusals on end are a reason to stop.
//!
//! | symbol | meaning | unit |
//! |---|---|---|
//! | Δp, Δφ | camera's pose minus own estimate at the exposure | m, rad |
//! | t | from the exposure of the last accepted pose, or the begin of the plan, to this exposure | s |
//! | V, b | speed limit of the rims, track | m/s, m |

use protocol::motion::{Limits, Pose, TICK};
use protocol::units::Radians;

/// Error of a camera's position and of a start measured on a photo or by hand, together, m.
const POSITION_ALLOWANCE: f32 = 0.05;
/// The same for headings, rad: 11°.
const HEADING_ALLOWANCE: f32 = 0.2;

/// So many poses refused on end are no mistake of the camera's.
const CONTRADICTED: u8 = 3;

/// The time since the last known pose, and what was refused since.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct PoseGate {
    /// Ticks since the exposure of the last accepted pose; the largest number also stands for none.
    ticks: u16,
    refused: u8,
}

impl PoseGate {
    /// Nobody has said yet where the robot is.
    pub(crate) const UNKNOWN: Self = Self { ticks: u16::MAX, refused: 0 };

    /// The pose was known `age` ticks ago.
    pub(crate) fn known(age: u32) -> Self {
        Self { ticks: u16::try_from(age).unwrap_or(u16::MAX), refused: 0 }
    }

    /// `ticks` more have passed.
    pub(crate) fn pass(&mut self, ticks: u16) {
        self.ticks = self.ticks.saturating_add(ticks);
    }

    /// One more pose was refused; whether they contradict where the robot believes it is.
    pub(crate) fn refuse(&mut self) -> bool {
        self.refused = self.refused.saturating_add(1);
        self.refused >= CONTRADICTED
    }

    /// Whether the robot may have been at `seen`, `age` ticks ago, when its own estimate was `estimate`.
    pub(crate) fn admits(self, seen: Pose, estimate: Pose, age: u32, limits: &Limits) -> bool {
        if self.ticks == u16::MAX {
            return true;
        }
        let ticks = u32::from(self.ticks).saturating_sub(age);
        let rim = limits.speed.0 * TICK.0 * ticks as f32;
        let (dx, dy) = (seen.x.0 - estimate.x.0, seen.y.0 - estimate.y.0);
        let turn = Radians(seen.heading.0 - estimate.heading.0).wrapped().0;
        let reach = POSITION_ALLOWANCE + rim;
        dx * dx + dy * dy <= reach * reach
            && turn.abs() <= HEADING_ALLOWANCE + 2.0 * rim / limits.track.0
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use protocol::parameters::Parameters;

    /// Whether the default robot, whose pose was known 20 ticks before the exposure, takes a jump.
    fn admits(x: f32, heading: f32) -> bool {
        let limits = Parameters::default().limits();
        let estimate = Pose::new(1.0, 1.0, 3.1);
        let seen =
            Pose { heading: Radians(3.1 + heading).wrapped(), ..Pose::new(1.0 + x, 1.0, 0.0) };
        let mut gate = PoseGate::known(10);
        gate.pass(15);
        gate.admits(seen, estimate, 5, &limits)
    }

    #[test]
    fn the_bounds_by_hand() {
        // 0.1 s at 0.4 m/s is 40 mm; at 2 · 0.4 / 0.12 rad/s it is 0.667 rad.
        assert!(admits(0.089, 0.0) && !admits(0.091, 0.0));
        assert!(admits(-0.089, 0.0) && !admits(-0.091, 0.0));
        // Across half a turn: 3.1 + 0.86 wraps.
        assert!(admits(0.0, 0.86) && !admits(0.0, 0.88));
        assert!(admits(0.0, -0.86) && !admits(0.0, -0.88));
    }

    #[test]
    fn three_refusals_on_end_contradict_and_an_accepted_pose_ends_them() {
        let mut gate = PoseGate::known(0);
        assert_eq!([(); 4].map(|()| gate.refuse()), [false, false, true, true]);
        gate = PoseGate::known(0);
        assert!(!gate.refuse());
    }

    #[test]
    fn any_pose_is_the_first_and_an_older_exposure_gains_no_time() {
        let limits = Parameters::default().limits();
        let far = Pose::new(5.0, 5.0, 2.0);
        let mut gate = PoseGate::UNKNOWN;
        gate.pass(3);
        assert!(gate.admits(far, Pose::default(), 0, &limits));
        // Exposed 30 ticks before the last accepted one: the allowance alone.
        let gate = PoseGate::known(10);
        assert!(gate.admits(Pose::new(0.049, 0.0, 0.0), Pose::default(), 40, &limits));
        assert!(!gate.admits(Pose::new(0.051, 0.0, 0.0), Pose::default(), 40, &limits));
    }
}
