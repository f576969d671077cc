//! The place of a step of light along a line of samples, to a fraction of a sample.

/// Samples on each side from which a derivative is taken: wide enough against noise, and without
/// effect on the place of a symmetric step.
const HALF_WIDTH: usize = 2;
/// The least derivative that is a step, share of the expected change or linear light.
const LEAST_EXPECTED: f32 = 0.2;
const LEAST_ANY: f32 = 0.01;
/// Where any step counts, not the greatest, it has at least this share of the expected change.
const LEAST_ALIKE: f32 = 0.4;
/// Steps of more than this share of the expected change count less.
const GREATEST: f32 = 1.1;

/// A place along a line of samples where the light changes more than beside it.
#[derive(Clone, Copy, Debug)]
struct Peak {
    /// The slope in the middle, and the change of light before it, at it and behind it.
    index: usize,
    slopes: [f32; 3],
}

impl Peak {
    /// The change of light at it.
    fn height(&self) -> f32 {
        self.slopes[1]
    }

    /// The place, an index with a fraction.
    fn place(&self) -> f64 {
        let [before, peak, after] = self.slopes;
        let shift = f64::from(0.5 * (before - after) / (before - 2.0 * peak + after).min(-1e-9));
        (self.index + HALF_WIDTH) as f64 + shift
    }
}

/// The peaks of the change of light along `lights`, in shares of `change` if that is given.
fn peaks(lights: &[[f32; 3]], change: Option<[f32; 3]>) -> impl Iterator<Item = Peak> {
    let axis = change.map(|expected| {
        let square: f32 = expected.iter().map(|value| value * value).sum();
        expected.map(|value| value / square.max(1e-9))
    });
    let slope = move |(last, first): (&[f32; 3], &[f32; 3])| {
        let [r, g, b] = [last[0] - first[0], last[1] - first[1], last[2] - first[2]];
        match axis {
            Some([x, y, z]) => r * x + g * y + b * z,
            None => r.abs().max(g.abs()).max(b.abs()),
        }
    };
    let slopes = lights.iter().skip(2 * HALF_WIDTH).zip(lights).map(slope);
    // No comparison with what is not there holds.
    let mut last = [f32::NAN; 2];
    slopes.enumerate().filter_map(move |(index, after)| {
        let [before, here] = last;
        last = [here, after];
        let is_peak = here >= before && here > after;
        is_peak.then(|| Peak { index: index - 1, slopes: [before, here, after] })
    })
}

/// Where the light changes most along `lights`, as an index with a fraction.
///
/// With `change` (last less first light) only a change of that colour and sign counts. Changes that go on
/// beyond an end are not steps. `None` if there is no clear one.
pub(crate) fn step(lights: &[[f32; 3]], change: Option<[f32; 3]>) -> Option<f64> {
    // A step much greater than the expected one is another edge, such as that of a shadow.
    let fitting = |peak: &Peak| {
        let height = peak.height();
        if change.is_some() && height > GREATEST { GREATEST * GREATEST / height } else { height }
    };
    let best = peaks(lights, change).max_by(|a, b| fitting(a).total_cmp(&fitting(b)))?;
    let least = if change.is_some() { LEAST_EXPECTED } else { LEAST_ANY };
    (best.height() >= least).then(|| best.place())
}

/// All places along `lights` where the light changes by a good part of `change`, as indices with a fraction.
pub(crate) fn steps_like(lights: &[[f32; 3]], change: [f32; 3]) -> impl Iterator<Item = f64> {
    let clear = peaks(lights, Some(change)).filter(|peak| peak.height() >= LEAST_ALIKE);
    clear.map(|peak| peak.place())
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A step from 0 to 1 at `place`, blurred over three samples.
    fn blurred(place: f64) -> Vec<[f32; 3]> {
        (0..20).map(|i| [((f64::from(i) - place) / 3.0 + 0.5).clamp(0.0, 1.0) as f32; 3]).collect()
    }

    #[test]
    fn a_step_is_found_to_a_fraction_of_a_sample() {
        for place in [7.0, 7.3, 7.5, 11.8] {
            let found = step(&blurred(place), Some([1.0; 3])).unwrap();
            assert!((found - place).abs() < 0.1, "{found} for {place}");
        }
    }

    #[test]
    fn of_two_steps_like_one_both_are_told_and_none_that_is_small_or_the_other_way() {
        let at = |i: i32| match i {
            ..10 => 0.0,
            10..20 => 1.0,
            20..30 => 0.3,
            30..40 => 1.1,
            _ => 1.3,
        };
        let lights: Vec<_> = (0..50).map(|i| [at(i); 3]).collect();
        let found: Vec<f64> = steps_like(&lights, [1.0; 3]).collect();
        // A sharp step lies between two samples; its plateau of derivatives ends one sample after that.
        assert_eq!(found.len(), 2, "{found:?}");
        for (place, step) in found.iter().zip([9.5, 29.5]) {
            assert!((place - step).abs() <= 2.0, "{found:?}");
        }
    }

    #[test]
    fn neither_even_light_nor_the_wrong_sign_is_a_step() {
        assert_eq!(step(&[[0.5; 3]; 12], None), None);
        assert_eq!(step(&blurred(7.0), Some([-1.0; 3])), None);
        assert_eq!(step(&[], None), None);
    }
}
