//! From the areas' way to a taut one: few corners, each where the cost has its least.
//!
//! First the points of the way are thinned out where a straight leg costs no more than what it replaces
//! (but for a stated tolerance). Then, in turns until nothing is gained: corners slide along their legs and across them, are dropped, and
//! are cut off where that saves enough to be worth one more turn of the robot. From there on no step
//! raises the cost: it is what the true shapes make it, the areas play no part any more. Metres.

use super::march::Quest;
use crate::geometry::Point;

/// What thinning out may cost more, as a part of the cost: the areas' way is that inexact itself.
const THINNING: f64 = 2e-4;

/// A corner is cut off if that saves so much of the whole cost.
const WORTH_A_TURN: f64 = 1e-4;

/// Corners slide in steps from an area's side down to this, metres.
const FINEST_STEP: f64 = 5e-5;

/// Rounds of sliding between two rounds of cutting.
const SLIDES: usize = 12;

/// Rounds of cutting corners off.
const CUTS: usize = 3;

/// A round that gains less than this part of the cost is the last.
const SETTLED: f64 = 2e-6;

/// A way in the making, with the cost of each of its legs.
struct Taut<'a> {
    quest: &'a Quest<'a>,
    points: Vec<Point>,
    costs: Vec<f64>,
}

/// The taut way along `points`; `None` if one of its legs cannot be driven.
pub(super) fn tighten(quest: &Quest, points: &[Point]) -> Option<Vec<Point>> {
    let points = thinned(quest, points)?;
    let costs =
        points.windows(2).map(|leg| quest.cost(leg[0], leg[1])).collect::<Option<Vec<f64>>>()?;
    let mut taut = Taut { quest, points, costs };
    taut.slide();
    for _ in 0..CUTS {
        if !taut.cut_corners() {
            break;
        }
        taut.slide();
    }
    Some(taut.points)
}

/// The points that are left when straight legs replace what costs as much.
fn thinned(quest: &Quest, points: &[Point]) -> Option<Vec<Point>> {
    // Up to each point: how many legs cannot be driven, and what the others cost.
    let mut sums = vec![(0_usize, 0.0)];
    let (mut broken, mut sum) = (0, 0.0);
    for leg in points.windows(2) {
        match quest.cost(leg[0], leg[1]) {
            Some(cost) => sum += cost,
            None => broken += 1,
        }
        sums.push((broken, sum));
    }
    let last = points.len() - 1;
    let replaces = |from: usize, to: usize| {
        let is_broken = sums[to].0 > sums[from].0;
        let most = (sums[to].1 - sums[from].1) * (1.0 + THINNING);
        quest.cost(points[from], points[to]).is_some_and(|cost| is_broken || cost <= most)
    };
    let mut kept = vec![points[0]];
    let mut from = 0;
    while from < last {
        if replaces(from, last) {
            from = last;
        } else {
            let (mut reach, mut step) = (0, 1);
            while from + reach + step < last && replaces(from, from + reach + step) {
                reach += step;
                step *= 2;
            }
            while step > 0 {
                if from + reach + step <= last && replaces(from, from + reach + step) {
                    reach += step;
                }
                step /= 2;
            }
            if reach == 0 {
                return None;
            }
            from += reach;
        }
        kept.push(points[from]);
    }
    Some(kept)
}

impl Taut<'_> {
    fn whole(&self) -> f64 {
        self.costs.iter().sum()
    }

    /// The cost of going from one point over another to a third, if that can be driven.
    fn over(&self, from: Point, at: Point, to: Point) -> Option<(f64, f64)> {
        Some((self.quest.cost(from, at)?, self.quest.cost(at, to)?))
    }

    /// Slides and drops corners until that gains nothing.
    fn slide(&mut self) {
        let mut steps = vec![self.quest.grid.side(); self.points.len()];
        for _ in 0..SLIDES {
            let before = self.whole();
            self.drop_corners(&mut steps);
            let last = self.points.len() - 1;
            for (index, step) in steps.iter_mut().enumerate().take(last).skip(1) {
                *step = self.slide_corner(index, *step);
            }
            if before - self.whole() <= SETTLED * before {
                return;
            }
        }
    }

    fn drop_corners(&mut self, steps: &mut Vec<f64>) {
        let mut index = 1;
        while index + 1 < self.points.len() {
            let straight = self.quest.cost(self.points[index - 1], self.points[index + 1]);
            match straight.filter(|&cost| cost <= self.costs[index - 1] + self.costs[index]) {
                Some(cost) => {
                    self.points.remove(index);
                    steps.remove(index);
                    self.costs.remove(index);
                    self.costs[index - 1] = cost;
                    index = index.saturating_sub(1).max(1);
                }
                None => index += 1,
            }
        }
    }

    /// Slides one corner to where its two legs cost least; the length of the last step that did so.
    fn slide_corner(&mut self, index: usize, first: f64) -> f64 {
        let (from, to) = (self.points[index - 1], self.points[index + 1]);
        let (mut step, mut useful) = (first, FINEST_STEP);
        while step >= FINEST_STEP {
            let at = self.points[index];
            let cost = self.costs[index - 1] + self.costs[index];
            let better = directions(from, at, to).into_iter().find_map(|(dx, dy)| {
                let moved = Point::new(at.x + step * dx, at.y + step * dy);
                // Straight lengths alone may already say no.
                let least = from.distance(moved) + moved.distance(to);
                let legs = if least < cost { self.over(from, moved, to) } else { None }?;
                (legs.0 + legs.1 < cost - 1e-12).then_some((moved, legs))
            });
            match better {
                Some((moved, legs)) => {
                    self.points[index] = moved;
                    (self.costs[index - 1], self.costs[index]) = legs;
                    useful = f64::max(useful, step);
                }
                None => step /= 2.0,
            }
        }
        (2.0 * useful).min(self.quest.grid.side())
    }

    /// Cuts off the corners where that saves enough; whether any was.
    fn cut_corners(&mut self) -> bool {
        let worth = WORTH_A_TURN * self.whole();
        let (mut points, mut costs) = (vec![self.points[0]], Vec::new());
        let mut is_cut = false;
        for index in 1..self.points.len() - 1 {
            let (at, to) = (self.points[index], self.points[index + 1]);
            let from = points[points.len() - 1];
            let old = self.quest.cost(from, at).unwrap_or(f64::INFINITY) + self.costs[index];
            match self.cut(from, at, to).filter(|(_, cost)| old - cost.iter().sum::<f64>() > worth)
            {
                Some(([a, b], cost)) => {
                    points.extend([a, b]);
                    costs.extend([cost[0], cost[1]]);
                    is_cut = true;
                }
                None => {
                    costs.push(self.quest.cost(from, at).unwrap_or(f64::INFINITY));
                    points.push(at);
                }
            }
        }
        if is_cut {
            points.extend(self.points.last());
            let pairs: Option<Vec<f64>> =
                points.windows(2).map(|leg| self.quest.cost(leg[0], leg[1])).collect();
            if let Some(costs) = pairs {
                (self.points, self.costs) = (points, costs);
                return true;
            }
        }
        false
    }

    /// The best cut across a corner: its two ends, and what the three legs cost.
    fn cut(&self, from: Point, at: Point, to: Point) -> Option<([Point; 2], [f64; 3])> {
        const HALVINGS: usize = 12;
        let reach = from.distance(at).min(at.distance(to)) * 0.5;
        let toward = |end: Point, by: f64| {
            let share = by / at.distance(end).max(f64::MIN_POSITIVE);
            Point::new(at.x + share * (end.x - at.x), at.y + share * (end.y - at.y))
        };
        let costs = |by: f64| {
            let (a, b) = (toward(from, by), toward(to, by));
            let cost = |a, b| self.quest.cost(a, b);
            Some(([a, b], [cost(from, a)?, cost(a, b)?, cost(b, to)?]))
        };
        let (mut by, mut step) = (0.0, reach);
        let mut best = None;
        let mut least = f64::INFINITY;
        for _ in 0..HALVINGS {
            if let Some((ends, cost)) = costs(by + step)
                && cost.iter().sum::<f64>() < least
            {
                least = cost.iter().sum();
                best = Some((ends, cost));
                by += step;
            }
            step /= 2.0;
        }
        best
    }
}

/// Along both legs and across the corner, as unit vectors.
fn directions(from: Point, at: Point, to: Point) -> [(f64, f64); 6] {
    let unit = |a: Point, b: Point| {
        let length = a.distance(b).max(f64::MIN_POSITIVE);
        ((b.x - a.x) / length, (b.y - a.y) / length)
    };
    let (back, on, chord) = (unit(at, from), unit(at, to), unit(from, to));
    let across = (-chord.1, chord.0);
    let is_left = (to.x - from.x) * (at.y - from.y) - (to.y - from.y) * (at.x - from.x) > 0.0;
    let inward = if is_left { (-across.0, -across.1) } else { across };
    [inward, back, on, (-inward.0, -inward.1), chord, (-chord.0, -chord.1)]
}
