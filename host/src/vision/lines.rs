//! Long straight edges in the photo, by a Hough transform: what a border may be made of.
//!
//! Lines are sought in two directions, nearly horizontal and nearly vertical, up to 35° off, because
//! an arena may lie turned by 25° and tilted in the picture. A line is `v = offset + slope · (u − u0)`, u
//! along the direction and v across it, pixels, u0 the middle of u.

use super::photo::Photo;
use super::raster::Raster;

/// Slopes reach from −0.7 to 0.7 (35°).
const SLOPE_LIMIT: f64 = 0.7;
const SLOPE_STEP: f64 = 0.02;
/// An edge point votes for slopes this far from its own.
const SLOPE_SPREAD: f64 = 0.1;
/// Lines kept for each direction.
const MOST_LINES: usize = 30;
/// How far an edge point may lie from a line that it supports, pixels.
const REACH: f64 = 2.0;

/// The direction in which lines run.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Direction {
    Horizontal,
    Vertical,
}

/// A point on an edge, seen along one direction.
#[derive(Clone, Copy, Debug)]
struct EdgePoint {
    u: f64,
    v: f64,
    slope: f64,
    weight: f64,
}

/// A straight edge, and where along it edge points are found.
#[derive(Clone, Debug)]
pub(crate) struct Line {
    pub(crate) offset: f64,
    pub(crate) slope: f64,
    middle: f64,
    /// `support[i]`: how many of the places u = 0..i have an edge point at the line.
    support: Vec<u32>,
}

impl Line {
    /// The line's v at u.
    pub(crate) fn at(&self, u: f64) -> f64 {
        self.offset + self.slope * (u - self.middle)
    }

    /// The share of the places between `from` and `to` that have an edge point at the line.
    pub(crate) fn support(&self, from: f64, to: f64) -> f64 {
        let last = (self.support.len() - 1) as f64;
        let (a, b) =
            (from.min(to).clamp(0.0, last) as usize, from.max(to).clamp(0.0, last) as usize);
        let found = self.support[b] - self.support[a];
        f64::from(found) / (from - to).abs().max(1.0)
    }
}

/// The edges of a photo, thinned to one pixel, by direction.
pub(crate) struct EdgeMap {
    horizontal: Vec<EdgePoint>,
    vertical: Vec<EdgePoint>,
    width: usize,
    height: usize,
    /// The 99.5th percentile of the steps across edges, brightness codes.
    pub(crate) contrast: f64,
}

impl EdgeMap {
    /// The edges of `photo`: in every pixel the channel with the strongest gradient counts.
    pub(crate) fn of(photo: &Photo) -> Self {
        let gradient = gradients(photo);
        let magnitude = gradient.map(|[gx, gy]| gx.unsigned_abs() + gy.unsigned_abs());
        let (noise, contrast) = levels(&magnitude);
        let least = (3.0 * noise).max(24.0);
        let mut map = Self {
            horizontal: Vec::new(),
            vertical: Vec::new(),
            width: photo.width(),
            height: photo.height(),
            contrast: contrast / 4.0,
        };
        for y in 1..photo.height() as i64 - 1 {
            for x in 1..photo.width() as i64 - 1 {
                map.add(&gradient, &magnitude, (x, y), least);
            }
        }
        map
    }

    fn add(
        &mut self,
        gradient: &Raster<[i16; 2]>,
        magnitude: &Raster<u16>,
        (x, y): (i64, i64),
        least: f64,
    ) {
        let here = magnitude.get(x, y).unwrap_or(0);
        if f64::from(here) < least {
            return;
        }
        let [gx, gy] = gradient.get(x, y).unwrap_or([0, 0]);
        let horizontal = gy.abs() > gx.abs();
        let (dx, dy) = if horizontal { (0, 1) } else { (1, 0) };
        let before = magnitude.get(x - dx, y - dy).unwrap_or(0);
        let after = magnitude.get(x + dx, y + dy).unwrap_or(0);
        if here < before || here <= after {
            return;
        }
        let (b, h, a) = (f64::from(before), f64::from(here), f64::from(after));
        let shift = 0.5 * (b - a) / (b - 2.0 * h + a).min(-1e-9);
        let weight = h / (h + 80.0);
        if horizontal {
            let slope = -f64::from(gx) / f64::from(gy);
            self.horizontal.push(EdgePoint { u: x as f64, v: y as f64 + shift, slope, weight });
        } else {
            let slope = -f64::from(gy) / f64::from(gx);
            self.vertical.push(EdgePoint { u: y as f64, v: x as f64 + shift, slope, weight });
        }
    }

    /// The strongest lines of one direction.
    pub(crate) fn lines(&self, direction: Direction) -> Vec<Line> {
        let (points, length, breadth) = match direction {
            Direction::Horizontal => (&self.horizontal, self.width, self.height),
            Direction::Vertical => (&self.vertical, self.height, self.width),
        };
        let mut lines: Vec<Line> = Vec::new();
        for (offset, slope) in peaks(points, length, breadth) {
            let Some(line) = fit(points, length, offset, slope) else { continue };
            let known = lines.iter().any(|other| {
                let ends = [0.0, length as f64].map(|u| (other.at(u) - line.at(u)).abs());
                ends[0].max(ends[1]) < 1.5
            });
            if !known {
                lines.push(line);
            }
        }
        lines
    }
}

/// The Sobel gradient of the channel where it is strongest.
fn gradients(photo: &Photo) -> Raster<[i16; 2]> {
    let (width, height) = (photo.width(), photo.height());
    let pixels = photo.pixels();
    let mut gradient = Raster::filled(width, height, [0i16; 2]);
    for y in 1..height - 1 {
        let rows = [y - 1, y, y + 1].map(|row| &pixels[row * width..(row + 1) * width]);
        for x in 1..width - 1 {
            let of_channel = |channel: usize| {
                let at = |row: usize, column: usize| i16::from(rows[row][column][channel]);
                let side = |column: usize| at(0, column) + 2 * at(1, column) + at(2, column);
                let level = |row: usize| at(row, x - 1) + 2 * at(row, x) + at(row, x + 1);
                [side(x + 1) - side(x - 1), level(2) - level(0)]
            };
            let [red, green, blue] = [0, 1, 2].map(of_channel);
            let stronger = |a: [i16; 2], b: [i16; 2]| {
                if b[0].abs() + b[1].abs() > a[0].abs() + a[1].abs() { b } else { a }
            };
            let best = stronger(stronger(red, green), blue);
            gradient.cells_mut()[y * width + x] = best;
        }
    }
    gradient
}

/// The median and the 99.5th percentile of the magnitudes.
fn levels(magnitude: &Raster<u16>) -> (f64, f64) {
    let mut histogram = vec![0usize; 2048];
    for &value in magnitude.cells() {
        histogram[usize::from(value).min(2047)] += 1;
    }
    let at = |share: f64| {
        let wanted = (magnitude.cells().len() as f64 * share) as usize;
        let mut seen = 0;
        histogram.iter().position(|&count| {
            seen += count;
            seen > wanted
        })
    };
    (at(0.5).unwrap_or(0) as f64, at(0.995).unwrap_or(2047) as f64)
}

/// The peaks of the Hough transform as (offset, slope), strongest first.
fn peaks(points: &[EdgePoint], length: usize, breadth: usize) -> Vec<(f64, f64)> {
    let slopes = (2.0 * SLOPE_LIMIT / SLOPE_STEP) as usize + 1;
    let margin = (SLOPE_LIMIT * length as f64 / 2.0) as usize;
    let offsets = breadth + 2 * margin;
    let mut votes = Raster::filled(offsets, slopes, 0f32);
    let middle = length as f64 / 2.0;
    for point in points {
        let first =
            ((point.slope - SLOPE_SPREAD + SLOPE_LIMIT) / SLOPE_STEP).ceil().max(0.0) as usize;
        for index in first..slopes {
            let slope = index as f64 * SLOPE_STEP - SLOPE_LIMIT;
            if slope > point.slope + SLOPE_SPREAD {
                break;
            }
            let offset = point.v - slope * (point.u - middle) + margin as f64;
            let cell = offset as usize;
            if offset >= 0.0 && cell + 1 < offsets {
                let share = (offset - cell as f64) as f32;
                let start = index * offsets + cell;
                votes.cells_mut()[start] += point.weight as f32 * (1.0 - share);
                votes.cells_mut()[start + 1] += point.weight as f32 * share;
            }
        }
    }
    strongest(votes, length)
        .into_iter()
        .map(|(x, y)| (x as f64 - margin as f64, y as f64 * SLOPE_STEP - SLOPE_LIMIT))
        .collect()
}

/// The strongest cells that are the greatest of their neighbourhood.
fn strongest(votes: Raster<f32>, length: usize) -> Vec<(usize, usize)> {
    let least = 0.08 * length as f32;
    let mut found = Vec::new();
    for y in 0..votes.height() as i64 {
        for (x, &value) in votes.row(y as usize).iter().enumerate() {
            if value < least {
                continue;
            }
            let greatest = (-2..=2).all(|dy| {
                (-2..=2).all(|dx| {
                    let other = votes.get(x as i64 + dx, y + dy).unwrap_or(0.0);
                    other < value || (other == value && (dy, dx) <= (0, 0))
                })
            });
            if greatest {
                found.push((value, x, y as usize));
            }
        }
    }
    found.sort_by(|a, b| b.0.total_cmp(&a.0));
    found.into_iter().take(MOST_LINES).map(|(_, x, y)| (x, y)).collect()
}

/// The line through the edge points near a first guess, by weighted least squares.
fn fit(points: &[EdgePoint], length: usize, mut offset: f64, mut slope: f64) -> Option<Line> {
    let middle = length as f64 / 2.0;
    for reach in [2.0 * REACH, REACH] {
        let mut sums = [0.0; 5];
        for point in near(points, middle, offset, slope, reach) {
            let (u, w) = (point.u - middle, point.weight);
            for (sum, term) in
                sums.iter_mut().zip([w, w * u, w * u * u, w * point.v, w * u * point.v])
            {
                *sum += term;
            }
        }
        let [w, wu, wuu, wv, wuv] = sums;
        let determinant = w * wuu - wu * wu;
        if determinant < 1e-6 {
            return None;
        }
        offset = (wuu * wv - wu * wuv) / determinant;
        slope = (w * wuv - wu * wv) / determinant;
    }
    let mut support = vec![0u32; length + 1];
    for point in near(points, middle, offset, slope, REACH) {
        support[(point.u as usize).min(length - 1) + 1] = 1;
    }
    for index in 1..support.len() {
        support[index] += support[index - 1];
    }
    Some(Line { offset, slope, middle, support })
}

fn near(
    points: &[EdgePoint],
    middle: f64,
    offset: f64,
    slope: f64,
    reach: f64,
) -> impl Iterator<Item = &EdgePoint> {
    points.iter().filter(move |point| {
        (point.v - offset - slope * (point.u - middle)).abs() < reach
            && (point.slope - slope).abs() < 2.0 * SLOPE_SPREAD
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_slanted_step_is_one_line_of_that_slope() {
        let pixels = (0..100 * 80).map(|i| {
            let (x, y) = ((i % 100) as f64, (i / 100) as f64);
            let cover = (y - (30.0 + 0.2 * (x - 50.0)) + 0.5).clamp(0.0, 1.0);
            [(200.0 * cover) as u8; 3]
        });
        let photo = Photo::from_rgb(100, 80, pixels.collect()).unwrap();
        let map = EdgeMap::of(&photo);
        let lines = map.lines(Direction::Horizontal);
        let best = &lines[0];
        assert!((best.slope - 0.2).abs() < 0.01 && (best.offset - 30.0).abs() < 0.5, "{best:?}");
        assert!(best.support(5.0, 95.0) > 0.9);
        assert!(map.lines(Direction::Vertical).is_empty());
    }

    #[test]
    fn an_even_picture_has_no_lines() {
        let photo = Photo::from_rgb(64, 64, vec![[90; 3]; 4096]).unwrap();
        let map = EdgeMap::of(&photo);
        assert!(map.lines(Direction::Horizontal).is_empty() && map.contrast < 1.0);
    }
}
