//! What was taken for a box but cannot be one: the face of a wall, a part of the robot, floor that merely
//! grows darker, lines across it; and strips that tell that the arena itself was mistaken.
//!
//! Deviation: the paper keeps every area that is not white [Alghannam, Sec. II]. These are no obstacles
//! for reasons that colours alone do not tell. Metres in the arena frame.

use super::refine::at;
use crate::geometry::{Arena, Point, Rect, Side};
use crate::vision::appearance::{FOREIGN, Feature, Look};
use crate::vision::robot::RobotTop;

/// The face of a wall, or its blur, is at most this wide, metres; a gap as narrow leads nowhere.
const WALL_FACE: f64 = 0.035;
/// A strip along a side: its width at most, metres, and its length at least, a share of the side.
const WIDEST_STRIP: f64 = 0.08;
const STRIP_SHARE: f64 = 0.8;
/// A strip along more than half of a side, or in a corner, is a wall's foot up to this width, metres.
const STRIP_WIDTH: f64 = 0.06;
/// The visible foot of a wall is no wider than this, metres.
const WALL_FOOT: f64 = 0.035;
/// Lines on a floor reach two opposite sides of the arena to within so much, metres.
const LINE_END: f64 = 0.04;
/// What lies in a disc of so many radii about the robot's top belongs to it or to its shadow.
const ROBOT_REACH: f64 = 1.2;
/// Places along an edge where its step is measured, and half the distance across it: metres, and cells.
const PLACES: usize = 24;
const ACROSS: f64 = 0.010;
const ACROSS_CELLS: f64 = 2.0;
/// At least one edge of a box steps by so much (natural logarithms): less than half of the 0.12 by which
/// the faintest box on the plainest floor is foreign to it.
const LEAST_STEP: f32 = 0.05;
/// Of a box of which only one edge is seen at least this share is no floor.
const LEAST_FOREIGN: f64 = 0.5;

/// Whether a rectangle is as thin as the visible face of a wall and lies along one.
pub(crate) fn is_part_of_wall(rect: Rect, arena: Arena) -> bool {
    let thin =
        |low: f64, high: f64, length: f64| high - low < WALL_FACE && (low <= 0.0 || high >= length);
    thin(rect.x0, rect.x1, arena.width) || thin(rect.y0, rect.y1, arena.height)
}

/// On how many of the arena's sides a narrow strip lies from end to end.
///
/// On three or four that is the inner face of the wall: what was taken for its foot is its top.
pub(crate) fn lined_sides(rects: &[Rect], arena: Arena) -> usize {
    let Arena { width, height } = arena;
    let long = |from: f64, to: f64, length: f64| to - from > STRIP_SHARE * length;
    let lines = |side: Side, r: &Rect| match side {
        Side::Left => r.x0 <= 0.0 && r.x1 < WIDEST_STRIP && long(r.y0, r.y1, height),
        Side::Lower => r.y0 <= 0.0 && r.y1 < WIDEST_STRIP && long(r.x0, r.x1, width),
        Side::Right => r.x1 >= width && width - r.x0 < WIDEST_STRIP && long(r.y0, r.y1, height),
        Side::Upper => r.y1 >= height && height - r.y0 < WIDEST_STRIP && long(r.x0, r.x1, width),
    };
    Side::EDGES.into_iter().filter(|&side| rects.iter().any(|rect| lines(side, rect))).count()
}

/// Whether a rectangle has its middle where the robot stands: no box can stand there too.
pub(crate) fn is_part_of_robot(rect: Rect, robot: Option<RobotTop>) -> bool {
    let middle = Point::new((rect.x0 + rect.x1) / 2.0, (rect.y0 + rect.y1) / 2.0);
    robot.is_some_and(|top| top.radii_from(middle) < ROBOT_REACH)
}

/// Whether no edge of an outline can be seen: then it is floor on which the light falls off.
pub(crate) fn fades_into_floor(outline: Rect, look: &Look) -> bool {
    let steps = steps(outline, look);
    !steps.is_empty() && steps.iter().all(|&step| step < LEAST_STEP)
}

/// Whether a patch of cells of the view goes over into the floor around it without a step, as the light does.
///
/// A rectangle around it would not tell: that of a thin turned wall has no edges.
pub(super) fn goes_over_into_floor(patch: &[usize], look: &Look) -> bool {
    let width = look.features.width();
    let cells: std::collections::HashSet<usize> = patch.iter().copied().collect();
    let (mut sum, mut count) = (0.0, 0_usize);
    for &cell in patch {
        let (x, y) = ((cell % width) as i64, (cell / width) as i64);
        for (dx, dy) in [(1, 0), (-1, 0), (0, 1), (0, -1)] {
            let at = |steps: i64| look.features.get(x + steps * dx, y + steps * dy);
            let next = usize::try_from((y + dy) * width as i64 + x + dx);
            let is_rim = next.is_ok_and(|next| !cells.contains(&next));
            if let (true, Some(inside), Some(outside)) = (is_rim, at(0), at(ACROSS_CELLS as i64)) {
                let square: f32 = (0..3).map(|part| (inside[part] - outside[part]).powi(2)).sum();
                sum += square.sqrt();
                count += 1;
            }
        }
    }
    count > 0 && sum < LEAST_STEP * count as f32
}

/// Whether a box has but one edge that can be seen and is mostly floor: a fold or a seam may pass beside a
/// place where the light falls off.
pub(crate) fn is_faint_floor(outline: Rect, look: &Look) -> bool {
    let steps = steps(outline, look);
    let seen = steps.iter().filter(|&&step| step >= LEAST_STEP).count();
    steps.len() > 2 && seen < 2 && foreign_share(outline, look) < LEAST_FOREIGN
}

/// How much the mean colour changes across each edge of an outline that lies on the arena.
fn steps(outline: Rect, look: &Look) -> Vec<f32> {
    let arena = look.frame.arena;
    let across = ACROSS.max(ACROSS_CELLS / look.frame.scale);
    let edges: [f64; 4] = outline.into();
    let walls = [0.0, 0.0, arena.width, arena.height];
    let free = Side::EDGES
        .into_iter()
        .filter(|&side| (edges[side.edge()] - walls[side.edge()]).abs() > 2.0 * across);
    free.map(|side| step(outline, side, across, look)).collect()
}

/// The share of a rectangle that is not floor.
fn foreign_share(rect: Rect, look: &Look) -> f64 {
    let share =
        |i: usize, low: f64, high: f64| low + (high - low) * (i as f64 + 0.5) / PLACES as f64;
    let is_foreign = |&index: &usize| {
        let (x, y) = (index % PLACES, index / PLACES);
        let point = Point::new(share(x, rect.x0, rect.x1), share(y, rect.y0, rect.y1));
        look.difference_at(point).is_some_and(|difference| difference.lit > FOREIGN)
    };
    (0..PLACES * PLACES).filter(is_foreign).count() as f64 / (PLACES * PLACES) as f64
}

/// How much the mean colour changes across an edge.
fn step(outline: Rect, side: Side, across: f64, look: &Look) -> f32 {
    let mut sum: Feature = [0.0; 3];
    for place in 0..PLACES {
        let along = (place as f64 + 0.5) / PLACES as f64;
        let seen = |outward: f64| look.seen_at(at(outline, side, along, outward));
        if let (Some(inside), Some(outside)) = (seen(-across), seen(across)) {
            sum.iter_mut().zip(inside).zip(outside).for_each(|((sum, a), b)| *sum += a - b);
        }
    }
    sum.iter().map(|part| (part / PLACES as f32).powi(2)).sum::<f32>().sqrt()
}

/// Whether a rectangle lies in the strip along a side of the arena where the wall's foot is.
pub(super) fn is_along_wall(rect: Rect, arena: Arena) -> bool {
    let Arena { width, height } = arena;
    let along = |low: f64, high: f64, across: f64, length: f64, whole: f64| {
        let strip = if length > 0.5 * whole { STRIP_WIDTH } else { WALL_FOOT };
        high < strip || low > across - strip
    };
    let is_in_corner = [(rect.x0, rect.x1, width), (rect.y0, rect.y1, height)]
        .into_iter()
        .all(|(low, high, across)| high < STRIP_WIDTH || low > across - STRIP_WIDTH);
    is_in_corner
        || along(rect.x0, rect.x1, width, rect.y1 - rect.y0, height)
        || along(rect.y0, rect.y1, height, rect.x1 - rect.x0, width)
}

/// Whether a rectangle reaches from one side of the arena to the opposite one.
pub(super) fn joins_opposite_sides(rect: Rect, arena: Arena) -> bool {
    rect.x0 < LINE_END && rect.x1 > arena.width - LINE_END
        || rect.y0 < LINE_END && rect.y1 > arena.height - LINE_END
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::vision::camera::PlanMap;
    use crate::vision::image::Photo;

    #[test]
    fn faces_of_walls_are_no_boxes() {
        let arena = Arena { width: 2.0, height: 1.0 };
        assert!(is_part_of_wall(Rect::new(0.0, 0.2, 0.03, 0.9), arena));
        assert!(is_part_of_wall(Rect::new(0.4, 0.98, 0.9, 1.0), arena));
        assert!(!is_part_of_wall(Rect::new(0.0, 0.2, 0.05, 0.9), arena));
        assert!(!is_part_of_wall(Rect::new(0.1, 0.2, 0.13, 0.9), arena));
    }

    #[test]
    fn strips_along_the_sides_are_counted_and_a_box_at_a_wall_is_none() {
        let arena = Arena { width: 2.0, height: 1.0 };
        let strips = [
            Rect::new(0.0, 0.05, 0.04, 1.0),
            Rect::new(0.0, 0.0, 1.95, 0.04),
            Rect::new(1.96, 0.05, 2.0, 0.95),
            Rect::new(0.4, 0.95, 1.2, 1.0),
        ];
        assert_eq!(lined_sides(&strips, arena), 3);
        assert_eq!(lined_sides(&strips[3..], arena), 0);
    }

    #[test]
    fn a_box_does_not_stand_where_the_robot_does() {
        let top = RobotTop {
            centre: Point::new(0.5, 0.5),
            radius: 0.075,
            heading: 0.0,
            certainty: 1.0,
            base: Point::new(0.5, 0.5),
        };
        assert!(is_part_of_robot(Rect::new(0.42, 0.45, 0.50, 0.55), Some(top)));
        assert!(!is_part_of_robot(Rect::new(0.58, 0.45, 0.68, 0.55), Some(top)));
        assert!(!is_part_of_robot(Rect::new(0.42, 0.45, 0.50, 0.55), None));
    }

    #[test]
    fn floor_that_darkens_slowly_has_no_edges_and_a_faint_box_has() {
        // 100 pixels a metre; towards the left the light falls off, on the right there is a faint box.
        let faint = Rect::new(1.4, 0.4, 1.6, 0.7);
        let pixels = (0..200 * 150).map(|i| {
            let (x, y) = (f64::from(i % 200), f64::from(i / 200));
            let (metres_x, metres_y) = ((x + 0.5) / 100.0, (149.5 - y) / 100.0);
            let on_box = faint.contains(Point::new(metres_x, metres_y));
            [(if on_box { 178.0 } else { 200.0 } - 40.0 * (1.0 - metres_x / 0.6).max(0.0)) as u8; 3]
        });
        let photo = Photo::from_rgb(200, 150, pixels.collect()).unwrap();
        let arena = Arena { width: 2.0, height: 1.5 };
        let corners = [[-0.5, 149.5], [199.5, 149.5], [199.5, -0.5], [-0.5, -0.5]];
        let map = PlanMap::from_corners(&photo, arena, corners, 0.0).unwrap();
        let look = Look::at(&photo, &map, arena).unwrap();
        assert!(fades_into_floor(Rect::new(0.0, 0.3, 0.25, 0.9), &look));
        assert!(!fades_into_floor(faint, &look));
    }
}
