//! The plan view judged cell by cell: how far is each from the floor's colour?
//!
//! Everything after this works on it: the robot is sought in it, obstacles are what differs.

use super::floor::{Difference, Feature, FloorModel, feature};
use super::photo::Photo;
use super::plan_map::PlanMap;
use super::plan_view::{PlanFrame, plan_view};
use super::raster::Raster;
use crate::geometry::{Arena, Point};

/// The plan view is no finer than this, cells along the longer side.
const MOST_CELLS: f64 = 620.0;
/// How far the plan view reaches beyond the arena, share of the shorter side.
const MARGIN_SHARE: f64 = 0.12;
/// A colour this many standard deviations off the floor's is not floor.
pub(crate) const FOREIGN: f32 = 6.0;

/// A plan view, its colours and how they differ from the floor's.
pub(crate) struct Look {
    pub(crate) frame: PlanFrame,
    pub(crate) features: Raster<Feature>,
    pub(crate) differences: Raster<Difference>,
    pub(crate) floor: FloorModel,
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
        let floor = FloorModel::fit(arena, &samples(&frame, &features))?;
        let differences = Raster::from_fn(features.width(), features.height(), |column, row| {
            let seen = features.cells()[row * features.width() + column];
            floor.difference(frame.point(column as f64, row as f64), seen)
        });
        Some(Self { frame, features, differences, floor })
    }

    /// Whether the centre of a cell lies on the arena.
    pub(crate) fn on_arena(&self, column: usize, row: usize) -> bool {
        let point = self.frame.point(column as f64, row as f64);
        let arena = self.frame.arena;
        point.x > 0.0 && point.y > 0.0 && point.x < arena.width && point.y < arena.height
    }

    /// The difference at a floor point, of the cell that holds it.
    pub(crate) fn difference_at(&self, point: Point) -> Option<Difference> {
        let (column, row) = self.frame.cell(point);
        self.differences.get(column.round() as i64, row.round() as i64)
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
