//! The gradient by Sobel's operator [Alghannam, Sec. II.A].

/// [∂f/∂x, ∂f/∂y] of the 3 × 3 neighbourhood `at(column, row)`, columns and rows 0 to 2; eight times the change per cell.
///
/// `f` may be any values to 255.
#[inline]
pub(crate) fn sobel(at: impl Fn(usize, usize) -> i16) -> [i16; 2] {
    let column = |x: usize| at(x, 0) + 2 * at(x, 1) + at(x, 2);
    let row = |y: usize| at(0, y) + 2 * at(1, y) + at(2, y);
    [column(2) - column(0), row(2) - row(0)]
}

/// |∂f/∂x| + |∂f/∂y|.
#[inline]
pub(crate) fn magnitude([across, down]: [i16; 2]) -> u16 {
    across.unsigned_abs() + down.unsigned_abs()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_slope_has_eight_times_its_change() {
        let slope = sobel(|x, y| 10 * x as i16 - 3 * y as i16);
        assert_eq!((slope, magnitude(slope)), ([80, -24], 104));
    }
}
