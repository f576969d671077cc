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
    let is_smooth = |cell: usize, next: usize| {
        (features.cells()[cell][0] - features.cells()[next][0]).abs() < steepest
    };
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
        let (smooth, sharp): (Vec<_>, Vec<_>) =
            floor_beside.partition(|&(cell, next)| is_smooth(cell, next));
        if sharp.len() > smooth.len() {
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
