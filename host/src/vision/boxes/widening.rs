//! Margins made wider by what is seen beside a footprint: the rest of a box that leans, and what sticks out of it a
//! little. Metres in the arena frame.

use super::refine::Bounded;
use crate::geometry::Rect;

/// Every outline with the footprint of its box.
pub(super) fn with_outlines<'a>(
    outlines: &'a [Rect],
    bounded: &'a mut [Bounded],
) -> impl Iterator<Item = (Rect, &'a mut Bounded)> {
    outlines.iter().copied().zip(bounded)
}

/// The same footprint with margins that reach over a rectangle as well.
pub(super) fn reaching_over(rect: Rect, bounded: Bounded) -> Bounded {
    let (margin, beyond) = (bounded.margin, beyond(bounded.rect, rect));
    Bounded { margin: [0, 1, 2, 3].map(|edge| margin[edge].max(beyond[edge])), ..bounded }
}

/// Lets the margins of the box beside whose outline a rectangle lies reach over it; false if there is none.
pub(super) fn widen<'a>(
    rect: Rect,
    most: f64,
    boxes: impl Iterator<Item = (Rect, &'a mut Bounded)>,
) -> bool {
    let nearest = boxes
        .map(|(outline, bounded)| (beyond(outline, rect).into_iter().fold(0.0, f64::max), bounded))
        .min_by(|a, b| a.0.total_cmp(&b.0));
    let Some((_, bounded)) = nearest.filter(|nearest| nearest.0 < most) else {
        return false;
    };
    *bounded = reaching_over(rect, *bounded);
    true
}

/// How far a rectangle reaches beyond each edge of another (left, lower, right, upper); negative inside of it.
fn beyond(other: Rect, rect: Rect) -> [f64; 4] {
    [other.x0 - rect.x0, other.y0 - rect.y0, rect.x1 - other.x1, rect.y1 - other.y1]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn margins_reach_over_what_is_seen_and_are_never_made_narrower() {
        let rect = Rect::new(1.0, 1.0, 1.3, 1.4);
        let bounded = Bounded { rect, margin: [0.01, 0.01, 0.02, 0.01] };
        // The top leans to the right and up; left and lower edges are those of the footprint.
        let seen = reaching_over(Rect::new(1.0, 1.0, 1.35, 1.405), bounded);
        assert_eq!(seen.rect, rect);
        for (found, expected) in seen.margin.into_iter().zip([0.01, 0.01, 0.05, 0.01]) {
            assert!((found - expected).abs() < 1e-12, "{:?}", seen.margin);
        }
    }

    #[test]
    fn what_sticks_out_of_an_outline_is_covered_from_the_footprint() {
        let before = Bounded { rect: Rect::new(1.0, 1.0, 1.3, 1.4), margin: [0.01; 4] };
        let (outline, patch) = (Rect::new(1.0, 1.0, 1.35, 1.45), Rect::new(1.34, 1.2, 1.37, 1.25));
        let mut bounded = before;
        assert!(!widen(patch, 0.015, [(outline, &mut bounded)].into_iter()));
        assert_eq!(bounded, before);
        assert!(widen(patch, 0.03, [(outline, &mut bounded)].into_iter()));
        for (found, expected) in bounded.margin.into_iter().zip([0.01, 0.01, 0.07, 0.01]) {
            assert!((found - expected).abs() < 1e-12, "{:?}", bounded.margin);
        }
    }
}
