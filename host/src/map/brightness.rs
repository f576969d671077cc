//! The picture of a ROS map: how bright each cell is, or that it is transparent.
//!
//! Every format that the `image` crate decodes: PNM, PNG, BMP, TIFF, JPEG. A pixel's brightness is the
//! mean of its colour channels, 0 black to 1 white, as in ROS.

use super::MapError;
use image::{DynamicImage, ImageFormat};

/// A decoded map picture, row by row from the top left.
pub(super) struct Brightness {
    pub(super) columns: usize,
    pub(super) rows: usize,
    /// 0 black to 1 white; `None` where the picture is not opaque.
    pub(super) cells: Vec<Option<f32>>,
}

/// More cells than this are a fault of the file's head, not a map.
const CELL_LIMIT: usize = 1 << 28;
/// The largest sample of the 16-bit pixels that every picture is widened to.
const WHITE: f32 = 65535.0;
/// An 8-bit sample becomes a 16-bit one by this factor.
const WIDENED: f32 = 257.0;

impl Brightness {
    /// Decodes the bytes of a picture file.
    pub(super) fn decode(bytes: &[u8]) -> Result<Self, MapError> {
        let failed = |error: image::ImageError| MapError::Picture(error.to_string());
        if let [b'P', b'1'..=b'6', ..] = bytes {
            let pnm = with_plain_head(bytes)?;
            let picture = image::load_from_memory_with_format(&pnm, ImageFormat::Pnm);
            return Ok(Self::of(&picture.map_err(failed)?));
        }
        Ok(Self::of(&image::load_from_memory(bytes).map_err(failed)?))
    }

    fn of(picture: &DynamicImage) -> Self {
        let (columns, rows) = (picture.width() as usize, picture.height() as usize);
        let scaled = |sum: f32, channels: f32| Some(sum / channels / WHITE);
        let cells = match picture {
            DynamicImage::ImageLuma8(grey) => {
                grey.iter().map(|&value| scaled(f32::from(value) * WIDENED, 1.0)).collect()
            }
            other => other
                .to_rgba16()
                .pixels()
                .map(|pixel| {
                    let [red, green, blue, alpha] = pixel.0.map(f32::from);
                    if alpha < WHITE { None } else { scaled(red + green + blue, 3.0) }
                })
                .collect(),
        };
        Self { columns, rows, cells }
    }
}

/// A PNM file with its head written in the one form that decoders agree on.
///
/// The `image` crate takes exactly one character after the head for its end. A comment there, or the
/// two characters of a Windows line end, would shift all cells.
fn with_plain_head(file: &[u8]) -> Result<Vec<u8>, MapError> {
    let kind = file[1];
    let (plain, bitmap) = (kind <= b'3', matches!(kind, b'1' | b'4'));
    let mut rest = &file[2..];
    let mut head_number = || next_number(&mut rest).ok_or(MapError::Missing("PNM head"));
    let (columns, rows) = (head_number()?, head_number()?);
    let white = if bitmap { 1 } else { head_number()? };
    if !(1..=65535).contains(&white) {
        return Err(MapError::Picture(format!("white is {white}, not 1 to 65535")));
    }
    let cells = columns.checked_mul(rows).filter(|cells| (1..=CELL_LIMIT).contains(cells));
    let cells = cells.ok_or_else(|| MapError::Picture(format!("{columns} × {rows} pixels")))?;
    let channels = if matches!(kind, b'3' | b'6') { 3 } else { 1 };
    let sample_bytes = if white > 255 { 2 } else { 1 };
    let mut bytes = format!("P{}\n{columns} {rows}\n", char::from(kind)).into_bytes();
    if !bitmap {
        bytes.extend(format!("{white}\n").into_bytes());
    }
    if plain {
        bytes.extend(without_comments(rest));
    } else {
        let row = if bitmap { columns.div_ceil(8) } else { columns * channels * sample_bytes };
        let samples = raster(rest, row * rows);
        if samples.len() < row * rows {
            let found = samples.len() * cells / (row * rows);
            return Err(MapError::Cut { expected: cells, found });
        }
        bytes.extend(samples);
    }
    Ok(bytes)
}

/// The samples after the head of a binary PNM, of which there are to be `length` bytes. What stands
/// between is one white space, a Windows line end or a comment; the latter two are taken for that only
/// if enough bytes remain.
fn raster(rest: &[u8], length: usize) -> &[u8] {
    let after_comment = || {
        let blank = rest.iter().take_while(|byte| matches!(byte, b' ' | b'\t')).count();
        let comment = rest[blank..].strip_prefix(b"#")?;
        let end = comment.iter().position(|&byte| byte == b'\n')?;
        Some(&comment[end + 1..])
    };
    let candidate = after_comment().or_else(|| rest.strip_prefix(b"\r\n"));
    candidate
        .filter(|samples| samples.len() >= length)
        .or_else(|| rest.get(1..))
        .unwrap_or_default()
}

/// Text without what stands between `#` and the end of the line.
fn without_comments(text: &[u8]) -> Vec<u8> {
    let lines = text.split_inclusive(|&byte| byte == b'\n');
    lines
        .flat_map(|line| {
            line.iter().copied().take_while(|&byte| byte != b'#').chain(std::iter::once(b'\n'))
        })
        .collect()
}

/// The next number of a PNM head, after white space and comments.
fn next_number(rest: &mut &[u8]) -> Option<usize> {
    loop {
        *rest = rest.trim_ascii_start();
        if rest.first() != Some(&b'#') {
            break;
        }
        let line = rest.iter().take_while(|&&byte| byte != b'\n').count();
        *rest = &rest[line..];
    }
    let digits = rest.iter().take_while(|byte| byte.is_ascii_digit()).count();
    let (number, after) = rest.split_at(digits);
    *rest = after;
    std::str::from_utf8(number).ok()?.parse().ok()
}

#[cfg(test)]
mod tests {
    use super::*;
    use image::{Luma, LumaA, Rgb, Rgba};
    use std::io::Cursor;

    /// Brightness of 255ths, rounded; -1 for transparent.
    fn levels(bytes: &[u8]) -> Vec<i32> {
        let picture = Brightness::decode(bytes).unwrap();
        let level = |cell: &Option<f32>| cell.map_or(-1, |b| (b * 255.0).round() as i32);
        picture.cells.iter().map(level).collect()
    }

    fn encoded(picture: impl Into<DynamicImage>, format: ImageFormat) -> Vec<u8> {
        let mut bytes = Cursor::new(Vec::new());
        picture.into().write_to(&mut bytes, format).unwrap();
        bytes.into_inner()
    }

    #[test]
    fn all_six_kinds_of_pnm_give_the_same_cells() {
        for file in [
            b"P1\n2 2\n0 1\n1 0\n".as_slice(),
            b"P2\n2 2\n255\n255 0\n0 255\n",
            b"P3 2 2 255 255 255 255 0 0 0 0 0 0 255 255 255",
            b"P4 2 2\n\x40\x80",
            b"P5 2 2 255\n\xff\x00\x00\xff",
            b"P6 2 2 255\n\xff\xff\xff\x00\x00\x00\x00\x00\x00\xff\xff\xff",
            b"P5 2 2 65535\n\xff\xff\x00\x00\x00\x00\xff\xff",
        ] {
            assert_eq!(levels(file), [255, 0, 0, 255], "{}", String::from_utf8_lossy(file));
        }
    }

    #[test]
    fn samples_count_against_the_white_of_the_head() {
        assert_eq!(levels(b"P5 3 1 100\n\x64\x32\x00"), [255, 128, 0]);
        assert_eq!(levels(b"P2 3 1 100 100 50 0"), [255, 128, 0]);
        assert_eq!(levels(b"P5 2 1 1000\n\x03\xe8\x01\xf4"), [255, 128]);
    }

    #[test]
    fn comments_and_windows_line_ends_in_the_head_shift_nothing() {
        for file in [
            b"P5\r\n2 1\r\n255\r\n\xff\x00".as_slice(),
            b"P5\n2 1\n255 # grey\n\xff\x00",
            b"P5\n2 1\n255#\n\xff\x00",
            b"P5\n# made\n2 # wide\n1\n# white:\n255\n\xff\x00",
            b"P2\n2 1 # size\n255 # grey\n255 # free\n0\n",
        ] {
            assert_eq!(levels(file), [255, 0], "{}", String::from_utf8_lossy(file));
        }
    }

    #[test]
    fn samples_that_look_like_a_line_end_or_a_comment_are_samples() {
        assert_eq!(levels(b"P5 2 1 255\r\n\x07"), [10, 7]);
        assert_eq!(levels(b"P5 2 1 255\n#\n"), [35, 10]);
    }

    #[test]
    fn other_formats_give_the_mean_of_the_channels() {
        let yellow = image::RgbImage::from_pixel(1, 1, Rgb([255, 255, 0]));
        for format in [ImageFormat::Png, ImageFormat::Bmp, ImageFormat::Tiff] {
            assert_eq!(levels(&encoded(yellow.clone(), format)), [170], "{format:?}");
        }
        let grey = image::GrayImage::from_pixel(8, 8, Luma([254]));
        assert_eq!(levels(&encoded(grey, ImageFormat::Jpeg)), [254; 64]);
        let deep = image::ImageBuffer::from_pixel(1, 1, Luma([0x8080_u16]));
        assert_eq!(levels(&encoded(deep, ImageFormat::Png)), [128]);
    }

    #[test]
    fn a_cell_that_is_not_opaque_has_no_brightness() {
        let mut picture = image::RgbaImage::from_pixel(2, 1, Rgba([255, 255, 255, 0]));
        picture.put_pixel(1, 0, Rgba([205, 205, 205, 255]));
        assert_eq!(levels(&encoded(picture, ImageFormat::Png)), [-1, 205]);
        let grey = image::GrayAlphaImage::from_pixel(1, 1, LumaA([255, 254]));
        assert_eq!(levels(&encoded(grey, ImageFormat::Png)), [-1]);
    }

    #[test]
    fn broken_pictures_are_refused_with_a_reason() {
        let refused = |bytes: &[u8]| Brightness::decode(bytes).err();
        assert_eq!(refused(b"P5 2 2 255\n\xff"), Some(MapError::Cut { expected: 4, found: 1 }));
        assert!(matches!(refused(b"text"), Some(MapError::Picture(_))));
        assert!(matches!(refused(b"P2 2 2 255 1 2 3"), Some(MapError::Picture(_))));
        assert!(matches!(refused(b"P5 1 1 70000\n\xff"), Some(MapError::Picture(_))));
        assert!(matches!(refused(b"P5 999999999 999999999 255\n"), Some(MapError::Picture(_))));
        assert_eq!(refused(b"P5 2"), Some(MapError::Missing("PNM head")));
    }
}
