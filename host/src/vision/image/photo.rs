//! The photo, read in linear light.
//!
//! Pixels are sRGB; everything that measures light (edges to a fraction of a pixel, the floor's
//! colour) asks for linear light, because blur mixes light and not sRGB codes: edges located in sRGB
//! are biased towards the dark side by a quarter of a pixel.

use crate::vision::error::VisionError;
use std::borrow::Cow;

/// Bits behind the point of a place: 1/2048 pixel.
pub(crate) const FRACTION: u32 = 11;

/// A place in the photo: column and row in fixed-point pixels, left of the last column and above the last row.
pub(crate) type Place = [u32; 2];

/// Below this width or height no arena can be found.
const LEAST_SIDE: usize = 64;
/// Faults and the border's lines are searched for in a photo reduced to at most so many pixels a side.
const OVERVIEW_SIDE: usize = 700;

/// A decoded photo, upright.
#[derive(Clone, Debug, PartialEq)]
pub struct Photo {
    width: usize,
    height: usize,
    pixels: Vec<[u8; 3]>,
    linear: Box<[f32; 256]>,
}

impl Photo {
    /// A photo from sRGB pixels, row by row from the top left.
    ///
    /// # Errors
    /// [`VisionError::TooSmall`] below 64 pixels in either direction, [`VisionError::Decode`] if the
    /// number of pixels is not `width` × `height`.
    ///
    /// ```
    /// use wmr::vision::Photo;
    /// let grey = Photo::from_rgb(64, 64, vec![[128; 3]; 64 * 64])?;
    /// assert!((grey.light([10.0, 10.0])[0] - 0.2159).abs() < 1e-4);
    /// # Ok::<(), wmr::vision::VisionError>(())
    /// ```
    pub fn from_rgb(
        width: usize,
        height: usize,
        pixels: Vec<[u8; 3]>,
    ) -> Result<Self, VisionError> {
        if width < LEAST_SIDE || height < LEAST_SIDE {
            return Err(VisionError::TooSmall { width, height, least: LEAST_SIDE });
        }
        if pixels.len() != width * height {
            return Err(VisionError::Decode {
                reason: format!("{} pixels for {width} x {height}", pixels.len()),
            });
        }
        Ok(Self { width, height, pixels, linear: Box::new(std::array::from_fn(linear_light)) })
    }

    /// The same picture with other pixels, as many.
    pub(crate) fn with_pixels(&self, pixels: Vec<[u8; 3]>) -> Self {
        debug_assert_eq!(pixels.len(), self.pixels.len());
        Self { pixels, linear: self.linear.clone(), ..*self }
    }

    /// The part of the photo from a column and row up to others.
    pub(crate) fn part(&self, [left, top]: [usize; 2], [right, bottom]: [usize; 2]) -> Self {
        let (right, bottom) = (right.min(self.width), bottom.min(self.height));
        let (width, height) = (right.saturating_sub(left), bottom.saturating_sub(top));
        let rows = self.pixels.chunks_exact(self.width).skip(top).take(height);
        let pixels = rows.flat_map(|row| &row[right - width..right]).copied().collect();
        Self { width, height, pixels, linear: self.linear.clone() }
    }

    /// The linear light of every code.
    pub(crate) fn code_lights(&self) -> &[f32; 256] {
        &self.linear
    }

    /// Pixels in a row.
    pub fn width(&self) -> usize {
        self.width
    }

    /// Rows.
    pub fn height(&self) -> usize {
        self.height
    }

    /// The sRGB pixels, row by row from the top left.
    pub fn pixels(&self) -> &[[u8; 3]] {
        &self.pixels
    }

    /// The centre of the picture, pixels.
    pub(crate) fn centre(&self) -> [f64; 2] {
        [(self.width as f64 - 1.0) / 2.0, (self.height as f64 - 1.0) / 2.0]
    }

    /// The linear light (red, green, blue, 0 to 1) at a place in pixels, between four pixels by
    /// bilinear interpolation; beyond the picture's rim that of the rim.
    #[inline]
    pub fn light(&self, [x, y]: [f64; 2]) -> [f32; 3] {
        let x = x.clamp(0.0, (self.width - 1) as f64);
        let y = y.clamp(0.0, (self.height - 1) as f64);
        let (left, top) =
            ((x as u32 as usize).min(self.width - 2), (y as u32 as usize).min(self.height - 2));
        let (right, down) = ((x - left as f64) as f32, (y - top as f64) as f32);
        let first = top * self.width + left;
        let (upper, lower) =
            (&self.pixels[first..first + 2], &self.pixels[first + self.width..][..2]);
        let corners = [
            (upper[0], (1.0 - right) * (1.0 - down)),
            (upper[1], right * (1.0 - down)),
            (lower[0], (1.0 - right) * down),
            (lower[1], right * down),
        ];
        let mut light = [0.0; 3];
        for (codes, weight) in corners {
            for (sum, code) in light.iter_mut().zip(codes) {
                *sum += weight * self.linear[usize::from(code)];
            }
        }
        light
    }

    /// The same at a place of a [`crate::vision::plan_view::Lattice`] of this photo.
    #[inline]
    pub(crate) fn light_at(&self, [x, y]: Place) -> [f32; 3] {
        const ONE: f32 = (1 << FRACTION) as f32;
        let part = |value: u32| (value & ((1 << FRACTION) - 1)) as f32 / ONE;
        let (right, down) = (part(x), part(y));
        let first = (y >> FRACTION) as usize * self.width + (x >> FRACTION) as usize;
        let (upper, lower) =
            (&self.pixels[first..first + 2], &self.pixels[first + self.width..][..2]);
        std::array::from_fn(|channel| {
            let light = |pixel: &[u8; 3]| self.linear[usize::from(pixel[channel])];
            let above = light(&upper[0]) + right * (light(&upper[1]) - light(&upper[0]));
            let below = light(&lower[0]) + right * (light(&lower[1]) - light(&lower[0]));
            above + down * (below - above)
        })
    }

    /// The pixel nearest to a place of a [`crate::vision::plan_view::Lattice`] of this photo.
    #[inline]
    pub(crate) fn pixel_near(&self, [x, y]: Place) -> [u8; 3] {
        let nearest = |value: u32| ((value + (1 << (FRACTION - 1))) >> FRACTION) as usize;
        self.pixels[nearest(y) * self.width + nearest(x)]
    }

    /// The linear light of that pixel.
    #[inline]
    pub(crate) fn light_near(&self, place: Place) -> [f32; 3] {
        self.pixel_near(place).map(|code| self.linear[usize::from(code)])
    }

    /// The longer of its sides, pixels: the same for one camera held upright or turned.
    pub(crate) fn longer_side(&self) -> f64 {
        self.width.max(self.height) as f64
    }

    /// How much larger it is than those that lengths in pixels are stated for, see [`zoom`].
    pub(crate) fn zoom(&self) -> f64 {
        zoom(self.longer_side())
    }

    /// By what a photo is reduced for what needs no more than about 700 pixels a side.
    pub(crate) fn overview_factor(&self) -> usize {
        self.width.max(self.height).div_ceil(OVERVIEW_SIDE).max(1)
    }

    /// Whether a place in pixels is inside the picture.
    pub(crate) fn holds(&self, pixel: [f64; 2]) -> bool {
        self.holds_within(pixel, 0.0)
    }

    /// Whether it is inside the picture, or outside by no more than `slack` pixels.
    pub(crate) fn holds_within(&self, [x, y]: [f64; 2], slack: f64) -> bool {
        let least = -0.5 - slack;
        let (right, low) =
            (self.width as f64 + least.abs() - 1.0, self.height as f64 + least.abs() - 1.0);
        x >= least && y >= least && x <= right && y <= low
    }

    /// The photo at 1 / `factor` of its size, each pixel the mean of `factor`² sRGB pixels.
    ///
    /// The place (x, y) of the small picture is ((x + ½) `factor` − ½, …) of the large one.
    pub(crate) fn reduced(&self, factor: usize) -> Cow<'_, Self> {
        if factor == 1 {
            return Cow::Borrowed(self);
        }
        let (width, height) = (self.width / factor, self.height / factor);
        let area = (factor * factor) as u32;
        let mut pixels = Vec::with_capacity(width * height);
        let mut sums = vec![0u32; 3 * width * factor];
        for rows in self.pixels.chunks_exact(self.width * factor) {
            sums.fill(0);
            for row in rows.chunks_exact(self.width) {
                let codes = row.as_flattened().iter();
                sums.iter_mut().zip(codes).for_each(|(sum, &code)| *sum += u32::from(code));
            }
            pixels.extend(sums.chunks_exact(3 * factor).map(|group| {
                let mut sum = [area / 2; 3];
                for pixel in group.as_chunks::<3>().0 {
                    sum.iter_mut().zip(pixel).for_each(|(sum, value)| *sum += value);
                }
                sum.map(|value| (value / area) as u8)
            }));
        }
        Cow::Owned(Self { width, height, pixels, linear: self.linear.clone() })
    }
}

/// The linear light of an sRGB code (IEC 61966-2-1).
fn linear_light(code: usize) -> f32 {
    let value = code as f64 / 255.0;
    let light = if value <= 0.040_45 { value / 12.92 } else { ((value + 0.055) / 1.055).powf(2.4) };
    light as f32
}

/// How much larger a picture is than those that lengths in pixels are stated for, "at a longer side of 640".
pub(crate) fn zoom(longer_side: f64) -> f64 {
    (longer_side / 640.0).max(1.0)
}

/// The sRGB code (0 to 255) of a linear light between 0 and 1.
///
/// ```
/// assert_eq!(wmr::vision::srgb_code(0.2159), 128);
/// ```
pub fn srgb_code(light: f32) -> u8 {
    let light = f64::from(light).clamp(0.0, 1.0);
    let value =
        if light <= 0.003_130_8 { 12.92 * light } else { 1.055 * light.powf(1.0 / 2.4) - 0.055 };
    (255.0 * value).round() as u8
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn light_between_two_pixels_is_the_mean_of_their_light() {
        let codes = (0..128 * 64).map(|i| [(i % 128) as u8; 3]).collect();
        let photo = Photo::from_rgb(128, 64, codes).unwrap();
        let [between, ..] = photo.light([100.5, 3.0]);
        let expected = (linear_light(100) + linear_light(101)) / 2.0;
        assert!((between - expected).abs() < 1e-6);
    }

    #[test]
    fn every_code_survives_the_way_to_light_and_back() {
        for code in 0..=255 {
            assert_eq!(usize::from(srgb_code(linear_light(code))), code);
        }
    }

    #[test]
    fn the_small_picture_holds_means() {
        let photo =
            Photo::from_rgb(64, 64, (0..4096).map(|i| [(i % 2 * 100) as u8; 3]).collect()).unwrap();
        assert!(photo.reduced(2).pixels().iter().all(|&pixel| pixel == [50; 3]));
    }
}
