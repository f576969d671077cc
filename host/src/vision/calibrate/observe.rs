//! What one picture shows of the border: many steps of light along its four sides.

use crate::geometry::{Arena, PerSide, Side};
use crate::vision::border::{self, By, changes, check_arena, company, given};
use crate::vision::camera::PlanMap;
use crate::vision::camera::border_fit::{self, Search, Terms, side_point};
use crate::vision::error::VisionError;
use crate::vision::image::{Photo, check_overview};

/// How far from the border that was found a step of light belongs to it, pixels at a longer side of 640.
const REACH: f64 = 2.5;
/// With corners given by hand, steps are searched for within these shrinking distances, pixels at a longer side of 640:
/// lenses bend sides by some pixels.
const NEAR_CORNERS: [f64; 3] = [6.0, 4.0, 2.5];
/// A step of light is good to this, and a corner that a person points at to this, pixels at a longer side of 640.
const STEP_NOISE: f64 = 0.4;
const POINTED_NOISE: f64 = 0.7;
/// A side's end as a whole is where it was found to this, pixels at a longer side of 640. Where a person points at the
/// corners the edge that looks strongest need not be the right one, if it has more company than this: it then
/// tells the lens alone.
const SIDE_BLUR: f64 = 0.3;
const SIDE_BLUR_BY_HAND: f64 = 4.0;
const LONELY: f64 = 0.1;
/// How far inside and outside of the border the light is compared, pixels at a longer side of 640.
const BESIDE: f64 = 2.5;
/// How far along a side its direction is taken from, a share of its length.
const ALONG_STEP: f64 = 1e-3;

/// A step of light on a side of the border.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Sighting {
    pub(super) side: Side,
    /// Where along the side, counter-clockwise, 0 to 1.
    pub(super) along: f64,
    pub(super) pixel: [f64; 2],
    /// The unit normal of the side in the picture there, inward.
    pub(super) normal: [f64; 2],
    /// How exact the pixel is along the normal, pixels.
    pub(super) noise: f64,
    /// The end of a side that a person has pointed at: it shares no fault of the side's edge.
    pub(super) by_hand: bool,
}

impl Sighting {
    /// The pixel's place along the normal, pixels.
    pub(super) fn place(&self) -> f64 {
        self.normal[0] * self.pixel[0] + self.normal[1] * self.pixel[1]
    }

    /// How much the shift and the slant of its side move it.
    pub(super) fn shares(&self) -> [f64; 2] {
        if self.by_hand { [0.0; 2] } else { [1.0, 2.0 * self.along - 1.0] }
    }

    /// A step at `pixel`, which `map` takes to about the side, exact to `noise` pixels.
    pub(super) fn at(map: &PlanMap, arena: Arena, side: Side, pixel: [f64; 2], noise: f64) -> Self {
        let floor = map.to_floor(pixel);
        let along = match side {
            Side::Lower => floor.x / arena.width,
            Side::Right => floor.y / arena.height,
            Side::Upper => 1.0 - floor.x / arena.width,
            Side::Left => 1.0 - floor.y / arena.height,
        };
        let [a, b] = [-ALONG_STEP, ALONG_STEP]
            .map(|step| map.to_photo(side_point(arena, side, along + step, 0.0)));
        let (dx, dy) = (b[0] - a[0], b[1] - a[1]);
        let length = dx.hypot(dy).max(f64::MIN_POSITIVE);
        // Inward is left of counter-clockwise on the floor; rows run down.
        let normal = [dy / length, -dx / length];
        Self { side, along, pixel, normal, noise, by_hand: false }
    }
}

/// The border as one picture shows it; what [`super::calibrate_camera`] works on.
#[derive(Clone, Debug)]
pub struct ObservedBorder {
    pub(super) size: [usize; 2],
    pub(super) map: PlanMap,
    pub(super) sightings: Vec<Sighting>,
    /// How far an end of each side may be off as a whole, pixels.
    pub(super) side_blurs: PerSide<f64>,
    /// For each side how much of another edge is seen close beside it, a share of its own.
    pub(super) company: PerSide<f64>,
}

impl ObservedBorder {
    /// The longer side of the picture, pixels.
    pub(super) fn longer_side(&self) -> f64 {
        self.size[0].max(self.size[1]) as f64
    }

    /// Finds the border in a photo; from `corners` in pixels (lower left, lower right, upper right, upper
    /// left) if they are given.
    ///
    /// # Errors
    /// What keeps the border from being found, see [`VisionError`].
    pub fn find(
        photo: &Photo,
        arena: Arena,
        corners: Option<[[f64; 2]; 4]>,
    ) -> Result<Self, VisionError> {
        check_arena(arena)?;
        let small = photo.reduced(photo.overview_factor());
        check_overview(&small)?;
        let zoom = photo.zoom();
        let map = match corners {
            Some(corners) => near(photo, arena, corners, zoom)?,
            None => border::find(photo, &small, arena, None)?.map,
        };
        let change = Some(changes(photo, &map, arena, BESIDE * zoom));
        let steps =
            border_fit::steps(photo, &map, arena, &Search { reach: REACH * zoom, change }, 1);
        let sighting = |step: border_fit::Step| {
            Sighting::at(&map, arena, step.side, step.pixel, STEP_NOISE * zoom)
        };
        let mut sightings: Vec<_> = steps.into_iter().map(sighting).collect();
        sightings.extend(
            corners
                .into_iter()
                .flat_map(|corners| pointed(&map, arena, corners, POINTED_NOISE * zoom)),
        );
        let company = company(photo, &map, arena, zoom);
        let side_blurs = company.map(|company| {
            let other = corners.is_some() && company > LONELY;
            zoom * if other { SIDE_BLUR_BY_HAND } else { SIDE_BLUR }
        });
        let size = [photo.width(), photo.height()];
        Ok(Self { size, map, sightings, side_blurs, company })
    }
}

impl ObservedBorder {
    /// Whether a person has pointed at its corners.
    pub(super) fn by_hand(&self) -> bool {
        self.sightings.iter().any(|sighting| sighting.by_hand)
    }
}

/// The ends of the sides that meet in corners that a person has pointed at.
fn pointed(map: &PlanMap, arena: Arena, corners: [[f64; 2]; 4], noise: f64) -> Vec<Sighting> {
    let end = |side: Side, end: usize| {
        let pixel = corners[(side as usize + end) % 4];
        let sighting = Sighting::at(map, arena, side, pixel, noise);
        Sighting { along: end as f64, by_hand: true, ..sighting }
    };
    Side::ALL.into_iter().flat_map(|side| [0, 1].map(|which| end(side, which))).collect()
}

/// The map of corners that the user gave, with the lens that the steps of light near the sides show.
fn near(
    photo: &Photo,
    arena: Arena,
    corners: [[f64; 2]; 4],
    zoom: f64,
) -> Result<PlanMap, VisionError> {
    let mut map = given(photo, arena, corners, (By::Hand, None))?.map;
    for reach in NEAR_CORNERS {
        let search = Search { reach: reach * zoom, change: None };
        let steps = border_fit::steps(photo, &map, arena, &search, 1);
        let terms =
            Terms { width: search.reach, lens: true, stride: 1, without: None, camera: false };
        let fit = border_fit::fit(photo, arena, &map, &steps, terms);
        map = fit.ok_or(VisionError::Corners)?.map;
    }
    PlanMap::from_seen_corners(photo, arena, corners, map.radial()).ok_or(VisionError::Corners)
}
