//! The plan view judged cell by cell: how far is each from the floor's colour?
//!
//! Everything after this works on it: the robot is searched for in it, obstacles are what differs.

use super::floor::{Difference, Feature, FloorModel, feature, sample_step};
use super::shadow::{self, Readings, Residuals, Shadow};
use crate::geometry::{Arena, Point, Rect};
use crate::shape::Shape;
use crate::vision::camera::PlanMap;
use crate::vision::image::{Photo, Raster};
use crate::vision::plan_view::{PlanFrame, view_of};

/// The plan view is no finer than this, cells along the longer side.
const MOST_CELLS: f64 = 620.0;
/// How far the plan view reaches beyond the arena, share of the shorter side.
const MARGIN_SHARE: f64 = 0.12;
/// How far the colours reach at least beyond the arena, metres: the robot's top leans over its sides.
const VIEW_MARGIN: f64 = 0.05;
/// To find the robot a floor model of every so many-th sample is good enough.
const ROUGH_FLOOR: usize = 3;
/// Shadow and highlights are searched for with about this many cells along the longer side.
const COARSE_CELLS: f64 = 220.0;
/// A colour within this many standard deviations of the floor's is surely floor.
pub(crate) const SURE: f32 = 2.5;
/// A colour this many standard deviations off the floor's is not floor.
pub(crate) const FOREIGN: f32 = 6.0;

/// Readings of shadow of which one is right on most floors. An even floor shows dark sides and tops of boxes as
/// plainly as shadow, so that there more are worth a look.
const USUAL_READINGS: Readings = Readings { most: 2, least_score: 0.3 };
const EVEN_READINGS: Readings = Readings { most: 3, least_score: 0.15 };

/// Cells this near to a place that is left out are blurred with it.
const LEFT_OUT_BLUR: f64 = 2.0;

/// A plan view's colours and the floor's.
pub(crate) struct Look {
    /// The plan view with all that may hide parts of the arena.
    pub(crate) frame: PlanFrame,
    /// The part of it that is looked at, and its colours.
    pub(crate) view: PlanFrame,
    pub(crate) features: Raster<Feature>,
    pub(crate) floor: FloorModel,
    /// What shadow may look like, likeliest first; the floor's is one of them.
    shadows: Vec<Shadow>,
    /// Unknown if only the robot is looked for.
    bright: Option<Bright>,
    /// Where nothing is an obstacle, whatever it looks like.
    left_out: Vec<Shape>,
}

/// Where bright floor was found, by coarse cells.
struct Bright {
    coarse: Coarse,
    cells: Raster<bool>,
}

impl Bright {
    fn of(coarse: Coarse, floor: &FloorModel) -> Self {
        let cells = shadow::highlights(floor, &coarse.view, SURE);
        Self { coarse, cells }
    }
}

impl Look {
    /// Looks at the arena through a map; `None` if no floor colour can be learnt.
    pub(crate) fn at(photo: &Photo, map: &PlanMap, arena: Arena) -> Option<Self> {
        Self::with(photo, map, arena, USUAL_READINGS)
    }

    /// Looks at a photo as it would be over an even floor.
    pub(crate) fn at_even_floor(photo: &Photo, map: &PlanMap, arena: Arena) -> Option<Self> {
        Self::with(photo, map, arena, EVEN_READINGS)
    }

    fn with(photo: &Photo, map: &PlanMap, arena: Arena, readings: Readings) -> Option<Self> {
        let mut look = Self::of(photo, map, arena, f64::INFINITY, 1)?;
        let coarse = Coarse::of(&look.view, &look.features, &look.floor);
        look.shadows = shadow::find(&look.floor, &coarse.view, readings);
        look.floor.shadow = look.shadows.first().copied();
        look.bright = Some(Bright::of(coarse, &look.floor));
        Some(look)
    }

    /// Looks at a window of the arena alone, whose floor is as an earlier look has found it.
    pub(crate) fn within(
        photo: &Photo,
        map: &PlanMap,
        floor: &FloorModel,
        [frame, view]: [PlanFrame; 2],
        window: Rect,
    ) -> Self {
        let (frame, view) = (frame.within(window), view.within(window));
        let features = view_of(photo, map, &view, feature);
        let floor = floor.clone();
        let bright = Some(Bright::of(Coarse::of(&view, &features, &floor), &floor));
        let shadows = floor.shadow.into_iter().collect();
        Self { frame, view, features, floor, shadows, bright, left_out: Vec::new() }
    }

    /// Looks no closer than `scale` cells a metre and not for shadow: enough to find the robot.
    pub(crate) fn no_finer(photo: &Photo, map: &PlanMap, arena: Arena, scale: f64) -> Option<Self> {
        Self::of(photo, map, arena, scale, ROUGH_FLOOR)
    }

    /// Looks with at most `scale` cells a metre; every `stride`-th of the usual samples makes the floor's
    /// model.
    fn of(photo: &Photo, map: &PlanMap, arena: Arena, scale: f64, stride: usize) -> Option<Self> {
        let middle = Point::new(arena.width / 2.0, arena.height / 2.0);
        let most = MOST_CELLS / arena.width.max(arena.height);
        let scale = map.scale_at(middle).min(most).min(scale);
        let frame = PlanFrame::new(arena, scale, MARGIN_SHARE * arena.width.min(arena.height));
        // Whole cells are left out, so that those of the view are cells of the frame.
        let left_out = ((frame.margin - VIEW_MARGIN) * scale).floor().max(0.0) / scale;
        let view = PlanFrame::new(arena, scale, frame.margin - left_out);
        let features = view_of(photo, map, &view, feature);
        let floor = FloorModel::fit(arena, &samples(&view, &features, stride))?;
        Some(Self {
            frame,
            view,
            features,
            floor,
            shadows: Vec::new(),
            bright: None,
            left_out: Vec::new(),
        })
    }

    /// What shadow may look like, likeliest first: one reading at least, of none if there is none.
    pub(crate) fn readings(&self) -> Vec<Option<Shadow>> {
        if self.shadows.is_empty() {
            return vec![None];
        }
        self.shadows.iter().copied().map(Some).collect()
    }

    /// The floor point of a cell of the view by its index.
    pub(crate) fn cell_point(&self, cell: usize) -> Point {
        let width = self.features.width();
        self.view.point((cell % width) as f64, (cell / width) as f64)
    }

    /// Whether the centre of a cell lies on the arena.
    pub(crate) fn on_arena(&self, column: usize, row: usize) -> bool {
        let point = self.view.point(column as f64, row as f64);
        let arena = self.view.arena;
        point.x > 0.0 && point.y > 0.0 && point.x < arena.width && point.y < arena.height
    }

    /// From now on nothing is an obstacle in these places.
    pub(crate) fn leave_out(&mut self, places: Vec<Shape>) {
        self.left_out = places;
    }

    /// Whether a cell of `scale` cells a metre lies in a place that is left out, or is blurred with it.
    pub(crate) fn is_left_out(&self, point: Point, scale: f64) -> bool {
        let blur = LEFT_OUT_BLUR / scale;
        let is_near =
            |place: &Shape| place.bounds().distance(point) < blur && place.distance(point) < blur;
        self.left_out.iter().any(is_near)
    }

    /// Whether a point belongs to floor that is lit or brighter than the model.
    pub(crate) fn is_bright_floor(&self, point: Point) -> bool {
        let Some(Bright { coarse, cells }) = &self.bright else { return false };
        let (column, row) = self.view.cell(point);
        let cell = coarse.cell(column.round().max(0.0) as usize, row.round().max(0.0) as usize);
        cell.is_some_and(|cell| cells.cells()[cell])
    }

    /// The colour at a floor point, of the cell that holds it.
    pub(crate) fn seen_at(&self, point: Point) -> Option<Feature> {
        let (column, row) = self.view.cell(point);
        self.features.get(column.round() as i64, row.round() as i64)
    }

    /// The difference at a floor point, of the cell that holds it.
    pub(crate) fn difference_at(&self, point: Point) -> Option<Difference> {
        let (column, row) = self.view.cell(point);
        let middle = self.view.point(column.round(), row.round());
        let difference = self.floor.difference(middle, self.seen_at(point)?);
        Some(if self.is_bright_floor(point) { difference.at_most(1.0) } else { difference })
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
        let (columns, rows) = frame.size();
        let (right, lower) = frame.cell(Point::new(frame.arena.width, 0.0));
        // Of a part of the view the arena may end where that does.
        let count = |length: f64, end: f64, first: usize, cells: usize| {
            let left = (end + 0.5).clamp(0.0, cells as f64) as usize;
            (((length * frame.scale) as usize).min(left.saturating_sub(first)) / factor).max(1)
        };
        let width = count(frame.arena.width, right + 1.0, first.0, columns);
        let height = count(frame.arena.height, lower + 1.0, first.1, rows);
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

/// Cells on the arena, at most as many as a floor model is fitted to, or every `stride`-th of those.
pub(crate) fn samples(
    frame: &PlanFrame,
    features: &Raster<Feature>,
    stride: usize,
) -> Vec<(Point, Feature)> {
    let arena = frame.arena;
    let inside = |value: f64, length: f64| value > 0.0 && value < length;
    let columns: Vec<usize> = (0..features.width())
        .filter(|&column| inside(frame.point(column as f64, 0.0).x, arena.width))
        .collect();
    let rows: Vec<usize> = (0..features.height())
        .filter(|&row| inside(frame.point(0.0, row as f64).y, arena.height))
        .collect();
    let count = columns.len() * rows.len();
    (0..count)
        .step_by(stride * sample_step(count))
        .map(|index| {
            let (column, row) = (columns[index % columns.len()], rows[index / columns.len()]);
            let seen = features.cells()[row * features.width() + column];
            (frame.point(column as f64, row as f64), seen)
        })
        .collect()
}
