//! Waypoints to legs: the last step of the plan and the only place where f64 metres become f32.
//!
//! A leg turns, drives and turns [Alghannam, Sec. IV]. Its direction, forward or in reverse, is chosen
//! so that the whole mission ends soonest within the robot's limits: going backwards may save two
//! half turns. At a waypoint without a wanted heading the last turn is empty, and the next leg's
//! first turn does the work of both.

use crate::geometry::{Point, Pose, wrap_angle};
use protocol::message::plan_digest;
use protocol::motion::{self, Direction, Leg, Limits, Position, Timing};
use protocol::units::{Metres, MetresPerSecond, MetresPerSecondSquared, Radians, Seconds};

/// What the default robot's wheels may do; used until a robot has said otherwise.
pub const DEFAULT_LIMITS: Limits = Limits {
    speed: MetresPerSecond(0.4),
    acceleration: MetresPerSecondSquared(0.8),
    track: Metres(0.12),
};

/// How waypoints become legs.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LegOptions {
    /// How the time of each leg is chosen.
    pub timing: Timing,
    /// Whether the robot may drive backwards.
    pub reverse: bool,
}

/// The timing in which each leg takes `leg_time`, in three equal intervals of whole ticks.
///
/// ```
/// use protocol::{motion::Timing, units::Seconds};
/// assert_eq!(wmr::legs::paper_timing(Seconds(9.0)), Timing::Paper { interval_ticks: 600 });
/// ```
pub fn paper_timing(leg_time: Seconds) -> Timing {
    let ticks = leg_time.0 / motion::TICK.0 / 3.0;
    Timing::Paper { interval_ticks: ticks.round().max(1.0) as u32 }
}

/// Turns `waypoints`, the first of which is where the robot stands, into legs that begin at
/// `heading` and end at `goal_heading`, radians; `None` arrives along the last drive.
///
/// Waypoints that repeat the one before are passed over. All legs carry the plan's name, which is
/// drawn from what they say: the same legs are the same plan.
///
/// ```
/// use wmr::{geometry::Point, legs::{DEFAULT_LIMITS, LegOptions, to_legs}};
/// use protocol::motion::{Direction, Timing};
/// let way = [Point::new(0.0, 0.0), Point::new(-1.0, 0.0)];
/// let options = LegOptions { timing: Timing::Limits, reverse: true };
/// let legs = to_legs(&way, 0.0, None, &options, &DEFAULT_LIMITS);
/// assert_eq!((legs.len(), legs[0].direction), (1, Direction::Reverse));
/// ```
pub fn to_legs(
    waypoints: &[Point],
    heading: f64,
    goal_heading: Option<f64>,
    options: &LegOptions,
    limits: &Limits,
) -> Vec<Leg> {
    let mut way = waypoints.to_vec();
    way.dedup();
    if let (&[only], Some(_)) = (way.as_slice(), goal_heading) {
        way.push(only);
    }
    let Some(&first) = way.first() else { return Vec::new() };
    let start = motion::Pose::new(first.x as f32, first.y as f32, wrap_angle(heading) as f32);
    // The quickest way to have arrived by each direction: its time and its legs.
    let mut ways = vec![Way { ticks: 0, pose: start, legs: Vec::new() }];
    let directions: &[Direction] = if options.reverse {
        &[Direction::Forward, Direction::Reverse]
    } else {
        &[Direction::Forward]
    };
    for (index, goal) in way.iter().enumerate().skip(1) {
        let wanted = goal_heading.filter(|_| index + 1 == way.len());
        ways = directions
            .iter()
            .filter_map(|direction| {
                let arrivals = ways.iter().map(|way| {
                    way.extended(
                        Leg {
                            plan: 0,
                            index: (index - 1) as u16,
                            start: way.pose,
                            goal: Position::new(goal.x as f32, goal.y as f32),
                            goal_heading: wanted
                                .map(|heading| Radians(wrap_angle(heading) as f32).wrapped()),
                            direction: *direction,
                            timing: options.timing,
                        },
                        limits,
                    )
                });
                arrivals.min_by_key(|way| way.ticks)
            })
            .collect();
    }
    let best = ways.into_iter().min_by_key(|way| way.ticks);
    best.map_or_else(Vec::new, |way| named(way.legs))
}

/// How long `legs` take as planned, seconds.
pub fn duration(legs: &[Leg], limits: &Limits) -> f64 {
    let ticks: u32 = legs.iter().map(|leg| leg.ticks(limits)).sum();
    f64::from(ticks) * f64::from(motion::TICK_MILLISECONDS) / 1000.0
}

/// Where `legs` lead, as planned.
pub fn planned_end(legs: &[Leg], limits: &Limits) -> Option<Pose> {
    legs.last().map(|leg| from_wire(leg.intervals(limits)[2].end()))
}

/// Where the robot is to be at every tenth tick of `legs`: seconds and poses, first and last included.
pub fn planned_poses(legs: &[Leg], limits: &Limits) -> Vec<(f64, Pose)> {
    const EVERY: usize = 10;
    let tick = f64::from(motion::TICK_MILLISECONDS) / 1000.0;
    let mut poses = Vec::new();
    let mut began = 0;
    for motion in legs.iter().flat_map(|leg| leg.intervals(limits)) {
        let ticks = motion.profile.ticks();
        let inner = (0..ticks).step_by(EVERY).chain([ticks]);
        poses.extend(inner.map(|at| {
            let pose = from_wire(motion.pose_at(at * motion::PHASES_PER_TICK));
            (f64::from(began + at) * tick, pose)
        }));
        began += ticks;
    }
    poses
}

/// A robot's pose in the host's numbers.
pub fn from_wire(pose: motion::Pose) -> Pose {
    Pose::new(pose.x.0.into(), pose.y.0.into(), pose.heading.0.into())
}

/// The host's pose in the robot's numbers.
pub fn to_wire(pose: Pose) -> motion::Pose {
    motion::Pose::new(pose.position.x as f32, pose.position.y as f32, pose.heading as f32)
}

/// An f32 as the shortest decimal that means it: 0.035, not 0.03500000014901161.
pub fn shortest(value: f32) -> f64 {
    value.to_string().parse().unwrap_or(f64::NAN)
}

struct Way {
    ticks: u32,
    pose: motion::Pose,
    legs: Vec<Leg>,
}

impl Way {
    fn extended(&self, leg: Leg, limits: &Limits) -> Self {
        let mut legs = self.legs.clone();
        legs.push(leg);
        let pose = leg.intervals(limits)[2].end();
        Self { ticks: self.ticks + leg.ticks(limits), pose, legs }
    }
}

/// `legs` under the name that their content gives them.
pub(crate) fn named(mut legs: Vec<Leg>) -> Vec<Leg> {
    let plan = plan_digest(&legs);
    legs.iter_mut().for_each(|leg| leg.plan = plan);
    legs
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;
    use std::f64::consts::PI;

    const LIMITED: LegOptions = LegOptions { timing: Timing::Limits, reverse: true };

    #[test]
    fn a_corner_by_hand() {
        let way = [Point::new(0.0, 0.0), Point::new(1.0, 0.0), Point::new(1.0, 1.0)];
        let legs = to_legs(&way, 0.0, Some(PI), &LIMITED, &DEFAULT_LIMITS);
        let end = planned_end(&legs, &DEFAULT_LIMITS).unwrap();
        assert_eq!(legs.len(), 2);
        assert_eq!((legs[0].goal_heading, legs[1].goal_heading), (None, Some(Radians(PI as f32))));
        assert!(end.position.distance(Point::new(1.0, 1.0)) < 1e-6);
        assert!((end.heading.abs() - PI).abs() < 1e-6);
    }

    #[test]
    fn paper_legs_take_nine_seconds_each() {
        let way = [Point::new(0.0, 0.0), Point::new(0.5, 0.0), Point::new(0.5, 0.5)];
        let options = LegOptions { timing: paper_timing(Seconds(9.0)), reverse: false };
        let legs = to_legs(&way, 0.0, None, &options, &DEFAULT_LIMITS);
        assert_eq!(duration(&legs, &DEFAULT_LIMITS), 18.0);
    }

    #[test]
    fn a_turn_on_the_spot_is_a_leg() {
        let way = [Point::new(0.3, 0.3), Point::new(0.3, 0.3)];
        assert_eq!(to_legs(&way, 0.0, Some(1.0), &LIMITED, &DEFAULT_LIMITS).len(), 1);
        assert!(to_legs(&way, 0.0, None, &LIMITED, &DEFAULT_LIMITS).is_empty());
    }

    proptest! {
        #[test]
        fn no_choice_of_directions_is_quicker(
            points in prop::collection::vec((-1.0f64..1.0, -1.0f64..1.0), 2..6), heading in -3.0f64..3.0,
        ) {
            let way: Vec<_> = points.iter().map(|(x, y)| Point::new(*x, *y)).collect();
            let legs = to_legs(&way, heading, None, &LIMITED, &DEFAULT_LIMITS);
            let best = duration(&legs, &DEFAULT_LIMITS);
            for choice in 0..1u32 << legs.len() {
                let mut pose = legs[0].start;
                let mut ticks = 0;
                for (index, leg) in legs.iter().enumerate() {
                    let direction = if choice >> index & 1 == 1 { Direction::Reverse } else { Direction::Forward };
                    let leg = Leg { start: pose, direction, ..*leg };
                    ticks += leg.ticks(&DEFAULT_LIMITS);
                    pose = leg.intervals(&DEFAULT_LIMITS)[2].end();
                }
                prop_assert!(best <= f64::from(ticks) * 0.005 + 1e-9);
            }
        }
    }
}
