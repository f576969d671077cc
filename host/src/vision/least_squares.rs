//! Weighted least squares in a few unknowns: the normal equations, and weights by which outliers count less.
//!
//! Wanted is the x that makes Σ w (e − r·x)² least; where e depends on x not quite linearly, steps by x lead there
//! (Gauss and Newton's way).
//!
//! | symbol | here |
//! |---|---|
//! | x | the unknowns, or how much they change |
//! | r | `row`: how much an error falls as each unknown grows |
//! | e | `error`: what was observed less what is expected |
//! | w | `weight`: 1/σ² of the observation, times how far it is believed |
//!
//! A fit of many samples to polynomials ([`super::appearance`]), the one of many cameras at once
//! ([`super::calibrate`]) and that of a tag's pixels ([`super::tags`]) sum by themselves: their unknowns are counted at
//! run time, or their samples by thousands.

use nalgebra::{SMatrix, SVector};

/// The sums Σ w r rᵀ and Σ w e r.
#[derive(Clone, Debug)]
pub(crate) struct NormalEquations<const N: usize> {
    matrix: SMatrix<f64, N, N>,
    right: SVector<f64, N>,
}

impl<const N: usize> NormalEquations<N> {
    /// Nothing observed; each unknown stays at 0 as if `damping` were its weight.
    pub(crate) fn new(damping: f64) -> Self {
        Self { matrix: SMatrix::identity() * damping, right: SVector::zeros() }
    }

    /// Adds an observation.
    pub(crate) fn add(&mut self, row: SVector<f64, N>, error: f64, weight: f64) {
        self.matrix += weight * row * row.transpose();
        self.right += weight * error * row;
    }

    /// Adds that unknown number `index` is about `value`.
    pub(crate) fn add_prior(&mut self, index: usize, value: f64, weight: f64) {
        self.matrix[(index, index)] += weight;
        self.right[index] += weight * value;
    }

    /// The x; `None` if an unknown is not observed at all.
    pub(crate) fn solve(&self) -> Option<SVector<f64, N>> {
        Some(self.matrix.cholesky()?.solve(&self.right))
    }

    /// The covariance of x, if weights are 1/σ².
    pub(crate) fn covariance(&self) -> Option<SMatrix<f64, N, N>> {
        self.matrix.try_inverse()
    }
}

/// Tukey's biweight of an error, as a multiple of what counts no more: from 1 down to 0.
pub(crate) fn tukey(ratio: f64) -> f64 {
    if ratio.abs() < 1.0 { (1.0 - ratio * ratio).powi(2) } else { 0.0 }
}

/// Geman and McClure's weight of an error, as a multiple of what counts a quarter: no error counts nothing at all.
pub(crate) fn geman_mcclure(ratio: f64) -> f64 {
    (1.0 + ratio * ratio).powi(-2)
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn a_line_through_three_points_is_the_one_of_the_textbook() {
        // (0, 1), (1, 2), (2, 4): slope 3/2, at 0: 5/6. Its covariance with σ = 1: [5/6, −1/2; −1/2, 1/2].
        let mut sums = NormalEquations::<2>::new(0.0);
        for (x, y) in [(0.0, 1.0), (1.0, 2.0), (2.0, 4.0)] {
            sums.add(SVector::from([1.0, x]), y, 1.0);
        }
        let line = sums.solve().unwrap();
        assert!((line - SVector::from([5.0 / 6.0, 1.5])).amax() < 1e-12, "{line}");
        let covariance = sums.covariance().unwrap();
        let expected = SMatrix::from([[5.0 / 6.0, -0.5], [-0.5, 0.5]]);
        assert!((covariance - expected).amax() < 1e-12, "{covariance}");
    }

    #[test]
    fn what_nothing_tells_is_not_solved_unless_it_is_known() {
        let mut sums = NormalEquations::<2>::new(0.0);
        sums.add(SVector::from([2.0, 0.0]), 3.0, 2.0);
        assert!(sums.solve().is_none() && sums.covariance().is_none());
        sums.add_prior(1, 7.0, 4.0);
        assert!((sums.solve().unwrap() - SVector::from([1.5, 7.0])).amax() < 1e-12);
    }

    #[test]
    fn weights_fall_from_one() {
        assert_eq!([0.0, 0.5, 1.0, -2.0].map(tukey), [1.0, 0.5625, 0.0, 0.0]);
        assert_eq!([0.0, 1.0, -3.0].map(geman_mcclure), [1.0, 0.25, 0.01]);
    }

    proptest! {
        #[test]
        fn no_other_x_has_a_smaller_sum(
            seen in proptest::collection::vec((-3.0..3.0, -3.0..3.0, -5.0..5.0, 0.1..2.0), 4..20),
            other in (-1.0..1.0, -1.0..1.0),
        ) {
            let mut sums = NormalEquations::<2>::new(1e-6);
            for &(a, b, error, weight) in &seen {
                sums.add(SVector::from([a, b]), error, weight);
            }
            let best = sums.solve().unwrap();
            let sum = |x: SVector<f64, 2>| -> f64 {
                let square = |&(a, b, e, w): &(f64, f64, f64, f64)| w * (e - a * x[0] - b * x[1]).powi(2);
                seen.iter().map(square).sum::<f64>() + 1e-6 * x.norm_squared()
            };
            prop_assert!(sum(best) <= sum(best + SVector::from([other.0, other.1])) + 1e-9);
        }
    }
}
