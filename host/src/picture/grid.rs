//! The grid method in pictures: border lines, mini-matrix, closed traps [Alghannam, Sec. II-B and III].

use super::floor::{Floor, metres};
use super::svg::Swatch;
use crate::geometry::{Point, Rect};
use crate::grid::{Area, AreaKind, EnlargedArena, MiniMatrix};
use crate::plan::GridStages;
use crate::scene::Scene;

/// The lines that the visible borders of the enlarged obstacles draw over the arena, as SVG.
pub fn border_lines(scene: &Scene, stages: &GridStages) -> String {
    let lines = stages.matrix.lines();
    let subtitle = format!(
        "{} obstacles grown by the robot's radius of {} cm and their margins; every visible border draws a line",
        scene.obstacles.len(),
        scene.robot_radius * 100.0
    );
    let mut floor = Floor::new(scene.arena, "Border lines cut the arena into areas", &subtitle);
    grown(&mut floor, &stages.arena);
    floor.obstacles(scene);
    let metres = |units: i32| f64::from(units) / crate::grid::UNITS_PER_METRE;
    for x in lines.xs.iter().map(|&x| metres(x)) {
        floor.polyline(&[Point::new(x, 0.0), Point::new(x, scene.arena.height)], "border-line");
    }
    for y in lines.ys.iter().map(|&y| metres(y)) {
        floor.polyline(&[Point::new(0.0, y), Point::new(scene.arena.width, y)], "border-line");
    }
    floor.finish(&[
        (Swatch::Fill("obstacle"), "obstacle"),
        (Swatch::Fill("grown"), "grown by the radius and margin"),
        (Swatch::Line("border-line"), "border line"),
    ])
}

/// The mini-matrix: every area with its number and its element 0, 1 or 2, as SVG.
pub fn mini_matrix(scene: &Scene, stages: &GridStages) -> String {
    let subtitle = format!(
        "{} × {} areas with the dead ring along the border; numbers run from the top left",
        stages.matrix.rows(),
        stages.matrix.columns()
    );
    let mut floor = Floor::new(scene.arena, "The mini-matrix", &subtitle);
    for area in stages.matrix.areas() {
        numbered(&mut floor, &stages.matrix, area, class(stages.matrix.kind(area)));
    }
    floor.finish(&[
        (Swatch::Fill("dead"), "0 unavailable"),
        (Swatch::Fill("live"), "1 available"),
        (Swatch::Fill("terminal"), "2 start and goal"),
    ])
}

/// The mini-matrix with its traps closed, as SVG.
pub fn closed_traps(scene: &Scene, stages: &GridStages) -> String {
    let subtitle = match stages.traps.len() {
        0 => "no area is almost surrounded by zeros: nothing to close".to_owned(),
        1 => "1 area almost surrounded by zeros became 0".to_owned(),
        count => format!("{count} areas almost surrounded by zeros became 0"),
    };
    let mut floor = Floor::new(scene.arena, "Traps are closed", &subtitle);
    for area in stages.closed.areas() {
        let is_trap = stages.traps.contains(&area);
        let class = if is_trap { "trap" } else { class(stages.closed.kind(area)) };
        numbered(&mut floor, &stages.closed, area, class);
    }
    floor.finish(&[
        (Swatch::Fill("trap"), "closed as a trap"),
        (Swatch::Fill("dead"), "0 unavailable"),
        (Swatch::Fill("live"), "1 available"),
        (Swatch::Fill("terminal"), "2 start and goal"),
    ])
}

/// The grown obstacles.
pub(super) fn grown(floor: &mut Floor, arena: &EnlargedArena) {
    for &rect in &arena.boxes {
        floor.rect(metres(rect), "grown");
    }
}

fn class(kind: AreaKind) -> &'static str {
    match kind {
        AreaKind::Dead => "dead",
        AreaKind::Available => "live",
        AreaKind::Terminal => "terminal",
    }
}

/// One area with its element in the middle and its number in the upper left corner, as far as there
/// is room.
fn numbered(floor: &mut Floor, matrix: &MiniMatrix, area: Area, class: &str) {
    let rect = metres(matrix.rect(area));
    floor.rect(rect, &format!("area {class}"));
    let (left, top) = floor.pixel(Point::new(rect.x0, rect.y1));
    let (right, bottom) = floor.pixel(Point::new(rect.x1, rect.y0));
    let (width, height) = (right - left, bottom - top);
    let size = (height * 0.5).min(width * 0.5).min(26.0);
    if size >= LEAST_TEXT {
        let middle = centre(rect);
        let (x, y) = floor.pixel(middle);
        let element = matrix.kind(area).element().to_string();
        floor.svg.text((x, y + 0.36 * size), "element", "middle", size, &element);
    }
    let number = area.number().to_string();
    // A digit is 0.64 of its height wide; the number must end before the element begins.
    let room = width / 2.0 - 0.35 * size - 4.0;
    let small = (height * 0.3).min(room / (0.64 * number.len() as f64)).min(13.0);
    if small >= LEAST_TEXT {
        floor.svg.text((left + 3.0, top + small + 2.0), "number", "start", small, &number);
    }
}

/// Text below this size is left out, pixels.
const LEAST_TEXT: f64 = 7.0;

fn centre(rect: Rect) -> Point {
    Point::new((rect.x0 + rect.x1) / 2.0, (rect.y0 + rect.y1) / 2.0)
}
