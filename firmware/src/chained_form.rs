//! The chained form in n dimensions and its closed-form states [Alghannam, Eq. 2, 5, 8, 10].
//!
//! ż1 = v1, ż2 = v2, żk = z(k-1) v1 for k = 3..n. A differential-drive base is the case n = 3 with
//! z1 = X, z2 = tan φ, z3 = Y. Computed once a leg, so in f64.
//!
//! | symbol | meaning | unit for n = 3 |
//! |---|---|---|
//! | z1..zn | chained state; index 0 holds z1 | m, –, m |
//! | v1, v2 | chained input | m/s, 1/s |
//! | u1, u2 | linear and angular velocity | m/s, rad/s |
//! | φ | heading in the frame of the chained form | rad |
//! | δ | change of z1 in an even interval, c ε | m |

use protocol::motion::Twist;
use protocol::units::{MetresPerSecond, RadiansPerSecond};

/// z1..zn.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ChainedState<const N: usize>(pub [f64; N]);

/// v1 and v2.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct ChainedInput {
    /// v1 = ż1.
    pub v1: f32,
    /// v2 = ż2.
    pub v2: f32,
}

impl<const N: usize> ChainedState<N> {
    /// ż for the input (v1, v2) [Eq. 2].
    pub fn rates(&self, v1: f64, v2: f64) -> [f64; N] {
        let mut rates = [0.0; N];
        let mut before = None;
        for (place, (rate, z)) in rates.iter_mut().zip(self.0).enumerate() {
            *rate = match (place, before) {
                (0, _) => v1,
                (1, _) => v2,
                (_, Some(before)) => before * v1,
                (_, None) => 0.0,
            };
            before = Some(z);
        }
        rates
    }

    /// The state after z2 changed by `change`, v1 = 0 [Eq. 8].
    pub fn after_odd(mut self, change: f64) -> Self {
        if let Some(z2) = self.0.get_mut(1) {
            *z2 += change;
        }
        self
    }

    /// The state after z1 changed by `delta`, v2 = 0 [Eq. 10]:
    /// z_m ← Σ(k = 0..m-2) δ^k/k! z_(m-k) for m ≥ 3.
    pub fn after_even(self, delta: f64) -> Self {
        let mut after = self.0;
        if let Some(z1) = after.first_mut() {
            *z1 += delta;
        }
        for (place, z) in after.iter_mut().enumerate().skip(2) {
            *z = drift(&self.0, place, delta);
        }
        Self(after)
    }
}

/// Σ(k = 0..place-1) δ^k/k! z(place - k), with z counted from 0: the chain never reaches z1.
pub(crate) fn drift(z: &[f64], place: usize, delta: f64) -> f64 {
    let chain = z.get(1..=place).unwrap_or_default();
    let mut term = 1.0;
    let mut sum = 0.0;
    for (k, z) in chain.iter().rev().enumerate() {
        sum += term * z;
        term *= delta / (k + 1) as f64;
    }
    sum
}

impl ChainedInput {
    /// u1 = v1 / cos φ and u2 = v2 cos² φ, the inverse of [Eq. 5]; |φ| < π/2.
    pub fn twist(self, cos_phi: f32) -> Twist {
        Twist {
            linear: MetresPerSecond(self.v1 / cos_phi),
            angular: RadiansPerSecond(self.v2 * cos_phi * cos_phi),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rates_by_hand() {
        assert_eq!(ChainedState([1.0, 2.0, 3.0, 4.0]).rates(0.5, 7.0), [0.5, 7.0, 1.0, 1.5]);
    }

    #[test]
    fn even_interval_by_hand() {
        // δ = 2: z3 = 3 + 2·2 = 7, z4 = 4 + 2·3 + 2²/2·2 = 14.
        let after = ChainedState([1.0, 2.0, 3.0, 4.0]).after_even(2.0);
        assert_eq!(after, ChainedState([3.0, 2.0, 7.0, 14.0]));
    }

    #[test]
    fn equation_5_by_hand() {
        // φ = 60°: cos = 1/2, so u1 = 2 v1 and u2 = v2 / 4.
        let twist = ChainedInput { v1: 0.3, v2: 2.0 }.twist(0.5);
        assert_eq!(twist.linear, MetresPerSecond(0.6));
        assert_eq!(twist.angular, RadiansPerSecond(0.5));
    }
}
