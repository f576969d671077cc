//! Cosine switch control: from one chained state to another in 2(n - 2) + 1 intervals
//! [Alghannam, Eq. 6-12].
//!
//! This is the paper's solver in its own form. The robot does not run it: for n = 3 its states are those
//! of [`protocol::motion`]'s intervals, which add limits and a heading free of singularities. It is the
//! oracle that those are tested against, and drives vehicles of more dimensions (n > 3) in tests.
//!
//! In odd intervals only v2 acts, in even ones only v1, each as c (1 - cos wt) with w = 2π/ε: it
//! begins and ends at rest, so that the switch is smooth. The interval's whole change is c ε.
//!
//! | symbol | meaning |
//! |---|---|
//! | ε | duration of each interval, T / (2(n - 2) + 1) \[s\] |
//! | d_i | c(2i+1) ε, the change of z2 in odd interval i = 0..n-2 |
//! | δ_j | c(2j+2) ε, the change of z1 in even interval j = 0..n-3 |
//! | S_i | Σ(j = i..n-3) δ_j, what z1 still has to go after odd interval i |
//!
//! With the even changes chosen as equal shares [Eq. 12], [Eq. 11] is linear in the d_i: a
//! Vandermonde system with the nodes S_0 .. S_(n-3), 0, solvable iff these differ, that is, iff z1
//! changes at all. *Deviation:* [Eq. 11] is printed with c(2i+2) in the inner sum and n - 3 as the
//! last limit of the first; exact arithmetic for n = 3..6 shows c(2i+1), as here.

use crate::chained_form::{ChainedState, drift};

/// The coefficients that lead from one state to another.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CosineSwitch<const N: usize> {
    /// d_0 .. d_(N-2); the last place is unused.
    odd: [f64; N],
    /// δ: every even interval takes the same share.
    share: f64,
    epsilon: f64,
}

/// Why no coefficients exist.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum CosineSwitchError {
    /// N is below 3: there is no chain to steer.
    TooShort,
    /// z1 ends where it begins, so v1 cannot carry z3..zn: go through a state with another z1.
    NeedsIntermediate,
}

impl<const N: usize> CosineSwitch<N> {
    /// Solves for the inputs that lead from `start` to `end` with intervals of `epsilon` seconds.
    ///
    /// ```
    /// use wmr_firmware::{chained_form::ChainedState, cosine_switch::CosineSwitch};
    /// // A base at the origin along x, to (2, 1) along x: z3 rises by 1 over z1 = 2, so tan φ = 1/2.
    /// let switch = CosineSwitch::between(&ChainedState([0.0, 0.0, 0.0]), &ChainedState([2.0, 0.0, 1.0]), 3.0)?;
    /// assert_eq!(switch.odd_changes(), [0.5, -0.5]);
    /// assert_eq!(switch.even_change(), 2.0);
    /// # Ok::<(), wmr_firmware::cosine_switch::CosineSwitchError>(())
    /// ```
    ///
    /// # Errors
    /// [`CosineSwitchError`] if N < 3 or z1 does not change.
    pub fn between(
        start: &ChainedState<N>,
        end: &ChainedState<N>,
        epsilon: f64,
    ) -> Result<Self, CosineSwitchError> {
        let (Some(first), Some(last)) = (start.0.first(), end.0.first()) else {
            return Err(CosineSwitchError::TooShort);
        };
        if N < 3 {
            return Err(CosineSwitchError::TooShort);
        }
        let whole = last - first;
        if whole == 0.0 {
            return Err(CosineSwitchError::NeedsIntermediate);
        }
        let share = whole / (N - 2) as f64;
        // Row p asks for z_(p+2): what the d_i must add beyond the drift of the start state.
        let mut wanted = [0.0; N];
        for ((place, wanted), end) in wanted.iter_mut().enumerate().zip(end.0.iter().skip(1)) {
            *wanted = end - drift(&start.0, place + 1, whole);
        }
        Ok(Self { odd: solve_vandermonde(wanted, share), share, epsilon })
    }

    /// c(2i+1) ε for each odd interval: the changes of z2.
    pub fn odd_changes(&self) -> &[f64] {
        self.odd.get(..N.saturating_sub(1)).unwrap_or_default()
    }

    /// c(2j+2) ε, the same for each even interval: the change of z1.
    pub fn even_change(&self) -> f64 {
        self.share
    }

    /// T: the time that all intervals take together, seconds.
    pub fn duration(&self) -> f64 {
        (2 * (N - 2) + 1) as f64 * self.epsilon
    }

    /// (v1, v2) at time `t` after the start [Eq. 7, 9], seconds.
    pub fn input(&self, t: f64) -> (f64, f64) {
        let (interval, local) = self.locate(t);
        let shape = (1.0 - libm::cos(core::f64::consts::TAU * local / self.epsilon)) / self.epsilon;
        match self.odd_change(interval) {
            Some(change) => (0.0, change * shape),
            None => (self.share * shape, 0.0),
        }
    }

    /// The state at time `t` after leaving `start`, in closed form [Eq. 8, 10].
    pub fn state_at(&self, start: &ChainedState<N>, t: f64) -> ChainedState<N> {
        let (interval, local) = self.locate(t);
        let s = local / self.epsilon;
        let fraction = s - libm::sin(core::f64::consts::TAU * s) / core::f64::consts::TAU;
        let before = (0..interval).fold(*start, |state, done| self.advance(state, done, 1.0));
        self.advance(before, interval, fraction)
    }

    fn advance(&self, state: ChainedState<N>, interval: usize, fraction: f64) -> ChainedState<N> {
        match self.odd_change(interval) {
            Some(change) => state.after_odd(change * fraction),
            None => state.after_even(self.share * fraction),
        }
    }

    fn odd_change(&self, interval: usize) -> Option<f64> {
        if interval % 2 == 1 { None } else { self.odd.get(interval / 2).copied() }
    }

    fn locate(&self, t: f64) -> (usize, f64) {
        let last = 2 * (N - 2);
        let interval = (libm::floor(t / self.epsilon).max(0.0) as usize).min(last);
        (interval, (t - interval as f64 * self.epsilon).clamp(0.0, self.epsilon))
    }
}

/// Σ_i S_i^p / p! d_i = `wanted`[p] for p = 0..n-2, with S_i = (n - 2 - i) δ, by Newton's divided
/// differences (Björck and Pereyra): stable for these few, well-spread nodes.
fn solve_vandermonde<const N: usize>(mut wanted: [f64; N], share: f64) -> [f64; N] {
    let count = N - 1;
    let node = |i: usize| (count - 1 - i) as f64 * share;
    let mut factorial = 1.0;
    for (p, value) in wanted.iter_mut().enumerate() {
        factorial *= p.max(1) as f64;
        *value *= factorial;
    }
    let get = |values: &[f64; N], at: usize| values.get(at).copied().unwrap_or(0.0);
    for k in 0..count - 1 {
        for i in (k + 1..count).rev() {
            let value = get(&wanted, i) - node(k) * get(&wanted, i - 1);
            wanted.get_mut(i).into_iter().for_each(|place| *place = value);
        }
    }
    for k in (0..count - 1).rev() {
        for i in k + 1..count {
            let value = get(&wanted, i) / (node(i) - node(i - k - 1));
            wanted.get_mut(i).into_iter().for_each(|place| *place = value);
        }
        for i in k..count - 1 {
            let value = get(&wanted, i) - get(&wanted, i + 1);
            wanted.get_mut(i).into_iter().for_each(|place| *place = value);
        }
    }
    wanted
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    /// Runge and Kutta's fourth-order rule on [Eq. 2], knowing nothing of the closed forms.
    fn integrate<const N: usize>(
        switch: &CosineSwitch<N>,
        start: &ChainedState<N>,
        until: f64,
    ) -> [f64; N] {
        // A multiple of 3, 5, 7 and 9: no step straddles a switch of n = 3..6.
        const STEPS: usize = 6300;
        let h = until / STEPS as f64;
        let along = |z: &[f64; N], k: &[f64; N], h: f64| {
            let mut next = *z;
            next.iter_mut().zip(k).for_each(|(z, k)| *z += h * k);
            next
        };
        let mut z = start.0;
        for step in 0..STEPS {
            let rates = |z: &[f64; N], at: f64| {
                let (v1, v2) = switch.input((step as f64 + at) * h);
                ChainedState(*z).rates(v1, v2)
            };
            let k1 = rates(&z, 0.0);
            let k2 = rates(&along(&z, &k1, h / 2.0), 0.5);
            let k3 = rates(&along(&z, &k2, h / 2.0), 0.5);
            let k4 = rates(&along(&z, &k3, h), 1.0);
            for place in 0..N {
                z[place] += h / 6.0 * (k1[place] + 2.0 * k2[place] + 2.0 * k3[place] + k4[place]);
            }
        }
        z
    }

    fn check<const N: usize>(start: [f64; N], end: [f64; N]) {
        let (start, end) = (ChainedState(start), ChainedState(end));
        let switch = CosineSwitch::between(&start, &end, 1.5).unwrap();
        let closed = switch.state_at(&start, switch.duration());
        let numeric = integrate(&switch, &start, switch.duration());
        for place in 0..N {
            // The closed form is exact but for rounding in the solver; the integrator errs by h⁴.
            assert!(
                (closed.0[place] - end.0[place]).abs() < 1e-9,
                "closed z{}: {closed:?}",
                place + 1
            );
            assert!(
                (numeric[place] - end.0[place]).abs() < 1e-7,
                "numeric z{}: {numeric:?}",
                place + 1
            );
        }
        // Here a step straddles a switch: the rule falls to second order there.
        let middle = 0.37 * switch.duration();
        let (closed, numeric) =
            (switch.state_at(&start, middle), integrate(&switch, &start, middle));
        (0..N).for_each(|place| assert!((closed.0[place] - numeric[place]).abs() < 1e-5));
    }

    #[test]
    fn equation_11_against_numeric_integration() {
        check([0.1, 0.2, -0.3], [1.1, -0.4, 0.6]);
        check([0.1, 0.2, -0.3, 0.4], [1.1, -0.4, 0.6, -0.2]);
        check([0.1, 0.2, -0.3, 0.4, 0.5], [-1.1, -0.4, 0.6, -0.2, 0.3]);
        check([0.1, 0.2, -0.3, 0.4, 0.5, -0.6], [1.1, -0.4, 0.6, -0.2, 0.3, 0.7]);
    }

    #[test]
    fn one_legs_coefficients_by_hand() {
        // From z = (0, 1/2, 0) to (2, -1, 4), ε = 3: v1 carries z1 by 2, so c2 = 2/3.
        // z3: 2 (1/2 + d0) = 4, so d0 = 3/2 and c1 = 1/2; z2: 1/2 + 3/2 + d1 = -1, so c3 = -1.
        let (start, end) = (ChainedState([0.0, 0.5, 0.0]), ChainedState([2.0, -1.0, 4.0]));
        let switch = CosineSwitch::between(&start, &end, 3.0).unwrap();
        assert_eq!(switch.odd_changes(), [1.5, -3.0]);
        // In mid-interval the input is 2 c.
        assert!((switch.input(1.5).1 - 1.0).abs() < 1e-12);
        assert!((switch.input(4.5).0 - 4.0 / 3.0).abs() < 1e-12);
        assert!((switch.input(7.5).1 + 2.0).abs() < 1e-12);
    }

    #[test]
    fn without_a_change_of_z1_another_state_is_needed() {
        let (start, end) = (ChainedState([1.0, 0.0, 0.0]), ChainedState([1.0, 0.0, 2.0]));
        assert_eq!(
            CosineSwitch::between(&start, &end, 1.0),
            Err(CosineSwitchError::NeedsIntermediate)
        );
    }

    proptest! {
        #[test]
        fn every_solvable_pair_is_joined(
            start in prop::array::uniform4(-2.0f64..2.0), end in prop::array::uniform4(-2.0f64..2.0),
        ) {
            prop_assume!((start[0] - end[0]).abs() > 0.1);
            let (start, end) = (ChainedState(start), ChainedState(end));
            let switch = CosineSwitch::between(&start, &end, 1.0).unwrap();
            let reached = switch.state_at(&start, switch.duration());
            // Nodes at least 0.05 apart: d grows to about 4 / 0.05², and rounding with it.
            (0..4).for_each(|place| assert!((reached.0[place] - end.0[place]).abs() < 1e-10));
        }
    }
}
