//! Rectangles around all cells that are not floor, brought to where the light is half that of the floor.
//!
//! Blur makes what is dark wider: a wall of two pixels touches four cells. Across a rectangle with floor on
//! both sides the light, averaged along it, is the floor's at both ends and departs from it in between. The
//! edges are where it has gone half of the way; what lies beyond them stays in the margin. Metres in the arena
//! frame, profiles in linear light at the photo's own resolution.

use super::refine::{Bounded, at};
use crate::geometry::{Rect, Side};
use crate::vision::appearance::{FOREIGN, Look};
use crate::vision::camera::PlanMap;
use crate::vision::image::Photo;

/// Places along a rectangle where profiles across it are taken.
const PLACES: usize = 48;
/// At least so many of them, with floor at both ends, make an edge.
const LEAST_PLACES: usize = 8;
/// How far a profile reaches beyond the rectangle, cells of the view.
const BEYOND: f64 = 2.0;
/// The distance of samples, pixels.
const SAMPLE_STEP: f64 = 0.25;
/// A profile has at most so many samples.
const MOST_SAMPLES: usize = 4000;

/// What is needed to measure edges in a photo.
pub(super) struct Tightener<'a> {
    pub(super) photo: &'a Photo,
    pub(super) map: &'a PlanMap,
    pub(super) look: &'a Look,
}

impl Tightener<'_> {
    /// The same rectangle with each edge where the light is half that of the floor; rectangle and margin
    /// together reach no less far.
    pub(super) fn tighten(&self, bounded: Bounded) -> Bounded {
        let Bounded { rect, margin } = bounded;
        let outer: [f64; 4] = rect.into();
        let mut edges = outer;
        for side in [Side::Left, Side::Lower] {
            let (low, high) = (side.edge(), side.opposite().edge());
            if let Some((from, to)) = self.half_way(rect, side) {
                (edges[low], edges[high]) = (outer[low].max(from), outer[high].min(to));
            }
        }
        let margin = [0, 1, 2, 3].map(|edge| margin[edge] + (edges[edge] - outer[edge]).abs());
        Bounded { rect: edges.into(), margin }
    }

    /// Where the mean profile across a rectangle, from `side` to the opposite one, is half-way between
    /// the floor and what differs most from it.
    fn half_way(&self, rect: Rect, side: Side) -> Option<(f64, f64)> {
        let edges: [f64; 4] = rect.into();
        let low = edges[side.edge()];
        let across = edges[side.opposite().edge()] - low;
        let beyond = BEYOND / self.look.view.scale;
        let scale = self.map.scale_at(at(rect, side, 0.5, 0.0));
        let count = ((across + 2.0 * beyond) * scale / SAMPLE_STEP) as usize;
        if !(8..MOST_SAMPLES).contains(&count) {
            return None;
        }
        let inward =
            |index: usize| (across + 2.0 * beyond) * index as f64 / (count - 1) as f64 - beyond;
        let mut sums = vec![[0.0_f32; 3]; count];
        let mut places = 0;
        for place in 0..PLACES {
            let along = (place as f64 + 0.5) / PLACES as f64;
            let is_floor = |index: usize| {
                let point = at(rect, side, along, -inward(index));
                self.look.difference_at(point).is_some_and(|difference| difference.lit <= FOREIGN)
            };
            if !is_floor(0) || !is_floor(count - 1) {
                continue;
            }
            places += 1;
            for (index, sum) in sums.iter_mut().enumerate() {
                let light =
                    self.photo.light(self.map.to_photo(at(rect, side, along, -inward(index))));
                sum.iter_mut().zip(light).for_each(|(sum, light)| *sum += light);
            }
        }
        if places < LEAST_PLACES {
            return None;
        }
        let (from, to) = crossings(&departures(&sums))?;
        let place =
            |index: f64| low + (across + 2.0 * beyond) * index / (count - 1) as f64 - beyond;
        Some((place(from), place(to)))
    }
}

/// How far each light is from the straight line between the first and the last, along the direction of that
/// which is farthest, as a share of its distance.
fn departures(lights: &[[f32; 3]]) -> Vec<f32> {
    let (Some(&first), Some(&last)) = (lights.first(), lights.last()) else { return vec![] };
    let off = |(index, light): (usize, &[f32; 3])| {
        let share = index as f32 / (lights.len() - 1).max(1) as f32;
        [0, 1, 2].map(|axis| light[axis] - first[axis] - share * (last[axis] - first[axis]))
    };
    let dot = |a: &[f32; 3], b: &[f32; 3]| a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
    let all: Vec<[f32; 3]> = lights.iter().enumerate().map(off).collect();
    let Some(most) = all.iter().max_by(|a, b| dot(a, a).total_cmp(&dot(b, b))) else {
        return vec![];
    };
    all.iter().map(|off| dot(off, most) / dot(most, most).max(1e-12)).collect()
}

/// The first and the last place, as an index with a fraction, where a share passes a half.
fn crossings(shares: &[f32]) -> Option<(f64, f64)> {
    let first = shares.iter().position(|&share| share >= 0.5).filter(|&first| first > 0)?;
    let last =
        shares.iter().rposition(|&share| share >= 0.5).filter(|&last| last + 1 < shares.len())?;
    let part = |inside: f32, outside: f32| f64::from((inside - 0.5) / (inside - outside).max(1e-6));
    let from = first as f64 - part(shares[first], shares[first - 1]);
    let to = last as f64 + part(shares[last], shares[last + 1]);
    (to > from).then_some((from, to))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_dip_is_as_wide_as_it_is_at_half_its_depth() {
        // Floor that grows brighter from 1.0 to 1.3 with a dip of 0.5 whose flanks take two samples.
        let dip = [0.0, 0.0, 0.0, 0.25, 0.5, 0.5, 0.5, 0.25, 0.0, 0.0, 0.0];
        let light = |(i, dip): (usize, &f32)| [1.0 + 0.03 * i as f32 - dip; 3];
        let lights: Vec<[f32; 3]> = dip.iter().enumerate().map(light).collect();
        let (from, to) = crossings(&departures(&lights)).unwrap();
        assert!((from - 3.0).abs() < 1e-3 && (to - 7.0).abs() < 1e-3, "{from} {to}");
    }

    #[test]
    fn even_light_has_no_edges() {
        assert_eq!(crossings(&departures(&[[0.5; 3]; 9])), None);
        assert_eq!(crossings(&departures(&[])), None);
    }
}
