//! Edges as in the paper: Sobel in two directions, the sum of the magnitudes, an average filter, a
//! threshold at the mean of the histogram, and the inversion [Alghannam, Sec. II.A].
//!
//! One function a step; values are brightness codes of 8 bit.

use crate::vision::image::{Raster, magnitude, sobel};

/// The magnitude of the gradient, |∂f/∂x| + |∂f/∂y|, by the 3 × 3 Sobel operator.
///
/// The outermost rows and columns, where the operator does not fit, are 0.
///
/// ```
/// use wmr::vision::{Raster, edge_magnitude};
/// let step = Raster::from_fn(4, 3, |x, _| if x < 2 { 0 } else { 10 });
/// assert_eq!(edge_magnitude(&step).row(1), [0, 40, 40, 0]);
/// ```
pub fn edge_magnitude(brightness: &Raster<u8>) -> Raster<u16> {
    let (width, height) = (brightness.width(), brightness.height());
    let mut edges = Raster::filled(width, height, 0);
    if width < 3 || height < 3 {
        return edges;
    }
    let inner = width - 2;
    for y in 1..height - 1 {
        // Slices of one length let the compiler work on many cells at once.
        let [above, here, below] = [y - 1, y, y + 1].map(|y| {
            let row = brightness.row(y);
            [&row[..inner], &row[1..=inner], &row[2..]]
        });
        let out = &mut edges.cells_mut()[y * width + 1..(y + 1) * width - 1];
        for x in 0..inner {
            let at = |row: [&[u8]; 3], column: usize| i16::from(row[column][x]);
            out[x] = magnitude(sobel(|column, row| at([above, here, below][row], column)));
        }
    }
    edges
}

/// The average filter: every cell becomes the mean of its 3 × 3 neighbourhood, rounded down.
///
/// ```
/// use wmr::vision::{Raster, average_filter};
/// let dot = Raster::from_fn(3, 3, |x, y| if (x, y) == (1, 1) { 90 } else { 0 });
/// assert_eq!(average_filter(&dot).row(1), [0, 10, 0]);
/// ```
pub fn average_filter(values: &Raster<u16>) -> Raster<u16> {
    let (width, height) = (values.width(), values.height());
    let mut mean = Raster::filled(width, height, 0);
    if width < 3 || height < 3 {
        return mean;
    }
    let mut columns = vec![0u32; width];
    let inner = width - 2;
    for y in 1..height - 1 {
        let [a, b, c] = [y - 1, y, y + 1].map(|y| &values.row(y)[..width]);
        for (x, sum) in columns.iter_mut().enumerate() {
            *sum = u32::from(a[x]) + u32::from(b[x]) + u32::from(c[x]);
        }
        let [left, middle, right] = [&columns[..inner], &columns[1..=inner], &columns[2..]];
        let out = &mut mean.cells_mut()[y * width + 1..(y + 1) * width - 1];
        for x in 0..inner {
            out[x] = ((left[x] + middle[x] + right[x]) / 9) as u16;
        }
    }
    mean
}

/// The mean of the histogram: Σ value · count / Σ count.
///
/// ```
/// use wmr::vision::{Raster, histogram_mean};
/// assert_eq!(histogram_mean(&Raster::from_fn(2, 2, |x, _| x as u16 * 10)), 5.0);
/// ```
pub fn histogram_mean(values: &Raster<u16>) -> f64 {
    let sum: u64 = values.cells().iter().map(|&value| u64::from(value)).sum();
    sum as f64 / values.cells().len().max(1) as f64
}

/// The cells above `level`: the edges, white on black.
///
/// ```
/// use wmr::vision::{Raster, threshold};
/// let edges = threshold(&Raster::from_fn(3, 1, |x, _| x as u16 * 10), 5.0);
/// assert_eq!(edges.cells(), [false, true, true]);
/// ```
pub fn threshold(values: &Raster<u16>, level: f64) -> Raster<bool> {
    let level = level.max(0.0) as u16;
    values.map(|value| value > level)
}

/// The colours reversed: white areas between black edges.
///
/// ```
/// use wmr::vision::{Raster, invert};
/// assert_eq!(invert(&Raster::from_fn(2, 1, |x, _| x == 0)).cells(), [false, true]);
/// ```
pub fn invert(edges: &Raster<bool>) -> Raster<bool> {
    edges.map(|edge| !edge)
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn a_corner_has_both_gradients() {
        let corner = Raster::from_fn(3, 3, |x, y| if x == 2 && y == 2 { 8 } else { 0 });
        assert_eq!(edge_magnitude(&corner).get(1, 1), Some(16));
    }

    proptest! {
        #[test]
        fn magnitude_and_mean_agree_with_their_definitions(cells in proptest::collection::vec(any::<u8>(), 42)) {
            let picture = Raster::from_fn(7, 6, |x, y| cells[y * 7 + x]);
            let at = |x: i64, y: i64| i32::from(picture.get(x, y).unwrap());
            let (edges, weights) = (edge_magnitude(&picture), [1, 2, 1]);
            let mean = average_filter(&edges);
            for y in 1..5 {
                for x in 1..6 {
                    let (mut gx, mut gy, mut sum) = (0, 0, 0);
                    for (i, w) in (-1..=1).zip(weights) {
                        gx += w * (at(x + 1, y + i) - at(x - 1, y + i));
                        gy += w * (at(x + i, y + 1) - at(x + i, y - 1));
                        sum += (-1..=1).map(|j| u32::from(edges.get(x + j, y + i).unwrap())).sum::<u32>();
                    }
                    prop_assert_eq!(i32::from(edges.get(x, y).unwrap()), gx.abs() + gy.abs());
                    prop_assert_eq!(u32::from(mean.get(x, y).unwrap()), sum / 9);
                }
            }
        }
    }
}
