//! The plan view's brightness alone, in 8 bit, as the paper's steps want it [Alghannam, Sec. II.A].
//!
//! Brightness mixes sRGB codes, as the paper does.

use super::frame::PlanFrame;
use super::sampling::Lattice;
use crate::geometry::Point;
use crate::vision::camera::PlanMap;
use crate::vision::image::{FRACTION, Photo, Place, Raster};

/// The most places along each side of a cell.
const MOST_PLACES: usize = 4;
/// With fewer places along each side of a cell brightness is interpolated between pixels.
const BILINEAR_BELOW: usize = 3;
/// The weights of red, green and blue (ITU-R BT.709) in 256ths.
const WEIGHTS: [u32; 3] = [54, 183, 19];

/// Draws the brightness of the plan view of a photo, sRGB codes.
///
/// Where the photo is at least twice as fine as the view a cell is the mean of several places, at most 4 × 4.
///
/// ```
/// use wmr::{geometry::Arena, vision::{Photo, PlanFrame, PlanMap, brightness_view}};
/// // 100 pixels a metre, the left half white.
/// let pixels = (0..100 * 100).map(|i| if i % 100 < 50 { [255; 3] } else { [0; 3] });
/// let photo = Photo::from_rgb(100, 100, pixels.collect())?;
/// let arena = Arena { width: 1.0, height: 1.0 };
/// let corners = [[-0.5, 99.5], [99.5, 99.5], [99.5, -0.5], [-0.5, -0.5]];
/// let map = PlanMap::from_corners(&photo, arena, corners, 0.0).unwrap();
/// let view = brightness_view(&photo, &map, &PlanFrame::new(arena, 10.0, 0.0));
/// assert_eq!(view.row(3), [255, 255, 255, 255, 255, 0, 0, 0, 0, 0]);
/// # Ok::<(), wmr::vision::VisionError>(())
/// ```
pub fn brightness_view(photo: &Photo, map: &PlanMap, frame: &PlanFrame) -> Raster<u8> {
    let middle = Point::new(frame.arena.width / 2.0, frame.arena.height / 2.0);
    let places =
        (map.scale_at(middle) / frame.scale).floor().clamp(1.0, MOST_PLACES as f64) as usize;
    let (width, height) = frame.size();
    let fine = frame.finer(places);
    let mut sums = vec![0u32; width];
    let mut view = Raster::filled(width, height, 0u8);
    let mut lattice = Lattice::new(photo, map, fine, width * places);
    let count = (places * places) as u32;
    // The mean of many places is as smooth without interpolation at each of them.
    let grey = (places < BILINEAR_BELOW).then(|| brightness_of(photo));
    for (row, out) in view.cells_mut().chunks_exact_mut(width.max(1)).enumerate() {
        sums.fill(0);
        for line in row * places..(row + 1) * places {
            let line = lattice.line(line);
            match (&grey, places) {
                (Some(grey), 1) => add_line::<1>(line, &mut sums, |at| between_pixels(grey, at)),
                (Some(grey), _) => add_line::<2>(line, &mut sums, |at| between_pixels(grey, at)),
                (None, 3) => add_line::<3>(line, &mut sums, |at| luma(photo.pixel_near(at))),
                (None, _) => add_line::<4>(line, &mut sums, |at| luma(photo.pixel_near(at))),
            }
        }
        for (cell, sum) in out.iter_mut().zip(&sums) {
            *cell = ((sum + count / 2) / count) as u8;
        }
    }
    view
}

/// Adds the brightness along a line of places, `EACH` of them to every cell.
fn add_line<const EACH: usize>(
    line: &[Place],
    sums: &mut [u32],
    brightness: impl Fn(Place) -> u32,
) {
    for (sum, places) in sums.iter_mut().zip(line.as_chunks::<EACH>().0) {
        *sum += places.iter().map(|&place| brightness(place)).sum::<u32>();
    }
}

/// The brightness of every pixel, sRGB codes.
fn brightness_of(photo: &Photo) -> Raster<u8> {
    Raster::from_cells(
        photo.width(),
        photo.pixels().iter().map(|&pixel| luma(pixel) as u8).collect(),
    )
}

/// The brightness between four pixels.
#[inline]
fn between_pixels(grey: &Raster<u8>, [x, y]: Place) -> u32 {
    let part = |value: u32| (value >> (FRACTION - 8)) & 255;
    let (right, down) = (part(x), part(y));
    let first = (y >> FRACTION) as usize * grey.width() + (x >> FRACTION) as usize;
    let pair = |start: usize| match grey.cells().get(start..start + 2) {
        Some(&[a, b]) => (256 - right) * u32::from(a) + right * u32::from(b),
        _ => 0,
    };
    ((256 - down) * pair(first) + down * pair(first + grey.width()) + (1 << 15)) >> 16
}

/// The brightness of a pixel, rounded.
#[inline]
fn luma([r, g, b]: [u8; 3]) -> u32 {
    (WEIGHTS[0] * u32::from(r) + WEIGHTS[1] * u32::from(g) + WEIGHTS[2] * u32::from(b) + 128) >> 8
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
            let frame = PlanFrame::new(arena, scale, 0.05);
            let view = brightness_view(&photo, &map, &frame);
            let exact = super::super::view::plan_view(&photo, &map, &frame);
            for (&code, light) in view.cells().iter().zip(exact.cells()) {
                let expected = i32::from(srgb_code(light[0]));
                assert!((i32::from(code) - expected).abs() <= CODE_TOLERANCE, "{code} {expected}");
            }
        }
    }
}
