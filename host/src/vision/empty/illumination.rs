//! What the light of a photo is to the light of the empty picture where nothing has changed.
//!
//! `ln p(x, y) − ln e(x, y) = q(x, y)` for each channel, with p and e the linear light of photo and empty
//! picture and q a polynomial of order 4 over the arena: exposure and white balance are its constants, the
//! lamps' brightness and vignetting its slow rest. It is fitted to the densest ratio from there on, so that
//! boxes, shadows and the robot do not pull it: the model is that of the floor's colour.

use crate::geometry::{Arena, Point};
use crate::vision::appearance::{FloorModel, median, turned, turned_back};
use crate::vision::camera::PlanMap;
use crate::vision::image::Photo;

/// Places along each side of the arena where the pictures are compared.
const PLACES: usize = 80;
/// Light below this share of white is noise.
pub(super) const DARK_LIGHT: f32 = 0.004;
/// Light above this share of white may be burnt out.
const BRIGHT_LIGHT: f32 = 0.97;
/// Pixels between the nodes of a smooth field.
const STEP: usize = 16;
/// Pixels around a place whose light is averaged.
const AROUND: [f64; 3] = [-1.0, 0.0, 1.0];

/// Logarithms of light that vary slowly over a photo, known at every so many-th pixel.
pub(super) struct Field {
    columns: usize,
    nodes: Vec<[f32; 3]>,
}

/// The smooth light of an arena seen in two pictures.
pub(super) struct Illumination {
    /// The photo's light over the empty picture's.
    pub(super) ratio: Field,
    /// The colour of the empty floor without its pattern.
    pub(super) floor: Field,
}

impl Illumination {
    /// The illumination of a photo by that of the empty picture; `None` if nothing can be compared.
    pub(super) fn between(
        photo: &Photo,
        empty: &Photo,
        map: &PlanMap,
        arena: Arena,
    ) -> Option<Self> {
        let (mut ratios, mut floor) = (Vec::new(), Vec::new());
        for index in 0..PLACES * PLACES {
            let share = |index: usize| (index as f64 + 0.5) / PLACES as f64;
            let point = Point::new(
                share(index % PLACES) * arena.width,
                share(index / PLACES) * arena.height,
            );
            let pixel = map.to_photo(point);
            let (seen, before) = (mean(photo, pixel), mean(empty, pixel));
            let ln = |light: [f32; 3]| light.map(|value| (value + DARK_LIGHT).ln());
            floor.push((point, turned(ln(before))));
            if seen.iter().chain(&before).all(|value| *value < BRIGHT_LIGHT) {
                let ([a, b, c], [d, e, f]) = (ln(seen), ln(before));
                ratios.push((point, turned([a - d, b - e, c - f])));
            }
        }
        if ratios.is_empty() {
            ratios = floor.iter().map(|&(point, _)| (point, [0.0; 3])).collect();
        }
        let ratio = FloorModel::fit(arena, &ratios)?;
        let floor = FloorModel::fit(arena, &floor)?;
        let field = |model: &FloorModel| {
            Field::of(photo, |pixel| turned_back(model.lit(map.to_floor(pixel))))
        };
        Some(Self { ratio: field(&ratio), floor: field(&floor) })
    }
}

impl Illumination {
    /// How light the photo shows the floor, 0 to 1: the brightness in the middle of the arena's range.
    pub(super) fn brightness(&self) -> f32 {
        let lights = self.ratio.nodes.iter().zip(&self.floor.nodes);
        let mut logs: Vec<f32> =
            lights.map(|(ratio, floor)| turned(*ratio)[0] + turned(*floor)[0]).collect();
        median(&mut logs).exp()
    }
}

/// The mean light of the pixels around a place.
fn mean(photo: &Photo, [x, y]: [f64; 2]) -> [f32; 3] {
    let mut sum = [0f32; 3];
    for (dx, dy) in AROUND.into_iter().flat_map(|dy| AROUND.map(|dx| (dx, dy))) {
        let light = photo.light([x + dx, y + dy]);
        sum.iter_mut().zip(light).for_each(|(sum, light)| *sum += light);
    }
    sum.map(|sum| sum / (AROUND.len() * AROUND.len()) as f32)
}

impl Field {
    /// The field of `value(pixel)` over a photo.
    fn of(photo: &Photo, value: impl Fn([f64; 2]) -> [f32; 3]) -> Self {
        let count = |length: usize| length.div_ceil(STEP) + 1;
        let (columns, rows) = (count(photo.width()), count(photo.height()));
        let node = |index: usize| [index % columns * STEP, index / columns * STEP];
        let at = |index: usize| value(node(index).map(|place| place as f64));
        Self { columns, nodes: (0..columns * rows).map(at).collect() }
    }

    /// The field along row `y`, linear between the nodes, into `line`.
    pub(super) fn row(&self, y: usize, line: &mut [[f32; 3]]) {
        let share = (y % STEP) as f32 / STEP as f32;
        let above = self.nodes.chunks_exact(self.columns).nth(y / STEP).unwrap_or(&[]);
        let below = self.nodes.chunks_exact(self.columns).nth(y / STEP + 1).unwrap_or(above);
        let mut nodes = above.iter().zip(below).map(|(a, b)| mix(*a, *b, share));
        let mut left = nodes.next().unwrap_or_default();
        for (piece, right) in line.chunks_mut(STEP).zip(nodes) {
            let change = [0, 1, 2].map(|part| (right[part] - left[part]) / STEP as f32);
            for (index, value) in piece.iter_mut().enumerate() {
                *value = [0, 1, 2].map(|part| left[part] + index as f32 * change[part]);
            }
            left = right;
        }
    }
}

fn mix(a: [f32; 3], b: [f32; 3], share: f32) -> [f32; 3] {
    [0, 1, 2].map(|part| a[part] + share * (b[part] - a[part]))
}
