//! A slow, obvious shortest path to test the fast one against: a visibility graph over unit squares.
//!
//! It shares nothing with the planner: the boxes are painted into unit squares, a leg is judged by
//! the squares along it, and Dijkstra's algorithm runs over all corners that see each other.

use crate::grid::{EnlargedArena, LatticePoint};

/// The painted arena; coordinates are small.
pub(super) struct Oracle {
    size: i32,
    blocked: Vec<bool>,
    corners: Vec<(i32, i32)>,
}

impl Oracle {
    pub(super) fn new(arena: &EnlargedArena) -> Self {
        let size = arena.inside.x1.max(arena.inside.y1);
        let mut oracle =
            Self { size, blocked: vec![false; (size * size) as usize], corners: vec![] };
        for x in 0..size {
            for y in 0..size {
                let covers =
                    |r: &crate::grid::LatticeRect| r.x0 <= x && x < r.x1 && r.y0 <= y && y < r.y1;
                oracle.blocked[(y * size + x) as usize] =
                    !covers(&arena.inside) || arena.boxes.iter().any(covers);
            }
        }
        // A way turns at convex corners of obstacles: exactly one of four squares is blocked.
        for x in 0..=size {
            for y in 0..=size {
                if oracle.around(x, y).iter().filter(|&&blocked| blocked).count() == 1 {
                    oracle.corners.push((x, y));
                }
            }
        }
        oracle
    }

    fn is_blocked(&self, x: i32, y: i32) -> bool {
        let within = 0 <= x && x < self.size && 0 <= y && y < self.size;
        !within || self.blocked[(y * self.size + x) as usize]
    }

    /// The squares around a lattice point, counter-clockwise from the upper right.
    fn around(&self, x: i32, y: i32) -> [bool; 4] {
        [(x, y), (x - 1, y), (x - 1, y - 1), (x, y - 1)].map(|(x, y)| self.is_blocked(x, y))
    }

    /// Whether the way from `a` to `b` touches blocked squares on one side at a time only.
    fn sees(&self, a: (i32, i32), b: (i32, i32)) -> bool {
        let (dx, dy) = (b.0 - a.0, b.1 - a.1);
        let steps = gcd(dx.abs(), dy.abs());
        if dx == 0 || dy == 0 {
            return self.sees_along(a, (dx.signum(), dy.signum()), steps);
        }
        // No blocked square may have the line strictly inside.
        for x in a.0.min(b.0)..a.0.max(b.0) {
            for y in a.1.min(b.1)..a.1.max(b.1) {
                let side = |px: i32, py: i32| dx * (py - a.1) - dy * (px - a.0);
                let sides = [side(x, y), side(x + 1, y), side(x, y + 1), side(x + 1, y + 1)];
                let cut = sides.iter().any(|&s| s > 0) && sides.iter().any(|&s| s < 0);
                if cut && self.is_blocked(x, y) {
                    return false;
                }
            }
        }
        // Where it passes a lattice point, one of the squares beside it must be free.
        (1..steps).all(|i| {
            let around = self.around(a.0 + dx / steps * i, a.1 + dy / steps * i);
            let beside =
                if (dx > 0) == (dy > 0) { [around[1], around[3]] } else { [around[0], around[2]] };
            beside != [true, true]
        })
    }

    fn sees_along(&self, a: (i32, i32), (dx, dy): (i32, i32), steps: i32) -> bool {
        // The squares left and right of each unit step.
        let sides = |i: i32| {
            let (x, y) = (a.0 + dx * i, a.1 + dy * i);
            match (dx, dy) {
                (1, 0) => (self.is_blocked(x, y), self.is_blocked(x, y - 1)),
                (-1, 0) => (self.is_blocked(x - 1, y - 1), self.is_blocked(x - 1, y)),
                (0, 1) => (self.is_blocked(x - 1, y), self.is_blocked(x, y)),
                _ => (self.is_blocked(x, y - 1), self.is_blocked(x - 1, y - 1)),
            }
        };
        let free = (0..steps).all(|i| sides(i) != (true, true));
        let pinch = |i: i32| {
            let (before, after) = (sides(i - 1), sides(i));
            (before.0 && after.1) || (before.1 && after.0)
        };
        free && !(1..steps).any(pinch)
    }

    /// The length of the shortest way, units; `None` if there is none.
    pub(super) fn shortest(&self, start: LatticePoint, goal: LatticePoint) -> Option<f64> {
        let mut points = vec![(start.x, start.y), (goal.x, goal.y)];
        points.extend(&self.corners);
        let mut length = vec![f64::INFINITY; points.len()];
        let mut done = vec![false; points.len()];
        length[0] = 0.0;
        loop {
            let open = (0..points.len()).filter(|&i| !done[i] && length[i].is_finite());
            let at = open.min_by(|&a, &b| length[a].total_cmp(&length[b]))?;
            if at == 1 {
                return Some(length[1]);
            }
            done[at] = true;
            for next in 0..points.len() {
                let (a, b) = (points[at], points[next]);
                let step = f64::from((b.0 - a.0).pow(2) + (b.1 - a.1).pow(2)).sqrt();
                if !done[next] && length[at] + step < length[next] && self.sees(a, b) {
                    length[next] = length[at] + step;
                }
            }
        }
    }
}

fn gcd(a: i32, b: i32) -> i32 {
    if b == 0 { a } else { gcd(b, a % b) }
}
