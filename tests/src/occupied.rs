//! How well what was found agrees with true boxes: exact areas of unions of rectangles, boxes missed and invented, true
//! area left uncovered. What is no upright rectangle is judged as strips of one. Metres in the arena frame. Written
//! apart from vision's own geometry, which it judges.

use wmr::geometry::{Arena, Point, Rect};
use wmr::shape::Shape;

/// A true box of which less than this share is covered is missed.
const COVERED_SHARE: f64 = 0.5;
/// A found rectangle of which less than this share lies on true boxes is invented.
const TRUE_SHARE: f64 = 0.25;
/// Rectangles that overlap less than this (intersection over union) are not of the same box.
const SAME_BOX: f64 = 0.3;
/// The greatest distance between the points of a true box that are looked up, metres.
const STEP: f64 = 0.005;

/// The height of the strips that stand for a shape, metres.
const STRIP: f64 = 0.0025;

/// Upright rectangles that together are a shape: itself, or strips as wide as it is half-way up each.
pub fn strips(shape: &Shape) -> Vec<Rect> {
    let Rect { y0: low, y1: high, .. } = shape.bounds();
    let spans = |y: f64| -> Vec<f64> {
        match shape {
            Shape::Rect(rect) => vec![rect.x0, rect.x1],
            Shape::Circle(circle) => {
                let half = (circle.radius.powi(2) - (y - circle.centre.y).powi(2)).max(0.0).sqrt();
                vec![circle.centre.x - half, circle.centre.x + half]
            }
            Shape::Polygon(polygon) => {
                let crossing = |(a, b): (Point, Point)| {
                    ((a.y > y) != (b.y > y)).then(|| a.x + (y - a.y) / (b.y - a.y) * (b.x - a.x))
                };
                let mut ends: Vec<f64> = polygon.edges().filter_map(crossing).collect();
                ends.sort_by(f64::total_cmp);
                ends
            }
        }
    };
    let count = match shape {
        Shape::Rect(_) => 1.0,
        _ => ((high - low) / STRIP).ceil().max(1.0),
    };
    let step = (high - low) / count;
    let row = |index: usize| {
        let y0 = low + step * index as f64;
        let rect = |ends: &[f64]| Rect { x0: ends[0], y0, x1: ends[1], y1: y0 + step };
        spans(y0 + step / 2.0).chunks_exact(2).map(rect).collect::<Vec<_>>()
    };
    (0..count as usize).flat_map(row).collect()
}

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

/// The number of found things, each the rectangles that make it, of which less than a quarter lies on true boxes.
pub fn invented(truth: &[Rect], found: &[Vec<Rect>]) -> usize {
    let is_invented = |thing: &&Vec<Rect>| areas(thing, truth).0 < TRUE_SHARE * areas(thing, &[]).1;
    found.iter().filter(is_invented).count()
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

/// For each true box the index of the found thing that overlaps it most, if one is of the same box.
pub fn partners(truth: &[Rect], found: &[Vec<Rect>]) -> Vec<Option<usize>> {
    let best = |&rect: &Rect| {
        let overlaps = found.iter().map(|thing| overlap(&[rect], thing)).enumerate();
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
        assert_eq!(invented(&truth, &[vec![rect(0.75, 0.0, 1.75, 1.0)]]), 0);
        assert_eq!(invented(&truth, &[vec![rect(0.76, 0.0, 1.76, 1.0)]]), 1);
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
        assert_eq!(partners(&truth, &found.map(|rect| vec![rect])), [Some(1), None]);
    }

    /// A disc of radius 1 has area pi; a triangle of sides 3, 4, 5 has 6; an arrow of 4 by 2 less a notch of 4 by 1 / 2
    /// has 6.
    #[test]
    fn strips_have_the_area_of_their_shape() {
        let polygon = |corners: &[[f64; 2]]| {
            let corners = corners.iter().map(|&corner| corner.into()).collect();
            Shape::Polygon(wmr::shape::Polygon::new(corners).unwrap())
        };
        let disc = wmr::shape::Circle { centre: Point::new(1.0, 2.0), radius: 1.0 };
        for (shape, known) in [
            (Shape::Rect(rect(0.0, 1.0, 2.0, 4.0)), 6.0),
            (Shape::Circle(disc), std::f64::consts::PI),
            (polygon(&[[0.0, 0.0], [4.0, 0.0], [0.0, 3.0]]), 6.0),
            (polygon(&[[0.0, 0.0], [2.0, 1.0], [4.0, 0.0], [4.0, 2.0], [0.0, 2.0]]), 6.0),
        ] {
            let sum: f64 = strips(&shape).into_iter().map(area).sum();
            assert!((sum - known).abs() < 1e-4, "{sum} {known}");
        }
    }
}
