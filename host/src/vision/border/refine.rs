//! The fit of a map to the border's steps within shrinking reaches, with a lens where that fits clearly better.

use crate::geometry::{Arena, PerSide, Side};
use crate::vision::camera::PlanMap;
use crate::vision::camera::border_fit::{self, Fit, Search, Terms};
use crate::vision::image::Photo;

/// Radial coefficients of lenses that pictures of arenas are taken with, for half of the picture's longer side: wide
/// lenses bend sides outward, hardly any inward. The sides of a cloth that hangs together in folds bend inward by more.
const RADIAL_RANGE: std::ops::Range<f64> = -0.15..0.045;
/// The lens is accepted if it brings the residual below this share of that without.
const LENS_GAIN: f64 = 0.93;

/// What leads the search for the border's steps.
#[derive(Clone, Copy)]
pub(super) struct Guide {
    /// The light's change from inside to outside on each side, if it is known.
    pub(super) change: Option<Changes>,
    /// The side that does not count.
    pub(super) without: Option<Side>,
    /// Whether the map is one that a camera may have.
    pub(super) camera: bool,
}

/// The change of linear light from inside to outside on each side.
pub(super) type Changes = PerSide<[f32; 3]>;

impl Guide {
    pub(super) fn by(change: Changes) -> Self {
        Self { change: Some(change), without: None, camera: false }
    }
}

/// The share of all profiles that show a border.
pub(super) fn seen(shares: &PerSide<f64>) -> f64 {
    shares.values().iter().sum::<f64>() / 4.0
}

/// How far the farthest corner of two maps is apart, pixels.
pub(super) fn farthest(a: &PlanMap, b: &PlanMap, arena: Arena) -> f64 {
    let pairs = a.seen_corners(arena).into_iter().zip(b.seen_corners(arena));
    pairs.map(|(a, b)| (a[0] - b[0]).hypot(a[1] - b[1])).fold(0.0, f64::max)
}

/// Fits the map to the steps found within shrinking reaches, with the lens if that fits better.
pub(super) fn refine(
    photo: &Photo,
    arena: Arena,
    start: &PlanMap,
    reaches: &[f64],
    Guide { change, without, camera }: Guide,
) -> Option<Fit> {
    let mut best: Option<Fit> = None;
    for lens in [false, true] {
        let mut map = start.clone();
        let mut last = None;
        for (round, &reach) in reaches.iter().enumerate() {
            // The last round decides; for those before it half of the profiles are enough.
            let stride = if round + 1 == reaches.len() { 1 } else { 2 };
            let steps = border_fit::steps(photo, &map, arena, &Search { reach, change }, stride);
            let terms = Terms { width: reach, lens, stride, without, camera };
            let fit = border_fit::fit(photo, arena, &map, &steps, terms)
                .filter(|fit| near(photo, arena, (start, &fit.map), reaches));
            let Some(fit) = fit else {
                last = None;
                break;
            };
            map = fit.map.clone();
            last = Some(fit);
        }
        let Some(fit) = last else { continue };
        let better = best.as_ref().is_none_or(|best| {
            let gain = |fit: &Fit| fit.residual / seen(&fit.shares).max(1e-6);
            gain(&fit) < LENS_GAIN * gain(best)
        });
        if better {
            best = Some(fit);
        }
    }
    best
}

/// Whether a fitted map is still the candidate's: its corners lie where steps were searched for, its lens is one.
fn near(
    photo: &Photo,
    arena: Arena,
    (start, fitted): (&PlanMap, &PlanMap),
    reaches: &[f64],
) -> bool {
    let lens = fitted.radial() * (photo.longer_side() / photo.width() as f64).powi(2);
    let most = 3.0 * reaches.iter().copied().fold(0.0, f64::max);
    farthest(start, fitted, arena) < most && RADIAL_RANGE.contains(&lens)
}
