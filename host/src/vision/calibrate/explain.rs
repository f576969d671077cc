//! What is known before a picture is looked at, and which explanations of it are weighed.
//!
//! Most sides of a border are found to a few tenths of a pixel; now and then one is mistaken as a whole, by
//! several pixels: a wall's shadow or its top is taken for its foot, which happens only where such edges lie side
//! by side. Which side it was a single camera shows but weakly, so five explanations are fitted, none and each
//! side mistaken; the likeliest gives the camera, and where the others differ from it the camera is less sure.

use super::KnownOfCamera;
use super::model::{Prior, Problem, Unknown};
use super::observe::ObservedBorder;
use super::solve::{Solution, solve, starts};
use crate::geometry::{Arena, Point, Side};
use crate::vision::camera::{FOCAL_SPREAD, USUAL_FOCAL};
use crate::vision::image::zoom;

/// How far the principal point usually lies from the picture's centre, a share of the picture's longer side.
const CENTRE_SPREAD: f64 = 0.01;
/// How far the radial coefficient usually lies from 0.
const RADIAL_SPREAD: f64 = 0.2;
/// A tape measure tells a camera's height to this, metres: where in the lens the rays meet is not marked.
pub(super) const HEIGHT_SPREAD: f64 = 0.01;
/// A focal length from another calibration is good to this share.
const GIVEN_FOCAL_SPREAD: f64 = 0.005;
/// A tape measure tells the arena's sides to this, metres.
const SIDE_TAPE: f64 = 0.001;
/// How far off a side is that was mistaken, and how much farther at its ends, pixels at a longer side of 640.
const MISTAKEN_SHIFT: f64 = 4.0;
const MISTAKEN_SLANT: f64 = 0.5;
/// How often a side is mistaken that lies alone, and one that has company, a share of its own change of light:
/// of 280 sides of ray-traced borders 0 of 200 with less than the first, and 14 of 50 with more than the second.
const MISTAKEN_ALONE: f64 = 0.005;
const MISTAKEN_IN_COMPANY: f64 = 0.25;
const COMPANY: [f64; 2] = [0.1, 0.2];

/// The explanations of what was seen, each with its probability, the likeliest first.
pub(super) struct Explained<'a> {
    best: Solution<'a>,
    others: Vec<(f64, Solution<'a>)>,
    /// The side that the likeliest explanation takes for mistaken.
    pub(super) mistaken: Option<Side>,
}

impl<'a> Explained<'a> {
    pub(super) fn best(&self) -> &Solution<'a> {
        &self.best
    }

    /// The standard deviation of an unknown about its likeliest value.
    pub(super) fn spread(&self, unknown: Unknown) -> f64 {
        let value = self.best.value(unknown);
        let of = |share: f64, one: &Solution| {
            share * (one.variance(unknown) + (one.value(unknown) - value).powi(2))
        };
        let share = 1.0 - self.others.iter().map(|(share, _)| share).sum::<f64>();
        let others: f64 = self.others.iter().map(|(share, one)| of(*share, one)).sum();
        (of(share, &self.best) + others).sqrt()
    }
}

/// Fits and weighs all explanations; `None` if no camera sees anything like it.
pub(super) fn explain<'a>(
    arena: Arena,
    views: &'a [Vec<&'a ObservedBorder>],
    known: KnownOfCamera,
) -> Option<Explained<'a>> {
    let sound = problem(arena, views, known, None)?;
    let starts = starts(&sound, known)?;
    let sound = solve(sound, &starts)?;
    let start = [sound.state.clone()];
    let mut all = vec![(sound.evidence(), None, sound)];
    // Corners that a person has pointed at are not mistaken.
    let by_hand = views.first()?.iter().any(|border| border.by_hand());
    let sides: &[Side] = if by_hand { &[] } else { &Side::ALL };
    all.extend(sides.iter().filter_map(|&side| {
        let found = solve(problem(arena, views, known, Some(side))?, &start)?;
        let company = views[0].iter().map(|border| border.company[side]).fold(0.0, f64::max);
        Some((found.evidence() + odds(company).ln(), Some(side), found))
    }));
    all.sort_by(|a, b| b.0.total_cmp(&a.0));
    let most = all.first()?.0;
    let sum: f64 = all.iter().map(|(evidence, ..)| (evidence - most).exp()).sum();
    let mut all = all.into_iter();
    let (_, mistaken, best) = all.next()?;
    let others = all.map(|(evidence, _, found)| ((evidence - most).exp() / sum, found)).collect();
    Some(Explained { best, others, mistaken })
}

/// How much likelier than not it is that a side with so much company was mistaken.
fn odds(company: f64) -> f64 {
    let [alone, beset] = COMPANY;
    let beset = ((company - alone) / (beset - alone)).clamp(0.0, 1.0);
    let share = MISTAKEN_ALONE * (MISTAKEN_IN_COMPANY / MISTAKEN_ALONE).powf(beset);
    share / (1.0 - share)
}

/// The least squares with all that is known beforehand, if one side is `mistaken`.
fn problem<'a>(
    arena: Arena,
    views: &'a [Vec<&'a ObservedBorder>],
    known: KnownOfCamera,
    mistaken: Option<Side>,
) -> Option<Problem<'a>> {
    let first = views.first()?.first()?;
    let [width, height] = first.size.map(|count| count as f64);
    let longer = first.longer_side();
    let zoom = zoom(longer);
    let (focal, spread) = match known {
        KnownOfCamera { focal: Some(focal), .. } => (focal, GIVEN_FOCAL_SPREAD),
        // A height tells the focal length better than any usual one, of long lenses too.
        KnownOfCamera { height: Some(_), .. } => (USUAL_FOCAL * longer, 10.0 * FOCAL_SPREAD),
        _ => (USUAL_FOCAL * longer, FOCAL_SPREAD),
    };
    let centre = |axis, length: f64| Prior {
        unknown: Unknown::Centre(axis),
        value: (length - 1.0) / 2.0,
        spread: CENTRE_SPREAD * longer,
    };
    let mut priors = vec![
        Prior { unknown: Unknown::LogFocal, value: focal.ln(), spread },
        centre(0, width),
        centre(1, height),
        Prior { unknown: Unknown::Radial, value: 0.0, spread: RADIAL_SPREAD },
    ];
    let height = |value| Prior { unknown: Unknown::Height, value, spread: HEIGHT_SPREAD };
    priors.extend(known.height.map(height));
    for (stand, seen) in views.iter().enumerate() {
        let first = seen.first()?;
        let scale = first.map.scale_at(Point::new(arena.width / 2.0, arena.height / 2.0));
        // Two ends that are off independently make their mean and half their difference so.
        let share = std::f64::consts::FRAC_1_SQRT_2;
        let usual = first.side_blurs.map(|blur| share * blur.hypot(SIDE_TAPE * scale));
        let offset = |(side, which): (Side, usize)| {
            let spread = if mistaken == Some(side) && stand == 0 {
                [MISTAKEN_SHIFT, MISTAKEN_SLANT][which] * zoom
            } else {
                usual[side]
            };
            Prior { unknown: Unknown::Offset { stand, side, which }, value: 0.0, spread }
        };
        let ends = Side::ALL.into_iter().flat_map(|side| [(side, 0), (side, 1)]);
        priors.extend(ends.map(offset));
    }
    Some(Problem { arena, views, priors })
}
