//! The simplest shape that fits a contour: a disc, or a polygon with few corners.
//!
//! ```text
//! contour ─► disc, if all points lie on one circle
//!         └► corners (Douglas and Peucker) ─► edges fitted to the points between ─► polygon
//! ```
//! What sticks out of the shape by no more than the tolerance is a matter of its margin, which covers it:
//! shape and margin together hold the whole contour. Metres in the arena frame.
//!
//! Deviation: the paper's obstacles are upright rectangles [Alghannam, Sec. II.A].

use crate::geometry::{Point, square_to_leg};
use crate::shape::{Circle, Polygon, Shape};

/// A shape with how much further out the contour lies at most, metres.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct FittedShape {
    pub(crate) shape: Shape,
    pub(crate) margin: f64,
}

/// A polygon has at most so many corners; what has more is no obstacle with a shape of its own.
const MOST_CORNERS: usize = 32;
/// A disc is told from a polygon by at least so many points of its contour.
const LEAST_DISC_POINTS: usize = 16;
/// The points of a contour lie this near to a disc's circle, in the mean, as a share of the tolerance.
const DISC_SHARE: f64 = 0.45;
/// The share at either end of an edge that its line is not fitted to: corners are rounded by blur.
const EDGE_END: f64 = 0.15;
/// A corner is moved to where the lines of its edges meet only if these turn by so much, radians, and by
/// no more than so many tolerances.
const LEAST_TURN: f64 = 0.3;
const MOST_MOVED: f64 = 2.5;
/// An edge of a cut corner is shorter than so many tolerances.
const SHORT: f64 = 5.0;

/// The shape of a closed contour whose points are off by less than `tolerance` metres; `None` if nothing
/// simple fits.
///
/// Of a strip that is no wider than the tolerance only one side would be left. So the tolerance is at most half of
/// the width, 2 A / l for a strip of area A whose outline has the length l.
pub(crate) fn fit(contour: &[Point], tolerance: f64) -> Option<FittedShape> {
    let tolerance = tolerance.min(width(contour) / 2.0);
    // What lies flat on the arena's border encloses nothing.
    if tolerance <= 0.0 {
        return None;
    }
    let disc = disc(contour, tolerance);
    let shape = match disc {
        Some(disc) => Shape::Circle(disc),
        None => Shape::Polygon(polygon(contour, tolerance)?),
    };
    let outside = contour.iter().map(|&point| shape.distance(point)).fold(0.0, f64::max);
    Some(FittedShape { shape, margin: outside })
}

/// How wide what a closed contour encloses is if it is a strip, metres; half of its sides for a square.
fn width(contour: &[Point]) -> f64 {
    let next = || contour.iter().cycle().skip(1);
    let doubled: f64 = contour.iter().zip(next()).map(|(a, b)| a.x * b.y - b.x * a.y).sum();
    let outline: f64 = contour.iter().zip(next()).map(|(a, b)| a.distance(*b)).sum();
    doubled.abs() / outline
}

/// The circle through the contour's points by least squares (Kåsa), if they lie on it and all around it.
fn disc(contour: &[Point], tolerance: f64) -> Option<Circle> {
    if contour.len() < LEAST_DISC_POINTS {
        return None;
    }
    let count = contour.len() as f64;
    let mean = |of: &dyn Fn(&Point) -> f64| contour.iter().map(of).sum::<f64>() / count;
    let (mx, my) = (mean(&|p| p.x), mean(&|p| p.y));
    // With u, v from the mean: the centre solves [uu uv; uv vv] c = [u(uu+vv); v(uu+vv)] / 2.
    let uu = mean(&|p| (p.x - mx).powi(2));
    let vv = mean(&|p| (p.y - my).powi(2));
    let uv = mean(&|p| (p.x - mx) * (p.y - my));
    let square = |p: &Point| (p.x - mx).powi(2) + (p.y - my).powi(2);
    let (su, sv) = (mean(&|p| (p.x - mx) * square(p)), mean(&|p| (p.y - my) * square(p)));
    let det = uu * vv - uv * uv;
    let (cu, cv) = ((su * vv - sv * uv) / (2.0 * det), (sv * uu - su * uv) / (2.0 * det));
    let radius = (cu * cu + cv * cv + uu + vv).sqrt();
    let centre = Point::new(mx + cu, my + cv);
    let off = |p: &Point| (p.distance(centre) - radius).abs();
    let worst = contour.iter().map(off).fold(0.0, f64::max);
    let root = mean(&|p| off(p).powi(2)).sqrt();
    // A disc as small as the tolerance is a polygon's corner; one that is not closed has its mean elsewhere.
    let is_disc = radius.is_finite()
        && radius > 3.0 * tolerance
        && cu.hypot(cv) < tolerance
        && worst < 1.5 * tolerance
        && root < DISC_SHARE * tolerance;
    is_disc.then_some(Circle { centre, radius })
}

fn polygon(contour: &[Point], tolerance: f64) -> Option<Polygon> {
    let corners = corners(contour, tolerance).filter(|corners| corners.len() >= 3)?;
    let count = corners.len();
    let edges: Vec<Edge> = (0..count)
        .map(|index| {
            let (from, to) = (corners[index], corners[(index + 1) % count]);
            let line = Line::along(&between(contour, from, to));
            Edge { from: contour[from], to: contour[to], line }
        })
        .collect();
    let edges = without_cut_corners(edges, tolerance);
    let count = edges.len();
    let moved = |index: usize| {
        let (before, after) = (edges[(index + count - 1) % count], edges[index]);
        // Where a cut corner was left out, the neighbours' ends lie apart.
        let at = middle(before.to, after.from);
        let meeting = before.line.zip(after.line).and_then(|(a, b)| a.meet(b));
        meeting.filter(|meeting| meeting.distance(at) < MOST_MOVED * tolerance).unwrap_or(at)
    };
    let fitted = Polygon::new((0..count).map(moved).collect());
    let plain = || Polygon::new(corners.iter().map(|&corner| contour[corner]).collect());
    fitted.or_else(|_| plain()).ok()
}

/// A part of the contour between two corners, with the line that fits it.
#[derive(Clone, Copy, Debug)]
struct Edge {
    from: Point,
    to: Point,
    line: Option<Line>,
}

/// The edges without those that blur made of a corner: short ones between two whose lines meet beside them.
fn without_cut_corners(mut edges: Vec<Edge>, tolerance: f64) -> Vec<Edge> {
    let is_cut = |edges: &[Edge], index: usize| {
        let count = edges.len();
        let edge = edges[index];
        let [before, after] = [edges[(index + count - 1) % count], edges[(index + 1) % count]];
        let near =
            |meeting: &Point| meeting.distance(middle(edge.from, edge.to)) < MOST_MOVED * tolerance;
        let is_short = edge.from.distance(edge.to) < SHORT * tolerance;
        let meeting = || before.line.zip(after.line).and_then(|(a, b)| a.meet(b));
        is_short && meeting().is_some_and(|meeting| near(&meeting))
    };
    while edges.len() > 3
        && let Some(cut) = (0..edges.len()).find(|&index| is_cut(&edges, index))
    {
        edges.remove(cut);
    }
    edges
}

fn middle(a: Point, b: Point) -> Point {
    Point::new((a.x + b.x) / 2.0, (a.y + b.y) / 2.0)
}

/// The points of the closed contour from one index to another.
fn between(contour: &[Point], from: usize, to: usize) -> Vec<Point> {
    let count = contour.len();
    let steps = (to + count - from) % count;
    (0..=steps).map(|step| contour[(from + step) % count]).collect()
}

/// The indices of corners such that no point of the closed contour is further than `tolerance` from the
/// straight line between its two corners (Douglas and Peucker, 1973); `None` if that asks for more than
/// [`MOST_CORNERS`], or if the contour is one point.
fn corners(contour: &[Point], tolerance: f64) -> Option<Vec<usize>> {
    let count = contour.len();
    let furthest = |from: Point| {
        (0..count).max_by(|&a, &b| from.distance(contour[a]).total_cmp(&from.distance(contour[b])))
    };
    // The two ends of the longest way across: both are corners of any polygon that fits.
    let first = furthest(*contour.first()?)?;
    let second = furthest(contour[first]).filter(|&second| second != first)?;
    let mut kept = vec![first, second];
    let mut open = vec![(first, second), (second, first)];
    while let Some((from, to)) = open.pop() {
        let points = between(contour, from, to);
        let (a, b) = (contour[from], contour[to]);
        let off = |&(_, p): &(usize, &Point)| square_to_leg(*p, a, b);
        let worst = points.iter().enumerate().max_by(|p, q| off(p).total_cmp(&off(q)));
        if let Some((step, point)) = worst
            && square_to_leg(*point, a, b) > tolerance * tolerance
        {
            let middle = (from + step) % count;
            if kept.len() == MOST_CORNERS {
                return None;
            }
            kept.push(middle);
            open.extend([(from, middle), (middle, to)]);
        }
    }
    // In the order of the contour, beginning anywhere.
    kept.sort_unstable();
    Some(kept)
}

/// A line through a point in a direction.
#[derive(Clone, Copy, Debug)]
struct Line {
    at: Point,
    direction: (f64, f64),
}

impl Line {
    /// The line nearest to the middle part of the points, by total least squares; `None` of too few.
    fn along(points: &[Point]) -> Option<Self> {
        let left_out = (EDGE_END * points.len() as f64).ceil() as usize;
        let points = points.get(left_out..points.len().saturating_sub(left_out))?;
        if points.len() < 4 {
            return None;
        }
        let count = points.len() as f64;
        let x = points.iter().map(|p| p.x).sum::<f64>() / count;
        let y = points.iter().map(|p| p.y).sum::<f64>() / count;
        let moment =
            |of: fn(f64, f64) -> f64| points.iter().map(|p| of(p.x - x, p.y - y)).sum::<f64>();
        let (xx, xy, yy) = (moment(|x, _| x * x), moment(|x, y| x * y), moment(|_, y| y * y));
        let angle = 0.5 * (2.0 * xy).atan2(xx - yy);
        Some(Self { at: Point::new(x, y), direction: (angle.cos(), angle.sin()) })
    }

    /// Where two lines meet that differ enough in direction.
    fn meet(self, other: Self) -> Option<Point> {
        let ((ux, uy), (wx, wy)) = (self.direction, other.direction);
        let sine = ux * wy - uy * wx;
        let along = ((other.at.x - self.at.x) * wy - (other.at.y - self.at.y) * wx) / sine;
        let meeting = Point::new(self.at.x + along * ux, self.at.y + along * uy);
        (sine.abs() > LEAST_TURN.sin()).then_some(meeting)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;
    use std::f64::consts::TAU;

    /// Points a millimetre apart along a closed outline, each off by up to half of `noise`.
    fn drawn(corners: &[[f64; 2]], noise: f64) -> Vec<Point> {
        let mut random = fastrand::Rng::with_seed(3);
        let edges = corners.iter().zip(corners.iter().cycle().skip(1));
        let points = edges.flat_map(|(a, b)| {
            let steps = ((b[0] - a[0]).hypot(b[1] - a[1]) * 1000.0) as usize;
            (0..steps).map(move |i| {
                let part = i as f64 / steps as f64;
                [a[0] + part * (b[0] - a[0]), a[1] + part * (b[1] - a[1])]
            })
        });
        let points: Vec<[f64; 2]> = points.collect();
        let mut off = || noise * (random.f64() - 0.5);
        points.into_iter().map(|[x, y]| Point::new(x + off(), y + off())).collect()
    }

    #[test]
    fn a_turned_rectangle_has_four_corners_within_a_fraction_of_the_noise() {
        let turned = [[0.3, 0.1], [0.5, 0.2], [0.4, 0.4], [0.2, 0.3]];
        let fitted = fit(&drawn(&turned, 0.002), 0.003).unwrap();
        let Shape::Polygon(polygon) = &fitted.shape else { panic!("{fitted:?}") };
        assert_eq!(polygon.corners().len(), 4);
        for corner in polygon.corners() {
            let near = turned.iter().map(|&at| corner.distance(at.into())).fold(1.0, f64::min);
            assert!(near < 0.0005, "{corner:?}");
        }
        assert!(fitted.margin < 0.002, "{}", fitted.margin);
    }

    #[test]
    fn a_circle_is_a_disc_and_half_of_one_is_none() {
        let at = |part: f64| Point::new(0.5 + 0.1 * part.cos(), 0.4 + 0.1 * part.sin());
        let circle: Vec<Point> = (0..300).map(|i| at(TAU * f64::from(i) / 300.0)).collect();
        let fitted = fit(&circle, 0.003).unwrap();
        let Shape::Circle(disc) = fitted.shape else { panic!("{fitted:?}") };
        assert!(
            disc.centre.distance(Point::new(0.5, 0.4)) < 1e-9 && (disc.radius - 0.1).abs() < 1e-9
        );
        let half: Vec<Point> = (0..300).map(|i| at(TAU / 2.0 * f64::from(i) / 300.0)).collect();
        assert!(matches!(fit(&half, 0.003).unwrap().shape, Shape::Polygon(_)));
    }

    #[test]
    fn strips_thinner_than_the_tolerance_keep_their_width_and_ells_of_them_their_corner() {
        let (wall, ell) = (
            [[0.2, 0.1], [0.24, 0.4], [0.236, 0.4], [0.196, 0.1]],
            [[0.1, 0.1], [0.104, 0.1], [0.104, 0.396], [0.3, 0.396], [0.3, 0.4], [0.1, 0.4]],
        );
        // A parallelogram of 4 mm across by 300 mm, and two bars of 4 mm, 296 and 200 mm long.
        for (corners, area) in [(&wall[..], 0.0012), (&ell[..], 0.004 * (0.296 + 0.2))] {
            let fitted = fit(&drawn(corners, 0.0004), 0.003).unwrap();
            // Half of the width is the tolerance: no point is further from the shape.
            assert!(fitted.margin < 0.002, "{fitted:?}");
            assert!((fitted.shape.area() / area - 1.0).abs() < 0.1, "{area} {fitted:?}");
        }
    }

    #[test]
    fn a_concave_outline_stays_concave() {
        let ell = [[0.0, 0.0], [0.4, 0.0], [0.4, 0.1], [0.1, 0.1], [0.1, 0.3], [0.0, 0.3]];
        let fitted = fit(&drawn(&ell, 0.001), 0.003).unwrap();
        assert!((fitted.shape.area() - 0.06).abs() < 0.0005, "{}", fitted.shape.area());
        assert!(!fitted.shape.contains(Point::new(0.25, 0.2)));
    }

    #[test]
    fn what_encloses_nothing_or_has_too_many_corners_has_no_shape() {
        // Back and forth on the border, once with a rounding error.
        let flat = [0.0114, 0.03, 0.0761, 0.05].map(|x| Point::new(x, 0.0));
        assert_eq!(fit(&flat, 0.003), None);
        let mut rounded = flat;
        rounded[2].y = 1e-19;
        assert_eq!(fit(&rounded, 0.003), None);
        let comb: Vec<[f64; 2]> =
            (0..80).map(|i| [0.01 * f64::from(i), 0.02 * f64::from(i % 2)]).collect();
        assert_eq!(fit(&drawn(&comb, 0.0), 0.003), None);
    }

    proptest! {
        #[test]
        fn shape_and_margin_hold_the_whole_contour(
            radii in proptest::collection::vec(0.05..0.2_f64, 5..12), noise in 0.0..0.004_f64,
        ) {
            let corner = |(index, radius): (usize, &f64)| {
                let angle = TAU * index as f64 / radii.len() as f64;
                [0.5 + radius * angle.cos(), 0.5 + radius * angle.sin()]
            };
            let corners: Vec<[f64; 2]> = radii.iter().enumerate().map(corner).collect();
            let contour = drawn(&corners, noise);
            let fitted = fit(&contour, 0.004).unwrap();
            for &point in &contour {
                prop_assert!(fitted.shape.distance(point) <= fitted.margin + 1e-12);
            }
            prop_assert!(fitted.margin < 3.0 * 0.004, "{}", fitted.margin);
        }
    }
}
