//! How two cameras' colours of the same floor differ: by exposure and white balance, which add a constant
//! to a logarithm of light, and by vignetting, which takes c ρ² from its brightness.
//!
//! | symbol | meaning | unit |
//! |---|---|---|
//! | d | first colour less second at a floor point | natural logarithm |
//! | a | exposure and white balance, first over second | natural logarithm |
//! | c | fall of brightness from the middle of a picture to its corner | natural logarithm |
//! | ρ | distance from the picture's middle over that of its corner | – |
//!
//! Brightness obeys d = a − c₁ ρ₁² + c₂ ρ₂², chroma d = a. Highlights, which move with the camera, and
//! boxes differ otherwise: they count less and less (Geman and McClure's weight).

use crate::vision::appearance::{Feature, median};
use crate::vision::least_squares::{NormalEquations, geman_mcclure};
use nalgebra::Vector3;

const ROUNDS: usize = 10;
/// Differences this many times the usual one count a quarter.
const WIDTH: f64 = 2.0;
/// The least usual difference, a natural logarithm.
const LEAST_SPREAD: f64 = 0.01;
/// A usual c, its spread, and how many samples that knowledge weighs.
const USUAL_FALL: f64 = 0.15;
const KNOWLEDGE: f64 = 0.01;

/// A floor point that both pictures show.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Sample {
    /// The first colour less the second.
    pub(crate) difference: Feature,
    /// ρ² in both pictures.
    pub(crate) radii: [f64; 2],
}

/// What to add to each picture's colours so that they are alike.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Exposure {
    offset: Feature,
    falls: [f64; 2],
}

impl Exposure {
    /// The difference that most samples show.
    pub(crate) fn fit(samples: &[Sample]) -> Self {
        let usual = |part: usize| {
            median(&mut samples.iter().map(|sample| sample.difference[part]).collect::<Vec<f32>>())
        };
        let mut state = Vector3::new(f64::from(usual(0)), USUAL_FALL, USUAL_FALL);
        for _ in 0..ROUNDS {
            state = refit(samples, state).unwrap_or(state);
        }
        Self { offset: [state[0] as f32, usual(1), usual(2)], falls: [state[1], state[2]] }
    }

    /// What to add to a colour of a picture (0 or 1) at ρ².
    pub(crate) fn correction(&self, picture: usize, radius: f64) -> Feature {
        let fall = (self.falls[picture] * radius) as f32;
        let [a, b, c] = if picture == 0 { [0.0; 3] } else { self.offset };
        [a + fall, b, c]
    }
}

fn terms(sample: &Sample) -> Vector3<f64> {
    Vector3::new(1.0, -sample.radii[0], sample.radii[1])
}

/// One weighted least-squares fit of a, c₁ and c₂.
fn refit(samples: &[Sample], state: Vector3<f64>) -> Option<Vector3<f64>> {
    let residual = |sample: &Sample| f64::from(sample.difference[0]) - state.dot(&terms(sample));
    let mut sizes: Vec<f32> = samples.iter().map(|sample| residual(sample).abs() as f32).collect();
    let spread = (1.4826 * f64::from(median(&mut sizes))).max(LEAST_SPREAD);
    let known = KNOWLEDGE * samples.len().max(1) as f64;
    let mut sums = NormalEquations::<3>::new(0.0);
    sums.add_prior(1, USUAL_FALL, known);
    sums.add_prior(2, USUAL_FALL, known);
    for sample in samples {
        let weight = geman_mcclure(residual(sample) / (WIDTH * spread));
        sums.add(terms(sample), f64::from(sample.difference[0]), weight);
    }
    sums.solve()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn exposure_and_vignetting_are_found_beside_highlights() {
        let sample = |i: usize| {
            let (x, y) = ((i % 40) as f64 / 40.0, (i / 40) as f64 / 40.0);
            let radii = [(x - 0.3).powi(2) + y * y, (x - 0.7).powi(2) + y * y];
            let highlight = if x < 0.2 { 0.4 } else { 0.0 };
            let d = 0.3 - 0.25 * radii[0] + 0.10 * radii[1] + highlight;
            Sample { difference: [d as f32, -0.05, 0.02], radii }
        };
        let samples: Vec<_> = (0..800).map(sample).collect();
        let exposure = Exposure::fit(&samples);
        for sample in samples.iter().filter(|sample| sample.difference[0] < 0.3) {
            let [first, second] = [0, 1].map(|i| exposure.correction(i, sample.radii[i]));
            let left = sample.difference[0] + first[0] - second[0];
            // The usual fall pulls by a hundredth or two; two pictures' noise is as much.
            assert!(left.abs() < 0.03, "{left} of {sample:?}");
        }
        assert_eq!(exposure.correction(1, 0.0)[1..], [-0.05, 0.02]);
    }
}
