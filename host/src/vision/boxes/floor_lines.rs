//! Lines on the floor: a printed grid, seams, and the folds of a sheet, of which only pieces stand out.
//!
//! What is printed runs from one side of the arena to the other. So does a fold, bright here, dark there and
//! hardly seen between. A wall looks alike all along and ends. So the line that a thin piece is part of is followed
//! through the whole arena: along it the brightness differs from that on both sides more than it does along lines
//! nearby, either almost everywhere or faintly for much of the way. A thin wall from side to side looks like
//! such a line, which the answer says.
//!
//! ```text
//! thin pieces ─► the path of most contrast from side to side ─► how far is it seen? ─► no obstacle
//! ```
//! Brightness is a natural logarithm; metres in the arena frame, paths in cells of the plan view.

use super::shade::widened;
use crate::vision::appearance::{FOREIGN, Look, median};
use crate::vision::image::{CellRect, Raster, around, regions};

/// Lines on a floor are no wider than this, metres.
pub(super) const LINE_WIDTH: f64 = 0.012;
/// A piece runs straight on for so many cells at least.
const LEAST_PIECE: usize = 6;
/// So many lines are looked at, those of the longest pieces.
const MOST_LINES: usize = 48;
/// A line stays within this of where its piece is, metres.
const WANDER: f64 = 0.012;
/// Brightness on a line is compared with that at this distance on both sides, metres.
const BESIDE: f64 = 0.010;
/// More contrast does not draw the path more; a step to the side costs a little.
const MOST_DRAWN: f32 = 0.15;
const STEP_COST: f32 = 0.02;
/// The contrast along a line is averaged over such lengths, metres.
const BLOCK: f64 = 0.03;
/// A line is seen where it has this many times the usual contrast of paths nearby, and at least so much.
const CLEARER: f32 = 1.5;
const LEAST_CONTRAST: f32 = 0.008;
/// A printed line is seen along this share of the floor that it crosses, a fold along so much; along so much of it
/// the fold is seen faintly, with less than half of its greatest contrast.
const PRINT_SEEN: f64 = 0.94;
const FOLD_SEEN: f64 = 0.5;
const FOLD_FAINT: f64 = 0.2;
/// It is seen within this share of its length from both ends.
const END_SHARE: f64 = 0.2;
/// The contrast that counts as the greatest: one in so many blocks may have more.
const PEAK_SHARE: usize = 10;

/// The cells of lines on the floor.
pub(super) struct FloorLines {
    cells: Vec<usize>,
}

impl FloorLines {
    /// The lines in a look of which pieces differ from the floor, by how far each cell does.
    pub(super) fn of(look: &Look, distances: &Raster<f32>) -> Self {
        let foreign = distances.map(|distance| distance > FOREIGN);
        let mut thin = without(&foreign, &thick(&foreign, look.view.scale));
        let width = foreign.width();
        let mut pieces: Vec<Piece> = [true, false]
            .into_iter()
            .flat_map(|is_upright| pieces(&thin, is_upright, look.view.scale))
            .collect();
        pieces.sort_by_key(|piece| std::cmp::Reverse(piece.cells.len()));
        let hidden = widened(&without(&foreign, &thin), reach(BESIDE, look.view.scale) as i64);
        let mut lines = Self { cells: Vec::new() };
        let mut looked_at = 0;
        for Piece { cells, is_upright } in pieces {
            // A piece of a line that was found from another one is gone.
            if 2 * cells.iter().filter(|&&cell| thin.cells()[cell]).count() < cells.len() {
                continue;
            }
            if looked_at == MOST_LINES {
                break;
            }
            looked_at += 1;
            let ground = Ground { look, hidden: &hidden, is_upright };
            if let Some(path) = ground.line_through(around(&cells, width)) {
                let of_line: Vec<usize> =
                    ground.cells(&path).filter(|&cell| thin.cells()[cell]).collect();
                of_line.iter().for_each(|&cell| thin.cells_mut()[cell] = false);
                lines.cells.extend(of_line);
            }
        }
        lines
    }

    /// Whether there is any.
    pub(super) fn any(&self) -> bool {
        !self.cells.is_empty()
    }

    /// Distances with 0 for the cells of lines.
    pub(super) fn without(&self, mut distances: Raster<f32>) -> Raster<f32> {
        self.cells.iter().for_each(|&cell| distances.cells_mut()[cell] = 0.0);
        distances
    }
}

/// The cells of patches that are thicker than lines on a floor, with `scale` cells a metre.
pub(super) fn thick(mask: &Raster<bool>, scale: f64) -> Raster<bool> {
    let reach = (LINE_WIDTH * scale / 2.0).ceil().max(1.0) as i64;
    let thin = widened(&mask.map(|marked| !marked), reach);
    let kept = widened(&thin.map(|thin| !thin), reach + 1);
    both(mask, &kept, |marked, kept| marked && kept)
}

fn without(mask: &Raster<bool>, other: &Raster<bool>) -> Raster<bool> {
    both(mask, other, |marked, other| marked && !other)
}

fn both(a: &Raster<bool>, b: &Raster<bool>, of: fn(bool, bool) -> bool) -> Raster<bool> {
    let cells = a.cells().iter().zip(b.cells()).map(|(&a, &b)| of(a, b));
    Raster::from_cells(a.width(), cells.collect())
}

/// Cells that lie along a line.
struct Piece {
    cells: Vec<usize>,
    /// Whether the line runs across the rows.
    is_upright: bool,
}

/// The pieces of a mask in one direction: cells that have enough others before and after them.
fn pieces(mask: &Raster<bool>, is_upright: bool, scale: f64) -> Vec<Piece> {
    let least = LEAST_PIECE.max((LINE_WIDTH * scale) as usize + 1);
    let (width, height) = (mask.width(), mask.height());
    let (lines, places) = if is_upright { (width, height) } else { (height, width) };
    let cell = |line: usize, place: usize| {
        if is_upright { place * width + line } else { line * width + place }
    };
    let mut straight = Raster::filled(width, height, false);
    for line in 0..lines {
        let mut start = 0;
        for place in 0..=places {
            if place < places && mask.cells()[cell(line, place)] {
                continue;
            }
            if place - start >= least {
                (start..place).for_each(|at| straight.cells_mut()[cell(line, at)] = true);
            }
            start = place + 1;
        }
    }
    regions(&straight).into_iter().map(|cells| Piece { cells, is_upright }).collect()
}

/// A length in cells, one at least.
fn reach(metres: f64, scale: f64) -> usize {
    (metres * scale).round().max(1.0) as usize
}

/// The floor along lines of one direction: places along a line are rows for upright ones, columns for others.
struct Ground<'a> {
    look: &'a Look,
    /// Where something else lies.
    hidden: &'a Raster<bool>,
    is_upright: bool,
}

/// A path from one side of the arena to the other.
struct Path {
    /// The first place along it, and the place across of it and those after it.
    first: usize,
    across: Vec<usize>,
    /// How much the brightness on it differs from that beside it; `None` where that is not seen.
    contrast: Vec<Option<f32>>,
}

impl Ground<'_> {
    /// The path of the line that a piece is part of, if it is a line on the floor.
    fn line_through(&self, piece: CellRect) -> Option<Path> {
        let (low, high) = if self.is_upright { (piece.x0, piece.x1) } else { (piece.y0, piece.y1) };
        let (middle, scale) = ((low + high) / 2, self.look.view.scale);
        let wander = reach(WANDER, scale);
        let path = self.path(middle, wander)?;
        let nearby = [-3, -2, 2, 3].into_iter().filter_map(|step| {
            self.path(middle.checked_add_signed(step * wander as isize)?, wander)
        });
        let blocks = |path: &Path| path.blocks(reach(BLOCK, scale));
        let mut usual: Vec<f32> = nearby.flat_map(|path| blocks(&path)).collect();
        let least = (CLEARER * median(&mut usual)).max(LEAST_CONTRAST);
        is_floor_line(&blocks(&path), least).then_some(path)
    }

    /// The path of most contrast within `wander` cells of the line at the place `middle` across.
    fn path(&self, middle: usize, wander: usize) -> Option<Path> {
        let along = self.on_arena();
        let first = middle.checked_sub(wander)?;
        let count = 2 * wander + 1;
        let contrast = |place: usize, lane: usize| self.contrast(place, first + lane);
        // The best sum of what draws the path to each lane, and the lane before it.
        let mut sums = vec![0.0_f32; count];
        let mut before: Vec<Vec<usize>> = Vec::with_capacity(along.len());
        for place in along.clone() {
            let best = |lane: usize| {
                let from = (lane.saturating_sub(1)..=(lane + 1).min(count - 1))
                    .map(|from| (from, sums[from] - if from == lane { 0.0 } else { STEP_COST }));
                from.max_by(|a, b| a.1.total_cmp(&b.1)).unwrap_or((lane, sums[lane]))
            };
            let steps: Vec<(usize, f32)> = (0..count).map(best).collect();
            before.push(steps.iter().map(|step| step.0).collect());
            let drawn = |lane: usize| contrast(place, lane).unwrap_or(0.0).min(MOST_DRAWN);
            sums = steps.iter().enumerate().map(|(lane, step)| step.1 + drawn(lane)).collect();
        }
        let mut lane = (0..count).max_by(|&a, &b| sums[a].total_cmp(&sums[b]))?;
        let mut across = Vec::with_capacity(before.len());
        for from in before.iter().rev() {
            across.push(first + lane);
            lane = from[lane];
        }
        across.reverse();
        let contrast =
            along.clone().zip(&across).map(|(place, &across)| self.contrast(place, across));
        Some(Path { first: along.start, contrast: contrast.collect(), across })
    }

    /// The places along lines that lie on the arena.
    fn on_arena(&self) -> std::ops::Range<usize> {
        let (view, features) = (&self.look.view, &self.look.features);
        let margin = (view.margin * view.scale).ceil() as usize + 2;
        let length = if self.is_upright { features.height() } else { features.width() };
        margin..length.saturating_sub(margin).max(margin)
    }

    /// How much the brightness at a place differs from the mean of those on both sides.
    fn contrast(&self, along: usize, across: usize) -> Option<f32> {
        let beside = reach(BESIDE, self.look.view.scale).max(2);
        let at = |across: usize| {
            let (x, y) = if self.is_upright { (across, along) } else { (along, across) };
            let is_hidden = self.hidden.get(x as i64, y as i64)?;
            self.look.features.get(x as i64, y as i64).filter(|_| !is_hidden).map(|seen| seen[0])
        };
        let (low, high) = (at(across.checked_sub(beside)?)?, at(across + beside)?);
        Some((at(across)? - (low + high) / 2.0).abs())
    }

    /// The cells of the view within the width of a line of a path.
    fn cells(&self, path: &Path) -> impl Iterator<Item = usize> {
        let reach = reach(LINE_WIDTH / 2.0, self.look.view.scale) + 1;
        let (width, height) = (self.look.features.width(), self.look.features.height());
        let is_upright = self.is_upright;
        let end = if is_upright { width } else { height };
        path.across.iter().enumerate().flat_map(move |(index, &across)| {
            let along = path.first + index;
            (across.saturating_sub(reach)..(across + reach + 1).min(end)).map(move |across| {
                if is_upright { along * width + across } else { across * width + along }
            })
        })
    }
}

impl Path {
    /// The mean contrast of parts of so many cells each, of those of which half is seen.
    fn blocks(&self, cells: usize) -> Vec<f32> {
        let mean = |part: &[Option<f32>]| {
            let seen: Vec<f32> = part.iter().flatten().copied().collect();
            (2 * seen.len() >= cells).then(|| seen.iter().sum::<f32>() / seen.len() as f32)
        };
        self.contrast.chunks(cells).filter_map(mean).collect()
    }
}

/// Whether the contrast along a line is that of one on the floor, where less than `least` is nothing.
fn is_floor_line(blocks: &[f32], least: f32) -> bool {
    let mut sorted = blocks.to_vec();
    sorted.sort_by(|a, b| b.total_cmp(a));
    let Some(&peak) = sorted.get(sorted.len() / PEAK_SHARE) else { return false };
    let share = |is: &dyn Fn(f32) -> bool| {
        blocks.iter().filter(|&&contrast| is(contrast)).count() as f64 / blocks.len() as f64
    };
    let end = (END_SHARE * blocks.len() as f64).ceil() as usize;
    let is_seen = |contrast: &f32| *contrast > least;
    let seen = share(&|contrast| contrast > least);
    let faint = share(&|contrast| contrast > least && contrast < peak / 2.0);
    blocks.iter().take(end).any(is_seen)
        && blocks.iter().rev().take(end).any(is_seen)
        && (seen >= PRINT_SEEN || seen >= FOLD_SEEN && faint >= FOLD_FAINT)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn folds_that_fade_and_lines_from_side_to_side_lie_on_the_floor_and_a_wall_that_ends_does_not()
    {
        let fold = [0.5, 0.9, 0.1, 0.06, 0.05, 0.01, 0.04, 0.05, 0.2, 0.7];
        assert!(is_floor_line(&fold, 0.03));
        let wall = [1.4, 1.4, 1.4, 1.4, 1.4, 1.4, 1.4, 0.3, 0.01, 0.01];
        assert!(!is_floor_line(&wall, 0.03));
        assert!(is_floor_line(&[1.4; 10], 0.03));
        assert!(!is_floor_line(&[], 0.03));
    }
}
