//! A photo as it would be over an evenly grey floor.
//!
//! Where nothing has changed and in shadow, a pixel's light is divided by that of the empty picture; on what
//! was put there, by the mean colour of the floor, since the pattern beneath it is not seen. Symbols, all
//! logarithms of linear light for each channel: p photo, e empty picture, q illumination between them, s the
//! floor without its pattern, w how surely a pixel has changed (0 to 1), g the grey of the even floor.
//!
//! `ln result = g + p − q − (1 − w) e − w s`

use super::illumination::{DARK_LIGHT, Illumination};
use crate::geometry::Arena;
use crate::vision::appearance::turned;
use crate::vision::camera::PlanMap;
use crate::vision::image::{Photo, srgb_code};

/// The light of the even floor: what is four times as bright is still told from it.
const GREY: f32 = 0.25;
/// Logarithms of light from here on in steps are brought to codes by a table.
const DARKEST: f32 = -6.0;
const STEPS: f32 = 256.0;
/// Shadow leaves at least this share of the light, a logarithm.
const DEEPEST: f32 = -1.4;
/// Light that leaves so much chroma as it was may be shadow; with twice as much it is none. Deeper shadow is
/// tinted more, by this share of its depth.
const NEUTRAL: f32 = 0.05;
const TINT: f32 = 0.12;
/// What is brighter than the empty floor by so much has changed; by half as much it may be noise.
const BRIGHTER: f32 = 0.2;

/// The photo over an even floor; `None` if nothing of the two pictures can be compared.
pub(crate) fn over_even_floor(
    photo: &Photo,
    empty: &Photo,
    map: &PlanMap,
    arena: Arena,
) -> Option<Photo> {
    let light = Illumination::between(photo, empty, map, arena)?;
    let logs = photo.code_lights().map(|value| (value + DARK_LIGHT).ln());
    let codes = codes();
    let width = photo.width();
    let (mut ratio, mut floor) = (vec![[0.0; 3]; width], vec![[0.0; 3]; width]);
    let mut pixels = Vec::with_capacity(photo.pixels().len());
    let rows = photo.pixels().chunks_exact(width).zip(empty.pixels().chunks_exact(width));
    for (y, (seen, before)) in rows.enumerate() {
        light.ratio.row(y, &mut ratio);
        light.floor.row(y, &mut floor);
        for x in 0..width {
            let change: [f32; 3] = std::array::from_fn(|part| {
                let (p, e) = (seen[x][part], before[x][part]);
                let change =
                    logs[usize::from(p)] - logs[usize::from(e)] - ratio[x][part];
                // Of light beyond white nobody knows how much it is.
                if p == u8::MAX || e == u8::MAX { unburnt(change, p, e) } else { change }
            });
            let w = changed(change);
            pixels.push(std::array::from_fn(|part| {
                let pattern = logs[usize::from(before[x][part])] - floor[x][part];
                let log = change[part] + w * pattern;
                let index = ((log - DARKEST) * STEPS).max(0.0) as usize;
                codes[index.min(codes.len() - 1)]
            }));
        }
    }
    Some(photo.with_pixels(pixels))
}

/// A change of which photo (`p`) or empty picture (`e`) is burnt out: none if it may be none.
fn unburnt(change: f32, p: u8, e: u8) -> f32 {
    let low = if e == u8::MAX { change.max(0.0).min(0.0).min(change) } else { change };
    match (p, e) {
        (u8::MAX, _) if low < 0.0 => 0.0,
        (_, u8::MAX) if low > 0.0 => 0.0,
        _ => low,
    }
}

/// How surely something stands at a pixel whose light has changed so: it is neither floor nor shadow.
fn changed(change: [f32; 3]) -> f32 {
    let [b, c, d] = turned(change);
    let allowed = NEUTRAL + TINT * (-b).clamp(0.0, -DEEPEST);
    let tint = c.abs().max(d.abs()) / allowed;
    let bright = 2.0 * b / BRIGHTER;
    let dark = 1.0 + (DEEPEST - b) / NEUTRAL;
    (tint.max(bright).max(dark) - 1.0).clamp(0.0, 1.0)
}

/// The codes of logarithms of light relative to the floor's.
fn codes() -> Vec<u8> {
    let count = ((-GREY.ln() - DARKEST) * STEPS) as usize + 1;
    (0..count).map(|index| srgb_code(GREY * (DARKEST + index as f32 / STEPS).exp())).collect()
}
