//! Margins made wider by what sticks out of a box a little. Metres in the arena frame.

use super::refine::Bounded;
use crate::geometry::Rect;

/// Every outline with the margins of its box.
pub(super) fn with_margins<'a>(
    outlines: &'a [Rect],
    bounded: &'a mut [Bounded],
) -> impl Iterator<Item = (Rect, &'a mut [f64; 4])> {
    outlines.iter().copied().zip(bounded.iter_mut().map(|bounded| &mut bounded.margin))
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

/// Widens the margins of the outline beside which a rectangle lies; false if there is none.
pub(super) fn widen<'a>(
    rect: Rect,
    most: f64,
    outlines: impl Iterator<Item = (Rect, &'a mut [f64; 4])>,
) -> bool {
    let nearest = outlines
        .map(|(outline, margin)| (beyond(outline, rect), margin))
        .map(|(beyond, margin)| (beyond.into_iter().fold(0.0, f64::max), beyond, margin))
        .min_by(|a, b| a.0.total_cmp(&b.0));
    let Some((_, beyond, margin)) = nearest.filter(|nearest| nearest.0 < most) else {
        return false;
    };
    margin.iter_mut().zip(beyond).for_each(|(margin, beyond)| *margin = margin.max(beyond));
    true
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
}
