//! The shortest way among boxes grown by a disc: corners are arcs, not squares.
//!
//! Deviation: the paper grows rectangles to rectangles, which keeps the robot up to 41 % of its radius
//! further from a corner than it must. Here each corner of a grown box is an arc, replaced by legs along
//! tangents that stay within a stated tolerance of it, outside.
//!
//! The search is A* over the vertices of these outlines. From a vertex only those are candidates at
//! which the leg is tangent on both outlines, so each outline offers two at most; whether the leg is
//! free is asked of the outlines near it. Work grows with the boxes in reach of the way, squared: this
//! is for rooms, not for cities. Whatever is found, [`DiscTest`] has the last word. Lattice units.

mod disc_clearance;
mod outline;

use super::box_index::BoxIndex;
use super::ranked::Ranked;
use crate::grid::{EnlargedArena, LatticePoint, LatticeRect};
use disc_clearance::{DiscTest, grow};
use outline::{Outline, arc};
use std::collections::BinaryHeap;

/// How far a way around a corner may lie outside the true arc, units (1 mm).
pub(super) const TOLERANCE: i32 = 10;

/// An arena whose boxes grow by a disc.
#[derive(Clone, Debug)]
pub(super) struct Round {
    inside: LatticeRect,
    outlines: Vec<Outline>,
    /// The numbers of the turns of outline `i` are `first[i]..first[i + 1]`.
    first: Vec<usize>,
    /// By turn: where it is, and of which outline; `None` if the robot cannot be there.
    turns: Vec<Option<(LatticePoint, usize)>>,
    index: BoxIndex,
    test: DiscTest,
}

/// The best way known to a turn.
#[derive(Clone, Copy, Debug)]
struct Reached {
    length: f64,
    parent: usize,
    is_settled: bool,
}

/// The number of the start among the turns.
const START: usize = usize::MAX;

impl Round {
    /// The boxes of `arena`, which have grown by `radius` with square corners, with round ones.
    pub(super) fn new(arena: &EnlargedArena, radius: i32) -> Self {
        let boxes: Vec<LatticeRect> = arena.boxes.iter().map(|&b| grow(b, -radius)).collect();
        let arc = arc(radius, TOLERANCE);
        let outlines: Vec<Outline> = boxes.iter().map(|&rect| Outline::new(rect, &arc)).collect();
        let spans: Vec<LatticeRect> = outlines.iter().map(Outline::span).collect();
        let mut first = vec![0];
        let mut turns = Vec::new();
        for (number, outline) in outlines.iter().enumerate() {
            turns.extend(outline.turns.iter().map(|&at| Some((at, number))));
            first.push(turns.len());
        }
        let index = BoxIndex::new(arena.inside, &spans);
        let test = DiscTest::new(arena.inside, boxes, radius);
        let mut round = Self { inside: arena.inside, outlines, first, turns, index, test };
        let is_open = |at: LatticePoint| {
            round.inside.contains(at) && !round.index.at(at).any(|k| round.outlines[k].holds(at))
        };
        let open = |turn: &Option<(LatticePoint, usize)>| turn.filter(|&(at, _)| is_open(at));
        round.turns = round.turns.iter().map(open).collect();
        round
    }

    /// Whether the robot can stand at `point`.
    pub(super) fn holds(&self, point: LatticePoint) -> bool {
        self.test.holds(point)
    }

    /// The index of the first leg over `points` that comes too near to a box, as an error.
    pub(super) fn check_path(&self, points: &[LatticePoint]) -> Result<(), usize> {
        self.test.check_path(points)
    }

    /// The points of the shortest way, start and goal included; `None` if there is none. `square` is the
    /// shortest way with square corners, if there is one: the robot can drive that too.
    pub(super) fn shortest(
        &self,
        start: LatticePoint,
        goal: LatticePoint,
        square: Option<Vec<LatticePoint>>,
    ) -> Option<Vec<LatticePoint>> {
        let bound = square.as_ref().map_or(f64::INFINITY, |points| length(points));
        let search = RoundSearch {
            round: self,
            ends: [start, goal],
            around: [start, goal].map(|end| self.outlines_around(end)),
            bound,
        };
        let found = search.run();
        found.filter(|points| length(points) < bound).or(square)
    }

    /// The outlines that hold `point` although the disc touches nothing: it stands between an arc and
    /// its tangents.
    fn outlines_around(&self, point: LatticePoint) -> Vec<usize> {
        self.index.at(point).filter(|&k| self.outlines[k].holds(point)).collect()
    }
}

fn length(points: &[LatticePoint]) -> f64 {
    points.windows(2).map(|leg| leg[0].distance(leg[1])).sum()
}

struct RoundSearch<'a> {
    round: &'a Round,
    ends: [LatticePoint; 2],
    /// By end: the outlines that hold it.
    around: [Vec<usize>; 2],
    /// No way as long as this is of interest.
    bound: f64,
}

impl RoundSearch<'_> {
    fn run(&self) -> Option<Vec<LatticePoint>> {
        let [start, goal] = self.ends;
        if self.is_free(start, goal) {
            return Some(vec![start, goal]);
        }
        let mut reached: Vec<Option<Reached>> = vec![None; self.round.turns.len()];
        let mut queue = BinaryHeap::new();
        let mut best: Option<(f64, usize)> = None;
        let mut from = (START, start, 0.0);
        loop {
            for (turn, at) in self.candidates(from.0, from.1) {
                let length = from.2 + from.1.distance(at);
                let cost = length + at.distance(goal);
                let is_shorter = reached[turn].is_none_or(|known| length < known.length);
                if cost < self.bound && is_shorter && self.is_free(from.1, at) {
                    reached[turn] = Some(Reached { length, parent: from.0, is_settled: false });
                    queue.push(Ranked { cost, index: turn });
                }
            }
            from = loop {
                let Some(Ranked { cost, index }) = queue.pop() else {
                    return best.map(|(_, last)| self.trace(&reached, last));
                };
                if best.is_some_and(|(length, _)| length <= cost) {
                    return best.map(|(_, last)| self.trace(&reached, last));
                }
                let (Some(known), Some((at, _))) = (&mut reached[index], self.round.turns[index])
                else {
                    continue;
                };
                if !std::mem::replace(&mut known.is_settled, true) {
                    break (index, at, known.length);
                }
            };
            let whole = from.2 + from.1.distance(goal);
            let is_shorter = best.is_none_or(|(length, _)| whole < length);
            if is_shorter && self.leaves_freely(from.0, goal) && self.is_free(from.1, goal) {
                best = Some((whole, from.0));
            }
        }
    }

    /// The turns to which a way may lead straight from `at`, the turn `from` or the start.
    fn candidates(&self, from: usize, at: LatticePoint) -> Vec<(usize, LatticePoint)> {
        let round = self.round;
        let own = round.turns.get(from).copied().flatten().map(|(_, outline)| outline);
        let mut found = Vec::new();
        for (k, outline) in round.outlines.iter().enumerate() {
            let first = round.first[k];
            let is_candidate = |place: &usize| match own {
                Some(own) if own == k => outline.beside(from - first).contains(place),
                None if self.around[0].contains(&k) => true,
                _ => outline.is_tangent(at, *place),
            };
            for place in (0..outline.turns.len()).filter(is_candidate) {
                let turn = first + place;
                if let Some((to, _)) =
                    round.turns[turn].filter(|(to, _)| self.leaves_freely(from, *to))
                {
                    found.push((turn, to));
                }
            }
        }
        found
    }

    /// Whether a way from the turn `from` to `to` does not cut its own outline.
    fn leaves_freely(&self, from: usize, to: LatticePoint) -> bool {
        let Some((_, k)) = self.round.turns.get(from).copied().flatten() else { return true };
        self.around[1].contains(&k)
            || self.round.outlines[k].is_tangent(to, from - self.round.first[k])
    }

    /// Whether the leg is free: it meets no outline but those that hold an end of the way, of which it
    /// keeps the disc's radius.
    fn is_free(&self, a: LatticePoint, b: LatticePoint) -> bool {
        let span = LatticeRect::new(a.x.min(b.x), a.y.min(b.y), a.x.max(b.x), a.y.max(b.y));
        self.round.index.near(span).all(|k| {
            if self.around.iter().any(|around| around.contains(&k)) {
                self.round.test.keeps_off(k, a, b)
            } else {
                !self.round.outlines[k].meets(a, b)
            }
        })
    }

    fn trace(&self, reached: &[Option<Reached>], last: usize) -> Vec<LatticePoint> {
        let mut points = vec![self.ends[1]];
        let mut turn = last;
        while let (Some(Some((at, _))), Some(Some(known))) =
            (self.round.turns.get(turn), reached.get(turn))
        {
            points.push(*at);
            turn = known.parent;
        }
        points.push(self.ends[0]);
        points.reverse();
        points
    }
}

#[cfg(test)]
mod tests;
