//! A frame as pages get it.

use axum::body::Bytes;
use hil_sim::camera::Frame;
use image::ExtendedColorType;
use image::codecs::jpeg::JpegEncoder;
use std::sync::Arc;
use std::time::Instant;
use wmr::vision::Photo;

use super::Arranged;

/// Of 100: what a careful camera uses.
const QUALITY: u8 = 88;

/// A frame, and the picture file that a page shows.
#[derive(Clone, Debug)]
pub(in crate::dashboard) struct Shot {
    /// Counts the frames that were shown since the program began.
    pub(in crate::dashboard) number: u64,
    pub(in crate::dashboard) bytes: Bytes,
    pub(in crate::dashboard) content_type: &'static str,
    /// Width and height, pixels.
    pub(in crate::dashboard) size: [usize; 2],
    /// Since when it can be shown.
    pub(in crate::dashboard) taken: Instant,
    pub(in crate::dashboard) photo: Arc<Photo>,
    /// The floor that it shows, if that is simulated.
    pub(in crate::dashboard) arranged: Option<Arranged>,
}

/// What a browser can show of a picture file as it is.
pub(super) fn content_type(bytes: &[u8]) -> Option<&'static str> {
    match bytes {
        [0x89, b'P', b'N', b'G', ..] => Some("image/png"),
        [0xff, 0xd8, ..] => Some("image/jpeg"),
        [b'B', b'M', ..] => Some("image/bmp"),
        _ => None,
    }
}

/// The frame as JPEG; `None` if it cannot be written so.
pub(super) fn jpeg(frame: &Frame) -> Option<Vec<u8>> {
    let mut bytes = Vec::new();
    let (width, height) = (u32::try_from(frame.width).ok()?, u32::try_from(frame.height).ok()?);
    JpegEncoder::new_with_quality(&mut bytes, QUALITY)
        .encode(&frame.rgb, width, height, ExtendedColorType::Rgb8)
        .ok()?;
    Some(bytes)
}
