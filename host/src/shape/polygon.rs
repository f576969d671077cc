//! Simple polygons: what makes one, and which of two edges cross where it is none. Metres.

use super::ShapeError;
use crate::geometry::Point;

/// The most corners that a polygon may have: whether edges cross is asked of all pairs.
pub const CORNER_LIMIT: usize = 4096;

/// A polygon whose edges touch only at the corners that they share; its corners are kept
/// counter-clockwise.
#[derive(Clone, Debug, PartialEq)]
pub struct Polygon {
    pub(super) corners: Vec<Point>,
}

impl Polygon {
    /// The polygon with these corners, in either direction; repeated ones count once.
    ///
    /// # Errors
    /// [`ShapeError`] if there are too few corners or too many, one is not finite, or edges cross.
    ///
    /// ```
    /// use wmr::{geometry::Point, shape::{Polygon, ShapeError}};
    /// let at = |points: &[[f64; 2]]| Polygon::new(points.iter().map(|&p| Point::from(p)).collect());
    /// assert_eq!(at(&[[0.0, 0.0], [0.0, 1.0], [2.0, 0.0]])?.area(), 1.0);
    /// let bow_tie = at(&[[0.0, 0.0], [1.0, 1.0], [1.0, 0.0], [0.0, 1.0]]);
    /// assert_eq!(bow_tie, Err(ShapeError::Crossing { edges: [0, 2] }));
    /// # Ok::<(), ShapeError>(())
    /// ```
    pub fn new(mut corners: Vec<Point>) -> Result<Self, ShapeError> {
        if let Some(value) = corners.iter().flat_map(|p| [p.x, p.y]).find(|v| !v.is_finite()) {
            return Err(ShapeError::NotFinite { value });
        }
        corners.dedup();
        while corners.len() > 1 && corners.first() == corners.last() {
            corners.pop();
        }
        match corners.len() {
            count @ ..=2 => return Err(ShapeError::FewCorners { count }),
            count if count > CORNER_LIMIT => return Err(ShapeError::ManyCorners { count }),
            _ => {}
        }
        if let Some(edges) = first_crossing(&corners) {
            return Err(ShapeError::Crossing { edges });
        }
        let mut polygon = Self { corners };
        if polygon.signed_area() < 0.0 {
            polygon.corners.reverse();
        }
        if polygon.area() > 0.0 {
            Ok(polygon)
        } else {
            Err(ShapeError::NoSize { what: "area", value: polygon.area() })
        }
    }

    /// The corners, counter-clockwise, metres.
    pub fn corners(&self) -> &[Point] {
        &self.corners
    }

    /// The area, m².
    pub fn area(&self) -> f64 {
        self.signed_area().abs()
    }

    /// The edges from corner to corner, counter-clockwise.
    pub fn edges(&self) -> impl Iterator<Item = (Point, Point)> {
        edges(&self.corners)
    }

    fn signed_area(&self) -> f64 {
        self.edges().map(|(a, b)| a.x * b.y - b.x * a.y).sum::<f64>() / 2.0
    }

    /// Whether `point` lies inside, by the number of edges to its right (even-odd).
    pub(super) fn contains(&self, point: Point) -> bool {
        let is_right = |(a, b): (Point, Point)| {
            (a.y > point.y) != (b.y > point.y)
                && point.x < a.x + (point.y - a.y) / (b.y - a.y) * (b.x - a.x)
        };
        self.edges().filter(|&edge| is_right(edge)).count() % 2 == 1
    }
}

pub(super) fn edges(corners: &[Point]) -> impl Iterator<Item = (Point, Point)> {
    corners.iter().copied().zip(corners.iter().copied().cycle().skip(1))
}

/// The indices of the first two edges that have more in common than the corner between neighbours.
fn first_crossing(corners: &[Point]) -> Option<[usize; 2]> {
    let all: Vec<(Point, Point)> = edges(corners).collect();
    let count = all.len();
    for i in 0..count {
        for j in i + 1..count {
            let (a, b) = (all[i], all[j]);
            let meets = if j == i + 1 {
                folds_back(a.0, a.1, b.1)
            } else if i == 0 && j == count - 1 {
                folds_back(b.0, b.1, a.1)
            } else {
                meet(a, b)
            };
            if meets {
                return Some([i, j]);
            }
        }
    }
    None
}

/// Twice the signed area of the triangle, m²; positive if it turns left.
fn turn(a: Point, b: Point, c: Point) -> f64 {
    (b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x)
}

/// Whether the way from `a` over `b` to `c` goes back on itself.
fn folds_back(a: Point, b: Point, c: Point) -> bool {
    turn(a, b, c) == 0.0 && (b.x - a.x) * (c.x - b.x) + (b.y - a.y) * (c.y - b.y) < 0.0
}

/// Whether the two segments have a point in common.
pub(super) fn meet(a: (Point, Point), b: (Point, Point)) -> bool {
    let apart = |p: f64, q: f64, r: f64, s: f64| p.max(q) < r.min(s) || r.max(s) < p.min(q);
    if apart(a.0.x, a.1.x, b.0.x, b.1.x) || apart(a.0.y, a.1.y, b.0.y, b.1.y) {
        return false;
    }
    let sides =
        |of: (Point, Point), p: (Point, Point)| (turn(of.0, of.1, p.0), turn(of.0, of.1, p.1));
    let splits = |(p, q): (f64, f64)| !((p > 0.0 && q > 0.0) || (p < 0.0 && q < 0.0));
    splits(sides(a, b)) && splits(sides(b, a))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn polygon(points: &[[f64; 2]]) -> Result<Polygon, ShapeError> {
        Polygon::new(points.iter().map(|&point| Point::from(point)).collect())
    }

    #[test]
    fn what_is_no_polygon_is_refused_with_the_reason() {
        assert_eq!(polygon(&[[0.0, 0.0], [1.0, 0.0]]), Err(ShapeError::FewCorners { count: 2 }));
        let twice = [[0.0, 0.0], [1.0, 0.0], [0.0, 0.0]];
        assert_eq!(polygon(&twice), Err(ShapeError::FewCorners { count: 2 }));
        let spike = [[0.0, 0.0], [2.0, 0.0], [1.0, 0.0], [1.0, 1.0]];
        assert_eq!(polygon(&spike), Err(ShapeError::Crossing { edges: [0, 1] }));
        let touching = [[0.0, 0.0], [2.0, 0.0], [2.0, 2.0], [1.0, 0.0], [0.0, 2.0]];
        assert_eq!(polygon(&touching), Err(ShapeError::Crossing { edges: [0, 2] }));
        assert!(matches!(
            polygon(&[[0.0, f64::NAN], [1.0, 0.0], [0.0, 1.0]]),
            Err(ShapeError::NotFinite { .. })
        ));
        assert!(polygon(&[[0.0, 0.0], [1.0, 0.0], [2.0, 0.0]]).is_err());
    }
}
