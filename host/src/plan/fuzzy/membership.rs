//! The fuzzy grid: square areas, each with its membership in the set "free" [Alghannam, Sec. VI].
//!
//! ```text
//! 1.0 1.0 1.0 1.0      An area's membership is the ratio of white in it: of n × n sample cells, those
//! 1.0 0.8 0.4 0.6      that lie in the core of an obstacle (the footprint eroded from the free floor by
//! 1.0 0.4 0.0 0.0      the robot's disc) count 0, those in the band of an unsure edge something between,
//! 1.0 0.6 0.0 0.0      the others 1.
//! ```
//! The grid is a value of its own: whoever knows better may set another membership in an area. Areas are
//! counted from the lower left, metres.

use super::risk::RiskField;
use crate::geometry::{Arena, Point, Rect};
use std::collections::BTreeMap;

/// Sample cells along a side of an area that is neither wholly free nor wholly blocked; odd, so that one
/// of them is the area's middle.
const SAMPLES: usize = 3;

/// An area is beside a core's edge if its middle is so many sides from it.
const BESIDE: f64 = 1.2;

/// What is kept from both sides of a gap narrower than an area, metres.
const GAP_SPARE: f64 = 1e-5;

/// How often a place is moved out of the cores on both sides of a gap.
const GAP_ROUNDS: usize = 24;

/// A free place in a gap counts in a window so many sides wide: one at a corner counts for all around it.
const GAP_WINDOW: f64 = 1.4;

/// More areas than this are refused.
pub const AREA_LIMIT: usize = 16_000_000;

/// Membership "free" by area.
#[derive(Clone, Debug, PartialEq)]
pub struct MembershipGrid {
    columns: usize,
    rows: usize,
    side: f64,
    areas: Vec<FuzzyArea>,
}

/// One area of the fuzzy grid; shares and risks from 0 to 1.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FuzzyArea {
    /// The share of the area in which the robot's centre may be at all.
    pub free: f32,
    /// The mean risk in that share.
    pub risk: f32,
    /// The risk in the area's middle, or, in a gap narrower than the area, at the best place; 1 if the
    /// robot's centre cannot be there.
    pub middle: f32,
}

impl FuzzyArea {
    const FREE: Self = Self { free: 1.0, risk: 0.0, middle: 0.0 };
    const BLOCKED: Self = Self { free: 0.0, risk: 1.0, middle: 1.0 };

    /// The area's membership in the set "free".
    pub fn membership(&self) -> f32 {
        self.free * (1.0 - self.risk)
    }
}

impl MembershipGrid {
    /// The grid of `arena` with areas of `side` metres.
    pub(super) fn new(field: &RiskField, arena: Arena, side: f64) -> Self {
        let (columns, rows) = Self::size(arena, side);
        let mut grid = Self { columns, rows, side, areas: vec![FuzzyArea::FREE; columns * rows] };
        let mut mixed: Vec<(u32, u32)> = Vec::new();
        let mut beside: Vec<(u32, u32)> = Vec::new();
        for obstacle in 0..field.len() {
            grid.draw(field, obstacle, &mut mixed, &mut beside);
        }
        mixed.sort_unstable();
        for of_area in mixed.chunk_by(|a, b| a.0 == b.0) {
            let index = of_area[0].0 as usize;
            if grid.areas[index] != FuzzyArea::BLOCKED {
                grid.areas[index] = grid.sampled(field, index, of_area.iter().map(|&(_, by)| by));
            }
        }
        grid.close_border(field);
        beside.sort_unstable();
        grid.open_gaps(field, &beside);
        grid
    }

    /// How many columns and rows of areas cover `arena`.
    pub(super) fn size(arena: Arena, side: f64) -> (usize, usize) {
        // A size that is whole areas but for rounding is meant to be whole.
        const MEANT_WHOLE: f64 = 1e-6;
        let count = |length: f64| ((length / side - MEANT_WHOLE).ceil() as usize).max(1);
        (count(arena.width), count(arena.height))
    }

    /// Areas side by side.
    pub fn columns(&self) -> usize {
        self.columns
    }

    /// Areas one upon the other.
    pub fn rows(&self) -> usize {
        self.rows
    }

    /// The side of an area, metres.
    pub fn side(&self) -> f64 {
        self.side
    }

    /// The area in a column from the left and a row from below, if there is one.
    pub fn area(&self, column: usize, row: usize) -> Option<&FuzzyArea> {
        let index = (column < self.columns).then_some(row * self.columns + column)?;
        self.areas.get(index)
    }

    /// The areas row by row from the lower left.
    pub fn areas(&self) -> &[FuzzyArea] {
        &self.areas
    }

    /// Sets what is known of an area from elsewhere; nothing happens beyond the grid.
    pub fn set(&mut self, column: usize, row: usize, area: FuzzyArea) {
        if column < self.columns && row < self.rows {
            self.areas[row * self.columns + column] = area;
        }
    }

    /// The middle of the area at an index of [`Self::areas`].
    pub(super) fn middle(&self, index: usize) -> Point {
        let (column, row) = (index % self.columns, index / self.columns);
        Point::new((column as f64 + 0.5) * self.side, (row as f64 + 0.5) * self.side)
    }

    /// Blocks the areas in the core of an obstacle, and notes those that it touches in part, and those
    /// beside the edge of its core.
    fn draw(
        &mut self,
        field: &RiskField,
        obstacle: usize,
        mixed: &mut Vec<(u32, u32)>,
        beside: &mut Vec<(u32, u32)>,
    ) {
        let half_diagonal = self.side * std::f64::consts::FRAC_1_SQRT_2;
        let Rect { x0, y0, x1, y1 } = field.bounds(obstacle).widened([self.side; 4]);
        let first = |low: f64| (low / self.side).floor().max(0.0) as usize;
        let end = |high: f64, count: usize| {
            ((high / self.side).floor().max(-1.0) + 1.0).min(count as f64) as usize
        };
        for row in first(y0)..end(y1, self.rows) {
            for column in first(x0)..end(x1, self.columns) {
                let index = row * self.columns + column;
                let (from_core, from_band) = field.outside(obstacle, self.middle(index));
                if from_core <= -half_diagonal {
                    self.areas[index] = FuzzyArea::BLOCKED;
                    continue;
                }
                if from_band < half_diagonal {
                    mixed.push((index as u32, obstacle as u32));
                }
                if from_core < BESIDE * self.side {
                    beside.push((index as u32, obstacle as u32));
                }
            }
        }
    }

    /// Opens blocked areas where a gap between two cores, or a core and the border, is open though
    /// narrower than an area.
    fn open_gaps(&mut self, field: &RiskField, beside: &[(u32, u32)]) {
        let inside = field.inside();
        let inner = inside.widened([-BESIDE * self.side; 4]);
        let mut known = BTreeMap::new();
        for of_area in beside.chunk_by(|a, b| a.0 == b.0) {
            let index = of_area[0].0 as usize;
            let middle = self.middle(index);
            if self.areas[index].middle < 1.0 {
                continue;
            }
            let obstacles = || of_area.iter().map(|&(_, by)| by as usize);
            let mut is_open = |a: usize, b: usize| {
                *known.entry((a, b)).or_insert_with(|| field.is_open_between(a, b))
            };
            let is_gap = obstacles().any(|a| obstacles().any(|b| a < b && is_open(a, b)))
                || (!inner.contains(middle) && obstacles().any(|a| field.is_open_at_border(a)));
            if is_gap {
                self.open(field, index);
            }
        }
    }

    /// Opens an area from whose middle a free place is found that lies in it or just beside.
    fn open(&mut self, field: &RiskField, index: usize) {
        let middle = self.middle(index);
        let place = field.pushed_out(middle, GAP_SPARE, GAP_ROUNDS);
        let reach = 0.5 * GAP_WINDOW * self.side;
        if (place.x - middle.x).abs() > reach || (place.y - middle.y).abs() > reach {
            return;
        }
        let risk = field.at(place) as f32;
        let area = &mut self.areas[index];
        if risk < 1.0 {
            area.middle = risk;
            area.risk = area.risk.min(risk);
        }
    }

    fn sampled(
        &self,
        field: &RiskField,
        index: usize,
        obstacles: impl Iterator<Item = u32> + Clone,
    ) -> FuzzyArea {
        let middle = self.middle(index);
        let offset = |at: usize| ((at as f64 + 0.5) / SAMPLES as f64 - 0.5) * self.side;
        let (mut free, mut risk, mut in_middle) = (0_u32, 0.0, 0.0);
        for number in 0..SAMPLES * SAMPLES {
            let (x, y) = (offset(number % SAMPLES), offset(number / SAMPLES));
            let at = Point::new(middle.x + x, middle.y + y);
            let here = obstacles.clone().map(|by| field.of(by as usize, at)).fold(0.0, f64::max);
            if here < 1.0 {
                free += 1;
                risk += here;
            }
            if number == SAMPLES * SAMPLES / 2 {
                in_middle = here;
            }
        }
        let share = free as f32 / (SAMPLES * SAMPLES) as f32;
        let mean = if free == 0 { 1.0 } else { risk / f64::from(free) };
        FuzzyArea { free: share, risk: mean as f32, middle: in_middle as f32 }
    }

    /// Blocks what the border keeps the robot's centre from.
    fn close_border(&mut self, field: &RiskField) {
        let Rect { x0, y0, x1, y1 } = field.inside();
        let share = |index: usize, low: f64, high: f64| {
            let from = index as f64 * self.side;
            ((from + self.side).min(high) - from.max(low)).max(0.0) / self.side
        };
        let across: Vec<f64> = (0..self.columns).map(|column| share(column, x0, x1)).collect();
        let along: Vec<f64> = (0..self.rows).map(|row| share(row, y0, y1)).collect();
        for (index, area) in self.areas.iter_mut().enumerate() {
            let (column, row) = (index % self.columns, index / self.columns);
            let part = across[column] * along[row];
            if part < 1.0 {
                area.free *= part as f32;
                let middle =
                    Point::new((column as f64 + 0.5) * self.side, (row as f64 + 0.5) * self.side);
                if !field.is_inside(middle) {
                    area.middle = 1.0;
                }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::Scene;

    fn grid(scene: &Scene, side: f64) -> MembershipGrid {
        MembershipGrid::new(&RiskField::new(scene, 0.0), scene.arena, side)
    }

    fn row(grid: &MembershipGrid, row: usize) -> Vec<f32> {
        let area = |column| grid.area(column, row).unwrap().membership();
        (0..grid.columns()).map(area).map(|value| (value * 1000.0).round() / 1000.0).collect()
    }

    #[test]
    fn a_membership_is_the_ratio_of_what_is_free() {
        let mut scene = Scene::new(1.0, 1.0);
        scene.robot_radius = 0.1;
        scene.obstacles.push(Rect::new(0.6, 0.0, 1.0, 1.0).into());
        // The border leaves half of the first column; the core begins at 0.5, half way in the third.
        assert_eq!(row(&grid(&scene, 0.2), 2), [0.5, 1.0, 0.333, 0.0, 0.0]);
        assert_eq!(row(&grid(&scene, 0.2), 0)[1], 0.5);
        // With a margin of 0.2 m the risk at the samples left of the core is 2/3, 1/3, 0 and 0.
        scene.obstacles[0].margin = [0.2, 0.0, 0.0, 0.0];
        let soft = grid(&scene, 0.2);
        assert_eq!(row(&soft, 2)[2], 0.111, "a third of the area at 2/3");
        assert_eq!(row(&soft, 2)[1], 0.889, "1, 1 and 2/3");
    }

    #[test]
    fn a_gap_narrower_than_an_area_is_open_only_if_the_robot_fits() {
        for (width, is_open) in [(0.2001, true), (0.1999, false)] {
            let mut scene = Scene::new(1.0, 1.0);
            scene.robot_radius = 0.1;
            scene.obstacles = vec![
                Rect::new(0.45, 0.0, 0.55, 0.4).into(),
                Rect::new(0.45, 0.4 + width, 0.55, 1.0).into(),
            ];
            let grid = grid(&scene, 0.02);
            let open = (0..grid.rows()).any(|row| grid.area(25, row).unwrap().middle < 1.0);
            assert_eq!(open, is_open, "{width}");
        }
    }
}
