//! What moves, and what it means for the drive: go on, hold in time, or take another way.
//!
//! Two questions are asked after each frame. *May it go on until the next one?* The robot must still be able to
//! brake before it comes too near to the whole of any predicted set, or to what stops where it is now: as late as
//! that, and no later, it is held. *Does the way lead on?* Where the drive as it is would meet something further
//! ahead, waiting for it is held against other legs: behind the one under way, or from where the robot would rest.
//! Predictions of what is far ahead change, so only what is clearly quicker is done. Seconds from now, metres.

use super::WatchedDrive;
use super::judge::Moment;
use crate::dynamic::{
    Contact, Course, Demand, DynamicArena, DynamicPlan, Future, Pace, Place, Quest, Rollout,
};
use crate::geometry::Pose;
use crate::scene::Scene;
use crate::watch::event::Reason;
use crate::watch::route::{Route, end_of, goals};
use protocol::motion::Leg;
use std::time::Duration;

/// From a judgement to the change of a wheel's speed, and to the next judgement with its change, s.
const REACTION: f64 = 0.04;
const NEXT: f64 = 0.15;
/// From rest on one way to the first turn of another, s.
const RESTART: f64 = 0.15;
/// Sets are wholly forbidden so far ahead, s.
const SURE: f64 = 0.7;
/// Meetings further ahead than this are left to later predictions while driving, and while held, s.
const DECIDED: f64 = 2.5;
const LEFT_OPEN: f64 = 2.0;
/// Another way must be quicker than waiting by this, s, to brake for it; and at rest.
const QUICKER: f64 = 0.8;
const QUICKER_AT_REST: f64 = 0.2;
/// Holds that are tried, s: each longer than the one before by so much.
const HOLDS: i32 = 10;
const FIRST_HOLD: f64 = 0.4;
const LONGER: f64 = 1.4;
/// A robot at rest begins with so much more room around it, m, for so long, s: what is near may turn on it sooner
/// than a camera sees.
const ROOM: f64 = 0.03;
const FIRST_MOMENTS: f64 = 0.5;
/// A plan that begins after no longer a wait begins at once, s.
const AT_ONCE: f64 = 0.1;

/// What moves, and the legs that are driven among it.
#[derive(Clone, Debug)]
pub(super) struct Outlook {
    /// The hazards' indices: of what moves, then of newcomers.
    hazards: Vec<usize>,
    /// Where each thing that moves may be.
    futures: Vec<Future>,
    /// The same of what was not seen often enough to tell whether it moves.
    newcomers: Vec<Future>,
    rollout: Rollout,
    place: Place,
}

impl WatchedDrive {
    /// What moves at this moment.
    pub(super) fn outlook(&self, now: Duration, pose: Pose, legs: &[Leg]) -> Outlook {
        let (mut hazards, futures) = self.floor.futures(now);
        let (others, newcomers) = self.floor.newcomers(now);
        hazards.extend(others);
        let rollout = Rollout::new(legs, &self.limits);
        let place = rollout.place(pose);
        Outlook { hazards, futures, newcomers, rollout, place }
    }

    /// What is asked of legs that keep `margin`, and `extra`, m.
    fn demand(&self, extra: f64, margin: f64) -> Demand {
        let radius = self.options.router.scene.robot_radius;
        Demand { keep: radius + margin.max(0.0) + extra, sure: SURE }
    }

    /// What is asked of the legs that are driven.
    fn kept(&self, moment: &Moment) -> Demand {
        Demand { keep: self.keep(moment.extra()), sure: SURE }
    }

    /// Judges what moves while the robot drives; true if something was done. Other legs may take the place of
    /// those behind the one under way if there is `time` for that.
    pub(super) fn judge_moving(&mut self, moment: &Moment, time: bool) -> bool {
        let hazards = &moment.outlook.hazards;
        if let Some(contact) = self.must_brake(moment) {
            if let Some(reason) = blocked(moment, hazards, contact) {
                self.hold(moment, reason, false);
            }
            return true;
        }
        let demand = self.kept(moment);
        let on = moment.outlook.course(1.0, [f64::INFINITY; 2], demand);
        let Some(contact) = on.contact.filter(|contact| contact.time < DECIDED) else {
            return false;
        };
        let waiting = moment.outlook.quickest_hold(1.0, demand);
        if time
            && let Some(route) = self.behind_the_leg(moment, demand, waiting)
            && self.replace(&route, false)
        {
            return true;
        }
        let braked = moment.outlook.course(1.0, [REACTION, f64::INFINITY], demand);
        let from = Pose { position: braked.end, ..moment.pose };
        let start = braked.rests + RESTART;
        if self.dynamic_plan(moment, (from, start), waiting - QUICKER).is_some()
            && let Some(reason) = blocked(moment, hazards, contact)
        {
            self.hold(moment, reason, true);
            return true;
        }
        false
    }

    /// What the robot would come too near to if it braked only after the next judgement, and is better braked for
    /// now. What goes ahead of it may stop at any moment, and a newcomer may come at it.
    fn must_brake(&self, moment: &Moment) -> Option<Contact> {
        let demand = Demand { sure: f64::INFINITY, ..self.kept(moment) };
        let Outlook { futures, rollout, place, .. } = &moment.outlook;
        let seen = moment.outlook.seen();
        let stopped = futures.iter().map(Future::stopped);
        let all: Vec<Future> = seen.iter().cloned().chain(stopped).collect();
        let held_from =
            |time: f64| rollout.course((*place, Pace(1.0)), [time, f64::INFINITY], &all, demand);
        let contact = held_from(NEXT).contact?;
        let better_held = held_from(f64::INFINITY).gap <= held_from(REACTION).gap;
        better_held.then_some(Contact { future: contact.future % seen.len(), ..contact })
    }

    /// Whether a robot that is held may go on along its legs.
    pub(super) fn may_go(&self, moment: &Moment) -> bool {
        let demand = self.kept(moment);
        let Outlook { rollout, place, .. } = &moment.outlook;
        let on = moment.outlook.course(0.0, [f64::INFINITY; 2], demand);
        on.contact.is_none_or(|contact| contact.time > LEFT_OPEN)
            && has_room(rollout, *place, &moment.outlook.seen(), demand)
    }

    /// The legs to begin with at rest, where `route` is the way among what stands; else why the robot rather
    /// waits, if that is new. It may also go on along the legs that it has if they still fit: `waited` tells how
    /// long it has waited for that, s. The longer, the less is believed of how soon they will be free.
    pub(super) fn begin(
        &self,
        moment: &Moment,
        route: Route,
        waited: Option<f64>,
    ) -> Result<Route, Option<Reason>> {
        let outlook = &moment.outlook;
        if outlook.futures.is_empty() || moment.is_slow() {
            return Ok(route);
        }
        let demand = self.demand(moment.extra(), route.margin);
        let kept = self.kept(moment);
        let within = waited.map_or(f64::INFINITY, |waited| {
            outlook.quickest_hold(0.0, kept) + waited - QUICKER_AT_REST
        });
        let plan = self.search(moment, (moment.pose, RESTART), &route, (demand, within));
        let quicker = plan.cost() < within;
        let other = if plan.waits_for.is_none() {
            Route { legs: plan.legs(), length: plan.length(), margin: route.margin }
        } else {
            route.clone()
        };
        // Where it will have to wait later is seen then.
        let met = |route: &Route| self.met(&outlook.futures, route, moment.extra());
        let is_open = met(&other).0.is_none_or(|contact| contact.time > LEFT_OPEN);
        let begins_at_once = plan.waits_for.is_none() && plan.first_wait() < AT_ONCE;
        if quicker && (is_open || begins_at_once) && met(&other).1 {
            return Ok(other);
        }
        let thing = plan.waits_for.flatten().or(met(&route).0.map(|contact| contact.future));
        let ahead =
            |index: usize| outlook.futures[index].footprint().distance(moment.pose.position);
        Err(thing.and_then(|index| moment.blocked(outlook.hazards[index], ahead(index))))
    }

    /// Whether legs from rest meet nothing that moves if they begin now.
    pub(super) fn is_open(&self, now: Duration, route: &Route) -> bool {
        let (_, futures) = self.floor.futures(now);
        let (contact, has_room) = self.met(&futures, route, 0.0);
        contact.is_none() && has_room
    }

    /// What a route would meet that began now, and keeps so much more than its margin, m; and whether it has room to
    /// begin.
    fn met(&self, futures: &[Future], route: &Route, extra: f64) -> (Option<Contact>, bool) {
        let rollout = Rollout::new(&route.legs, &self.limits);
        let place = Place { leg: 0, time: 0.0 };
        let demand = self.demand(extra, route.margin);
        let on = rollout.course((place, Pace(0.0)), [f64::INFINITY; 2], futures, demand);
        (on.contact, has_room(&rollout, place, futures, demand))
    }

    /// Legs behind the one under way that are quicker than `waiting`.
    fn behind_the_leg(&self, moment: &Moment, demand: Demand, waiting: f64) -> Option<Route> {
        let first = moment.legs.first().filter(|_| moment.legs.len() > 1)?;
        let rollout = Rollout::new(std::slice::from_ref(first), &self.limits);
        let start = (moment.outlook.place, Pace(1.0));
        let leg = rollout.course(start, [f64::INFINITY; 2], &moment.outlook.futures, demand);
        if leg.contact.is_some() {
            return None;
        }
        let from = (end_of(first, &self.limits), leg.rests);
        let (plan, margin) = self.dynamic_plan(moment, from, waiting - QUICKER)?;
        (plan.first_wait() < AT_ONCE).then(|| Route {
            legs: plan.legs(),
            length: plan.length(),
            margin,
        })
    }

    /// The way over time to the goal from a place where the robot rests at a time, and its margin; none that costs
    /// more than `within`.
    fn dynamic_plan(
        &self,
        moment: &Moment,
        (from, start): (Pose, f64),
        within: f64,
    ) -> Option<(DynamicPlan, f64)> {
        let route = self.route(from, (moment.extra(), false)).ok()?;
        let demand = self.demand(moment.extra(), route.margin);
        let plan = self.search(moment, (from, start), &route, (demand, within));
        plan.waits_for.is_none().then_some((plan, route.margin))
    }

    fn search(
        &self,
        moment: &Moment,
        (from, start): (Pose, f64),
        route: &Route,
        (demand, within): (Demand, f64),
    ) -> DynamicPlan {
        let router = &self.options.router;
        let scene = Scene { obstacles: self.floor.standing(), ..router.scene.clone() };
        let mut way = goals(&route.legs);
        way.pop();
        let futures = &moment.outlook.futures;
        let quest = Quest { from, start, goal: router.goal, within, way: &way, futures };
        DynamicArena::new(&scene, self.limits, router.legs, demand).plan(&quest)
    }
}

impl Outlook {
    /// What moves, then newcomers, as `hazards` lists them.
    fn seen(&self) -> Vec<Future> {
        self.futures.iter().chain(&self.newcomers).cloned().collect()
    }

    fn course(&self, pace: f64, held: [f64; 2], demand: Demand) -> Course {
        self.rollout.course((self.place, Pace(pace)), held, &self.futures, demand)
    }

    /// What the quickest hold costs after which the legs lead on to their end, s.
    fn quickest_hold(&self, pace: f64, demand: Demand) -> f64 {
        let holds = (0..HOLDS).map(|step| FIRST_HOLD * LONGER.powi(step));
        let mut tried = holds.map(|hold| self.course(pace, [REACTION, REACTION + hold], demand));
        let free = tried.find(|course| course.contact.is_none());
        free.map_or(f64::INFINITY, |course| course.cost())
    }
}

/// Whether a robot at rest has room to begin.
fn has_room(rollout: &Rollout, place: Place, futures: &[Future], demand: Demand) -> bool {
    let roomy = Demand { keep: demand.keep + ROOM, ..demand };
    let held = [FIRST_MOMENTS, f64::INFINITY];
    let first = rollout.course((place, Pace(0.0)), held, futures, roomy);
    first.contact.is_none_or(|contact| contact.time > FIRST_MOMENTS)
}

fn blocked(moment: &Moment, hazards: &[usize], contact: Contact) -> Option<Reason> {
    moment.blocked(*hazards.get(contact.future)?, contact.distance)
}
