//! The search in places and time: which legs, and when each begins, lead to the goal soonest.
//!
//! Safe-interval path planning with legs of any direction: a node is a place, reached at a time with a heading; from
//! it a leg may lead to every other place, at once or after a wait that the place's free interval
//! allows. Legs are ordered by the time at which the goal could be reached at best, and only the one at the head is
//! tried against what moves: most are never looked at. A leg that meets something is put back with a later
//! beginning. What a leg risks is added to its time. Seconds, metres.

use super::plan::{DynamicPlan, RISK_WEIGHT, TimedLeg};
use super::queue::{Entry, Next, Node};
use super::times::Times;
use super::{DynamicArena, Future, LegMotion, Quest, TimeGrid};
use crate::geometry::{Point, Pose, wrap_angle};
use crate::legs::{named, to_wire};
use protocol::motion::{Direction, Leg, Position};
use protocol::units::Radians;
use std::collections::BinaryHeap;

/// A leg that meets something begins later by so much, s.
const DELAY: f64 = 0.2;
/// No longer wait is planned before one leg, s.
const LONGEST_WAIT: f64 = 10.0;
/// So many legs are tried at most.
const TRIED: usize = 800;
const DIRECTIONS: [Direction; 2] = [Direction::Forward, Direction::Reverse];

/// A search under way.
pub(super) struct Search<'a, 'q> {
    arena: &'a DynamicArena<'a>,
    quest: &'q Quest<'q>,
    times: Times,
    grid: TimeGrid<'q>,
    /// Places where the robot may stand as far as what stands goes, and their distance to the goal, m.
    usable: Vec<(usize, f64)>,
    goal: usize,
    nodes: Vec<Node>,
    queue: BinaryHeap<Entry>,
    /// By place, how it was reached.
    reached: Vec<Vec<usize>>,
    fastest: f64,
    blocker: Option<usize>,
    /// The cost of the best way to the goal that is known, s.
    bound: f64,
}

impl<'a, 'q> Search<'a, 'q> {
    /// The search for a way over `arena`.
    pub(super) fn new(arena: &'a DynamicArena<'a>, quest: &'q Quest<'q>) -> Self {
        let mut own = quest.way.to_vec();
        own.extend([quest.from.position, quest.goal.position]);
        let grid = TimeGrid::new(arena.scene.arena, quest.futures, arena.demand, &own);
        let goal = grid.len() - 1;
        let cells = grid.len() - own.len();
        let near = grid.side() / 2.0;
        let is_usable = |index: usize| {
            let place = grid.place(index);
            let apart = index >= cells || own.iter().all(|other| other.distance(place) > near);
            apart && (index >= cells || arena.is_clear(place, place))
        };
        let usable: Vec<(usize, f64)> = (0..grid.len())
            .filter(|&index| index != goal - 1 && is_usable(index))
            .map(|index| (index, grid.place(index).distance(quest.goal.position)))
            .collect();
        let times = Times::new(arena.limits, arena.options.timing, near);
        let speed = f64::from(arena.limits.speed.0);
        let fastest = quest.futures.iter().map(Future::speed).fold(0.0, f64::max) + speed;
        let reached = vec![Vec::new(); grid.len()];
        Self {
            arena,
            quest,
            times,
            grid,
            usable,
            goal,
            nodes: Vec::new(),
            queue: BinaryHeap::new(),
            reached,
            fastest,
            blocker: None,
            bound: f64::INFINITY,
        }
    }

    /// The way that reaches the goal soonest, or leads to where the robot best waits.
    pub(super) fn run(mut self) -> DynamicPlan {
        let Quest { from, start, .. } = *self.quest;
        let place = self.goal - 1;
        let first = Node { place, time: start, pose: from, cost: start, risk: 0.0, parent: None };
        let along = self.along_way(first);
        let along = along.filter(|(node, _)| node.cost < self.quest.within);
        self.bound = along.as_ref().map_or(self.quest.within, |(node, _)| node.cost);
        self.reach(first);
        let mut tried = 0;
        while let Some(entry) = self.queue.pop() {
            if entry.best >= self.bound {
                break;
            }
            match entry.next {
                Next::Others => self.expand(entry.from),
                Next::Tried(node) => {
                    if node.place == self.goal {
                        return self.plan_to(node, None);
                    }
                    self.reach(node);
                }
                Next::Leg { to, direction, wait } => {
                    tried += 1;
                    if tried > TRIED {
                        break;
                    }
                    self.try_leg(entry, (to, direction, wait));
                }
            }
        }
        match along {
            Some((last, legs)) => self.named(last, legs, None),
            None => self.waiting_place(),
        }
    }

    /// The way among what stands, each of its legs as soon as it is free.
    fn along_way(&mut self, first: Node) -> Option<(Node, Vec<TimedLeg>)> {
        let places = self.goal - 1 - self.quest.way.len();
        let inner = places..self.goal - 1;
        let (mut node, mut legs) = (first, Vec::new());
        for to in inner.chain([self.goal]) {
            if self.grid.place(to) == node.pose.position && to != self.goal {
                continue;
            }
            let ways = DIRECTIONS.into_iter().take(if self.arena.options.reverse { 2 } else { 1 });
            let legs_to: Vec<Leg> = ways.map(|way| self.leg(node.pose, to, way)).collect();
            if !self.arena.is_clear(node.pose.position, self.grid.place(to)) {
                return None;
            }
            let quickest = legs_to.into_iter().min_by_key(|leg| leg.ticks(&self.arena.limits))?;
            let motion = LegMotion::new(&quickest, &self.arena.limits);
            let mut waits = (0..=(LONGEST_WAIT / DELAY) as u32).map(|step| DELAY * f64::from(step));
            let (wait, risk) = waits.find_map(|wait| {
                let risk = self.risk_of(&motion, node.time + wait).ok()?;
                Some((wait, risk))
            })?;
            let begins = node.time + wait;
            legs.push(TimedLeg { leg: quickest, begins, wait });
            node = Node {
                place: to,
                time: begins + motion.times()[2],
                pose: motion.end,
                cost: node.cost + wait + motion.times()[2] + RISK_WEIGHT * risk,
                risk: node.risk + risk,
                parent: None,
            };
        }
        Some((node, legs))
    }

    /// Takes a node up, unless the place was reached before in a way that is as good.
    fn reach(&mut self, node: Node) {
        let is_as_good = |index: usize| {
            let other = self.nodes[index];
            let turn = self.times.turn(node.pose.heading - other.pose.heading);
            other.cost + turn <= node.cost
                && self.grid.free_until(node.place, other.time) >= node.time
        };
        if self.reached[node.place].iter().copied().any(is_as_good) {
            return;
        }
        let index = self.nodes.len();
        self.reached[node.place].push(index);
        self.nodes.push(node);
        let distance = node.pose.position.distance(self.quest.goal.position);
        self.offer(index, (self.goal, 0.0));
        let best = node.cost + self.times.by_two(distance);
        self.queue.push(Entry { best, from: index, next: Next::Others });
    }

    /// Puts the legs to all places but the goal into the queue.
    fn expand(&mut self, from: usize) {
        let usable = std::mem::take(&mut self.usable);
        for &(to, distance) in &usable {
            if to != self.goal && to != self.nodes[from].place {
                self.offer(from, (to, distance));
            }
        }
        self.usable = usable;
    }

    /// Puts the legs to one place, which is `rest` from the goal, into the queue.
    fn offer(&mut self, from: usize, (to, rest): (usize, f64)) {
        let node = self.nodes[from];
        let place = self.grid.place(to);
        let (dx, dy) = (place.x - node.pose.position.x, place.y - node.pose.position.y);
        let length = dx.hypot(dy);
        let bearing = if length > 0.0 { dy.atan2(dx) } else { node.pose.heading };
        let is_reversible = self.arena.options.reverse;
        for direction in DIRECTIONS.into_iter().take(if is_reversible { 2 } else { 1 }) {
            let heading = match direction {
                Direction::Forward => bearing,
                Direction::Reverse => wrap_angle(bearing + std::f64::consts::PI),
            };
            let leg = [heading - node.pose.heading, length];
            let best = if to == self.goal {
                let last = self.quest.goal.heading.map_or(0.0, |goal| goal - heading);
                node.cost + self.times.leg(leg[0], leg[1], last)
            } else {
                let goal = self.quest.goal.position;
                let (gx, gy) = (goal.x - place.x, goal.y - place.y);
                let on = self.times.rest(gy.atan2(gx) - heading, rest, is_reversible);
                node.cost + self.times.leg(leg[0], leg[1], 0.0) + on
            };
            if best < self.bound {
                self.queue.push(Entry { best, from, next: Next::Leg { to, direction, wait: 0.0 } });
            }
        }
    }

    /// Tries a leg; it comes back with its real cost, or later, or never.
    fn try_leg(&mut self, entry: Entry, (to, direction, wait): (usize, Direction, f64)) {
        let node = self.nodes[entry.from];
        let goal = self.grid.place(to);
        let leg = self.leg(node.pose, to, direction);
        let is_first_try = wait == 0.0;
        if is_first_try
            && (leg.check(&self.arena.limits).is_err()
                || !self.arena.is_clear(node.pose.position, goal))
        {
            return;
        }
        let motion = LegMotion::new(&leg, &self.arena.limits);
        let begins = node.time + wait;
        let again = match self.risk_of(&motion, begins) {
            Ok(risk) => {
                let arrival = begins + motion.times()[2];
                let dear = RISK_WEIGHT * risk;
                let cost = node.cost + wait + motion.times()[2] + dear;
                let timed = TimedLeg { leg, begins, wait };
                let reached = Node {
                    place: to,
                    time: arrival,
                    pose: motion.end,
                    cost,
                    risk: node.risk + risk,
                    parent: Some((entry.from, timed)),
                };
                let best = entry.best + dear;
                self.queue.push(Entry { best, next: Next::Tried(reached), ..entry });
                // Later there may be less risk; what costs no more than the wait is not worth it.
                (dear > DELAY).then_some(DELAY)
            }
            Err((time, blocker)) => {
                if to == self.goal {
                    self.blocker = Some(blocker);
                }
                self.later(motion.position(time - begins), time)
            }
        };
        let Some(more) = again else { return };
        let until = match node.parent {
            None => f64::INFINITY,
            Some(_) => self.grid.free_until(node.place, node.time),
        };
        if wait + more <= LONGEST_WAIT && begins + more <= until {
            let next = Next::Leg { to, direction, wait: wait + more };
            self.queue.push(Entry { best: entry.best + more, next, ..entry });
        }
    }

    /// How much later a leg may begin that met something at a place and time: not before the place is free.
    fn later(&self, place: Point, time: f64) -> Option<f64> {
        let mut waits = (1..=(LONGEST_WAIT / DELAY) as u32).map(|step| DELAY * f64::from(step));
        let is_free =
            |wait: &f64| self.arena.demand.at(self.quest.futures, place, time + wait).gap >= 0.0;
        waits.find(is_free)
    }

    fn leg(&self, from: Pose, to: usize, direction: Direction) -> Leg {
        let goal = self.grid.place(to);
        let goal_heading = self.quest.goal.heading.filter(|_| to == self.goal);
        Leg {
            plan: 0,
            index: 0,
            start: to_wire(from),
            goal: Position::new(goal.x as f32, goal.y as f32),
            goal_heading: goal_heading.map(|heading| Radians(wrap_angle(heading) as f32).wrapped()),
            direction,
            timing: self.arena.options.timing,
        }
    }

    fn risk_of(&self, motion: &LegMotion, begins: f64) -> Result<f64, (f64, usize)> {
        self.arena.risk_of(motion, (self.quest, self.fastest), begins)
    }

    /// The way over the nodes to `last`.
    fn plan_to(&self, last: Node, waits_for: Option<Option<usize>>) -> DynamicPlan {
        let mut legs = Vec::new();
        let mut at = last;
        while let Some((from, timed)) = at.parent {
            legs.push(timed);
            at = self.nodes[from];
        }
        legs.reverse();
        self.named(last, legs, waits_for)
    }

    fn named(
        &self,
        last: Node,
        mut legs: Vec<TimedLeg>,
        waits_for: Option<Option<usize>>,
    ) -> DynamicPlan {
        let numbered = legs.iter().zip(0..);
        let names =
            named(numbered.map(|(timed, index)| Leg { index, ..timed.leg }).collect::<Vec<Leg>>());
        for (timed, leg) in legs.iter_mut().zip(names) {
            timed.leg = leg;
        }
        DynamicPlan { legs, arrival: last.time, risk: last.risk, waits_for }
    }

    /// The goal cannot be reached: the place nearest to it where the robot may stay.
    fn waiting_place(mut self) -> DynamicPlan {
        let nodes = self.nodes.clone();
        let stays = |grid: &mut TimeGrid, node: &Node| {
            node.parent.is_none() || grid.free_until(node.place, node.time).is_infinite()
        };
        let rest = |node: &Node| node.pose.position.distance(self.quest.goal.position);
        let best = nodes
            .iter()
            .filter(|node| stays(&mut self.grid, node))
            .min_by(|a, b| rest(a).total_cmp(&rest(b)));
        let last = best.copied().unwrap_or(nodes[0]);
        self.plan_to(last, Some(self.blocker))
    }
}
