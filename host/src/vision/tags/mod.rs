//! Square black and white tags (ArUco, AprilTag): which they are and where their corners lie.
//!
//! ```text
//! photo ─► dark outlines ─► quads ─► bits ─► dictionary ─► pattern fitted to the photo ─► Tag
//! ```
//! Pixels: the centre of the top left pixel is (0, 0). Corners are given clockwise from the tag's own top
//! left, as OpenCV has them. A tag needs a rim brighter than its ring, at least half a cell wide.

mod arena;
mod bridge;
mod dark;
mod decode;
mod dictionary;
mod fit;
mod quad;

pub use arena::TagPoint;
pub use dictionary::TagDictionary;

pub(crate) use arena::{corners, patch, pose};
pub(crate) use bridge::{Bridged, bridged};

use crate::vision::image::Photo;
use dark::{Grey, Outlines};

/// The share of the photo's variance that a tag's pattern explains.
const LEAST_EXPLAINED: f64 = 0.8;

/// A tag in the photo.
#[derive(Clone, Debug, PartialEq)]
pub struct Tag {
    /// The dictionary in which it was found: the first of those asked for that fit equally well.
    pub dictionary: TagDictionary,
    /// Its number there.
    pub id: usize,
    /// Corners of the black ring, pixels: top left, top right, bottom right, bottom left of the upright tag.
    pub corners_px: [[f64; 2]; 4],
    /// Bits that were read wrong.
    pub errors: u32,
    /// The share of the brightness's variance that the pattern explains, to 1.
    pub explained: f64,
}

impl Tag {
    /// Where the tag's centre appears: where its diagonals cross.
    pub fn centre_px(&self) -> [f64; 2] {
        self.point_px([0.5, 0.5]).unwrap_or(self.corners_px[0])
    }

    /// Where a point of the tag appears, in sides of the ring from the top left, right and down.
    pub(crate) fn point_px(&self, [x, y]: [f64; 2]) -> Option<[f64; 2]> {
        let image = decode::cells_to_photo(self.corners_px, 1)? * nalgebra::Vector3::new(x, y, 1.0);
        Some([image.x / image.z, image.y / image.z])
    }
}

/// Finds the tags of some dictionaries, from the top of the photo to its bottom.
///
/// ```
/// use wmr::vision::{Photo, TagDictionary, find_tags};
/// // Tag 7, upright, with 8 pixels a cell; the ring's outer edge is half a pixel before column 40.
/// let dictionary = TagDictionary::named("4X4_50").unwrap();
/// let cells = dictionary.cells(7).unwrap();
/// let pixel = |i: usize| {
///     let (x, y) = ((i % 128).checked_sub(40), (i / 128).checked_sub(40));
///     let cell = x.zip(y).filter(|(x, y)| x.max(y) < &48).map(|(x, y)| cells[y / 8 * 6 + x / 8]);
///     if cell.unwrap_or(true) { [220; 3] } else { [30; 3] }
/// };
/// let photo = Photo::from_rgb(128, 128, (0..128 * 128).map(pixel).collect())?;
/// let tags = find_tags(&photo, &TagDictionary::usual());
/// assert_eq!((tags.len(), tags[0].id), (1, 7));
/// assert!((tags[0].corners_px[0][0] - 39.5).abs() < 0.05);
/// # Ok::<(), wmr::vision::VisionError>(())
/// ```
pub fn find_tags(photo: &Photo, dictionaries: &[TagDictionary]) -> Vec<Tag> {
    let grey = Grey::of(photo);
    let mut tags: Vec<Tag> = Vec::new();
    Outlines::of(&grey).for_each(|points| {
        let found = quad::of_outline(points).and_then(|corners| tag(&grey, corners, dictionaries));
        tags.extend(found);
    });
    tags
}

/// The tag with these corners whose pattern explains the photo best.
fn tag(grey: &Grey, corners: [[f64; 2]; 4], dictionaries: &[TagDictionary]) -> Option<Tag> {
    let fitted = decode::read(grey, corners, dictionaries).into_iter().filter_map(|read| {
        let corners = std::array::from_fn(|i| corners[(i + read.first_corner) % 4]);
        let fitted = fit::fit(grey, corners, &read.dictionary.cells(read.id)?)?;
        (fitted.explained >= LEAST_EXPLAINED).then_some(Tag {
            dictionary: read.dictionary,
            id: read.id,
            corners_px: fitted.corners,
            errors: read.errors,
            explained: fitted.explained,
        })
    });
    fitted.max_by(|a, b| a.explained.total_cmp(&b.explained))
}
