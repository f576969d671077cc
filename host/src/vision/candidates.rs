//! Candidates of the search for boxes, each with what it gains.
//!
//! A box changes what cells cost within its outline and its shadow. Candidates that lie elsewhere gain
//! what they did before, so that only those near the last box are looked at again.

use super::boxes::{Scored, Search};
use super::leaning::LeaningBox;
use super::raster::Raster;
use crate::geometry::Rect;

/// Candidates that are improved before the best is taken.
const IMPROVED: usize = 3;

/// A box that may be one, with what is known of it at the present cost of cells.
pub(super) struct Candidate {
    start: Scored,
    /// The bounds of all cells that the gain depends on, metres.
    bounds: Rect,
    /// What improvement made of it, if it was tried, and the bounds of all boxes that were tried.
    improved: Option<(Scored, Rect)>,
}

impl Search<'_> {
    /// A candidate and its gain.
    pub(super) fn candidate(&self, seen: LeaningBox, cost: &Raster<f32>) -> Candidate {
        let start = Scored { gain: self.gain(seen, cost), seen };
        Candidate { start, bounds: self.touched(seen), improved: None }
    }

    /// The candidate with the greatest gain after improvement.
    pub(super) fn best(&self, candidates: &mut [Candidate], cost: &Raster<f32>) -> Option<Scored> {
        let mut order: Vec<&mut Candidate> = candidates.iter_mut().collect();
        order.sort_by(|a, b| b.start.gain.total_cmp(&a.start.gain));
        let improved = order.into_iter().take(IMPROVED).map(|candidate| {
            let Candidate { start, bounds, improved } = candidate;
            let (best, _) = improved.get_or_insert_with(|| {
                let mut tried = *bounds;
                let visit = |seen| tried = union(tried, self.touched(seen));
                (self.improve_seen(*start, cost, visit), tried)
            });
            *best
        });
        improved.max_by(|a, b| a.gain.total_cmp(&b.gain))
    }

    /// Brings candidates up to date after a box was explained.
    pub(super) fn renew(
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
        let Rect { x0, y0, x1, y1 } = shadow.map_or(outline, |shadow| union(outline, shadow));
        let cell = 1.0 / self.evidence.frame.scale;
        Rect::new(x0 - cell, y0 - cell, x1 + cell, y1 + cell)
    }
}

fn union(a: Rect, b: Rect) -> Rect {
    Rect::new(a.x0.min(b.x0), a.y0.min(b.y0), a.x1.max(b.x1), a.y1.max(b.y1))
}

fn overlap(a: Rect, b: Rect) -> bool {
    a.x0 <= b.x1 && b.x0 <= a.x1 && a.y0 <= b.y1 && b.y0 <= a.y1
}
