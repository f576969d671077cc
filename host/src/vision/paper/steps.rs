//! The paper's pipeline on the plan view, step by step [Alghannam, Sec. II].
//!
//! Sobel → sum of magnitudes → average filter → threshold at the histogram's mean → inversion → regions
//! near white are floor, the rest obstacle → segment-method enlargement → borders. Brightness is sRGB
//! in 8 bit, as in the paper.
//!
//! Deviation: "near white" is taken as at least 0.8 of the brightness that 95 of 100 cells stay below,
//! since the paper names no number; it is asked of whole regions between edges and not of single
//! pixels, as the paper's picture shows, and of every edge's pixels by their own colour.

use super::edges::{average_filter, edge_magnitude, histogram_mean, invert, threshold};
use super::mask::{ObstacleMask, enlarge, obstacle_borders};
use crate::vision::image::{Raster, Run, runs, srgb_code};

/// The share of the bright level above which a region is floor.
const NEAR_WHITE: f64 = 0.8;
/// The share of cells that stay below the bright level.
const BRIGHT_SHARE: f64 = 0.95;

/// What each step of the paper made of a plan view.
#[derive(Clone, Debug, PartialEq)]
pub struct PaperSteps {
    /// The plan view's brightness, sRGB codes.
    pub brightness: Raster<u8>,
    /// |∂f/∂x| + |∂f/∂y|.
    pub magnitude: Raster<u16>,
    /// The magnitudes through the average filter.
    pub averaged: Raster<u16>,
    /// The mean of the histogram of `averaged`.
    pub mean: f64,
    /// The edges: cells above the mean.
    pub edges: Raster<bool>,
    /// The colours reversed: areas between edges.
    pub inverted: Raster<bool>,
    /// Obstacles and floor.
    pub obstacles: ObstacleMask,
    /// Obstacles and arena borders enlarged by the robot's radius.
    pub enlarged: ObstacleMask,
    /// The borders of what is enlarged.
    pub borders: Raster<bool>,
}

/// Runs the paper's steps on the brightness of a plan view of `scale` cells a metre for a robot `radius`
/// in metres.
///
/// ```
/// use wmr::vision::{Raster, paper_steps};
/// let view = Raster::from_fn(40, 30, |x, y| if (15..25).contains(&x) && (10..20).contains(&y) { 30 } else { 230 });
/// let steps = paper_steps(view, 100.0, 0.02);
/// assert_eq!(steps.obstacles.cells.cells().iter().filter(|&&obstacle| obstacle).count(), 100);
/// assert_eq!(steps.enlarged.cells.get(13, 15), Some(true));
/// ```
pub fn paper_steps(brightness: Raster<u8>, scale: f64, radius: f64) -> PaperSteps {
    let magnitude = edge_magnitude(&brightness);
    let averaged = average_filter(&magnitude);
    let mean = histogram_mean(&averaged);
    let edges = threshold(&averaged, mean);
    let inverted = invert(&edges);
    let obstacles = ObstacleMask { cells: detect_obstacles(&brightness, &inverted), scale };
    let enlarged = enlarge(&obstacles, radius);
    let borders = obstacle_borders(&enlarged);
    PaperSteps {
        brightness,
        magnitude,
        averaged,
        mean,
        edges,
        inverted,
        obstacles,
        enlarged,
        borders,
    }
}

/// The brightness of linear light as sRGB codes (ITU-R BT.709 weights).
///
/// ```
/// use wmr::vision::{Raster, brightness};
/// assert_eq!(brightness(&Raster::filled(1, 1, [1.0, 1.0, 1.0])).cells(), [255]);
/// ```
pub fn brightness(view: &Raster<[f32; 3]>) -> Raster<u8> {
    view.map(|[r, g, b]| srgb_code(0.2126 * r + 0.7152 * g + 0.0722 * b))
}

/// The obstacles in the brightness of a plan view: all the paper's steps up to the mask, keeping none.
///
/// ```
/// use wmr::vision::{Raster, paper_obstacles};
/// let view = Raster::from_fn(40, 30, |x, y| if (15..25).contains(&x) && (10..20).contains(&y) { 30 } else { 230 });
/// let obstacles = paper_obstacles(&view);
/// assert_eq!((obstacles.get(15, 10), obstacles.get(14, 10)), (Some(true), Some(false)));
/// ```
pub fn paper_obstacles(brightness: &Raster<u8>) -> Raster<bool> {
    let averaged = average_filter(&edge_magnitude(brightness));
    let edges = threshold(&averaged, histogram_mean(&averaged));
    drop(averaged);
    detect_obstacles(brightness, &invert(&edges))
}

/// Which cells are obstacle: the regions between edges (`areas`) that are not near white, and the
/// edges' own cells that are not.
///
/// ```
/// use wmr::vision::{Raster, detect_obstacles};
/// let brightness = Raster::from_fn(9, 1, |x, _| if (3..6).contains(&x) { 20 } else { 240 });
/// let areas = Raster::from_fn(9, 1, |x, _| x != 3 && x != 5);
/// let row = [false, false, false, true, true, true, false, false, false];
/// assert_eq!(detect_obstacles(&brightness, &areas).row(0), row);
/// ```
pub fn detect_obstacles(brightness: &Raster<u8>, areas: &Raster<bool>) -> Raster<bool> {
    let near_white = (NEAR_WHITE * f64::from(bright_level(brightness))) as u64;
    let (areas, count) = runs(areas, true);
    let of_run = |run: &Run| &brightness.row(run.row)[run.start..run.end];
    let mut sums = vec![(0u64, 0u64); count + 1];
    for run in &areas {
        let (sum, cells) = &mut sums[run.region as usize];
        *sum += of_run(run).iter().map(|&code| u64::from(code)).sum::<u64>();
        *cells += (run.end - run.start) as u64;
    }
    let mut obstacles = brightness.map(|code| u64::from(code) < near_white);
    let width = obstacles.width();
    for run in areas {
        let (sum, cells) = sums[run.region as usize];
        let row = run.row * width;
        obstacles.cells_mut()[row + run.start..row + run.end].fill(sum < near_white * cells);
    }
    obstacles
}

/// The brightness that 95 of 100 cells stay below.
fn bright_level(brightness: &Raster<u8>) -> u8 {
    let mut counts = [0usize; 256];
    for &code in brightness.cells() {
        counts[usize::from(code)] += 1;
    }
    let wanted = (BRIGHT_SHARE * brightness.cells().len() as f64) as usize;
    let mut seen = 0;
    let level = (0..=255u8).find(|&code| {
        seen += counts[usize::from(code)];
        seen > wanted
    });
    level.unwrap_or(255)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_dark_box_on_a_white_floor_is_the_obstacle() {
        let view = Raster::from_fn(60, 50, |x, y| {
            if (20..35).contains(&x) && (10..30).contains(&y) { [0.05; 3] } else { [0.9; 3] }
        });
        let steps = paper_steps(brightness(&view), 100.0, 0.03);
        for y in 0..50 {
            for x in 0..60 {
                let inside = (20..35).contains(&x) && (10..30).contains(&y);
                assert_eq!(steps.obstacles.cells.get(x, y), Some(inside), "{x} {y}");
            }
        }
        assert_eq!(steps.enlarged.cells.get(17, 7), Some(true));
        assert_eq!(steps.enlarged.cells.get(16, 7), Some(false));
        assert_eq!(steps.borders.get(17, 20), Some(true));
    }
}
