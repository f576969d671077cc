//! Which cells of the plan view are neither floor, shadow of a known light, robot nor the border's foot.
//!
//! An edge is blurred over some cells, and so is what differs from floor: of a thing of high contrast the outermost
//! cells that differ are mostly floor. The edge runs where half of the light is the floor's: for a thing whose light is
//! e^d times that of the floor at d' = ln((1 + e^d) / 2), nearer to the floor if the thing is dark.
//! Distances in standard deviations of the floor's colour; metres in the arena frame.

use super::evidence::{BORDER_SHADOW, DEEPEST, ROBOT_SHADOW};
use super::floor_lines::{FloorLines, thick};
use super::implausible::joins_opposite_sides;
use super::light::Lamp;
use super::projection::LeaningBox;
use super::robot_shadow::is_robot_shadow;
use super::shade::{HALF_SHADOW, widened};
use super::uncovered::Explained;
use crate::geometry::Point;
use crate::vision::appearance::{FOREIGN, Look};
use crate::vision::image::{Raster, around, regions};
use crate::vision::robot::RobotTop;

/// Cells this near to the border are blurred with it, and with the wall's foot: cells and metres.
const BORDER_CELLS: f64 = 2.0;
const BORDER_METRES: f64 = 0.004;
/// How much larger than the robot's top the disc is in which nothing counts.
const ROBOT_RIM: f64 = 1.35;
/// Cells this near to that disc are blurred with it.
const ROBOT_BLUR: f64 = 2.0;
/// A patch as dark as shadow is shadow where more than this share of it lies where one is cast.
const MOSTLY_CAST: f64 = 0.5;
/// The visible foot of a wall is no wider than this, metres, and so many times as long as it is wide.
const WALL_FOOT: f64 = 0.035;
const FOOT_LENGTHS: f64 = 8.0;
/// A thing differs from the floor as much as it does most within so many cells.
const NEAR_CELLS: i64 = 3;
/// The greatest difference of light, a natural logarithm, that tells where its half is.
const MOST_DEPTH: f32 = 2.0;
/// No robot passes a gap as narrow as this, metres: what lies on both sides is one thing.
const CLOSED_GAP: f64 = 0.008;

/// What differs from the floor.
pub(super) struct Foreign {
    /// How far from floor each cell is; 0 where nothing is searched for.
    pub(super) distances: Raster<f32>,
    /// How far inside of the nearest edge it is: at least 1 inside and in narrow gaps, below 1 outside.
    pub(super) levels: Raster<f32>,
    /// Whether lines on the floor were left out.
    pub(super) has_lines: bool,
}

impl Foreign {
    /// What differs from the floor by so much as a look shows.
    fn of(distances: Raster<f32>, has_lines: bool, look: &Look) -> Self {
        let scale = look.view.scale;
        let mut levels = levels(&distances, look);
        let reach = (CLOSED_GAP / 2.0 * scale).round().max(1.0) as i64;
        let joined = widened(&levels.map(|level| level >= 1.0), reach);
        // Beside open floor nothing is filled: the steps of a turned edge are no gaps.
        let open = widened(&joined.map(|joined| !joined), reach + 1);
        let closed = levels.cells_mut().iter_mut().zip(open.cells()).filter(|(_, open)| !**open);
        closed.for_each(|(level, _)| *level = level.max(1.0));
        Self { distances, levels, has_lines }
    }

    /// The cells that differ from the floor, and those between them.
    pub(super) fn mask(&self) -> Raster<bool> {
        let cells = self.distances.cells().iter().zip(self.levels.cells());
        let mask = cells.map(|(&distance, &level)| distance > FOREIGN || level >= 1.0);
        Raster::from_cells(self.levels.width(), mask.collect())
    }
}

/// How far inside of the nearest edge each cell is. What lies deep in a patch is inside of it, whatever its
/// pattern.
fn levels(distances: &Raster<f32>, look: &Look) -> Raster<f32> {
    let greatest = extreme(distances, f32::max);
    let least = extreme(distances, f32::min);
    let width = distances.width();
    let cells = distances.cells().iter().zip(greatest.cells()).zip(least.cells()).enumerate();
    let level = |(cell, ((&distance, &greatest), &least)): (usize, ((&f32, &f32), &f32))| {
        if distance <= 0.0 || least > FOREIGN {
            return distance / FOREIGN;
        }
        let point = look.cell_point(cell);
        let is_dark = look.floor.residual(point, look.features.cells()[cell])[0] < 0.0;
        let depth = greatest.max(FOREIGN) * look.floor.spread[0];
        let half = half_light(if is_dark { -depth } else { depth });
        (distance / (half * greatest.max(FOREIGN))).min(distance / FOREIGN)
    };
    Raster::from_cells(width, cells.map(level).collect())
}

/// Which part of the logarithm `d` of a light over the floor's is that of the mean of both; more contrast than
/// [`MOST_DEPTH`] is glare or the end of the scale.
fn half_light(d: f32) -> f32 {
    let d = d.clamp(-MOST_DEPTH, MOST_DEPTH);
    f32::midpoint(1.0, d.exp()).ln() / d
}

/// The extreme of the values within [`NEAR_CELLS`] columns and rows of each cell.
fn extreme(values: &Raster<f32>, of: fn(f32, f32) -> f32) -> Raster<f32> {
    let along = |values: &Raster<f32>, (i, j): (i64, i64)| {
        Raster::from_fn(values.width(), values.height(), |column, row| {
            let at = |k: i64| values.get(column as i64 + k * i, row as i64 + k * j);
            let here = values.row(row)[column];
            (-NEAR_CELLS..=NEAR_CELLS).filter_map(at).fold(here, of)
        })
    };
    along(&along(values, (1, 0)), (0, 1))
}

impl Explained<'_> {
    /// What differs from the floor and is no shadow of a known light, no robot, no foot of the border and no
    /// line on the floor.
    pub(super) fn foreign(&self) -> Foreign {
        let mut distances = self.without_wall_feet(self.distances());
        let joins = self.remove_joints(&mut distances);
        let lines = FloorLines::of(self.look, &distances);
        Foreign::of(lines.without(distances), joins || lines.any(), self.look)
    }

    /// Sets 0 for what is as thin as a line in patches that reach from one side of the arena to the opposite
    /// one, as joints and printed grids do. Whether there is any.
    fn remove_joints(&self, distances: &mut Raster<f32>) -> bool {
        let foreign = distances.map(|distance| distance > FOREIGN);
        let joins = |patch: &Vec<usize>| {
            let rect = self.metres(around(patch, foreign.width()));
            joins_opposite_sides(rect, self.look.frame.arena)
        };
        let joints: Vec<Vec<usize>> = regions(&foreign).into_iter().filter(joins).collect();
        if joints.is_empty() {
            return false;
        }
        let kept = thick(&foreign, self.look.view.scale);
        let thin = joints.iter().flatten().filter(|&&cell| !kept.cells()[cell]);
        thin.for_each(|&cell| distances.cells_mut()[cell] = 0.0);
        true
    }

    /// Distances with 0 for the strips along the border that are its visible foot, even where they join
    /// something that reaches further onto the floor.
    fn without_wall_feet(&self, mut distances: Raster<f32>) -> Raster<f32> {
        let view = &self.look.view;
        let depth = |cell: usize| self.look.floor.inside(self.look.cell_point(cell));
        let is_foreign = |cell: usize| distances.cells()[cell] > FOREIGN;
        let reach = (WALL_FOOT * view.scale).ceil() as usize;
        // What is reached from further inside in so many steps belongs to what stands there.
        let mut front: Vec<usize> = (0..distances.cells().len())
            .filter(|&c| is_foreign(c) && depth(c) > WALL_FOOT)
            .collect();
        let mut strip = distances.map(|distance| distance > FOREIGN);
        front.iter().for_each(|&cell| strip.cells_mut()[cell] = false);
        for _ in 0..reach {
            let beside = front.iter().flat_map(|&cell| strip.beside(cell));
            let mut next: Vec<usize> = beside.filter(|&cell| strip.cells()[cell]).collect();
            next.sort_unstable();
            next.dedup();
            next.iter().for_each(|&cell| strip.cells_mut()[cell] = false);
            front = next;
        }
        for foot in regions(&strip) {
            let deepest = foot.iter().map(|&cell| depth(cell)).fold(0.0, f64::max);
            let area = foot.len() as f64 / view.scale.powi(2);
            if area > FOOT_LENGTHS * deepest.powi(2) {
                foot.iter().for_each(|&cell| distances.cells_mut()[cell] = 0.0);
            }
        }
        distances
    }

    /// How far from floor every cell is that is neither floor, shadow of a known light nor robot, standard
    /// deviations; 0 for the others.
    fn distances(&self) -> Raster<f32> {
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
        self.without_robot_shadow(self.without_shadow(judged, &floors, &shaded))
    }

    /// Distances with 0 for the cells of shadow: of those that are as dark as shadow the patches most of
    /// which lie where a known light source or the robot casts one, and what of the others lies there.
    fn without_shadow(
        &self,
        mut distances: Raster<f32>,
        floors: &Raster<f32>,
        shaded: &Raster<bool>,
    ) -> Raster<f32> {
        let casts = self.casts();
        let point = |cell: usize| self.look.cell_point(cell);
        for patch in regions(shaded) {
            let (cast, other): (Vec<usize>, Vec<usize>) =
                patch.iter().partition(|&&cell| self.is_in_light_shadow(point(cell), &casts));
            // The robot's shadow begins at the robot; what is as dark and only reaches near it is none.
            let touches = patch.iter().any(|&cell| self.is_at_robot(point(cell)));
            let of_robot =
                other.iter().filter(|&&cell| touches && self.is_near_robot(point(cell))).count();
            let whole = (cast.len() + of_robot) as f64 > MOSTLY_CAST * patch.len() as f64;
            let explained = cast.iter().chain(other.iter().filter(|_| whole));
            explained.for_each(|&cell| distances.cells_mut()[cell] = 0.0);
        }
        for cell in 0..distances.cells().len() {
            let floor = floors.cells()[cell];
            let is_darker = floor > FOREIGN && floor < distances.cells()[cell];
            let in_shadow = || {
                let point = point(cell);
                self.is_near_robot(point) || self.is_in_light_shadow(point, &casts)
            };
            if is_darker && in_shadow() {
                distances.cells_mut()[cell] = floor;
            }
        }
        distances
    }

    /// Distances with 0 for a patch that has the form of the robot's shadow, whatever shadow is known.
    fn without_robot_shadow(&self, mut distances: Raster<f32>) -> Raster<f32> {
        let Some(robot) = self.robot else { return distances };
        let floor = &self.look.floor;
        let point = |cell: usize| self.look.cell_point(cell);
        let is_dim = |(cell, &distance): (usize, &f32)| {
            let residual = || floor.residual(point(cell), self.look.features.cells()[cell]);
            distance > FOREIGN
                && self.is_near_robot(point(cell))
                && floor.off_any_shadow(residual(), DEEPEST) <= FOREIGN
        };
        let dim: Vec<bool> = distances.cells().iter().enumerate().map(is_dim).collect();
        for patch in regions(&Raster::from_cells(distances.width(), dim)) {
            let points: Vec<Point> = patch.iter().map(|&cell| point(cell)).collect();
            if is_robot_shadow(&points, 1.0 / self.look.view.scale, robot, ROBOT_RIM) {
                patch.iter().for_each(|&cell| distances.cells_mut()[cell] = 0.0);
            }
        }
        distances
    }

    /// The shadows that a known lamp makes of the boxes, each with the lamp's foot point.
    pub(super) fn casts(&self) -> Vec<(LeaningBox, Point)> {
        let shadow = |lamp: &Lamp| {
            let shadows = self.boxes.iter().filter_map(|&seen| lamp.shadow(seen));
            shadows.map(|shadow| (shadow, lamp.foot)).collect()
        };
        self.lamp.as_ref().map(shadow).unwrap_or_default()
    }

    fn is_of_robot(&self, point: Point) -> bool {
        self.robot.is_some_and(|top| top.radii_from(point) < ROBOT_RIM)
    }

    /// Whether a place is beside the robot's disc, where its shadow begins.
    fn is_at_robot(&self, point: Point) -> bool {
        let blur = ROBOT_BLUR / self.look.view.scale;
        let near = |top: RobotTop| top.radii_from(point) < ROBOT_RIM + blur / top.radius;
        self.robot.is_some_and(near)
    }

    /// Whether the robot's shadow may lie there.
    pub(super) fn is_near_robot(&self, point: Point) -> bool {
        self.robot.is_some_and(|top| top.radii_from(point) < ROBOT_SHADOW)
    }

    /// Whether the shadow that a known light makes of a box or of the border may lie there.
    pub(super) fn is_in_light_shadow(&self, point: Point, casts: &[(LeaningBox, Point)]) -> bool {
        let of_border = self.lamp.is_some() && self.look.floor.inside(point) < BORDER_SHADOW;
        of_border
            || casts.iter().any(|&(shadow, foot)| shadow.spans(Some(foot), point, HALF_SHADOW))
    }
}

#[cfg(test)]
mod tests {
    use super::half_light;

    #[test]
    fn half_of_the_light_is_nearer_to_the_floor_in_logarithms_for_what_is_dark() {
        // A thing with half of the floor's light: the mean is 3/4, and ln(3/4) / ln(1/2) = 0.4150.
        assert!((half_light(-2.0_f32.ln()) - 0.4150).abs() < 1e-4);
        assert!((half_light(0.01) - 0.5).abs() < 0.01);
        assert!((half_light(3.0_f32.ln()) - 2.0_f32.ln() / 3.0_f32.ln()).abs() < 1e-6);
    }
}
