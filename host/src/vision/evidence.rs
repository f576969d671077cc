//! What speaks for floor and what for boxes, on a coarse plan view.
//!
//! Every cell has a colour, and a cost of being floor, shadow or border from 0 (surely) to 1 (surely
//! not). Beyond the arena's sides the background is the border: its colour at every distance from a
//! side is the median along that side, so that a box that leans over the border is seen against it.

use super::floor::{Feature, feature, median};
use super::look::{FOREIGN, Look};
use super::photo::Photo;
use super::plan_map::PlanMap;
use super::plan_view::{PlanFrame, plan_view};
use super::raster::Raster;
use super::robot::RobotTop;
use crate::geometry::{Arena, Point};

/// Cells per metre at most, and cells along the longer side at most.
const COARSE_SCALE: f64 = 110.0;
const COARSE_CELLS: f64 = 300.0;
/// A border's colour varies by this much (brightness, chroma, chroma).
const BORDER_SPREAD: Feature = [0.12, 0.06, 0.06];
/// A colour within this many standard deviations of the floor's is surely floor.
const SURE: f32 = 2.5;
/// Cells within which a shadow touches what casts it.
const TOUCH: i64 = 2;
/// Cells this close to the border are blurred with it.
const BORDER_BLUR: f64 = 1.2;
/// Cells beyond the border say less, because what lies there is not known.
const OUTSIDE_WEIGHT: f32 = 0.4;
/// How much larger than the robot's top the disc is in which nothing counts.
const ROBOT_RIM: f64 = 1.2;

/// The coarse plan view.
pub(crate) struct Evidence {
    pub(crate) frame: PlanFrame,
    pub(crate) features: Raster<Feature>,
    /// The cost of being background, 0 to 1.
    pub(crate) background: Raster<f32>,
    /// How much a cell counts.
    pub(crate) weight: Raster<f32>,
}

impl Evidence {
    pub(crate) fn of(photo: &Photo, map: &PlanMap, look: &Look, robot: Option<RobotTop>) -> Self {
        let arena = look.frame.arena;
        let scale =
            COARSE_SCALE.min(COARSE_CELLS / arena.width.max(arena.height)).min(look.frame.scale);
        let frame = PlanFrame { scale, ..look.frame };
        let features = plan_view(photo, map, &frame).map(feature);
        let borders = border_colours(&frame, &features);
        let lonely = lonely_shadow(&frame, &features, look, robot);
        let width = features.width();
        let background = Raster::from_fn(width, features.height(), |column, row| {
            let point = frame.point(column as f64, row as f64);
            let seen = features.cells()[row * width + column];
            let distance = match outside(arena, point) {
                None => {
                    let difference = look.floor.difference(point, seen);
                    let distance = if lonely.cells()[row * width + column] {
                        difference.lit
                    } else {
                        difference.floor
                    };
                    ((distance - SURE) / (FOREIGN - SURE)).max(0.0)
                }
                Some((side, depth)) => borders[side]
                    .get((depth * scale) as usize)
                    .map_or(0.0, |&of_border| border_distance(seen, of_border)),
            };
            (distance * distance).min(1.0)
        });
        let weight = Raster::from_fn(width, features.height(), |column, row| {
            let point = frame.point(column as f64, row as f64);
            let of_robot =
                robot.is_some_and(|top| top.centre.distance(point) < ROBOT_RIM * top.radius);
            let seen = photo.holds(map.to_photo(point));
            match outside(arena, point) {
                _ if of_robot || !seen => 0.0,
                Some(_) => OUTSIDE_WEIGHT,
                None if inside(arena, point) * scale < BORDER_BLUR => 0.0,
                None => 1.0,
            }
        });
        Self { frame, features, background, weight }
    }

    /// The cells on the arena that are hardly background.
    pub(crate) fn foreign(&self) -> Raster<bool> {
        let width = self.features.width();
        Raster::from_fn(width, self.features.height(), |column, row| {
            let index = row * width + column;
            let point = self.frame.point(column as f64, row as f64);
            self.background.cells()[index] >= 0.8
                && self.weight.cells()[index] > 0.0
                && outside(self.frame.arena, point).is_none()
        })
    }
}

/// Cells as dark as shadow in patches that touch nothing that could cast one: no box, border or robot.
fn lonely_shadow(
    frame: &PlanFrame,
    features: &Raster<Feature>,
    look: &Look,
    robot: Option<RobotTop>,
) -> Raster<bool> {
    let (width, height) = (features.width(), features.height());
    let judged = |column: usize, row: usize| {
        let point = frame.point(column as f64, row as f64);
        (point, look.floor.difference(point, features.cells()[row * width + column]))
    };
    let dark = Raster::from_fn(width, height, |column, row| {
        let (point, difference) = judged(column, row);
        outside(frame.arena, point).is_none()
            && difference.lit > FOREIGN
            && difference.floor <= FOREIGN
    });
    let (patches, count) = dark.regions(true);
    let mut cast = vec![false; count + 1];
    for row in 0..height {
        for column in 0..width {
            let (point, difference) = judged(column, row);
            let of_robot =
                robot.is_some_and(|top| top.centre.distance(point) < ROBOT_RIM * top.radius);
            if difference.floor <= FOREIGN && outside(frame.arena, point).is_none() && !of_robot {
                continue;
            }
            for (i, j) in (-TOUCH..=TOUCH).flat_map(|j| (-TOUCH..=TOUCH).map(move |i| (i, j))) {
                if let Some(patch) = patches.get(column as i64 + i, row as i64 + j) {
                    cast[patch as usize] = true;
                }
            }
        }
    }
    patches.map(|patch| patch > 0 && !cast[patch as usize])
}

/// The side (0 left, 1 lower, 2 right, 3 upper) that a point lies beyond and how far; `None` on the arena.
fn outside(arena: Arena, point: Point) -> Option<(usize, f64)> {
    let depths = [-point.x, -point.y, point.x - arena.width, point.y - arena.height];
    let (side, &depth) = depths.iter().enumerate().max_by(|a, b| a.1.total_cmp(b.1))?;
    (depth > 0.0).then_some((side, depth))
}

/// How far a point of the arena is from its nearest side, metres.
fn inside(arena: Arena, point: Point) -> f64 {
    point.x.min(point.y).min(arena.width - point.x).min(arena.height - point.y)
}

/// The median colour beyond each side, by the distance from it in cells.
fn border_colours(frame: &PlanFrame, features: &Raster<Feature>) -> [Vec<Feature>; 4] {
    let depths = (frame.margin * frame.scale) as usize + 2;
    let mut lists: [Vec<[Vec<f32>; 3]>; 4] = [(); 4].map(|()| vec![Default::default(); depths]);
    for row in 0..features.height() {
        for (column, seen) in features.row(row).iter().enumerate() {
            if let Some((side, depth)) =
                outside(frame.arena, frame.point(column as f64, row as f64))
                && let Some(parts) = lists[side].get_mut((depth * frame.scale) as usize)
            {
                parts.iter_mut().zip(seen).for_each(|(list, &value)| list.push(value));
            }
        }
    }
    lists
        .map(|side| side.into_iter().map(|parts| parts.map(|mut list| median(&mut list))).collect())
}

fn border_distance(seen: Feature, border: Feature) -> f32 {
    let square: f32 = (0..3)
        .map(|part| ((seen[part] - border[part]) / (3.0 * BORDER_SPREAD[part])).powi(2))
        .sum();
    square.sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn points_beyond_a_side_know_which_and_how_far() {
        let arena = Arena { width: 2.0, height: 1.0 };
        assert_eq!(outside(arena, Point::new(1.0, 0.5)), None);
        assert_eq!(outside(arena, Point::new(2.25, 0.5)), Some((2, 0.25)));
        assert_eq!(outside(arena, Point::new(-0.1, -0.3)), Some((1, 0.3)));
    }
}
