//! Candidates of the search for boxes, each with what it gains.
//!
//! A box changes what cells cost within its outline and its shadow. Candidates that lie elsewhere gain
//! what they did before, so that only those near the last box are looked at again.

use super::projection::LeaningBox;
use super::search::{Scored, Search};
use crate::geometry::Rect;
use crate::vision::image::Raster;

/// Candidates that are improved before the best is taken.
const IMPROVED: usize = 3;

/// A box that may be one, with what is known of it at the present cost of cells.
pub(crate) struct Candidate {
    start: Scored,
    /// The bounds of all cells that the gain depends on, metres.
    bounds: Rect,
    /// What improvement made of it, if it was tried, and the bounds of all boxes that were tried.
    improved: Option<(Scored, Rect)>,
}

impl Search<'_> {
    /// A candidate and its gain.
    pub(crate) fn candidate(&self, seen: LeaningBox, cost: &Raster<f32>) -> Candidate {
        let start = Scored { gain: self.gain(seen, cost), seen };
        Candidate { start, bounds: self.touched(seen), improved: None }
    }

    /// The candidate with the greatest gain after improvement.
    pub(crate) fn best(&self, candidates: &mut [Candidate], cost: &Raster<f32>) -> Option<Scored> {
        let mut order: Vec<&mut Candidate> = candidates.iter_mut().collect();
        order.sort_by(|a, b| b.start.gain.total_cmp(&a.start.gain));
        let improved = order.into_iter().take(IMPROVED).map(|candidate| {
            let Candidate { start, bounds, improved } = candidate;
            let (best, _) = improved.get_or_insert_with(|| {
                let mut tried = *bounds;
                let visit = |seen| tried = tried.union(self.touched(seen));
                (self.improve_seen(*start, cost, visit), tried)
            });
            *best
        });
        improved.max_by(|a, b| a.gain.total_cmp(&b.gain))
    }

    /// Brings candidates up to date after a box was explained.
    pub(crate) fn renew(
        &self,
        candidates: &mut [Candidate],
        cost: &Raster<f32>,
        explained: LeaningBox,
    ) {
        let changed = self.touched(explained);
        for candidate in candidates {
            if overlap(changed, candidate.bounds) {
                *candidate = self.candidate(candidate.start.seen, cost);
            } else if candidate.improved.is_some_and(|(_, tried)| overlap(changed, tried)) {
                candidate.improved = None;
            }
        }
    }

    /// The bounds of a box's outline and shadow and a cell more, metres.
    fn touched(&self, seen: LeaningBox) -> Rect {
        let outline = seen.bounds(self.foot());
        let shadow = self.lamp.and_then(|lamp| Some(lamp.shadow(seen)?.bounds(lamp.foot)));
        let Rect { x0, y0, x1, y1 } = shadow.map_or(outline, |shadow| outline.union(shadow));
        let cell = 1.0 / self.evidence.frame.scale;
        Rect::new(x0 - cell, y0 - cell, x1 + cell, y1 + cell)
    }
}

fn overlap(a: Rect, b: Rect) -> bool {
    a.x0 <= b.x1 && b.x0 <= a.x1 && a.y0 <= b.y1 && b.y0 <= a.y1
}

#[cfg(test)]
mod tests {
    use super::super::evidence::Evidence;
    use super::*;
    use crate::geometry::{Arena, Point};
    use crate::vision::PlanFrame;

    #[test]
    fn candidates_that_are_kept_gain_what_they_would_if_looked_at_again() {
        let drawn =
            [(0.3, 0.3), (0.45, 0.5), (1.5, 0.6)].map(|(x, y)| Rect::new(x, y, x + 0.2, y + 0.2));
        let frame = PlanFrame::new(Arena { width: 2.0, height: 1.0 }, 100.0, 0.1);
        let evidence = Evidence::drawn(frame, |point| {
            let dark = drawn.iter().position(|rect| rect.contains(point));
            dark.map_or(0.0, |index| -1.0 - 0.2 * index as f32)
        });
        let search = Search { evidence: &evidence, foot: Some(Point::new(1.0, 0.5)), lamp: None };
        let starts = drawn.map(|base| LeaningBox { base, lean: 1.02 });
        let mut cost = search.unexplained();
        let mut kept: Vec<Candidate> =
            starts.iter().map(|&seen| search.candidate(seen, &cost)).collect();
        for _ in 0..drawn.len() {
            let best = search.best(&mut kept, &cost).unwrap();
            let mut all: Vec<Candidate> =
                starts.iter().map(|&seen| search.candidate(seen, &cost)).collect();
            let expected = search.best(&mut all, &cost).unwrap();
            assert_eq!((best.gain, best.seen), (expected.gain, expected.seen));
            search.explain(&mut cost, best.seen);
            search.renew(&mut kept, &cost, best.seen);
        }
        // Far from the last box nothing was looked at again.
        assert!(kept.iter().any(|candidate| candidate.improved.is_some()));
    }
}
