//! From the border in a reduced photo to the one in the photo itself, to a fraction of its pixels.
//!
//! Sides of which little is seen then are searched again along straight lines, see [`consensus`].

use super::candidates::Border;
use super::consensus;
use super::refine::{Guide, refine};
use crate::geometry::{Arena, Side};
use crate::vision::camera::PlanMap;
use crate::vision::camera::border_fit::side_point;
use crate::vision::image::Photo;

/// Shrinking reaches of the search for steps, pixels of the reduced photo.
const FULL_REACH: [f64; 2] = [2.5, 2.0];
/// A side of which less is seen is searched again along straight lines; one that shows this much more is it.
const LITTLE_SEEN: f64 = 0.7;
const CLEARLY_MORE: f64 = 0.1;

impl Border {
    /// The border of a photo, found in its copy reduced by `factor`, to a fraction of the photo's pixels.
    pub(crate) fn enlarged(self, photo: &Photo, arena: Arena, factor: usize) -> Option<Self> {
        if factor == 1 {
            return Some(self);
        }
        let factor = factor as f64;
        let corners = self.map.seen_corners(arena).map(|pixel| enlarged(pixel, factor));
        let map = PlanMap::from_seen_corners(photo, arena, corners, self.map.radial())?;
        let reaches = FULL_REACH.map(|reach| reach * factor);
        let Some(fine) = refine(photo, arena, &map, &reaches, Guide::by(self.change)) else {
            return Some(Self { map, residual: factor * self.residual, ..self });
        };
        Some(Self::of(fine, self.change, self.by).straightened(photo, arena, reaches[1]))
    }

    /// The border with those sides of which little is seen where a straight line shows clearly more.
    fn straightened(self, photo: &Photo, arena: Arena, reach: f64) -> Self {
        Side::ALL.into_iter().fold(self, |border, side| {
            let now = border.shares[side];
            if now > LITTLE_SEEN {
                return border;
            }
            let lines = consensus::lines(photo, &border.map, arena, side, border.change[side]);
            let clear = lines.into_iter().filter(|line| line.share >= now + CLEARLY_MORE);
            let refitted = clear.filter_map(|line| {
                let map = tilted(photo, arena, &border.map, side, line.inward)?;
                let fit = refine(photo, arena, &map, &[reach], Guide::by(border.change))?;
                Some(Self::of(fit, border.change, border.by))
            });
            let more = refitted.filter(|found| found.shares[side] >= now + CLEARLY_MORE);
            let best = more.max_by(|a, b| a.value(photo).total_cmp(&b.value(photo)));
            best.filter(|best| best.value(photo) > border.value(photo)).unwrap_or(border)
        })
    }
}

/// The place in a photo of a pixel of its copy reduced by `factor`.
fn enlarged(pixel: [f64; 2], factor: f64) -> [f64; 2] {
    pixel.map(|value| (value + 0.5) * factor - 0.5)
}

/// The map with one side where `map` has these distances from it, metres, at its start and its end.
fn tilted(
    photo: &Photo,
    arena: Arena,
    map: &PlanMap,
    side: Side,
    [start, end]: [f64; 2],
) -> Option<PlanMap> {
    let mut corners = map.seen_corners(arena);
    let first = side as usize;
    corners[first] = map.to_photo(side_point(arena, side, 0.0, start));
    corners[(first + 1) % 4] = map.to_photo(side_point(arena, side, 1.0, end));
    PlanMap::from_seen_corners(photo, arena, corners, map.radial())
}

#[cfg(test)]
mod tests {
    use super::super::sides::EndBy;
    use super::*;
    use crate::geometry::PerSide;

    const ARENA: Arena = Arena { width: 1.0, height: 0.75 };

    /// A white floor of 800 x 600 pixels in walls 10 pixels thick, which leave a fifth of each side open; around it a
    /// white rim, on a black table. The rim's lower edge is not parallel to the wall.
    fn walled() -> Photo {
        let pixel = |i: usize| {
            let (x, y) = ((i % 1000) as f64, (i / 1000) as f64);
            let wall = |depth: f64, along: f64| (-10.0..0.0).contains(&depth) && along > 0.2;
            let dark = wall(x - 99.5, (699.5 - y) / 600.0)
                || wall(899.5 - x, (y - 99.5) / 600.0)
                || wall(y - 99.5, (899.5 - x) / 800.0)
                || wall(699.5 - y, (x - 99.5) / 800.0);
            let lower = 712.0 + 0.006 * (x - 99.5);
            let rim = (80.0..920.0).contains(&x) && (80.0..lower).contains(&y);
            if rim && !dark { [225; 3] } else { [30; 3] }
        };
        Photo::from_rgb(1000, 800, (0..1000 * 800).map(pixel).collect()).unwrap()
    }

    #[test]
    fn a_side_between_a_wall_with_a_gap_and_the_rim_beyond_it_moves_to_the_wall() {
        let photo = walled();
        let truth = [[99.5, 699.5], [899.5, 699.5], [899.5, 99.5], [99.5, 99.5]];
        // The lower side starts at the rim's corner.
        let wrong = [[99.5, 712.0], truth[1], truth[2], truth[3]];
        let half = wrong.map(|pixel| pixel.map(|value| (value + 0.5) / 2.0 - 0.5));
        let map = PlanMap::from_seen_corners(&photo.reduced(2), ARENA, half, 0.0).unwrap();
        let change = PerSide::all([-0.7; 3]);
        let by = PerSide::all(EndBy::NoShadow);
        let border = Border { map, shares: PerSide::all(0.8), residual: 0.4, change, by };
        let found = border.enlarged(&photo, ARENA, 2).unwrap();
        for ([x, y], [true_x, true_y]) in found.map.seen_corners(ARENA).into_iter().zip(truth) {
            assert!((x - true_x).hypot(y - true_y) < 0.5, "{x} {y} for {true_x} {true_y}");
        }
    }

    #[test]
    fn both_straight_lines_near_a_side_are_told_with_their_shares() {
        let photo = walled();
        let corners = [[99.5, 699.5], [899.5, 699.5], [899.5, 99.5], [99.5, 99.5]];
        let map = PlanMap::from_seen_corners(&photo, ARENA, corners, 0.0).unwrap();
        let lines = consensus::lines(&photo, &map, ARENA, Side::Lower, [-0.7; 3]);
        // 800 pixels a metre: the wall where the map has the side, the rim 12.5 and 17.3 pixels outside.
        let near = |inward: [f64; 2], share: f64| {
            let line = lines.iter().find(|line| (line.share - share).abs() < 0.02);
            let line = line.unwrap_or_else(|| panic!("{share}: {lines:?}"));
            for (found, pixels) in line.inward.into_iter().zip(inward) {
                assert!((800.0 * found - pixels).abs() < 2.0, "{line:?}");
            }
        };
        // The wall begins behind a fifth of the side and goes on beyond its end.
        near([0.0, 0.0], 0.8125);
        near([-12.5, -17.3], 1.0);
    }
}
