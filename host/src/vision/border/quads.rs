//! Quadrilaterals of long edges that a camera may see of the stated arena: candidates for its border.
//!
//! Tilt foreshortens and an arena may lie turned, so the sides' lengths tell little; that a camera has to have
//! seen the rectangle tells much. What has about the arena's shape but fits no camera is kept apart: where it
//! encloses a rectangle that fits, one of them is mistaken.
//!
//! A border has several parallel edges (inner and outer edge of a tape, foot and top of a wall), so
//! candidates come in nests; one of each nest is enough, since [`super::candidates`] looks from there
//! for the edge where the floor ends.

use super::given::is_convex;
use super::lines::{Direction, EdgeMap, Line};
use super::origin::PictureCorner;
use crate::geometry::Arena;
use crate::vision::camera::{PlanMap, Viewpoint};
use crate::vision::image::Photo;

/// The ratio of the sides in the picture may be off by this much, a natural logarithm: a tilt of 45° does so.
const ASPECT_TOLERANCE: f64 = 0.36;
/// A rectangle whose ratio is off by less may be the border of an arena whose size was mistaken.
const NEAR_ASPECT: f64 = 0.14;
/// The misfit of a camera that lines at their rough places may have, squared standard deviations of a stated size.
const MOST_MISFIT: f64 = 90.0;
/// The least share of each side that is edge: boxes hide some of it, lenses bend it off a line.
const LEAST_SUPPORT: f64 = 0.2;
/// Sides are at least this share of the picture's shorter side.
const LEAST_SIDE: f64 = 0.2;
/// Quadrilaterals whose corners are all closer than this share of their size belong to one nest.
const NEST: f64 = 0.09;
/// Nests that are looked at, of those that a camera may see and of those that none does.
const MOST_NESTS: usize = 6;
const MOST_ODD: usize = 3;
/// Quadrilaterals that are held against a camera.
const MOST_HELD: usize = 3000;
/// How much a candidate's size counts beside the share of its sides that is edge.
const SIZE_WEIGHT: f64 = 0.8;
/// An arena whose width runs up in the picture is a little less likely.
const TURNED_COST: f64 = 0.02;
/// How far outside the picture a corner may lie, as a share of its width.
const OUTSIDE: f64 = 0.02;

/// Four edges around what may be the arena.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Quad {
    /// Corners 0..3: lower left, lower right, upper right, upper left, pixels.
    pub(crate) corners: [[f64; 2]; 4],
    /// The share of the four sides that is edge, 0 to 1.
    pub(crate) support: f64,
    /// How likely this is the arena by its edges and its size: arenas fill much of the picture.
    pub(crate) rank: f64,
}

/// The likeliest quadrilateral of each nest, best first.
#[derive(Clone, Debug, Default)]
pub(crate) struct Candidates {
    /// Those that a camera may see of the arena.
    pub(crate) fitting: Vec<Quad>,
    /// Those of nearly the arena's shape that no camera sees of it.
    pub(crate) odd: Vec<Quad>,
}

impl Candidates {
    /// Those that fit, then those that do not.
    pub(crate) fn all(&self) -> impl Iterator<Item = &Quad> {
        self.fitting.iter().chain(&self.odd)
    }
}

/// The candidates for an arena's border in a photo with such edges.
pub(crate) fn candidates(
    photo: &Photo,
    edges: &EdgeMap,
    arena: Arena,
    origin: Option<PictureCorner>,
) -> Candidates {
    let mut quads = quads(edges, (photo.width(), photo.height()), (arena, origin));
    quads.sort_by(|a: &Quad, b: &Quad| b.rank.total_cmp(&a.rank));
    let mut nests = Candidates::default();
    for quad in quads.into_iter().take(MOST_HELD) {
        if nests.fitting.len() == MOST_NESTS {
            break;
        }
        let Some(map) = PlanMap::from_seen_corners(photo, arena, quad.corners, 0.0) else {
            continue;
        };
        let fits = Viewpoint::misfit_as_stated(photo, &map) < MOST_MISFIT;
        let near = |ratio: f64| ratio.ln().abs() < NEAR_ASPECT;
        if fits {
            add(&mut nests.fitting, quad, MOST_NESTS);
        } else if Viewpoint::side_ratio(photo, &map).is_some_and(near) {
            add(&mut nests.odd, quad, MOST_ODD);
        }
    }
    nests
}

/// Adds a quadrilateral to nests, unless it belongs to one of them or there are so many.
fn add(nests: &mut Vec<Quad>, quad: Quad, most: usize) {
    if nests.len() < most && nests.iter().all(|nest| !same_nest(nest, &quad)) {
        nests.push(quad);
    }
}

/// All quadrilaterals of lines that may be the arena.
fn quads(
    edges: &EdgeMap,
    size: (usize, usize),
    wanted: (Arena, Option<PictureCorner>),
) -> Vec<Quad> {
    let rows = edges.lines(Direction::Horizontal);
    let columns = edges.lines(Direction::Vertical);
    let crossings: Vec<Vec<_>> =
        rows.iter().map(|row| columns.iter().map(|column| cross(row, column)).collect()).collect();
    let mut quads = Vec::new();
    let beside = pairs(&columns, size, size.1);
    for (upper, lower) in pairs(&rows, size, size.0) {
        for &(left, right) in &beside {
            let [above, below] = [upper, lower].map(|row: usize| &crossings[row]);
            let corners = (below[left], below[right], above[right], above[left]);
            let (Some(a), Some(b), Some(c), Some(d)) = corners else { continue };
            let lines = [&rows[lower], &columns[right], &rows[upper], &columns[left]];
            quads.extend(quad([a, b, c, d], lines, size, wanted));
        }
    }
    quads
}

/// The numbers of all pairs of lines, smaller v first, that are far enough apart in the middle of the picture.
fn pairs(lines: &[Line], size: (usize, usize), length: usize) -> Vec<(usize, usize)> {
    let least = LEAST_SIDE * size.0.min(size.1) as f64;
    let middle = length as f64 / 2.0;
    let mut pairs = Vec::new();
    for (i, first) in lines.iter().enumerate() {
        for (j, second) in lines.iter().enumerate() {
            if second.at(middle) - first.at(middle) > least {
                pairs.push((i, j));
            }
        }
    }
    pairs
}

/// The quadrilaterals of a lower, right, upper and left line with its corners that can be the arena: from the
/// lower left or whichever corner is the origin, and from the next one, should the arena lie the other way.
fn quad(
    corners: [[f64; 2]; 4],
    [lower, right, upper, left]: [&Line; 4],
    size: (usize, usize),
    (arena, origin): (Arena, Option<PictureCorner>),
) -> Vec<Quad> {
    let slack = OUTSIDE * size.0 as f64;
    let inside = |[x, y]: [f64; 2]| {
        x > -slack && y > -slack && x < size.0 as f64 + slack && y < size.1 as f64 + slack
    };
    if !corners.into_iter().all(inside) || !is_convex(corners) {
        return Vec::new();
    }
    let side =
        |a: usize, b: usize| (corners[a][0] - corners[b][0]).hypot(corners[a][1] - corners[b][1]);
    let (across, up) = ((side(0, 1) + side(2, 3)) / 2.0, (side(1, 2) + side(3, 0)) / 2.0);
    let seen = (across / up.max(1.0)).ln();
    let stated = (arena.width / arena.height).ln();
    let fits = |origin: &PictureCorner| {
        let stated = if origin.is_upwards() { -stated } else { stated };
        (seen - stated).abs() < ASPECT_TOLERANCE
    };
    let first = origin.unwrap_or(PictureCorner::LowerLeft);
    let origins = [(first, 0.0), (first.next(), TURNED_COST)];
    let origins = origins.into_iter().filter(|(origin, _)| fits(origin));
    if origins.clone().next().is_none() {
        return Vec::new();
    }
    let shares = [
        lower.support(corners[0][0], corners[1][0]),
        right.support(corners[1][1], corners[2][1]),
        upper.support(corners[2][0], corners[3][0]),
        left.support(corners[3][1], corners[0][1]),
    ];
    let least = shares.into_iter().fold(1.0, f64::min);
    if least <= LEAST_SUPPORT {
        return Vec::new();
    }
    let support = shares.iter().sum::<f64>() / 4.0;
    let rank = support + SIZE_WEIGHT * (across * up / (size.0 * size.1) as f64).sqrt();
    let from = |(origin, cost): (PictureCorner, f64)| {
        let mut corners = corners;
        corners.rotate_left(origin.index());
        Quad { corners, support, rank: rank - cost }
    };
    origins.map(from).collect()
}

/// Where a nearly horizontal and a nearly vertical line meet, pixels.
fn cross(row: &Line, column: &Line) -> Option<[f64; 2]> {
    let (a, b) = (row.at(0.0), column.at(0.0));
    let denominator = 1.0 - row.slope * column.slope;
    if denominator < 0.1 {
        return None;
    }
    let x = (b + column.slope * a) / denominator;
    Some([x, row.at(x)])
}

fn same_nest(a: &Quad, b: &Quad) -> bool {
    let size = (a.corners[0][0] - a.corners[2][0]).hypot(a.corners[0][1] - a.corners[2][1]);
    a.corners.iter().zip(b.corners).all(|(p, q)| (p[0] - q[0]).hypot(p[1] - q[1]) < NEST * size)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn framed() -> Photo {
        let pixels = (0..200 * 150).map(|i| {
            let (x, y) = (i % 200, i / 200);
            let frame = (20..180).contains(&x) && (30..110).contains(&y);
            let floor = (25..175).contains(&x) && (35..105).contains(&y);
            if frame && !floor { [30; 3] } else { [220; 3] }
        });
        Photo::from_rgb(200, 150, pixels.collect()).unwrap()
    }

    #[test]
    fn a_frame_is_one_nest() {
        let photo = framed();
        let arena = Arena { width: 1.5, height: 0.7 };
        let quads = candidates(&photo, &EdgeMap::of(&photo), arena, None).fitting;
        assert_eq!(quads.len(), 1);
        let [x, y] = quads[0].corners[0];
        assert!((19.0..26.0).contains(&x) && (104.0..111.0).contains(&y), "{:?}", quads[0]);
    }

    #[test]
    fn the_wrong_shape_is_no_candidate() {
        let photo = framed();
        let square = Arena { width: 1.0, height: 1.0 };
        assert!(candidates(&photo, &EdgeMap::of(&photo), square, None).fitting.is_empty());
    }
}
