//! Roads for many queries: the taut lines between corners, drawn once and kept.
//!
//! A shortest way is straight from corner to corner, and at each it bends around the box that stands
//! there. So of all lines between corners that see each other only those matter that touch the box at
//! either end without entering it on either side; of these a few leave each corner, however large the
//! arena. They are found by the cones of the search when a query first comes to the corner, and stay.
//! A query looks around from its two ends and then runs A* over corners: no cone is cut twice.
//!
//! Why not larger pieces: merging the cells into larger convex ones, the usual cure, halves the cones of a
//! search. Roads leave none but those around the two ends, on the same mesh.
//!
//! At a corner whose box fills the quadrant with the signs (sx, sy), a taut line runs in the sector
//! between (sx, 0) and (0, −sy) or in that between (0, sy) and (−sx, 0): along the box's horizontal or
//! its vertical edge at the one end, straight away from it at the other. A way that comes in one sector
//! leaves in the same, turned towards the box's edge or not at all. Lattice units.

use super::mesh::Mesh;
use super::search::straighten;
use super::sight::{Outlook, Sight};
use super::view::{Ray, cross, ray};
use crate::grid::{LatticePoint, LatticeRect};
use std::cmp::Reverse;
use std::collections::BinaryHeap;

/// The number of the start among the corners.
const START: u32 = u32::MAX;

/// Lines to keep per corner, on average; more are forgotten and drawn again when needed.
const LINES_PER_CORNER: usize = 24;

/// Lines that may be kept in any case.
const FEW_LINES: usize = 1 << 16;

/// A corner at which a way can turn.
#[derive(Clone, Copy, Debug)]
struct Corner {
    at: LatticePoint,
    /// The signs of x and y of the quadrant that the box fills.
    filled: (i32, i32),
    /// The two pieces that meet here.
    pieces: [u32; 2],
}

/// The two sectors of a corner in which taut lines run.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Sector {
    /// From along the box's horizontal edge to straight away from it.
    Horizontal,
    /// From along the box's vertical edge to straight away from it.
    Vertical,
}

impl Corner {
    /// The sector of a taut `direction`; `None` if a way in this direction does not bend around the box.
    fn sector(&self, direction: Ray) -> Option<Sector> {
        let along = (self.filled.0 * direction.0.signum(), self.filled.1 * direction.1.signum());
        match along {
            (0 | 1, -1) | (1, 0) => Some(Sector::Horizontal),
            (-1 | 0, 1) | (-1, 0) => Some(Sector::Vertical),
            _ => None,
        }
    }

    /// Positive if in this sector `b` is turned further from the box's edge than `a`.
    fn turned(&self, sector: Sector, a: Ray, b: Ray) -> i64 {
        let sign = i64::from(self.filled.0 * self.filled.1);
        match sector {
            Sector::Horizontal => -sign * cross(a, b),
            Sector::Vertical => sign * cross(a, b),
        }
    }

    /// Whether a way that comes with `arrival`, of this `sector`, may leave in the direction `leaving`.
    fn is_taut(&self, sector: Sector, arrival: Ray, leaving: Ray) -> bool {
        self.sector(leaving) == Some(sector) && self.turned(sector, leaving, arrival) >= 0
    }
}

/// A taut line from one corner to another.
#[derive(Clone, Copy, Debug)]
struct Line {
    step: Ray,
    to: u32,
}

/// The lines of one corner: those of the horizontal sector, then those of the vertical one, each sorted
/// from the box's edge outwards.
#[derive(Clone, Copy, Debug)]
struct Span {
    first: u32,
    middle: u32,
    end: u32,
}

/// The lines of this corner are not drawn yet.
const UNDRAWN: Span = Span { first: u32::MAX, middle: 0, end: 0 };

/// What a query knows of a corner.
#[derive(Clone, Copy, Debug, Default)]
struct Mark {
    /// The length of the best way known.
    length: f64,
    /// The corner before, or [`START`].
    parent: u32,
    /// The query that came here, that settled the way, and whose goal is in sight.
    reached: u32,
    settled: u32,
    sees_goal: u32,
}

/// The roads of one mesh.
#[derive(Clone, Debug, Default)]
pub(super) struct Roads {
    corners: Vec<Corner>,
    spans: Vec<Span>,
    lines: Vec<Line>,
    marks: Vec<Mark>,
    query: u32,
    /// Corners by the least length of a way over them, the least first.
    queue: BinaryHeap<Reverse<(u64, u32)>>,
    sight: Sight,
    /// The lines of one corner while they are sorted.
    drawn: Vec<(Sector, Line)>,
}

/// One end of a way and the pieces that hold it, edges included.
pub(super) type Place<'a> = (LatticePoint, &'a [u32]);

impl Roads {
    /// Roads on `mesh`, whose pieces are `cells`; none is drawn yet.
    pub(super) fn new(mesh: &Mesh, cells: &[LatticeRect]) -> Self {
        let nowhere = Corner { at: LatticePoint::new(0, 0), filled: (1, 1), pieces: [0; 2] };
        let mut corners = vec![nowhere; mesh.corners];
        for (piece, cell) in cells.iter().enumerate() {
            for portal in mesh.portals(piece as u32) {
                let pieces = [piece as u32, portal.beyond];
                for end in [portal.right, portal.left].into_iter().filter(|end| end.has_corner()) {
                    // The piece that ends where the portal does has the box beside it.
                    let above = if end.at.y == cell.y0 {
                        -1
                    } else if end.at.y == cell.y1 {
                        1
                    } else {
                        continue;
                    };
                    let beside = if end.at.x == cell.x1 { -1 } else { 1 };
                    corners[end.corner as usize] =
                        Corner { at: end.at, filled: (beside, above), pieces };
                }
            }
        }
        let (spans, marks) = (vec![UNDRAWN; mesh.corners], vec![Mark::default(); mesh.corners]);
        Self { corners, spans, marks, ..Self::default() }
    }

    /// The points of the shortest way, start and goal included; `None` if there is no way.
    pub(super) fn shortest(
        &mut self,
        mesh: &Mesh,
        start: Place,
        goal: Place,
    ) -> Option<Vec<LatticePoint>> {
        let ends = [start.0, goal.0];
        if start.1.iter().any(|piece| goal.1.contains(piece)) {
            return Some(ends.to_vec());
        }
        self.begin();
        if self.look_from_goal(mesh, start, goal) {
            return Some(ends.to_vec());
        }
        self.look_from_start(mesh, start, goal.0);
        let last = self.run(mesh, start.0, goal.0)?;
        Some(self.trace(ends, last))
    }

    fn begin(&mut self) {
        self.query = self.query.wrapping_add(1);
        if self.query == 0 {
            self.marks.fill(Mark::default());
            self.query = 1;
        }
        self.queue.clear();
    }

    /// Marks the corners from which a taut line leads to the goal; returns whether the start sees it.
    fn look_from_goal(&mut self, mesh: &Mesh, start: Place, goal: Place) -> bool {
        let outlook = Outlook { from: goal.0, pieces: goal.1, but: None };
        if self.sight.look(mesh, &outlook, Some(start)) {
            return true;
        }
        for end in &self.sight.corners {
            if self.corners[end.corner as usize].sector(ray(end.at, goal.0)).is_some() {
                self.marks[end.corner as usize].sees_goal = self.query;
            }
        }
        false
    }

    /// Reaches the corners to which a taut line leads from the start.
    fn look_from_start(&mut self, mesh: &Mesh, start: Place, goal: LatticePoint) {
        let outlook = Outlook { from: start.0, pieces: start.1, but: None };
        self.sight.look(mesh, &outlook, None);
        for index in 0..self.sight.corners.len() {
            let end = self.sight.corners[index];
            if self.corners[end.corner as usize].sector(ray(start.0, end.at)).is_some() {
                let length = start.0.distance(end.at);
                self.reach(end.corner, length, START, end.at.distance(goal));
            }
        }
    }

    fn reach(&mut self, corner: u32, length: f64, parent: u32, rest: f64) {
        let mark = &mut self.marks[corner as usize];
        if mark.reached != self.query || length < mark.length {
            (mark.length, mark.parent, mark.reached) = (length, parent, self.query);
            // The bits of floats that are not negative are in the floats' order.
            self.queue.push(Reverse(((length + rest).to_bits(), corner)));
        }
    }

    /// Follows the roads, most promising corner first; the last corner of the shortest way.
    fn run(&mut self, mesh: &Mesh, start: LatticePoint, goal: LatticePoint) -> Option<u32> {
        let mut best: Option<(f64, u32)> = None;
        while let Some(Reverse((least, number))) = self.queue.pop() {
            if best.is_some_and(|(length, _)| length <= f64::from_bits(least)) {
                break;
            }
            let index = number as usize;
            let mark = &mut self.marks[index];
            if mark.settled == self.query {
                continue;
            }
            mark.settled = self.query;
            let (length, corner) = (mark.length, self.corners[index]);
            let before = self.corners.get(mark.parent as usize).map_or(start, |corner| corner.at);
            let arrival = ray(before, corner.at);
            let Some(sector) = corner.sector(arrival) else { continue };
            if mark.sees_goal == self.query && corner.is_taut(sector, arrival, ray(corner.at, goal))
            {
                let whole = length + corner.at.distance(goal);
                if best.is_none_or(|(length, _)| whole < length) {
                    best = Some((whole, number));
                }
            }
            for line in self.lines_of(mesh, index, sector) {
                let Line { step, to } = self.lines[line];
                if corner.turned(sector, step, arrival) < 0 {
                    break;
                }
                if self.marks[to as usize].settled == self.query {
                    continue;
                }
                let at = LatticePoint::new(corner.at.x + step.0, corner.at.y + step.1);
                self.reach(to, length + norm(step), number, at.distance(goal));
            }
        }
        best.map(|(_, corner)| corner)
    }

    /// The places of the lines of a corner in one sector, drawn now if they were not.
    fn lines_of(&mut self, mesh: &Mesh, corner: usize, sector: Sector) -> std::ops::Range<usize> {
        if self.spans[corner].first == UNDRAWN.first {
            self.draw(mesh, corner);
        }
        let Span { first, middle, end } = self.spans[corner];
        match sector {
            Sector::Horizontal => first as usize..middle as usize,
            Sector::Vertical => middle as usize..end as usize,
        }
    }

    fn draw(&mut self, mesh: &Mesh, number: usize) {
        if self.lines.len() > LINES_PER_CORNER * self.corners.len() + FEW_LINES {
            self.lines.clear();
            self.spans.fill(UNDRAWN);
        }
        let corner = self.corners[number];
        let away = (-corner.filled.0, -corner.filled.1);
        let outlook = Outlook { from: corner.at, pieces: &corner.pieces, but: Some(away) };
        self.sight.look(mesh, &outlook, None);
        self.drawn.clear();
        for end in &self.sight.corners {
            let step = ray(corner.at, end.at);
            let is_taut_there = self.corners[end.corner as usize].sector(step).is_some();
            if let Some(sector) = corner.sector(step).filter(|_| is_taut_there) {
                self.drawn.push((sector, Line { step, to: end.corner }));
            }
        }
        self.drawn.sort_unstable_by(|(s, a), (t, b)| {
            let is_later = |sector: &Sector| *sector == Sector::Vertical;
            let by_angle = || 0.cmp(&corner.turned(*s, a.step, b.step));
            is_later(s).cmp(&is_later(t)).then_with(by_angle).then(a.to.cmp(&b.to))
        });
        self.drawn.dedup_by_key(|(_, line)| line.to);
        let middle = self.drawn.partition_point(|(sector, _)| *sector == Sector::Horizontal);
        let first = self.lines.len();
        self.lines.extend(self.drawn.iter().map(|(_, line)| *line));
        let at = |place: usize| (first + place) as u32;
        self.spans[number] = Span { first: at(0), middle: at(middle), end: at(self.drawn.len()) };
    }

    /// The way back from the goal over the corner `last` to the start.
    fn trace(&self, [start, goal]: [LatticePoint; 2], last: u32) -> Vec<LatticePoint> {
        let mut points = vec![goal];
        let mut corner = last;
        while corner != START {
            points.push(self.corners[corner as usize].at);
            corner = self.marks[corner as usize].parent;
        }
        points.push(start);
        points.reverse();
        straighten(&mut points);
        points
    }
}

fn norm((x, y): Ray) -> f64 {
    let (x, y) = (f64::from(x), f64::from(y));
    (x * x + y * y).sqrt()
}
