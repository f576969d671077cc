//! Sine and cosine in integer arithmetic, for processors without a floating-point unit.
//!
//! An RP2040 takes 9400 cycles for `libm::sincosf`, which computes in f64, and about 800 for this.
//! The result is the same to the last bit on every processor.
//!
//! The angle becomes a fraction of a turn in 32 bits, so that wrapping around is free. The nearest
//! multiple of a quarter turn goes to the signs; the rest, t in [-1, 1] eighths of a turn, to
//!
//! ```text
//! sin(π/4 t) = t (S0 + S1 y + S2 y² + S3 y³ + S4 y⁴)        y = t²
//! cos(π/4 t) = 1 + C1 y + C2 y² + C3 y³ + C4 y⁴
//! ```
//! the first terms of Taylor's series, whose rest is below 3e-8.

/// sin and cos of `angle` in radians, of any size, to [`SIN_COS_ERROR`].
///
/// Angles that are not finite give some finite pair.
///
/// ```
/// let (sin, cos) = wmr_protocol::trigonometry::sin_cos(core::f32::consts::FRAC_PI_6);
/// assert!((sin - 0.5).abs() < 1e-7 && (cos - 0.866_025_4).abs() < 1e-7);
/// ```
pub fn sin_cos(angle: f32) -> (f32, f32) {
    let turn = fraction_of_turn(angle);
    let quarter = turn.wrapping_add(1 << 29) >> 30;
    // Eighths of a turn, 31 bits after the point.
    let t = (turn.wrapping_sub(quarter << 30) << 2).cast_signed();
    // 30 bits after the point.
    let y = multiply_high(t, t);
    let sin = multiply_high(polynomial(&SINE, y), t);
    let cos = polynomial(&COSINE, y);
    let (sin, cos) = match quarter {
        0 => (sin, cos),
        1 => (cos, -sin),
        2 => (-sin, -cos),
        _ => (-cos, sin),
    };
    (from_fixed(sin), from_fixed(cos))
}

/// The largest error of [`sin_cos`] for angles in [-2π, 2π].
pub const SIN_COS_ERROR: f32 = 8e-8;

/// S4 to S0, 31 bits after the point.
const SINE: [i32; 5] = [673, -78_547, 5_348_082, -173_399_667, 1_686_629_713];
/// C4 to C0, 30 bits after the point.
const COSINE: [i32; 5] = [3_856, -350_031, 17_023_473, -331_168_970, 1 << 30];

/// 2^34 / 2π.
const TURNS_PER_RADIAN: u64 = 2_734_261_102;
/// Bits of a float's fraction.
const FRACTION_BITS: u32 = 23;
/// What a float's exponent field would be if its fraction, times [`TURNS_PER_RADIAN`], were 2^-32 turns.
const EXPONENT_OF_PRODUCT: i32 = 127 + 23 + 2;

/// `angle` in units of 2^-32 turns; whole turns drop out.
fn fraction_of_turn(angle: f32) -> u32 {
    let bits = angle.to_bits();
    let exponent = ((bits >> FRACTION_BITS) & 0xff).cast_signed();
    let fraction = (bits & ((1 << FRACTION_BITS) - 1)) | (1 << FRACTION_BITS);
    let product = u64::from(fraction) * TURNS_PER_RADIAN;
    let shift = exponent - EXPONENT_OF_PRODUCT;
    let turn = if shift < 0 {
        product.checked_shr(shift.unsigned_abs()).unwrap_or(0)
    } else {
        product.checked_shl(shift.unsigned_abs()).unwrap_or(0)
    };
    let turn = turn as u32;
    if angle.is_sign_negative() { turn.wrapping_neg() } else { turn }
}

/// Horner's scheme for `y` with 30 bits after the point; the result has as many as the coefficients.
fn polynomial(coefficients: &[i32; 5], y: i32) -> i32 {
    let step = |sum: i32, coefficient: &i32| (multiply_high(sum, y) << 2) + coefficient;
    coefficients.iter().fold(0, step)
}

/// The upper 32 of the product's 64 bits, up to 2 too small.
///
/// In halves, because a Cortex-M0+ multiplies 32 bits by 32 bits to 32 bits at most; the product of
/// the lower halves hardly counts.
fn multiply_high(a: i32, b: i32) -> i32 {
    let (a_high, a_low) = (a >> 16, a & 0xffff);
    let (b_high, b_low) = (b >> 16, b & 0xffff);
    a_high * b_high + ((a_high * b_low) >> 16) + ((a_low * b_high) >> 16)
}

/// A number with 30 bits after the point as a float.
fn from_fixed(value: i32) -> f32 {
    const UNIT: f32 = 1.0 / (1 << 30) as f32;
    value as f32 * UNIT
}

#[cfg(test)]
mod tests {
    use super::*;
    use core::f32::consts::{FRAC_PI_2, PI};

    fn error(angle: f32) -> f64 {
        let (sin, cos) = sin_cos(angle);
        let exact = f64::from(angle).sin_cos();
        (f64::from(sin) - exact.0).abs().max((f64::from(cos) - exact.1).abs())
    }

    #[test]
    fn the_coefficients_are_those_of_the_series() {
        let eighth = core::f64::consts::FRAC_PI_4;
        let mut term = 1.0;
        for power in 0..10 {
            let table = if power % 2 == 0 { (COSINE, 30) } else { (SINE, 31) };
            let exact = term * 2f64.powi(table.1) * if power % 4 < 2 { 1.0 } else { -1.0 };
            let coefficient = table.0[4 - power / 2];
            assert!((exact - f64::from(coefficient)).abs() <= 0.5, "{power} {exact}");
            term *= eighth / (power + 1) as f64;
        }
    }

    #[test]
    fn the_error_keeps_its_bound() {
        let worst = (-628_319..=628_319).map(|step| error(step as f32 * 1e-5)).fold(0.0, f64::max);
        assert!(worst <= f64::from(SIN_COS_ERROR), "{worst}");
    }

    #[test]
    fn whole_quarters_are_exact() {
        assert_eq!(sin_cos(0.0), (0.0, 1.0));
        assert_eq!(sin_cos(FRAC_PI_2).0, 1.0);
        assert_eq!(sin_cos(-PI).1, -1.0);
    }

    #[test]
    fn angles_of_every_size_are_taken() {
        for angle in [1e-30, 1e-7, 4.0, 100.0, -1e4, 1e7] {
            // A fraction of a turn to 2^-34 of the whole angle.
            assert!(error(angle) < 1e-7 + f64::from(angle.abs()) * 1e-9, "{angle}");
        }
        for angle in [f32::MAX, f32::INFINITY, f32::NAN] {
            assert!(sin_cos(angle).0.is_finite());
        }
    }
}
