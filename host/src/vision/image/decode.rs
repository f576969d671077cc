//! From the bytes of a picture file to a photo, upright and within bounded memory.

use super::photo::Photo;
use crate::vision::error::VisionError;
use image::{DynamicImage, ImageDecoder, ImageReader, Limits, Rgb, RgbImage};
use std::io::Cursor;

/// The greatest number of pixels that is decoded: 40 million.
pub const MAX_PIXELS: u64 = 40_000_000;
/// Decoders may hold one copy at 16 bit and four channels, and tables.
const DECODER_BYTES_PER_PIXEL: u64 = 8;
const DECODER_TABLES: u64 = 16 << 20;

/// Decodes a PNG, JPEG, WebP, BMP, TIFF, GIF or PNM file and turns it upright as its EXIF orientation says.
///
/// Of an animation the first picture is taken; what is transparent lies on white.
///
/// # Errors
/// [`VisionError::Decode`] for broken or other files, [`VisionError::Format`] for those that phones write and nobody
/// reads, [`VisionError::TooLarge`] above [`MAX_PIXELS`],
/// [`VisionError::TooSmall`] below 64 pixels in either direction.
///
/// ```
/// assert!(wmr::vision::decode(b"no picture").is_err());
/// ```
pub fn decode(bytes: &[u8]) -> Result<Photo, VisionError> {
    let failed = |error: &dyn std::fmt::Display| VisionError::Decode { reason: error.to_string() };
    if let Some(format) = foreign_format(bytes) {
        return Err(VisionError::Format { format });
    }
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
    let picture = on_white(picture);
    let (width, height) = (picture.width() as usize, picture.height() as usize);
    let pixels = picture.as_raw().as_chunks::<3>().0.to_vec();
    Photo::from_rgb(width, height, pixels)
}

/// The picture in three channels, on white where it is transparent.
fn on_white(picture: DynamicImage) -> RgbImage {
    if !picture.color().has_alpha() {
        return picture.into_rgb8();
    }
    let picture = picture.into_rgba8();
    let (width, height) = picture.dimensions();
    let over = |[red, green, blue, alpha]: [u8; 4]| {
        let alpha = u16::from(alpha);
        Rgb([red, green, blue]
            .map(|code| ((u16::from(code) * alpha + 255 * (255 - alpha) + 127) / 255) as u8))
    };
    RgbImage::from_fn(width, height, |x, y| over(picture.get_pixel(x, y).0))
}

/// The name of a format that phones write and that is not read: its decoders are patented or vast.
fn foreign_format(bytes: &[u8]) -> Option<&'static str> {
    let brand = bytes.get(8..12).filter(|_| bytes.get(4..8) == Some(b"ftyp"))?;
    match brand {
        b"avif" | b"avis" => Some("AVIF"),
        b"heic" | b"heix" | b"heim" | b"heis" | b"hevc" | b"hevx" | b"mif1" | b"msf1" => {
            Some("HEIC")
        }
        _ => None,
    }
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

#[cfg(test)]
mod tests {
    use super::*;
    use miette::Diagnostic;

    fn png(width: u32, height: u32) -> Vec<u8> {
        let mut bytes = Cursor::new(Vec::new());
        let picture =
            image::GrayImage::from_fn(width, height, |x, _| image::Luma([(x % 256) as u8]));
        picture.write_to(&mut bytes, image::ImageFormat::Png).unwrap();
        bytes.into_inner()
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

    /// A picture without two pixels alike side by side, so that no format packs it into a few bytes.
    fn encoded(format: image::ImageFormat) -> Vec<u8> {
        let mut random = fastrand::Rng::with_seed(7);
        let picture =
            image::RgbImage::from_fn(160, 120, |_, _| image::Rgb([random.u8(..), 128, 90]));
        let mut bytes = Cursor::new(Vec::new());
        picture.write_to(&mut bytes, format).unwrap();
        bytes.into_inner()
    }

    #[test]
    fn every_format_is_read_whole_and_refused_in_part() {
        use image::ImageFormat::{Bmp, Gif, Jpeg, Png, Pnm, Tiff, WebP};
        let drawn = decode(&encoded(Png)).unwrap();
        for format in [Png, Jpeg, Bmp, Gif, Pnm, Tiff, WebP] {
            let whole = encoded(format);
            let photo = decode(&whole).unwrap();
            assert_eq!((photo.width(), photo.height()), (160, 120), "{format:?}");
            if matches!(format, Bmp | Pnm | Tiff | WebP) {
                assert_eq!(photo, drawn, "{format:?}");
            }
            for percent in [1, 20, 50, 80, 97] {
                let cut = decode(&whole[..whole.len() * percent / 100]);
                assert!(cut.is_err(), "{format:?}, {percent} %");
            }
        }
    }

    #[test]
    fn what_phones_write_is_named_with_the_cure() {
        let heic = b"\0\0\0\x18ftypheic\0\0\0\0mif1heic";
        let error = decode(heic).unwrap_err();
        assert_eq!(error, VisionError::Format { format: "HEIC" });
        assert!(error.help().unwrap().to_string().contains("Most Compatible"), "{error:?}");
        let avif = b"\0\0\0\x18ftypavif\0\0\0\0mif1miaf";
        assert_eq!(decode(avif), Err(VisionError::Format { format: "AVIF" }));
    }

    #[test]
    fn what_is_transparent_lies_on_white() {
        let picture = image::RgbaImage::from_fn(96, 64, |x, _| {
            image::Rgba(if x < 48 { [0, 0, 0, 0] } else { [100, 0, 255, 51] })
        });
        let mut bytes = Cursor::new(Vec::new());
        picture.write_to(&mut bytes, image::ImageFormat::Png).unwrap();
        let photo = decode(&bytes.into_inner()).unwrap();
        // A fifth of the colour and four fifths of white: 0.2 × 100 + 0.8 × 255 = 224.
        assert_eq!((photo.pixels()[0], photo.pixels()[60]), ([255; 3], [224, 204, 255]));
    }

    #[test]
    fn sixteen_bits_are_read_as_eight() {
        let picture = image::ImageBuffer::from_fn(96, 64, |x, _| {
            image::Luma([if x < 48 { 0x8000u16 } else { 0xffff }])
        });
        let mut bytes = Cursor::new(Vec::new());
        picture.write_to(&mut bytes, image::ImageFormat::Png).unwrap();
        let photo = decode(&bytes.into_inner()).unwrap();
        assert_eq!((photo.pixels()[0], photo.pixels()[60]), ([128; 3], [255; 3]));
    }

    #[test]
    fn of_an_animation_the_first_picture_is_taken() {
        let mut bytes = Vec::new();
        let mut encoder = image::codecs::gif::GifEncoder::new(&mut bytes);
        for code in [40, 200] {
            let frame = image::RgbaImage::from_pixel(96, 64, image::Rgba([code, code, code, 255]));
            encoder.encode_frame(image::Frame::new(frame)).unwrap();
        }
        drop(encoder);
        let photo = decode(&bytes).unwrap();
        assert!(photo.pixels().iter().all(|&pixel| pixel == [40; 3]));
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
}
