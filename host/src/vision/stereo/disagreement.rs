//! Where two pictures of one floor agree lies floor, lit or in shadow; where they do not, something raised
//! is in the way of one of them.
//!
//! Highlights move with the camera and so disagree too, but smoothly: what can be reached from agreeing
//! floor without crossing an edge of the difference is floor. What is raised has an edge all around.

use super::pair::{on_floor, raster};
use crate::geometry::PerSide;
use crate::vision::appearance::{Feature, median};
use crate::vision::image::Raster;
use crate::vision::plan_view::PlanFrame;

/// The least spread of differences between the pictures (brightness, chroma, chroma).
const LEAST_SPREAD: Feature = [0.02, 0.012, 0.012];
/// Differences of so many standard deviations are none, or surely one.
const SAME: f32 = 3.0;
const DIFFERENT: f32 = 8.0;
/// How much of a slow difference may be no highlight but the fit's own error.
const LOOSENESS: f32 = 0.15;
/// Light that reaches one camera but not the other by reflection, linear: shadow and dark boxes shine.
const STRAY_LIGHT: f32 = 0.003;
/// The pictures agree within this many standard deviations to begin with, and go on agreeing as long as
/// their difference does not step from cell to cell by more than this (brightness, chroma, chroma).
const AGREED: f32 = 1.5;
const STEP: Feature = [0.025, 0.015, 0.015];
/// Where fewer cells agree than this, hardly anything is known of the slow difference.
const HOLD: f64 = 10.0;
/// The half width of the window of the local mean, metres.
const WINDOW: f64 = 0.12;
/// Beyond a side the border is plain where the pictures disagree less than this.
const PLAIN: f32 = 0.3;

/// Where the pictures disagree, 0 to 1, and where that can be judged.
pub(crate) fn disagreement(
    frame: &PlanFrame,
    [first, second]: [Raster<Feature>; 2],
    in_sight: &Raster<bool>,
) -> (Raster<f32>, Raster<bool>) {
    let mut seen = in_sight.cells().iter();
    let floor = raster(frame, |point| seen.next() == Some(&true) && on_floor(frame, point));
    let differences = difference(&first, &second);
    let every = vec![1.0; differences.cells().len()];
    let smooth = local_mean(&differences, &every, 1, 0.0);
    let even = even_floor(&smooth, spread(&differences, &floor), &floor);
    let counts: Vec<f32> = even.cells().iter().map(|&even| if even { 1.0 } else { 0.0 }).collect();
    let window = (WINDOW * frame.scale).ceil() as usize;
    let slow = local_mean(&differences, &counts, window, HOLD);
    let all = sureness(&first, &second, &slow, &even);
    let plain = plain_border(frame, &all, in_sight);
    let mut cells = floor.cells().iter().zip(in_sight.cells());
    let judged = raster(frame, |point| match (cells.next(), frame.arena.beyond(point)) {
        (Some((&on_floor, _)), None) => on_floor,
        (Some((_, &seen)), Some((side, depth))) => {
            seen && plain[side].get((depth * frame.scale) as usize) == Some(&true)
        }
        (None, _) => false,
    });
    let mut sure = all.cells().iter();
    let kept =
        judged.map(|judged| sure.next().map_or(0.0, |&sure| if judged { sure } else { 0.0 }));
    (kept, judged)
}

/// How surely each cell disagrees, if highlights may be as much brighter as the floor around says, half
/// as much, or not at all: where shadow keeps the lamp's light away there are none.
fn sureness(
    first: &Raster<Feature>,
    second: &Raster<Feature>,
    slow: &Raster<Feature>,
    even: &Raster<bool>,
) -> Raster<f32> {
    let with = |share: f32| difference(second, &slow.map(|part| part.map(|value| -share * value)));
    let readings = [with(1.0), with(0.5), second.clone()];
    let spread = spread(&difference(first, &readings[0]), even);
    let width = first.width();
    Raster::from_fn(width, first.height(), |column, row| {
        let index = row * width + column;
        if even.cells()[index] {
            return 0.0;
        }
        let slow = slow.cells()[index];
        let stray = stray(first.cells()[index], second.cells()[index]);
        let loose = [0, 1, 2].map(|part| spread[part].hypot(LOOSENESS * slow[part]).hypot(stray));
        let distance = readings
            .each_ref()
            .map(|other| nearest(first, other, column, row, loose))
            .into_iter()
            .fold(f32::INFINITY, f32::min);
        let sure = ((distance - SAME) / (DIFFERENT - SAME)).clamp(0.0, 1.0);
        sure * sure
    })
}

/// How much the logarithm of the darker of two colours changes by stray light.
pub(crate) fn stray(a: Feature, b: Feature) -> f32 {
    STRAY_LIGHT / a[0].min(b[0]).exp()
}

/// The cells that can be reached from where the pictures agree without crossing an edge of their
/// difference: floor, however its highlights move. What is raised has an edge all around.
fn even_floor(smooth: &Raster<Feature>, spread: Feature, floor: &Raster<bool>) -> Raster<bool> {
    let width = smooth.width();
    let cells = smooth.cells();
    let mut open: Vec<usize> = (0..cells.len())
        .filter(|&cell| floor.cells()[cell] && length(cells[cell], spread) < AGREED)
        .collect();
    let mut even = Raster::filled(width, smooth.height(), false);
    open.iter().for_each(|&cell| even.cells_mut()[cell] = true);
    while let Some(cell) = open.pop() {
        let neighbours = [
            (cell % width > 0).then(|| cell - 1),
            ((cell + 1) % width > 0).then_some(cell + 1),
            cell.checked_sub(width),
            Some(cell + width),
        ];
        for next in neighbours.into_iter().flatten() {
            if floor.cells().get(next) == Some(&true)
                && !even.cells()[next]
                && length(minus(cells[cell], cells[next]), STEP) < 1.0
            {
                even.cells_mut()[next] = true;
                open.push(next);
            }
        }
    }
    even
}

/// At which distances beyond each side, in cells, the pictures mostly agree: a raised border disagrees
/// with itself all along and says nothing.
fn plain_border(
    frame: &PlanFrame,
    disagreement: &Raster<f32>,
    in_sight: &Raster<bool>,
) -> PerSide<Vec<bool>> {
    let depths = (frame.margin * frame.scale) as usize + 2;
    let mut lists = PerSide::from_fn(|_| vec![Vec::new(); depths]);
    let width = disagreement.width();
    for (index, (&sure, _)) in disagreement
        .cells()
        .iter()
        .zip(in_sight.cells())
        .enumerate()
        .filter(|(_, (_, seen))| **seen)
    {
        let point = frame.point((index % width) as f64, (index / width) as f64);
        if let Some((side, depth)) = frame.arena.beyond(point)
            && let Some(list) = lists[side].get_mut((depth * frame.scale) as usize)
        {
            list.push(sure);
        }
    }
    lists.map(|side| {
        side.into_iter().map(|mut list| !list.is_empty() && median(&mut list) < PLAIN).collect()
    })
}

/// How far a cell of the first picture is from the most alike of the cells around it in the second:
/// cameras are known to about a cell only.
fn nearest(
    first: &Raster<Feature>,
    second: &Raster<Feature>,
    column: usize,
    row: usize,
    spread: Feature,
) -> f32 {
    let (x, y) = (column as i64, row as i64);
    let Some(here) = first.get(x, y) else { return 0.0 };
    let around = (-1..=1).flat_map(|j| (-1..=1).map(move |i| (x + i, y + j)));
    around
        .filter_map(|(x, y)| second.get(x, y))
        .map(|other| length(minus(here, other), spread))
        .fold(f32::INFINITY, f32::min)
}

/// The difference of two colours.
pub(crate) fn minus(a: Feature, b: Feature) -> Feature {
    [a[0] - b[0], a[1] - b[1], a[2] - b[2]]
}

fn length(value: Feature, spread: Feature) -> f32 {
    (0..3).map(|part| (value[part] / spread[part]).powi(2)).sum::<f32>().sqrt()
}

fn difference(first: &Raster<Feature>, second: &Raster<Feature>) -> Raster<Feature> {
    let mut others = second.cells().iter();
    first.map(|cell| others.next().map_or([0.0; 3], |&other| minus(cell, other)))
}

/// One standard deviation of the differences on the floor, by their median.
fn spread(differences: &Raster<Feature>, floor: &Raster<bool>) -> Feature {
    let on_floor = || differences.cells().iter().zip(floor.cells()).filter(|(_, on)| **on);
    [0, 1, 2].map(|part| {
        let mut sizes: Vec<f32> = on_floor().map(|(d, _)| d[part].abs()).collect();
        (1.4826 * median(&mut sizes)).max(LEAST_SPREAD[part])
    })
}

/// The mean over windows of `reach` cells in each direction, every cell counting as `counts` says.
/// `hold` more cells of value 0 hold it where few count.
pub(crate) fn local_mean(
    values: &Raster<Feature>,
    counts: &[f32],
    reach: usize,
    hold: f64,
) -> Raster<Feature> {
    let (width, height) = (values.width(), values.height());
    let mut sums = vec![[0f64; 4]; (width + 1) * (height + 1)];
    for row in 0..height {
        let mut line = [0f64; 4];
        for column in 0..width {
            let index = row * width + column;
            let (value, count) = (values.cells()[index], f64::from(counts[index]));
            for part in 0..3 {
                line[part] += count * f64::from(value[part]);
            }
            line[3] += count;
            for part in 0..4 {
                sums[(row + 1) * (width + 1) + column + 1][part] =
                    sums[row * (width + 1) + column + 1][part] + line[part];
            }
        }
    }
    Raster::from_fn(width, height, |column, row| {
        let (left, right) = (column.saturating_sub(reach), (column + reach + 1).min(width));
        let (top, down) = (row.saturating_sub(reach), (row + reach + 1).min(height));
        let at = |column: usize, row: usize| sums[row * (width + 1) + column];
        let (a, b, c, d) = (at(right, down), at(left, down), at(right, top), at(left, top));
        let sum = [0, 1, 2, 3].map(|part| a[part] - b[part] - c[part] + d[part]);
        [0, 1, 2].map(|part| (sum[part] / (sum[3] + hold).max(1e-9)) as f32)
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::{Arena, Point};

    fn frame() -> PlanFrame {
        PlanFrame::new(Arena { width: 1.0, height: 1.0 }, 100.0, 0.0)
    }

    fn drawn(exposure: f32, shadow: bool, patch: impl Fn(Point) -> bool) -> Raster<Feature> {
        raster(&frame(), |point| {
            let speck = ((point.x * 700.0).sin() * (point.y * 900.0).cos() * 0.02) as f32;
            let dark = if shadow && point.x < 0.4 { -0.5 } else { 0.0 };
            [exposure + dark + speck + if patch(point) { -1.0 } else { 0.0 }, 0.0, 0.0]
        })
    }

    #[test]
    fn exposure_and_shadow_agree_and_a_patch_in_one_picture_does_not() {
        let inside = |p: Point| p.x > 0.6 && p.x < 0.8 && p.y > 0.5 && p.y < 0.7;
        let pictures = [drawn(0.3, true, inside), drawn(0.0, true, |_| false)];
        let (found, judged) = disagreement(&frame(), pictures, &Raster::filled(100, 100, true));
        assert_eq!((judged.get(0, 50), judged.get(50, 50)), (Some(false), Some(true)));
        for (index, &sure) in found.cells().iter().enumerate() {
            let point = frame().point((index % 100) as f64, (index / 100) as f64);
            // Cameras are known to a cell: the patch's rim may be either.
            let around = |by: f64| {
                [(-by, 0.0), (by, 0.0), (0.0, -by), (0.0, by)]
                    .map(|(dx, dy)| inside(Point::new(point.x + dx, point.y + dy)))
            };
            if around(0.015).iter().all(|&there| there == inside(point)) {
                assert_eq!(sure > 0.5, inside(point), "{point:?} {sure}");
            }
        }
    }

    #[test]
    fn the_local_mean_is_that_of_the_cells_that_count() {
        let values = Raster::from_fn(3, 1, |x, _| [x as f32, 0.0, 0.0]);
        let mean = local_mean(&values, &[1.0, 1.0, 0.0], 1, 0.0);
        assert_eq!(mean.cells().iter().map(|cell| cell[0]).collect::<Vec<_>>(), [0.5, 0.5, 1.0]);
    }
}
