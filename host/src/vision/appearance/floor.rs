//! The colour of the floor, slowly varying over the arena, and of shadow on it.
//!
//! Colours are compared as logarithms of linear light, turned to brightness and two chroma axes: a
//! weaker light then shifts the brightness alone. The floor is a polynomial of order up to 4 in x
//! and y, fitted with re-weighting from the densest colour on, so that boxes do not pull it. Its
//! residuals give the tolerance; wood, tiles and speckle thereby widen it by themselves. How shadow
//! differs is found by [`super::shadow`].
//!
//! Deviation: the paper takes pixels near white for floor [Alghannam, Sec. II.A]; uneven light, coloured
//! floors and shadows need the model.

use super::shadow::{DEPTH_TOLERANCE, Shadow};
use crate::geometry::{Arena, Point};
use crate::vision::least_squares::geman_mcclure;
use nalgebra::{DMatrix, DVector};

/// A colour as brightness and two chroma axes, natural logarithms.
pub(crate) type Feature = [f32; 3];

/// Light below this share of white is noise.
const DARK_LEVEL: f32 = 0.03;
/// The least tolerance (one standard deviation) of brightness and of chroma.
const LEAST_SPREAD: [f32; 3] = [0.02, 0.016, 0.016];
/// Shadow is darker than lit floor by this many of the floor's standard deviations.
const LEAST_DEPTH: f32 = 5.0;
/// Shadow of unknown depth may be tinted by this share of it.
const TINT: f32 = 0.3;
/// Chroma in shadow is noisier than on lit floor, and light from other places tints it.
const SHADOW_CHROMA: f32 = 2.5;
/// The terms of a polynomial of order 4 in two variables.
const MOST_TERMS: usize = 15;
/// The order of the polynomial and the width of the inliers (standard deviations) in each round.
const ROUNDS: [(usize, f32); 7] =
    [(0, 3.0), (1, 3.0), (2, 3.0), (2, 2.5), (3, 2.5), (4, 2.5), (4, 2.5)];
/// Samples that the model is fitted to, at most.
const MOST_SAMPLES: usize = 6000;

/// Of so many samples every how many-th is used.
pub(crate) fn sample_step(count: usize) -> usize {
    count.div_ceil(MOST_SAMPLES).max(1)
}

/// The feature of a linear light.
#[inline]
pub(crate) fn feature(light: [f32; 3]) -> Feature {
    turned(light.map(|value| (value + DARK_LEVEL).ln()))
}

/// Logarithms of the light of three channels, turned to brightness and two chroma axes.
#[inline]
pub(crate) fn turned([r, g, b]: [f32; 3]) -> Feature {
    [(r + g + b) / 3.0, (r - g) / std::f32::consts::SQRT_2, (r + g - 2.0 * b) / 6f32.sqrt()]
}

/// The logarithms of the light of three channels that [`turned`] brought to these axes.
#[inline]
pub(crate) fn turned_back([b, c, d]: Feature) -> [f32; 3] {
    let (across, down) = (c / std::f32::consts::SQRT_2, d / 6f32.sqrt());
    [b + down + across, b + down - across, b - 2.0 * down]
}

/// The floor's colour over the arena.
#[derive(Clone, Debug)]
pub(crate) struct FloorModel {
    arena: Arena,
    /// Those of orders that were not fitted are 0.
    coefficients: [[f64; MOST_TERMS]; 3],
    /// Standard deviations of the three parts of the feature.
    pub(crate) spread: [f32; 3],
    /// How shadow differs from lit floor, if there is shadow.
    pub(crate) shadow: Option<Shadow>,
}

/// How a colour differs from the floor's, in standard deviations.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Difference {
    /// From lit floor.
    pub(crate) lit: f32,
    /// From lit floor, shadow or anything between, whichever is nearest.
    pub(crate) floor: f32,
    /// From full shadow; infinite if there is no shadow.
    pub(crate) core: f32,
}

impl Difference {
    /// The same, but no more than `most`.
    pub(crate) fn at_most(self, most: f32) -> Self {
        Self { lit: self.lit.min(most), floor: self.floor.min(most), core: self.core }
    }
}

impl FloorModel {
    /// The model of the floor seen in `samples` (floor point and feature); `None` without samples.
    pub(crate) fn fit(arena: Arena, samples: &[(Point, Feature)]) -> Option<Self> {
        let samples: Vec<_> = samples.iter().step_by(sample_step(samples.len())).copied().collect();
        let start = densest(&samples)?;
        let mut model = Self {
            arena,
            coefficients: [[0.0; MOST_TERMS]; 3],
            spread: [0.08, 0.04, 0.04],
            shadow: None,
        };
        for (coefficients, value) in model.coefficients.iter_mut().zip(start) {
            coefficients[0] = f64::from(value);
        }
        for (order, width) in ROUNDS {
            model.refit(&samples, (order + 1) * (order + 2) / 2, width);
        }
        Some(model)
    }

    /// The spread that the floor's grain has in other samples, such as larger cells.
    pub(crate) fn spread_of(&self, samples: &[(Point, Feature)]) -> Feature {
        let mut inliers: [Vec<f32>; 3] = Default::default();
        for &(point, seen) in samples {
            self.take_inlier(self.residual(point, seen), &mut inliers);
        }
        spread(inliers)
    }

    /// The same with another spread.
    pub(crate) fn with_spread(&self, spread: Feature) -> Self {
        Self { spread, ..self.clone() }
    }

    /// Adds a residual to lists of absolute values if it is the floor's.
    fn take_inlier(&self, residual: Feature, inliers: &mut [Vec<f32>; 3]) {
        if self.difference_of(residual).lit < 4.0 {
            inliers.iter_mut().zip(residual).for_each(|(list, value)| list.push(value.abs()));
        }
    }

    /// The lit floor's feature at a point.
    pub(crate) fn lit(&self, point: Point) -> Feature {
        let terms = self.monomials(point);
        self.coefficients.map(|row| row.iter().zip(terms).map(|(c, t)| c * t).sum::<f64>() as f32)
    }

    /// `seen` less the lit floor's feature at a point.
    pub(crate) fn residual(&self, point: Point, seen: Feature) -> Feature {
        let lit = self.lit(point);
        [seen[0] - lit[0], seen[1] - lit[1], seen[2] - lit[2]]
    }

    /// How a colour seen at a point differs from the floor's.
    pub(crate) fn difference(&self, point: Point, seen: Feature) -> Difference {
        let lit = self.lit(point);
        let residual = [seen[0] - lit[0], seen[1] - lit[1], seen[2] - lit[2]];
        let mut difference = self.difference_of(residual);
        if let Some(shadow) = self.shadow {
            let offset = shadow.at(lit);
            if self.tells_shadow(offset) {
                difference.core = self.off_shadow(residual, offset);
            }
            difference.floor = difference.lit.min(self.between(residual, offset));
        }
        difference
    }

    /// How a residual differs from that of lit floor.
    pub(crate) fn difference_of(&self, residual: Feature) -> Difference {
        let [b, c, d] = [0, 1, 2].map(|part| residual[part] / self.spread[part]);
        let lit = (b * b + c * c + d * d).sqrt();
        Difference { lit, floor: lit, core: f32::INFINITY }
    }

    /// Whether shadow of an offset can be told from lit floor.
    pub(crate) fn tells_shadow(&self, offset: Feature) -> bool {
        -offset[0] > LEAST_DEPTH * self.spread[0]
    }

    /// How far a point is from the nearest side of the floor, metres.
    pub(crate) fn inside(&self, point: Point) -> f64 {
        self.arena.depth(point)
    }

    /// How a residual differs from full shadow with an offset, in standard deviations.
    pub(crate) fn off_shadow(&self, residual: Feature, offset: Feature) -> f32 {
        let slack = DEPTH_TOLERANCE * -offset[0];
        let beyond = ((residual[0] - offset[0]).abs() - slack).max(0.0);
        self.shaded([beyond, residual[1] - offset[1], residual[2] - offset[2]], 1.0)
    }

    /// How a residual differs from anything between lit floor and a little more than full shadow.
    fn between(&self, residual: Feature, offset: Feature) -> f32 {
        let share = (residual[0] / offset[0]).clamp(0.0, 1.0 + DEPTH_TOLERANCE);
        let part = |part: usize| residual[part] - share.min(1.0) * offset[part];
        self.shaded([residual[0] - share * offset[0], part(1), part(2)], share.min(1.0))
    }

    /// How a residual differs from floor in shadow of any depth down to `deepest`.
    pub(crate) fn off_any_shadow(&self, residual: Feature, deepest: f32) -> f32 {
        let depth = residual[0].clamp(deepest, 0.0);
        let part = |part: usize| (residual[part].abs() + TINT * depth).max(0.0);
        self.shaded([residual[0] - depth, part(1), part(2)], (depth / -0.5).min(1.0))
    }

    /// The length of a difference in standard deviations, those of chroma widened by the share of shadow.
    fn shaded(&self, [b, c, d]: Feature, share: f32) -> f32 {
        let widened = 1.0 + (SHADOW_CHROMA - 1.0) * share;
        let parts =
            [b / self.spread[0], c / (widened * self.spread[1]), d / (widened * self.spread[2])];
        parts.iter().map(|part| part * part).sum::<f32>().sqrt()
    }

    fn monomials(&self, point: Point) -> [f64; MOST_TERMS] {
        let x = (2.0 * point.x / self.arena.width - 1.0).clamp(-1.15, 1.15);
        let y = (2.0 * point.y / self.arena.height - 1.0).clamp(-1.15, 1.15);
        let (x2, y2) = (x * x, y * y);
        [
            1.0,
            x,
            y,
            x2,
            x * y,
            y2,
            x2 * x,
            x2 * y,
            x * y2,
            y2 * y,
            x2 * x2,
            x2 * x * y,
            x2 * y2,
            x * y2 * y,
            y2 * y2,
        ]
    }

    /// One weighted least-squares fit with `terms` terms to the samples within `width` deviations.
    fn refit(&mut self, samples: &[(Point, Feature)], terms: usize, width: f32) {
        let mut products = [[0.0; MOST_TERMS]; MOST_TERMS];
        let mut right = [[0.0; MOST_TERMS]; 3];
        let mut inliers: [Vec<f32>; 3] = Default::default();
        for &(point, seen) in samples {
            let residual = self.residual(point, seen);
            let distance = self.difference_of(residual).lit;
            let weight = geman_mcclure(f64::from(distance / width));
            let monomials = self.monomials(point);
            let weighted = monomials.map(|monomial| weight * monomial);
            for (i, (row, factor)) in products.iter_mut().zip(weighted).take(terms).enumerate() {
                let lower = row.iter_mut().zip(monomials).take(i + 1);
                lower.for_each(|(sum, monomial)| *sum += factor * monomial);
            }
            for (right, value) in right.iter_mut().zip(seen.map(f64::from)) {
                right
                    .iter_mut()
                    .zip(weighted)
                    .take(terms)
                    .for_each(|(sum, factor)| *sum += factor * value);
            }
            self.take_inlier(residual, &mut inliers);
        }
        let mut normal = DMatrix::from_fn(terms, terms, |i, j| products[i][j]);
        for i in 0..terms {
            normal[(i, i)] += 1e-3 * samples.len() as f64 * if i > 2 { 1e-2 } else { 1e-6 };
        }
        let Some(factor) = normal.cholesky() else { return };
        for (row, right) in self.coefficients.iter_mut().zip(&right) {
            row.iter_mut()
                .zip(factor.solve(&DVector::from_column_slice(&right[..terms])).iter())
                .for_each(|(value, solved)| *value = *solved);
        }
        self.spread = spread(inliers);
    }
}

/// Standard deviations by the medians of absolute residuals.
fn spread(mut residuals: [Vec<f32>; 3]) -> Feature {
    [0, 1, 2].map(|part| (1.4826 * median(&mut residuals[part])).max(LEAST_SPREAD[part]))
}

/// The centre of the fullest cell of colour space.
fn densest(samples: &[(Point, Feature)]) -> Option<Feature> {
    const CELL: Feature = [0.15, 0.08, 0.08];
    let mut cells = std::collections::HashMap::<[i32; 3], (u32, Feature)>::new();
    for (_, seen) in samples {
        let key = [0, 1, 2].map(|part| (seen[part] / CELL[part]).round() as i32);
        let (count, sum) = cells.entry(key).or_insert((0, [0.0; 3]));
        *count += 1;
        sum.iter_mut().zip(seen).for_each(|(sum, value)| *sum += value);
    }
    let (_, (count, sum)) = cells.into_iter().max_by_key(|(key, (count, _))| (*count, *key))?;
    Some(sum.map(|value| value / count as f32))
}

/// The median; 0 for an empty list.
pub(crate) fn median(values: &mut [f32]) -> f32 {
    if values.is_empty() {
        return 0.0;
    }
    let middle = values.len() / 2;
    *values.select_nth_unstable_by(middle, f32::total_cmp).1
}

#[cfg(test)]
mod tests {
    use super::*;

    const ARENA: Arena = Arena { width: 2.0, height: 1.0 };

    fn floor_light(point: Point) -> f32 {
        (0.5 + 0.1 * point.x - 0.05 * point.y * point.y) as f32
    }

    fn samples() -> Vec<(Point, Feature)> {
        let place = |i: usize| Point::new((i % 60) as f64 / 30.0, (i / 60) as f64 / 30.0);
        let light = |point: Point| match point {
            p if p.x < 0.5 => [0.04; 3],
            p if p.x < 0.7 => [0.5 * floor_light(p); 3],
            p => [floor_light(p); 3],
        };
        (0..1800).map(|i| (place(i), feature(light(place(i))))).collect()
    }

    #[test]
    fn a_weaker_light_shifts_brightness_alone() {
        let [b0, c0, d0] = feature([0.6, 0.5, 0.4]);
        let [b1, c1, d1] = feature([0.3, 0.25, 0.2]);
        assert!(
            (b0 - b1 - 2f32.ln()).abs() < 0.08 && (c0 - c1).abs() < 0.03 && (d0 - d1).abs() < 0.03
        );
    }

    #[test]
    fn a_shadow_is_told_from_the_floor_if_it_is_deeper_than_the_floors_own_spread() {
        let model = FloorModel::fit(ARENA, &samples()).unwrap();
        let deep = |spreads: f32| [-spreads * model.spread[0], 0.0, 0.0];
        assert!(model.tells_shadow(deep(1.01 * LEAST_DEPTH)));
        assert!(!model.tells_shadow(deep(0.99 * LEAST_DEPTH)));
        assert!(!model.tells_shadow([0.0; 3]) && !model.tells_shadow([1.0, 0.0, 0.0]));
    }

    #[test]
    fn the_model_follows_the_floor_and_knows_boxes_and_shadow() {
        let mut model = FloorModel::fit(ARENA, &samples()).unwrap();
        model.shadow = Some(Shadow { offset: [-0.65, 0.0, 0.0], even: None });
        let point = Point::new(1.5, 0.5);
        assert!(model.difference(point, feature([floor_light(point); 3])).lit < 1.0);
        let dark = model.difference(point, feature([0.04; 3]));
        assert!(dark.floor > 10.0);
        let shade = model.difference(point, feature([0.5 * floor_light(point); 3]));
        assert!(shade.lit > 10.0 && shade.floor < 1.5 && shade.core < 1.5, "{shade:?} {model:?}");
        let half = model.difference(point, feature([0.75 * floor_light(point); 3]));
        assert!(half.floor < 1.5 && half.core > 6.0, "{half:?}");
    }

    #[test]
    fn axes_are_turned_there_and_back() {
        let light = [0.3, -1.2, 0.7];
        let back = turned_back(turned(light));
        assert!(light.iter().zip(back).all(|(a, b)| (a - b).abs() < 1e-6), "{back:?}");
    }

    #[test]
    fn no_samples_make_no_model() {
        assert!(FloorModel::fit(ARENA, &[]).is_none());
    }
}
