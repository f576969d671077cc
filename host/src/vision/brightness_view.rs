//! The plan view's brightness alone, in 8 bit, as the paper's steps want it [Alghannam, Sec. II.A].
//!
//! The map from floor to photo is evaluated at every sixteenth cell and taken as linear in between: over
//! a few centimetres of floor homography and lens bend by hundredths of a pixel. Places in the photo
//! are fixed-point numbers with 16 bits behind the point. Brightness mixes sRGB codes, as the paper does.

use super::photo::Photo;
use super::plan_map::PlanMap;
use super::plan_view::PlanFrame;
use super::raster::Raster;
use crate::geometry::Point;

/// Cells between exact places.
const STEP: usize = 16;
/// One pixel, fixed-point.
const ONE: i32 = 1 << 16;
/// The weights of red, green and blue (ITU-R BT.709) in 256ths.
const WEIGHTS: [u32; 3] = [54, 183, 19];

/// Draws the brightness of the plan view of a photo, sRGB codes.
///
/// Where the photo is at least twice as fine as the view a cell is the mean of several places, at most 4 × 4.
///
/// ```
/// use host::{geometry::Arena, vision::{Photo, PlanFrame, PlanMap, brightness_view}};
/// // 100 pixels a metre, the left half white.
/// let pixels = (0..100 * 100).map(|i| if i % 100 < 50 { [255; 3] } else { [0; 3] });
/// let photo = Photo::from_rgb(100, 100, pixels.collect())?;
/// let arena = Arena { width: 1.0, height: 1.0 };
/// let corners = [[-0.5, 99.5], [99.5, 99.5], [99.5, -0.5], [-0.5, -0.5]];
/// let map = PlanMap::from_corners(&photo, arena, corners, 0.0).unwrap();
/// let view = brightness_view(&photo, &map, &PlanFrame { arena, scale: 10.0, margin: 0.0 });
/// assert_eq!(view.row(3), [255, 255, 255, 255, 255, 0, 0, 0, 0, 0]);
/// # Ok::<(), host::vision::VisionError>(())
/// ```
pub fn brightness_view(photo: &Photo, map: &PlanMap, frame: &PlanFrame) -> Raster<u8> {
    let middle = Point::new(frame.arena.width / 2.0, frame.arena.height / 2.0);
    let places = (map.scale_at(middle) / frame.scale).floor().clamp(1.0, 4.0) as usize;
    let (width, height) = frame.size();
    let fine = PlanFrame { scale: frame.scale * places as f64, ..*frame };
    let mut sums = vec![0u32; width];
    let mut view = Raster::filled(width, height, 0u8);
    let mut lines = Lines::new(photo, map, fine, width * places);
    let count = (places * places) as u32;
    for (row, out) in view.cells_mut().chunks_exact_mut(width.max(1)).enumerate() {
        sums.fill(0);
        for line in row * places..(row + 1) * places {
            let (start, end) = lines.around(line);
            add_line(photo, start, end, line % STEP, places, &mut sums);
        }
        for (cell, sum) in out.iter_mut().zip(&sums) {
            *cell = ((sum + count / 2) / count) as u8;
        }
    }
    view
}

/// A place in the photo, fixed-point.
type Place = [i32; 2];

/// The exact places of the two lines of cells around the one that is drawn.
struct Lines<'a> {
    photo: &'a Photo,
    map: &'a PlanMap,
    fine: PlanFrame,
    columns: usize,
    first: usize,
    places: [Vec<Place>; 2],
}

impl<'a> Lines<'a> {
    fn new(photo: &'a Photo, map: &'a PlanMap, fine: PlanFrame, columns: usize) -> Self {
        let mut lines = Self { photo, map, fine, columns, first: 0, places: Default::default() };
        lines.places = [lines.exact(0), lines.exact(STEP)];
        lines
    }

    /// The places of every sixteenth cell of the exact lines above and below `line`.
    fn around(&mut self, line: usize) -> (&[Place], &[Place]) {
        let first = line / STEP * STEP;
        if first != self.first {
            self.places.swap(0, 1);
            self.places[1] = self.exact(first + STEP);
            self.first = first;
        }
        (&self.places[0], &self.places[1])
    }

    fn exact(&self, line: usize) -> Vec<Place> {
        let most = |length: usize| (length - 1) as f64 - 1e-3;
        let fixed =
            |value: f64, length: usize| (value.clamp(0.0, most(length)) * f64::from(ONE)) as i32;
        (0..=self.columns.div_ceil(STEP))
            .map(|index| {
                let point = self.fine.point((index * STEP) as f64, line as f64);
                let [x, y] = self.map.to_photo(point);
                [fixed(x, self.photo.width()), fixed(y, self.photo.height())]
            })
            .collect()
    }
}

/// Adds the brightness along one line of fine cells, `places` of them to every cell of `sums`.
fn add_line(
    photo: &Photo,
    above: &[Place],
    below: &[Place],
    within: usize,
    places: usize,
    sums: &mut [u32],
) {
    let mix = |index: usize| {
        let part = |axis: usize| {
            let (a, b) = (i64::from(above[index][axis]), i64::from(below[index][axis]));
            (a + (b - a) * within as i64 / STEP as i64) as i32
        };
        [part(0), part(1)]
    };
    let mut column = 0;
    let total = sums.len() * places;
    for index in 0..above.len().saturating_sub(1) {
        let ([mut x, mut y], [end_x, end_y]) = (mix(index), mix(index + 1));
        let (dx, dy) = ((end_x - x) / STEP as i32, (end_y - y) / STEP as i32);
        for _ in 0..STEP.min(total - column) {
            sums[column / places] += brightness_at(photo, x, y);
            column += 1;
            x += dx;
            y += dy;
        }
    }
}

/// The brightness between four pixels.
#[inline]
fn brightness_at(photo: &Photo, x: i32, y: i32) -> u32 {
    let (left, top) = ((x >> 16) as usize, (y >> 16) as usize);
    let (right, down) = ((x >> 8 & 255) as u32, (y >> 8 & 255) as u32);
    let first = top * photo.width() + left;
    let pair = |start: usize| match photo.pixels().get(start..start + 2) {
        Some([a, b]) => (256 - right) * luma(*a) + right * luma(*b),
        _ => 0,
    };
    ((256 - down) * (pair(first) >> 8) + down * (pair(first + photo.width()) >> 8) + (1 << 15))
        >> 16
}

/// The brightness of a pixel in 256ths.
#[inline]
fn luma(pixel: [u8; 3]) -> u32 {
    (0..3).map(|channel| WEIGHTS[channel] * u32::from(pixel[channel])).sum()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::Arena;
    use crate::vision::srgb_code;

    /// Linear light and sRGB codes mix differently: on a smooth picture by less than this.
    const CODE_TOLERANCE: i32 = 3;

    #[test]
    fn it_is_the_plan_views_brightness_through_tilt_and_lens() {
        let shade = |x: usize, y: usize| (60.0 + 0.2 * x as f64 + 0.15 * y as f64) as u8;
        let pixels = (0..400 * 300).map(|i| [shade(i % 400, i / 400); 3]);
        let photo = Photo::from_rgb(400, 300, pixels.collect()).unwrap();
        let arena = Arena { width: 1.3, height: 1.1 };
        let corners = [[40.0, 280.0], [380.0, 260.0], [350.0, 30.0], [60.0, 20.0]];
        let map = PlanMap::from_corners(&photo, arena, corners, -0.05).unwrap();
        for scale in [90.0, 300.0] {
            let frame = PlanFrame { arena, scale, margin: 0.05 };
            let view = brightness_view(&photo, &map, &frame);
            let exact = super::super::plan_view::plan_view(&photo, &map, &frame);
            for (&code, light) in view.cells().iter().zip(exact.cells()) {
                let expected = i32::from(srgb_code(light[0]));
                assert!((i32::from(code) - expected).abs() <= CODE_TOLERANCE, "{code} {expected}");
            }
        }
    }
}
