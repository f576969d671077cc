//! Levenberg and Marquardt's way down to the least squares, re-weighted as outliers show; and how likely
//! its end is among those of other problems (Laplace's approximation).

use super::KnownOfCamera;
use super::model::{Lens, Problem, Stand, State, Unknown};
use crate::geometry::Point;
use nalgebra::DMatrix;

/// Focal lengths to start from, longer sides of the picture.
const STARTS: [f64; 4] = [0.6, 1.0, 1.7, 3.0];
/// Steps farther off than this do not count, in their noise: boxes and shadows on the border. The way
/// starts with all, because a wrong focal length may bring a whole side out of reach.
const REACH: [f64; 4] = [f64::INFINITY, 12.0, 6.0, LAST_REACH];
const LAST_REACH: f64 = 4.7;
/// Steps of the descent for each reach.
const MOST_STEPS: usize = 40;
/// The damping, as a factor of the matrix's diagonal: at first, and where no step helps any more.
const FIRST_DAMPING: f64 = 1e-3;
const LAST_DAMPING: f64 = 1e9;
/// A gain of the cost by less than this share is none.
const LEAST_GAIN: f64 = 1e-9;

/// The most likely state of a problem.
pub(super) struct Solution<'a> {
    problem: Problem<'a>,
    pub(super) state: State,
    weights: Vec<f64>,
    covariance: DMatrix<f64>,
    /// Half the logarithm of the covariance's determinant.
    log_volume: f64,
}

impl Solution<'_> {
    /// The most likely value of an unknown.
    pub(super) fn value(&self, unknown: Unknown) -> f64 {
        self.state.value(unknown)
    }

    /// The variance of an unknown.
    pub(super) fn variance(&self, unknown: Unknown) -> f64 {
        let index = unknown.index();
        self.covariance[(index, index)].max(0.0)
    }

    /// The sum of squares of the sightings and of the priors that count, in standard deviations.
    pub(super) fn misfit(&self, counts: impl Fn(Unknown) -> bool) -> f64 {
        self.problem.misfit(&self.state, LAST_REACH, counts)
    }

    /// The logarithm of how likely the problem is, given what was seen: its priors and the volume of what
    /// they allow.
    pub(super) fn evidence(&self) -> f64 {
        let allowed: f64 = self.problem.priors.iter().map(|prior| prior.spread.ln()).sum();
        self.log_volume - allowed - 0.5 * self.misfit(|_| true)
    }

    /// The sum of squares of the priors that count alone, in standard deviations.
    pub(super) fn strain(&self, counts: impl Fn(Unknown) -> bool) -> f64 {
        self.problem.strain(&self.state, counts)
    }

    /// The root mean square distance of the sightings that count, pixels, and their number.
    pub(super) fn residual(&self) -> (f64, usize) {
        let seen = self.problem.distances(&self.state).into_iter().zip(self.problem.sightings());
        let counted: Vec<f64> = seen
            .zip(&self.weights)
            .filter(|((_, (_, of)), weight)| **weight > 0.0 && !of.by_hand)
            .map(|((far, _), _)| far)
            .collect();
        let squares = counted.iter().map(|far| far * far).sum::<f64>();
        ((squares / counted.len().max(1) as f64).sqrt(), counted.len())
    }
}

/// The best of the states to which several starts lead; `None` if nothing holds them.
pub(super) fn solve<'a>(problem: Problem<'a>, starts: &[State]) -> Option<Solution<'a>> {
    let ends = starts.iter().filter_map(|start| {
        let (state, weights) = descend(&problem, start.clone());
        let misfit = problem.misfit(&state, LAST_REACH, |_| true);
        misfit.is_finite().then_some((misfit, state, weights))
    });
    let (_, state, weights) = ends.min_by(|a, b| a.0.total_cmp(&b.0))?;
    let (matrix, _) = problem.normal_equations(&state, &weights);
    let factor = matrix.cholesky()?;
    let log_volume = -factor.l_dirty().diagonal().iter().map(|value| value.ln()).sum::<f64>();
    Some(Solution { problem, state, weights, covariance: factor.inverse(), log_volume })
}

/// Where to start from: what several focal lengths make of the borders, or what is known does.
pub(super) fn starts(problem: &Problem, known: KnownOfCamera) -> Option<Vec<State>> {
    let first = problem.views.first()?.first()?;
    let middle = Point::new(problem.arena.width / 2.0, problem.arena.height / 2.0);
    let focals = match known {
        KnownOfCamera { focal: Some(focal), .. } => vec![focal],
        KnownOfCamera { height: Some(height), .. } => vec![height * first.map.scale_at(middle)],
        _ => STARTS.map(|share| share * first.longer_side()).to_vec(),
    };
    Some(focals.into_iter().filter_map(|focal| start(problem, focal)).collect())
}

fn start(problem: &Problem, focal: f64) -> Option<State> {
    let first = problem.views.first()?.first()?;
    let [width, height] = first.size.map(|count| count as f64);
    let stands = problem.views.iter().map(|seen| Stand::of(&seen.first()?.map, focal));
    // The map's coefficient is per half width, the lens's per focal length.
    let radial = first.map.radial() * (2.0 * focal / width).powi(2);
    let lens = Lens { focal, centre: [(width - 1.0) / 2.0, (height - 1.0) / 2.0], radial };
    Some(State { lens, stands: stands.collect::<Option<_>>()? })
}

fn descend(problem: &Problem, start: State) -> (State, Vec<f64>) {
    let mut state = start;
    let mut weights = Vec::new();
    for reach in REACH {
        weights = problem.weights(&state, reach);
        let mut damping = FIRST_DAMPING;
        for _ in 0..MOST_STEPS {
            let before = problem.cost(&state, &weights);
            let next = downhill(problem, &state, &weights, before, &mut damping);
            let Some((after, next)) = next else { break };
            state = next;
            if before - after < LEAST_GAIN * before {
                break;
            }
        }
    }
    (state, weights)
}

/// A step that lowers the cost, with its cost; `None` if there is none.
fn downhill(
    problem: &Problem,
    state: &State,
    weights: &[f64],
    before: f64,
    damping: &mut f64,
) -> Option<(f64, State)> {
    let (matrix, right) = problem.normal_equations(state, weights);
    while *damping < LAST_DAMPING {
        let mut damped = matrix.clone();
        for i in 0..damped.nrows() {
            damped[(i, i)] *= 1.0 + *damping;
        }
        let next = state.moved(&damped.cholesky()?.solve(&right));
        let after = problem.cost(&next, weights);
        if after < before {
            *damping /= 10.0;
            return Some((after, next));
        }
        *damping *= 10.0;
    }
    None
}
