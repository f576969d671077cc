//! Which of the nested edges around the arena is its border: the one where the floor ends.
//!
//! From a candidate quadrilateral the floor's colour is learnt inside. On each side the place is
//! taken where, coming from inside, the colour stops being floor or shadow; its step is then fitted
//! to a fraction of a pixel. The share of profiles that show that step, with floor inside and
//! something else outside, is the candidate's score.

use super::align::{self, Fit, PLACES, Search, side_point};
use super::floor::{Feature, FloorModel, feature};
use super::photo::Photo;
use super::plan_map::PlanMap;
use super::plan_view::{PlanFrame, cell_light};
use super::viewpoint::Viewpoint;
use crate::geometry::{Arena, Point};

/// Cells along the arena's longer side from which the floor's colour is learnt.
const FLOOR_CELLS: f64 = 160.0;
/// Of them so many at most.
const FLOOR_SAMPLES: usize = 2000;
/// How far inside and outside of the candidate's sides the floor's end is sought, share of the shorter side.
const SEARCH_SHARE: f64 = 0.1;
/// Hue tells the floor's end if it changes by this much (the two chroma axes of a feature), within this
/// many samples from the side; the light of an edge is mixed over so many samples.
const LEAST_HUE: f32 = 0.05;
const HUE_REACH: usize = 20;
const HUE_BLUR: usize = 4;
/// It counts if it lies this many pixels from the step of light, at a width of 640.
const COLOUR_SHIFT: f64 = 1.2;
/// A difference between cameras' misfits that tells, squared standard deviations.
const CLEAR_GAIN: f64 = 1.2;
/// Reaches of the search for a wall's foot, pixels at a width of 640.
const FOOT_REACH: [f64; 3] = [3.0, 2.0, 2.0];
/// A colour this many standard deviations off is not floor.
const FOREIGN: f32 = 6.0;
/// A border's shadow on the floor is at most this deep, a natural logarithm.
const DEEPEST: f32 = -1.0;
/// At the floor's end the share of foreign colour rises by at least this.
const LEAST_RISE: f64 = 0.3;
/// The distance of samples across a side, pixels.
const SAMPLE_STEP: f64 = 0.5;
/// The same for a border that was found in a reduced photo, pixels of that.
const FULL_REACH: [f64; 2] = [2.5, 2.0];
/// Lines of samples across each side, and samples of a line that are evenly apart in the photo.
const SEEN: usize = PLACES / 2;
const PIECE: usize = 12;
/// The border is found when its corners move by less than this, pixels at a width of 640.
const SETTLED: f64 = 0.15;
/// Shrinking reaches of the search for steps, pixels at a width of 640.
const ROUGH_REACH: [f64; 3] = [9.0, 5.0, 3.0];
const FINE_REACH: [[f64; 3]; 3] = [[8.0, 5.0, 3.0], [5.0, 3.0, 2.0], [4.0, 2.5, 2.0]];
/// Radial coefficients of lenses that pictures of arenas are taken with.
const RADIAL_RANGE: std::ops::Range<f64> = -0.15..0.08;
/// The lens is accepted if it brings the residual below this share of that without.
const LENS_GAIN: f64 = 0.93;

/// A border that was found.
#[derive(Clone, Debug)]
pub(crate) struct Border {
    /// The map from floor to photo.
    pub(crate) map: PlanMap,
    /// The share of profiles that show the border, 0 to 1: the mean over the sides.
    pub(crate) score: f64,
    /// The root mean square distance of the border's steps from the map, pixels.
    pub(crate) residual: f64,
    /// The change of linear light from inside to outside on each side.
    change: [[f32; 3]; 4],
}

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
        let Some(fine) = refine(photo, arena, &map, &reaches, Some(self.change)) else {
            return Some(Self { map, residual: factor * self.residual, ..self });
        };
        let score = fine.shares.iter().sum::<f64>() / 4.0;
        Some(Self { map: fine.map, score, residual: fine.residual, ..self })
    }
}

/// The place in a photo of a pixel of its copy reduced by `factor`.
pub(crate) fn enlarged(pixel: [f64; 2], factor: f64) -> [f64; 2] {
    pixel.map(|value| (value + 0.5) * factor - 0.5)
}

/// Looks for the border from a candidate's corners; `None` if the floor does not end there.
pub(crate) fn find(photo: &Photo, arena: Arena, corners: [[f64; 2]; 4]) -> Option<Border> {
    let zoom = zoom(photo);
    let straight = PlanMap::from_seen_corners(photo, arena, corners, 0.0)?;
    let rough = refine(photo, arena, &straight, &ROUGH_REACH.map(|reach| reach * zoom), None)?;
    let floor = learn_floor(photo, &rough.map, arena)?;
    let (mut fine, mut change) = (rough, [[0.0; 3]; 4]);
    // The first pass may start from a wrong edge or without the lens; then profiles are smeared.
    for reaches in FINE_REACH {
        let sides = Sides::measure(photo, &fine.map, arena, &floor);
        let ends = sides.ends()?;
        let moved = moved(photo, arena, &fine.map, ends)?;
        let reaches = reaches.map(|reach| reach * zoom);
        change = sides.changes(ends);
        let next = refine(photo, arena, &moved, &reaches, Some(change))?;
        let settled = farthest(&fine.map, &next.map, arena) < SETTLED * zoom;
        fine = next;
        if settled {
            break;
        }
    }
    let score = fine.shares.iter().sum::<f64>() / 4.0;
    let residual = fine.residual;
    let (map, change) = by_colour(photo, arena, &fine.map, &floor).unwrap_or((fine.map, change));
    Some(Border { map, score, residual, change })
}

/// How much wider a photo is than those that lengths in pixels are stated for.
fn zoom(photo: &Photo) -> f64 {
    (photo.width() as f64 / 640.0).max(1.0)
}

/// How far the farthest corner of two maps is apart, pixels.
fn farthest(a: &PlanMap, b: &PlanMap, arena: Arena) -> f64 {
    let pairs = a.seen_corners(arena).into_iter().zip(b.seen_corners(arena));
    pairs.map(|(a, b)| (a[0] - b[0]).hypot(a[1] - b[1])).fold(0.0, f64::max)
}

/// The map whose sides lie where `map` has the distances `inward` from its sides, metres.
fn moved(photo: &Photo, arena: Arena, map: &PlanMap, inward: [f64; 4]) -> Option<PlanMap> {
    let [lower, right, upper, left] = inward;
    let (right, upper) = (arena.width - right, arena.height - upper);
    let corners = [(left, lower), (right, lower), (right, upper), (left, upper)];
    PlanMap::from_seen_corners(
        photo,
        arena,
        corners.map(|(x, y)| map.to_photo(Point::new(x, y))),
        map.radial(),
    )
}

/// Fits the map to the steps found within shrinking reaches, with the lens if that fits better.
///
/// `change` is the light's change from inside to outside on each side, if it is known.
fn refine(
    photo: &Photo,
    arena: Arena,
    start: &PlanMap,
    reaches: &[f64],
    change: Option<[[f32; 3]; 4]>,
) -> Option<Fit> {
    let mut best: Option<Fit> = None;
    for lens in [false, true] {
        let mut map = start.clone();
        let mut last = None;
        for (round, &reach) in reaches.iter().enumerate() {
            // The last round decides; for those before it half of the profiles are enough.
            let stride = if round + 1 == reaches.len() { 1 } else { 2 };
            let steps = align::steps(photo, &map, arena, &Search { reach, change }, stride);
            let fit = align::fit(photo, arena, &map, &steps, reach, lens, stride)
                .filter(|fit| near(start, &fit.map, arena, reaches));
            let Some(fit) = fit else {
                last = None;
                break;
            };
            map = fit.map.clone();
            last = Some(fit);
        }
        let Some(fit) = last else { continue };
        let better = best.as_ref().is_none_or(|best| {
            let gain = |fit: &Fit| fit.residual / fit.shares.iter().sum::<f64>().max(1e-6);
            gain(&fit) < LENS_GAIN * gain(best)
        });
        if better {
            best = Some(fit);
        }
    }
    best
}

/// Whether a fitted map is still the candidate's: its corners lie where steps were sought, its lens is one.
fn near(start: &PlanMap, fitted: &PlanMap, arena: Arena, reaches: &[f64]) -> bool {
    let most = 3.0 * reaches.iter().copied().fold(0.0, f64::max);
    farthest(start, fitted, arena) < most && RADIAL_RANGE.contains(&fitted.radial())
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
) -> Option<(PlanMap, [[f32; 3]; 4])> {
    let sides = Sides::measure(photo, map, arena, floor);
    let scale = map.scale_at(Point::new(arena.width / 2.0, arena.height / 2.0)).max(1.0);
    let least = COLOUR_SHIFT * zoom(photo) / scale;
    let shifts = sides.hue_ends().map(|end| end.filter(|shift| shift.abs() > least).unwrap_or(0.0));
    if shifts == [0.0; 4] {
        return None;
    }
    let better = moved(photo, arena, map, shifts)?;
    let (before, after) = (Viewpoint::misfit(photo, map), Viewpoint::misfit(photo, &better));
    if after + CLEAR_GAIN < before {
        return Some((better, sides.changes(shifts)));
    }
    // The top of a wall of one height all around is as good a rectangle as its foot: the inner one counts.
    if shifts.iter().any(|&shift| shift <= 0.0) {
        return None;
    }
    let zoom = zoom(photo);
    let change = sides.changes(shifts);
    let reaches = FOOT_REACH.map(|reach| reach * zoom);
    let foot = refine(photo, arena, &better, &reaches, Some(change))?.map;
    (Viewpoint::misfit(photo, &foot) < before + CLEAR_GAIN).then_some((foot, change))
}

/// What is seen across the four sides.
struct Sides {
    /// Metres inward of the samples, from inside to outside.
    inward: Vec<f64>,
    /// For each side and sample: the share of places that are not floor.
    foreign: [Vec<f64>; 4],
    /// For each side and sample: the median light.
    light: [Vec<[f32; 3]>; 4],
}

impl Sides {
    fn measure(photo: &Photo, map: &PlanMap, arena: Arena, floor: &FloorModel) -> Self {
        let scale = map.scale_at(side_point(arena, 0, 0.5, arena.height / 2.0)).max(1.0);
        let reach = SEARCH_SHARE * arena.width.min(arena.height);
        let pieces = (2.0 * reach * scale / SAMPLE_STEP / PIECE as f64).ceil().max(1.0) as usize;
        let inward = |index: usize| reach - index as f64 * SAMPLE_STEP / scale;
        let count = pieces * PIECE;
        let mut sides = Self {
            inward: (0..count).map(inward).collect(),
            foreign: Default::default(),
            light: Default::default(),
        };
        for side in 0..4 {
            let mut foreign = vec![0usize; count];
            let mut lights: [Vec<f32>; 3] = std::array::from_fn(|_| vec![0.0; count * SEEN]);
            for place in 0..SEEN {
                let along = align::along(2 * place);
                // Over a piece places in the photo and the floor's colour change evenly.
                let node = |piece: usize| {
                    let point = side_point(arena, side, along, inward(piece * PIECE));
                    (map.to_photo(point), floor.lit(point))
                };
                let mut end = node(0);
                for piece in 0..pieces {
                    let start = std::mem::replace(&mut end, node(piece + 1));
                    for within in 0..PIECE {
                        let (pixel, lit) = between(start, end, within as f64 / PIECE as f64);
                        let light = photo.light(pixel);
                        let [b, c, d] = feature(light);
                        let residual = [b - lit[0], c - lit[1], d - lit[2]];
                        let index = piece * PIECE + within;
                        foreign[index] +=
                            usize::from(floor.off_any_shadow(residual, DEEPEST) > FOREIGN);
                        for (list, value) in lights.iter_mut().zip(light) {
                            list[index * SEEN + place] = value;
                        }
                    }
                }
            }
            sides.foreign[side] = foreign.iter().map(|&seen| seen as f64 / SEEN as f64).collect();
            let mut median = |channel: usize, index: usize| {
                super::floor::median(&mut lights[channel][index * SEEN..(index + 1) * SEEN])
            };
            sides.light[side] =
                (0..count).map(|index| [0, 1, 2].map(|channel| median(channel, index))).collect();
        }
        sides
    }

    /// Where the floor ends on each side, metres inward of the map's sides.
    fn ends(&self) -> Option<[f64; 4]> {
        let mut ends = [0.0; 4];
        for (end, foreign) in ends.iter_mut().zip(&self.foreign) {
            let inside = &foreign[..foreign.len() / 3];
            let base = inside.iter().sum::<f64>() / inside.len().max(1) as f64;
            let most = foreign.iter().copied().fold(base, f64::max);
            if most < base + LEAST_RISE {
                return None;
            }
            let level = base + 0.5 * (most - base);
            let lasting = 3;
            let index = foreign
                .windows(lasting)
                .position(|window| window.iter().all(|&share| share > level))?;
            *end = self.inward[index];
        }
        Some(ends)
    }

    /// Where the hue changes on each side, metres inward, if it does clearly.
    fn hue_ends(&self) -> [Option<f64>; 4] {
        [0, 1, 2, 3].map(|side| self.hue_end(side))
    }

    fn hue_end(&self, side: usize) -> Option<f64> {
        let light = &self.light[side];
        let zero = self.inward.iter().position(|&depth| depth <= 0.0)?;
        let hue = |light: [f32; 3]| {
            let [_, c, d] = feature(light);
            [c, d]
        };
        let within = zero.checked_sub(HUE_REACH)?..light.len().min(zero + HUE_REACH);
        let start = within.start;
        let floor = hue(*light.get(start)?);
        let far = |index: usize| {
            let [c, d] = hue(light[index]);
            (c - floor[0]).hypot(d - floor[1])
        };
        let most = within.clone().max_by(|&a, &b| far(a).total_cmp(&far(b)))?;
        let contrast = far(most);
        if contrast < LEAST_HUE {
            return None;
        }
        let [c, d] = hue(light[most]);
        let axis = [(c - floor[0]) / contrast, (d - floor[1]) / contrast];
        let along = |light: [f32; 3]| {
            let [c, d] = hue(light);
            (c - floor[0]) * axis[0] + (d - floor[1]) * axis[1]
        };
        // The hue of light that is half floor and half border, both as bright as they are near by.
        let lead = |index: usize| {
            let (inside, outside) = (light[index - HUE_BLUR], light[index + HUE_BLUR]);
            let half = [0, 1, 2].map(|channel| (inside[channel] + outside[channel]) / 2.0);
            let clear = along(outside) - along(inside) > 0.5 * contrast;
            clear.then(|| along(light[index]) - along(half))
        };
        let mut indices = start + HUE_BLUR..within.end.saturating_sub(HUE_BLUR);
        let index = indices.find(|&index| lead(index).is_some_and(|lead| lead >= 0.0))?;
        Some(self.inward[index])
    }

    /// The change of light across the floor's end on each side.
    fn changes(&self, ends: [f64; 4]) -> [[f32; 3]; 4] {
        [0, 1, 2, 3].map(|side| {
            let end = self.inward.iter().position(|&depth| depth <= ends[side]).unwrap_or(0);
            let at = |offset: i64| {
                let index = (end as i64 + offset).clamp(0, self.inward.len() as i64 - 1) as usize;
                self.light[side][index]
            };
            let (inside, outside) = (at(-5), at(4));
            [0, 1, 2].map(|channel| outside[channel] - inside[channel])
        })
    }
}

/// A pixel and the floor's colour there, at a share of the way between two of them.
fn between(
    (from, first): ([f64; 2], Feature),
    (to, last): ([f64; 2], Feature),
    share: f64,
) -> ([f64; 2], Feature) {
    let part = share as f32;
    (
        [from[0] + share * (to[0] - from[0]), from[1] + share * (to[1] - from[1])],
        [0, 1, 2].map(|axis| first[axis] + part * (last[axis] - first[axis])),
    )
}

/// The floor's colour inside a candidate.
fn learn_floor(photo: &Photo, map: &PlanMap, arena: Arena) -> Option<FloorModel> {
    let frame =
        PlanFrame { arena, scale: FLOOR_CELLS / arena.width.max(arena.height), margin: 0.0 };
    let light = cell_light(photo, map, &frame);
    let (width, height) = frame.size();
    let count = width * height;
    // A step that no row is a multiple of, lest samples stand in few columns.
    let step = count.div_ceil(FLOOR_SAMPLES).max(1);
    let step = if width.is_multiple_of(step) && step > 1 { step + 1 } else { step };
    let sample = |index: usize| {
        let (column, row) = (index % width, index / width);
        (frame.point(column as f64, row as f64), feature(light(column, row)))
    };
    FloorModel::fit(arena, &(0..count).step_by(step).map(sample).collect::<Vec<_>>())
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
        assert!(border.score > 0.95 && border.residual < 0.1, "{border:?}");
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
}
