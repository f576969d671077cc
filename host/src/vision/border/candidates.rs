//! Which of the nested edges around the arena is its border: the one where the floor ends.
//!
//! From a candidate quadrilateral the floor's colour is learnt inside. On each side the place is
//! taken where, coming from inside, the colour stops being floor or shadow; its step is then fitted
//! to a fraction of a pixel. The share of profiles that show that step, with floor inside and
//! something else outside, is the candidate's score.
//!
//! A quadrilateral that no camera could see of the stated rectangle has a wrong side, such as the edge of
//! boxes that hide the border. Three sides and the condition that a camera saw them predict the fourth:
//! [`Border::reconsidered`] looks there.

use super::light;
use super::refine::{Changes, Guide, farthest, refine, seen};
use super::sides::{EndBy, Sides, learn_floor};
use crate::geometry::{Arena, PerSide, Point, Side};
use crate::vision::appearance::FloorModel;
use crate::vision::camera::border_fit::Fit;
use crate::vision::camera::{PlanMap, Viewpoint};
use crate::vision::image::Photo;

/// It counts if it lies this many pixels from the step of light, at a longer side of 640.
const COLOUR_SHIFT: f64 = 1.2;
/// A difference between cameras' misfits that tells, squared standard deviations.
const CLEAR_GAIN: f64 = 1.2;
/// Reaches of the search for a wall's foot, pixels at a longer side of 640.
const FOOT_REACH: [f64; 3] = [3.0, 2.0, 2.0];
/// The border is found when its corners move by less than this, pixels at a longer side of 640.
const SETTLED: f64 = 0.05;
/// Shrinking reaches of the search for steps, pixels at a longer side of 640.
const ROUGH_REACH: [f64; 3] = [9.0, 5.0, 3.0];
const FINE_REACH: [[f64; 3]; 3] = [[8.0, 5.0, 3.0], [5.0, 3.0, 2.0], [4.0, 2.5, 2.0]];
/// Reaches where three sides predict the fourth, pixels at a longer side of 640.
const PREDICTED_REACH: [f64; 2] = [3.0, 2.0];
/// A squared standard deviation of misfit outweighs this share of the profiles.
const MISFIT_WEIGHT: f64 = 0.05;
/// How far to both sides of a line light is compared, pixels at a longer side of 640.
const LINED_BESIDE: f64 = 3.0;
/// Each side shows on this share of its profiles: of less it is a guess where it runs.
pub(super) const LEAST_SHARE: f64 = 0.45;
/// Inside of a line there is floor, at these distances, pixels at a longer side of 640.
const INSIDE: [f64; 2] = [2.0, 6.0];
/// The lines themselves are the border if they are better by this than where the floor's colour ends.
const LINED_GAIN: f64 = 0.05;
/// Misfits beyond this are all alike.
const MOST_MISFIT: f64 = 10.0;
/// A border that was found.
#[derive(Clone, Debug)]
pub(crate) struct Border {
    /// The map from floor to photo.
    pub(crate) map: PlanMap,
    /// The share of each side's profiles that show the border, 0 to 1.
    pub(crate) shares: PerSide<f64>,
    /// The root mean square distance of the border's steps from the map, pixels.
    pub(crate) residual: f64,
    /// The change of linear light from inside to outside on each side.
    pub(super) change: Changes,
    /// By what the floor's end was told on each side.
    pub(super) by: PerSide<EndBy>,
}

impl Border {
    /// The border with one side searched again where a camera that saw the others would see it, if that fits
    /// clearly better to a camera.
    fn reconsidered(&self, photo: &Photo, arena: Arena) -> Option<Self> {
        let before = Viewpoint::misfit(photo, &self.map);
        let floor = learn_floor(photo, &self.map, arena)?;
        let reaches = PREDICTED_REACH.map(|reach| reach * photo.zoom());
        let sought_anew = |side: Side| {
            let guide = Guide { without: Some(side), camera: true, ..Guide::by(self.change) };
            let predicted = refine(photo, arena, &self.map, &reaches, guide)?;
            settle(photo, arena, predicted.map, &floor, (self.by, true))
        };
        let misfit = |border: &Self| Viewpoint::misfit(photo, &border.map);
        let value = |border: &Self| border.score() - MISFIT_WEIGHT * misfit(border);
        let found = Side::ALL.into_iter().filter_map(sought_anew);
        let better = found.filter(|border| misfit(border) + CLEAR_GAIN < before);
        better.max_by(|a, b| value(a).total_cmp(&value(b)))
    }

    pub(super) fn of(fit: Fit, change: Changes, by: PerSide<EndBy>) -> Self {
        Self { map: fit.map, shares: fit.shares, residual: fit.residual, change, by }
    }

    /// The share of all profiles that show the border, 0 to 1.
    pub(crate) fn score(&self) -> f64 {
        seen(&self.shares)
    }

    /// How good a border it is: the share of the profiles that show it, less what no camera would see.
    pub(super) fn value(&self, photo: &Photo) -> f64 {
        let misfit = Viewpoint::misfit_as_stated(photo, &self.map).min(MOST_MISFIT);
        self.score() - MISFIT_WEIGHT * misfit
    }
}

/// Looks for the border from a candidate's corners; `None` if the floor does not end there.
pub(crate) fn find(photo: &Photo, arena: Arena, corners: [[f64; 2]; 4]) -> Option<Border> {
    let straight = PlanMap::from_seen_corners(photo, arena, corners, 0.0)?;
    let lined = lined(photo, arena, corners);
    let settled = where_floor_ends(photo, arena, &straight);
    match (settled, lined) {
        (Some(settled), Some(lined)) => {
            let better = lined.value(photo) > settled.value(photo) + LINED_GAIN;
            Some(if better { lined } else { settled })
        }
        (settled, lined) => settled.or(lined),
    }
}

/// The border where the floor's colour ends, from a candidate's map.
fn where_floor_ends(photo: &Photo, arena: Arena, straight: &PlanMap) -> Option<Border> {
    let reaches = ROUGH_REACH.map(|reach| reach * photo.zoom());
    let any = Guide { change: None, without: None, camera: false };
    let rough = refine(photo, arena, straight, &reaches, any)?;
    let floor = learn_floor(photo, &rough.map, arena)?;
    let sides = Sides::measure(photo, &rough.map, arena, &floor);
    let found = choices(photo, arena, &rough.map, &sides).into_iter().filter_map(|by| {
        let border = settle(photo, arena, rough.map.clone(), &floor, (by, false))?;
        let is_odd = Viewpoint::misfit(photo, &border.map) > MOST_MISFIT;
        let border = is_odd.then(|| border.reconsidered(photo, arena)).flatten().unwrap_or(border);
        Some((border.value(photo), border))
    });
    found.max_by(|a, b| a.0.total_cmp(&b.0)).map(|(_, border)| border)
}

/// The border where the lines of a candidate are, if the floor inside reaches up to all four of them: inside the
/// outer edge of a tape or a wall there is no floor.
pub(crate) fn lined(photo: &Photo, arena: Arena, corners: [[f64; 2]; 4]) -> Option<Border> {
    let lines = PlanMap::from_seen_corners(photo, arena, corners, 0.0)?;
    let zoom = photo.zoom();
    let change = light::changes(photo, &lines, arena, LINED_BESIDE * zoom);
    let reaches = FINE_REACH[2].map(|reach| reach * zoom);
    let fit = refine(photo, arena, &lines, &reaches, Guide::by(change))?;
    let floor = learn_floor(photo, &fit.map, arena)?;
    let up_to =
        Sides::measure(photo, &fit.map, arena, &floor).floor_inside(INSIDE.map(|d| d * zoom));
    let whole = fit.shares.values().iter().all(|&share| share >= LEAST_SHARE)
        && up_to == PerSide::all(true);
    whole.then(|| Border::of(fit, change, PerSide::all(EndBy::Unlit)))
}

/// By what the floor's end may be told on the four sides: all alike, and what fits a camera best.
///
/// A wall's shadow on the floor and grey ground around a white sheet look alike on one side; four sides make a
/// rectangle of the stated size in one way only.
fn choices(photo: &Photo, arena: Arena, map: &PlanMap, sides: &Sides) -> Vec<PerSide<EndBy>> {
    let alike = [PerSide::all(EndBy::NoShadow), PerSide::all(EndBy::Unlit)];
    let [Some(shadow), Some(unlit)] = alike.map(|by| sides.ends(by)) else {
        return alike.to_vec();
    };
    let scale = map.scale_at(Point::new(arena.width / 2.0, arena.height / 2.0)).max(1.0);
    let apart =
        |side: Side| (shadow[side] - unlit[side]).abs() * scale > COLOUR_SHIFT * photo.zoom();
    let differing: Vec<Side> = Side::ALL.into_iter().filter(|&side| apart(side)).collect();
    let choices = (0..1u32 << differing.len()).map(|chosen| {
        let mut by = alike[0];
        for (_, &side) in differing.iter().enumerate().filter(|(bit, _)| chosen >> bit & 1 == 1) {
            by[side] = EndBy::Unlit;
        }
        by
    });
    let misfit = |by: &PerSide<EndBy>| {
        let moved = sides.ends(*by).and_then(|ends| moved(photo, arena, map, ends));
        moved.map_or(f64::INFINITY, |map| Viewpoint::misfit(photo, &map))
    };
    let mut tried = alike.to_vec();
    if differing.is_empty() {
        tried.truncate(1);
    }
    let best = choices.min_by(|a, b| misfit(a).total_cmp(&misfit(b)));
    tried.extend(best.filter(|by| !alike.contains(by)));
    tried
}

/// Moves a map to where the floor ends, until it stays; only as one of a `camera` if so wanted.
fn settle(
    photo: &Photo,
    arena: Arena,
    start: PlanMap,
    floor: &FloorModel,
    (by, camera): (PerSide<EndBy>, bool),
) -> Option<Border> {
    let zoom = photo.zoom();
    let (mut map, mut last) = (start, None);
    // The first pass may start from a wrong edge or without the lens; then profiles are smeared.
    for reaches in FINE_REACH {
        let sides = Sides::measure(photo, &map, arena, floor);
        let ends = sides.ends(by)?;
        let moved = moved(photo, arena, &map, ends)?;
        let guide = Guide { camera, ..Guide::by(sides.changes(ends)) };
        let fit = refine(photo, arena, &moved, &reaches.map(|reach| reach * zoom), guide)?;
        let settled = farthest(&map, &fit.map, arena) < SETTLED * zoom;
        map = fit.map.clone();
        last = Some((fit, sides.changes(ends)));
        if settled {
            break;
        }
    }
    let (fit, change) = last?;
    let (map, change) = by_colour(photo, arena, &map, floor).unwrap_or((map, change));
    Some(Border { map, ..Border::of(fit, change, by) })
}

/// The map whose sides lie where `map` has the distances `inward` from its sides, metres.
fn moved(photo: &Photo, arena: Arena, map: &PlanMap, inward: PerSide<f64>) -> Option<PlanMap> {
    let [lower, right, upper, left] = *inward.values();
    let (right, upper) = (arena.width - right, arena.height - upper);
    let corners = [(left, lower), (right, lower), (right, upper), (left, upper)];
    PlanMap::from_seen_corners(
        photo,
        arena,
        corners.map(|(x, y)| map.to_photo(Point::new(x, y))),
        map.radial(),
    )
}

/// The map with those sides moved whose floor ends elsewhere by its colour than by its light, if any.
///
/// The greatest step may be that of a shadow on the floor or the top of a wall. Shadow has the floor's
/// hue, and the faces of a wall have one hue; so where hues differ enough, the floor ends where the hue
/// changes. What no camera could see is not believed.
fn by_colour(
    photo: &Photo,
    arena: Arena,
    map: &PlanMap,
    floor: &FloorModel,
) -> Option<(PlanMap, Changes)> {
    let sides = Sides::measure(photo, map, arena, floor);
    let scale = map.scale_at(Point::new(arena.width / 2.0, arena.height / 2.0)).max(1.0);
    let least = COLOUR_SHIFT * photo.zoom() / scale;
    let shifts = sides.hue_ends().map(|end| end.filter(|shift| shift.abs() > least).unwrap_or(0.0));
    if shifts == PerSide::all(0.0) {
        return None;
    }
    let better = moved(photo, arena, map, shifts)?;
    let (before, after) = (Viewpoint::misfit(photo, map), Viewpoint::misfit(photo, &better));
    if after <= MOST_MISFIT && after + CLEAR_GAIN < before {
        return Some((better, sides.changes(shifts)));
    }
    // The top of a wall of one height all around is as good a rectangle as its foot: the inner one counts.
    if shifts.values().iter().any(|&shift| shift <= 0.0) {
        return None;
    }
    let zoom = photo.zoom();
    let change = sides.changes(shifts);
    let reaches = FOOT_REACH.map(|reach| reach * zoom);
    let foot = refine(photo, arena, &better, &reaches, Guide::by(change))?.map;
    (Viewpoint::misfit(photo, &foot) < before + CLEAR_GAIN).then_some((foot, change))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn from_a_frames_outer_edge_the_inner_one_is_found() {
        let pixels = (0..320 * 240).map(|i| {
            let (x, y) = (i % 320, i / 320);
            let frame = (40..280).contains(&x) && (30..210).contains(&y);
            let floor = (50..270).contains(&x) && (40..200).contains(&y);
            if frame && !floor { [40; 3] } else { [225; 3] }
        });
        let photo = Photo::from_rgb(320, 240, pixels.collect()).unwrap();
        let arena = Arena { width: 2.2, height: 1.6 };
        let outer = [[39.5, 209.5], [279.5, 209.5], [279.5, 29.5], [39.5, 29.5]];
        let border = find(&photo, arena, outer).unwrap();
        assert!(border.score() > 0.95 && border.residual < 0.1, "{border:?}");
        for (found, expected) in border.map.seen_corners(arena).into_iter().zip([
            [49.5, 199.5],
            [269.5, 199.5],
            [269.5, 39.5],
            [49.5, 39.5],
        ]) {
            assert!((found[0] - expected[0]).hypot(found[1] - expected[1]) < 0.2, "{found:?}");
        }
    }

    #[test]
    fn a_shadow_along_a_wall_does_not_move_the_border() {
        let pixels = (0..320 * 240).map(|i| {
            let (x, y) = (i % 320, i / 320);
            let frame = (40..280).contains(&x) && (30..210).contains(&y);
            let floor = (50..270).contains(&x) && (40..200).contains(&y);
            match (floor, frame) {
                (true, _) if y < 44 => [126, 124, 120],
                (true, _) => [225, 220, 212],
                (_, true) => [90, 50, 25],
                _ => [120, 120, 122],
            }
        });
        let photo = Photo::from_rgb(320, 240, pixels.collect()).unwrap();
        let arena = Arena { width: 2.2, height: 1.6 };
        let outer = [[39.5, 209.5], [279.5, 209.5], [279.5, 29.5], [39.5, 29.5]];
        let border = find(&photo, arena, outer).unwrap();
        // The shadow's edge lies 4 pixels from the wall's.
        for (found, y) in border.map.seen_corners(arena).into_iter().zip([199.5, 199.5, 39.5, 39.5])
        {
            assert!((found[1] - y).abs() < 1.0, "{found:?}");
        }
    }

    #[test]
    fn a_cloth_whose_sides_bend_inward_is_not_seen_through_a_lens() {
        // All sides but the lower bend inward by 5 pixels.
        let pixels = (0..640 * 480).map(|i| {
            let (x, y) = ((i % 640) as f64, (i / 640) as f64);
            let bend = |share: f64| 5.0 * (1.0 - (2.0 * share - 1.0).powi(2));
            let (across, down) = ((x - 79.5) / 480.0, (y - 79.5) / 320.0);
            let cloth = x > 79.5 + bend(down)
                && x < 559.5 - bend(down)
                && y > 79.5 + bend(across)
                && y < 399.5;
            if cloth { [225; 3] } else { [110; 3] }
        });
        let photo = Photo::from_rgb(640, 480, pixels.collect()).unwrap();
        let arena = Arena { width: 1.5, height: 1.0 };
        let corners = [[79.5, 399.5], [559.5, 399.5], [559.5, 79.5], [79.5, 79.5]];
        let found = find(&photo, arena, corners).unwrap().map;
        // A lens that bends straight sides so leaves the straight one 5 pixels outside of the cloth.
        for [x, y] in found.seen_corners(arena) {
            assert!((78.5..560.5).contains(&x) && (78.5..400.5).contains(&y), "{x} {y}");
        }
    }
}
