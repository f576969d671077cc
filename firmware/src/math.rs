//! The one place where the robot computes by approximation.
//!
//! `micromath` takes a root by shifting a float's exponent: some ten instructions, where
//! `libm::sqrtf` goes bit by bit on a processor without a floating-point unit. It errs by up to
//! [`LENGTH_ERROR`], so it serves for lengths that are only compared with a threshold that
//! itself is coarse. Whatever becomes a pose or a speed uses
//! [`sin_cos`](protocol::trigonometry::sin_cos) and `libm`.

use micromath::F32Ext;

/// The length of (`x`, `y`), with an error of at most [`LENGTH_ERROR`] of it.
pub(crate) fn approximate_length(x: f32, y: f32) -> f32 {
    // By path: as a method, the standard library's exact one would be taken in tests on a computer.
    F32Ext::sqrt(x * x + y * y)
}

/// The largest error of [`approximate_length`], as a share of the length.
#[cfg(test)]
pub(crate) const LENGTH_ERROR: f32 = 0.0625;

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_length_keeps_its_bound() {
        // A root's error repeats with every factor of 4 of its square: 0.1 to 1 m sees all of it.
        let worst = (1000..=10_000u16)
            .map(|step| f64::from(step) / 10_000.0)
            .map(|length| {
                let (x, y) = (0.6 * length, -0.8 * length);
                (f64::from(approximate_length(x as f32, y as f32)) / length - 1.0).abs()
            })
            .fold(0.0, f64::max);
        assert!(worst <= f64::from(LENGTH_ERROR), "{worst}");
        assert!(worst > 1e-3, "exact: the standard library's root was taken");
        assert!(approximate_length(0.0, 0.0) < 1e-9);
    }
}
