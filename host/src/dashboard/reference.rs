//! Where a drive wants the robot to be: the planned pose of this moment, beside which a page draws the real
//! one. Metres, radians and seconds of the robot's clock.
//!
//! The robot says which leg it drives and when; time within a leg passes as its clock does. A pause stretches
//! time in a way that the robot keeps to itself, so while it pauses and speeds up again the planned pose
//! nearest to the robot is taken.

use protocol::motion::{Leg, Limits};
use wmr::geometry::{Pose, wrap_angle};
use wmr::legs::{duration, planned_poses};

/// After a pause a robot has its speed again by then (V / A is 0.5 s by default), seconds.
const SPEEDS_UP: f64 = 1.0;
/// A radian off counts as so many metres when the nearest pose is looked for: about half a robot's track.
const METRES_PER_RADIAN: f64 = 0.06;

/// The plan's clock.
#[derive(Clone, Debug)]
pub(super) struct Reference {
    /// Seconds since the plan began, and where the robot is to be then.
    poses: Vec<(f64, Pose)>,
    /// When each leg begins, and when the last one ends.
    begins: Vec<f64>,
    leg: usize,
    time: f64,
    /// When the robot was last heard, and when it last paused, by its own clock.
    heard: Option<f64>,
    paused: Option<f64>,
}

/// What the robot says at one moment.
#[derive(Clone, Copy, Debug)]
pub(super) struct Word {
    pub(super) time: f64,
    pub(super) leg: usize,
    pub(super) pose: Pose,
    pub(super) is_paused: bool,
}

impl Reference {
    pub(super) fn new(legs: &[Leg], limits: &Limits) -> Self {
        let begins =
            (0..=legs.len()).map(|count| duration(legs.get(..count).unwrap_or(legs), limits));
        Self {
            poses: planned_poses(legs, limits),
            begins: begins.collect(),
            leg: 0,
            time: 0.0,
            heard: None,
            paused: None,
        }
    }

    /// The planned pose at the moment of `word`.
    pub(super) fn at(&mut self, word: Word) -> Option<Pose> {
        let passed = self.heard.map_or(0.0, |heard| word.time - heard);
        self.heard = Some(word.time);
        let begin = |leg: usize| self.begins.get(leg).copied().unwrap_or(self.time);
        let (from, to) = (begin(word.leg), begin(word.leg + 1));
        if word.leg != self.leg {
            self.time = from;
        } else {
            self.time += passed;
        }
        self.leg = word.leg;
        if word.is_paused {
            self.paused = Some(word.time);
        }
        if self.paused.is_some_and(|paused| word.time - paused < SPEEDS_UP) {
            self.time = self.nearest_time(word.pose, from, to);
        }
        self.time = self.time.clamp(from, to);
        let after = self.poses.partition_point(|(time, _)| *time < self.time);
        self.poses.get(after).or(self.poses.last()).map(|(_, pose)| *pose)
    }

    /// When between `from` and `to` the plan is nearest to `pose`.
    fn nearest_time(&self, pose: Pose, from: f64, to: f64) -> f64 {
        let away = |planned: &Pose| {
            let turned = wrap_angle(planned.heading - pose.heading).abs();
            planned.position.distance(pose.position) + METRES_PER_RADIAN * turned
        };
        let within = self.poses.iter().filter(|(time, _)| (from..=to).contains(time));
        let nearest = within.min_by(|(_, a), (_, b)| away(a).total_cmp(&away(b)));
        nearest.map_or(self.time, |(time, _)| *time)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use protocol::motion::Timing;
    use wmr::geometry::Point;
    use wmr::legs::{DEFAULT_LIMITS, LegOptions, to_legs};

    /// One metre ahead, then one to the left.
    fn reference() -> Reference {
        let way = [Point::new(0.0, 0.0), Point::new(1.0, 0.0), Point::new(1.0, 1.0)];
        let options = LegOptions { timing: Timing::Limits, reverse: false };
        let legs = to_legs(&way, 0.0, None, &options, &DEFAULT_LIMITS);
        Reference::new(&legs, &DEFAULT_LIMITS)
    }

    fn word(time: f64, leg: usize, pose: Pose, is_paused: bool) -> Word {
        Word { time, leg, pose, is_paused }
    }

    #[test]
    fn time_passes_with_the_robots_clock_and_each_leg_begins_in_its_place() {
        let mut reference = reference();
        let anywhere = Pose::new(0.3, 0.2, 0.0);
        let mut last = reference.at(word(10.0, 0, anywhere, false)).unwrap().position.x;
        assert_eq!(last, 0.0);
        for tenth in 1..=20 {
            let pose =
                reference.at(word(10.0 + 0.1 * f64::from(tenth), 0, anywhere, false)).unwrap();
            assert!(pose.position.x >= last && pose.position.y.abs() < 1e-6);
            last = pose.position.x;
        }
        assert!(last > 0.3, "{last}");
        // It never runs ahead of the leg that the robot drives.
        let end = reference.at(word(100.0, 0, anywhere, false)).unwrap();
        assert!(end.position.distance(Point::new(1.0, 0.0)) < 1e-5, "{end:?}");
        let turn = reference.at(word(100.1, 1, anywhere, false)).unwrap();
        assert!(turn.position.distance(Point::new(1.0, 0.0)) < 1e-5 && turn.heading.abs() < 1e-5);
    }

    #[test]
    fn a_pause_stops_it_where_the_robot_stops() {
        let mut reference = reference();
        let at = Pose::new(0.4, 0.003, 0.0);
        reference.at(word(0.0, 0, Pose::new(0.0, 0.0, 0.0), false));
        for second in 1..60 {
            let planned = reference.at(word(f64::from(second), 0, at, true)).unwrap();
            assert!((planned.position.x - 0.4).abs() < 0.02, "{planned:?}");
        }
        // It goes on from there.
        let moved = Pose::new(0.45, 0.0, 0.0);
        let planned = reference.at(word(59.5, 0, moved, false)).unwrap();
        assert!((planned.position.x - 0.45).abs() < 0.02, "{planned:?}");
        let later = reference.at(word(60.7, 0, moved, false)).unwrap();
        assert!(later.position.x > 0.6, "{later:?}");
    }
}
