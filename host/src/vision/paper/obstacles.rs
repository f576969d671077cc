//! The paper's method on a photo: its steps on the plan view, and obstacles in metres by its mask.
//!
//! The arena's map and the robot come from the modules that every method shares; the robot is taken out of
//! the mask, which the paper need not do, as its pictures show none. Metres in the arena frame.

use super::steps::{PaperSteps, paper_obstacles, paper_steps};
use crate::geometry::{Arena, Point, Rect};
use crate::shape::Shape;
use crate::vision::boxes::Bounded;
use crate::vision::camera::PlanMap;
use crate::vision::image::{CellRect, Photo, Raster, rectangles};
use crate::vision::plan_view::{PlanFrame, brightness_view, plan_view};
use crate::vision::robot::RobotTop;

/// Cells per metre of the paper's plan view, and the most cells along a side.
const PAPER_SCALE: f64 = 300.0;
const PAPER_CELLS: f64 = 1200.0;
/// Obstacles are at least this large, metres.
const LEAST_SIDE: f64 = 0.02;
/// Cells this close to the border, in cells, are blurred with it.
const BORDER_BLUR: f64 = 1.5;
/// How much larger than the robot's top the disc is that is taken out of the mask.
const ROBOT_RIM: f64 = 1.15;

/// The pictures of the steps, in the plan view.
#[derive(Clone, Debug, PartialEq)]
pub struct Steps {
    /// Where the plan view's cells lie.
    pub frame: PlanFrame,
    /// The plan view in linear light.
    pub view: Raster<[f32; 3]>,
    /// What the paper's steps made of it.
    pub paper: PaperSteps,
}

/// The paper's plan view is no finer than the photo.
fn paper_frame(map: &PlanMap, arena: Arena) -> PlanFrame {
    let middle = Point::new(arena.width / 2.0, arena.height / 2.0);
    let most = PAPER_SCALE.min(PAPER_CELLS / arena.width.max(arena.height));
    PlanFrame::new(arena, most.min(map.scale_at(middle)), 0.0)
}

/// What the paper's steps make of a photo.
pub(crate) fn steps(photo: &Photo, map: &PlanMap, arena: Arena, radius: f64) -> Steps {
    let frame = paper_frame(map, arena);
    let view = plan_view(photo, map, &frame);
    let paper = paper_steps(brightness_view(photo, map, &frame), frame.scale, radius);
    Steps { frame, view, paper }
}

/// Obstacles by the paper's mask, to a cell.
pub(crate) fn paper_rectangles(
    photo: &Photo,
    map: &PlanMap,
    arena: Arena,
    robot: Option<RobotTop>,
    left_out: &[Shape],
) -> Vec<Bounded> {
    let frame = paper_frame(map, arena);
    let obstacles = paper_obstacles(&brightness_view(photo, map, &frame));
    let mask = without(&obstacles, &frame, robot, left_out);
    let least = (LEAST_SIDE * frame.scale).max(2.5);
    let found = rectangles(&mask, least * least);
    let thick = found
        .into_iter()
        .filter(|cells| (cells.x1 - cells.x0).min(cells.y1 - cells.y0) as f64 >= least);
    let cell = 1.0 / frame.scale;
    thick.map(|cells| Bounded { rect: metres(&frame, cells), margin: [2.0 * cell; 4] }).collect()
}

/// The mask without the robot, without what is left out, and without the cells that are blurred with the
/// border.
fn without(
    mask: &Raster<bool>,
    frame: &PlanFrame,
    robot: Option<RobotTop>,
    left_out: &[Shape],
) -> Raster<bool> {
    let blur = BORDER_BLUR / frame.scale;
    Raster::from_fn(mask.width(), mask.height(), |column, row| {
        let point = frame.point(column as f64, row as f64);
        let inside = point.x > blur
            && point.y > blur
            && point.x < frame.arena.width - blur
            && point.y < frame.arena.height - blur;
        let of_robot = robot.is_some_and(|top| top.radii_from(point) < ROBOT_RIM);
        let is_marked = mask.get(column as i64, row as i64) == Some(true);
        let is_left_out = || left_out.iter().any(|place| place.distance(point) < blur);
        inside && !of_robot && is_marked && !is_left_out()
    })
}

fn metres(frame: &PlanFrame, cells: CellRect) -> Rect {
    let corner = |column: usize, row: usize| frame.point(column as f64 - 0.5, row as f64 - 0.5);
    let (upper_left, lower_right): (Point, Point) =
        (corner(cells.x0, cells.y0), corner(cells.x1, cells.y1));
    Rect::new(upper_left.x, lower_right.y, lower_right.x, upper_left.y)
}
