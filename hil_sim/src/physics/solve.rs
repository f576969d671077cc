//! The five linear equations of one step: velocities at its end.

/// Place of the velocity ahead.
pub(super) const U: usize = 0;
/// Place of the velocity to the left.
pub(super) const V: usize = 1;
/// Place of the yaw rate.
pub(super) const YAW: usize = 2;
/// Place of the left wheel's speed; the right one's follows.
pub(super) const WHEEL: usize = 3;

const N: usize = 5;

/// Rows of momentum: `matrix` times the velocities at the end is `right`.
pub(super) struct Equations {
    matrix: [[f64; N]; N],
    right: [f64; N],
    before: [f64; N],
}

impl Equations {
    /// Bodies of these masses that keep their velocities.
    pub(super) fn new(masses: [f64; N], before: [f64; N]) -> Self {
        let mut matrix = [[0.0; N]; N];
        let mut right = [0.0; N];
        for place in 0..N {
            matrix[place][place] = masses[place];
            right[place] = masses[place] * before[place];
        }
        Self { matrix, right, before }
    }

    /// The frame of the body turns at `rate` for `h` seconds under what keeps its direction.
    pub(super) fn turn_frame(&mut self, mass: f64, rate: f64, h: f64) {
        let half = h * mass * rate / 2.0;
        self.matrix[U][V] -= half;
        self.right[U] += half * self.before[V];
        self.matrix[V][U] += half;
        self.right[V] -= half * self.before[U];
    }

    /// A torque that falls with the step's mean speed: `torque - slope · mean`.
    pub(super) fn drive(&mut self, place: usize, torque: f64, slope: f64, h: f64) {
        self.matrix[place][place] += h * slope / 2.0;
        self.right[place] += h * (torque - slope * self.before[place] / 2.0);
    }

    /// A force of `c` times the velocity `row · q` at the end of the step, against it.
    pub(super) fn resist(&mut self, row: &[f64; N], c: f64, h: f64) {
        for (line, a) in self.matrix.iter_mut().zip(row) {
            if *a != 0.0 {
                line.iter_mut().zip(row).for_each(|(cell, b)| *cell += h * c * a * b);
            }
        }
    }

    /// Gauss's elimination. The matrix is positive definite but for a small skew part, so no row need
    /// be exchanged.
    pub(super) fn solve(mut self) -> [f64; N] {
        for pivot in 0..N {
            let (above, below) = self.matrix.split_at_mut(pivot + 1);
            let row = &above[pivot];
            for (offset, line) in below.iter_mut().enumerate() {
                let factor = line[pivot] / row[pivot];
                if factor != 0.0 {
                    (pivot..N).for_each(|column| line[column] -= factor * row[column]);
                    self.right[pivot + 1 + offset] -= factor * self.right[pivot];
                }
            }
        }
        let mut found = [0.0; N];
        for place in (0..N).rev() {
            let known: f64 =
                (place + 1..N).map(|column| self.matrix[place][column] * found[column]).sum();
            found[place] = (self.right[place] - known) / self.matrix[place][place];
        }
        found
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_found_fulfils_the_equations() {
        let mut random = fastrand::Rng::with_seed(1);
        for _ in 0..100 {
            let mut draw = || std::array::from_fn::<f64, N, _>(|_| random.f64() - 0.5);
            let mut equations = Equations::new([0.6, 0.6, 0.01, 1e-4, 1e-4], draw());
            equations.turn_frame(0.6, 3.0, 0.001);
            (0..4).for_each(|_| equations.resist(&draw(), 1e3, 0.001));
            equations.drive(WHEEL, 0.1, 0.01, 0.001);
            let (matrix, right) = (equations.matrix, equations.right);
            let found = equations.solve();
            for (row, right) in matrix.iter().zip(right) {
                let left: f64 = row.iter().zip(found).map(|(a, b)| a * b).sum();
                assert!((left - right).abs() < 1e-9, "{left} {right}");
            }
        }
    }

    #[test]
    fn a_turning_frame_keeps_the_speed() {
        let mut q = [0.3, -0.1, 2.0, 0.0, 0.0];
        for _ in 0..1000 {
            let mut equations = Equations::new([0.5, 0.5, 0.01, 1.0, 1.0], q);
            equations.turn_frame(0.5, 2.0, 0.001);
            q = equations.solve();
        }
        assert!((q[U].hypot(q[V]) - 0.1f64.sqrt()).abs() < 1e-12);
        // After 1 s the body has turned by 2 rad, so the velocity by -2 rad as it sees it.
        let angle = q[V].atan2(q[U]) - (-0.1f64).atan2(0.3);
        assert!((angle + 2.0).abs() < 1e-6, "{angle}");
    }
}
