//! Boxes that were found in pieces put together: stripes, tape and shadow on a top cut it into parts.

use super::projection::LeaningBox;
use super::search::{Scored, Search};
use crate::geometry::Rect;

/// Two boxes may be one if the area around both is at most this much larger than theirs.
const MERGE_FILL: f64 = 1.25;
/// One box is better than several if it explains this share of what they do.
const MERGE_SHARE: f32 = 0.85;
/// Several that all reach across a rectangle and fill it may as well be one box with stripes: then this
/// share will do. Their edges may be so many cells off.
const STRIPED_SHARE: f32 = 0.55;
const STRIPE_SLACK: f64 = 3.5;
/// One box in place of several must cover this share of each that does not touch it, to so many cells.
const KEPT_SHARE: f64 = 0.8;
const TOUCH: f64 = 2.0;

impl Search<'_> {
    /// Replaces boxes that lie side by side by one around them where that explains nearly as much.
    pub(crate) fn merge(&self, found: &mut Vec<LeaningBox>) {
        let foot = self.foot();
        let mut pair = (0, 1);
        while pair.0 + 1 < found.len() {
            let (a, b) = (found[pair.0].bounds(foot), found[pair.1].bounds(foot));
            pair = match self.merged(found, a, b) {
                Some(next) => {
                    *found = next;
                    (0, 1)
                }
                None if pair.1 + 1 < found.len() => (pair.0, pair.1 + 1),
                None => (pair.0 + 1, pair.0 + 2),
            };
        }
    }

    /// The boxes with all that lie in the bounds of `a` and `b` replaced by one, if that is better.
    fn merged(&self, found: &[LeaningBox], a: Rect, b: Rect) -> Option<Vec<LeaningBox>> {
        let union = Rect::new(a.x0.min(b.x0), a.y0.min(b.y0), a.x1.max(b.x1), a.y1.max(b.y1));
        if union.area() > MERGE_FILL * (a.area() + b.area()) {
            return None;
        }
        let foot = self.foot();
        let (parts, mut rest): (Vec<LeaningBox>, Vec<LeaningBox>) =
            found.iter().copied().partition(|seen| covers(union, seen.bounds(foot)));
        let mut cost = self.unexplained();
        rest.iter().for_each(|&seen| self.explain(&mut cost, seen));
        let starts = parts.iter().map(|part| LeaningBox::within(union, foot, part.lean));
        let improved =
            starts.map(|seen| self.improve(Scored { gain: self.gain(seen, &cost), seen }, &cost));
        let whole = improved.max_by(|a, b| a.gain.total_cmp(&b.gain))?;
        let mut apart = 0.0;
        for &part in &parts {
            apart += self.gain(part, &cost);
            self.explain(&mut cost, part);
        }
        rest.push(whole.seen);
        let share = if self.striped(union, &parts) { STRIPED_SHARE } else { MERGE_SHARE };
        let all = whole.seen.bounds(foot);
        let reach = TOUCH / self.evidence.frame.scale;
        let kept = |part: &LeaningBox| {
            let own = part.bounds(foot);
            covers(all, own) || touches(all, own, reach)
        };
        (parts.iter().all(kept) && whole.gain > share * apart).then_some(rest)
    }

    /// Whether boxes are stripes of a rectangle: all reach across it and together they fill it.
    fn striped(&self, union: Rect, parts: &[LeaningBox]) -> bool {
        let slack = STRIPE_SLACK / self.evidence.frame.scale;
        let foot = self.foot();
        [0, 1].into_iter().any(|axis| {
            let whole: [f64; 4] = union.into();
            let mut spans: Vec<[f64; 4]> =
                parts.iter().map(|part| part.bounds(foot).into()).collect();
            spans.sort_by(|a, b| a[axis].total_cmp(&b[axis]));
            let across = |span: &[f64; 4]| {
                (span[1 - axis] - whole[1 - axis]).abs() < slack
                    && (span[3 - axis] - whole[3 - axis]).abs() < slack
            };
            let joined = spans.windows(2).all(|pair| pair[1][axis] - pair[0][2 + axis] < slack);
            joined && spans.iter().all(across)
        })
    }
}

/// Whether `cover` covers most of a rectangle.
fn covers(cover: Rect, rect: Rect) -> bool {
    let width = rect.x1.min(cover.x1) - rect.x0.max(cover.x0);
    let height = rect.y1.min(cover.y1) - rect.y0.max(cover.y0);
    width > 0.0 && height > 0.0 && width * height > KEPT_SHARE * rect.area()
}

fn touches(a: Rect, b: Rect, reach: f64) -> bool {
    a.x0 < b.x1 + reach && b.x0 < a.x1 + reach && a.y0 < b.y1 + reach && b.y0 < a.y1 + reach
}

#[cfg(test)]
mod tests {
    use super::super::evidence::Evidence;
    use super::*;
    use crate::geometry::Arena;
    use crate::vision::PlanFrame;

    /// The boxes found on a floor of brightness 0 with rectangles of their own brightness.
    fn found(drawn: &[(Rect, f32)]) -> Vec<Rect> {
        let arena = Arena { width: 2.0, height: 1.0 };
        let frame = PlanFrame::new(arena, 100.0, 0.1);
        let evidence = Evidence::drawn(frame, |point| {
            drawn.iter().find(|(rect, _)| rect.contains(point)).map_or(0.0, |(_, dark)| *dark)
        });
        let rects: Vec<Rect> = drawn.iter().map(|(rect, _)| *rect).collect();
        let search = Search { evidence: &evidence, foot: None, lamp: None };
        search.run(&rects).into_iter().map(|seen| seen.base).collect()
    }

    #[test]
    fn a_box_with_a_strip_of_tape_is_one() {
        let strip = |y0: f64, y1: f64| Rect::new(0.5, y0, 1.0, y1);
        let boxes =
            found(&[(strip(0.3, 0.5), -1.0), (strip(0.5, 0.56), -2.2), (strip(0.56, 0.7), -1.0)]);
        assert_eq!(boxes.len(), 1, "{boxes:?}");
        assert!(covers(boxes[0], Rect::new(0.5, 0.3, 1.0, 0.7)), "{boxes:?}");
    }

    #[test]
    fn a_bar_beside_a_large_box_is_not_swallowed() {
        let bar = Rect::new(0.54, 0.2, 0.97, 0.26);
        let boxes = found(&[(Rect::new(0.5, 0.33, 1.0, 0.6), -1.0), (bar, -1.3)]);
        assert_eq!(boxes.len(), 2, "{boxes:?}");
        assert!(boxes.iter().any(|&found| covers(found, bar)), "{boxes:?}");
    }
}
