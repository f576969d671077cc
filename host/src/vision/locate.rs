//! Where the floor is in a photo: by an earlier picture, a camera, by corners that a person or tags give, or by the border.

use crate::geometry::Arena;
use crate::vision::border::{self, By, PictureCorner, given, lowest_left};
use crate::vision::camera::{PlanMap, Viewpoint};
use crate::vision::error::VisionError;
use crate::vision::image::{Photo, check_overview};
use crate::vision::marks::Marks;
use crate::vision::options::DetectOptions;
use crate::vision::tags::{self, Bridged, TagPoint};
use crate::vision::warning::Warning;

/// Of light's greatest change near the border, the least share at the place where a camera has it. Where low walls hide
/// or shade the border it falls to 0.28; 12 pixels beside it is mostly below 0.1.
const LEAST_SEEN: f64 = 0.25;
/// The most that a camera is tilted from straight down, radians: 60 degrees.
const MOST_TILT: f64 = std::f64::consts::FRAC_PI_3;
/// A border that fits worse than this many pixels is worth a warning.
const ROUGH_BORDER: f64 = 0.8;

/// The map from floor to photo.
#[derive(Clone, Debug)]
pub(super) struct Located {
    pub(super) map: PlanMap,
    /// How sure it is, 0 to 1.
    pub(super) confidence: f64,
    pub(super) warnings: Vec<Warning>,
}

/// The map from floor to photo, by camera, by corners or by the border.
///
/// A photo with faults is refused here, where a small copy of it is at hand.
///
/// # Errors
/// Why the floor cannot be found, see [`VisionError`].
pub(super) fn locate(
    photo: &Photo,
    arena: Arena,
    options: &DetectOptions,
    marks: &Marks,
) -> Result<Located, VisionError> {
    let small = photo.reduced(photo.overview_factor());
    check_overview(&small)?;
    if let Some(map) = &options.map {
        return Ok(Located { map: map.clone(), confidence: 1.0, warnings: Vec::new() });
    }
    if let Some(camera) = &options.camera {
        let map = camera.plan_map(photo)?;
        let seen = border_seen(photo, &map, arena);
        let warnings = moved_camera(seen).into_iter().collect();
        let confidence = if seen < LEAST_SEEN { seen } else { 1.0 };
        return Ok(Located { map, confidence, warnings });
    }
    let by_hand = options.corners.map(|corners| Ok((corners, None)));
    let by = if by_hand.is_some() { By::Hand } else { By::Tags };
    let by_tags =
        || options.tags.map(|point| by_tags(photo, arena, (point, options.origin), marks));
    if let Some(corners) = by_hand.or_else(by_tags) {
        let (corners, bridge) = corners?;
        let seen = given(photo, arena, corners, (by, options.origin))?;
        check_tilt(photo, &seen.map)?;
        let warnings = bridge.into_iter().chain(seen.warnings).collect();
        return Ok(Located { map: seen.map, confidence: 1.0, warnings });
    }
    let border = match &options.empty {
        // Nothing stands before its border; but in other light it may be hard to see.
        Some(empty) => {
            let reduced = empty.reduced(empty.overview_factor());
            border::find(empty, &reduced, arena, options.origin)
                .or_else(|_| border::find(photo, &small, arena, options.origin))?
        }
        None => border::find(photo, &small, arena, options.origin)?,
    };
    check_tilt(photo, &border.map)?;
    let mut warnings: Vec<_> = rough_border(border.residual).into_iter().collect();
    let unasked = options.origin.is_none() && lowest_left(border.map.seen_corners(arena)) != 0;
    warnings.extend(unasked.then_some(Warning::WidthRunsUp));
    Ok(Located { confidence: border.score(), map: border.map, warnings })
}

/// The corners that tags give, with what to say of those that have none.
fn by_tags(
    photo: &Photo,
    arena: Arena,
    (point, origin): (TagPoint, Option<PictureCorner>),
    marks: &Marks,
) -> Result<([[f64; 2]; 4], Option<Warning>), VisionError> {
    let seen = marks.corners();
    tags::corners(&seen, point).map(|corners| (corners, None)).or_else(|error| {
        let bridged = tags::bridged(photo, arena, &seen, (point, origin)).ok_or(error)?;
        let Bridged { corners, missing, spread } = bridged;
        Ok((corners, Some(Warning::CornerTags { missing, spread })))
    })
}

/// Refuses a view along the floor: what stands there hides the floor behind it, and a pixel is a decimetre.
fn check_tilt(photo: &Photo, map: &PlanMap) -> Result<(), VisionError> {
    let tilt = Viewpoint::tilt(photo, map);
    if tilt > MOST_TILT { Err(VisionError::Tilted { tilt, allowed: MOST_TILT }) } else { Ok(()) }
}

/// How clearly the border is seen where a map has it, 0 to 1: on all sides but the least clear one.
fn border_seen(photo: &Photo, map: &PlanMap, arena: Arena) -> f64 {
    let mut shown = *border::shown(photo, map, arena).values();
    shown.sort_by(f64::total_cmp);
    shown[1]
}

/// What to say about a border that is seen so clearly where the camera has it.
fn moved_camera(seen: f64) -> Option<Warning> {
    (seen < LEAST_SEEN).then_some(Warning::CameraMoved { seen })
}

/// What to say about a border that fits badly.
fn rough_border(residual: f64) -> Option<Warning> {
    (residual > ROUGH_BORDER).then_some(Warning::RoughBorder { residual })
}
