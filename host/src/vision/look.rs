//! The plan view judged cell by cell: how far is each from the floor's colour?
//!
//! Everything after this works on it: the robot is sought in it, obstacles are what differs.

use super::floor::{Difference, Feature, FloorModel, feature};
use super::photo::Photo;
use super::plan_map::PlanMap;
use super::plan_view::{PlanFrame, plan_view};
use super::raster::Raster;
use super::shadow::{self, Residuals};
use crate::geometry::{Arena, Point};

/// The plan view is no finer than this, cells along the longer side.
const MOST_CELLS: f64 = 620.0;
/// How far the plan view reaches beyond the arena, share of the shorter side.
const MARGIN_SHARE: f64 = 0.12;
/// Shadow and highlights are sought with about this many cells along the longer side.
const COARSE_CELLS: f64 = 220.0;
/// A colour within this many standard deviations of the floor's is surely floor.
pub(crate) const SURE: f32 = 2.5;
/// A colour this many standard deviations off the floor's is not floor.
pub(crate) const FOREIGN: f32 = 6.0;

/// A plan view, its colours and how they differ from the floor's.
pub(crate) struct Look {
    pub(crate) frame: PlanFrame,
    pub(crate) features: Raster<Feature>,
    pub(crate) differences: Raster<Difference>,
    pub(crate) floor: FloorModel,
    bright: Bright,
}

/// Where bright floor was found, by coarse cells.
struct Bright {
    coarse: Coarse,
    cells: Raster<bool>,
}

impl Look {
    /// Looks at the arena through a map; `None` if no floor colour can be learnt.
    pub(crate) fn at(photo: &Photo, map: &PlanMap, arena: Arena) -> Option<Self> {
        let middle = Point::new(arena.width / 2.0, arena.height / 2.0);
        let scale = map.scale_at(middle).min(MOST_CELLS / arena.width.max(arena.height));
        let frame =
            PlanFrame { arena, scale, margin: MARGIN_SHARE * arena.width.min(arena.height) };
        let light = plan_view(photo, map, &frame);
        let features = light.map(feature);
        let mut floor = FloorModel::fit(arena, &samples(&frame, &features))?;
        let coarse = Coarse::of(&frame, &features, &floor);
        floor.shadow = shadow::find(&floor, &coarse.view);
        let bright = shadow::highlights(&floor, &coarse.view, SURE);
        let differences = Raster::from_fn(features.width(), features.height(), |column, row| {
            let seen = features.cells()[row * features.width() + column];
            let difference = floor.difference(frame.point(column as f64, row as f64), seen);
            let floor_like = coarse.cell(column, row).is_some_and(|cell| bright.cells()[cell]);
            if floor_like { difference.at_most(1.0) } else { difference }
        });
        Some(Self { frame, features, differences, floor, bright: Bright { coarse, cells: bright } })
    }

    /// Whether the centre of a cell lies on the arena.
    pub(crate) fn on_arena(&self, column: usize, row: usize) -> bool {
        let point = self.frame.point(column as f64, row as f64);
        let arena = self.frame.arena;
        point.x > 0.0 && point.y > 0.0 && point.x < arena.width && point.y < arena.height
    }

    /// Whether a point belongs to floor that is lit or brighter than the model.
    pub(crate) fn is_bright_floor(&self, point: Point) -> bool {
        let (column, row) = self.frame.cell(point);
        let cell = self
            .bright
            .coarse
            .cell(column.round().max(0.0) as usize, row.round().max(0.0) as usize);
        cell.is_some_and(|cell| self.bright.cells.cells()[cell])
    }

    /// The difference at a floor point, of the cell that holds it.
    pub(crate) fn difference_at(&self, point: Point) -> Option<Difference> {
        let (column, row) = self.frame.cell(point);
        self.differences.get(column.round() as i64, row.round() as i64)
    }
}

/// The view of the arena alone, each cell the mean of several.
struct Coarse {
    view: Residuals,
    /// The first column and row of the arena, and the cells on each side of a coarse cell.
    first: (usize, usize),
    factor: usize,
}

impl Coarse {
    fn of(frame: &PlanFrame, features: &Raster<Feature>, floor: &FloorModel) -> Self {
        let factor = (frame.arena.width.max(frame.arena.height) * frame.scale / COARSE_CELLS)
            .round()
            .max(1.0) as usize;
        let (left, upper) = frame.cell(Point::new(0.0, frame.arena.height));
        let first = (left.ceil().max(0.0) as usize, upper.ceil().max(0.0) as usize);
        let count = |length: f64| ((length * frame.scale) as usize / factor).max(1);
        let (width, height) = (count(frame.arena.width), count(frame.arena.height));
        let mut points = Vec::with_capacity(width * height);
        let residuals = Raster::from_fn(width, height, |x, y| {
            let (column, row) = (first.0 + x * factor, first.1 + y * factor);
            let half = (factor as f64 - 1.0) / 2.0;
            let point = frame.point(column as f64 + half, row as f64 + half);
            points.push(point);
            let mut sum = [0.0; 3];
            for index in 0..factor * factor {
                let (i, j) = (column + index % factor, row + index / factor);
                if let Some(seen) = features.get(i as i64, j as i64) {
                    sum.iter_mut().zip(seen).for_each(|(sum, value)| *sum += value);
                }
            }
            floor.residual(point, sum.map(|sum| sum / (factor * factor) as f32))
        });
        Self {
            view: Residuals { points, scale: frame.scale / factor as f64, residuals },
            first,
            factor,
        }
    }

    /// The coarse cell that holds a cell.
    fn cell(&self, column: usize, row: usize) -> Option<usize> {
        let x = column.checked_sub(self.first.0)? / self.factor;
        let y = row.checked_sub(self.first.1)? / self.factor;
        let (width, height) = (self.view.residuals.width(), self.view.residuals.height());
        (x < width && y < height).then_some(y * width + x)
    }
}

fn samples(frame: &PlanFrame, features: &Raster<Feature>) -> Vec<(Point, Feature)> {
    let arena = frame.arena;
    let mut samples = Vec::with_capacity(features.cells().len());
    for row in 0..features.height() {
        for (column, &seen) in features.row(row).iter().enumerate() {
            let point = frame.point(column as f64, row as f64);
            if point.x > 0.0 && point.y > 0.0 && point.x < arena.width && point.y < arena.height {
                samples.push((point, seen));
            }
        }
    }
    samples
}
