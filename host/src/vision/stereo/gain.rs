//! What a raised box explains in two pictures at once.
//!
//! | what | gain per cell |
//! |---|---|
//! | a cell of its outline in one picture | what background costs there less what its face costs, half each |
//! | a cell of its outline in either picture | how much the pictures disagree there |
//! | a cell of its top | less what the two pictures of it differ |
//! | a cell beside an edge of its top or a visible foot | more where the picture has an edge there |
//!
//! A face has one colour. What a box found before explains counts neither way. Where one picture shows
//! the box and the other the floor behind it, they disagree as surely as the box does not look like floor:
//! the colours count as far as they do. Shadow and highlight of any shape are thereby no box.

use super::disagreement::stray;
use super::pair::Pair;
use super::raised::RaisedBox;
use crate::geometry::{Point, Rect, Side};
use crate::vision::appearance::Feature;
use crate::vision::boxes::{Face, LeaningBox};
use crate::vision::image::Raster;

/// How far a cell may be off its face's colour, and off the same place's in the other picture.
const FACE_SPREAD: Feature = [0.40, 0.16, 0.16];
const TOP_SPREAD: Feature = [0.22, 0.09, 0.09];
/// What the two pictures' colours count beside their disagreement, each; and the top's likeness.
const COLOUR_WEIGHT: f32 = 0.5;
const TOP_WEIGHT: f32 = 0.6;
/// Colours count less where hardly a cell can be judged, and agreement where there can be none costs.
const UNJUDGED: f32 = 2.0;
const ALIKE_CHARGE: f32 = 0.3;
/// How strongly both pictures together say how far one picture's colours count, cells.
const POOLED: f32 = 6.0;
/// A cell of another colour than its face costs at most this: faces may shine.
const MOST_STRANGE: f32 = 0.35;
/// A box gains at least what this many square metres of disagreement do, and disagrees on as much.
const LEAST_AREA: f64 = 0.0012;
/// Every cell of an outline costs a little.
const CELL_CHARGE: f32 = 0.05;
/// The outermost cells of an outline are blurred with what is around it.
const RIM: f64 = 1.0;
const RIM_CHARGE: f32 = 0.1;
/// How much a cell's length of a clear edge of the top counts, and how far from it is compared, cells.
const EDGE_WEIGHT: f32 = 0.8;
const EDGE_REACH: f64 = 1.3;
/// Edges that step by so many standard deviations of the floor are none, or clear.
const NO_EDGE: f32 = 0.7;
const CLEAR_EDGE: f32 = 3.0;
/// What a cell costs on which two boxes would stand.
const OVERLAP_CHARGE: f32 = 2.0;
/// A box is at least this wide and tall, metres.
const LEAST_SIDE: f64 = 0.025;
pub(crate) const LEAST_HEIGHT: f64 = 0.05;
pub(crate) const MOST_HEIGHT: f64 = 0.55;

/// What is already explained.
#[derive(Clone)]
pub(crate) struct Canvas<'a> {
    pair: &'a Pair,
    /// Which cells of each picture show a box.
    taken: [Raster<bool>; 2],
    /// The disagreement that is left.
    left: Raster<f32>,
    boxes: Vec<RaisedBox>,
}

impl<'a> Canvas<'a> {
    /// With these boxes explained.
    pub(crate) fn with(pair: &'a Pair, boxes: &[RaisedBox]) -> Self {
        let (width, height) = pair.frame.size();
        let taken = [Raster::filled(width, height, false), Raster::filled(width, height, false)];
        let mut canvas = Self { pair, taken, left: pair.disagreement.clone(), boxes: Vec::new() };
        boxes.iter().for_each(|&raised| canvas.explain(raised));
        canvas
    }

    /// Takes a box as found.
    pub(crate) fn explain(&mut self, raised: RaisedBox) {
        for eye in 0..2 {
            let view = self.pair.views[eye];
            let (taken, left) = (&mut self.taken[eye], &mut self.left);
            each_cell(self.pair, raised.seen(view), view.foot, |index, _, rim| {
                taken.cells_mut()[index] |= !rim;
                left.cells_mut()[index] = 0.0;
            });
        }
        self.boxes.push(raised);
    }

    /// What a box saves.
    pub(crate) fn gain(&self, raised: RaisedBox) -> f32 {
        if !self.possible(raised) {
            return f32::NEG_INFINITY;
        }
        let [first, second] = [0, 1].map(|eye| self.outline_gain(raised, eye));
        let disagreement = first.disagreement + second.disagreement;
        if disagreement < self.least_gain() {
            return f32::NEG_INFINITY;
        }
        let expected = first.expected() + second.expected();
        let pooled = (first.parted_disagrees + second.parted_disagrees) / (expected + UNJUDGED);
        let colours = first.shared_colours(pooled) + second.shared_colours(pooled);
        // Grain and grout have edges too: they only say where a box ends.
        let edges = self.edge_gain(raised).min(disagreement + colours.max(0.0));
        disagreement + colours + edges - self.top_cost(raised) - self.overlap_cost(raised)
    }

    /// The floor on which the pictures disagree and no box says why, square metres.
    pub(crate) fn unexplained(&self) -> f64 {
        let cells: f32 = self.left.cells().iter().sum();
        f64::from(cells) / (self.pair.frame.scale * self.pair.frame.scale)
    }

    /// What a box must gain.
    pub(crate) fn least_gain(&self) -> f32 {
        (LEAST_AREA * self.pair.frame.scale * self.pair.frame.scale) as f32
    }

    fn possible(&self, RaisedBox { base, height }: RaisedBox) -> bool {
        let (arena, slack) = (self.pair.frame.arena, 2.0 / self.pair.frame.scale);
        base.x0 > -slack
            && base.y0 > -slack
            && base.x1 < arena.width + slack
            && base.y1 < arena.height + slack
            && base.x1 - base.x0 >= LEAST_SIDE
            && base.y1 - base.y0 >= LEAST_SIDE
            && (LEAST_HEIGHT..=MOST_HEIGHT).contains(&height)
    }

    /// The part of the gain that comes from the outline in one picture.
    fn outline_gain(&self, raised: RaisedBox, eye: usize) -> OutlineGain {
        let pair = self.pair;
        let (view, other) = (pair.views[eye], pair.views[1 - eye]);
        let (seen, seen_there) = (raised.seen(view), raised.seen(other));
        let faces = self.face_colours(seen, eye);
        let (colours, background) = (pair.colours[eye].cells(), pair.background[eye].cells());
        let (weight, width) = (pair.weight[eye].cells(), pair.disagreement.width());
        let mut gain = OutlineGain::default();
        each_cell(pair, seen, view.foot, |index, face, rim| {
            let point = pair.frame.point((index % width) as f64, (index / width) as f64);
            let there = seen_there.face(point, other.foot).is_some();
            // A cell in both outlines is visited twice and counts once.
            let disagrees = self.left.cells()[index];
            gain.disagreement += if there { 0.5 * disagrees } else { disagrees };
            if self.taken[eye].cells()[index] {
                return;
            }
            gain.cells += weight[index];
            gain.foreign += weight[index] * background[index];
            let saved = if rim {
                0.5 * background[index] - RIM_CHARGE
            } else {
                let off = off(colours[index], faces[face as usize], FACE_SPREAD);
                (background[index] - off).max(-MOST_STRANGE)
            };
            gain.colours += COLOUR_WEIGHT * weight[index] * saved;
            gain.disagreement -= CELL_CHARGE * weight[index];
            if !there && !self.taken[1 - eye].cells()[index] && pair.judged.cells()[index] {
                gain.parted += weight[index];
                gain.parted_disagrees += weight[index] * pair.disagreement.cells()[index];
                gain.disagreement -=
                    ALIKE_CHARGE * weight[index] * (1.0 - pair.disagreement.cells()[index]);
            }
        });
        gain
    }

    /// The mean colour of each face; cells that are likely background hardly count.
    fn face_colours(&self, seen: LeaningBox, eye: usize) -> [Feature; 3] {
        let (pair, mut sums) = (self.pair, [([0f32; 3], 1e-6f32); 3]);
        each_cell(pair, seen, pair.views[eye].foot, |index, face, rim| {
            let taken = self.taken[eye].cells()[index];
            let likely = pair.background[eye].cells()[index] + pair.disagreement.cells()[index];
            let counts = (likely + 0.05) * if rim || taken { 0.02 } else { 1.0 };
            let (sum, total) = &mut sums[face as usize];
            *total += counts;
            for (sum, value) in sum.iter_mut().zip(pair.colours[eye].cells()[index]) {
                *sum += counts * value;
            }
        });
        sums.map(|(sum, total)| sum.map(|value| value / total))
    }

    /// How much the two pictures of the top differ.
    fn top_cost(&self, raised: RaisedBox) -> f32 {
        let pair = self.pair;
        let tops = [0, 1].map(|eye| (pair.views[eye].foot, raised.seen(pair.views[eye]).lean));
        let step = 1.0 / pair.frame.scale;
        let count = |length: f64| (length / step - 1.0).floor().max(1.0) as usize;
        let base = raised.base;
        let (columns, rows) = (count(base.x1 - base.x0), count(base.y1 - base.y0));
        let mut cost = 0.0;
        for row in 0..rows {
            for column in 0..columns {
                let along = |low: f64, high: f64, index: usize, of: usize| {
                    low + (high - low) * (index as f64 + 0.5) / of as f64
                };
                let x = along(base.x0, base.x1, column, columns);
                let y = along(base.y0, base.y1, row, rows);
                let shown = [0, 1].map(|eye| {
                    let (foot, lean) = tops[eye];
                    let at = Point::new(foot.x + lean * (x - foot.x), foot.y + lean * (y - foot.y));
                    self.untaken_colour(eye, at)
                });
                if let [Some(a), Some(b)] = shown {
                    let stray = stray(a, b);
                    cost += off(a, b, TOP_SPREAD.map(|spread| spread.hypot(6.0 * stray)));
                }
            }
        }
        TOP_WEIGHT * cost
    }

    /// The colour at a floor point of a picture, unless a box that was found is seen there.
    fn untaken_colour(&self, eye: usize, at: Point) -> Option<Feature> {
        let (column, row) = self.pair.frame.cell(at);
        let (x, y) = (column.floor() as i64, row.floor() as i64);
        if self.taken[eye].get(column.round() as i64, row.round() as i64)? {
            return None;
        }
        let (right, down) = ((column - x as f64) as f32, (row - y as f64) as f32);
        let corner = |i: i64, j: i64| self.pair.smooth[eye].get(x + i, y + j);
        let (a, b, c, d) = (corner(0, 0)?, corner(1, 0)?, corner(0, 1)?, corner(1, 1)?);
        Some([0, 1, 2].map(|part| {
            (1.0 - down) * ((1.0 - right) * a[part] + right * b[part])
                + down * ((1.0 - right) * c[part] + right * d[part])
        }))
    }

    /// What the edges of the top and the feet of visible sides count.
    fn edge_gain(&self, raised: RaisedBox) -> f32 {
        let mut clarity = 0.0;
        for (eye, view) in self.pair.views.into_iter().enumerate() {
            let seen = raised.seen(view);
            let top = seen.top(view.foot);
            for side in Side::EDGES {
                clarity += self.edge_clarity(top, side, eye);
                if seen.faces(side, view.foot) {
                    clarity += self.edge_clarity(seen.base, side, eye);
                }
            }
        }
        EDGE_WEIGHT * clarity
    }

    /// How clear an edge is, times its length in cells.
    fn edge_clarity(&self, top: Rect, side: Side, eye: usize) -> f32 {
        let cell = 1.0 / self.pair.frame.scale;
        let upright = side.is_upright();
        let (low, high) = if upright { (top.y0, top.y1) } else { (top.x0, top.x1) };
        let place = <[f64; 4]>::from(top)[side.edge()];
        let outward = side.outward() * EDGE_REACH * cell;
        let steps = ((high - low) / cell) as usize;
        let (mut sum, mut count) = ([0f32; 3], 0u16);
        for step in 1..steps {
            let along = low + step as f64 * cell;
            let at = |across: f64| {
                let point =
                    if upright { Point::new(across, along) } else { Point::new(along, across) };
                self.untaken_colour(eye, point)
            };
            if let (Some(inside), Some(outside)) = (at(place - outward), at(place + outward)) {
                count += 1;
                (0..3).for_each(|part| sum[part] += outside[part] - inside[part]);
            }
        }
        if count == 0 {
            return 0.0;
        }
        let mean = sum.map(|value| value / f32::from(count));
        let spread = self.pair.spreads[eye];
        let square: f32 = (0..3).map(|part| (mean[part] / spread[part]).powi(2)).sum();
        let clarity = ((square.sqrt() - NO_EDGE) / (CLEAR_EDGE - NO_EDGE)).clamp(0.0, 1.0);
        clarity * f32::from(count)
    }

    fn overlap_cost(&self, raised: RaisedBox) -> f32 {
        let shared = |other: &RaisedBox| overlap(raised.base, other.base);
        let area: f64 = self.boxes.iter().map(shared).sum();
        let scale = self.pair.frame.scale;
        OVERLAP_CHARGE * (area * scale * scale) as f32
    }
}

/// What an outline in one picture gains.
#[derive(Clone, Copy, Default)]
struct OutlineGain {
    colours: f32,
    /// By disagreement, less the charge for every cell.
    disagreement: f32,
    /// Cells that count, and how many of them do not look like floor.
    cells: f32,
    foreign: f32,
    /// Cells in this outline alone, and how many of them disagree.
    parted: f32,
    parted_disagrees: f32,
}

impl OutlineGain {
    /// How many cells should disagree if this is a raised box.
    fn expected(&self) -> f32 {
        self.parted * self.foreign / self.cells.max(1e-6)
    }

    /// The colours' gain as far as the pictures disagree where they should.
    fn shared_colours(&self, pooled: f32) -> f32 {
        let share = (self.parted_disagrees + POOLED * pooled) / (self.expected() + POOLED);
        self.colours * share.min(1.0)
    }
}

/// The area that two rectangles share, square metres.
pub(crate) fn overlap(a: Rect, b: Rect) -> f64 {
    let (width, height) = (a.x1.min(b.x1) - a.x0.max(b.x0), a.y1.min(b.y1) - a.y0.max(b.y0));
    width.max(0.0) * height.max(0.0)
}

/// How far a colour is off another, 0 to 1.
fn off(seen: Feature, colour: Feature, spread: Feature) -> f32 {
    let square: f32 = (0..3).map(|part| ((seen[part] - colour[part]) / spread[part]).powi(2)).sum();
    square.min(1.0)
}

/// Calls `visit` with every cell of a box's outline, its face and whether it is in the blurred rim.
fn each_cell(pair: &Pair, seen: LeaningBox, foot: Point, mut visit: impl FnMut(usize, Face, bool)) {
    let bounds = seen.bounds(foot);
    let (left, upper) = pair.frame.cell(Point::new(bounds.x0, bounds.y1));
    let (right, lower) = pair.frame.cell(Point::new(bounds.x1, bounds.y0));
    let (width, height) = pair.frame.size();
    let first = |edge: f64| edge.ceil().max(0.0) as usize;
    let after = |edge: f64, length: usize| ((edge.floor() + 1.0).max(0.0) as usize).min(length);
    for row in first(upper)..after(lower, height) {
        for column in first(left)..after(right, width) {
            let (x, y) = (column as f64, row as f64);
            if let Some(face) = seen.face(pair.frame.point(x, y), foot) {
                let depth = (x - left).min(right - x).min(y - upper).min(lower - y);
                visit(row * width + column, face, depth < RIM);
            }
        }
    }
}
