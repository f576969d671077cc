//! Chance as measurements have it.

/// A normally distributed number with mean 0 and standard deviation 1, never beyond 6: the sum of twelve
/// even ones, whose variance is 1/12 each.
///
/// ```
/// let mut random = fastrand::Rng::with_seed(1);
/// let draws: Vec<f64> = (0..10_000).map(|_| wmr_sim::noise::normal(&mut random)).collect();
/// let square = draws.iter().map(|draw| draw * draw).sum::<f64>() / draws.len() as f64;
/// assert!((square - 1.0).abs() < 0.05);
/// ```
pub fn normal(random: &mut fastrand::Rng) -> f64 {
    (0..12).map(|_| random.f64()).sum::<f64>() - 6.0
}
