//! What speaks for floor and what for boxes, on a coarse plan view.
//!
//! Every cell has a colour, and a cost of being floor, shadow or border from 0 (surely) to 1 (surely
//! not). Beyond the arena's sides the background is the border: its colour at every distance from a
//! side is the median along that side, so that a box that leans over the border is seen against it.

use super::border_colours::BorderColours;
use super::projection::LeaningBox;
use super::shade::{ROBOT_RIM, half_shadow, lonely_shadow, soft_shadow, widened};
use crate::geometry::{Point, Rect};
use crate::vision::appearance::{
    Difference, FOREIGN, Feature, FloorModel, Look, SURE, feature, samples,
};
use crate::vision::camera::PlanMap;
use crate::vision::image::{Photo, Raster};
use crate::vision::plan_view::{PlanFrame, plan_view};
use crate::vision::robot::RobotTop;

/// Cells per metre at most, and cells along the longer side at most.
const COARSE_SCALE: f64 = 110.0;
const COARSE_CELLS: f64 = 300.0;
/// Blur beside lit floor is at most this deep, a natural logarithm.
pub(super) const DEEPEST: f32 = -1.5;
/// Cells this close to the border are blurred with it.
const BORDER_BLUR: f64 = 1.2;
/// Cells beyond the border say less, because what lies there is not known.
const OUTSIDE_WEIGHT: f32 = 0.4;
/// The shadows of the border and of the robot reach this far: metres, and radii of the robot.
pub(super) const BORDER_SHADOW: f64 = 0.08;
pub(super) const ROBOT_SHADOW: f64 = 2.5;

/// The coarse plan view.
pub(crate) struct Evidence {
    pub(crate) frame: PlanFrame,
    pub(crate) features: Raster<Feature>,
    /// The cost of being background, 0 to 1.
    pub(crate) background: Raster<f32>,
    /// How much a cell counts.
    pub(crate) weight: Raster<f32>,
    /// How surely a cell is floor in shadow (up to 1) or lit floor (down to −1); 0 if it is neither.
    pub(crate) shade: Raster<f32>,
    /// The spread of the floor's colours in cells of this size.
    pub(crate) spread: Feature,
    /// The colours beyond each side, by the distance from it in cells.
    pub(crate) borders: BorderColours,
}

/// Cells of the coarse view and what is known of them before they are judged.
struct Cells {
    features: Raster<Feature>,
    weight: Raster<f32>,
    spread: Feature,
    borders: BorderColours,
}

/// Cells per metre of the coarse plan view.
pub(crate) fn coarse_scale(look: &Look) -> f64 {
    let arena = look.frame.arena;
    COARSE_SCALE.min(COARSE_CELLS / arena.width.max(arena.height)).min(look.frame.scale)
}

impl Evidence {
    /// The evidence of a picture; without `shadows` nothing but the robot casts any.
    pub(crate) fn of(
        photo: &Photo,
        map: &PlanMap,
        look: &Look,
        robot: Option<RobotTop>,
        shadows: bool,
    ) -> Self {
        let frame = coarse_frame(look);
        let (features, weight) = cells(photo, map, look, &frame, robot);
        let spread = look.floor.spread_of(&samples(&frame, &features, 1));
        let borders = BorderColours::of(&frame, &features);
        let cells = Cells { features, weight, spread, borders };
        Self::judged(frame, cells, look, robot, shadows)
    }

    /// The evidence of a window of a picture, where spread and border are as an earlier picture has told.
    pub(crate) fn within(
        photo: &Photo,
        map: &PlanMap,
        look: &Look,
        robot: Option<RobotTop>,
        (frame, window): (PlanFrame, Rect),
        known: (Feature, &BorderColours, bool),
    ) -> Self {
        let frame = frame.within(window);
        let (features, weight) = cells(photo, map, look, &frame, robot);
        let (spread, borders, shadows) = known;
        let cells = Cells { features, weight, spread, borders: borders.clone() };
        Self::judged(frame, cells, look, robot, shadows)
    }

    /// The same of another look at the picture.
    pub(crate) fn judged_again(&self, look: &Look, robot: Option<RobotTop>, shadows: bool) -> Self {
        let cells = Cells {
            features: self.features.clone(),
            weight: self.weight.clone(),
            spread: self.spread,
            borders: self.borders.clone(),
        };
        Self::judged(self.frame, cells, look, robot, shadows)
    }

    fn judged(
        frame: PlanFrame,
        cells: Cells,
        look: &Look,
        robot: Option<RobotTop>,
        shadows: bool,
    ) -> Self {
        let Cells { features, weight, spread, borders } = cells;
        let floor = look.floor.with_spread(spread);
        let judged = judge(&frame, &features, &floor, look);
        let soft = soft_shadow(&frame, &features, &judged, &floor, look.frame.scale);
        let shadows = shadows.then_some(&soft);
        let cells = (&features, &judged, &borders);
        let background = background(&frame, cells, &floor, robot, shadows);
        let shade = shade(&frame, &judged, robot);
        Self { frame, features, background, weight, shade, spread, borders }
    }

    /// The floor point of a cell by its index.
    pub(crate) fn point(&self, index: usize) -> Point {
        let width = self.features.width();
        self.frame.point((index % width) as f64, (index / width) as f64)
    }

    /// Calls `visit` with the index and the floor point of every `stride`-th cell in the outline of a box
    /// as it is seen from above `foot`.
    pub(crate) fn each_covered(
        &self,
        seen: LeaningBox,
        foot: Point,
        stride: usize,
        mut visit: impl FnMut(usize, Point),
    ) {
        let bounds = seen.bounds(foot);
        let (left, upper) = self.frame.cell(Point::new(bounds.x0, bounds.y1));
        let (right, lower) = self.frame.cell(Point::new(bounds.x1, bounds.y0));
        let (width, height) = (self.features.width(), self.features.height());
        let first = |edge: f64| edge.ceil().max(0.0) as usize;
        let after = |edge: f64, length: usize| ((edge.floor() + 1.0).max(0.0) as usize).min(length);
        let columns: Vec<_> = (first(left)..after(right, width))
            .step_by(stride)
            .map(|column| {
                let x = self.frame.point(column as f64, 0.0).x;
                (column, x, seen.leans_at_x(x, foot))
            })
            .collect();
        for row in (first(upper)..after(lower, height)).step_by(stride) {
            let y = self.frame.point(0.0, row as f64).y;
            let leans = seen.leans_at_y(y, foot);
            for &(column, x, across) in &columns {
                if seen.face_within(across, leans).is_some() {
                    visit(row * width + column, Point::new(x, y));
                }
            }
        }
    }

    /// The cells on the arena that are hardly background.
    pub(crate) fn foreign(&self) -> Raster<bool> {
        let width = self.features.width();
        Raster::from_fn(width, self.features.height(), |column, row| {
            let index = row * width + column;
            let point = self.frame.point(column as f64, row as f64);
            self.background.cells()[index] >= 0.8
                && self.weight.cells()[index] > 0.0
                && self.frame.arena.beyond(point).is_none()
        })
    }
}

/// The coarse view of all that a look spans.
fn coarse_frame(look: &Look) -> PlanFrame {
    PlanFrame::new(look.frame.arena, coarse_scale(look), look.frame.margin)
}

/// The colours of a frame's cells and how much each counts.
fn cells(
    photo: &Photo,
    map: &PlanMap,
    look: &Look,
    frame: &PlanFrame,
    robot: Option<RobotTop>,
) -> (Raster<Feature>, Raster<f32>) {
    let (arena, scale) = (frame.arena, frame.scale);
    let features = plan_view(photo, map, frame).map(feature);
    let weight = Raster::from_fn(features.width(), features.height(), |column, row| {
        let point = frame.point(column as f64, row as f64);
        let of_robot = robot.is_some_and(|top| top.radii_from(point) < ROBOT_RIM);
        let seen = photo.holds(map.to_photo(point)) && !look.is_left_out(point, scale);
        match arena.beyond(point) {
            _ if of_robot || !seen => 0.0,
            Some(_) => OUTSIDE_WEIGHT,
            None if arena.depth(point) * scale < BORDER_BLUR => 0.0,
            None => 1.0,
        }
    });
    (features, weight)
}

/// The cost of every cell of being background; `shadows` marks their wide rims, and without it nothing but
/// the robot casts any.
fn background(
    frame: &PlanFrame,
    (features, judged, borders): (&Raster<Feature>, &Raster<Difference>, &BorderColours),
    floor: &FloorModel,
    robot: Option<RobotTop>,
    shadows: Option<&Raster<bool>>,
) -> Raster<f32> {
    let half = half_shadow(frame, judged);
    // Without shadow, what is half dark beside lit floor is the blur of an edge.
    let rim = widened(&judged.map(|difference| difference.lit < SURE), 1);
    let lonely = lonely_shadow(frame, judged, robot);
    let width = features.width();
    Raster::from_fn(width, features.height(), |column, row| {
        let point = frame.point(column as f64, row as f64);
        let index = row * width + column;
        let seen = features.cells()[index];
        let distance = match frame.arena.beyond(point) {
            None => {
                let difference = judged.cells()[index];
                let of_robot = robot.is_some_and(|top| top.radii_from(point) < ROBOT_SHADOW);
                let blurred = !(shadows.is_some() && floor.shadow.is_some()) && rim.cells()[index];
                let distance = if lonely.cells()[index] {
                    difference.lit
                } else if blurred {
                    floor.off_any_shadow(floor.residual(point, seen), DEEPEST)
                } else if of_robot
                    || shadows.is_some_and(|soft| half.cells()[index] || soft.cells()[index])
                {
                    difference.floor
                } else if shadows.is_none() {
                    difference.lit
                } else {
                    difference.lit.min(difference.core)
                };
                ((distance - SURE) / (FOREIGN - SURE)).max(0.0)
            }
            Some((side, depth)) => borders.distance(side, depth * frame.scale, seen),
        };
        (distance * distance).min(1.0)
    })
}

/// How every cell differs from the floor's colours.
fn judge(
    frame: &PlanFrame,
    features: &Raster<Feature>,
    floor: &FloorModel,
    look: &Look,
) -> Raster<Difference> {
    let width = features.width();
    Raster::from_fn(width, features.height(), |column, row| {
        let point = frame.point(column as f64, row as f64);
        let difference = floor.difference(point, features.cells()[row * width + column]);
        if look.is_bright_floor(point) { difference.at_most(1.0) } else { difference }
    })
}

/// How surely cells are floor in shadow or lit floor; the shadow of border and robot says nothing.
fn shade(frame: &PlanFrame, judged: &Raster<Difference>, robot: Option<RobotTop>) -> Raster<f32> {
    let width = judged.width();
    Raster::from_fn(width, judged.height(), |column, row| {
        let point = frame.point(column as f64, row as f64);
        let of_robot = robot.is_some_and(|top| top.radii_from(point) < ROBOT_SHADOW);
        if of_robot || frame.arena.depth(point) < BORDER_SHADOW {
            return 0.0;
        }
        let difference = judged.cells()[row * width + column];
        if difference.lit < SURE {
            -1.0
        } else if difference.lit > FOREIGN {
            ((FOREIGN - difference.core) / (FOREIGN - SURE)).clamp(0.0, 1.0)
        } else {
            0.0
        }
    })
}

#[cfg(test)]
impl Evidence {
    /// A floor of brightness 0 on which `brightness` tells how bright it is elsewhere; what is below −0.5 is none of it.
    pub(super) fn drawn(frame: PlanFrame, brightness: impl Fn(Point) -> f32) -> Self {
        let (width, height) = frame.size();
        let features = Raster::from_fn(width, height, |column, row| {
            [brightness(frame.point(column as f64, row as f64)), 0.0, 0.0]
        });
        Self {
            frame,
            background: features.map(|seen| if seen[0] < -0.5 { 1.0 } else { 0.0 }),
            features,
            weight: Raster::filled(width, height, 1.0),
            shade: Raster::filled(width, height, 0.0),
            spread: [0.02; 3],
            borders: BorderColours::default(),
        }
    }
}
