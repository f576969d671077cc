//! Grid maps of other people: Moving AI `.map` files and the maps of ROS `map_server`.
//!
//! A map is cells, blocked or free. It becomes a [`Scene`] whose obstacles are rectangles of blocked
//! cells, in the arena frame: metres from the map's lower-left corner, y up. The scene keeps where that
//! corner lies in the map's own frame, so that its points are written in the map frame. Text and bytes in, text
//! and bytes out; files are the caller's.

mod brightness;
mod movingai;
mod ros;

pub use ros::{MapWarning, RosHead, RosMap};

use crate::geometry::{Point, Rect};
use crate::scene::{Obstacle, Scene, SceneFormat};

/// Cells that are blocked or free.
#[derive(Clone, Debug, PartialEq)]
pub struct CellMap {
    /// Cells side by side.
    pub columns: usize,
    /// Cells one upon the other.
    pub rows: usize,
    /// The side of a cell, metres.
    pub resolution: f64,
    /// Whether a cell is blocked, row by row from the top left.
    pub blocked: Vec<bool>,
    /// Where the map's lower left corner lies in the frame of the map, metres; the arena frame begins in
    /// that corner.
    pub origin: [f64; 2],
}

/// Why a map cannot be read.
#[derive(Clone, Debug, PartialEq, thiserror::Error, miette::Diagnostic)]
pub enum MapError {
    /// A line that must be there is not.
    #[error("the map has no `{0}`")]
    #[diagnostic(help(
        "give a Moving AI .map file, or the .yaml file of a ROS map beside its picture"
    ))]
    Missing(&'static str),
    /// A value cannot be understood.
    #[error("`{what}` is `{value}`: {need}")]
    #[diagnostic(help("correct that line of the map"))]
    Value {
        /// The field.
        what: &'static str,
        /// What it holds.
        value: String,
        /// What it must hold.
        need: &'static str,
    },
    /// There are fewer cells than the head announces.
    #[error("the map announces {expected} cells but has {found}, so the file is cut off")]
    #[diagnostic(help("copy or make the file again"))]
    Cut {
        /// As announced.
        expected: usize,
        /// As found.
        found: usize,
    },
    /// The picture of a ROS map cannot be decoded.
    #[error("the map's picture cannot be decoded: {0}")]
    #[diagnostic(help("give a PGM or PNG file"))]
    Picture(String),
    /// The text of a ROS map is not YAML.
    #[error("the text is not YAML: {0}")]
    #[diagnostic(help("give the .yaml file of a ROS map"))]
    Yaml(String),
    /// A cell's letter is not of the Moving AI format.
    #[error("the map has a cell `{letter}` in row {row}")]
    #[diagnostic(help(
        "letters are . G S (free) and @ O T W (blocked); weights of the ground are not understood"
    ))]
    Letter {
        /// The letter.
        letter: char,
        /// Its row, from 1 at the top.
        row: usize,
    },
}

impl CellMap {
    /// The scene of this map for a robot of `robot_radius` metres. Blocked cells are joined along
    /// rows, and equal runs of neighbouring rows are joined to one rectangle.
    ///
    /// ```
    /// use wmr::{geometry::Rect, map::CellMap};
    /// let map = CellMap::from_movingai("type octile\nheight 2\nwidth 3\nmap\n.@@\n.@@\n", 0.5)?;
    /// let scene = map.to_scene(0.1);
    /// assert_eq!(scene.obstacles, [Rect::new(0.5, 0.0, 1.5, 1.0).into()]);
    /// # Ok::<(), wmr::map::MapError>(())
    /// ```
    pub fn to_scene(&self, robot_radius: f64) -> Scene {
        let size = |cells: usize| cells as f64 * self.resolution;
        let mut scene = Scene::new(size(self.columns), size(self.rows));
        scene.format = SceneFormat::Scene;
        scene.robot_radius = robot_radius;
        let [x, y] = self.origin;
        scene.origin = (self.origin != [0.0; 2]).then_some(Point::new(x, y));
        // Runs whose rectangle may still grow downwards: first and last column, first row.
        let mut open: Vec<(usize, usize, usize)> = Vec::new();
        let rect = |(first, last, top): (usize, usize, usize), bottom: usize| {
            let (low, high) = (size(self.rows - bottom), size(self.rows - top));
            Obstacle::from(Rect::new(size(first), low, size(last), high))
        };
        for row in 0..self.rows {
            let runs = self.runs(row);
            let (go_on, end): (Vec<_>, Vec<_>) = open
                .iter()
                .partition(|&&(first, last, _)| runs.binary_search(&(first, last)).is_ok());
            scene.obstacles.extend(end.into_iter().map(|run| rect(run, row)));
            let top = |run: &(usize, usize)| {
                go_on
                    .binary_search_by_key(run, |&(first, last, _)| (first, last))
                    .map_or(row, |at| go_on[at].2)
            };
            open = runs.iter().map(|run| (run.0, run.1, top(run))).collect();
        }
        scene.obstacles.extend(open.into_iter().map(|run| rect(run, self.rows)));
        scene
    }

    /// Blocked runs of a row, as first column and the one after the last.
    fn runs(&self, row: usize) -> Vec<(usize, usize)> {
        let cells = &self.blocked[row * self.columns..(row + 1) * self.columns];
        let mut runs = Vec::new();
        let mut column = 0;
        for piece in cells.chunk_by(|a, b| a == b) {
            if piece[0] {
                runs.push((column, column + piece.len()));
            }
            column += piece.len();
        }
        runs
    }

    /// The map of `scene` with cells of `resolution` metres; a cell that an obstacle touches with any
    /// part of its inside is blocked.
    ///
    /// ```
    /// use wmr::{geometry::Rect, map::CellMap, scene::Scene};
    /// let mut scene = Scene::new(0.3, 0.2);
    /// scene.obstacles.push(Rect::new(0.0, 0.0, 0.15, 0.1).into());
    /// let map = CellMap::from_scene(&scene, 0.1);
    /// assert_eq!(map.to_movingai(), "type octile\nheight 2\nwidth 3\nmap\n...\n@@.\n");
    /// ```
    pub fn from_scene(scene: &Scene, resolution: f64) -> Self {
        // Sizes that are whole cells but for rounding are meant to be whole.
        let up = |metres: f64| (metres / resolution - MEANT_WHOLE).ceil().max(0.0) as usize;
        let down = |metres: f64| (metres / resolution + MEANT_WHOLE).floor().max(0.0) as usize;
        let (columns, rows) = (up(scene.arena.width).max(1), up(scene.arena.height).max(1));
        let mut blocked = vec![false; columns * rows];
        for rect in scene.obstacles.iter().flat_map(|of| of.footprint.cover(resolution)) {
            let across = down(rect.x0).min(columns)..up(rect.x1).min(columns);
            for level in down(rect.y0).min(rows)..up(rect.y1).min(rows) {
                if !across.is_empty() {
                    blocked[(rows - 1 - level) * columns..][across.clone()].fill(true);
                }
            }
        }
        let origin = scene.origin.map_or([0.0; 2], |origin| [origin.x, origin.y]);
        Self { columns, rows, resolution, blocked, origin }
    }
}

/// Part of a cell that a size may be off by rounding.
const MEANT_WHOLE: f64 = 1e-6;

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn rectangles_cover_exactly_the_blocked_cells(
            (columns, blocked) in (1..9_usize).prop_flat_map(|columns| {
                let cells = proptest::collection::vec(any::<bool>(), columns * 7);
                (Just(columns), cells)
            }),
        ) {
            let map = CellMap { columns, rows: 7, resolution: 0.05, blocked, origin: [0.0; 2] };
            let scene = map.to_scene(0.0);
            prop_assert_eq!(&CellMap::from_scene(&scene, 0.05), &map);
            let area: f64 = scene.obstacles.iter().map(|of| of.footprint.area()).sum();
            let count = map.blocked.iter().filter(|&&blocked| blocked).count() as f64;
            prop_assert!((area - count * 0.05 * 0.05).abs() < 1e-9, "rectangles overlap");
        }
    }
}
