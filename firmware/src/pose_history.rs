//! Where odometry saw the robot during the last second, one pose a tick.
//!
//! A camera's pose is some ticks old when it arrives. What odometry saw since then is still true,
//! so the correction is P ← P_cam ∘ (P_odo(t)⁻¹ ∘ P_odo(now)); P_odo(t) is remembered here.

use protocol::motion::{Pose, TICKS_PER_SECOND};

/// One second.
const LENGTH: usize = TICKS_PER_SECOND as usize;

/// A ring of poses.
#[derive(Clone, Debug)]
pub(crate) struct PoseHistory {
    poses: [Pose; LENGTH],
    next: usize,
    filled: usize,
}

impl Default for PoseHistory {
    fn default() -> Self {
        Self { poses: [Pose::default(); LENGTH], next: 0, filled: 0 }
    }
}

impl PoseHistory {
    /// Remembers the pose of this tick.
    pub(crate) fn push(&mut self, pose: Pose) {
        if let Some(place) = self.poses.get_mut(self.next) {
            *place = pose;
        }
        self.next = (self.next + 1) % LENGTH;
        self.filled = (self.filled + 1).min(LENGTH);
    }

    /// The pose `age` ticks before the last; `None` if that is forgotten.
    pub(crate) fn at(&self, age: u32) -> Option<Pose> {
        let age = usize::try_from(age).ok().filter(|age| *age < self.filled)?;
        self.poses.get((self.next + LENGTH - 1 - age) % LENGTH).copied()
    }

    /// Forgets all: the robot was put down elsewhere.
    pub(crate) fn clear(&mut self) {
        self.filled = 0;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_last_second_is_remembered_and_no_more() {
        let mut history = PoseHistory::default();
        assert_eq!(history.at(0), None);
        (0..450u16).for_each(|tick| history.push(Pose::new(tick.into(), 0.0, 0.0)));
        assert_eq!(history.at(0), Some(Pose::new(449.0, 0.0, 0.0)));
        assert_eq!(history.at(199), Some(Pose::new(250.0, 0.0, 0.0)));
        assert_eq!(history.at(200), None);
        assert_eq!(history.at(u32::MAX), None);
        history.clear();
        assert_eq!(history.at(0), None);
    }
}
