//! The judgement after each frame: drive on, hold, go on, or take another way. What moves is judged in
//! [`moving`](super::moving).

use super::moving::Outlook;
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
use crate::watch::way::{Contact, first_contact};
use protocol::message::State;
use protocol::motion::{Leg, WheelSpeeds};
use std::time::Duration;

/// This much uncertainty of the pose is what margins are for, m.
const USUAL_GROWTH: f64 = 0.012;
/// A way is free while it keeps its margin less this, m: edges flicker.
const FLICKER: f64 = 0.006;
/// Other legs need so long to get to the robot, control ticks: 0.4 s.
const REPLACE_TICKS: u32 = 80;
/// Further beside its path the robot plans again, m.
const OFF_PATH: f64 = 0.05;
/// Before it has driven so far, the robot knows whether a thing that has just appeared moves, m.
const FOUND_OUT: f64 = 0.35;
/// Another way must be shorter by this, m, to be taken while driving; and to be worth a stop.
const SHORTER: f64 = 0.03;
const WORTH_A_STOP: f64 = 0.4;
/// Slow legs are given up at once if the one under way takes so much longer, control ticks: 3 s.
const LONG_TICKS: u32 = 600;

/// What is known at the moment of a judgement.
pub(super) struct Moment {
    pub(super) now: Duration,
    pub(super) pose: Pose,
    growth: Growth,
    hazards: Vec<Hazard>,
    /// The legs from the one under way on.
    pub(super) legs: Vec<Leg>,
    /// With what stands.
    contact: Option<Contact>,
    /// What moves.
    pub(super) outlook: Outlook,
}

impl Moment {
    pub(super) fn extra(&self) -> f64 {
        extra(&self.growth)
    }

    pub(super) fn is_slow(&self) -> bool {
        self.growth.verdict >= Verdict::Slow
    }

    /// Whether a contact is one with something that surely stands, or is too near to find out.
    fn matters(&self, contact: &Contact) -> bool {
        let is_known = self.hazards.get(contact.hazard).is_some_and(|hazard| hazard.is_known);
        is_known || contact.distance < FOUND_OUT
    }

    /// That a hazard is in the way, so far ahead, m.
    pub(super) fn blocked(&self, hazard: usize, ahead: f64) -> Option<Reason> {
        let hazard = self.hazards.get(hazard)?;
        let shape = hazard.obstacle.footprint.clone();
        Some(Reason::Blocked { shape, moves: hazard.moves(), ahead })
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
        let outlook = self.outlook(now, pose, &legs);
        Some(Moment { now, pose, growth, hazards, legs, contact, outlook })
    }

    fn contact(
        &self,
        from: Point,
        goals: &[Point],
        hazards: &[Hazard],
        growth: &Growth,
    ) -> Option<Contact> {
        first_contact(from, goals, hazards, self.keep(extra(growth)))
    }

    /// How far from everything the legs that are driven are to keep the robot's centre, m.
    pub(super) fn keep(&self, extra: f64) -> f64 {
        self.options.router.scene.robot_radius + (self.course.margin - FLICKER).max(0.0) + extra
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
        if let Some(contact) = moment.contact.filter(|contact| moment.matters(contact)) {
            let Some(reason) = moment.blocked(contact.hazard, contact.distance) else { return };
            let is_later = contact.leg > 0 && left > REPLACE_TICKS;
            if !(is_later && self.take_other_legs(moment, None)) {
                self.hold(moment, reason, false);
            }
            return;
        }
        if self.judge_moving(moment, left > REPLACE_TICKS) {
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

    /// A route from `from` round what stands now.
    pub(super) fn route(&self, from: Pose, manner: (f64, bool)) -> Result<Route, PlanError> {
        self.options.router.route(&self.floor.standing(), from, manner, &self.limits)
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
        self.course.obstacles = self.floor.standing();
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
        free.is_none() && is_short && self.replace(&route, slow)
    }

    /// Sends other legs that begin where the one under way ends; false if that is not possible now.
    pub(super) fn replace(&mut self, route: &Route, slow: bool) -> bool {
        if !self.mission.replace(&route.legs) {
            return false;
        }
        let (legs, length) = (route.legs.len(), route.length);
        let obstacles = self.floor.standing();
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

    pub(super) fn hold(&mut self, moment: &Moment, reason: Reason, replans: bool) {
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
        let is_free = moment.contact.is_none();
        if fits && is_free && self.may_go(moment) {
            self.hold = None;
            self.events.push(WatchEvent::Resumed { after: waited });
            return;
        }
        if rests(client) {
            let was_blocked = matches!(hold.reason, Reason::Blocked { .. });
            let still_fits = was_blocked && is_free && beside < OFF_PATH;
            let fits = fits && is_free || still_fits;
            self.plan_from_rest(client, moment, (hold, fits.then_some(waited)));
        }
    }

    /// The robot rests and cannot go on as it is: another way from here, or a reason to wait. Its legs may still
    /// fit what stands, and for so long it has waited for what moves.
    fn plan_from_rest<P: TimedPort>(
        &mut self,
        client: &mut LinkClient<P>,
        moment: &Moment,
        (hold, fitting): (&Hold, Option<Duration>),
    ) {
        let slow = moment.is_slow();
        match self.route(moment.pose, (moment.extra(), slow)) {
            Err(error) => self.wait_for(hold, Reason::NoWay(error)),
            Ok(route) => {
                match self.begin(moment, route, fitting.map(|waited| waited.as_secs_f64())) {
                    Ok(route) => self.restart(client, moment.pose, (route, slow)),
                    // The legs that it has are as good.
                    Err(reason) => {
                        let hold =
                            Hold { replans: hold.replans && fitting.is_none(), ..hold.clone() };
                        self.wait_for(&hold, reason.unwrap_or(hold.reason.clone()));
                    }
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
