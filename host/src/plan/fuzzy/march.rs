//! Fast marching over the areas: the least cost of a way from the start to each of them.
//!
//! The cost T of arriving solves the eikonal equation |∇T| = 1 + w r with the risk r and its weight w.
//! Areas are accepted in the order of T; each takes its value from the accepted ones on its upwind sides,
//! by differences of second order where two lie in a row (Sethian). The queue sorts areas into buckets
//! narrower than any step instead of one by one, which is several times quicker and changes T by less
//! than a bucket's width. Metres.

use super::membership::MembershipGrid;
use super::risk::RiskField;
use crate::geometry::Point;

/// The width of a bucket, as a part of the side of an area.
const BUCKET: f64 = 0.125;

/// Around the start, so many areas far, the cost is that of a straight leg.
const SEEDED: f64 = 4.0;

/// From areas so many sides around the goal a straight leg leads on to it.
const REACHED: f64 = 3.0;

/// What the points of a way keep further from cores than needed, as a part of a side, so that the legs
/// between them fit.
const SPARE: f64 = 0.02;

/// How often a point of a way is moved out of the cores around it.
const ROUNDS: usize = 6;

/// Areas around the grid that are never entered.
const RING: usize = 2;

/// What the march is about.
#[derive(Clone, Copy, Debug)]
pub(super) struct Quest<'a> {
    pub(super) field: &'a RiskField,
    pub(super) grid: &'a MembershipGrid,
    pub(super) start: Point,
    pub(super) goal: Point,
    /// The weight of risk.
    pub(super) weight: f64,
    /// No place may have more risk than this.
    pub(super) ceiling: f64,
}

impl Quest<'_> {
    /// What a leg costs; `None` if it cannot be driven.
    pub(super) fn cost(&self, a: Point, b: Point) -> Option<f64> {
        let is_end = [a, b].iter().any(|&at| at == self.start || at == self.goal);
        let risk = self.field.leg(a, b, self.ceiling, is_end)?;
        Some(a.distance(b) + self.weight * risk.integral)
    }
}

/// The cost of arriving, by area; infinite where it was not needed or nothing leads.
#[derive(Clone, Debug)]
pub(super) struct Arrival {
    stride: usize,
    side: f64,
    cost: Vec<f64>,
    /// The accepted area nearest to the goal by cost.
    pub(super) last: Point,
}

/// The way is found on the grid until its areas are accepted.
struct March<'a> {
    quest: Quest<'a>,
    stride: usize,
    /// The cost of a side's length by area; infinite where blocked.
    slowness: Vec<f64>,
    cost: Vec<f64>,
    is_accepted: Vec<bool>,
    buckets: Vec<Vec<u32>>,
    width: f64,
    waiting: usize,
    /// The bucket being emptied, counted on without end.
    now: usize,
}

/// The costs of arriving, as far as the goal; `None` if nothing leads there.
pub(super) fn march(quest: Quest) -> Option<Arrival> {
    let mut march = March::new(quest);
    march.seed();
    let ends = march.ends();
    let mut best: Option<(f64, u32)> = None;
    while let Some(area) = march.next(best.map_or(f64::INFINITY, |(cost, _)| cost)) {
        if let Ok(at) = ends.binary_search_by_key(&area, |&(area, _)| area) {
            let whole = march.cost[area as usize] + ends[at].1;
            if best.is_none_or(|(least, _)| whole < least) {
                best = Some((whole, area));
            }
        }
        march.accept(area as usize);
    }
    let (_, area) = best?;
    let last = march.point(area as usize);
    // What was never accepted is no upwind side of anything.
    let costs = march.cost.iter().zip(&march.is_accepted);
    let cost = costs.map(|(&cost, &is)| if is { cost } else { f64::INFINITY }).collect();
    Some(Arrival { stride: march.stride, side: quest.grid.side(), cost, last })
}

impl<'a> March<'a> {
    fn new(quest: Quest<'a>) -> Self {
        let grid = quest.grid;
        let stride = grid.columns() + 2 * RING;
        let count = stride * (grid.rows() + 2 * RING);
        let mut slowness = vec![f64::INFINITY; count];
        for (row, areas) in grid.areas().chunks_exact(grid.columns()).enumerate() {
            let to = &mut slowness[(row + RING) * stride + RING..];
            for (slowness, area) in to.iter_mut().zip(areas) {
                if area.middle < 1.0 && f64::from(area.middle) <= quest.ceiling {
                    *slowness = grid.side() * (1.0 + quest.weight * f64::from(area.risk));
                }
            }
        }
        let width = BUCKET * grid.side();
        let most = (1.0 + quest.weight) * grid.side() * (SEEDED + 2.0);
        Self {
            quest,
            stride,
            slowness,
            cost: vec![f64::INFINITY; count],
            is_accepted: vec![false; count],
            buckets: vec![Vec::new(); (most / width) as usize + 2],
            width,
            waiting: 0,
            now: 0,
        }
    }

    fn point(&self, area: usize) -> Point {
        let (column, row) = (area % self.stride - RING, area / self.stride - RING);
        let side = self.quest.grid.side();
        Point::new((column as f64 + 0.5) * side, (row as f64 + 0.5) * side)
    }

    /// The areas around `at` that a straight leg joins to it, with what the leg costs.
    fn around(&self, at: Point, reach: f64) -> Vec<(u32, f64)> {
        let (grid, side) = (self.quest.grid, self.quest.grid.side());
        let range = |at: f64, count: usize| {
            let low = (at / side - reach - 0.5).ceil().max(0.0) as usize;
            low..((at / side + reach + 0.5).floor().max(0.0) as usize).min(count)
        };
        let columns = range(at.x, grid.columns());
        let near = range(at.y, grid.rows()).flat_map(|row| {
            columns.clone().map(move |column| (row + RING) * self.stride + column + RING)
        });
        let joined = near.filter(|&area| self.slowness[area].is_finite()).filter_map(|area| {
            let point = self.point(area);
            let is_near = at.distance(point) <= reach * side;
            let cost = if is_near { self.quest.cost(at, point) } else { None }?;
            Some((area as u32, cost))
        });
        joined.collect()
    }

    fn seed(&mut self) {
        for (area, cost) in self.around(self.quest.start, SEEDED) {
            self.cost[area as usize] = cost;
            self.push(area, cost);
        }
    }

    /// The areas from which a straight leg leads to the goal, by number.
    fn ends(&self) -> Vec<(u32, f64)> {
        self.around(self.quest.goal, REACHED)
    }

    fn push(&mut self, area: u32, cost: f64) {
        let bucket = ((cost / self.width) as usize).max(self.now);
        let count = self.buckets.len();
        self.buckets[bucket % count].push(area);
        self.waiting += 1;
    }

    /// The next area in the order of costs below `limit`.
    fn next(&mut self, limit: f64) -> Option<u32> {
        let count = self.buckets.len();
        while self.waiting > 0 && self.now as f64 * self.width < limit {
            match self.buckets[self.now % count].pop() {
                Some(area) => {
                    self.waiting -= 1;
                    if !self.is_accepted[area as usize] {
                        return Some(area);
                    }
                }
                None => self.now += 1,
            }
        }
        None
    }

    fn accept(&mut self, area: usize) {
        self.is_accepted[area] = true;
        for next in [area - 1, area + 1, area - self.stride, area + self.stride] {
            if self.is_accepted[next] || self.slowness[next].is_infinite() {
                continue;
            }
            let cost = self.arriving(next);
            if cost < self.cost[next] {
                self.cost[next] = cost;
                self.push(next as u32, cost);
            }
        }
    }

    /// The cost of arriving in an area from its accepted neighbours.
    fn arriving(&self, area: usize) -> f64 {
        let slowness = self.slowness[area];
        let (x, y) = (self.upwind(area, 1), self.upwind(area, self.stride));
        let alone = |side: Option<Upwind>| {
            side.map_or(f64::INFINITY, |side| side.value + slowness / side.factor.sqrt())
        };
        let least = alone(x).min(alone(y));
        let (Some(x), Some(y)) = (x, y) else { return least };
        // factor_x (T - value_x)² + factor_y (T - value_y)² = slowness²
        let a = x.factor + y.factor;
        let half_b = x.factor * x.value + y.factor * y.value;
        let c = x.factor * x.value * x.value + y.factor * y.value * y.value - slowness * slowness;
        let root = half_b * half_b - a * c;
        if root < 0.0 {
            return least;
        }
        let cost = (half_b + root.sqrt()) / a;
        // Upwind: nothing arrives before what it comes from.
        if cost >= x.nearest.max(y.nearest) { cost } else { least }
    }

    fn upwind(&self, area: usize, step: usize) -> Option<Upwind> {
        let (low, high) = (area - step, area + step);
        let cost = |at: usize| if self.is_accepted[at] { self.cost[at] } else { f64::INFINITY };
        let (low_cost, high_cost) = (cost(low), cost(high));
        let nearest = low_cost.min(high_cost);
        if nearest.is_infinite() {
            return None;
        }
        let beyond = if low_cost <= high_cost { low - step } else { high + step };
        let second = if self.is_accepted[beyond] { self.cost[beyond] } else { f64::INFINITY };
        Some(if second <= nearest {
            Upwind { value: (4.0 * nearest - second) / 3.0, factor: 2.25, nearest }
        } else {
            Upwind { value: nearest, factor: 1.0, nearest }
        })
    }
}

/// One side of an area in the difference that stands for the slope.
#[derive(Clone, Copy)]
struct Upwind {
    value: f64,
    factor: f64,
    nearest: f64,
}

impl Arrival {
    /// The way back from the goal, the start not included: down the slope of the costs in half sides.
    pub(super) fn way_back(&self, quest: &Quest) -> Option<Vec<Point>> {
        let near = SEEDED * self.side;
        let mut way = vec![quest.goal, self.last];
        let mut at = self.last;
        let limit = 8 * self.cost.len().isqrt() + 100;
        while way.len() < limit {
            if at.distance(quest.start) <= near && quest.cost(quest.start, at).is_some() {
                return Some(way);
            }
            let (gx, gy) = self.slope(at)?;
            let steep = gx.hypot(gy);
            let by = 0.5 * self.side / steep;
            at = Point::new(at.x - by * gx, at.y - by * gy);
            at = quest.field.pushed_out(at, SPARE * self.side, ROUNDS);
            way.push(at);
        }
        None
    }

    /// As [`Self::way_back`], from area to area: crooked, but every step of it can be driven.
    pub(super) fn steps_back(&self, quest: &Quest) -> Option<Vec<Point>> {
        let near = SEEDED * self.side;
        let mut way = vec![quest.goal, self.last];
        let (mut at, mut point) = (self.area(self.last)?, self.last);
        loop {
            if point.distance(quest.start) <= near && quest.cost(quest.start, point).is_some() {
                return Some(way);
            }
            let s = self.stride;
            let around =
                [at - 1, at + 1, at - s, at + s, at - s - 1, at - s + 1, at + s - 1, at + s + 1];
            let drop =
                |next: usize, to: Point| (self.cost[at] - self.cost[next]) / point.distance(to);
            let next = around
                .into_iter()
                .filter(|&next| self.cost[next] < self.cost[at])
                .map(|next| (next, self.point(next)))
                .filter(|&(_, to)| quest.cost(point, to).is_some())
                .max_by(|&(a, p), &(b, q)| drop(a, p).total_cmp(&drop(b, q)));
            (at, point) = next?;
            way.push(point);
        }
    }

    fn point(&self, area: usize) -> Point {
        let (column, row) = (area % self.stride - RING, area / self.stride - RING);
        Point::new((column as f64 + 0.5) * self.side, (row as f64 + 0.5) * self.side)
    }

    fn area(&self, at: Point) -> Option<usize> {
        let (column, row) = (at.x / self.side, at.y / self.side);
        (column >= 0.0 && row >= 0.0)
            .then_some((row as usize + RING) * self.stride + column as usize + RING)
    }

    /// The slope of the costs at a point, from the areas around it that were reached.
    fn slope(&self, at: Point) -> Option<(f64, f64)> {
        let (x, y) = ((at.x / self.side - 0.5).max(0.0), (at.y / self.side - 0.5).max(0.0));
        let (column, row) = (x as usize, y as usize);
        let (u, v) = (x - column as f64, y - row as f64);
        let (mut weight, mut gx, mut gy) = (0.0, 0.0, 0.0);
        for (dx, dy) in [(0, 0), (1, 0), (0, 1), (1, 1)] {
            let area = (row + dy + RING) * self.stride + column + dx + RING;
            let share = |part: f64, is_far: usize| if is_far == 1 { part } else { 1.0 - part };
            let part = share(u, dx) * share(v, dy) + 1e-9;
            if self.cost.get(area).is_some_and(|cost| cost.is_finite()) {
                weight += part;
                gx += part * self.slope_along(area, 1);
                gy += part * self.slope_along(area, self.stride);
            }
        }
        let is_steep = weight > 0.0 && gx.hypot(gy) > 1e-12;
        is_steep.then(|| (gx / weight, gy / weight))
    }

    fn slope_along(&self, area: usize, step: usize) -> f64 {
        let (low, here, high) = (self.cost[area - step], self.cost[area], self.cost[area + step]);
        if low < here && low <= high {
            here - low
        } else if high < here {
            high - here
        } else {
            0.0
        }
    }
}
