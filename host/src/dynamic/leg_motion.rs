//! One leg over time: how long its turns and its drive take, and where the robot is meanwhile.
//!
//! The robot is a disc, so a turn on the spot only takes time. Metres, seconds from the leg's beginning.

use crate::geometry::{Point, Pose};
use crate::legs::from_wire;
use protocol::motion::{self, Leg, Limits, PHASES_PER_TICK, Profile};

/// Seconds of one phase.
const PHASE: f64 = motion::TICK_MILLISECONDS as f64 / 1000.0 / PHASES_PER_TICK as f64;

/// A leg over time.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LegMotion {
    from: Point,
    to: Point,
    /// Where it ends.
    pub end: Pose,
    profiles: [Profile; 3],
    turns: [f64; 3],
    rim: f64,
}

impl LegMotion {
    /// The leg from where the plan has it begin.
    pub fn new(leg: &Leg, limits: &Limits) -> Self {
        let intervals = leg.intervals(limits);
        let end = from_wire(intervals[2].end());
        Self {
            from: from_wire(leg.start).position,
            to: end.position,
            end,
            profiles: intervals.map(|interval| interval.profile),
            turns: intervals.map(|interval| f64::from(interval.change)),
            rim: f64::from(limits.track.0) / 2.0,
        }
    }

    /// When its drive begins, when that ends, and when the whole leg ends, s.
    pub fn times(&self) -> [f64; 3] {
        let mut sum = 0.0;
        self.profiles.map(|profile| {
            sum += f64::from(profile.phases()) * PHASE;
            sum
        })
    }

    /// Where the robot is after `time`.
    pub fn position(&self, time: f64) -> Point {
        let [turned, driven, _] = self.times();
        if time <= turned {
            return self.from;
        }
        if time >= driven {
            return self.to;
        }
        let share = f64::from(self.profiles[1].fraction(phase(time - turned)));
        self.along(share)
    }

    /// The speed of the faster rim then, m/s, and whether that moves the robot from its place.
    pub fn speed(&self, time: f64) -> (f64, bool) {
        let [turned, driven, ended] = self.times();
        let (interval, since) = match time {
            _ if time < turned => (0, time),
            _ if time < driven => (1, time - turned),
            _ if time < ended => (2, time - driven),
            _ => return (0.0, false),
        };
        let rim = if interval == 1 { 1.0 } else { self.rim };
        let rate = f64::from(self.profiles[interval].rate(phase(since)));
        (rim * self.turns[interval].abs() * rate, interval == 1)
    }

    /// How far into the leg a robot at `pose` is, s.
    pub fn time_at(&self, pose: Pose, start_heading: f64) -> f64 {
        let [turned, driven, ended] = self.times();
        let (dx, dy) = (self.to.x - self.from.x, self.to.y - self.from.y);
        let length = dx.hypot(dy);
        let done = if length > 0.0 {
            let (x, y) = (pose.position.x - self.from.x, pose.position.y - self.from.y);
            (x * dx + y * dy) / (length * length)
        } else {
            1.0
        };
        if done * length > AT_END && (1.0 - done) * length > AT_END {
            return turned + self.inverse(1, done);
        }
        let (interval, begins, from) = if done * length <= AT_END && self.turns[1] != 0.0 {
            (0, 0.0, start_heading)
        } else {
            (2, driven, start_heading + self.turns[0])
        };
        let change = self.turns[interval];
        if change.abs() < TURNED {
            return if interval == 0 { turned + self.inverse(1, done.max(0.0)) } else { ended };
        }
        let turn = crate::geometry::wrap_angle(pose.heading - from);
        begins + self.inverse(interval, turn / change)
    }

    /// When an interval has done this share of its change, s from its beginning.
    fn inverse(&self, interval: usize, share: f64) -> f64 {
        let profile = self.profiles[interval];
        let (mut low, mut high) = (0, profile.phases());
        while high - low > PHASES_PER_TICK {
            let middle = (low + high) / 2;
            if f64::from(profile.fraction(middle)) < share { low = middle } else { high = middle }
        }
        f64::from(if share >= 1.0 { profile.phases() } else { low }) * PHASE
    }

    fn along(&self, share: f64) -> Point {
        let between = |a: f64, b: f64| a + share * (b - a);
        Point::new(between(self.from.x, self.to.x), between(self.from.y, self.to.y))
    }
}

/// Nearer to an end of the drive than this a robot turns, m.
const AT_END: f64 = 0.003;
/// A turn by less is none, rad.
const TURNED: f64 = 0.01;

fn phase(time: f64) -> u32 {
    (time / PHASE) as u32
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::legs::{DEFAULT_LIMITS, LegOptions, planned_poses, to_legs};
    use proptest::prelude::*;
    use protocol::motion::Timing;
    use std::f64::consts::FRAC_PI_2;

    const OPTIONS: LegOptions = LegOptions { timing: Timing::Limits, reverse: false };

    fn leg(to: Point, heading: f64, goal_heading: f64) -> Leg {
        to_legs(&[Point::new(0.0, 0.0), to], heading, Some(goal_heading), &OPTIONS, &DEFAULT_LIMITS)
            [0]
    }

    #[test]
    fn a_quarter_turn_and_a_metre_by_hand() {
        let motion = LegMotion::new(&leg(Point::new(0.0, 1.0), 0.0, FRAC_PI_2), &DEFAULT_LIMITS);
        // 173 ticks for the turn and 658 for the drive, as the profile's own tests have them.
        let [turned, driven, ended] = motion.times();
        assert!(
            (turned - 0.865).abs() < 1e-9 && (driven - 4.155).abs() < 1e-9 && ended - driven < 0.06
        );
        assert!(motion.position(0.8) == Point::new(0.0, 0.0));
        assert!(
            (motion.position(0.865 + 1.645).y - 0.5).abs() < 1e-3,
            "half of it in half the time"
        );
        let (speed, moves) = motion.speed(2.5);
        assert!((speed - 0.4).abs() < 1e-3 && moves && !motion.speed(0.4).1);
    }

    proptest! {
        #[test]
        fn a_pose_on_the_leg_tells_its_time(
            x in 0.2f64..1.0, y in -1.0f64..1.0, heading in -3.0f64..3.0, to in -3.0f64..3.0, at in 0.0f64..1.0,
        ) {
            let leg = leg(Point::new(x, y), heading, to);
            let motion = LegMotion::new(&leg, &DEFAULT_LIMITS);
            let poses = planned_poses(&[leg], &DEFAULT_LIMITS);
            let (time, pose) = poses[(at * (poses.len() - 1) as f64) as usize];
            prop_assert!(motion.position(time).distance(pose.position) < 1e-4);
            // Around its ends the cosine hardly moves: there a millimetre is a tenth of a second.
            prop_assert!((motion.time_at(pose, heading) - time).abs() < 0.25);
        }
    }
}
