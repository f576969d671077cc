//! The judgement after each frame: drive on, hold, go on, or take another way.

use super::{Course, Hold, JUDGE_INTERVAL, WatchError, WatchedDrive};
use crate::geometry::{Point, Pose, square_to_leg};
use crate::legs::from_wire;
use crate::link::LinkClient;
use crate::link::drive::TimedPort;
use crate::plan::PlanError;
use crate::track::pose::{Growth, Verdict};
use crate::watch::event::{Reason, WatchEvent};
use crate::watch::floor::Hazard;
use crate::watch::route::{Route, end_of, goals, length};
use crate::watch::way::{Contact, Demand, first_contact};
use protocol::message::State;
use protocol::motion::{Leg, WheelSpeeds};
use std::f64::consts::SQRT_2;
use std::time::Duration;

/// This much uncertainty of the pose is what margins are for, m.
const USUAL_GROWTH: f64 = 0.012;
/// A way is free while it keeps its margin less this, m: edges flicker.
const FLICKER: f64 = 0.006;
/// Other legs need so long to get to the robot, control ticks: 0.4 s.
const REPLACE_TICKS: u32 = 80;
/// Further beside its path the robot plans again, m.
const OFF_PATH: f64 = 0.05;
/// Things that move are looked ahead for so long while driving and, so that it pays to go on, while held, s.
const HORIZON: f64 = 1.2;
const HELD_HORIZON: f64 = 2.5;
/// Something that moves is waited for so long before another way is taken.
const WAIT: Duration = Duration::from_secs(3);
/// Another way must be shorter by this, m, to be taken while driving; and to be worth a stop.
const SHORTER: f64 = 0.03;
const WORTH_A_STOP: f64 = 0.4;
/// Slow legs are given up at once if the one under way takes so much longer, control ticks: 3 s.
const LONG_TICKS: u32 = 600;

/// What is known at the moment of a judgement.
struct Moment {
    now: Duration,
    pose: Pose,
    growth: Growth,
    hazards: Vec<Hazard>,
    /// The legs from the one under way on.
    legs: Vec<Leg>,
    contact: Option<Contact>,
}

impl Moment {
    fn extra(&self) -> f64 {
        extra(&self.growth)
    }

    fn is_slow(&self) -> bool {
        self.growth.verdict >= Verdict::Slow
    }

    fn blocked(&self, contact: &Contact) -> Option<Reason> {
        let hazard = self.hazards.get(contact.hazard)?;
        let shape = hazard.obstacle.footprint.clone();
        Some(Reason::Blocked { shape, moves: hazard.moves(), ahead: contact.distance })
    }
}

fn extra(growth: &Growth) -> f64 {
    (growth.margin - USUAL_GROWTH).max(0.0)
}

impl WatchedDrive {
    /// Judges the way, after each frame and from time to time without one.
    pub(super) fn judge<P: TimedPort>(&mut self, client: &mut LinkClient<P>, now: Duration) {
        let due = self.judged.is_zero() || now >= self.judged + JUDGE_INTERVAL;
        let drives = self.ended.is_none() && self.mission.has_begun() && self.is_placed;
        let decides = self.ending.is_none() && !self.is_paused;
        if !due || !drives || !decides || self.mission.is_replacing() {
            return;
        }
        self.judged = now;
        let Some(moment) = self.moment(now) else { return };
        match self.hold.clone() {
            None => self.judge_driving(client, &moment),
            Some(hold) => self.judge_held(client, &moment, &hold),
        }
    }

    fn moment(&self, now: Duration) -> Option<Moment> {
        let pose = self.filter.estimate(now)?.pose;
        let growth = self.filter.growth(now);
        let hazards = self.floor.hazards();
        let next = usize::from(self.mission.progress().next);
        let legs = self.mission.legs().get(next..)?.to_vec();
        let contact = self.contact(pose.position, &goals(&legs), &hazards, &growth);
        Some(Moment { now, pose, growth, hazards, legs, contact })
    }

    fn contact(
        &self,
        from: Point,
        goals: &[Point],
        hazards: &[Hazard],
        growth: &Growth,
    ) -> Option<Contact> {
        let radius = self.options.router.scene.robot_radius;
        let keep = radius + (self.course.margin - FLICKER).max(0.0) + extra(growth);
        let horizon = if self.hold.is_some() { HELD_HORIZON } else { HORIZON };
        let speed = f64::from(self.limits.speed.0);
        first_contact(from, goals, hazards, Demand { keep, speed, horizon })
    }

    fn judge_driving<P: TimedPort>(&mut self, client: &LinkClient<P>, moment: &Moment) {
        if moment.growth.verdict == Verdict::Stop
            && let Some(caution) = moment.growth.because
        {
            return self.hold(moment, Reason::Unsure(caution), false);
        }
        let beside = off_path(moment.pose.position, moment.legs.first());
        if beside > OFF_PATH {
            return self.hold(moment, Reason::OffPath(beside), true);
        }
        let left = self.ticks_left(client, moment);
        if let Some(contact) = moment.contact {
            let Some(reason) = moment.blocked(&contact) else { return };
            let moves = moment.hazards.get(contact.hazard).is_some_and(Hazard::moves);
            let is_later = contact.leg > 0 && !moves && left > REPLACE_TICKS;
            if !(is_later && self.take_other_legs(moment, None)) {
                self.hold(moment, reason, false);
            }
            return;
        }
        match (moment.is_slow(), self.course.slow) {
            (true, false) => {
                if let Some(caution) = moment.growth.because {
                    self.hold(moment, Reason::Unsure(caution), true);
                }
            }
            (false, true) if left > LONG_TICKS => self.hold(moment, Reason::SeesAgain, true),
            (false, true) if moment.legs.len() > 1 && left > REPLACE_TICKS => {
                self.take_other_legs(moment, None);
            }
            _ => self.look_for_shorter(moment, left),
        }
    }

    /// A route from `from` round what is seen now, and what moves round where it will be.
    pub(super) fn route(&self, from: Pose, manner: (f64, bool)) -> Result<Route, PlanError> {
        let router = &self.options.router;
        let widest = router.margins.iter().copied().fold(0.0, f64::max) + manner.0;
        // Squares reach further at their corners.
        let keep = SQRT_2 * (router.scene.robot_radius + widest);
        router.route(&self.floor.to_avoid(from.position, keep), from, manner, &self.limits)
    }

    /// When something has changed on the floor, a shorter way may have opened.
    fn look_for_shorter(&mut self, moment: &Moment, left: u32) {
        if !self.floor.differs_from(&self.course.obstacles) {
            return;
        }
        let manner = (moment.extra(), moment.is_slow());
        let from_here = self.route(moment.pose, manner);
        let rest = length(moment.pose.position, &goals(&moment.legs));
        if from_here.is_ok_and(|route| route.length + WORTH_A_STOP < rest) {
            return self.hold(moment, Reason::SeesAgain, true);
        }
        if left > REPLACE_TICKS && moment.legs.len() > 1 {
            let Some(first) = moment.legs.first() else { return };
            let end = end_of(first, &self.limits);
            let rest = length(end.position, &goals(&moment.legs[1..]));
            if self.take_other_legs(moment, Some(rest - SHORTER)) {
                return;
            }
        }
        self.course.obstacles = self.floor.obstacles();
    }

    /// Sends other legs that begin where the one under way ends, if they are shorter than `most`; false if there
    /// are none.
    fn take_other_legs(&mut self, moment: &Moment, most: Option<f64>) -> bool {
        let Some(first) = moment.legs.first() else { return false };
        let end = end_of(first, &self.limits);
        let (extra, slow) = (moment.extra(), moment.is_slow());
        let Ok(route) = self.route(end, (extra, slow)) else { return false };
        let free = self.contact(end.position, &goals(&route.legs), &moment.hazards, &moment.growth);
        let is_short = most.is_none_or(|most| route.length < most);
        if free.is_some() || !is_short || !self.mission.replace(&route.legs) {
            return false;
        }
        let (legs, length) = (route.legs.len(), route.length);
        let obstacles = self.floor.obstacles();
        self.next_course = Some(Course { obstacles, margin: route.margin, slow });
        self.events.push(WatchEvent::Rerouted { legs, length, at_rest: false, slow });
        true
    }

    /// How many ticks the leg under way still takes, as planned.
    fn ticks_left<P: TimedPort>(&self, client: &LinkClient<P>, moment: &Moment) -> u32 {
        let (Some(leg), Some(last)) = (moment.legs.first(), client.telemetry()) else { return 0 };
        let passed = last.ticks.wrapping_sub(self.leg_began);
        leg.ticks(&self.limits).saturating_sub(passed)
    }

    fn hold(&mut self, moment: &Moment, reason: Reason, replans: bool) {
        self.statistics.waits += 1;
        self.events.push(WatchEvent::Held(reason.clone()));
        self.hold = Some(Hold { since: moment.now, reason, replans });
    }

    fn judge_held<P: TimedPort>(
        &mut self,
        client: &mut LinkClient<P>,
        moment: &Moment,
        hold: &Hold,
    ) {
        let waited = moment.now.saturating_sub(hold.since);
        if waited > self.options.patience {
            self.ending = Some(WatchError::GaveUp { reason: hold.reason.clone(), waited });
            return;
        }
        if moment.growth.verdict == Verdict::Stop {
            let because = moment.growth.because;
            return because.map_or((), |caution| self.wait_for(hold, Reason::Unsure(caution)));
        }
        let beside = off_path(moment.pose.position, moment.legs.first());
        let fits = !hold.replans && moment.is_slow() == self.course.slow && beside < OFF_PATH;
        if fits && moment.contact.is_none() {
            self.hold = None;
            self.events.push(WatchEvent::Resumed { after: waited });
            return;
        }
        if rests(client) {
            self.plan_from_rest(client, moment, (hold, waited));
        }
    }

    /// The robot rests and cannot go on: another way from here, or a reason to wait.
    fn plan_from_rest<P: TimedPort>(
        &mut self,
        client: &mut LinkClient<P>,
        moment: &Moment,
        (hold, waited): (&Hold, Duration),
    ) {
        let moving =
            |contact: &Contact| moment.hazards.get(contact.hazard).is_some_and(Hazard::moves);
        if moment.contact.is_some_and(|contact| moving(&contact)) && waited < WAIT {
            return;
        }
        let (extra, slow) = (moment.extra(), moment.is_slow());
        match self.route(moment.pose, (extra, slow)) {
            Err(error) => self.wait_for(hold, Reason::NoWay(error)),
            Ok(route) => {
                let from = moment.pose.position;
                let contact =
                    self.contact(from, &goals(&route.legs), &moment.hazards, &moment.growth);
                // What moves will pass; what stands was planned around.
                match contact.filter(moving) {
                    Some(contact) => {
                        if let Some(reason) = moment.blocked(&contact) {
                            self.wait_for(hold, reason);
                        }
                    }
                    None => self.restart(client, moment.pose, (route, slow)),
                }
            }
        }
    }

    /// Waits on, and says why if that is new.
    fn wait_for(&mut self, hold: &Hold, reason: Reason) {
        if !reason.is_like(&hold.reason) {
            self.events.push(WatchEvent::Held(reason.clone()));
        }
        self.hold = Some(Hold { reason, ..hold.clone() });
    }
}

/// How far a point is beside a leg, m.
fn off_path(at: Point, leg: Option<&Leg>) -> f64 {
    leg.map_or(0.0, |leg| {
        let start = from_wire(leg.start).position;
        let goal = Point::new(leg.goal.x.0.into(), leg.goal.y.0.into());
        square_to_leg(at, start, goal).sqrt()
    })
}

/// Whether the robot is held and stands.
fn rests<P: TimedPort>(client: &LinkClient<P>) -> bool {
    client.telemetry().is_some_and(|last| {
        matches!(last.state, State::Paused(_)) && last.wheels == WheelSpeeds::default()
    })
}
