//! The light across the four sides of a border: how it changes there, and what lies beside.
//!
//! Medians over many places of a side, so that boxes on it do not count. Lengths are pixels at a longer side of 640,
//! `zoom` times as many in wider pictures; light is linear.

use crate::geometry::{Arena, PerSide, Side};
use crate::vision::appearance::median;
use crate::vision::camera::PlanMap;
use crate::vision::camera::border_fit::{self, along, side_point};
use crate::vision::image::Photo;

/// Places on a side where the light is compared.
const PLACES: usize = 40;
/// Lines along which edges in company of the border are searched for: their distance and how far to both sides of each
/// light is compared, pixels at a longer side of 640.
const SCAN_STEP: f64 = 0.5;
const SCAN_BESIDE: f64 = 1.5;
/// How many lines the greatest change may lie from the map, and how many from that one others count.
const SCAN_PEAK: i64 = 5;
const SCAN_COMPANY: std::ops::RangeInclusive<i64> = 5..=10;
/// Changes of at least this share of the greatest are as great.
const PLATEAU: f32 = 0.999;
/// How far to both sides of a border other edges are compared with it, lines.
const SCAN_AROUND: i64 = 24;
/// Within so many lines an edge is the border.
const SCAN_AT: i64 = 4;

/// For each side how much of another edge is seen close beside the one that was found: 0 where there is none.
///
/// Blur spreads a lone edge evenly to both its sides. Where a wall's shadow, foot and top follow each other within
/// a few pixels, the change of light is uneven about the greatest; its excess, as a share of that, is returned.
pub(crate) fn company(photo: &Photo, map: &PlanMap, arena: Arena, zoom: f64) -> PerSide<f64> {
    let span = SCAN_PEAK + *SCAN_COMPANY.end();
    PerSide::from_fn(|side| {
        let changes = scan(photo, map, arena, side, (span, zoom));
        let at = |places: i64| changes[(places + span) as usize];
        // A sharp edge makes a plateau, whose middle counts.
        let most = (-SCAN_PEAK..=SCAN_PEAK).map(at).fold(0.0, f32::max);
        let top = |line: &i64| at(*line) >= PLATEAU * most;
        let first = (-SCAN_PEAK..=SCAN_PEAK).find(top).unwrap_or(0);
        let last = (-SCAN_PEAK..=SCAN_PEAK).rfind(top).unwrap_or(0);
        let peak = (first + last).div_euclid(2);
        let excess = SCAN_COMPANY.map(|off| (at(peak + off) - at(peak - off)).abs());
        f64::from(excess.fold(0.0, f32::max) / at(peak).max(f32::MIN_POSITIVE))
    })
}

/// The change of light from inside to outside of each side, in the median.
pub(crate) fn changes(
    photo: &Photo,
    map: &PlanMap,
    arena: Arena,
    beside: f64,
) -> PerSide<[f32; 3]> {
    PerSide::from_fn(|side| change(photo, map, arena, side, (0.0, beside)))
}

/// How bright the ground `beside` each side is as a share of the floor as far inside, in the median over the side.
pub(crate) fn ground(photo: &Photo, map: &PlanMap, arena: Arena, beside: f64) -> PerSide<f64> {
    PerSide::from_fn(|side| {
        let scale = map.scale_at(side_point(arena, side, 0.5, 0.0)).max(1e-6);
        let brightness = |inward: f64| {
            let place = |place: usize| {
                let along = along(place * border_fit::PLACES / PLACES);
                let point = side_point(arena, side, along, inward / scale);
                photo.light(map.to_photo(point)).iter().sum::<f32>()
            };
            f64::from(median(&mut (0..PLACES).map(place).collect::<Vec<_>>()))
        };
        brightness(-beside) / brightness(beside).max(f64::MIN_POSITIVE)
    })
}

/// The change of light across a line `inward` of a side, from `beside` it to as far beyond, pixels; in the
/// median over the side.
fn change(
    photo: &Photo,
    map: &PlanMap,
    arena: Arena,
    side: Side,
    (inward, beside): (f64, f64),
) -> [f32; 3] {
    let scale = map.scale_at(side_point(arena, side, 0.5, 0.0)).max(1e-6);
    let mut lists: [Vec<f32>; 3] = Default::default();
    for place in 0..PLACES {
        let along = along(place * border_fit::PLACES / PLACES);
        let light =
            |pixels: f64| photo.light(map.to_photo(side_point(arena, side, along, pixels / scale)));
        let (inside, outside) = (light(inward + beside), light(inward - beside));
        for (channel, list) in lists.iter_mut().enumerate() {
            list.push(outside[channel] - inside[channel]);
        }
    }
    lists.map(|mut list| median(&mut list))
}

/// For each side the greatest change of light at it, as a share of the greatest near it.
pub(crate) fn shown(photo: &Photo, map: &PlanMap, arena: Arena) -> PerSide<f64> {
    let zoom = photo.zoom();
    PerSide::from_fn(|side| {
        let changes = scan(photo, map, arena, side, (SCAN_AROUND, zoom));
        let greatest = |changes: &[f32]| changes.iter().copied().fold(0.0, f32::max);
        let at = SCAN_AROUND - SCAN_AT..=SCAN_AROUND + SCAN_AT;
        let here = greatest(&changes[*at.start() as usize..=*at.end() as usize]);
        f64::from(here / greatest(&changes).max(f32::MIN_POSITIVE))
    })
}

/// The change of light across each of `span` lines outside of a side, at it, and as many inside.
fn scan(
    photo: &Photo,
    map: &PlanMap,
    arena: Arena,
    side: Side,
    (span, zoom): (i64, f64),
) -> Vec<f32> {
    let change = |line: i64| {
        let place = (line as f64 * SCAN_STEP * zoom, SCAN_BESIDE * zoom);
        let change = change(photo, map, arena, side, place);
        change.into_iter().fold(0.0, |most: f32, value| most.max(value.abs()))
    };
    (-span..=span).map(change).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    const ARENA: Arena = Arena { width: 1.6, height: 1.2 };

    /// A floor with a dark border, at 200 pixels a metre, whose left side has a shadow of so many pixels.
    fn drawn(shadow: usize) -> Photo {
        let pixel = |i: usize| {
            let (x, y) = (i % 480, i / 480);
            let floor = (80..400).contains(&x) && (60..300).contains(&y);
            let border = (70..410).contains(&x) && (50..310).contains(&y);
            match (floor, border) {
                (true, _) if x < 80 + shadow => [120; 3],
                (true, _) => [220; 3],
                (_, true) => [40; 3],
                _ => [150; 3],
            }
        };
        Photo::from_rgb(480, 360, (0..480 * 360).map(pixel).collect()).unwrap()
    }

    fn map(photo: &Photo, shift: f64) -> PlanMap {
        let corners = [[79.5, 299.5], [399.5, 299.5], [399.5, 59.5], [79.5, 59.5]];
        let corners = corners.map(|[x, y]| [x + shift, y - shift]);
        PlanMap::from_seen_corners(photo, ARENA, corners, 0.0).unwrap()
    }

    #[test]
    fn the_border_is_seen_where_it_is_and_not_beside_it() {
        let photo = drawn(0);
        assert!(shown(&photo, &map(&photo, 0.0), ARENA).values().iter().all(|&share| share > 0.95));
        let beside = shown(&photo, &map(&photo, 6.0), ARENA);
        assert!(beside.values().iter().all(|&share| share < 0.2), "{beside:?}");
    }

    #[test]
    fn the_ground_is_compared_with_the_floor() {
        let photo = drawn(0);
        // sRGB 40 and 220 in linear light: 0.0212 and 0.7157.
        for share in *ground(&photo, &map(&photo, 0.0), ARENA, 5.0).values() {
            assert!((share - 0.0212 / 0.7157).abs() < 1e-3, "{share}");
        }
    }

    #[test]
    fn only_the_side_with_a_shadow_has_company() {
        let photo = drawn(4);
        let [lower, right, upper, left] = *company(&photo, &map(&photo, 0.0), ARENA, 1.0).values();
        assert!(left > 0.2 && lower.max(right).max(upper) < 0.05, "{left} {lower} {right} {upper}");
    }
}
