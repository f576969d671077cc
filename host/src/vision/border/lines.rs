//! Long straight edges in the photo, by a Hough transform: what a border may be made of.
//!
//! Lines are searched for in two directions, nearer to the horizontal and nearer to the vertical, each up to 60°
//! off: an arena may lie turned by any angle, and perspective spreads its sides. A line near 45° belongs to both. A line is
//! `v = offset + slope · (u − u0)`, u along the direction and v across it, pixels, u0 the middle of u.

use crate::vision::image::{Photo, Raster, magnitude, sobel};

/// Slopes reach from −1.7 to 1.7 (60°).
const SLOPE_LIMIT: f64 = 1.7;
const SLOPE_STEP: f64 = 0.02;
/// An edge point votes for directions this far from its own, radians.
const TURN_SPREAD: f64 = 0.1;
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
    u: f32,
    v: f32,
    slope: f32,
    weight: f32,
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

/// The edges of a photo, thinned to one pixel, by direction; the points of each in the order of v.
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
        let magnitude = magnitudes(photo);
        let (noise, contrast) = levels(&magnitude);
        let least = (3.0 * noise).max(24.0) as u16;
        let mut map = Self {
            horizontal: Vec::new(),
            vertical: Vec::new(),
            width: photo.width(),
            height: photo.height(),
            contrast: contrast / 4.0,
        };
        for y in 1..photo.height() - 1 {
            for (x, &here) in magnitude.row(y).iter().enumerate() {
                // The outermost pixels have no gradient.
                if here >= least {
                    map.add(photo, &magnitude, (x, y));
                }
            }
        }
        for points in [&mut map.horizontal, &mut map.vertical] {
            points.sort_unstable_by(|a, b| a.v.total_cmp(&b.v));
        }
        map
    }

    /// Adds an inner pixel if its gradient is the greatest across the edge.
    fn add(&mut self, photo: &Photo, magnitude: &Raster<u16>, (x, y): (usize, usize)) {
        let [gx, gy] = gradient(photo, x, y);
        let horizontal = gy.abs() > gx.abs();
        let index = y * self.width + x;
        let across = if horizontal { self.width } else { 1 };
        let [b, h, a] = [index - across, index, index + across].map(|i| magnitude.cells()[i]);
        if h < b || h <= a {
            return;
        }
        let [b, h, a] = [b, h, a].map(f32::from);
        let shift = 0.5 * (b - a) / (b - 2.0 * h + a).min(-1e-9);
        let (x, y) = (x as f32, y as f32);
        let (x, y) = if horizontal { (x, y + shift) } else { (x + shift, y) };
        let weight = h / (h + 80.0);
        let [gx, gy] = [gx, gy].map(f32::from);
        let limit = SLOPE_LIMIT as f32;
        if gx.abs() <= limit * gy.abs() {
            self.horizontal.push(EdgePoint { u: x, v: y, slope: -gx / gy, weight });
        }
        if gy.abs() <= limit * gx.abs() {
            self.vertical.push(EdgePoint { u: y, v: x, slope: -gy / gx, weight });
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

/// The magnitudes |∂f/∂x| + |∂f/∂y| of the channel where that is greatest, by Sobel; 0 on the rim.
fn magnitudes(photo: &Photo) -> Raster<u16> {
    let (width, height) = (photo.width(), photo.height());
    let codes = photo.pixels().as_flattened();
    let length = 3 * width;
    let mut edges = Raster::filled(width, height, 0u16);
    let mut of_channels = vec![0u16; length - 6];
    for y in 1..height - 1 {
        // Channels lie side by side: the same channel of the next pixel is three places on.
        let [above, here, below] = [y - 1, y, y + 1].map(|row| {
            let row = &codes[row * length..(row + 1) * length];
            [&row[..length - 6], &row[3..length - 3], &row[6..]]
        });
        for (index, out) in of_channels.iter_mut().enumerate() {
            let at = |row: [&[u8]; 3], part: usize| i16::from(row[part][index]);
            *out = magnitude(sobel(|x, y| at([above, here, below][y], x)));
        }
        let row = &mut edges.cells_mut()[y * width + 1..(y + 1) * width - 1];
        for (cell, [red, green, blue]) in row.iter_mut().zip(of_channels.as_chunks().0) {
            *cell = *red.max(green).max(blue);
        }
    }
    edges
}

/// The Sobel gradient at an inner pixel of the channel where it is strongest.
fn gradient(photo: &Photo, x: usize, y: usize) -> [i16; 2] {
    let of_channel = |channel: usize| {
        let at = |i: usize, j: usize| {
            i16::from(photo.pixels()[(y + j - 1) * photo.width() + x + i - 1][channel])
        };
        sobel(at)
    };
    let stronger = |a, b| if magnitude(b) > magnitude(a) { b } else { a };
    stronger(stronger(of_channel(0), of_channel(1)), of_channel(2))
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
        let (u, slope) = (f64::from(point.u) - middle, f64::from(point.slope));
        let index = |slope: f64| (slope + SLOPE_LIMIT) / SLOPE_STEP;
        let spread = slope_spread(slope);
        let first = index(slope - spread).ceil().max(0.0) as usize;
        let end = (index(slope + spread).floor() + 1.0).clamp(0.0, slopes as f64) as usize;
        for index in first..end {
            let slope = index as f64 * SLOPE_STEP - SLOPE_LIMIT;
            let offset = f64::from(point.v) - slope * u + margin as f64;
            let cell = offset as usize;
            if offset >= 0.0 && cell + 1 < offsets {
                let share = (offset - cell as f64) as f32;
                let start = index * offsets + cell;
                votes.cells_mut()[start] += point.weight * (1.0 - share);
                votes.cells_mut()[start + 1] += point.weight * share;
            }
        }
    }
    strongest(votes, length)
        .into_iter()
        .map(|(x, y)| (x as f64 - margin as f64, y as f64 * SLOPE_STEP - SLOPE_LIMIT))
        .collect()
}

/// How far slopes are apart whose directions are [`TURN_SPREAD`] apart.
fn slope_spread(slope: f64) -> f64 {
    TURN_SPREAD * (1.0 + slope * slope)
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
        for point in near(points, length, offset, slope, reach) {
            let (u, w) = (f64::from(point.u) - middle, f64::from(point.weight));
            let v = f64::from(point.v);
            for (sum, term) in sums.iter_mut().zip([w, w * u, w * u * u, w * v, w * u * v]) {
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
    for point in near(points, length, offset, slope, REACH) {
        support[(point.u as usize).min(length - 1) + 1] = 1;
    }
    for index in 1..support.len() {
        support[index] += support[index - 1];
    }
    Some(Line { offset, slope, middle, support })
}

/// The edge points, of those in the order of v, within `reach` of a line and of about its slope.
fn near(
    points: &[EdgePoint],
    length: usize,
    offset: f64,
    slope: f64,
    reach: f64,
) -> impl Iterator<Item = &EdgePoint> {
    let middle = length as f64 / 2.0;
    let most = reach + slope.abs() * middle;
    let first = points.partition_point(|point| f64::from(point.v) < offset - most);
    let end = points.partition_point(|point| f64::from(point.v) <= offset + most);
    let spread = 2.0 * slope_spread(slope) as f32;
    let (offset, slope, middle) = (offset as f32, slope as f32, middle as f32);
    points[first..end.max(first)].iter().filter(move |point| {
        (point.v - offset - slope * (point.u - middle)).abs() < reach as f32
            && (point.slope - slope).abs() < spread
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
