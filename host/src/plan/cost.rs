//! Ways that are best by something else than their length: driving time, or number of turns.
//!
//! A robot that turns on the spot pays for every turn, so the shortest way is not always the
//! quickest. The cost of a turn depends on the legs before and after it; the states of the search
//! are therefore legs, pairs of corners that see each other by [`LegTest`]. It is best among all ways
//! that turn at corners of the grown boxes. Work grows with the square of the corners in reach, so
//! this is for rooms, not for cities. Metres, seconds, radians; lattice units inside.

use super::LegTest;
use super::ranked::Ranked;
use crate::grid::{EnlargedArena, LatticePoint, UNITS_PER_METRE};
use protocol::motion::{Limits, Profile, TICK_MILLISECONDS};
use protocol::units::Metres;
use std::collections::{BinaryHeap, HashMap};

/// What makes a way good.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum Cost {
    /// The shortest.
    #[default]
    Length,
    /// The quickest within the wheels' limits: turn on the spot, drive, turn, drive.
    Time(Limits),
    /// The one with the fewest turns, and of these the shortest.
    Turns,
}

/// More than any way is long, metres: one turn less is worth every detour.
const TURN_PRICE: f64 = 1e7;

impl Cost {
    /// The cost of driving `length` metres straight on.
    ///
    /// ```
    /// use wmr::{legs::DEFAULT_LIMITS, plan::Cost};
    /// assert_eq!(Cost::Length.of_leg(1.5), 1.5);
    /// // 1/0.4 s at 0.4 m/s, π 0.4 / 1.6 s for the ramps at 0.8 m/s², in whole ticks of 5 ms.
    /// assert_eq!(Cost::Time(DEFAULT_LIMITS).of_leg(1.0), 3.29);
    /// ```
    pub fn of_leg(&self, length: f64) -> f64 {
        match self {
            Self::Length | Self::Turns => length,
            Self::Time(limits) => seconds(length, limits),
        }
    }

    /// The cost of turning by `angle` radians between two legs.
    pub fn of_turn(&self, angle: f64) -> f64 {
        match self {
            Self::Length => 0.0,
            Self::Time(limits) => seconds(angle.abs() * f64::from(limits.track.0) / 2.0, limits),
            Self::Turns if angle == 0.0 => 0.0,
            Self::Turns => TURN_PRICE,
        }
    }

    /// The cost of the way over `points`, units.
    fn of_way(&self, points: &[LatticePoint]) -> f64 {
        let legs = points.windows(2).map(|leg| self.of_leg(metres(leg[0], leg[1])));
        let turns = points.windows(3).map(|p| self.of_turn(angle(p[0], p[1], p[2])));
        legs.chain(turns).sum()
    }
}

/// The time in which the robot's own profile takes the wheels' rims over `distance` metres, from rest
/// to rest.
fn seconds(distance: f64, limits: &Limits) -> f64 {
    let ticks = Profile::shortest(Metres(distance as f32), limits).ticks();
    f64::from(ticks) * f64::from(TICK_MILLISECONDS) / 1000.0
}

/// The way of least `cost`; `shortest` is the shortest way, from which the search takes its bound.
pub(super) fn best_way(
    cost: Cost,
    arena: &EnlargedArena,
    test: &LegTest,
    shortest: Vec<LatticePoint>,
) -> Vec<LatticePoint> {
    let (Some(&start), Some(&goal)) = (shortest.first(), shortest.last()) else { return shortest };
    if cost == Cost::Length || shortest.len() < 3 {
        return shortest;
    }
    let bound = cost.of_way(&shortest);
    let is_in_reach = |&corner: &LatticePoint| {
        cost.of_leg(metres(start, corner)) + cost.of_leg(metres(corner, goal)) <= bound
    };
    let mut places = vec![start, goal];
    places.extend(corners(arena, test).into_iter().filter(is_in_reach));
    let mut search = LegSearch { cost, test, seen: vec![None; places.len()], places };
    search.run(bound).unwrap_or(shortest)
}

/// The corners of the grown boxes at which a way can turn: three of the four quadrants are free.
fn corners(arena: &EnlargedArena, test: &LegTest) -> Vec<LatticePoint> {
    let mut corners: Vec<LatticePoint> = arena.boxes.iter().flat_map(|b| b.corners()).collect();
    corners.retain(|&corner| test.is_turning_point(corner));
    corners.sort_unstable();
    corners.dedup();
    corners
}

/// Place 0 is the start, place 1 the goal.
struct LegSearch<'a> {
    cost: Cost,
    test: &'a LegTest,
    places: Vec<LatticePoint>,
    /// By place, the places that it sees, once asked.
    seen: Vec<Option<Vec<usize>>>,
}

/// A leg at the end of a way from the start.
#[derive(Clone, Copy)]
struct Leg {
    from: usize,
    to: usize,
    parent: usize,
    cost: f64,
}

impl LegSearch<'_> {
    /// The best way of cost below `bound`, if there is one.
    fn run(&mut self, bound: f64) -> Option<Vec<LatticePoint>> {
        let mut legs = vec![Leg { from: 0, to: 0, parent: 0, cost: 0.0 }];
        let mut best: HashMap<(usize, usize), f64> = HashMap::new();
        let mut queue = BinaryHeap::from([Ranked { cost: 0.0, index: 0 }]);
        while let Some(Ranked { index, .. }) = queue.pop() {
            let leg = legs[index];
            if leg.to == 1 {
                return Some(self.trace(&legs, index));
            }
            if best.get(&(leg.from, leg.to)).is_some_and(|&known| known < leg.cost) {
                continue;
            }
            for to in self.seen_from(leg.to) {
                let cost = leg.cost + self.step(&leg, to);
                let rest = self.cost.of_leg(metres(self.places[to], self.places[1]));
                let known = best.entry((leg.to, to)).or_insert(f64::INFINITY);
                if cost < *known && cost + rest < bound {
                    *known = cost;
                    queue.push(Ranked { cost: cost + rest, index: legs.len() });
                    legs.push(Leg { from: leg.to, to, parent: index, cost });
                }
            }
        }
        None
    }

    /// The cost of going on from the end of `leg` to place `to`.
    fn step(&self, leg: &Leg, to: usize) -> f64 {
        let [before, at, next] = [leg.from, leg.to, to].map(|place| self.places[place]);
        let turn = if before == at { 0.0 } else { angle(before, at, next) };
        self.cost.of_turn(turn) + self.cost.of_leg(metres(at, next))
    }

    fn seen_from(&mut self, place: usize) -> Vec<usize> {
        let at = self.places[place];
        let sees = |&to: &usize| self.places[to] != at && self.test.is_free(at, self.places[to]);
        let all = 1..self.places.len();
        self.seen[place].get_or_insert_with(|| all.filter(sees).collect()).clone()
    }

    fn trace(&self, legs: &[Leg], last: usize) -> Vec<LatticePoint> {
        let parent = |&at: &usize| (at != 0).then(|| legs[at].parent);
        let way = std::iter::successors(Some(last), parent);
        let mut points: Vec<LatticePoint> = way.map(|at| self.places[legs[at].to]).collect();
        points.reverse();
        points
    }
}

fn metres(a: LatticePoint, b: LatticePoint) -> f64 {
    a.distance(b) / UNITS_PER_METRE
}

/// By how much the way turns at `at`, radians, without sign.
fn angle(before: LatticePoint, at: LatticePoint, next: LatticePoint) -> f64 {
    let ((ux, uy), (vx, vy)) = (before.to(at), at.to(next));
    ((ux * vy - uy * vx) as f64).atan2((ux * vx + uy * vy) as f64).abs()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::{Point, Rect};
    use crate::plan::{PlanOptions, plan};
    use crate::scene::Scene;
    use proptest::prelude::*;
    use protocol::units::{MetresPerSecond, MetresPerSecondSquared};

    const LIMITS: Limits = Limits {
        speed: MetresPerSecond(0.4),
        acceleration: MetresPerSecondSquared(0.8),
        track: Metres(0.12),
    };

    #[test]
    fn a_turn_costs_the_time_of_the_rims_on_their_arc() {
        // A quarter turn takes the rims 0.06 π/2 = 0.0942 m: √(2π 0.0942 / 0.8) = 0.8604 s.
        assert_eq!(Cost::Time(LIMITS).of_turn(std::f64::consts::FRAC_PI_2), 0.865);
        assert_eq!(Cost::Time(LIMITS).of_turn(0.0), 0.0);
    }

    fn with_boxes(boxes: &[[f64; 4]], cost: Cost) -> Vec<Point> {
        let mut scene = Scene::new(2.0, 2.0);
        scene.robot_radius = 0.0;
        scene.obstacles = boxes.iter().map(|&numbers| Rect::from(numbers).into()).collect();
        let options = PlanOptions { cost, ..Default::default() };
        plan(&scene, Point::new(0.1, 1.0), Point::new(1.9, 1.0), &options).unwrap().waypoints
    }

    #[test]
    fn the_way_with_fewest_turns_takes_the_detour() {
        // The shortest way turns at two corners of the first box; the second one's lower right corner
        // sees both ends.
        let boxes = [[0.8, 0.9, 1.2, 1.05], [0.95, 1.3, 1.0, 1.4]];
        let [start, goal] = [Point::new(0.1, 1.0), Point::new(1.9, 1.0)];
        let short = [start, Point::new(0.8, 1.05), Point::new(1.2, 1.05), goal];
        assert_eq!(with_boxes(&boxes, Cost::Length), short);
        assert_eq!(with_boxes(&boxes, Cost::Turns), [start, Point::new(1.0, 1.3), goal]);
    }

    /// The least cost by trying every order of up to three corners.
    fn slow(cost: Cost, arena: &EnlargedArena, start: LatticePoint, goal: LatticePoint) -> f64 {
        let test = LegTest::new(arena);
        let corners = corners(arena, &test);
        let mut best = f64::INFINITY;
        let mut ways = vec![vec![start]];
        while let Some(way) = ways.pop() {
            let last = way[way.len() - 1];
            if test.is_free(last, goal) {
                best = best.min(cost.of_way(&[&way[..], &[goal]].concat()));
            }
            if way.len() < 4 {
                let next = corners.iter().filter(|c| !way.contains(c) && test.is_free(last, **c));
                ways.extend(next.map(|&c| [&way[..], &[c]].concat()));
            }
        }
        best
    }

    proptest! {
        #[test]
        fn no_way_over_three_corners_is_better(
            boxes in proptest::collection::vec(proptest::array::uniform4(1..8_i32), 1..4),
            cost in prop_oneof![Just(Cost::Turns), Just(Cost::Time(LIMITS))],
        ) {
            let whole = crate::grid::LatticeRect::new(0, 0, 120_000, 120_000);
            let step = 10_000;
            let boxes = boxes.iter().map(|&[x, y, w, h]| {
                crate::grid::LatticeRect::new(x * step, y * step, (x + w / 2 + 1) * step, (y + h / 2 + 1) * step)
            });
            let arena = EnlargedArena::new(whole, whole, boxes.collect());
            let (start, goal) = (LatticePoint::new(3000, 7000), LatticePoint::new(117_000, 113_000));
            let shortest = super::super::exact::Exact::new(&arena).shortest(start, goal).unwrap();
            let before = cost.of_way(&shortest);
            let way = best_way(cost, &arena, &LegTest::new(&arena), shortest);
            let found = cost.of_way(&way);
            prop_assert!(found <= before + 1e-9);
            prop_assert!(found <= slow(cost, &arena, start, goal) + 1e-6, "{way:?} costs {found}");
        }
    }
}
