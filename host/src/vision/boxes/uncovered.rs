//! What no box explains: cells that are neither floor, shadow of a known light source, robot nor box.
//!
//! An answer that leaves out part of an obstacle leads a robot into it. So whatever the explanation by boxes
//! leaves is covered as well: where it sticks out of a box by little, by that box's margin; elsewhere by few
//! rectangles that follow its outline. Turned boxes, discs and thin walls thus lie inside what is reported,
//! larger than they are rather than smaller. Thin lines from one side of the arena to the other are taken for
//! joints or print on the floor, which the answer says. Metres in the arena frame; patches are sought in the
//! plan view.
//!
//! Deviation: the paper's obstacles are upright rectangles alone [Alghannam, Sec. II.A].

use super::evidence::widened;
use super::implausible::{goes_over_into_floor, is_part_of_robot};
use super::light::Lamp;
use super::projection::LeaningBox;
use super::refine::Bounded;
use super::shaped::{Patches, Shaped};
use crate::geometry::{Arena, Point, Rect};
use crate::scene::Obstacle;
use crate::vision::appearance::{FOREIGN, Look};
use crate::vision::image::{CellRect, LEAST_CELLS, Raster, around, cut, greatest, marked, regions};
use crate::vision::robot::RobotTop;

/// Cells this near to the border are blurred with it, and with the wall's foot: cells and metres.
const BORDER_CELLS: f64 = 2.0;
const BORDER_METRES: f64 = 0.004;
/// Cells this near to a box's outline are blurred with it.
const BOX_BLUR: f64 = 1.5;
/// How much larger than the robot's top the disc is in which nothing counts, with its shadow.
const ROBOT_RIM: f64 = 1.35;
const ROBOT_SHADOW: f64 = 2.5;
/// How far the soft rim of a shadow reaches beyond it, and the shadow of the border onto the floor, metres.
const HALF_SHADOW: f64 = 0.03;
const BORDER_SHADOW: f64 = 0.08;
/// A patch as dark as shadow is shadow where more than this share of it lies where one is cast.
const MOSTLY_CAST: f64 = 0.5;
/// What sticks out of a box by no more than this is a matter of its margin, metres.
const MOST_WIDENED: f64 = 0.015;
const MOST_WIDENED_LEANING: f64 = 0.03;
/// What is smaller is a matter of margins up to twice as wide, square metres.
const SLIVER: f64 = 0.0006;
/// Lines on a floor (joints, a printed grid) are no wider than this, metres, and reach two opposite sides of
/// the arena to within so much.
const LINE_WIDTH: f64 = 0.012;
const LINE_END: f64 = 0.04;
/// A strip along more than half of a side, or in a corner, is a wall's foot up to this width, metres.
const STRIP_WIDTH: f64 = 0.06;
/// The visible foot of a wall is no wider than this, metres.
const WALL_FOOT: f64 = 0.035;
/// A patch of this size may have a shape of its own, square metres and cells.
const LEAST_SHAPED: f64 = 0.0002;
const LEAST_SHAPED_CELLS: f64 = 24.0;
/// Cells this near to a shape's outline are blurred with it.
const SHAPE_BLUR: f64 = 2.0;
/// Half of the least cells of a patch are this many times as far from floor as the limit.
const LEAST_PEAK: f32 = 1.8;

/// What explains a picture so far.
pub(crate) struct Explained<'a> {
    pub(crate) look: &'a Look,
    /// The outlines of boxes.
    pub(crate) boxes: &'a [LeaningBox],
    /// The camera's foot point, if boxes lean.
    pub(crate) foot: Option<Point>,
    pub(crate) lamp: Option<Lamp>,
    pub(crate) robot: Option<RobotTop>,
}

impl Explained<'_> {
    /// The shapes of what upright boxes explain badly, with the boxes that they replace.
    pub(super) fn shapes(&self, distances: &Raster<f32>) -> Vec<Shaped> {
        let foreign = distances.map(|distance| distance > FOREIGN);
        let (frame, width) = (self.look.view, foreign.width());
        let (boxes, foot) = (self.boxes, self.foot);
        let is_lit = self.lamp.is_some();
        let patches = Patches { frame, distances, boxes, foot, is_lit };
        let least = (LEAST_SHAPED * frame.scale.powi(2)).max(LEAST_SHAPED_CELLS) as usize;
        let is_shape = |patch: &Vec<usize>| {
            let rect = self.metres(around(patch, width));
            patch.len() >= least
                && is_sure(distances, patch)
                && !is_along_wall(rect, frame.arena)
                && !joins_opposite_sides(rect, frame.arena)
                && !is_part_of_robot(rect, self.robot)
                && !goes_over_into_floor(patch, self.look)
        };
        regions(&foreign)
            .iter()
            .filter(|patch| is_shape(patch))
            .filter_map(|patch| patches.shape_of(patch))
            .collect()
    }

    /// Widens the margins of `bounded`, one for each of the boxes, by what sticks out a little, and adds
    /// rectangles around all else that neither they nor `shapes` explain. Whether lines on the floor were
    /// left out.
    pub(crate) fn complete(
        &self,
        distances: &Raster<f32>,
        shapes: &[Obstacle],
        bounded: &mut Vec<Bounded>,
    ) -> bool {
        let blur = SHAPE_BLUR / self.look.view.scale;
        let is_of_shape = |point: Point| {
            let near = |of: &Obstacle| of.footprint.distance(point) < of.largest_margin() + blur;
            shapes.iter().any(near)
        };
        let view = &self.look.view;
        let distances = Raster::from_fn(distances.width(), distances.height(), |column, row| {
            let distance = distances.row(row)[column];
            let point = view.point(column as f64, row as f64);
            let is_explained = || self.is_of_box(point) || is_of_shape(point);
            if distance <= 0.0 || is_explained() { 0.0 } else { distance }
        });
        let foreign = distances.map(|distance| distance > FOREIGN);
        let arena = self.look.frame.arena;
        let width = foreign.width();
        let outline = |seen: &LeaningBox| self.foot.map_or(seen.base, |foot| seen.bounds(foot));
        let outlines: Vec<Rect> = self.boxes.iter().map(outline).collect();
        let (mut patches, mut has_lines) = (Vec::new(), false);
        for patch in regions(&foreign) {
            if joins_opposite_sides(self.metres(around(&patch, width)), arena) {
                patches.extend(self.thick(&patch, width));
                has_lines = true;
            } else {
                patches.push(patch);
            }
        }
        for patch in &patches {
            self.add(patch, width, is_sure(&distances, patch), &outlines, bounded);
        }
        has_lines
    }

    /// Adds a patch to what is reported: to the margins of `outlines` where it sticks out of one a little, as
    /// rectangles of its own elsewhere if it is surely no noise.
    fn add(
        &self,
        patch: &[usize],
        width: usize,
        is_sure: bool,
        outlines: &[Rect],
        bounded: &mut Vec<Bounded>,
    ) {
        let rect = self.metres(around(patch, width));
        if !is_sure {
            widen(rect, MOST_WIDENED, with_margins(outlines, bounded));
            return;
        }
        let arena = self.look.frame.arena;
        if is_along_wall(rect, arena)
            || is_part_of_robot(rect, self.robot)
            || goes_over_into_floor(patch, self.look)
        {
            return;
        }
        let most = if self.foot.is_some() { MOST_WIDENED_LEANING } else { MOST_WIDENED };
        let mut left = patch.to_vec();
        left.retain(|&cell| {
            !widen(self.metres(around(&[cell], width)), most, with_margins(outlines, bounded))
        });
        // A patch of which nothing was taken is one region still; noise makes thousands of these.
        let whole = left.len() == patch.len();
        let rest = if whole { vec![left] } else { regions(&marked(&left, width)) };
        for region in rest {
            let rect = self.metres(around(&region, width));
            let is_sliver = self.foot.is_some()
                && (region.len() as f64) < SLIVER * self.look.view.scale.powi(2);
            if !is_sliver || !widen(rect, 2.0 * most, with_margins(outlines, bounded)) {
                bounded.extend(self.cover(&region, width));
            }
        }
    }

    /// The regions of a patch that are thicker than lines on a floor.
    fn thick(&self, patch: &[usize], width: usize) -> Vec<Vec<usize>> {
        let mask = marked(patch, width);
        let reach = (LINE_WIDTH * self.look.view.scale / 2.0).ceil().max(1.0) as i64;
        let thin = widened(&mask.map(|marked| !marked), reach);
        let kept = widened(&thin.map(|thin| !thin), reach + 1);
        let rows = kept.height();
        let kept = Raster::from_fn(width, rows, |x, y| {
            kept.cells()[y * width + x] && mask.cells()[y * width + x]
        });
        regions(&kept)
    }

    /// Few rectangles, with their margins, around all cells of a patch.
    fn cover(&self, patch: &[usize], width: usize) -> Vec<Bounded> {
        let (rects, rest) = greatest(patch, width);
        let margin = [0.5 / self.look.view.scale; 4];
        let bounded = |rect| Bounded { rect: self.metres(rect), margin };
        let mut covers: Vec<Bounded> = rects.into_iter().map(bounded).collect();
        for region in rest {
            let rect = self.metres(around(&region, width));
            if !widen(
                rect,
                MOST_WIDENED,
                covers.iter_mut().map(|cover| (cover.rect, &mut cover.margin)),
            ) {
                covers.extend(cut(&region, width).into_iter().map(bounded));
            }
        }
        covers
    }

    /// The metres that cells of the view span.
    fn metres(&self, cells: CellRect) -> Rect {
        let point = |x: usize, y: usize| self.look.view.point(x as f64 - 0.5, y as f64 - 0.5);
        let (low, high) = (point(cells.x0, cells.y1), point(cells.x1, cells.y0));
        Rect::new(low.x, low.y, high.x, high.y)
    }

    /// How far from floor every cell is that is neither floor, shadow of a known light nor robot, standard
    /// deviations; 0 for the others.
    pub(super) fn distances(&self) -> Raster<f32> {
        let (frame, features) = (&self.look.view, &self.look.features);
        let border = (BORDER_CELLS / frame.scale).max(BORDER_METRES);
        let width = features.width();
        let mut shaded = Raster::filled(width, features.height(), false);
        let mut floors = Raster::filled(width, features.height(), 0.0_f32);
        let judged = Raster::from_fn(width, features.height(), |column, row| {
            let point = frame.point(column as f64, row as f64);
            if self.look.floor.inside(point) < border || self.look.is_bright_floor(point) {
                return 0.0;
            }
            let difference =
                self.look.floor.difference(point, features.cells()[row * width + column]);
            let is_left_out = || self.look.is_left_out(point, frame.scale);
            if difference.lit <= FOREIGN || self.is_of_robot(point) || is_left_out() {
                return 0.0;
            }
            floors.set(column as i64, row as i64, difference.floor);
            if difference.floor <= FOREIGN {
                shaded.set(column as i64, row as i64, true);
            }
            difference.lit
        });
        self.without_shadow(judged, &floors, &shaded)
    }

    /// Distances with 0 for the cells of shadow: of those that are as dark as shadow the patches most of
    /// which lie where a known light source or the robot casts one, and what of the others lies there.
    fn without_shadow(
        &self,
        mut distances: Raster<f32>,
        floors: &Raster<f32>,
        shaded: &Raster<bool>,
    ) -> Raster<f32> {
        let width = distances.width();
        let casts: Vec<(LeaningBox, Point)> = self
            .lamp
            .iter()
            .flat_map(|lamp| {
                self.boxes.iter().filter_map(|&seen| Some((lamp.shadow(seen)?, lamp.foot)))
            })
            .collect();
        for patch in regions(shaded) {
            let is_cast = |cell: &usize| {
                let (column, row) = (cell % width, cell / width);
                self.is_in_shadow(self.look.view.point(column as f64, row as f64), &casts)
            };
            let (cast, other): (Vec<usize>, Vec<usize>) =
                patch.iter().partition(|cell| is_cast(cell));
            let whole = cast.len() as f64 > MOSTLY_CAST * patch.len() as f64;
            let explained = cast.iter().chain(other.iter().filter(|_| whole));
            explained.for_each(|&cell| distances.cells_mut()[cell] = 0.0);
        }
        for cell in 0..distances.cells().len() {
            let floor = floors.cells()[cell];
            if floor > FOREIGN && floor < distances.cells()[cell] {
                let point = self.look.view.point((cell % width) as f64, (cell / width) as f64);
                if self.is_in_shadow(point, &casts) {
                    distances.cells_mut()[cell] = floor;
                }
            }
        }
        distances
    }

    fn is_of_robot(&self, point: Point) -> bool {
        self.robot.is_some_and(|top| top.centre.distance(point) < ROBOT_RIM * top.radius)
    }

    fn is_of_box(&self, point: Point) -> bool {
        let blur = BOX_BLUR / self.look.view.scale;
        self.boxes.iter().any(|seen| seen.spans(self.foot, point, blur))
    }

    /// Whether the shadow of a box, of the border or of the robot may lie there.
    fn is_in_shadow(&self, point: Point, casts: &[(LeaningBox, Point)]) -> bool {
        let near = |top: RobotTop| top.centre.distance(point) < ROBOT_SHADOW * top.radius;
        let of_border = self.lamp.is_some() && self.look.floor.inside(point) < BORDER_SHADOW;
        of_border
            || self.robot.is_some_and(near)
            || casts.iter().any(|&(shadow, foot)| shadow.spans(Some(foot), point, HALF_SHADOW))
    }
}

/// Whether a patch is surely no noise.
fn is_sure(distances: &Raster<f32>, patch: &[usize]) -> bool {
    let peaks = patch.iter().filter(|&&cell| distances.cells()[cell] > LEAST_PEAK * FOREIGN);
    patch.len() >= LEAST_CELLS && peaks.count() >= LEAST_CELLS / 2
}

/// Whether a rectangle lies in the strip along a side of the arena where the wall's foot is.
fn is_along_wall(rect: Rect, arena: Arena) -> bool {
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
fn joins_opposite_sides(rect: Rect, arena: Arena) -> bool {
    rect.x0 < LINE_END && rect.x1 > arena.width - LINE_END
        || rect.y0 < LINE_END && rect.y1 > arena.height - LINE_END
}

/// Every outline with the margins of its box.
fn with_margins<'a>(
    outlines: &'a [Rect],
    bounded: &'a mut [Bounded],
) -> impl Iterator<Item = (Rect, &'a mut [f64; 4])> {
    outlines.iter().copied().zip(bounded.iter_mut().map(|bounded| &mut bounded.margin))
}

/// Widens the margins of the outline beside which a rectangle lies; false if there is none.
fn widen<'a>(
    rect: Rect,
    most: f64,
    outlines: impl Iterator<Item = (Rect, &'a mut [f64; 4])>,
) -> bool {
    let beyond = |outline: Rect| {
        [outline.x0 - rect.x0, outline.y0 - rect.y0, rect.x1 - outline.x1, rect.y1 - outline.y1]
    };
    let nearest = outlines
        .map(|(outline, margin)| (beyond(outline), margin))
        .map(|(beyond, margin)| (beyond.into_iter().fold(0.0, f64::max), beyond, margin))
        .min_by(|a, b| a.0.total_cmp(&b.0));
    let Some((_, beyond, margin)) = nearest.filter(|nearest| nearest.0 < most) else {
        return false;
    };
    margin.iter_mut().zip(beyond).for_each(|(margin, beyond)| *margin = margin.max(beyond));
    true
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::shape::Shape;
    use crate::vision::detect::{DetectOptions, Detection, detect};
    use crate::vision::image::Photo;

    const ARENA: Arena = Arena { width: 1.2, height: 0.9 };
    /// Pixels per metre of the drawings: walls of 5 mm have two.
    const SCALE: f64 = 400.0;
    /// What is drawn may stick out of shapes and margins by two pixels, and by one more where a slightly turned
    /// edge passes for the visible side of a tall box, metres.
    const TOLERANCE: f64 = 3.0 / SCALE;

    /// A light floor with a dark frame and with something dark on it, seen straight from above.
    fn seen(is_dark: impl Fn(Point) -> bool) -> Detection {
        let (columns, rows) = (520, 400);
        let mut noise = fastrand::Rng::with_seed(7);
        let pixels = (0..columns * rows).map(|i| {
            let x = (f64::from(i % columns) - 20.0 + 0.5) / SCALE;
            let y = ARENA.height - (f64::from(i / columns) - 20.0 + 0.5) / SCALE;
            let point = Point::new(x, y);
            let on_floor = x > 0.0 && y > 0.0 && x < ARENA.width && y < ARENA.height;
            [if !on_floor || is_dark(point) { 40 } else { 220 } + noise.u8(0..6); 3]
        });
        let photo = Photo::from_rgb(columns as usize, rows as usize, pixels.collect()).unwrap();
        let corners = [[19.5, 379.5], [499.5, 379.5], [499.5, 19.5], [19.5, 19.5]];
        let options = DetectOptions { corners: Some(corners), ..DetectOptions::default() };
        detect(&photo, ARENA, &options).unwrap()
    }

    /// How far a dark point sticks out of all shapes with their margins at most, metres.
    fn out_by(seen: &Detection, is_dark: impl Fn(Point) -> bool) -> f64 {
        let distance = |point: Point, obstacle: &Obstacle| match obstacle.footprint.as_rect() {
            Some(rect) => rect.widened(obstacle.margin).distance(point),
            None => obstacle.footprint.distance(point) - obstacle.largest_margin(),
        };
        let place = |i: u32| Point::new(f64::from(i % 480) / SCALE, f64::from(i / 480) / SCALE);
        let nearest = |point: Point| {
            seen.obstacles.iter().map(|obstacle| distance(point, obstacle)).fold(9.0, f64::min)
        };
        (0..480 * 360).map(place).filter(|&p| is_dark(p)).map(nearest).fold(0.0, f64::max)
    }

    /// Whether a point lies in a rectangle of half sides `a` and `b` turned by `angle` about (0.6, 0.45).
    fn in_turned(point: Point, angle: f64, a: f64, b: f64) -> bool {
        let (x, y) = (point.x - 0.6, point.y - 0.45);
        let (sin, cos) = angle.sin_cos();
        (x * cos + y * sin).abs() < a && (y * cos - x * sin).abs() < b
    }

    #[test]
    fn turned_boxes_lie_inside_what_is_reported() {
        for degrees in [5.0_f64, 17.0, 30.0, 45.0] {
            let is_dark = |point: Point| in_turned(point, degrees.to_radians(), 0.15, 0.08);
            let seen = seen(is_dark);
            let out = out_by(&seen, is_dark);
            assert!(out < TOLERANCE, "{degrees}: {out} {:?}", seen.obstacles);
        }
    }

    /// A quarter of a pixel more or less at every edge is two per cent of the area of such a box.
    #[test]
    fn a_turned_box_and_a_disc_are_one_shape_each() {
        let is_dark = |point: Point| in_turned(point, 0.5, 0.15, 0.08);
        let [turned] = &seen(is_dark).obstacles[..] else {
            panic!("{:?}", seen(is_dark).obstacles)
        };
        let Shape::Polygon(polygon) = &turned.footprint else { panic!("{turned:?}") };
        assert_eq!(polygon.corners().len(), 4);
        assert!((polygon.area() - 0.048).abs() < 0.02 * 0.048, "{}", polygon.area());
        let disc = |point: Point| point.distance(Point::new(0.6, 0.45)) < 0.11;
        let [round] = &seen(disc).obstacles[..] else { panic!("{:?}", seen(disc).obstacles) };
        let Shape::Circle(circle) = round.footprint else { panic!("{round:?}") };
        assert!((circle.radius - 0.11).abs() < 0.25 / SCALE, "{circle:?}");
        assert!(circle.centre.distance(Point::new(0.6, 0.45)) < 0.001, "{circle:?}");
    }

    #[test]
    fn discs_triangles_and_walls_lie_inside_what_is_reported() {
        let disc = |p: Point| p.distance(Point::new(0.6, 0.45)) < 0.11;
        let triangle = |p: Point| p.y > 0.3 && p.y < 0.3 + 0.8 * (p.x - 0.4) && p.x < 0.8;
        let walls = |p: Point| {
            let thick = |x: f64, width: f64| p.x > x && p.x < x + width;
            p.y > 0.2 && p.y < 0.7 && (thick(0.3, 0.02) || thick(0.5, 0.01) || thick(0.7, 0.005))
        };
        let shapes: [&dyn Fn(Point) -> bool; 3] = [&disc, &triangle, &walls];
        for (index, is_dark) in shapes.iter().enumerate() {
            let seen = seen(is_dark);
            assert!(out_by(&seen, is_dark) < TOLERANCE, "{index}: {:?}", seen.obstacles);
        }
    }

    #[test]
    fn an_empty_floor_has_no_obstacles_and_lines_from_side_to_side_are_floor_but_said() {
        let empty = seen(|_| false);
        assert!(empty.obstacles.is_empty() && empty.warnings.is_empty(), "{empty:?}");
        let lines = seen(|p| (p.x - 0.4).abs() < 0.003 || (p.y - 0.5).abs() < 0.003);
        assert!(lines.obstacles.is_empty(), "{:?}", lines.obstacles);
        assert!(lines.warnings.iter().any(|warning| warning.contains("thin lines")));
    }
}
