//! Finding the arena in the photo: candidates from long edges, the border among them, or a refusal.

use super::candidates::{self, Border, LEAST_SHARE};
use super::lines::EdgeMap;
use super::nested::is_drawn_inside;
use super::origin::{PictureCorner, lowest_left};
use super::quads::{self, Quad};
use super::seen::SeenBorder;
use crate::geometry::{Arena, Side};
use crate::vision::camera::Viewpoint;
use crate::vision::camera::border_fit::side_point;
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
/// Beside each side so much of the picture's longer side is seen: else the picture was cut there.
const LEAST_BESIDE: f64 = 0.006;
/// What encloses less of the photo may be a card or the top of a box with the arena's ratio.
const LEAST_ENCLOSED: f64 = 0.15;
/// How much a candidate's edges and size count beside the share of its profiles.
const RANK_WEIGHT: f64 = 1.2;
/// A rectangle around another counts if it scores no less than that by more than this.
const OUTER_LOSS: f64 = 0.2;
/// A rectangle whose border is seen to this share is one, even if its size is not exactly the stated one.
const CLEAR_SCORE: f64 = 0.78;
/// The misfit of a camera that no true border reaches, squared standard deviations.
const MOST_MISFIT: f64 = 10.0;

/// Finds the arena's border in a photo, of which `small` is the overview; with `origin` at that corner of the picture.
///
/// # Errors
/// [`VisionError::NoContrast`], [`VisionError::NoBorder`], [`VisionError::OddBorder`], [`VisionError::Origin`],
/// [`VisionError::OutOfView`], [`VisionError::AtTheEdge`], [`VisionError::HiddenSide`] or
/// [`VisionError::SmallBorder`], with what was measured.
pub(crate) fn find(
    photo: &Photo,
    small: &Photo,
    arena: Arena,
    origin: Option<PictureCorner>,
) -> Result<Border, VisionError> {
    let edges = EdgeMap::of(small);
    if edges.contrast < LEAST_CONTRAST {
        return Err(VisionError::NoContrast { measured: edges.contrast, needed: LEAST_CONTRAST });
    }
    let candidates = quads::candidates(small, &edges, arena, origin);
    let mut found = Found::default();
    for quad in &candidates.fitting {
        if found.is_before(quad) {
            break;
        }
        found.look(small, arena, quad);
    }
    while let Some(around) = found.unseen_around(small, arena, &candidates.fitting) {
        found.look(small, arena, around);
    }
    let refused = |ratio: Option<f64>| VisionError::OddBorder { arena, ratio };
    let odd = |quad: &Quad| odd_ratio(small, arena, quad);
    let Some(best) = found.best else {
        let likeliest = found.likeliest.or(candidates.all().next().map(|quad| quad.corners));
        let seen = likeliest.and_then(|corners| SeenBorder::of(small, arena, corners));
        let none =
            VisionError::NoBorder { arena, measured: found.measured, needed: LEAST_SCORE, seen };
        let ratio = candidates.all().find_map(odd);
        return Err(if found.is_odd || ratio.is_some() { refused(ratio) } else { none });
    };
    let around = candidates
        .all()
        .filter(|quad| is_drawn_inside(small, arena, &best.border.map, quad.corners));
    if let Some(ratio) = around.filter_map(odd).next() {
        return Err(refused(Some(ratio)));
    }
    match best.border.enlarged(photo, arena, photo.overview_factor()) {
        Some(border) if Viewpoint::misfit_as_stated(photo, &border.map) <= MOST_MISFIT => {
            let corners = border.map.seen_corners(arena);
            let first = lowest_left(corners);
            match origin.filter(|origin| !(first + origin.index()).is_multiple_of(4)) {
                Some(origin) => Err(VisionError::Origin { origin, arena }),
                None => in_view(photo, arena, border),
            }
        }
        Some(border) => Err(refused(Viewpoint::side_ratio(photo, &border.map))),
        None => Err(refused(None)),
    }
}

/// What was found among candidates that were looked at.
#[derive(Default)]
struct Found {
    best: Option<Ranked>,
    /// The best score of any.
    measured: f64,
    /// The corners of the candidate with that score.
    likeliest: Option<[[f64; 2]; 4]>,
    /// Whether one that no camera sees of the arena was seen as clearly as a border.
    is_odd: bool,
    looked_at: Vec<[[f64; 2]; 4]>,
}

struct Ranked {
    value: f64,
    border: Border,
}

impl Found {
    /// Whether what was found comes before a candidate, even if all of its border were seen.
    fn is_before(&self, quad: &Quad) -> bool {
        let most = MOST_SCORE + RANK_WEIGHT * quad.rank;
        self.best
            .as_ref()
            .is_some_and(|best| best.border.score() > SURE_SCORE || best.value >= most)
    }

    /// Looks for the border from a candidate.
    fn look(&mut self, small: &Photo, arena: Arena, quad: &Quad) {
        self.looked_at.push(quad.corners);
        let Some(border) = candidates::find(small, arena, quad.corners) else { return };
        if border.score() > self.measured {
            self.measured = border.score();
            self.likeliest = Some(border.map.seen_corners(arena));
        }
        if border.score() < LEAST_SCORE {
            return;
        }
        let exact = Viewpoint::misfit(small, &border.map) <= MOST_MISFIT;
        let as_stated = Viewpoint::misfit_as_stated(small, &border.map) <= MOST_MISFIT;
        let clear = as_stated && border.score() >= CLEAR_SCORE;
        if !exact && !clear {
            self.is_odd = true;
            return;
        }
        let value = border.score() + RANK_WEIGHT * quad.rank;
        let before = self.best.as_ref();
        let around = before.is_some_and(|best| {
            let enough = border.score() > best.border.score() - OUTER_LOSS;
            enough
                && is_drawn_inside(small, arena, &best.border.map, border.map.seen_corners(arena))
        });
        if around || before.is_none_or(|best| value > best.value) {
            self.best = Some(Ranked { value, border });
        }
    }

    /// A candidate that was not looked at, on whose floor the best border lies.
    fn unseen_around<'a>(
        &self,
        small: &Photo,
        arena: Arena,
        quads: &'a [Quad],
    ) -> Option<&'a Quad> {
        let best = &self.best.as_ref()?.border;
        quads.iter().find(|quad| {
            let seen = self.looked_at.contains(&quad.corners);
            !seen && is_drawn_inside(small, arena, &best.map, quad.corners)
        })
    }
}

/// The ratio of sides, against the stated one, of a candidate that no camera sees of the arena, if its border is
/// seen clearly.
fn odd_ratio(small: &Photo, arena: Arena, quad: &Quad) -> Option<f64> {
    let border = candidates::lined(small, arena, quad.corners)?;
    let odd = Viewpoint::misfit_as_stated(small, &border.map) > MOST_MISFIT;
    Viewpoint::side_ratio(small, &border.map).filter(|_| odd && border.score() >= CLEAR_SCORE)
}

/// A border of which enough is seen on each side, and more than its inside: beside each side there is something
/// else in the picture. It is no small thing.
fn in_view(photo: &Photo, arena: Arena, border: Border) -> Result<Border, VisionError> {
    let corners = border.map.seen_corners(arena);
    if let Some(corner) = corners.iter().position(|&pixel| !photo.holds(pixel)) {
        return Err(VisionError::OutOfView { corner, pixel: corners[corner] });
    }
    let hidden = border.shares.iter().find(|&(_, &share)| share < LEAST_SHARE);
    if let Some((side, &share)) = hidden {
        return Err(VisionError::HiddenSide { side, share, needed: LEAST_SHARE });
    }
    let all = (photo.width() * photo.height()) as f64;
    let share = enclosed(corners) / all;
    if share < LEAST_ENCLOSED {
        return Err(VisionError::SmallBorder { share, needed: LEAST_ENCLOSED });
    }
    let beside = LEAST_BESIDE * photo.width().max(photo.height()) as f64;
    for side in Side::ALL {
        let [middle, inner] =
            [0.0, 1e-3].map(|inward| border.map.to_photo(side_point(arena, side, 0.5, inward)));
        let length = (middle[0] - inner[0]).hypot(middle[1] - inner[1]).max(1e-9);
        let outside = [0, 1].map(|k| middle[k] + beside * (middle[k] - inner[k]) / length);
        if !photo.holds(outside) {
            return Err(VisionError::AtTheEdge { side });
        }
    }
    Ok(border)
}

/// The area of a quadrilateral, square pixels.
fn enclosed(corners: [[f64; 2]; 4]) -> f64 {
    let next = corners.iter().cycle().skip(1);
    let doubled: f64 = corners.iter().zip(next).map(|(a, b)| a[0] * b[1] - b[0] * a[1]).sum();
    doubled.abs() / 2.0
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

#[cfg(test)]
mod tests {
    use super::super::sides::EndBy;
    use super::*;
    use crate::geometry::PerSide;
    use crate::vision::camera::PlanMap;

    const ARENA: Arena = Arena { width: 1.5, height: 1.0 };

    #[test]
    fn grey_and_borderless_pictures_are_refused_for_their_reason() {
        let even = |code| Photo::from_rgb(160, 120, vec![[code; 3]; 160 * 120]).unwrap();
        assert!(matches!(
            find(&even(128), &even(128), ARENA, None),
            Err(VisionError::NoContrast { .. })
        ));
        let halves = (0..160 * 120).map(|i| if i % 160 < 80 { [200; 3] } else { [40; 3] });
        let halves = Photo::from_rgb(160, 120, halves.collect()).unwrap();
        assert!(matches!(find(&halves, &halves, ARENA, None), Err(VisionError::NoBorder { .. })));
    }

    #[test]
    fn a_side_of_which_most_is_hidden_is_refused_by_its_name() {
        let photo = Photo::from_rgb(640, 480, vec![[128; 3]; 640 * 480]).unwrap();
        let corners = [[80.0, 420.0], [620.0, 420.0], [620.0, 60.0], [80.0, 60.0]];
        let seen = |right: f64| {
            let map = PlanMap::from_seen_corners(&photo, ARENA, corners, 0.0).unwrap();
            let mut shares = PerSide::all(1.0);
            shares[Side::Right] = right;
            let (change, by) = (PerSide::all([-0.5; 3]), PerSide::all(EndBy::Unlit));
            in_view(&photo, ARENA, Border { map, shares, residual: 0.1, change, by })
        };
        assert!(seen(0.5).is_ok());
        let refused = seen(0.4).unwrap_err();
        let hidden = |side, share| side == Side::Right && share == 0.4;
        assert!(
            matches!(refused, VisionError::HiddenSide { side, share, .. } if hidden(side, share))
        );
    }
}
