//! Finding the arena in the photo: candidates from long edges, the border among them, or a refusal; or
//! taking it from corners that the user gave.

use super::candidates::{self, Border};
use super::lines::EdgeMap;
use super::quads;
use crate::geometry::Arena;
use crate::vision::camera::{PlanMap, Viewpoint};
use crate::vision::error::VisionError;
use crate::vision::image::Photo;

/// Edges step by at least this many brightness codes.
const LEAST_CONTRAST: f64 = 8.0;
/// The share of the border's profiles that must show it.
const LEAST_SCORE: f64 = 0.5;
/// Every profile shows the border; a little more than 1, since shares are summed up.
const MOST_SCORE: f64 = 1.0 + 1e-9;
/// With this share no other candidate is looked at.
const SURE_SCORE: f64 = 0.93;
/// How much a candidate's edges and size count beside the share of its profiles.
const RANK_WEIGHT: f64 = 1.2;
/// The misfit of a camera that no true border reaches, squared standard deviations.
const MOST_MISFIT: f64 = 10.0;

/// Finds the arena's border in a photo, of which `small` is the overview.
///
/// # Errors
/// [`VisionError::NoContrast`], [`VisionError::NoBorder`], [`VisionError::OddBorder`] or
/// [`VisionError::OutOfView`], with what was measured.
pub(crate) fn find(photo: &Photo, small: &Photo, arena: Arena) -> Result<Border, VisionError> {
    let edges = EdgeMap::of(small);
    if edges.contrast < LEAST_CONTRAST {
        return Err(VisionError::NoContrast { measured: edges.contrast, needed: LEAST_CONTRAST });
    }
    let candidates = quads::candidates(&edges, (small.width(), small.height()), arena);
    let mut best: Option<(f64, Border)> = None;
    let mut odd: f64 = 0.0;
    for quad in &candidates {
        // The others rank no higher: not even a whole border would bring them before the best.
        let most = MOST_SCORE + RANK_WEIGHT * quad.rank;
        if best.as_ref().is_some_and(|(value, found)| *value >= most && found.score >= LEAST_SCORE)
        {
            break;
        }
        let Some(border) = candidates::find(small, arena, quad.corners) else { continue };
        let misfit = Viewpoint::misfit(small, &border.map);
        let odd_one = misfit > MOST_MISFIT;
        let anew = odd_one.then(|| border.reconsidered(small, arena)).flatten();
        let border = anew.unwrap_or(border);
        let misfit = Viewpoint::misfit(small, &border.map);
        if misfit > MOST_MISFIT {
            odd = odd.max(border.score);
            continue;
        }
        // Candidates come likeliest first: one that shows the border nearly everywhere is it.
        let sure = border.score > SURE_SCORE;
        let value = border.score + RANK_WEIGHT * quad.rank;
        if best.as_ref().is_none_or(|(most, _)| value > *most) {
            best = Some((value, border));
        }
        if sure {
            break;
        }
    }
    let best = best.map(|(_, border)| border);
    let measured = best.as_ref().map_or(0.0, |border| border.score);
    let odd_border = Err(VisionError::OddBorder { arena });
    let Some(found) = best.filter(|border| border.score >= LEAST_SCORE) else {
        let none = Err(VisionError::NoBorder { arena, measured, needed: LEAST_SCORE });
        return if odd >= LEAST_SCORE { odd_border } else { none };
    };
    match found.enlarged(photo, arena, photo.overview_factor()) {
        Some(border) if Viewpoint::misfit(photo, &border.map) <= MOST_MISFIT => {
            in_view(photo, arena, border)
        }
        _ => odd_border,
    }
}

fn in_view(photo: &Photo, arena: Arena, border: Border) -> Result<Border, VisionError> {
    let corners = border.map.seen_corners(arena);
    match corners.iter().position(|&pixel| !photo.holds(pixel)) {
        Some(corner) => Err(VisionError::OutOfView { corner, pixel: corners[corner] }),
        None => Ok(border),
    }
}

/// Whether an arena of that size is possible.
pub(crate) fn check_arena(arena: Arena) -> Result<(), VisionError> {
    let Arena { width, height } = arena;
    let possible = |length: f64| (0.1..=100.0).contains(&length);
    if !possible(width) || !possible(height) || width > 10.0 * height || height > 10.0 * width {
        return Err(VisionError::ArenaSize(arena));
    }
    Ok(())
}

/// The map of corners that the user gave.
pub(crate) fn given(
    photo: &Photo,
    arena: Arena,
    corners: [[f64; 2]; 4],
) -> Result<PlanMap, VisionError> {
    let turn = |i: usize| {
        let [a, b, c] = [corners[i], corners[(i + 1) % 4], corners[(i + 2) % 4]];
        (b[0] - a[0]) * (c[1] - b[1]) - (b[1] - a[1]) * (c[0] - b[0])
    };
    // Counter-clockwise on the floor is clockwise with rows running down, hence negative.
    if !(0..4).all(|i| turn(i) < 0.0) {
        return Err(VisionError::Corners);
    }
    if let Some(corner) = corners.iter().position(|&pixel| !photo.holds(pixel)) {
        return Err(VisionError::OutOfView { corner, pixel: corners[corner] });
    }
    PlanMap::from_seen_corners(photo, arena, corners, 0.0).ok_or(VisionError::Corners)
}

#[cfg(test)]
mod tests {
    use super::*;

    const ARENA: Arena = Arena { width: 1.5, height: 1.0 };

    #[test]
    fn grey_and_borderless_pictures_are_refused_for_their_reason() {
        let even = |code| Photo::from_rgb(160, 120, vec![[code; 3]; 160 * 120]).unwrap();
        assert!(matches!(find(&even(128), &even(128), ARENA), Err(VisionError::NoContrast { .. })));
        let halves = (0..160 * 120).map(|i| if i % 160 < 80 { [200; 3] } else { [40; 3] });
        let halves = Photo::from_rgb(160, 120, halves.collect()).unwrap();
        assert!(matches!(find(&halves, &halves, ARENA), Err(VisionError::NoBorder { .. })));
    }
}
