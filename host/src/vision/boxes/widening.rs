//! Margins made wider by what sticks out of a box a little. Metres in the arena frame.

use super::refine::Bounded;
use crate::geometry::Rect;

/// The outline of a box, and the rectangle that its margins count from.
#[derive(Clone, Copy)]
pub(super) struct Outline {
    pub(super) seen: Rect,
    /// The footprint, or the outline itself where a known camera shows which way its edges lean: what sticks out of
    /// the top there is as far from the footprint below.
    pub(super) from: Rect,
}

/// Every outline with the margins of its box.
pub(super) fn with_margins<'a>(
    outlines: &'a [Outline],
    bounded: &'a mut [Bounded],
) -> impl Iterator<Item = (Outline, &'a mut [f64; 4])> {
    outlines.iter().copied().zip(bounded.iter_mut().map(|bounded| &mut bounded.margin))
}

/// A rectangle that is its own outline, with its margins.
pub(super) fn as_it_stands(Bounded { rect, margin }: &mut Bounded) -> (Outline, &mut [f64; 4]) {
    (Outline { seen: *rect, from: *rect }, margin)
}

/// The same footprint with margins that reach over an outline as well.
pub(super) fn reaching_over(outline: Rect, Bounded { rect, margin }: Bounded) -> Bounded {
    let beyond = beyond(rect, outline);
    Bounded { rect, margin: [0, 1, 2, 3].map(|edge| margin[edge].max(beyond[edge])) }
}

/// How far a rectangle reaches beyond each edge of an outline (left, lower, right, upper); negative inside of it.
fn beyond(outline: Rect, rect: Rect) -> [f64; 4] {
    [outline.x0 - rect.x0, outline.y0 - rect.y0, rect.x1 - outline.x1, rect.y1 - outline.y1]
}

/// Widens the margins of the outline beside which a rectangle lies, so that they reach over it; false if there is none.
pub(super) fn widen<'a>(
    rect: Rect,
    most: f64,
    outlines: impl Iterator<Item = (Outline, &'a mut [f64; 4])>,
) -> bool {
    let nearest = outlines
        .map(|(outline, margin)| (farthest(outline.seen, rect), outline.from, margin))
        .min_by(|a, b| a.0.total_cmp(&b.0));
    let Some((_, from, margin)) = nearest.filter(|nearest| nearest.0 < most) else {
        return false;
    };
    margin
        .iter_mut()
        .zip(beyond(from, rect))
        .for_each(|(margin, beyond)| *margin = margin.max(beyond));
    true
}

/// How far a rectangle reaches beyond an outline at most; 0 inside of it.
fn farthest(outline: Rect, rect: Rect) -> f64 {
    beyond(outline, rect).into_iter().fold(0.0, f64::max)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn margins_reach_over_what_is_seen_and_are_never_made_narrower() {
        let bounded =
            Bounded { rect: Rect::new(1.0, 1.0, 1.3, 1.4), margin: [0.01, 0.01, 0.02, 0.01] };
        // The top leans to the right and up; left and lower edges are those of the footprint.
        let seen = reaching_over(Rect::new(1.0, 1.0, 1.35, 1.405), bounded);
        assert_eq!(seen.rect, bounded.rect);
        for (found, expected) in seen.margin.into_iter().zip([0.01, 0.01, 0.05, 0.01]) {
            assert!((found - expected).abs() < 1e-12, "{:?}", seen.margin);
        }
    }

    #[test]
    fn what_sticks_out_of_an_outline_is_covered_from_the_footprint() {
        let from = Rect::new(1.0, 1.0, 1.3, 1.4);
        let outline = Outline { seen: Rect::new(1.0, 1.0, 1.35, 1.45), from };
        let patch = Rect::new(1.34, 1.2, 1.37, 1.25);
        let mut margin = [0.01; 4];
        assert!(!widen(patch, 0.015, [(outline, &mut margin)].into_iter()));
        assert_eq!(margin, [0.01; 4]);
        assert!(widen(patch, 0.03, [(outline, &mut margin)].into_iter()));
        assert!((from.widened(margin).x1 - patch.x1).abs() < 1e-12, "{margin:?}");
        assert_eq!(margin[..2], [0.01; 2]);
    }
}
