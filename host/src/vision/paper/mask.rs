//! The obstacle mask: which cells of the plan view are obstacle, its segments, its borders and its
//! enlargement by the segment method [Alghannam, Sec. II.B].

use crate::vision::image::Raster;

/// Obstacles (true, the paper's black) and floor (false) in a metric grid, row 0 on top.
#[derive(Clone, Debug, PartialEq)]
pub struct ObstacleMask {
    /// The cells.
    pub cells: Raster<bool>,
    /// Cells per metre.
    pub scale: f64,
}

/// A run of obstacle cells in one row or column: from `start` up to and without `end`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Segment {
    /// The first cell.
    pub start: usize,
    /// The first cell after it.
    pub end: usize,
}

/// The segments of one row or column: each lies between a pair of value changes.
///
/// ```
/// use wmr::vision::{Segment, segments};
/// let found = segments([false, true, true, false, true].into_iter());
/// assert_eq!(found, [Segment { start: 1, end: 3 }, Segment { start: 4, end: 5 }]);
/// ```
pub fn segments(line: impl Iterator<Item = bool>) -> Vec<Segment> {
    let mut found = Vec::new();
    let mut start = None;
    let mut length = 0;
    for value in line {
        match (value, start) {
            (true, None) => start = Some(length),
            (false, Some(first)) => {
                found.push(Segment { start: first, end: length });
                start = None;
            }
            _ => {}
        }
        length += 1;
    }
    found.extend(start.map(|first| Segment { start: first, end: length }));
    found
}

/// Enlarges obstacles and arena borders by the robot's radius, metres: the segment method.
///
/// Every row is scanned for segments and each grows by the radius at both ends, then every column of
/// the result; the radius is rounded up to whole cells. Rectangles thereby stay rectangles: the robot
/// may then be planned for as a point.
///
/// ```
/// use wmr::vision::{ObstacleMask, Raster, enlarge};
/// let cells = Raster::from_fn(7, 7, |x, y| x == 3 && y == 3);
/// let grown = enlarge(&ObstacleMask { cells, scale: 100.0 }, 0.01);
/// assert_eq!(grown.cells.row(2), [true, false, true, true, true, false, true]);
/// assert_eq!(grown.cells.row(0), [true; 7]);
/// ```
pub fn enlarge(mask: &ObstacleMask, radius: f64) -> ObstacleMask {
    let (width, height) = (mask.cells.width(), mask.cells.height());
    let reach = (radius.max(0.0) * mask.scale - 1e-9).ceil().max(0.0) as usize;
    let mut rows = Raster::filled(width, height, false);
    for y in 0..height {
        for segment in segments(mask.cells.row(y).iter().copied()) {
            for x in segment.start.saturating_sub(reach)..(segment.end + reach).min(width) {
                rows.cells_mut()[y * width + x] = true;
            }
        }
    }
    let mut grown = rows.clone();
    for x in 0..width {
        for segment in segments((0..height).map(|y| rows.cells()[y * width + x])) {
            for y in segment.start.saturating_sub(reach)..(segment.end + reach).min(height) {
                grown.cells_mut()[y * width + x] = true;
            }
        }
    }
    let border =
        |x: usize, y: usize| x < reach || y < reach || x + reach >= width || y + reach >= height;
    for y in 0..height {
        for x in 0..width {
            grown.cells_mut()[y * width + x] |= border(x, y);
        }
    }
    ObstacleMask { cells: grown, scale: mask.scale }
}

/// The borders of the obstacles: obstacle cells beside a floor cell.
///
/// ```
/// use wmr::vision::{ObstacleMask, Raster, obstacle_borders};
/// let cells = Raster::from_fn(5, 5, |x, y| (1..4).contains(&x) && (1..4).contains(&y));
/// let borders = obstacle_borders(&ObstacleMask { cells, scale: 1.0 });
/// assert_eq!(borders.row(2), [false, true, false, true, false]);
/// ```
pub fn obstacle_borders(mask: &ObstacleMask) -> Raster<bool> {
    let cells = &mask.cells;
    Raster::from_fn(cells.width(), cells.height(), |x, y| {
        let (x, y) = (x as i64, y as i64);
        let floor = |x, y| cells.get(x, y) == Some(false);
        cells.get(x, y) == Some(true)
            && (floor(x - 1, y) || floor(x + 1, y) || floor(x, y - 1) || floor(x, y + 1))
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn a_cell_is_enlarged_exactly_if_an_obstacle_or_the_border_is_within_reach(
            cells in proptest::collection::vec(prop::bool::weighted(0.1), 108), reach in 0i64..4,
        ) {
            let cells = Raster::from_fn(12, 9, |x, y| cells[y * 12 + x]);
            let grown = enlarge(&ObstacleMask { cells: cells.clone(), scale: 10.0 }, reach as f64 / 10.0);
            for y in 0..9i64 {
                for x in 0..12i64 {
                    let border = x < reach || y < reach || x + reach >= 12 || y + reach >= 9;
                    let near = (-reach..=reach).any(|dy| (-reach..=reach).any(|dx| cells.get(x + dx, y + dy) == Some(true)));
                    prop_assert_eq!(grown.cells.get(x, y), Some(near || border));
                }
            }
        }
    }

    #[test]
    fn a_part_of_a_cell_counts_as_a_whole_one() {
        let cells = Raster::from_fn(9, 9, |x, y| x == 4 && y == 4);
        let grown = enlarge(&ObstacleMask { cells, scale: 100.0 }, 0.011);
        assert_eq!(grown.cells.row(4), [true, true, true, true, true, true, true, true, true]);
    }
}
