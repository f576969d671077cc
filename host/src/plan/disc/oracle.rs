//! A slow, obvious shortest path among polygons to test the fast one against.
//!
//! It shares nothing with the planner. A leg is judged piece by piece: it is cut wherever it meets a
//! line through an edge, each piece has a place in its middle, and a way may pass there if a point just
//! to its left or just to its right lies in no polygon and inside the arena; where it turns, the floor on
//! one side of the corner must be free all the way. All of that is done in exact fractions; only lengths
//! are floats. Dijkstra's algorithm runs over the legs between all corners.

use std::cmp::Ordering;

/// A whole number of halves, thirds and so on: numerator and positive denominator.
#[derive(Clone, Copy, Debug)]
struct Fraction(i128, i128);

impl Fraction {
    fn new(numerator: i128, denominator: i128) -> Self {
        if denominator < 0 { Self(-numerator, -denominator) } else { Self(numerator, denominator) }
    }

    fn compare(self, other: Self) -> Ordering {
        (self.0 * other.1).cmp(&(other.0 * self.1))
    }

    fn middle(self, other: Self) -> Self {
        Self(self.0 * other.1 + other.0 * self.1, 2 * self.1 * other.1)
    }
}

type At = (i128, i128);

/// Polygons with small whole coordinates in a square arena from the origin.
pub(super) struct Oracle {
    pub(super) size: i128,
    /// Counter-clockwise.
    pub(super) polygons: Vec<Vec<At>>,
}

impl Oracle {
    /// The length of the shortest way; `None` if there is none.
    pub(super) fn shortest(&self, start: At, goal: At) -> Option<f64> {
        let mut points = vec![start, goal];
        points.extend(self.polygons.iter().flatten());
        let within = |p: &At| (0..=self.size).contains(&p.0) && (0..=self.size).contains(&p.1);
        points.retain(within);
        // What has been reached is a leg: whether the way may go on depends on where it comes from.
        let count = points.len();
        let sees: Vec<bool> = (0..count * count)
            .map(|pair| {
                pair / count != pair % count
                    && self.sees(points[pair / count], points[pair % count])
            })
            .collect();
        let mut length = vec![f64::INFINITY; count * count];
        let mut done = vec![false; count * count];
        // The leg from the start to itself.
        length[0] = 0.0;
        loop {
            let open = (0..count * count).filter(|&leg| !done[leg] && length[leg].is_finite());
            let leg = open.min_by(|&a, &b| length[a].total_cmp(&length[b]))?;
            let (from, at) = (leg / count, leg % count);
            if at == 1 {
                return Some(length[leg]);
            }
            done[leg] = true;
            for next in (0..count).filter(|&next| sees[at * count + next]) {
                let (a, b) = (points[at], points[next]);
                let through =
                    length[leg] + (((b.0 - a.0).pow(2) + (b.1 - a.1).pow(2)) as f64).sqrt();
                let turns = || from == at || self.turns_freely(points[from], a, b);
                let known = at * count + next;
                if !done[known] && through < length[known] && turns() {
                    length[known] = through;
                }
            }
        }
    }

    /// Whether a way from `a` over `b` to `c` gets round `b` through free floor, on one side of it.
    fn turns_freely(&self, a: At, b: At, c: At) -> bool {
        let [back, on] = [a, c].map(|p| (p.0 - b.0, p.1 - b.1));
        // Between two neighbouring ones of these directions the floor does not change; they are no more
        // than a quarter turn apart, so that their sum lies between them.
        let mut directions = vec![back, on, (1, 0), (0, 1), (-1, 0), (0, -1)];
        for (p, q) in self.polygons.iter().flat_map(|polygon| edges(polygon)) {
            let touches = (q.0 - p.0) * (b.1 - p.1) == (q.1 - p.1) * (b.0 - p.0)
                && (p.0 - b.0) * (q.0 - b.0) + (p.1 - b.1) * (q.1 - b.1) <= 0;
            if touches {
                directions.extend([p, q].map(|p| (p.0 - b.0, p.1 - b.1)));
            }
        }
        directions.retain(|&direction| direction != (0, 0));
        let is_free = |from: At, to: At| self.is_free_around(b, from, to, &directions);
        is_free(back, on) || is_free(on, back)
    }

    /// Whether the floor around `at` is free from one direction counter-clockwise to the other.
    fn is_free_around(&self, at: At, from: At, to: At, directions: &[At]) -> bool {
        let cross = |p: At, q: At| p.0 * q.1 - p.1 * q.0;
        let dot = |p: At, q: At| p.0 * q.0 + p.1 * q.1;
        // The part of a turn from `from` to a direction, as a half and its order within the half.
        let is_same = |p: At, q: At| cross(p, q) == 0 && dot(p, q) > 0;
        let half =
            |p: At| u8::from(cross(from, p) < 0 || (cross(from, p) == 0 && dot(from, p) < 0));
        let by_turn = |p: &At, q: &At| half(*p).cmp(&half(*q)).then_with(|| 0.cmp(&cross(*p, *q)));
        if is_same(from, to) {
            return true;
        }
        let mut between: Vec<At> = directions.to_vec();
        between.sort_by(by_turn);
        between.dedup_by(|p, q| is_same(*p, *q));
        let end = between.iter().position(|&p| is_same(p, to)).unwrap_or(0);
        between[..=end]
            .windows(2)
            .all(|pair| self.is_free_beside(at, (pair[0].0 + pair[1].0, pair[0].1 + pair[1].1)))
    }

    /// Whether the floor just beside `at` in that direction is free.
    fn is_free_beside(&self, at: At, direction: At) -> bool {
        const TINY: i128 = 1 << 24;
        let (x, y) = (at.0 * TINY + direction.0, at.1 * TINY + direction.1);
        let limit = self.size * TINY;
        let within = 0 < x && x < limit && 0 < y && y < limit;
        within && !self.polygons.iter().any(|polygon| strictly_inside(polygon, (x, y, TINY)))
    }

    /// Whether the point is inside no polygon; one on an edge is not inside.
    pub(super) fn is_free(&self, point: At) -> bool {
        let scaled = (point.0, point.1, 1);
        !self.polygons.iter().any(|polygon| strictly_inside(polygon, scaled))
    }

    /// Whether a way leads straight from `a` to `b`: between the places where something changes, either
    /// side of it is free floor; the same where two shapes meet in a corner on it.
    fn sees(&self, a: At, b: At) -> bool {
        if a == b {
            return false;
        }
        let mut cuts = vec![Fraction(0, 1), Fraction(1, 1)];
        for (p, q) in self.polygons.iter().flat_map(|polygon| edges(polygon)) {
            let (u, w) = ((b.0 - a.0, b.1 - a.1), (q.0 - p.0, q.1 - p.1));
            let crossing = u.0 * w.1 - u.1 * w.0;
            if crossing != 0 {
                let along = (p.0 - a.0) * w.1 - (p.1 - a.1) * w.0;
                cuts.push(Fraction::new(along, crossing));
            }
            for end in [p, q] {
                let along = (end.0 - a.0) * u.0 + (end.1 - a.1) * u.1;
                cuts.push(Fraction::new(along, u.0 * u.0 + u.1 * u.1));
            }
        }
        cuts.retain(|cut| cut.0 >= 0 && cut.0 <= cut.1);
        cuts.sort_by(|p, q| p.compare(*q));
        cuts.dedup_by(|p, q| p.compare(*q) == Ordering::Equal);
        let sides: Vec<[bool; 2]> =
            cuts.windows(2).map(|pair| self.free_sides(a, b, pair[0].middle(pair[1]))).collect();
        // Where the free side changes, the way would pass through a gap of no width.
        let passes = |place: usize| {
            let touched = self.touched_sides(a, b, cuts[place + 1]);
            (0..2).any(|side| sides[place][side] && sides[place + 1][side] && !touched[side])
        };
        sides.iter().all(|side| side[0] || side[1]) && (0..sides.len() - 1).all(passes)
    }

    /// Whether a corner that lies `part` of the way along reaches there from the left and from the right.
    fn touched_sides(&self, a: At, b: At, part: Fraction) -> [bool; 2] {
        let u = (b.0 - a.0, b.1 - a.1);
        let is_here =
            |p: At| (p.0 - a.0) * part.1 == u.0 * part.0 && (p.1 - a.1) * part.1 == u.1 * part.0;
        let mut touched = [false; 2];
        for (p, q) in self.polygons.iter().flat_map(|polygon| edges(polygon)) {
            for (here, there) in [(p, q), (q, p)].into_iter().filter(|(here, _)| is_here(*here)) {
                let side = u.0 * (there.1 - here.1) - u.1 * (there.0 - here.0);
                touched[0] |= side > 0;
                touched[1] |= side < 0;
            }
        }
        touched
    }

    /// Whether points just to the left and to the right of the place `part` of the way along are free.
    fn free_sides(&self, a: At, b: At, part: Fraction) -> [bool; 2] {
        // Far below any distance between different places on so small a lattice.
        const TINY: i128 = 1 << 24;
        let u = (b.0 - a.0, b.1 - a.1);
        [1, -1].map(|side| {
            let scale = part.1 * TINY;
            let x = a.0 * scale + u.0 * part.0 * TINY - side * u.1 * part.1;
            let y = a.1 * scale + u.1 * part.0 * TINY + side * u.0 * part.1;
            let limit = self.size * scale;
            let within = 0 < x && x < limit && 0 < y && y < limit;
            within && !self.polygons.iter().any(|polygon| strictly_inside(polygon, (x, y, scale)))
        })
    }
}

fn edges(polygon: &[At]) -> impl Iterator<Item = (At, At)> {
    polygon.iter().copied().zip(polygon.iter().copied().cycle().skip(1))
}

/// Whether the point (x / s, y / s) lies inside and not on the edge.
fn strictly_inside(polygon: &[At], (x, y, s): (i128, i128, i128)) -> bool {
    let mut is_inside = false;
    for (a, b) in edges(polygon) {
        let side = (b.0 - a.0) * (y - a.1 * s) - (b.1 - a.1) * (x - a.0 * s);
        let between = |p: i128, q: i128, v: i128| p.min(q) * s <= v && v <= p.max(q) * s;
        if side == 0 && between(a.0, b.0, x) && between(a.1, b.1, y) {
            return false;
        }
        if (a.1 * s > y) != (b.1 * s > y) && (side > 0) == (b.1 > a.1) {
            is_inside = !is_inside;
        }
    }
    is_inside
}
