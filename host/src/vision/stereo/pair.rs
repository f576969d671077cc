//! Two pictures on one plan view, with exposure, white balance and vignetting of their cameras cancelled.
//!
//! Colours are those of [`crate::vision::appearance::floor`].

use super::disagreement::{disagreement, local_mean};
use super::exposure::{Exposure, Sample};
use crate::geometry::{Arena, Point};
use crate::vision::appearance::{Feature, Look, feature};
use crate::vision::boxes::Evidence;
use crate::vision::camera::{PlanMap, Viewpoint};
use crate::vision::image::{Photo, Raster};
use crate::vision::plan_view::{PlanFrame, plan_view};
use crate::vision::robot::RobotTop;

/// Cells per metre at most, and cells along the longer side at most.
const SCALE: f64 = 130.0;
const MOST_CELLS: f64 = 320.0;
/// How far tops may lean out of the arena, metres.
const MARGIN: f64 = 0.22;
/// Cells this close to the border are blurred with it, cells.
const BORDER_BLUR: f64 = 2.0;
/// How much larger than the robot's top the disc is in which nothing counts.
const ROBOT_RIM: f64 = 1.35;

/// One of the two pictures.
pub(crate) struct Sight<'a> {
    pub(crate) photo: &'a Photo,
    pub(crate) map: PlanMap,
    pub(crate) view: Viewpoint,
    pub(crate) look: Look,
    pub(crate) robot: Option<RobotTop>,
}

/// Both pictures, cell by cell.
pub(crate) struct Pair {
    pub(crate) frame: PlanFrame,
    pub(crate) views: [Viewpoint; 2],
    /// Colours as if by one camera.
    pub(crate) colours: [Raster<Feature>; 2],
    /// The same, every cell the mean of 3 × 3: grain that is not laid over itself exactly vanishes.
    pub(crate) smooth: [Raster<Feature>; 2],
    /// The spread of the lit floor's colour.
    pub(crate) spreads: [Feature; 2],
    /// The cost of being background by its colour, 0 to 1.
    pub(crate) background: [Raster<f32>; 2],
    /// How much a cell counts.
    pub(crate) weight: [Raster<f32>; 2],
    /// How surely the pictures disagree about a cell of the floor, 0 to 1.
    pub(crate) disagreement: Raster<f32>,
    /// Where that can be judged: not at the border, the robot and beyond the pictures.
    pub(crate) judged: Raster<bool>,
}

impl Pair {
    /// Lays two pictures over each other.
    pub(crate) fn of(arena: Arena, sights: &[Sight; 2]) -> Self {
        let middle = Point::new(arena.width / 2.0, arena.height / 2.0);
        let finest = sights.iter().map(|sight| sight.map.scale_at(middle));
        let most = (MOST_CELLS / arena.width.max(arena.height)).min(SCALE);
        let frame = PlanFrame::new(arena, finest.fold(most, f64::min), MARGIN);
        let blind = |point: Point| {
            sights
                .iter()
                .filter_map(|sight| sight.robot)
                .any(|top| top.radii_from(point) < ROBOT_RIM)
        };
        let evidence = sights
            .each_ref()
            .map(|sight| Evidence::of(sight.photo, &sight.map, &sight.look, sight.robot, true));
        let sampled = |values: &Raster<f32>, of: &PlanFrame| {
            raster(&frame, |point| {
                let (column, row) = of.cell(point);
                values.get(column.round() as i64, row.round() as i64).unwrap_or(0.0)
            })
        };
        let background = evidence.each_ref().map(|seen| sampled(&seen.background, &seen.frame));
        let weight = evidence.each_ref().map(|seen| sampled(&seen.weight, &seen.frame));
        let in_sight = raster(&frame, |point| {
            let held = sights.iter().all(|sight| sight.photo.holds(sight.map.to_photo(point)));
            held && !blind(point)
        });
        let colours = colours(sights, &frame, &in_sight);
        let (disagreement, judged) = disagreement(&frame, colours.clone(), &in_sight);
        let spreads = sights.each_ref().map(|sight| sight.look.floor.spread);
        let views = sights.each_ref().map(|sight| sight.view);
        let every = vec![1.0; colours[0].cells().len()];
        let smooth = colours.each_ref().map(|colours| local_mean(colours, &every, 1, 0.0));
        Self { frame, views, colours, smooth, spreads, background, weight, disagreement, judged }
    }

    /// The share of the floor on which the pictures disagree.
    pub(crate) fn disagreeing_share(&self) -> f64 {
        let floor = raster(&self.frame, |point| on_floor(&self.frame, point));
        let cells = || self.disagreement.cells().iter().zip(floor.cells()).filter(|(_, on)| **on);
        let sum: f32 = cells().map(|(sure, _)| sure).sum();
        f64::from(sum) / cells().count().max(1) as f64
    }
}

/// The values of the cells' floor points.
pub(crate) fn raster<T: Copy>(frame: &PlanFrame, mut value: impl FnMut(Point) -> T) -> Raster<T> {
    let (width, height) = frame.size();
    Raster::from_fn(width, height, |column, row| value(frame.point(column as f64, row as f64)))
}

/// The colours of both pictures as if by one camera.
fn colours(
    sights: &[Sight; 2],
    frame: &PlanFrame,
    in_sight: &Raster<bool>,
) -> [Raster<Feature>; 2] {
    let seen =
        sights.each_ref().map(|sight| plan_view(sight.photo, &sight.map, frame).map(feature));
    let radii = sights.each_ref().map(|sight| {
        let [x, y] = sight.photo.centre();
        raster(frame, |point| {
            let [u, v] = sight.map.to_photo(point);
            ((u - x).powi(2) + (v - y).powi(2)) / (x * x + y * y)
        })
    });
    let width = in_sight.width();
    let floor = |index: usize| {
        let point = frame.point((index % width) as f64, (index / width) as f64);
        in_sight.cells()[index] && on_floor(frame, point)
    };
    let sample = |index: usize| Sample {
        difference: super::disagreement::minus(seen[0].cells()[index], seen[1].cells()[index]),
        radii: radii.each_ref().map(|radii| radii.cells()[index]),
    };
    let samples: Vec<Sample> =
        (0..in_sight.cells().len()).filter(|&index| floor(index)).map(sample).collect();
    let exposure = Exposure::fit(&samples);
    let mut alike = seen;
    for (picture, colours) in alike.iter_mut().enumerate() {
        for (colour, &radius) in colours.cells_mut().iter_mut().zip(radii[picture].cells()) {
            let correction = exposure.correction(picture, radius);
            colour.iter_mut().zip(correction).for_each(|(value, shift)| *value += shift);
        }
    }
    alike
}

/// Whether a point lies on the floor and clear of the border's blur.
pub(crate) fn on_floor(frame: &PlanFrame, point: Point) -> bool {
    let (blur, arena) = (BORDER_BLUR / frame.scale, frame.arena);
    point.x > blur
        && point.y > blur
        && point.x < arena.width - blur
        && point.y < arena.height - blur
}
