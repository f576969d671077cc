//! The outer contour of one region of cells, to a fraction of a cell.
//!
//! ```text
//!   . . . . .      The contour runs between a cell inside (#) and its neighbour outside (.), around the
//!   . # # . .      region with the inside on its left. On every such pair it passes where the value,
//!   . # # # .      linear between the two centres, is 1.
//!   . . . . .
//! ```
//! Columns and rows of a raster; row numbers grow downwards.

use crate::vision::image::Raster;

/// Steps to the neighbour on the right, below, on the left and above.
const STEPS: [(i64, i64); 4] = [(1, 0), (0, 1), (-1, 0), (0, -1)];

/// The points of the outer contour of the region that holds the cell `first`, which is the region's first
/// cell, row by row: where `values`, at least 1 inside and below 1 outside, passes through 1.
pub(crate) fn contour(values: &Raster<f32>, first: usize) -> Vec<(f64, f64)> {
    let width = values.width().max(1);
    let value = |(x, y): (i64, i64)| values.get(x, y).unwrap_or(0.0);
    let is_inside = |cell: (i64, i64)| value(cell) >= 1.0;
    let start = ((first % width) as i64, (first / width) as i64);
    // Above the first cell lies none of the region: the walk begins on its upper side, going left.
    let (mut cell, mut side) = (start, 3);
    let mut points = Vec::new();
    loop {
        let (dx, dy) = STEPS[side];
        let (inside, outside) = (value(cell), value((cell.0 + dx, cell.1 + dy)));
        // Where both are far from the level the crossing stays between the centres.
        let share = f64::from((inside - 1.0) / (inside - outside).max(1e-6)).clamp(0.0, 1.0);
        points.push((cell.0 as f64 + share * dx as f64, cell.1 as f64 + share * dy as f64));
        // With the inside on the left, the walk goes on along the side: round the outer corner, straight
        // on, or round the inner corner.
        let ahead = (side + 3) % 4;
        let (ax, ay) = STEPS[ahead];
        let beside = (cell.0 + ax, cell.1 + ay);
        let beyond = (beside.0 + dx, beside.1 + dy);
        (cell, side) = match (is_inside(beside), is_inside(beyond)) {
            (false, _) => (cell, ahead),
            (true, false) => (beside, side),
            (true, true) => (beyond, (side + 1) % 4),
        };
        if (cell, side) == (start, 3) {
            return points;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    /// Twice the enclosed area, positive if the contour runs counter-clockwise as a picture shows it.
    fn doubled_area(points: &[(f64, f64)]) -> f64 {
        let next = points.iter().cycle().skip(1);
        points.iter().zip(next).map(|(a, b)| a.1 * b.0 - a.0 * b.1).sum()
    }

    #[test]
    fn a_single_cell_is_a_diamond_around_its_centre() {
        let values = Raster::from_fn(3, 3, |x, y| if (x, y) == (1, 1) { 2.0 } else { 0.0 });
        let points = contour(&values, 4);
        assert_eq!(points, [(1.0, 0.5), (0.5, 1.0), (1.0, 1.5), (1.5, 1.0)]);
        assert_eq!(doubled_area(&points), 1.0);
    }

    #[test]
    fn an_edge_lies_where_the_value_passes_through_one() {
        // A square whose right neighbours are half as far from the level as its cells.
        let values = Raster::from_fn(6, 5, |x, y| match (x, y) {
            (1..=3, 1..=3) => 1.5,
            (4, 1..=3) => 0.75,
            _ => 0.5,
        });
        let right = contour(&values, 7).into_iter().map(|p| p.0).fold(0.0, f64::max);
        assert!((right - (3.0 + 0.5 / 0.75)).abs() < 1e-6, "{right}");
    }

    proptest! {
        #[test]
        fn every_walk_ends_and_encloses_its_cells(cells in proptest::collection::vec(any::<bool>(), 64)) {
            let values =
                Raster::from_fn(10, 10, |x, y| match (x.checked_sub(1), y.checked_sub(1)) {
                    (Some(x), Some(y)) if x < 8 && y < 8 && cells[8 * y + x] => 2.0,
                    _ => 0.0,
                });
            let (regions, count) = values.map(|value| value > 1.0).regions(true);
            for region in 1..=count as u32 {
                let first = regions.cells().iter().position(|&at| at == region).unwrap();
                let points = contour(&values, first);
                prop_assert!(doubled_area(&points) > 0.0);
                for (cell, _) in regions.cells().iter().enumerate().filter(|(_, at)| **at == region) {
                    let (x, y) = ((cell % 10) as f64, (cell / 10) as f64);
                    let near = |p: &(f64, f64)| p.0 >= x;
                    prop_assert!(points.iter().any(near) && points.iter().any(|p| p.1 >= y));
                }
            }
        }
    }
}
