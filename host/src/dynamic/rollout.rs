//! What becomes of legs that are being driven: where the robot is if it goes on, and where if it is held.
//!
//! A robot that is held slows its own time down, within its limits, and so comes to rest on its path
//! ([`Pace`], as the robot does it). Metres, seconds.

use super::plan::RISK_WEIGHT;
use super::{Band, Demand, Future, LegMotion};
use crate::geometry::{Point, Pose};
use crate::legs::from_wire;
use protocol::motion::{Leg, Limits};

/// The step of time, s.
const STEP: f64 = 0.02;
/// Below this planned speed of the rims the pace may change as it likes, m/s.
const CREEP: f64 = 0.005;
/// A robot whose rims are slower touches nothing, m/s.
const RESTS: f64 = 0.002;
/// A way that takes longer is not looked at to its end, s.
const LONGEST: f64 = 120.0;

/// The pace at which a leg's own time runs: 1 as planned, 0 held.
#[derive(Clone, Copy, Debug, PartialEq, PartialOrd)]
pub struct Pace(pub f64);

impl Pace {
    /// A step of time towards `target`, where the rims are planned to move at `speed` and to change that by
    /// `change` each second, and may do so by `limit`.
    fn towards(self, target: f64, (speed, change): (f64, f64), limit: f64) -> Self {
        if self.0 == target || speed < CREEP {
            return Self(target);
        }
        let step = (limit.copysign(target - self.0) - self.0 * self.0 * change) / speed * STEP;
        Self(if target > self.0 {
            (self.0 + step.max(0.0)).min(target)
        } else {
            (self.0 + step.min(0.0)).max(target)
        })
    }
}

/// How far along its legs a robot is.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Place {
    /// Which leg, of those looked at.
    pub leg: usize,
    /// How far into it, in its own time, s.
    pub time: f64,
}

/// Where the robot would come too near to something.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Contact {
    /// When, s from now.
    pub time: f64,
    /// Where the robot is then.
    pub at: Point,
    /// How far along its way, m.
    pub distance: f64,
    /// To which thing.
    pub future: usize,
}

/// Legs that are being driven.
#[derive(Clone, Debug)]
pub struct Rollout {
    legs: Vec<LegMotion>,
    first_heading: f64,
    acceleration: f64,
}

/// How it goes on.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Course {
    /// The first place where the robot comes too near to something while it moves.
    pub contact: Option<Contact>,
    /// When it rests, s from now: at its goal, or held for good.
    pub rests: f64,
    /// Where it rests.
    pub end: Point,
    /// The integral of the risk while it moves, s.
    pub risk: f64,
    /// The least distance to what is forbidden, m.
    pub gap: f64,
}

impl Course {
    /// When the robot rests, with what risks cost, s.
    pub fn cost(&self) -> f64 {
        self.rests + RISK_WEIGHT * self.risk
    }
}

impl Rollout {
    /// The legs from the one under way on.
    pub fn new(legs: &[Leg], limits: &Limits) -> Self {
        Self {
            legs: legs.iter().map(|leg| LegMotion::new(leg, limits)).collect(),
            first_heading: legs.first().map_or(0.0, |leg| from_wire(leg.start).heading),
            acceleration: limits.acceleration.0.into(),
        }
    }

    /// How far a robot at `pose` is.
    pub fn place(&self, pose: Pose) -> Place {
        let time = self.legs.first().map_or(0.0, |leg| leg.time_at(pose, self.first_heading));
        Place { leg: 0, time }
    }

    /// What happens from `place` on at that pace if the robot is held from one time to another.
    pub fn course(
        &self,
        (mut place, mut pace): (Place, Pace),
        held: [f64; 2],
        futures: &[Future],
        demand: Demand,
    ) -> Course {
        let here = self.position(place);
        let mut course =
            Course { contact: None, rests: 0.0, end: here, risk: 0.0, gap: f64::INFINITY };
        let (mut time, mut travelled) = (0.0, 0.0);
        while time < LONGEST {
            let target = if (held[0]..held[1]).contains(&time) { 0.0 } else { 1.0 };
            let Some(leg) = self.legs.get(place.leg) else { break };
            let (speed, _) = leg.speed(place.time);
            if target == 0.0 && pace.0 * speed < RESTS && held[1].is_infinite() {
                break;
            }
            let change = (leg.speed(place.time + STEP).0 - speed) / STEP;
            pace = pace.towards(target, (speed, change), self.acceleration);
            place.time += pace.0 * STEP;
            time += STEP;
            if place.time >= leg.times()[2] {
                place = Place { leg: place.leg + 1, time: place.time - leg.times()[2] };
            }
            let at = self.position(place);
            travelled += at.distance(course.end);
            course.end = at;
            if pace.0 > 0.0 && pace.0 * speed >= RESTS {
                let band = demand.at(futures, at, time);
                note(&mut course, band, (time, travelled));
            }
        }
        course.rests = time;
        course
    }

    fn position(&self, place: Place) -> Point {
        match self.legs.get(place.leg) {
            Some(leg) => leg.position(place.time),
            None => self.legs.last().map_or(Point::new(0.0, 0.0), |leg| leg.end.position),
        }
    }
}

fn note(course: &mut Course, band: Band, (time, distance): (f64, f64)) {
    course.risk += band.risk * STEP;
    course.gap = course.gap.min(band.gap);
    if band.gap < 0.0
        && course.contact.is_none()
        && let Some(future) = band.nearest
    {
        course.contact = Some(Contact { time, at: course.end, distance, future });
    }
}
