//! How well found rectangles agree with true ones: exact areas of unions, boxes missed and invented, true area left
//! uncovered. Metres in the arena frame. Written apart from vision's own geometry, which it judges.

use wmr::geometry::{Arena, Rect};

/// A true box of which less than this share is covered is missed.
const COVERED_SHARE: f64 = 0.5;
/// A found rectangle of which less than this share lies on true boxes is invented.
const TRUE_SHARE: f64 = 0.25;
/// Rectangles that overlap less than this (intersection over union) are not of the same box.
const SAME_BOX: f64 = 0.3;
/// The greatest distance between the points of a true box that are looked up, metres.
const STEP: f64 = 0.005;

fn area(rect: Rect) -> f64 {
    (rect.x1 - rect.x0).max(0.0) * (rect.y1 - rect.y0).max(0.0)
}

fn intersection(a: Rect, b: Rect) -> Rect {
    Rect { x0: a.x0.max(b.x0), y0: a.y0.max(b.y0), x1: a.x1.min(b.x1), y1: a.y1.min(b.y1) }
}

/// The parts of rectangles inside the arena; those wholly outside are left out.
pub fn inside(rects: &[Rect], arena: Arena) -> Vec<Rect> {
    let whole = Rect { x0: 0.0, y0: 0.0, x1: arena.width, y1: arena.height };
    rects.iter().map(|&rect| intersection(rect, whole)).filter(|&rect| area(rect) > 0.0).collect()
}

/// The areas of intersection and union of two unions of rectangles, square metres: on the grid that all their edges
/// make, every cell is wholly inside or outside of each rectangle.
pub fn areas(a: &[Rect], b: &[Rect]) -> (f64, f64) {
    let sorted = |ends: fn(&Rect) -> [f64; 2]| {
        let mut ends: Vec<f64> = a.iter().chain(b).flat_map(ends).collect();
        ends.sort_by(f64::total_cmp);
        ends
    };
    let (columns, rows) = (sorted(|rect| [rect.x0, rect.x1]), sorted(|rect| [rect.y0, rect.y1]));
    let mut sums = (0.0, 0.0);
    for x in columns.windows(2) {
        for y in rows.windows(2) {
            let (column, row) = ((x[0] + x[1]) / 2.0, (y[0] + y[1]) / 2.0);
            let holds = |rects: &[Rect]| {
                rects.iter().any(|r| r.x0 < column && column < r.x1 && r.y0 < row && row < r.y1)
            };
            let cell = (x[1] - x[0]) * (y[1] - y[0]);
            let (in_a, in_b) = (holds(a), holds(b));
            sums.0 += if in_a && in_b { cell } else { 0.0 };
            sums.1 += if in_a || in_b { cell } else { 0.0 };
        }
    }
    sums
}

/// Intersection over union of the occupied area; 1 if both are empty.
pub fn overlap(truth: &[Rect], found: &[Rect]) -> f64 {
    let (intersection, union) = areas(truth, found);
    if union > 0.0 { intersection / union } else { 1.0 }
}

/// The share of a rectangle that lies on others.
fn share_on(rect: Rect, others: &[Rect]) -> f64 {
    let parts: Vec<_> = others.iter().map(|&other| intersection(other, rect)).collect();
    let parts: Vec<_> = parts.into_iter().filter(|&part| area(part) > 0.0).collect();
    areas(&[rect], &parts).0 / area(rect)
}

/// The number of true boxes that are less than half covered.
pub fn missed(truth: &[Rect], found: &[Rect]) -> usize {
    truth.iter().filter(|&&rect| share_on(rect, found) < COVERED_SHARE).count()
}

/// The number of found rectangles of which less than a quarter lies on true boxes.
pub fn invented(truth: &[Rect], found: &[Rect]) -> usize {
    found.iter().filter(|&&rect| share_on(rect, truth) < TRUE_SHARE).count()
}

/// The greatest distance of a point of a true box from everything found, metres: 0 without true boxes, infinite
/// if there are some and nothing was found.
pub fn uncovered(truth: &[Rect], found: &[Rect]) -> f64 {
    let places = |low: f64, high: f64| {
        let count = ((high - low) / STEP).ceil().max(1.0);
        (0..=count as usize).map(move |i| low + (high - low) * i as f64 / count)
    };
    let distance = |x: f64, y: f64| {
        let to =
            |r: &Rect| (r.x0 - x).max(x - r.x1).max(0.0).hypot((r.y0 - y).max(y - r.y1).max(0.0));
        found.iter().map(to).fold(f64::INFINITY, f64::min)
    };
    let points = truth
        .iter()
        .flat_map(|r| places(r.x0, r.x1).flat_map(|x| places(r.y0, r.y1).map(move |y| (x, y))));
    points.map(|(x, y)| distance(x, y)).fold(0.0, f64::max)
}

/// For each true box the index of the found rectangle that overlaps it most, if one is of the same box.
pub fn partners(truth: &[Rect], found: &[Rect]) -> Vec<Option<usize>> {
    let best = |&rect: &Rect| {
        let overlaps = found.iter().map(|&other| overlap(&[rect], &[other])).enumerate();
        let best = overlaps.max_by(|a, b| a.1.total_cmp(&b.1));
        best.filter(|&(_, overlap)| overlap >= SAME_BOX).map(|(index, _)| index)
    };
    truth.iter().map(best).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn rect(x0: f64, y0: f64, x1: f64, y1: f64) -> Rect {
        Rect { x0, y0, x1, y1 }
    }

    fn near(a: f64, b: f64) -> bool {
        (a - b).abs() < 1e-12
    }

    /// Two true unit squares half upon each other fill 1.5; a found 1 × 1 covers the right one.
    #[test]
    fn overlap_counts_shared_area_once() {
        let truth = [rect(0.0, 0.0, 1.0, 1.0), rect(0.5, 0.0, 1.5, 1.0)];
        let (both, either) = areas(&truth, &[rect(0.5, 0.0, 1.5, 1.0)]);
        assert!(near(both, 1.0) && near(either, 1.5), "{both} {either}");
        assert!(near(overlap(&truth, &[rect(1.0, 0.0, 2.0, 1.0)]), 0.25));
    }

    #[test]
    fn nothing_agrees_with_nothing_and_with_nothing_else() {
        assert_eq!(overlap(&[], &[]), 1.0);
        assert_eq!(overlap(&[rect(0.0, 0.0, 1.0, 1.0)], &[]), 0.0);
        assert_eq!(uncovered(&[], &[]), 0.0);
        assert_eq!(uncovered(&[rect(0.0, 0.0, 1.0, 1.0)], &[]), f64::INFINITY);
    }

    /// Half a box is covered by two thin rectangles that overlap each other: 0.3 + 0.3 - 0.1.
    #[test]
    fn a_box_is_missed_below_half_and_a_rectangle_invented_below_a_quarter() {
        let truth = [rect(0.0, 0.0, 1.0, 1.0)];
        let found = [rect(0.0, 0.0, 0.3, 1.0), rect(0.2, 0.0, 0.5, 1.0)];
        assert_eq!(missed(&truth, &found), 0);
        assert_eq!(missed(&truth, &[found[0], rect(0.2, 0.0, 0.49, 1.0)]), 1);
        assert_eq!(invented(&truth, &[rect(0.75, 0.0, 1.75, 1.0)]), 0);
        assert_eq!(invented(&truth, &[rect(0.76, 0.0, 1.76, 1.0)]), 1);
    }

    /// The far corner sticks out by 3 and 4: 5 metres.
    #[test]
    fn the_corner_that_sticks_out_farthest_counts() {
        assert!(near(uncovered(&[rect(0.0, 0.0, 4.0, 5.0)], &[rect(-1.0, -1.0, 1.0, 1.0)]), 5.0));
        assert!(near(uncovered(&[rect(0.0, 0.0, 1.0, 1.0)], &[rect(-1.0, -1.0, 1.0, 0.9)]), 0.1));
    }

    #[test]
    fn what_lies_outside_the_arena_does_not_count() {
        let arena = Arena { width: 2.0, height: 1.0 };
        let found = [rect(-1.0, 0.5, 0.5, 2.0), rect(2.0, 0.0, 3.0, 1.0)];
        assert_eq!(inside(&found, arena), [rect(0.0, 0.5, 0.5, 1.0)]);
    }

    #[test]
    fn a_partner_overlaps_most_and_enough() {
        let truth = [rect(0.0, 0.0, 1.0, 1.0), rect(5.0, 0.0, 6.0, 1.0)];
        let found = [rect(0.0, 0.0, 1.0, 0.4), rect(0.0, 0.0, 1.0, 0.5), rect(5.9, 0.0, 6.9, 1.0)];
        assert_eq!(partners(&truth, &found), [Some(1), None]);
    }
}
