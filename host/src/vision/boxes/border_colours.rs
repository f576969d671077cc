//! What lies beyond the arena's sides: a border has a colour of its own there, and is no obstacle.

use crate::geometry::{PerSide, Side};
use crate::vision::appearance::{Feature, median};
use crate::vision::image::Raster;
use crate::vision::plan_view::PlanFrame;

/// A border's colour varies by this much (brightness, chroma, chroma).
const BORDER_SPREAD: Feature = [0.12, 0.06, 0.06];

/// The median colours beyond each side, by the distance from it in cells.
#[derive(Clone, Debug, Default)]
pub(crate) struct BorderColours(PerSide<Vec<Feature>>);

impl BorderColours {
    /// Those of a plan view.
    pub(super) fn of(frame: &PlanFrame, features: &Raster<Feature>) -> Self {
        let depths = (frame.margin * frame.scale) as usize + 2;
        let mut lists: PerSide<Vec<[Vec<f32>; 3]>> =
            PerSide::from_fn(|_| vec![Default::default(); depths]);
        for row in 0..features.height() {
            for (column, seen) in features.row(row).iter().enumerate() {
                if let Some((side, depth)) =
                    frame.arena.beyond(frame.point(column as f64, row as f64))
                    && let Some(parts) = lists[side].get_mut((depth * frame.scale) as usize)
                {
                    parts.iter_mut().zip(seen).for_each(|(list, &value)| list.push(value));
                }
            }
        }
        let middle = |parts: [Vec<f32>; 3]| parts.map(|mut list| median(&mut list));
        Self(lists.map(|side| side.into_iter().map(middle).collect()))
    }

    /// How far a colour is from the border's so many cells beyond a side, 1 at three standard deviations; 0 where
    /// nothing is known of it.
    pub(super) fn distance(&self, side: Side, cells: f64, seen: Feature) -> f32 {
        let Some(border) = self.0[side].get(cells as usize) else { return 0.0 };
        let square: f32 = (0..3)
            .map(|part| ((seen[part] - border[part]) / (3.0 * BORDER_SPREAD[part])).powi(2))
            .sum();
        square.sqrt()
    }
}
