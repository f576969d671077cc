//! What no box explains: cells that are neither floor, shadow of a known light source, robot nor box.
//!
//! An answer that leaves out part of an obstacle leads a robot into it. So whatever the explanation by boxes
//! leaves is covered as well: where it sticks out of a box by little, by that box's margin; elsewhere by few
//! rectangles that follow its outline. Turned boxes, discs and thin walls thus lie inside what is reported,
//! larger than they are rather than smaller. Metres in the arena frame; patches are searched for in the plan view.
//!
//! Deviation: the paper's obstacles are upright rectangles alone [Alghannam, Sec. II.A].

use super::foreign::Foreign;
use super::implausible::{goes_over_into_floor, is_along_wall, is_part_of_robot};
use super::light::Lamp;
use super::projection::LeaningBox;
use super::refine::Bounded;
use super::shaped::{Patches, Shaped};
use super::widening::{widen, with_outlines};
use crate::geometry::{Point, Rect};
use crate::scene::Obstacle;
use crate::vision::appearance::{FOREIGN, Look};
use crate::vision::image::{CellRect, LEAST_CELLS, Raster, around, cut, greatest, marked, regions};
use crate::vision::robot::RobotTop;

/// Cells this near to a box's outline are blurred with it.
const BOX_BLUR: f64 = 1.5;
/// What sticks out of a box by no more than this is a matter of its margin, metres.
const MOST_WIDENED: f64 = 0.015;
const MOST_WIDENED_LEANING: f64 = 0.03;
/// What is smaller is a matter of margins up to twice as wide, square metres.
const SLIVER: f64 = 0.0006;
/// A patch of this size may have a shape of its own, square metres and cells.
const LEAST_SHAPED: f64 = 0.0002;
const LEAST_SHAPED_CELLS: f64 = 24.0;
/// Cells this near to a shape's outline are blurred with it.
const SHAPE_BLUR: f64 = 2.0;
/// Half of the least cells of a patch are this many times as far from floor as the limit.
const LEAST_PEAK: f32 = 1.8;

/// What explains a picture so far.
pub(crate) struct Explained<'a> {
    pub(crate) look: &'a Look,
    /// The outlines of boxes.
    pub(crate) boxes: &'a [LeaningBox],
    /// The camera's foot point, if boxes lean.
    pub(crate) foot: Option<Point>,
    pub(crate) lamp: Option<Lamp>,
    pub(crate) robot: Option<RobotTop>,
}

impl Explained<'_> {
    /// The shapes of what upright boxes explain badly, with the boxes that they replace.
    pub(super) fn shapes(&self, seen: &Foreign) -> Vec<Shaped> {
        let distances = &seen.distances;
        let foreign = seen.mask();
        let (frame, width) = (self.look.view, foreign.width());
        let patches = self.patches(seen);
        let least = (LEAST_SHAPED * frame.scale.powi(2)).max(LEAST_SHAPED_CELLS) as usize;
        let is_shape = |patch: &Vec<usize>| {
            let rect = self.metres(around(patch, width));
            patch.len() >= least
                && is_sure(distances, patch)
                && !is_along_wall(rect, frame.arena)
                && !is_part_of_robot(rect, self.robot)
                && !goes_over_into_floor(patch, self.look)
        };
        regions(&foreign)
            .iter()
            .filter(|patch| is_shape(patch))
            .filter_map(|patch| patches.shape_of(patch))
            .collect()
    }

    fn patches<'a>(&'a self, seen: &'a Foreign) -> Patches<'a> {
        Patches {
            frame: self.look.view,
            levels: &seen.levels,
            boxes: self.boxes,
            foot: self.foot,
            is_lit: self.lamp.is_some(),
        }
    }

    /// Widens the margins of `bounded`, one for each of the boxes, by what sticks out a little, and adds
    /// rectangles around all else that neither they nor `shapes` explain; where one rectangle is not enough for
    /// a region, its outline is returned, unless a known light makes outlines ragged.
    pub(crate) fn complete(
        &self,
        seen: &Foreign,
        shapes: &[Obstacle],
        bounded: &mut Vec<Bounded>,
    ) -> Vec<Obstacle> {
        let blur = SHAPE_BLUR / self.look.view.scale;
        let is_of_shape = |point: Point| {
            let near = |of: &Obstacle| of.footprint.distance(point) < of.largest_margin() + blur;
            shapes.iter().any(near)
        };
        let view = &self.look.view;
        let (width, height) = (seen.levels.width(), seen.levels.height());
        let unexplained = Raster::from_fn(width, height, |column, row| {
            let point = view.point(column as f64, row as f64);
            // What is beyond an edge is blurred with what lies inside of it.
            seen.levels.row(row)[column] >= 1.0 && !self.is_of_box(point) && !is_of_shape(point)
        });
        let outline = |seen: &LeaningBox| self.foot.map_or(seen.base, |foot| seen.bounds(foot));
        let outlines: Vec<Rect> = self.boxes.iter().map(outline).collect();
        let patches = self.patches(seen);
        let (things, bounds) = self.things(seen);
        let mut added = Vec::new();
        for patch in regions(&unexplained) {
            let thing = bounds[things.cells()[patch[0]]];
            let is_sure = is_sure(&seen.distances, &patch);
            for region in self.beyond(&patch, thing, is_sure, &outlines, bounded) {
                let rects = self.cover(&region, width);
                match patches.outline(&region).filter(|_| rects.len() > 1 && self.lamp.is_none()) {
                    Some(shape) => added.push(shape),
                    None => bounded.extend(rects),
                }
            }
        }
        added
    }

    /// What is connected and no floor: the number of every cell's thing, and the bounds of each.
    fn things(&self, seen: &Foreign) -> (Raster<usize>, Vec<Rect>) {
        let patches = regions(&seen.levels.map(|level| level >= 1.0));
        let (width, height) = (seen.levels.width(), seen.levels.height());
        let mut things = Raster::filled(width, height, 0);
        for (index, patch) in patches.iter().enumerate() {
            patch.iter().for_each(|&cell| things.cells_mut()[cell] = index);
        }
        let bounds = patches.iter().map(|patch| self.metres(around(patch, width)));
        (things, bounds.collect())
    }

    /// The regions of a patch of a thing with these bounds that are surely no noise and too far from `outlines` to
    /// be a matter of their margins, which are widened by the others.
    fn beyond(
        &self,
        patch: &[usize],
        thing: Rect,
        is_sure: bool,
        outlines: &[Rect],
        bounded: &mut [Bounded],
    ) -> Vec<Vec<usize>> {
        let width = self.look.features.width();
        let rect = self.metres(around(patch, width));
        if !is_sure {
            widen(rect, MOST_WIDENED, with_outlines(outlines, bounded));
            return vec![];
        }
        // What remains of a thing that reaches onto the floor is no foot of a wall.
        if is_along_wall(thing, self.look.frame.arena)
            || is_part_of_robot(rect, self.robot)
            || goes_over_into_floor(patch, self.look)
        {
            return vec![];
        }
        let most = if self.foot.is_some() { MOST_WIDENED_LEANING } else { MOST_WIDENED };
        let mut left = patch.to_vec();
        left.retain(|&cell| {
            !widen(self.metres(around(&[cell], width)), most, with_outlines(outlines, bounded))
        });
        // A patch of which nothing was taken is one region still; noise makes thousands of these.
        let whole = left.len() == patch.len();
        let mut rest = if whole { vec![left] } else { regions(&marked(&left, width)) };
        rest.retain(|region| {
            let rect = self.metres(around(region, width));
            let is_sliver = self.foot.is_some()
                && (region.len() as f64) < SLIVER * self.look.view.scale.powi(2);
            !is_sliver || !widen(rect, 2.0 * most, with_outlines(outlines, bounded))
        });
        rest
    }

    /// Few rectangles, with their margins, around all cells of a patch.
    fn cover(&self, patch: &[usize], width: usize) -> Vec<Bounded> {
        let (rects, rest) = greatest(patch, width);
        let margin = [0.5 / self.look.view.scale; 4];
        let bounded = |rect| Bounded { rect: self.metres(rect), margin };
        let mut covers: Vec<Bounded> = rects.into_iter().map(bounded).collect();
        for region in rest {
            let rect = self.metres(around(&region, width));
            if !widen(rect, MOST_WIDENED, covers.iter_mut().map(|cover| (cover.rect, cover))) {
                covers.extend(cut(&region, width).into_iter().map(bounded));
            }
        }
        covers
    }

    /// The metres that cells of the view span.
    pub(super) fn metres(&self, cells: CellRect) -> Rect {
        let point = |x: usize, y: usize| self.look.view.point(x as f64 - 0.5, y as f64 - 0.5);
        let (low, high) = (point(cells.x0, cells.y1), point(cells.x1, cells.y0));
        Rect::new(low.x, low.y, high.x, high.y)
    }

    fn is_of_box(&self, point: Point) -> bool {
        let blur = BOX_BLUR / self.look.view.scale;
        self.boxes.iter().any(|seen| seen.spans(self.foot, point, blur))
    }
}

/// Whether a patch is surely no noise.
fn is_sure(distances: &Raster<f32>, patch: &[usize]) -> bool {
    let peaks = patch.iter().filter(|&&cell| distances.cells()[cell] > LEAST_PEAK * FOREIGN);
    patch.len() >= LEAST_CELLS && peaks.count() >= LEAST_CELLS / 2
}

#[cfg(test)]
mod tests;
