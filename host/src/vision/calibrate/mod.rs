//! A camera's own numbers and its place over the arena, from pictures of the arena's border.
//!
//! ```text
//! photos ─► observe (steps of light along the border) ─► explain (is a side mistaken?) ─► Camera, how sure
//!                                                          └─► solve (least squares) ─► model
//! ```
//! The arena's known size makes its border a calibration target: straight sides tell the lens, their
//! lengths the scale, their convergence the tilt. What a border cannot tell is the focal length seen from
//! straight above: a longer one from higher up makes the same picture. So what is known beforehand takes
//! part: usual focal lengths, principal points near the picture's centre, and what the user has measured
//! (the camera's height, or the focal length). Each number comes with its standard deviation. Metres in the
//! arena frame, pixels in the photo.
//!
//! More pictures from the same place add little noise to less noise; pictures by the same camera from
//! other, tilted places tell what one place cannot: focal length and principal point.
//!
//! Deviation: the paper takes its camera for straight above and its pictures for plans; where the boxes' tops
//! lean to, and how much, needs the camera's place.

mod explain;
mod model;
mod observe;
mod solve;

#[cfg(test)]
mod tests;

use crate::geometry::{Arena, Side};
use crate::vision::camera::{Camera, CameraModel, CameraSpread};
use crate::vision::error::VisionError;
use explain::{Explained, explain};
use model::Unknown;
pub use observe::ObservedBorder;

/// Focal lengths that cameras have, longer sides of the picture; long ones from far away make good plans.
const FOCAL_RANGE: std::ops::RangeInclusive<f64> = 0.3..=30.0;
/// Pictures from one place show the corners at the same places to this, a share of the longer side.
const MOST_SHIFT: f64 = 0.005;
/// What is given may add this much to the misfit, squared standard deviations.
const MOST_CONTRADICTION: f64 = 16.0;

/// What the user knows of the camera.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct KnownOfCamera {
    /// The height of the lens above the floor, metres, good to a centimetre.
    pub height: Option<f64>,
    /// The focal length in pixels of these pictures, good to half a percent.
    pub focal: Option<f64>,
}

/// A calibrated camera, and how sure its numbers are.
#[derive(Clone, Debug, PartialEq)]
pub struct CalibratedCamera {
    /// The camera at its first place.
    pub camera: Camera,
    /// The lens's place, metres: x and y of the foot point, and the height.
    pub position: [f64; 3],
    /// How sure the camera's numbers are; the same as in `camera`.
    pub spread: CameraSpread,
    /// The angle between the camera's axis and straight down, radians.
    pub tilt: f64,
    /// The root mean square distance of the border's steps of light from where the camera expects them, pixels.
    pub residual: f64,
    /// How far the sides had to be shifted, and the lens bent, for a camera to see them so: squared standard
    /// deviations, a few if the border was found right.
    pub strain: f64,
    /// The side of the border that was taken for another edge, as far as can be told: 0 lower, 1 right, 2
    /// upper, 3 left.
    pub mistaken: Option<Side>,
    /// How many steps of light count, of all four sides and pictures.
    pub steps: usize,
}

/// Fits a camera to borders that were observed.
///
/// `fixed` are pictures from the place that is calibrated, `elsewhere` further ones by the same camera
/// from other places, each of its own; these may be none.
///
/// # Errors
/// [`VisionError::Sizes`] if pictures differ in size, [`VisionError::Moved`] if those from one place do
/// not agree, [`VisionError::KnownHeight`], [`VisionError::KnownFocal`] or [`VisionError::OddFocal`] if what
/// is known contradicts them, [`VisionError::Camera`] if no camera sees them.
pub fn calibrate_camera(
    arena: Arena,
    fixed: &[ObservedBorder],
    elsewhere: &[ObservedBorder],
    known: KnownOfCamera,
) -> Result<CalibratedCamera, VisionError> {
    let first = fixed.first().ok_or(VisionError::Corners)?;
    same_size(first.size, fixed, elsewhere)?;
    same_place(arena, fixed)?;
    let mut views = vec![fixed.iter().collect::<Vec<_>>()];
    views.extend(elsewhere.iter().map(|border| vec![border]));
    let found = explain(arena, &views, known).ok_or_else(impossible)?;
    check_known(arena, &views, known, &found)?;
    described(&found, first.size).ok_or_else(impossible)
}

fn impossible() -> VisionError {
    VisionError::Camera { reason: "no camera sees such a border".into() }
}

fn same_size(
    first: [usize; 2],
    fixed: &[ObservedBorder],
    elsewhere: &[ObservedBorder],
) -> Result<(), VisionError> {
    let mut others = (1..).zip(fixed.iter().chain(elsewhere));
    match others.find(|(_, border)| border.size != first) {
        Some((photo, border)) => Err(VisionError::Sizes { first, photo, other: border.size }),
        None => Ok(()),
    }
}

/// Whether pictures from one place show the border at one place.
fn same_place(arena: Arena, fixed: &[ObservedBorder]) -> Result<(), VisionError> {
    let corners: Vec<_> = fixed.iter().map(|border| border.map.seen_corners(arena)).collect();
    let allowed = MOST_SHIFT * fixed.first().map_or(0.0, ObservedBorder::longer_side);
    let mut worst = (0.0, [0, 0], 0);
    for (j, b) in corners.iter().enumerate() {
        for (i, a) in corners[..j].iter().enumerate() {
            for (corner, (p, q)) in a.iter().zip(b).enumerate() {
                let shift = (p[0] - q[0]).hypot(p[1] - q[1]);
                if shift > worst.0 {
                    worst = (shift, [i + 1, j + 1], corner);
                }
            }
        }
    }
    let (shift, photos, corner) = worst;
    if shift > allowed {
        return Err(VisionError::Moved { photos, corner, shift, allowed });
    }
    Ok(())
}

/// Whether what is given agrees with what is seen: the sightings must not fit worse for it.
fn check_known(
    arena: Arena,
    views: &[Vec<&ObservedBorder>],
    known: KnownOfCamera,
    found: &Explained,
) -> Result<(), VisionError> {
    let misfit = |explained: &Explained| explained.best().misfit(of_border);
    let nothing = KnownOfCamera::default();
    if let Some(given) = known.focal {
        let free = explain(arena, views, nothing).ok_or_else(impossible)?;
        let only = explain(arena, views, KnownOfCamera { height: None, ..known })
            .ok_or_else(impossible)?;
        if misfit(&only) > misfit(&free) + MOST_CONTRADICTION {
            let measured = free.best().state.lens.focal;
            let spread = measured * free.spread(Unknown::LogFocal);
            return Err(VisionError::KnownFocal { given, measured, spread });
        }
    }
    if let Some(given) = known.height {
        let free = explain(arena, views, KnownOfCamera { height: None, ..known })
            .ok_or_else(impossible)?;
        let far = found.best().value(Unknown::Height) - given;
        if misfit(found) + (far / explain::HEIGHT_SPREAD).powi(2)
            > misfit(&free) + MOST_CONTRADICTION
        {
            let (measured, spread) =
                (free.best().value(Unknown::Height), free.spread(Unknown::Height));
            return Err(VisionError::KnownHeight { given, measured, spread });
        }
    }
    let sides = found.best().state.lens.focal / views[0][0].longer_side();
    if FOCAL_RANGE.contains(&sides) {
        return Ok(());
    }
    Err(VisionError::OddFocal { sides, range: [*FOCAL_RANGE.start(), *FOCAL_RANGE.end()] })
}

/// Whether an unknown is about the border and the lens, not about what a border hardly tells.
fn of_border(unknown: Unknown) -> bool {
    !matches!(unknown, Unknown::LogFocal | Unknown::Height)
}

/// The camera of a solution at its first place; `None` if the solution leaves something open.
fn described(explained: &Explained, size: [usize; 2]) -> Option<CalibratedCamera> {
    let found = explained.best();
    let (lens, stand) = (found.state.lens, found.state.stands.first()?);
    let position = stand.position;
    let shift = -(stand.rotation * position);
    let rows = |matrix: &nalgebra::Matrix3<f64>| {
        [0, 1, 2].map(|row| [0, 1, 2].map(|column| matrix[(row, column)]))
    };
    let spread = CameraSpread {
        focal: lens.focal * explained.spread(Unknown::LogFocal),
        principal_point: [0, 1].map(|axis| explained.spread(Unknown::Centre(axis))),
        k1: explained.spread(Unknown::Radial),
        position: [Unknown::X, Unknown::Y, Unknown::Height].map(|one| explained.spread(one)),
    };
    let camera = Camera {
        model: CameraModel::Perspective,
        image_size: size,
        matrix: [
            [lens.focal, 0.0, lens.centre[0]],
            [0.0, lens.focal, lens.centre[1]],
            [0.0, 0.0, 1.0],
        ],
        k1: lens.radial,
        rotation: rows(stand.rotation.matrix()),
        translation: shift.into(),
        spread: Some(spread),
    };
    let (residual, steps) = found.residual();
    Some(CalibratedCamera {
        camera,
        position: position.into(),
        spread,
        tilt: (-stand.rotation.matrix()[(2, 2)]).clamp(-1.0, 1.0).acos(),
        residual,
        steps,
        strain: found.strain(of_border),
        mistaken: explained.mistaken,
    })
}
