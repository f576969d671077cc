//! Whether the camera stands where it stood when the empty picture was taken.
//!
//! Both pictures are reduced to what local light does not change: the logarithm of their brightness less its
//! mean around each pixel. At the edges of the empty picture the difference between the two tells how far the
//! photo lies across each edge; the motion of the whole picture (shift, turn, growth) that explains most of
//! them is found by re-weighted least squares, so that boxes, shadows and the robot do not count:
//!
//! `P(x + u) − E(x) ≈ 0` with `u = t + θ J (x − c) + σ (x − c)`
//!
//! P photo, E empty picture, x a pixel, c the picture's centre, t shift (pixels), θ turn (radians), J a quarter
//! turn, σ growth. A motion too large for that leaves most edges where the photo has none.

use crate::vision::appearance::median;
use crate::vision::error::VisionError;
use crate::vision::image::{Photo, Raster};
use crate::vision::least_squares::{NormalEquations, geman_mcclure};
use nalgebra::SVector;

/// A camera that moved by more, pixels and radians, has moved: a pixel and 0.1° are always noticed.
const MOST_SHIFT: f64 = 0.4;
const MOST_TURN: f64 = 0.035 * std::f64::consts::PI / 180.0;
/// The share of edges that both pictures have in one place if the camera did not move.
const LEAST_AGREEING: f64 = 0.7;
/// Edges differ by less than this, pixels, where nothing has changed.
const TOLERANCE: f32 = 0.5;
/// In dark places a little light is no edge: share of white.
const DARK: f32 = 0.1;
/// The mean around a pixel is that of so many pixels to both sides.
const AROUND: usize = 4;
/// Edges are at least this steep: logarithms a pixel, and share of the steepest.
const LEAST_SLOPE: f32 = 0.02;
const STEEP_SHARE: f32 = 0.25;
/// With fewer pixels at edges nothing is known of the motion.
const LEAST_EDGES: usize = 100;
/// Edges at most; of more, those in every so many-th block of so many pixels count.
const MOST_EDGES: usize = 12_000;
const BLOCK: usize = 16;
/// Least-squares steps at each size of the picture, and sizes, each half the one before.
const STEPS: usize = 12;
const SIZES: usize = 4;
/// Turn and growth count per so many pixels, so that all parts of a motion are alike.
const LEVER: f64 = 100.0;

/// A motion of a picture about its centre.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Motion {
    /// Pixels to the right and down.
    shift: [f64; 2],
    /// Radians, clockwise as the picture shows it.
    turn: f64,
    growth: f64,
    /// The share of the empty picture's edges that the photo has there.
    agreeing: f64,
}

/// Refuses pictures by a camera that moved between them, by a pixel, 0.1° or more.
///
/// # Errors
/// [`VisionError::EmptySize`], [`VisionError::EmptyMoved`] or [`VisionError::EmptyUnlike`].
///
/// ```
/// use wmr::vision::{Photo, VisionError, check_still};
/// // A dark square whose edges a lens has blurred over three pixels.
/// let square = |left: f64| {
///     let pixel = |i: usize| {
///         let (x, y) = ((i % 96) as f64, (i / 96) as f64);
///         let depth = (x - left).min(left + 40.0 - x).min(y - 20.0).min(70.0 - y);
///         [(200.0 - 160.0 * (depth / 3.0 + 0.5).clamp(0.0, 1.0)) as u8; 3]
///     };
///     Photo::from_rgb(96, 96, (0..96 * 96).map(pixel).collect())
/// };
/// check_still(&square(20.0)?, &square(20.0)?)?;
/// assert!(matches!(check_still(&square(21.0)?, &square(20.0)?), Err(VisionError::EmptyMoved { .. })));
/// # Ok::<(), VisionError>(())
/// ```
pub fn check_still(photo: &Photo, empty: &Photo) -> Result<(), VisionError> {
    let [size, other] = [photo, empty].map(|picture| [picture.width(), picture.height()]);
    if size != other {
        return Err(VisionError::EmptySize { photo: size, empty: other });
    }
    let factor = photo.overview_factor();
    let (small, small_empty) = (photo.reduced(factor), empty.reduced(factor));
    let gain = gain(&small, &small_empty);
    let (small, small_empty) = (logs(&small, gain), logs(&small_empty, 1.0));
    let Some(motion) = Motion::of(&small, &small_empty, Motion::NONE) else { return Ok(()) };
    let half_diagonal = f64::hypot(small.width() as f64, small.height() as f64) / 2.0;
    let pixels = factor as f64;
    if motion.agreeing >= LEAST_AGREEING {
        return motion.check(pixels, half_diagonal);
    }
    let far = search(&small, &small_empty).filter(|far| far.agreeing >= LEAST_AGREEING);
    far.map_or(Ok(()), |far| far.check(pixels, half_diagonal))?;
    Err(VisionError::EmptyUnlike { measured: motion.agreeing, needed: LEAST_AGREEING })
}

/// The motion between pictures that may lie far apart, from their smallest copies on.
fn search(photo: &Raster<f32>, empty: &Raster<f32>) -> Option<Motion> {
    let mut sizes = vec![(photo.clone(), empty.clone())];
    while sizes.len() < SIZES
        && let Some((photo, empty)) = sizes.last()
    {
        sizes.push((halved(photo), halved(empty)));
    }
    let mut motion = Motion::NONE;
    for (photo, empty) in sizes.iter().rev() {
        motion.shift = motion.shift.map(|pixels| 2.0 * pixels);
        motion = Motion::of(photo, empty, motion)?;
    }
    Some(motion)
}

impl Motion {
    const NONE: Self = Self { shift: [0.0; 2], turn: 0.0, growth: 0.0, agreeing: 0.0 };

    /// Refuses a motion in a picture whose pixels are `pixels` of the photo wide.
    fn check(self, pixels: f64, half_diagonal: f64) -> Result<(), VisionError> {
        let [x, y] = self.shift.map(|shift| shift * pixels);
        let shift = f64::hypot(x, y).max((self.growth * half_diagonal * pixels).abs());
        let moved = shift > MOST_SHIFT || self.turn.abs() > MOST_TURN;
        let error = || VisionError::EmptyMoved { shift, turn: self.turn };
        if moved { Err(error()) } else { Ok(()) }
    }

    /// The motion from the empty picture to the photo near `start`, logarithms of brightness both; `None`
    /// without edges.
    fn of(photo: &Raster<f32>, empty: &Raster<f32>, start: Self) -> Option<Self> {
        let edges = edges(empty);
        if edges.len() < LEAST_EDGES {
            return None;
        }
        let seen = local(photo);
        let mut motion = start;
        for _ in 0..STEPS {
            let (sums, agreeing) = motion.equations(&seen, &edges);
            motion.agreeing = agreeing;
            let step = sums.solve()?;
            motion.shift[0] -= step[0];
            motion.shift[1] -= step[1];
            motion.turn -= step[2] / LEVER;
            motion.growth -= step[3] / LEVER;
            if step.amax() < 1e-3 {
                break;
            }
        }
        motion.agreeing = motion.equations(&seen, &edges).1;
        Some(motion)
    }

    /// The normal equations of the next step, and the share of edges that agree.
    fn equations(&self, seen: &Raster<f32>, edges: &[Edge]) -> (NormalEquations<4>, f64) {
        let mut sums = NormalEquations::new(1e-9);
        let mut agreeing = 0;
        for edge in edges {
            let ([x, y], [dx, dy]) = (edge.from_centre, edge.slope.map(f64::from));
            let u = self.shift[0] - self.turn * y + self.growth * x;
            let v = self.shift[1] + self.turn * x + self.growth * y;
            let residual = between(seen, edge.pixel[0] + u, edge.pixel[1] + v) - edge.local;
            let steep = f32::hypot(edge.slope[0], edge.slope[1]);
            let off = residual / (steep * TOLERANCE);
            agreeing += usize::from(off.abs() < 1.0);
            let weight = geman_mcclure(f64::from(off / 1.5)) / f64::from(steep);
            let row = [dx, dy, (x * dy - y * dx) / LEVER, (x * dx + y * dy) / LEVER];
            sums.add(SVector::from(row), f64::from(residual), weight);
        }
        (sums, agreeing as f64 / edges.len() as f64)
    }
}

/// A pixel at an edge of the empty picture.
struct Edge {
    pixel: [f64; 2],
    from_centre: [f64; 2],
    slope: [f32; 2],
    local: f32,
}

/// The pixels of a picture where its brightness changes steeply.
fn edges(picture: &Raster<f32>) -> Vec<Edge> {
    let (width, height) = (picture.width(), picture.height());
    let at = |x: usize, y: usize| picture.cells()[y * width + x];
    let slope = |x: usize, y: usize| {
        let across = |y: usize| at(x + 1, y) - at(x - 1, y);
        let down = |x: usize| at(x, y + 1) - at(x, y - 1);
        [
            (across(y - 1) + 2.0 * across(y) + across(y + 1)) / 8.0,
            (down(x - 1) + 2.0 * down(x) + down(x + 1)) / 8.0,
        ]
    };
    let rim = AROUND + 2;
    let places: Vec<(usize, usize)> = (rim..height.saturating_sub(rim))
        .flat_map(|y| (rim..width.saturating_sub(rim)).map(move |x| (x, y)))
        .collect();
    let mut steepness: Vec<f32> =
        places.iter().map(|&(x, y)| slope(x, y)).map(|[dx, dy]| f32::hypot(dx, dy)).collect();
    let all = steepness.clone();
    let high = steepness.len() * 99 / 100;
    if high >= steepness.len() {
        return Vec::new();
    }
    let steepest = *steepness.select_nth_unstable_by(high, f32::total_cmp).1;
    let least = LEAST_SLOPE.max(STEEP_SHARE * steepest);
    let steep: Vec<(usize, usize)> =
        places.into_iter().zip(all).filter(|(_, slope)| *slope > least).map(|(at, _)| at).collect();
    let locals = local(picture);
    let centre = [width, height].map(|length| (length as f64 - 1.0) / 2.0);
    let edge = |&(x, y): &(usize, usize)| Edge {
        pixel: [x as f64, y as f64],
        from_centre: [x as f64 - centre[0], y as f64 - centre[1]],
        slope: slope(x, y),
        local: locals.cells()[y * width + x],
    };
    let every = steep.len().div_ceil(MOST_EDGES).max(1);
    // Both sides of an edge count alike only in whole blocks.
    let is_kept = |&&(x, y): &&(usize, usize)| (x / BLOCK + y / BLOCK).is_multiple_of(every);
    steep.iter().filter(is_kept).map(edge).collect()
}

/// How much lighter a photo is than the empty picture, in the median of its pixels.
fn gain(photo: &Photo, empty: &Photo) -> f32 {
    let (lights, before) = (lights(photo), lights(empty));
    let mut ratios: Vec<f32> = lights.zip(before).map(|(p, e)| (p + DARK) / (e + DARK)).collect();
    median(&mut ratios).max(f32::MIN_POSITIVE)
}

/// The brightness of every pixel in linear light.
fn lights(photo: &Photo) -> impl Iterator<Item = f32> {
    let of_code = photo.code_lights();
    photo
        .pixels()
        .iter()
        .map(|pixel| pixel.iter().map(|&code| of_code[usize::from(code)]).sum::<f32>() / 3.0)
}

/// The logarithms of a photo's brightness in light that is `gain` times as strong as usual: dark places get
/// as much contrast as they have in usual light.
fn logs(photo: &Photo, gain: f32) -> Raster<f32> {
    let cells = lights(photo).map(|light| (light / gain + DARK).ln());
    Raster::from_cells(photo.width(), cells.collect())
}

/// A picture at half its size.
fn halved(picture: &Raster<f32>) -> Raster<f32> {
    let width = picture.width();
    let at = |x: usize, y: usize| picture.cells()[y * width + x];
    Raster::from_fn(width / 2, picture.height() / 2, |x, y| {
        let (x, y) = (2 * x, 2 * y);
        (at(x, y) + at(x + 1, y) + at(x, y + 1) + at(x + 1, y + 1)) / 4.0
    })
}

/// A picture less its mean around each pixel.
fn local(picture: &Raster<f32>) -> Raster<f32> {
    let along = mean_along_rows(picture);
    let means = transposed(&mean_along_rows(&transposed(&along)));
    let mut result = picture.clone();
    result.cells_mut().iter_mut().zip(means.cells()).for_each(|(value, mean)| *value -= mean);
    result
}

fn mean_along_rows(picture: &Raster<f32>) -> Raster<f32> {
    let mut cells = Vec::with_capacity(picture.cells().len());
    for row in picture.cells().chunks_exact(picture.width()) {
        let mut sum: f32 = row.iter().take(AROUND).sum();
        let mut count = AROUND.min(row.len());
        for x in 0..row.len() {
            if let Some(entering) = row.get(x + AROUND) {
                sum += entering;
                count += 1;
            }
            if let Some(leaving) = x.checked_sub(AROUND + 1) {
                sum -= row[leaving];
                count -= 1;
            }
            cells.push(sum / count as f32);
        }
    }
    Raster::from_cells(picture.width(), cells)
}

fn transposed(picture: &Raster<f32>) -> Raster<f32> {
    let width = picture.width();
    Raster::from_fn(picture.height(), width, |x, y| picture.cells()[x * width + y])
}

/// The value between four pixels; beyond the rim that of the rim.
fn between(picture: &Raster<f32>, x: f64, y: f64) -> f32 {
    let (width, height) = (picture.width(), picture.height());
    let x = x.clamp(0.0, width as f64 - 1.001);
    let y = y.clamp(0.0, height as f64 - 1.001);
    let (left, upper) = (x as usize, y as usize);
    let (right, down) = ((x - left as f64) as f32, (y - upper as f64) as f32);
    let at = |x: usize, y: usize| picture.cells()[y * width + x];
    let row = |y: usize| at(left, y) + right * (at(left + 1, y) - at(left, y));
    row(upper) + down * (row(upper + 1) - row(upper))
}
