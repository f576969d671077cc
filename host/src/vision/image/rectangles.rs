//! Rectangles that cover a mask: obstacles are rectangles with sides parallel to the arena's
//! [Alghannam, Sec. II.A], touching ones make L and T shapes.
//!
//! In each connected region the rectangle with the greatest gain is taken (a covered mask cell gains
//! 1, a covered floor cell costs 1), then the next one over what is left, until little is left.

use super::components::{Run, runs};
use super::raster::Raster;

/// Regions are searched at no more than this many blocks of cells a side.
const MOST_BLOCKS: usize = 90;
/// Rectangles of one region, at most.
const MOST_RECTANGLES: usize = 12;
/// A further rectangle covers at least this share of its region.
const LEAST_SHARE: f64 = 0.03;

/// Columns `x0..x1` and rows `y0..y1` of a raster.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct CellRect {
    /// The first column.
    pub x0: usize,
    /// The first row.
    pub y0: usize,
    /// The first column after it.
    pub x1: usize,
    /// The first row after it.
    pub y1: usize,
}

/// Covers the true cells with rectangles; what gains less than `least` cells is left out.
///
/// ```
/// use wmr::vision::{CellRect, Raster, rectangles};
/// let mask = Raster::from_fn(10, 8, |x, y| (2..6).contains(&x) && (1..7).contains(&y));
/// assert_eq!(rectangles(&mask, 4.0), [CellRect { x0: 2, y0: 1, x1: 6, y1: 7 }]);
/// ```
pub fn rectangles(mask: &Raster<bool>, least: f64) -> Vec<CellRect> {
    let (runs, count) = runs(mask, true);
    let mut regions: Vec<Vec<Run>> = vec![Vec::new(); count];
    for run in runs {
        regions[run.region as usize - 1].push(run);
    }
    let mut found = Vec::new();
    for region in regions {
        let area: usize = region.iter().map(|run| run.end - run.start).sum();
        let least = least.max(LEAST_SHARE * area as f64);
        if area as f64 >= least {
            cover(&region, least, &mut found);
        }
    }
    found
}

/// The columns and rows that hold runs, which come row by row.
fn bounds(runs: &[Run]) -> CellRect {
    CellRect {
        x0: runs.iter().map(|run| run.start).min().unwrap_or(0),
        y0: runs.first().map_or(0, |run| run.row),
        x1: runs.iter().map(|run| run.end).max().unwrap_or(0),
        y1: runs.last().map_or(0, |run| run.row + 1),
    }
}

/// Covers one region, best rectangle first.
fn cover(region: &[Run], least: f64, found: &mut Vec<CellRect>) {
    let bound = bounds(region);
    let (width, height) = (bound.x1 - bound.x0, bound.y1 - bound.y0);
    let mut gain = Raster::filled(width, height, -1i8);
    for run in region {
        let row = (run.row - bound.y0) * width;
        gain.cells_mut()[row + run.start - bound.x0..row + run.end - bound.x0].fill(1);
    }
    for _ in 0..MOST_RECTANGLES {
        let sums = Sums::of(&gain);
        let block = width.max(height).div_ceil(MOST_BLOCKS);
        let Some(rough) = best_of_blocks(&sums, width, height, block) else { return };
        let best = snap(&sums, rough, width, height, block);
        if (sums.of_rect(best) as f64) < least {
            return;
        }
        for y in best.y0..best.y1 {
            gain.cells_mut()[y * width + best.x0..y * width + best.x1]
                .iter_mut()
                .for_each(|cell| *cell = (*cell).min(0));
        }
        found.push(CellRect {
            x0: bound.x0 + best.x0,
            y0: bound.y0 + best.y0,
            x1: bound.x0 + best.x1,
            y1: bound.y0 + best.y1,
        });
    }
}

/// Sums over the cells left of and above every corner of cells.
struct Sums(Raster<i32>);

impl Sums {
    fn of(values: &Raster<i8>) -> Self {
        let width = values.width() + 1;
        let mut sums = Raster::filled(width, values.height() + 1, 0);
        for y in 0..values.height() {
            let (above, below) = sums.cells_mut()[y * width..].split_at_mut(width);
            let mut row = 0;
            for ((below, above), &value) in
                below[1..].iter_mut().zip(&above[1..]).zip(values.row(y))
            {
                row += i32::from(value);
                *below = above + row;
            }
        }
        Self(sums)
    }

    fn of_rect(&self, rect: CellRect) -> i32 {
        let at = |x: usize, y: usize| self.0.cells()[y * self.0.width() + x];
        at(rect.x1, rect.y1) - at(rect.x0, rect.y1) - at(rect.x1, rect.y0) + at(rect.x0, rect.y0)
    }
}

/// The rectangle of whole blocks with the greatest sum (Kadane over every pair of rows).
fn best_of_blocks(sums: &Sums, width: usize, height: usize, block: usize) -> Option<CellRect> {
    let edges = |length: usize| {
        (0..=length.div_ceil(block)).map(|i| (i * block).min(length)).collect::<Vec<_>>()
    };
    let (columns, rows) = (edges(width), edges(height));
    let blocks: Vec<Vec<i32>> = rows
        .windows(2)
        .map(|y| {
            let block = |x: &[usize]| CellRect { x0: x[0], y0: y[0], x1: x[1], y1: y[1] };
            columns.windows(2).map(|x| sums.of_rect(block(x))).collect()
        })
        .collect();
    // No rectangle has more than all that gains in its rows: those that cannot win are not looked at.
    let mut gains = vec![0; blocks.len() + 1];
    for (row, values) in blocks.iter().enumerate() {
        gains[row + 1] = gains[row] + values.iter().map(|&value| value.max(0)).sum::<i32>();
    }
    let mut best: Option<(i32, CellRect)> = None;
    let mut strip = vec![0; columns.len() - 1];
    for top in 0..blocks.len() {
        strip.fill(0);
        for (bottom, row) in blocks.iter().enumerate().skip(top) {
            strip.iter_mut().zip(row).for_each(|(sum, block)| *sum += block);
            if best.is_some_and(|(most, _)| gains[bottom + 1] - gains[top] <= most) {
                continue;
            }
            let (sum, first, end) = best_run(&strip);
            if best.is_none_or(|(most, _)| sum > most) {
                let (x0, x1) = (columns[first], columns[end]);
                best = Some((sum, CellRect { x0, y0: rows[top], x1, y1: rows[bottom + 1] }));
            }
        }
    }
    best.map(|(_, rect)| rect)
}

/// The run with the greatest sum (Kadane): the sum, its first value and the first after it.
fn best_run(values: &[i32]) -> (i32, usize, usize) {
    let (mut best, mut sum, mut first) = ((i32::MIN, 0, 0), 0, 0);
    for (index, &value) in values.iter().enumerate() {
        if sum <= 0 {
            (sum, first) = (0, index);
        }
        sum += value;
        if sum > best.0 {
            best = (sum, first, index + 1);
        }
    }
    best
}

/// Moves the edges cell by cell as long as the sum grows.
fn snap(sums: &Sums, mut rect: CellRect, width: usize, height: usize, block: usize) -> CellRect {
    if block == 1 {
        return rect;
    }
    for _ in 0..4 * block {
        let mut better = rect;
        for x in [rect.x0.saturating_sub(1), (rect.x0 + 1).min(rect.x1 - 1)] {
            better = greater(sums, better, CellRect { x0: x, ..rect });
        }
        for x in [(rect.x1 - 1).max(rect.x0 + 1), (rect.x1 + 1).min(width)] {
            better = greater(sums, better, CellRect { x1: x, ..rect });
        }
        for y in [rect.y0.saturating_sub(1), (rect.y0 + 1).min(rect.y1 - 1)] {
            better = greater(sums, better, CellRect { y0: y, ..rect });
        }
        for y in [(rect.y1 - 1).max(rect.y0 + 1), (rect.y1 + 1).min(height)] {
            better = greater(sums, better, CellRect { y1: y, ..rect });
        }
        if better == rect {
            break;
        }
        rect = better;
    }
    rect
}

fn greater(sums: &Sums, a: CellRect, b: CellRect) -> CellRect {
    if sums.of_rect(b) > sums.of_rect(a) { b } else { a }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn an_l_shape_is_two_rectangles() {
        let mask = Raster::from_fn(40, 40, |x, y| {
            (5..10).contains(&x) && (5..35).contains(&y)
                || (10..30).contains(&x) && (30..35).contains(&y)
        });
        let found = rectangles(&mask, 10.0);
        assert_eq!(found.len(), 2);
        let covered = |x: usize, y: usize| {
            found.iter().any(|r| (r.x0..r.x1).contains(&x) && (r.y0..r.y1).contains(&y))
        };
        assert!(
            (0..40)
                .all(|y| (0..40).all(|x| covered(x, y) == mask.get(x as i64, y as i64).unwrap()))
        );
    }

    proptest! {
        #[test]
        fn one_rectangle_is_found_exactly_at_any_size(x0 in 0usize..150, y0 in 0usize..150, w in 5usize..150, h in 5usize..150) {
            let rect = CellRect { x0, y0, x1: x0 + w, y1: y0 + h };
            let mask = Raster::from_fn(300, 300, |x, y| (rect.x0..rect.x1).contains(&x) && (rect.y0..rect.y1).contains(&y));
            prop_assert_eq!(rectangles(&mask, 9.0), [rect]);
        }
    }
}
