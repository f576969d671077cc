//! Whether the robot, as a disc, can drive a straight leg: an exact test on integers.
//!
//! It looks at the shapes themselves, knows nothing of contours or cells, and has the last word on every
//! path. A leg is free if it keeps the radius from every shape, and its ends lie inside the shrunk
//! border. Distances are compared as the squares of cross products in `i128`. Without a radius a leg may
//! touch a shape and run along its edge, but not pass through its inside. Lattice units.

use super::contour::Inflated;
use crate::grid::{LatticePoint, LatticeRect, turn};
use crate::plan::box_index::BoxIndex;

/// The shapes, ready to be asked about legs.
#[derive(Clone, Debug)]
pub(super) struct DistanceTest {
    inside: LatticeRect,
    shapes: Vec<Inflated>,
    /// The shapes by their inflated bounds.
    index: BoxIndex,
}

impl DistanceTest {
    pub(super) fn new(inside: LatticeRect, shapes: Vec<Inflated>) -> Self {
        let bounds: Vec<LatticeRect> = shapes.iter().map(bounds).collect();
        Self { inside, index: BoxIndex::new(inside, &bounds), shapes }
    }

    pub(super) fn shapes(&self) -> &[Inflated] {
        &self.shapes
    }

    /// Whether the disc can stand at `point`; touching is allowed.
    pub(super) fn holds(&self, point: LatticePoint) -> bool {
        self.is_free(point, point)
    }

    /// Whether the disc can drive straight from `a` to `b`.
    pub(super) fn is_free(&self, a: LatticePoint, b: LatticePoint) -> bool {
        let span = LatticeRect::new(a.x.min(b.x), a.y.min(b.y), a.x.max(b.x), a.y.max(b.y));
        self.inside.contains(a)
            && self.inside.contains(b)
            && self.index.near(span).all(|number| keeps_off(&self.shapes[number], a, b))
    }

    /// The shapes that the disc at `point` comes too near to.
    pub(super) fn blockers(&self, point: LatticePoint) -> impl Iterator<Item = usize> {
        self.index.at(point).filter(move |&number| !keeps_off(&self.shapes[number], point, point))
    }
}

fn bounds(shape: &Inflated) -> LatticeRect {
    let nothing = LatticeRect::new(i32::MAX, i32::MAX, i32::MIN, i32::MIN);
    let around = shape.corners.iter().fold(nothing, |around, at| {
        LatticeRect::new(
            around.x0.min(at.x),
            around.y0.min(at.y),
            around.x1.max(at.x),
            around.y1.max(at.y),
        )
    });
    let by = shape.radius;
    LatticeRect::new(around.x0 - by, around.y0 - by, around.x1 + by, around.y1 + by)
}

/// Whether the leg keeps the shape's radius from it.
pub(super) fn keeps_off(shape: &Inflated, a: LatticePoint, b: LatticePoint) -> bool {
    if shape.radius == 0 {
        return !passes_through(&shape.corners, a, b);
    }
    let square = i128::from(shape.radius).pow(2);
    let is_far = |point, from, to| is_as_far(point, (from, to), square);
    !encloses(&shape.corners, a)
        && edges(&shape.corners).all(|(p, q)| {
            !meet((a, b), (p, q))
                && is_far(a, p, q)
                && is_far(b, p, q)
                && is_far(p, a, b)
                && is_far(q, a, b)
        })
}

/// The edges of an outline; of a single corner, an edge without length.
fn edges(corners: &[LatticePoint]) -> impl Iterator<Item = (LatticePoint, LatticePoint)> {
    corners.iter().copied().zip(corners.iter().copied().cycle().skip(1))
}

/// Whether `point` is at least as far from the leg as the root of `square`.
fn is_as_far(point: LatticePoint, (a, b): (LatticePoint, LatticePoint), square: i128) -> bool {
    let (along, from_a, from_b) = (a.to(b), a.to(point), b.to(point));
    if dot(along, from_a) <= 0 {
        dot(from_a, from_a) >= square
    } else if dot(along, from_b) >= 0 {
        dot(from_b, from_b) >= square
    } else {
        i128::from(turn(a, b, point)).pow(2) >= square * dot(along, along)
    }
}

fn dot(a: (i64, i64), b: (i64, i64)) -> i128 {
    i128::from(a.0 * b.0 + a.1 * b.1)
}

/// Whether the two legs cross, each from one side of the other to the other side.
fn meet(a: (LatticePoint, LatticePoint), b: (LatticePoint, LatticePoint)) -> bool {
    let splits = |of: (LatticePoint, LatticePoint), by: (LatticePoint, LatticePoint)| {
        turn(of.0, of.1, by.0).signum() * turn(of.0, of.1, by.1).signum() < 0
    };
    splits(a, b) && splits(b, a)
}

/// Whether `point` lies inside the outline, its edges not included.
fn encloses(corners: &[LatticePoint], point: LatticePoint) -> bool {
    let mut is_inside = false;
    for (a, b) in edges(corners) {
        let side = turn(a, b, point);
        if side == 0 && is_between(point, a, b) {
            return false;
        }
        if (a.y > point.y) != (b.y > point.y) && (side > 0) == (b.y > a.y) {
            is_inside = !is_inside;
        }
    }
    is_inside
}

/// Whether a point on the line through `a` and `b` lies between them or is one of them.
fn is_between(point: LatticePoint, a: LatticePoint, b: LatticePoint) -> bool {
    dot(point.to(a), point.to(b)) <= 0
}

/// Whether the leg has a point inside the outline: it crosses an edge, begins inside, or goes in where it
/// touches.
fn passes_through(corners: &[LatticePoint], a: LatticePoint, b: LatticePoint) -> bool {
    let count = corners.len();
    if count < 3 {
        return false;
    }
    if encloses(corners, a) || edges(corners).any(|edge| meet((a, b), edge)) {
        return true;
    }
    let [on, back] = [a.to(b), b.to(a)];
    // What lies inside where the leg touches the outline: the wedge from u counter-clockwise to w.
    let goes_in = |at: LatticePoint, u: (i64, i64), w: (i64, i64)| {
        (at != b && is_in_wedge(on, u, w)) || (at != a && is_in_wedge(back, u, w))
    };
    (0..count).any(|index| {
        let (before, at, after) =
            (corners[(index + count - 1) % count], corners[index], corners[(index + 1) % count]);
        let is_on_leg = turn(a, b, at) == 0 && is_between(at, a, b);
        let touches_corner = is_on_leg && goes_in(at, at.to(after), at.to(before));
        let touches_edge = [a, b].into_iter().any(|end| {
            end != at
                && end != after
                && turn(at, after, end) == 0
                && is_between(end, at, after)
                && goes_in(end, at.to(after), after.to(at))
        });
        touches_corner || touches_edge
    })
}

/// Whether the direction lies strictly between `u` and `w`, counter-clockwise; where these are opposite,
/// strictly to the left of `u`.
fn is_in_wedge(direction: (i64, i64), u: (i64, i64), w: (i64, i64)) -> bool {
    let cross = |p: (i64, i64), q: (i64, i64)| p.0 * q.1 - p.1 * q.0;
    match cross(u, w) {
        0 => cross(u, direction) > 0,
        1.. => cross(u, direction) > 0 && cross(direction, w) > 0,
        _ => !(cross(w, direction) >= 0 && cross(direction, u) >= 0),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn at(x: i32, y: i32) -> LatticePoint {
        LatticePoint::new(x, y)
    }

    fn shape(radius: i32, corners: &[(i32, i32)]) -> Inflated {
        Inflated { corners: corners.iter().map(|&(x, y)| at(x, y)).collect(), radius }
    }

    const SQUARE: [(i32, i32); 4] = [(-9, -9), (0, -9), (0, 0), (-9, 0)];
    const ELL: [(i32, i32); 6] = [(0, 0), (20, 0), (20, 10), (10, 10), (10, 20), (0, 20)];

    #[test]
    fn a_leg_may_touch_the_arc_and_not_cut_it() {
        // 4x + 3y = 100 is exactly 20 from the origin, at (16, 12).
        let (a, b) = (at(40, -20), at(-20, 60));
        assert!(keeps_off(&shape(20, &SQUARE), a, b) && !keeps_off(&shape(21, &SQUARE), a, b));
        assert!(keeps_off(&shape(20, &SQUARE), at(16, 12), at(16, 12)));
        assert!(!keeps_off(&shape(20, &SQUARE), at(16, 11), at(16, 11)));
        assert!(keeps_off(&shape(5, &[(0, 0)]), at(5, -9), at(5, 9)), "a disc");
        assert!(!keeps_off(&shape(6, &[(0, 0)]), at(5, -9), at(5, 9)));
    }

    #[test]
    fn a_leg_through_or_inside_a_shape_is_not_free_however_small_the_disc() {
        for radius in [0, 1] {
            assert!(!keeps_off(&shape(radius, &SQUARE), at(-20, -5), at(20, -5)));
            assert!(!keeps_off(&shape(radius, &SQUARE), at(-5, -5), at(-4, -5)));
            assert!(keeps_off(&shape(radius, &SQUARE), at(5, 5), at(5, -50)));
        }
    }

    #[test]
    fn without_a_radius_a_leg_runs_along_edges_and_over_corners() {
        let ell = shape(0, &ELL);
        assert!(keeps_off(&ell, at(-5, 0), at(50, 0)), "along an edge");
        assert!(keeps_off(&ell, at(30, 0), at(0, 30)), "over two corners");
        assert!(keeps_off(&ell, at(10, 10), at(30, 30)), "out of the notch");
        assert!(!keeps_off(&ell, at(30, 30), at(5, 5)), "into the inner corner");
        assert!(!keeps_off(&ell, at(10, 20), at(20, 0)), "from corner to corner through it");
        assert!(!keeps_off(&ell, at(0, 5), at(5, 0)), "from edge to edge through it");
        assert!(keeps_off(&ell, at(10, 15), at(15, 10)), "from edge to edge across the notch");
        assert!(!keeps_off(&ell, at(10, -3), at(10, 30)), "through it and on along its edge");
    }
}
