//! Which parts of a picture differ from how they looked before, block by block.
//!
//! A block's codes are summed channel by channel. Light that has changed everywhere by one factor is divided out;
//! what the camera's noise makes of a block, and a quarter of a pixel of motion at its edges, is no change.

use crate::vision::appearance::median;
use crate::vision::image::{Photo, Raster};

/// Pixels along each side of a block.
pub(super) const SIDE: usize = 4;
/// The least change, codes, and standard deviations of the changes that noise makes.
const LEAST_CHANGE: f32 = 3.0;
const SURE: f32 = 6.0;
/// Edges that move by less than so many pixels have not.
const STILL: f32 = 0.25;
/// The light is measured at every so many-th block.
const EVERY: usize = 5;
/// Blocks that are darker than this say nothing of light, codes.
const DARK: f32 = 16.0;
/// The median of the absolute values of a normal distribution, standard deviations.
const MEDIAN_OF_NORMAL: f32 = 0.6745;

/// The mean codes of the blocks of a picture.
#[derive(Clone, Debug)]
pub(super) struct Blocks {
    means: Raster<[f32; 3]>,
}

/// How a picture differs from another.
pub(super) struct Changes {
    /// The blocks that have changed.
    pub(super) changed: Raster<bool>,
    /// The codes of this picture over those of the other where nothing has changed, channel by channel.
    pub(super) gain: [f32; 3],
}

impl Blocks {
    pub(super) fn of(photo: &Photo) -> Self {
        let (width, height) = (photo.width() / SIDE, photo.height() / SIDE);
        let mut means = Vec::with_capacity(width * height);
        let mut sums = vec![[0_u16; 3]; width];
        for rows in photo.pixels().chunks_exact(SIDE * photo.width()) {
            sums.fill([0; 3]);
            for row in rows.chunks_exact(photo.width()) {
                for (sum, pixels) in sums.iter_mut().zip(row.as_chunks::<SIDE>().0) {
                    for pixel in pixels {
                        sum.iter_mut().zip(pixel).for_each(|(sum, &code)| *sum += u16::from(code));
                    }
                }
            }
            means.extend(sums.iter().map(|sum| sum.map(|sum| f32::from(sum) / PIXELS)));
        }
        Self { means: Raster::from_cells(width, means) }
    }

    /// How these differ from `before`, a picture of the same size.
    pub(super) fn changes(&self, before: &Self) -> Changes {
        let gain = [0, 1, 2].map(|part| gain(&self.means, &before.means, part));
        let off = |index: usize| {
            let (now, then) = (self.means.cells()[index], before.means.cells()[index]);
            [0, 1, 2].map(|part| (now[part] - gain[part] * then[part]).abs())
        };
        let count = self.means.cells().len();
        let noise = [0, 1, 2].map(|part| {
            let mut offs: Vec<f32> = (0..count).step_by(EVERY).map(|at| off(at)[part]).collect();
            (SURE * median(&mut offs) / MEDIAN_OF_NORMAL).max(LEAST_CHANGE)
        });
        let (width, height) = (self.means.width(), self.means.height());
        let changed = Raster::from_fn(width, height, |column, row| {
            let offs = off(row * width + column);
            let differs =
                |slack: [f32; 3]| (0..3).any(|part| offs[part] > noise[part] + slack[part]);
            differs([0.0; 3]) && differs(before.slack(column, row))
        });
        Changes { changed, gain }
    }

    /// By how much a block changes if the edges in it move by as much as counts for nothing.
    fn slack(&self, column: usize, row: usize) -> [f32; 3] {
        let (mut least, mut most) = ([f32::INFINITY; 3], [f32::NEG_INFINITY; 3]);
        for (i, j) in (-1..=1).flat_map(|j| (-1..=1).map(move |i| (i, j))) {
            let Some(seen) = self.means.get(column as i64 + i, row as i64 + j) else { continue };
            for part in 0..3 {
                least[part] = least[part].min(seen[part]);
                most[part] = most[part].max(seen[part]);
            }
        }
        [0, 1, 2].map(|part| (most[part] - least[part]) * STILL / SIDE as f32)
    }

    /// Takes blocks over from a picture whose light is `gain` times as strong.
    pub(super) fn take(&mut self, now: &Self, gain: [f32; 3], is_taken: &Raster<bool>) {
        let taken = now.means.cells().iter().zip(is_taken.cells());
        for (own, (seen, is_taken)) in self.means.cells_mut().iter_mut().zip(taken) {
            if *is_taken {
                *own = [0, 1, 2].map(|part| seen[part] / gain[part]);
            }
        }
    }
}

/// Pixels of a block.
const PIXELS: f32 = (SIDE * SIDE) as f32;

/// The median ratio of the codes of two pictures.
fn gain(now: &Raster<[f32; 3]>, then: &Raster<[f32; 3]>, part: usize) -> f32 {
    let pairs = now.cells().iter().zip(then.cells()).step_by(EVERY);
    let lit = pairs.filter(|(now, then)| now[part].min(then[part]) > DARK);
    let mut ratios: Vec<f32> = lit.map(|(now, then)| now[part] / then[part]).collect();
    if ratios.is_empty() { 1.0 } else { median(&mut ratios) }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A floor of code `floor` on which `code` tells what differs, with noise.
    fn blocks(seed: u64, code: impl Fn(f64, f64) -> Option<f64>, gain: f64) -> Blocks {
        let mut noise = fastrand::Rng::with_seed(seed);
        let pixels = (0..160 * 120).map(|i| {
            let seen = code(f64::from(i % 160), f64::from(i / 160)).unwrap_or(180.0);
            [(gain * seen + 4.0 * noise.f64()) as u8; 3]
        });
        Blocks::of(&Photo::from_rgb(160, 120, pixels.collect()).unwrap())
    }

    /// A dark square from 40 to 80 across and down, moved to the right.
    fn square(right: f64) -> impl Fn(f64, f64) -> Option<f64> {
        move |x, y| {
            let depth = (x - 40.0 - right).min(80.0 + right - x).min(y - 40.0).min(80.0 - y);
            let share = (depth + 0.5).clamp(0.0, 1.0);
            Some(180.0 - 140.0 * share)
        }
    }

    fn count(changes: &Changes) -> usize {
        changes.changed.cells().iter().filter(|changed| **changed).count()
    }

    #[test]
    fn noise_light_and_a_fifth_of_a_pixel_are_no_change_but_half_a_pixel_is() {
        let before = blocks(1, square(0.0), 1.0);
        assert_eq!(count(&blocks(2, square(0.0), 1.0).changes(&before)), 0);
        let brighter = blocks(3, square(0.0), 1.08).changes(&before);
        assert_eq!(count(&brighter), 0);
        assert!((brighter.gain[0] - 1.08).abs() < 0.01, "{:?}", brighter.gain);
        assert_eq!(count(&blocks(4, square(0.2), 1.0).changes(&before)), 0);
        assert!(count(&blocks(5, square(0.5), 1.0).changes(&before)) >= 10);
    }

    /// A thing of 8 × 8 pixels covers at least one block wholly; it is eight codes darker than the floor.
    #[test]
    fn a_small_faint_thing_is_a_change_where_it_stands() {
        let thing = |x: f64, y: f64| {
            ((102.0..110.0).contains(&x) && (58.0..66.0).contains(&y)).then_some(172.0)
        };
        let changes = blocks(6, thing, 1.0).changes(&blocks(7, |_, _| None, 1.0));
        assert_eq!(changes.changed.get(26, 15), Some(true));
        assert!(count(&changes) <= 9);
    }

    #[test]
    fn blocks_that_were_taken_over_have_not_changed_since() {
        let mut before = blocks(8, |_, _| None, 1.0);
        let now = blocks(9, square(0.0), 1.05);
        let Changes { changed, gain } = now.changes(&before);
        before.take(&now, gain, &changed);
        assert_eq!(count(&now.changes(&before)), 0);
    }
}
