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

/// Widens the margins of the outline beside which a rectangle lies; false if there is none.
pub(super) fn widen<'a>(
    rect: Rect,
    most: f64,
    outlines: impl Iterator<Item = (Rect, &'a mut [f64; 4])>,
) -> bool {
    let beyond = |outline: Rect| {
        [outline.x0 - rect.x0, outline.y0 - rect.y0, rect.x1 - outline.x1, rect.y1 - outline.y1]
    };
    let nearest = outlines
        .map(|(outline, margin)| (beyond(outline), margin))
        .map(|(beyond, margin)| (beyond.into_iter().fold(0.0, f64::max), beyond, margin))
        .min_by(|a, b| a.0.total_cmp(&b.0));
    let Some((_, beyond, margin)) = nearest.filter(|nearest| nearest.0 < most) else {
        return false;
    };
    margin.iter_mut().zip(beyond).for_each(|(margin, beyond)| *margin = margin.max(beyond));
    true
}
