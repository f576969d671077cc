//! From four corners to bits: the cells' brightness, sharpened, against the rim's white and the ring's black.
//!
//! Cells may be two pixels wide; blur then mixes a fifth of each neighbour into a cell. What a cell shows is
//! c′ = A c with A the blur between neighbours; c is regained by a few steps c ← c + (c′ − A c).

use super::dark::Grey;
use super::dictionary::TagDictionary;
use crate::vision::camera::homography;
use nalgebra::Matrix3;

/// The blur of camera and interpolation, pixels (standard deviation).
const BLUR: f64 = 0.9;
/// Of a cell at most this share comes from each neighbour along a row or column.
const MOST_MIXED: f64 = 0.2;
const SHARPENING_STEPS: usize = 4;
/// White is brighter than black by so many codes.
const LEAST_CONTRAST: f32 = 20.0;
/// The share of the rim's cells that must be white: a card may be cut close or touched.
const LEAST_RIM: f32 = 0.75;

/// A pattern that was read.
#[derive(Clone, Copy, Debug)]
pub(super) struct Read {
    pub(super) dictionary: TagDictionary,
    pub(super) id: usize,
    pub(super) errors: u32,
    /// The tag's own top left corner is this one of the corners that were given.
    pub(super) first_corner: usize,
}

/// The square from (0, 0) to (`cells`, `cells`) to corners clockwise from the top left.
pub(super) fn cells_to_photo(corners: [[f64; 2]; 4], cells: usize) -> Option<Matrix3<f64>> {
    let n = cells as f64;
    homography([[0.0, 0.0], [n, 0.0], [n, n], [0.0, n]], corners)
}

/// The best reading for each number of cells that `dictionaries` have.
pub(super) fn read(
    grey: &Grey,
    corners: [[f64; 2]; 4],
    dictionaries: &[TagDictionary],
) -> Vec<Read> {
    let mut sides: Vec<usize> = dictionaries.iter().map(TagDictionary::side).collect();
    sides.sort_unstable();
    sides.dedup();
    let best = |side: usize| {
        let bits = bits(grey, corners, side)?;
        let fitting = dictionaries.iter().filter(|dictionary| dictionary.side() == side);
        let readings = fitting.filter_map(|&dictionary| {
            let (errors, id, first_corner) = dictionary.nearest(bits)?;
            Some(Read { dictionary, id, errors, first_corner })
        });
        readings.min_by_key(|read| read.errors)
    };
    sides.into_iter().filter_map(best).collect()
}

/// The bits inside a black ring inside a white rim; `None` if there are no such.
fn bits(grey: &Grey, corners: [[f64; 2]; 4], side: usize) -> Option<u64> {
    let ring = side + 2;
    let width = ring + 2;
    let map = cells_to_photo(corners, ring)?;
    let place = |index: usize| {
        let (column, row) = ((index % width) as f64 - 0.5, (index / width) as f64 - 0.5);
        let image = map * nalgebra::Vector3::new(column, row, 1.0);
        [image.x / image.z, image.y / image.z]
    };
    let seen: Vec<f32> = (0..width * width).map(|index| grey.at(place(index))).collect();
    let cells = sharpened(&seen, width, mixed(corners, ring));
    let depth = |index: usize| {
        let (row, column) = (index / width, index % width);
        row.min(column).min(width - 1 - row).min(width - 1 - column)
    };
    let mean = |wanted: usize| {
        let (sum, count) = (0..width * width)
            .filter(|&index| depth(index) == wanted)
            .fold((0.0, 0.0), |(sum, count), index| (sum + cells[index], count + 1.0));
        sum / count
    };
    let (white, black) = (mean(0), mean(1));
    let middle = (white + black) / 2.0;
    let bright = |wanted: usize| {
        let all = (0..width * width).filter(move |&index| depth(index) == wanted);
        let count = all.clone().count() as f32;
        all.filter(|&index| cells[index] > middle).count() as f32 / count
    };
    if white - black < LEAST_CONTRAST || bright(1) > 0.0 || bright(0) < LEAST_RIM {
        return None;
    }
    let inside = (0..width * width).filter(|&index| depth(index) >= 2);
    Some(inside.fold(0, |bits, index| bits << 1 | u64::from(cells[index] > middle)))
}

/// What each neighbour along the columns and rows of cells mixes into a cell.
fn mixed(corners: [[f64; 2]; 4], ring: usize) -> [f32; 2] {
    let length = |i: usize| {
        let [a, b] = [corners[i], corners[(i + 1) % 4]];
        (b[0] - a[0]).hypot(b[1] - a[1])
    };
    // Blur goes across the sides: a slanted cell is as wide as its area over its other side.
    let area = (0..4).map(|i| {
        let [a, b] = [corners[i], corners[(i + 1) % 4]];
        (a[0] * b[1] - a[1] * b[0]) / 2.0
    });
    let area: f64 = area.sum();
    [[1, 3], [0, 2]].map(|[one, other]| {
        let cell = 2.0 * area / (length(one) + length(other)) / ring as f64;
        // The share of a Gaussian beyond half a cell, by the logistic function.
        let share = 1.0 / (1.0 + (1.702 * 0.5 * cell / BLUR).exp());
        share.min(MOST_MIXED) as f32
    })
}

fn sharpened(seen: &[f32], width: usize, [along, across]: [f32; 2]) -> Vec<f32> {
    let mut cells = seen.to_vec();
    let at = |cells: &[f32], index: usize, step: isize, inside: bool| {
        if inside { cells[index.wrapping_add_signed(step)] } else { cells[index] }
    };
    let stride = width as isize;
    for _ in 0..SHARPENING_STEPS {
        let pass = |cells: &[f32], share: f32, step: isize, place: &dyn Fn(usize) -> usize| {
            (0..cells.len())
                .map(|index| {
                    let here = place(index);
                    let before = at(cells, index, -step, here > 0);
                    let after = at(cells, index, step, here + 1 < width);
                    (1.0 - 2.0 * share) * cells[index] + share * (before + after)
                })
                .collect::<Vec<f32>>()
        };
        let rows = pass(&cells, along, 1, &|index| index % width);
        let both = pass(&rows, across, stride, &|index| index / width);
        cells.iter_mut().zip(seen.iter().zip(&both)).for_each(|(cell, (s, b))| *cell += s - b);
    }
    cells
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sharpening_undoes_the_mixing_of_neighbours() {
        let width = 8;
        let cells: Vec<f32> =
            (0..64).map(|i| if i % 3 == 0 || i % 5 == 1 { 200.0 } else { 20.0 }).collect();
        let mix = |cells: &[f32], step: usize, place: &dyn Fn(usize) -> usize| -> Vec<f32> {
            let mixed = |i: usize| {
                let before = if place(i) > 0 { cells[i - step] } else { cells[i] };
                let after = if place(i) < 7 { cells[i + step] } else { cells[i] };
                0.72 * cells[i] + 0.14 * (before + after)
            };
            (0..64).map(mixed).collect()
        };
        let seen = mix(&mix(&cells, 1, &|i| i % 8), 8, &|i| i / 8);
        let back = sharpened(&seen, width, [0.14; 2]);
        let worst = |of: &[f32]| {
            cells.iter().zip(of).map(|(cell, code)| (cell - code).abs()).fold(0.0, f32::max)
        };
        assert!(worst(&back) < 0.5 * worst(&seen), "{} {}", worst(&back), worst(&seen));
    }
}
