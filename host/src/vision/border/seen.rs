//! What is seen where no border is found: for a refusal to say it, and for a person to look at.

use super::light;
use super::lines::EdgeMap;
use super::origin::PictureCorner;
use super::quads::{self, Quad};
use crate::geometry::{Arena, Side};
use crate::vision::camera::{PlanMap, Viewpoint};
use crate::vision::image::Photo;

/// How far to both sides of a side brightness is compared, pixels at a longer side of 640.
const BESIDE: f64 = 6.0;
/// Ground that is as bright as the floor to this, a natural logarithm, is hard to tell from it.
const ALIKE: f64 = 0.35;
/// Ratios of sides that differ by less, a natural logarithm, are written alike.
const SAME_RATIO: f64 = 0.01;

/// The likeliest candidate for a border, and why it may not have been found.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SeenBorder {
    /// The ratio of width to height of the rectangle that is seen, if it is one.
    pub ratio: Option<f64>,
    /// The side along which ground and floor are most alike.
    pub side: Side,
    /// How bright the ground is there, as a share of the floor's brightness.
    pub ground: f64,
}

impl SeenBorder {
    pub(super) fn of(photo: &Photo, arena: Arena, corners: [[f64; 2]; 4]) -> Option<Self> {
        let map = PlanMap::from_seen_corners(photo, arena, corners, 0.0)?;
        let zoom = photo.zoom();
        let shares = light::ground(photo, &map, arena, BESIDE * zoom);
        let alike = |share: &f64| share.max(f64::MIN_POSITIVE).ln().abs();
        let (side, &ground) = shares.iter().min_by(|a, b| alike(a.1).total_cmp(&alike(b.1)))?;
        let stated = arena.width / arena.height;
        let ratio = Viewpoint::side_ratio(photo, &map).map(|ratio| ratio * stated);
        Some(Self { ratio, side, ground })
    }

    /// The ratio of sides that is seen, in words, if it is not that of the stated arena.
    pub(crate) fn other_ratio(&self, arena: Arena) -> Option<String> {
        let stated = arena.width / arena.height;
        let other = self.ratio.filter(|ratio| (ratio / stated).ln().abs() > SAME_RATIO)?;
        Some(format!("a rectangle of ratio {other:.2} is seen, {stated:.2} was stated"))
    }

    /// What would tell the floor from the ground, in words, where they are hard to tell apart.
    pub(crate) fn contrast_advice(&self) -> Option<String> {
        let is_alike = self.ground.max(f64::MIN_POSITIVE).ln().abs() < ALIKE;
        is_alike.then(|| {
            format!(
                "along its {} side the ground is {:.2} as bright as the floor: a dark tape along the edge would help",
                self.side, self.ground
            )
        })
    }
}

/// Quadrilaterals that may be the arena's border, pixels, likeliest first.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct BorderCandidates {
    /// Those that a camera may see of the arena.
    pub fitting: Vec<[[f64; 2]; 4]>,
    /// Those of nearly its shape that no camera sees of it.
    pub odd: Vec<[[f64; 2]; 4]>,
}

/// The candidates for the border of an arena in a photo, for people to look at.
///
/// ```
/// use wmr::{geometry::Arena, vision::{Photo, border_candidates}};
/// let sheet = |i: usize| (40..180).contains(&(i % 220)) && (30..135).contains(&(i / 220));
/// let pixels = (0..220 * 160).map(|i| if sheet(i) { [230; 3] } else { [60; 3] });
/// let photo = Photo::from_rgb(220, 160, pixels.collect())?;
/// let seen = border_candidates(&photo, Arena { width: 1.6, height: 1.2 }, None);
/// assert!((seen.fitting[0][0][0] - 39.5).abs() < 2.0);
/// # Ok::<(), wmr::vision::VisionError>(())
/// ```
pub fn border_candidates(
    photo: &Photo,
    arena: Arena,
    origin: Option<PictureCorner>,
) -> BorderCandidates {
    let factor = photo.overview_factor();
    let small = photo.reduced(factor);
    let found = quads::candidates(&small, &EdgeMap::of(&small), arena, origin);
    let factor = factor as f64;
    let enlarged =
        |quad: &Quad| quad.corners.map(|pixel| pixel.map(|value| (value + 0.5) * factor - 0.5));
    BorderCandidates {
        fitting: found.fitting.iter().map(enlarged).collect(),
        odd: found.odd.iter().map(enlarged).collect(),
    }
}
