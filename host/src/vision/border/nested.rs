//! Rectangles within rectangles: whether one is the floor's end or only drawn on the floor of another.
//!
//! Printed grids, seams of tiles and inner frames are rectangles of floor on floor; the border is the outermost
//! around which there is something else. Lengths are pixels of the overview.

use super::sides::learn_floor;
use crate::geometry::Arena;
use crate::vision::appearance::feature;
use crate::vision::camera::PlanMap;
use crate::vision::image::Photo;

/// Colours within so many standard deviations are the floor's, where what lies between two rectangles is looked
/// at in the places of a lattice of so many rows and columns.
const ON_FLOOR: f32 = 6.0;
const LATTICE: usize = 48;
/// A rim is at most this wide, a share of the outer diagonal, and nowhere less than this share of its widest.
const MOST_RIM: f64 = 0.08;
const LEAST_RIM: f64 = 0.4;
/// What is this near a side is on it, and a corner this far from all others is elsewhere, pixels of the overview.
const ON_SIDE: f64 = 3.0;
const CLEARLY_OUTSIDE: f64 = 12.0;
/// Whether a rectangle's floor goes on around it up to an outer one: it is a drawing on that floor rather than
/// its end.
pub(super) fn is_drawn_inside(
    photo: &Photo,
    arena: Arena,
    map: &PlanMap,
    outer: [[f64; 2]; 4],
) -> bool {
    let inner = map.seen_corners(arena);
    if !encloses(outer, inner) || is_rim(outer, inner) {
        return false;
    }
    let Some(floor) = learn_floor(photo, map, arena) else { return false };
    let is_floor = |pixel: [f64; 2]| {
        let residual = floor.residual(map.to_floor(pixel), feature(photo.light(pixel)));
        floor.difference_of(residual).lit < ON_FLOOR
    };
    let (floor, other): (Vec<_>, Vec<_>) = between_quads(inner, outer).partition(|&p| is_floor(p));
    floor.len() > other.len()
}

/// Pixels of a lattice between the sides of a quadrilateral and of one around it, clear of both.
fn between_quads(inner: [[f64; 2]; 4], outer: [[f64; 2]; 4]) -> impl Iterator<Item = [f64; 2]> {
    let range = |axis: usize| {
        let values = outer.map(|corner| corner[axis]);
        (values.into_iter().fold(f64::INFINITY, f64::min), values.into_iter().fold(0.0, f64::max))
    };
    let ranges = [range(0), range(1)];
    let places = (0..LATTICE * LATTICE).map(move |index| {
        let share = [index % LATTICE, index / LATTICE].map(|i| (i as f64 + 0.5) / LATTICE as f64);
        [0, 1].map(|axis| ranges[axis].0 + share[axis] * (ranges[axis].1 - ranges[axis].0))
    });
    places.filter(move |&place| depth(outer, place) > ON_SIDE && depth(inner, place) < -ON_SIDE)
}

/// How far a place lies inside the nearest side of a quadrilateral, pixels; negative outside.
fn depth(quad: [[f64; 2]; 4], place: [f64; 2]) -> f64 {
    (0..4).map(|side| inward(quad, side, place)).fold(f64::INFINITY, f64::min)
}

/// How far a place lies inside a side of a quadrilateral, pixels.
fn inward(quad: [[f64; 2]; 4], side: usize, [x, y]: [f64; 2]) -> f64 {
    let ([ax, ay], [bx, by]) = (quad[side], quad[(side + 1) % 4]);
    let length = (bx - ax).hypot(by - ay).max(1.0);
    ((by - ay) * (x - ax) - (bx - ax) * (y - ay)) / length
}

/// Whether what lies between two quadrilaterals is a narrow rim of about one width all around: a sheet's, beyond the
/// frame that is printed on it as its border.
fn is_rim(outer: [[f64; 2]; 4], inner: [[f64; 2]; 4]) -> bool {
    let width = |side: usize| {
        let depths = inner.map(|corner| inward(outer, side, corner));
        depths.into_iter().fold(f64::INFINITY, f64::min)
    };
    let widths = [0, 1, 2, 3].map(width);
    let widest = widths.into_iter().fold(0.0, f64::max);
    let narrowest = widths.into_iter().fold(f64::INFINITY, f64::min);
    let size = (outer[0][0] - outer[2][0]).hypot(outer[0][1] - outer[2][1]);
    widest < MOST_RIM * size && narrowest > LEAST_RIM * widest
}

/// Whether a quadrilateral lies around the corners of another, with a clear distance from one of them at least.
fn encloses(outer: [[f64; 2]; 4], inner: [[f64; 2]; 4]) -> bool {
    let inside = inner.into_iter().all(|corner| depth(outer, corner) > -ON_SIDE);
    let apart = outer.iter().map(|a| {
        let far = inner.iter().map(|p| (p[0] - a[0]).hypot(p[1] - a[1]));
        far.fold(f64::INFINITY, f64::min)
    });
    inside && apart.fold(0.0, f64::max) > CLEARLY_OUTSIDE
}

#[cfg(test)]
mod tests {
    use super::*;

    const INNER: [[f64; 2]; 4] = [[40.0, 80.0], [80.0, 80.0], [80.0, 40.0], [40.0, 40.0]];
    const OUTER: [[f64; 2]; 4] = [[20.0, 80.0], [80.0, 80.0], [80.0, 20.0], [20.0, 20.0]];

    #[test]
    fn a_place_is_as_deep_as_its_nearest_side_is_far() {
        assert_eq!(depth(INNER, [50.0, 60.0]), 10.0);
        assert_eq!(depth(INNER, [85.0, 60.0]), -5.0);
    }

    #[test]
    fn a_square_may_share_sides_with_the_one_around_it() {
        assert!(encloses(OUTER, INNER) && !encloses(INNER, OUTER) && !encloses(OUTER, OUTER));
        assert!(between_quads(INNER, OUTER).all(|[x, y]| x < 37.0 || y < 37.0));
        assert!(between_quads(INNER, OUTER).count() > 500);
    }

    #[test]
    fn places_between_two_squares_lie_as_far_from_one_side_as_from_the_other() {
        let inner = [[40.0, 60.0], [60.0, 60.0], [60.0, 40.0], [40.0, 40.0]];
        let places: Vec<_> = between_quads(inner, OUTER).collect();
        for axis in [0, 1] {
            let middle = places.iter().map(|place| place[axis]).sum::<f64>() / places.len() as f64;
            assert!((middle - 50.0).abs() < 1e-9, "{middle}");
        }
    }

    #[test]
    fn a_rim_is_narrow_and_of_one_width() {
        let grown = |by: f64| {
            [
                [40.0 - by, 80.0 + by],
                [80.0 + by, 80.0 + by],
                [80.0 + by, 40.0 - by],
                [40.0 - by, 40.0 - by],
            ]
        };
        assert!(is_rim(grown(4.0), INNER) && !is_rim(grown(20.0), INNER) && !is_rim(OUTER, INNER));
    }

    #[test]
    fn floor_around_makes_a_drawing_and_other_ground_a_border() {
        let photo = |ground: u8| {
            let pixel = move |i: usize| {
                let (x, y) = ((i % 100) as f64, (i / 100) as f64);
                let line = depth(INNER, [x, y]).abs() < 1.5;
                let inside = depth(INNER, [x, y]) > 0.0;
                if line {
                    [20; 3]
                } else if inside {
                    [210; 3]
                } else {
                    [ground; 3]
                }
            };
            Photo::from_rgb(100, 100, (0..100 * 100).map(pixel).collect()).unwrap()
        };
        let arena = Arena { width: 1.0, height: 1.0 };
        let drawn_on = |ground: u8| {
            let photo = photo(ground);
            let map = PlanMap::from_seen_corners(&photo, arena, INNER, 0.0).unwrap();
            is_drawn_inside(&photo, arena, &map, OUTER)
        };
        assert!(drawn_on(210) && !drawn_on(120));
    }
}
