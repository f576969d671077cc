//! Dark regions against their surroundings, and their outlines to a fraction of a pixel.
//!
//! The threshold of a pixel is half-way between the darkest and the brightest pixel of the 3 × 3 tiles
//! around it (as AprilTag does, Wang and Olson 2016): tags are small, light is not even. Where these
//! differ little nothing is dark. The outline is followed pixel by pixel (Moore); its points lie where
//! brightness crosses the threshold between a dark pixel and its neighbour.

use crate::vision::image::Photo;

/// Side of a tile, pixels: with its neighbours it spans the rim and the ring of the smallest tag.
const TILE: usize = 4;
/// Brightness codes between dark and bright: noise makes less.
const LEAST_CONTRAST: u8 = 24;
/// An outline of fewer pixels is no tag of 8 pixels.
const LEAST_OUTLINE: usize = 24;
/// East, then clockwise with rows running down.
const AROUND: [(isize, isize); 8] =
    [(1, 0), (1, 1), (0, 1), (-1, 1), (-1, 0), (-1, -1), (0, -1), (1, -1)];

/// The brightness of a photo, sRGB codes.
pub(super) struct Grey {
    pub(super) width: usize,
    pub(super) height: usize,
    pub(super) codes: Vec<u8>,
}

impl Grey {
    pub(super) fn of(photo: &Photo) -> Self {
        let grey =
            |&[r, g, b]: &[u8; 3]| ((u16::from(r) + 2 * u16::from(g) + u16::from(b)) >> 2) as u8;
        let codes = photo.pixels().iter().map(grey).collect();
        Self { width: photo.width(), height: photo.height(), codes }
    }

    /// The brightness between four pixels; beyond the rim that of the rim.
    #[inline]
    pub(super) fn at(&self, [x, y]: [f64; 2]) -> f32 {
        let x = x.clamp(0.0, (self.width - 1) as f64) as f32;
        let y = y.clamp(0.0, (self.height - 1) as f64) as f32;
        let (left, top) = ((x as usize).min(self.width - 2), (y as usize).min(self.height - 2));
        let (right, down) = (x - left as f32, y - top as f32);
        let first = top * self.width + left;
        let code = |index: usize| f32::from(self.codes[index]);
        let upper = code(first) + right * (code(first + 1) - code(first));
        let lower = code(first + self.width)
            + right * (code(first + self.width + 1) - code(first + self.width));
        upper + down * (lower - upper)
    }
}

/// For each tile the threshold; 0 where nothing is dark.
fn thresholds(grey: &Grey) -> (usize, Vec<u8>) {
    let (columns, rows) = (grey.width.div_ceil(TILE), grey.height.div_ceil(TILE));
    let mut extremes = vec![(u8::MAX, 0u8); columns * rows];
    for (row, line) in grey.codes.chunks_exact(grey.width).enumerate() {
        let tiles = &mut extremes[row / TILE * columns..][..columns];
        for (tile, codes) in tiles.iter_mut().zip(line.chunks(TILE)) {
            for &code in codes {
                *tile = (tile.0.min(code), tile.1.max(code));
            }
        }
    }
    let joined = |(a, b): (u8, u8), (c, d): (u8, u8)| (a.min(c), b.max(d));
    let wide: Vec<(u8, u8)> = (0..columns * rows)
        .map(|index| {
            let column = index % columns;
            let left = if column > 0 { extremes[index - 1] } else { extremes[index] };
            let right = if column + 1 < columns { extremes[index + 1] } else { extremes[index] };
            joined(joined(left, right), extremes[index])
        })
        .collect();
    let threshold = |index: usize| {
        let above = wide[index.checked_sub(columns).unwrap_or(index)];
        let below = wide.get(index + columns).copied().unwrap_or(wide[index]);
        let (low, high) = joined(joined(above, below), wide[index]);
        let middle = low + (high - low) / 2;
        if high - low >= LEAST_CONTRAST { middle } else { 0 }
    };
    (columns, (0..columns * rows).map(threshold).collect())
}

const DARK: u8 = 1;
const FOLLOWED: u8 = 2;

/// The dark pixels, with a rim of one light pixel around the picture.
pub(super) struct Outlines<'a> {
    grey: &'a Grey,
    columns: usize,
    thresholds: Vec<u8>,
    stride: usize,
    mask: Vec<u8>,
}

impl<'a> Outlines<'a> {
    pub(super) fn of(grey: &'a Grey) -> Self {
        let (columns, thresholds) = thresholds(grey);
        let stride = grey.width + 2;
        let mut mask = vec![0; stride * (grey.height + 2)];
        for (row, line) in grey.codes.chunks_exact(grey.width).enumerate() {
            let limits = &thresholds[row / TILE * columns..][..columns];
            let out = &mut mask[(row + 1) * stride + 1..][..grey.width];
            for ((out, codes), &limit) in out.chunks_mut(TILE).zip(line.chunks(TILE)).zip(limits) {
                out.iter_mut().zip(codes).for_each(|(out, &code)| *out = u8::from(code < limit));
            }
        }
        Self { grey, columns, thresholds, stride, mask }
    }

    /// Calls `each` with the outline of every dark region that is large enough, clockwise as seen.
    pub(super) fn for_each(&mut self, mut each: impl FnMut(&[[f64; 2]])) {
        let (mut pixels, mut points) = (Vec::new(), Vec::new());
        for first in self.stride..self.mask.len() - self.stride {
            if self.mask[first] != DARK || self.mask[first - 1] & DARK != 0 {
                continue;
            }
            self.follow(first, &mut pixels);
            if pixels.len() < LEAST_OUTLINE || self.twice_area(&pixels) <= 0 {
                continue;
            }
            self.refine(&pixels, &mut points);
            each(&points);
        }
    }

    /// Follows an outline from a dark pixel whose western neighbour is light.
    fn follow(&mut self, first: usize, pixels: &mut Vec<usize>) {
        pixels.clear();
        let (mut here, mut heading, mut first_step) = (first, 0, None);
        loop {
            self.mask[here] |= FOLLOWED;
            let next = (heading + 5..heading + 13).map(|turn| turn % 8).find_map(|turn| {
                let to = self.neighbour(here, AROUND[turn]);
                (self.mask[to] & DARK != 0).then_some((to, turn))
            });
            let Some((to, turn)) = next else { return };
            if here == first && first_step == Some(turn) {
                return;
            }
            first_step.get_or_insert(turn);
            pixels.push(here);
            (here, heading) = (to, turn);
        }
    }

    fn neighbour(&self, pixel: usize, (x, y): (isize, isize)) -> usize {
        pixel.wrapping_add_signed(x + y * self.stride as isize)
    }

    fn place(&self, pixel: usize) -> (usize, usize) {
        (pixel % self.stride - 1, pixel / self.stride - 1)
    }

    /// Twice the area that an outline encloses; negative for the outline of a hole.
    fn twice_area(&self, pixels: &[usize]) -> i64 {
        let mut last = pixels.last().map_or((0, 0), |&pixel| self.place(pixel));
        pixels.iter().fold(0, |sum, &pixel| {
            let here = self.place(pixel);
            let part = last.0 as i64 * here.1 as i64 - here.0 as i64 * last.1 as i64;
            last = here;
            sum + part
        })
    }

    fn refine(&self, pixels: &[usize], points: &mut Vec<[f64; 2]>) {
        points.clear();
        for &pixel in pixels {
            let (x, y) = self.place(pixel);
            let limit = f64::from(self.thresholds[y / TILE * self.columns + x / TILE]);
            let inside = f64::from(self.grey.codes[y * self.grey.width + x]);
            for (right, down) in [AROUND[0], AROUND[2], AROUND[4], AROUND[6]] {
                if self.mask[self.neighbour(pixel, (right, down))] & DARK != 0 {
                    continue;
                }
                let (Some(u), Some(v)) = (x.checked_add_signed(right), y.checked_add_signed(down))
                else {
                    continue;
                };
                if u >= self.grey.width || v >= self.grey.height {
                    continue;
                }
                let outside = f64::from(self.grey.codes[v * self.grey.width + u]);
                if outside < limit {
                    continue;
                }
                let share = ((limit - inside) / (outside - inside).max(1.0)).clamp(0.0, 1.0);
                points.push([x as f64 + share * right as f64, y as f64 + share * down as f64]);
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_outline_of_a_square_lies_half_way_up_its_edges() {
        // Dark from 20.25 to 40.25 pixels in both directions: edge pixels hold shares of both.
        let share = |i: usize| {
            (i as f64 + 0.5 - 20.25).clamp(0.0, 1.0).min((40.75 - i as f64).clamp(0.0, 1.0))
        };
        let code = |i: usize| (220.0 - 200.0 * share(i % 64) * share(i / 64)) as u8;
        let photo = Photo::from_rgb(64, 64, (0..64 * 64).map(|i| [code(i); 3]).collect()).unwrap();
        let grey = Grey::of(&photo);
        let mut seen = Vec::new();
        Outlines::of(&grey).for_each(|points| seen.push(points.to_vec()));
        assert_eq!(seen.len(), 1);
        let low = seen[0].iter().map(|p| p[0]).fold(f64::MAX, f64::min);
        let high = seen[0].iter().map(|p| p[0]).fold(0.0, f64::max);
        assert!((low - 20.25).abs() < 0.5 && (high - 40.25).abs() < 0.55, "{low} {high}");
    }

    #[test]
    fn holes_and_flat_pictures_have_no_outline() {
        let ring = |i: usize| {
            let (x, y) = (i % 64, i / 64);
            let within =
                |low: usize, high: usize| (low..high).contains(&x) && (low..high).contains(&y);
            if within(16, 48) && !within(22, 42) { [30; 3] } else { [200; 3] }
        };
        let photo = Photo::from_rgb(64, 64, (0..4096).map(ring).collect()).unwrap();
        let mut count = 0;
        Outlines::of(&Grey::of(&photo)).for_each(|_| count += 1);
        assert_eq!(count, 1);
        let flat = Photo::from_rgb(64, 64, vec![[90; 3]; 4096]).unwrap();
        Outlines::of(&Grey::of(&flat)).for_each(|_| count += 1);
        assert_eq!(count, 1);
    }
}
