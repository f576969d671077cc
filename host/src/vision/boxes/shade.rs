//! Which dark cells of the coarse plan view may be shadow: half in it, in the soft rim of it, or beside nothing that
//! could cast one.
//!
//! Deviation: the paper knows no shadows; it leaves them to a second camera [Alghannam, Sec. VI].

use crate::vision::appearance::{Difference, FOREIGN, Feature, FloorModel, SURE};
use crate::vision::image::{Raster, regions};
use crate::vision::plan_view::PlanFrame;
use crate::vision::robot::RobotTop;

/// How much larger than the robot's top the disc is in which nothing counts.
pub(super) const ROBOT_RIM: f64 = 1.2;
/// Half shadow lies this close to lit floor and to full shadow, metres.
pub(super) const HALF_SHADOW: f64 = 0.03;
/// The steepest rim of a shadow that is wider: shares of its depth per metre.
const SOFTNESS: f32 = 13.0;
/// The step from pixel to pixel of the faintest box's edge if the picture is blurred.
const LEAST_BLURRED: f32 = 0.025;
/// Steps on a floor are no greater than this, standard deviations of its grain.
const GRAIN: f32 = 5.0;
/// Cells within which a shadow touches what casts it.
const TOUCH: i64 = 2;

/// The cells that may be half in shadow: lit floor and full shadow are both near.
pub(super) fn half_shadow(frame: &PlanFrame, judged: &Raster<Difference>) -> Raster<bool> {
    let reach = (HALF_SHADOW * frame.scale).ceil().max(2.0) as i64;
    let lit = widened(&judged.map(|difference| difference.lit < SURE), reach);
    let core = widened(&judged.map(|difference| difference.core < SURE), reach);
    let width = judged.width();
    Raster::from_fn(width, judged.height(), |column, row| {
        lit.cells()[row * width + column] && core.cells()[row * width + column]
    })
}

/// The cells that are reached from lit floor by way of cells that darken slowly: the rim of a large lamp's
/// shadow may be wider than [`HALF_SHADOW`], but the edges of a box are sharp; `finest` are the photo's
/// pixels per metre. What floor goes over into in a few places but ends at in most is a thing of shadow's colour.
pub(super) fn soft_shadow(
    frame: &PlanFrame,
    features: &Raster<Feature>,
    judged: &Raster<Difference>,
    floor: &FloorModel,
    finest: f64,
) -> Raster<bool> {
    let lit = judged.map(|difference| difference.lit < SURE);
    let Some(shadow) = floor.shadow else { return lit };
    let sharpest = LEAST_BLURRED * finest as f32;
    let steepest = (SOFTNESS * -shadow.offset[0]).min(sharpest) / frame.scale as f32;
    let width = judged.width();
    let step =
        |cell: usize, next: usize| (features.cells()[cell][0] - features.cells()[next][0]).abs();
    let is_smooth = |cell: usize, next: usize| step(cell, next) < steepest;
    let is_dim = |cell: usize| {
        let point = frame.point((cell % width) as f64, (cell / width) as f64);
        judged.cells()[cell].floor < SURE && frame.arena.beyond(point).is_none()
    };
    let mut soft = lit.grown(|cell, next| is_dim(next) && is_smooth(cell, next));
    let dim = soft.cells().iter().zip(lit.cells()).map(|(&soft, &lit)| soft && !lit);
    for patch in regions(&Raster::from_cells(width, dim.collect())) {
        let rim = patch.iter().flat_map(|&cell| soft.beside(cell).map(move |next| (cell, next)));
        let floor_beside =
            rim.filter(|&(_, next)| lit.cells()[next] || !soft.cells()[next] && is_dim(next));
        let (smooth, steep): (Vec<_>, Vec<_>) =
            floor_beside.partition(|&(cell, next)| is_smooth(cell, next));
        let is_sharp =
            |&&(cell, next): &&(usize, usize)| step(cell, next) > GRAIN * floor.spread[0];
        let sharp = steep.iter().filter(is_sharp).count();
        if sharp > smooth.len() {
            patch.iter().for_each(|&cell| soft.cells_mut()[cell] = false);
        }
    }
    soft
}

/// The cells within `reach` columns and rows of a marked one.
pub(super) fn widened(mask: &Raster<bool>, reach: i64) -> Raster<bool> {
    let along = |mask: &Raster<bool>, (i, j): (i64, i64)| {
        Raster::from_fn(mask.width(), mask.height(), |column, row| {
            (-reach..=reach)
                .any(|k| mask.get(column as i64 + k * i, row as i64 + k * j) == Some(true))
        })
    };
    along(&along(mask, (1, 0)), (0, 1))
}

/// Cells as dark as shadow in patches that touch nothing that could cast one: no box, border or robot.
pub(super) fn lonely_shadow(
    frame: &PlanFrame,
    judged: &Raster<Difference>,
    robot: Option<RobotTop>,
) -> Raster<bool> {
    let (width, height) = (judged.width(), judged.height());
    let judged = |column: usize, row: usize| {
        (frame.point(column as f64, row as f64), judged.cells()[row * width + column])
    };
    let dark = Raster::from_fn(width, height, |column, row| {
        let (point, difference) = judged(column, row);
        frame.arena.beyond(point).is_none()
            && difference.lit > FOREIGN
            && difference.floor <= FOREIGN
    });
    let (patches, count) = dark.regions(true);
    let mut cast = vec![false; count + 1];
    for row in 0..height {
        for column in 0..width {
            let (point, difference) = judged(column, row);
            let of_robot = robot.is_some_and(|top| top.radii_from(point) < ROBOT_RIM);
            if difference.floor <= FOREIGN && frame.arena.beyond(point).is_none() && !of_robot {
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::{Arena, Point};
    use crate::vision::appearance::Shadow;

    const ARENA: Arena = Arena { width: 1.0, height: 0.6 };
    const SCALE: f64 = 100.0;
    const DEPTH: f32 = 0.8;

    /// Whether the middle of a floor is taken for lit or the rim of shadow, where `dark` tells its depth.
    fn is_soft(dark: impl Fn(Point) -> f32) -> bool {
        let frame = PlanFrame::new(ARENA, SCALE, 0.0);
        let (width, height) = frame.size();
        let samples: Vec<(Point, Feature)> = (0..600)
            .map(|i| (frame.point(f64::from(i % 30), f64::from(i / 30)), [0.0; 3]))
            .collect();
        let mut floor = FloorModel::fit(ARENA, &samples).unwrap();
        floor.shadow = Some(Shadow { offset: [-DEPTH, 0.0, 0.0], even: None });
        let features = Raster::from_fn(width, height, |column, row| {
            [-dark(frame.point(column as f64, row as f64)), 0.0, 0.0]
        });
        let judged = Raster::from_fn(width, height, |column, row| {
            floor.difference(frame.point(column as f64, row as f64), features.row(row)[column])
        });
        let (column, row) = frame.cell(Point::new(0.5, 0.3));
        let soft = soft_shadow(&frame, &features, &judged, &floor, 300.0);
        soft.get(column as i64, row as i64) == Some(true)
    }

    #[test]
    fn what_darkens_slowly_is_the_rim_of_shadow() {
        // From lit floor to full shadow within 0.4 m.
        assert!(is_soft(|point| DEPTH * ((point.x - 0.3) / 0.4).clamp(0.0, 1.0) as f32));
    }

    #[test]
    fn a_grey_box_that_floor_goes_over_into_in_one_place_is_none() {
        let edge = |point: Point| {
            let (x, y) = ((point.x - 0.5).abs(), (point.y - 0.3).abs());
            if x < 0.2 && y < 0.2 { 0.3 } else { 0.0 }
        };
        assert!(!is_soft(edge));
        // A blurred corner leads up to it, 3 cm wide.
        let leak = |point: Point| {
            let along = ((0.3 - point.x) / 0.1).clamp(0.0, 1.0) as f32;
            let is_leak = (point.y - 0.3).abs() < 0.015 && point.x < 0.3 && point.x > 0.2;
            if is_leak { 0.3 * (1.0 - along) } else { edge(point) }
        };
        assert!(!is_soft(leak));
    }
}
