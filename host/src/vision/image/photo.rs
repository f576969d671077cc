//! The photo: decoding PNG and JPEG within bounded memory, and reading it in linear light.
//!
//! Pixels are sRGB; everything that measures light (edges to a fraction of a pixel, the floor's
//! colour) asks for linear light, because blur mixes light and not sRGB codes: edges located in sRGB
//! are biased towards the dark side by a quarter of a pixel.

/// Bits behind the point of a place: 1/2048 pixel.
pub(crate) const FRACTION: u32 = 11;

/// A place in the photo: column and row in fixed-point pixels, left of the last column and above the last row.
pub(crate) type Place = [u32; 2];

use crate::vision::error::VisionError;
use image::{DynamicImage, ImageDecoder, ImageReader, Limits};
use std::borrow::Cow;
use std::io::Cursor;

/// The greatest number of pixels that is decoded: 40 million.
pub const MAX_PIXELS: u64 = 40_000_000;
/// Below this width or height no arena can be found.
const LEAST_SIDE: usize = 64;
/// Faults and the border's lines are sought in a photo reduced to at most so many pixels a side.
const OVERVIEW_SIDE: usize = 700;
/// Decoders may hold one copy at 16 bit and four channels, and tables.
const DECODER_BYTES_PER_PIXEL: u64 = 8;
const DECODER_TABLES: u64 = 16 << 20;

/// A decoded photo, upright.
#[derive(Clone, Debug, PartialEq)]
pub struct Photo {
    width: usize,
    height: usize,
    pixels: Vec<[u8; 3]>,
    linear: Box<[f32; 256]>,
}

/// Decodes a PNG or JPEG file and turns it upright as its EXIF orientation says.
///
/// # Errors
/// [`VisionError::Decode`] for broken or other files, [`VisionError::TooLarge`] above [`MAX_PIXELS`],
/// [`VisionError::TooSmall`] below 64 pixels in either direction.
///
/// ```
/// assert!(wmr::vision::decode(b"no picture").is_err());
/// ```
pub fn decode(bytes: &[u8]) -> Result<Photo, VisionError> {
    let failed = |error: &dyn std::fmt::Display| VisionError::Decode { reason: error.to_string() };
    if is_cut_jpeg(bytes) {
        return Err(failed(&"the JPEG ends in the middle of the picture"));
    }
    let reader = ImageReader::new(Cursor::new(bytes))
        .with_guessed_format()
        .map_err(|error| failed(&error))?;
    let mut decoder = reader.into_decoder().map_err(|error| failed(&error))?;
    let (width, height) = decoder.dimensions();
    let count = u64::from(width) * u64::from(height);
    if count > MAX_PIXELS {
        return Err(VisionError::TooLarge { width, height, limit: MAX_PIXELS });
    }
    let mut limits = Limits::no_limits();
    limits.max_alloc = Some(count * DECODER_BYTES_PER_PIXEL + DECODER_TABLES);
    decoder.set_limits(limits).map_err(|error| failed(&error))?;
    let orientation = decoder.orientation().map_err(|error| failed(&error))?;
    let mut picture = DynamicImage::from_decoder(decoder).map_err(|error| failed(&error))?;
    picture.apply_orientation(orientation);
    let picture = picture.into_rgb8();
    let (width, height) = (picture.width() as usize, picture.height() as usize);
    let pixels = picture.as_raw().as_chunks::<3>().0.to_vec();
    Photo::from_rgb(width, height, pixels)
}

/// Whether the bytes are a JPEG without its end: decoders fill what is missing with grey, which looks like
/// floor or like a box.
///
/// A marker's two bytes never occur in a picture's data, so after the first scan begins the first marker of
/// the end is the end.
fn is_cut_jpeg(bytes: &[u8]) -> bool {
    const START: [u8; 2] = [0xff, 0xd8];
    const END: [u8; 2] = [0xff, 0xd9];
    const SCAN: u8 = 0xda;
    const FILL: u8 = 0xff;
    if !bytes.starts_with(&START) {
        return false;
    }
    let mut at = START.len();
    // Segments with their lengths, among them a small picture with an end of its own.
    while let Some(&[0xff, kind, high, low]) = bytes.get(at..at + 4) {
        if kind == SCAN {
            break;
        }
        if kind == FILL {
            at += 1;
            continue;
        }
        at += 2 + usize::from(u16::from_be_bytes([high, low]));
    }
    !bytes.get(at..).unwrap_or_default().windows(END.len()).any(|pair| pair == END)
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

    /// By what a photo is reduced for what needs no more than about 700 pixels a side.
    pub(crate) fn overview_factor(&self) -> usize {
        self.width.max(self.height).div_ceil(OVERVIEW_SIDE).max(1)
    }

    /// Whether a place in pixels is inside the picture.
    pub(crate) fn holds(&self, [x, y]: [f64; 2]) -> bool {
        x >= -0.5 && y >= -0.5 && x <= self.width as f64 - 0.5 && y <= self.height as f64 - 0.5
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

    fn png(width: u32, height: u32) -> Vec<u8> {
        let mut bytes = Cursor::new(Vec::new());
        let picture =
            image::GrayImage::from_fn(width, height, |x, _| image::Luma([(x % 256) as u8]));
        picture.write_to(&mut bytes, image::ImageFormat::Png).unwrap();
        bytes.into_inner()
    }

    #[test]
    fn light_between_two_pixels_is_the_mean_of_their_light() {
        let photo = decode(&png(128, 64)).unwrap();
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
    fn cut_and_foreign_files_are_refused() {
        let whole = png(200, 100);
        for length in [0, 10, whole.len() / 2, whole.len() - 20] {
            assert!(
                matches!(decode(&whole[..length]), Err(VisionError::Decode { .. })),
                "{length} bytes"
            );
        }
        assert!(matches!(decode(&png(20, 300)), Err(VisionError::TooSmall { .. })));
    }

    #[test]
    fn a_huge_picture_is_refused_before_it_is_decoded() {
        let mut bytes = png(64, 64);
        bytes[16..24].copy_from_slice(&[0, 1, 0, 0, 0, 1, 0, 0]);
        assert!(decode(&bytes).is_err());
    }

    /// A JPEG of a picture that is bright above and dark below, with an EXIF orientation.
    fn oriented(orientation: u8) -> Vec<u8> {
        let picture =
            image::GrayImage::from_fn(128, 80, |_, y| image::Luma([if y < 40 { 220 } else { 30 }]));
        let mut bytes = Cursor::new(Vec::new());
        picture.write_to(&mut bytes, image::ImageFormat::Jpeg).unwrap();
        let bytes = bytes.into_inner();
        // An APP1 segment with one entry, 0x0112: a short, the orientation.
        let mut exif =
            b"\xff\xe1\0\x22Exif\0\0MM\0\x2a\0\0\0\x08\0\x01\x01\x12\0\x03\0\0\0\x01\0".to_vec();
        exif.extend([orientation, 0, 0, 0, 0, 0, 0]);
        [&bytes[..2], &exif, &bytes[2..]].concat()
    }

    #[test]
    fn photos_are_turned_upright_as_exif_says() {
        let bright = |photo: &Photo, x: f64, y: f64| photo.light([x, y])[0] > 0.4;
        let plain = decode(&oriented(1)).unwrap();
        assert!((plain.width(), plain.height()) == (128, 80) && bright(&plain, 60.0, 5.0));
        let upside_down = decode(&oriented(3)).unwrap();
        assert!(bright(&upside_down, 60.0, 75.0) && !bright(&upside_down, 60.0, 5.0));
        // 6: turn by 90° clockwise; what was above is at the right.
        let turned = decode(&oriented(6)).unwrap();
        assert_eq!((turned.width(), turned.height()), (80, 128));
        assert!(bright(&turned, 75.0, 60.0) && !bright(&turned, 5.0, 60.0));
    }

    #[test]
    fn more_than_forty_megapixels_are_refused_by_the_header_alone() {
        let mut bytes = png(64, 64);
        // 8000 × 5001 in the header; its checksum is made to fit.
        bytes[16..24].copy_from_slice(&[0, 0, 0x1f, 0x40, 0, 0, 0x13, 0x89]);
        let checksum = crc32(&bytes[12..29]);
        bytes[29..33].copy_from_slice(&checksum.to_be_bytes());
        assert_eq!(
            decode(&bytes),
            Err(VisionError::TooLarge { width: 8000, height: 5001, limit: MAX_PIXELS })
        );
    }

    /// The checksum of PNG's chunks (ISO 3309).
    fn crc32(bytes: &[u8]) -> u32 {
        !bytes.iter().fold(u32::MAX, |sum, &byte| {
            (0..8).fold(sum ^ u32::from(byte), |sum, _| {
                (sum >> 1) ^ (0xedb8_8320 & (sum & 1).wrapping_neg())
            })
        })
    }

    #[test]
    fn the_small_picture_holds_means() {
        let photo =
            Photo::from_rgb(64, 64, (0..4096).map(|i| [(i % 2 * 100) as u8; 3]).collect()).unwrap();
        assert!(photo.reduced(2).pixels().iter().all(|&pixel| pixel == [50; 3]));
    }
}
