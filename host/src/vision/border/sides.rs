//! What is seen across the four sides of a quadrilateral that may be the arena's border: where the floor
//! ends by its colour, and how light and hue change there.
//!
//! Lines of samples run across each side from inside to outside; over the lines of a side, light is the
//! median and "not floor" a share, so that boxes on the border do not count as long as half of it is seen.

use crate::geometry::{Arena, PerSide, Side};
use crate::vision::appearance::{Feature, FloorModel, feature, median};
use crate::vision::camera::PlanMap;
use crate::vision::camera::border_fit::{self, PLACES, side_point};
use crate::vision::image::Photo;
use crate::vision::plan_view::{PlanFrame, cell_light};

/// Cells along the arena's longer side from which the floor's colour is learnt.
const FLOOR_CELLS: f64 = 160.0;
/// Of them so many at most.
const FLOOR_SAMPLES: usize = 2000;
/// How far inside and outside of the candidate's sides the floor's end is searched for, share of the shorter side.
const SEARCH_SHARE: f64 = 0.1;
/// Hue tells the floor's end if it changes by this much (the two chroma axes of a feature), within this
/// many samples from the side; the light of an edge is mixed over so many samples.
const LEAST_HUE: f32 = 0.05;
const HUE_REACH: usize = 20;
const HUE_BLUR: usize = 4;
/// A colour this many standard deviations off is not floor.
const FOREIGN: f32 = 6.0;
/// A border's shadow on the floor is at most this deep, a natural logarithm.
const DEEPEST: f32 = -1.0;
/// At the floor's end the share of foreign colour rises by at least this.
const LEAST_RISE: f64 = 0.3;
/// So many samples in a row must be foreign.
const LASTING: usize = 3;
/// The distance of samples across a side, pixels.
const SAMPLE_STEP: f64 = 0.5;
/// Lines of samples across each side, and samples of a line that are evenly apart in the photo.
const SEEN: usize = PLACES / 2;
const PIECE: usize = 12;

/// By what the floor's end on a side is told.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum EndBy {
    /// What no shadow on the floor looks like: walls, tape, coloured ground, also behind a border's shadow. Where
    /// there is nothing such, as for [`EndBy::Unlit`].
    NoShadow,
    /// Whatever is not lit floor: grey ground around a white sheet looks like its shadow.
    Unlit,
}

/// What is seen across the four sides.
pub(crate) struct Sides {
    /// Metres inward of the samples, from inside to outside.
    inward: Vec<f64>,
    /// For each side and sample: the share of places that are not floor, lit or in shadow.
    foreign: PerSide<Vec<f64>>,
    /// For each side and sample: the share of places that are not lit floor.
    unlit: PerSide<Vec<f64>>,
    /// For each side and sample: the median light.
    light: PerSide<Vec<[f32; 3]>>,
}

impl Sides {
    /// Looks across the sides of a map with the floor's colour.
    pub(crate) fn measure(photo: &Photo, map: &PlanMap, arena: Arena, floor: &FloorModel) -> Self {
        let scale = map.scale_at(side_point(arena, Side::Lower, 0.5, arena.height / 2.0)).max(1.0);
        let reach = SEARCH_SHARE * arena.width.min(arena.height);
        let pieces = (2.0 * reach * scale / SAMPLE_STEP / PIECE as f64).ceil().max(1.0) as usize;
        let inward = |index: usize| reach - index as f64 * SAMPLE_STEP / scale;
        let count = pieces * PIECE;
        let mut sides = Self {
            inward: (0..count).map(inward).collect(),
            foreign: Default::default(),
            unlit: Default::default(),
            light: Default::default(),
        };
        for side in Side::ALL {
            let (mut foreign, mut unlit) = (vec![0usize; count], vec![0usize; count]);
            let mut lights: [Vec<f32>; 3] = std::array::from_fn(|_| vec![0.0; count * SEEN]);
            for place in 0..SEEN {
                let along = border_fit::along(2 * place);
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
                        let shadow = floor.off_any_shadow(residual, DEEPEST);
                        foreign[index] += usize::from(shadow > FOREIGN);
                        unlit[index] += usize::from(floor.difference_of(residual).lit > FOREIGN);
                        for (list, value) in lights.iter_mut().zip(light) {
                            list[index * SEEN + place] = value;
                        }
                    }
                }
            }
            let shares = |seen: Vec<usize>| seen.iter().map(|&n| n as f64 / SEEN as f64).collect();
            (sides.foreign[side], sides.unlit[side]) = (shares(foreign), shares(unlit));
            let mut middle = |channel: usize, index: usize| {
                median(&mut lights[channel][index * SEEN..(index + 1) * SEEN])
            };
            sides.light[side] =
                (0..count).map(|index| [0, 1, 2].map(|channel| middle(channel, index))).collect();
        }
        sides
    }

    /// Where the floor ends on each side, metres inward of the map's sides, by what is taken for its end there.
    pub(crate) fn ends(&self, by: PerSide<EndBy>) -> Option<PerSide<f64>> {
        let mut ends = PerSide::all(0.0);
        for side in Side::ALL {
            let (foreign, unlit) = (&self.foreign[side], &self.unlit[side]);
            let index = match by[side] {
                EndBy::NoShadow => lasting_rise(foreign).or_else(|| lasting_rise(unlit)),
                EndBy::Unlit => lasting_rise(unlit),
            };
            ends[side] = self.inward[index?];
        }
        Some(ends)
    }

    /// Whether most of what lies between two distances inside of each side, pixels, is lit floor.
    pub(crate) fn floor_inside(&self, [from, to]: [f64; 2]) -> PerSide<bool> {
        let per_sample = |pixels: f64| (pixels / SAMPLE_STEP) as usize;
        let zero = self.inward.iter().position(|&depth| depth <= 0.0).unwrap_or(0);
        let range = zero.saturating_sub(per_sample(to))..zero.saturating_sub(per_sample(from));
        PerSide::from_fn(|side| {
            let shares = self.unlit[side].get(range.clone()).unwrap_or_default();
            shares.iter().sum::<f64>() < 0.5 * shares.len() as f64
        })
    }

    /// Where the hue changes on each side, metres inward, if it does clearly.
    pub(crate) fn hue_ends(&self) -> PerSide<Option<f64>> {
        PerSide::from_fn(|side| self.hue_end(side))
    }

    fn hue_end(&self, side: Side) -> Option<f64> {
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
    pub(crate) fn changes(&self, ends: PerSide<f64>) -> PerSide<[f32; 3]> {
        PerSide::from_fn(|side| {
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

/// Where shares rise to stay, coming from inside; `None` if they do not clearly.
fn lasting_rise(shares: &[f64]) -> Option<usize> {
    let inside = &shares[..shares.len() / 3];
    let base = inside.iter().sum::<f64>() / inside.len().max(1) as f64;
    let most = shares.iter().copied().fold(base, f64::max);
    let level = base + 0.5 * (most - base);
    let lasts = |window: &[f64]| window.iter().all(|&share| share > level);
    let rises = most >= base + LEAST_RISE;
    shares.windows(LASTING).position(lasts).filter(|_| rises)
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
pub(crate) fn learn_floor(photo: &Photo, map: &PlanMap, arena: Arena) -> Option<FloorModel> {
    let frame = PlanFrame::new(arena, FLOOR_CELLS / arena.width.max(arena.height), 0.0);
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
