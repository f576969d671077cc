//! What stands on the floor as bodies with a height: where rays meet them. Metres, arena frame.
//!
//! A body is its footprint pulled up straight. A ray through its height is a short segment over the floor:
//! it meets the top where that segment begins inside the footprint, else the side that it crosses first.

use super::lens::Ray;
use crate::base::TruePose;
use crate::world::{Shape, polygon_holds, segment_square};

/// A colour as sRGB has it.
pub type Colour = [u8; 3];

/// Where triangle and disc of the robot's mark lie, shares of the disc's radius: the apex ahead of the
/// centre, the base behind it, and half of the base's width.
const APEX: f64 = 0.8;
const BASE: f64 = -0.533;
const HALF_BASE: f64 = 0.373;

/// A body on the floor.
#[derive(Clone, Debug, PartialEq)]
pub struct Solid {
    /// Its footprint.
    pub shape: Shape,
    /// How tall it is, m.
    pub height: f64,
    /// Of its sides, and of its top outside the mark.
    pub colour: Colour,
    /// What is on its top.
    pub mark: Option<(TruePose, Mark)>,
}

/// What a robot carries on its top.
#[derive(Clone, Debug, PartialEq)]
pub enum Mark {
    /// A triangle that points ahead, of this colour.
    Triangle(Colour),
    /// A square tag whose right edge points ahead.
    Tag {
        /// Of the square of all cells, m.
        side: f64,
        /// Its cells, as many rows as columns, row by row from the top left, the dark frame included;
        /// true is white.
        cells: Vec<bool>,
    },
}

/// A footprint, ready for rays.
#[derive(Clone, Debug)]
pub(super) struct Body {
    edges: Edges,
    /// A circle around it: x, y, radius.
    bound: [f64; 3],
    pub(super) height: f64,
}

#[derive(Clone, Debug)]
enum Edges {
    Polygon(Vec<[f64; 2]>),
    Circle([f64; 3]),
}

/// Where a ray meets a body.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Hit {
    pub(super) point: [f64; 3],
    pub(super) normal: [f64; 3],
    /// Which face: 0 the top, then the sides.
    pub(super) face: u32,
}

/// Where a segment crosses a footprint's outline: after which share of it, and which edge.
struct Crossing {
    share: f64,
    edge: u32,
    normal: [f64; 2],
}

impl Body {
    pub(super) fn new(shape: &Shape, height: f64) -> Self {
        let outline = shape.outline();
        let edges = match shape {
            Shape::Circle(circle) => Edges::Circle(*circle),
            _ => Edges::Polygon(outline.clone()),
        };
        let count = outline.len().max(1) as f64;
        let mean = |axis: usize| outline.iter().map(|corner| corner[axis]).sum::<f64>() / count;
        let (x, y) = (mean(0), mean(1));
        let reach = outline.iter().map(|corner| (corner[0] - x).hypot(corner[1] - y));
        let radius = reach.fold(0.0, f64::max);
        Self { edges, bound: [x, y, radius * (1.0 + 1e-9)], height }
    }

    /// The radius of the circle around it, m.
    pub(super) fn radius(&self) -> f64 {
        self.bound[2]
    }

    /// Corners around it, one after the other, that hold it in their midst, m.
    pub(super) fn hull(&self) -> Vec<[f64; 2]> {
        match &self.edges {
            Edges::Polygon(corners) => corners.clone(),
            // A polygon around a circle is larger than it by this.
            Edges::Circle([x, y, radius]) => {
                let around = radius / (std::f64::consts::PI / 16.0).cos();
                Shape::Circle([*x, *y, around]).outline().into_iter().step_by(3).collect()
            }
        }
    }

    /// Where `ray` meets it first.
    pub(super) fn hit(&self, ray: &Ray) -> Option<Hit> {
        let top = self.height.min(ray.from[2]);
        let (above, below) = (ray.at(top), ray.at(0.0));
        if self.is_far_from(above, below, 0.0) {
            return None;
        }
        if self.holds(above) {
            let [x, y] = above;
            return Some(Hit { point: [x, y, top], normal: [0.0, 0.0, 1.0], face: 0 });
        }
        let Crossing { share, edge, normal: [nx, ny] } = self.crossing(above, below)?;
        let z = top * (1.0 - share);
        let [x, y] = ray.at(z);
        Some(Hit { point: [x, y, z], normal: [nx, ny, 0.0], face: 1 + edge })
    }

    /// Whether it may stand between a point and some place within `spread` of a lamp, m.
    pub(super) fn may_block(&self, point: [f64; 3], lamp: [f64; 3], spread: f64) -> bool {
        let Some((from, to, share)) = self.way_up(point, lamp) else { return false };
        !self.is_far_from(from, to, share * spread)
    }

    /// Whether it stands between a point and a lamp.
    pub(super) fn blocks(&self, point: [f64; 3], lamp: [f64; 3]) -> bool {
        self.way_up(point, lamp)
            .is_some_and(|(from, to, _)| self.holds(to) || self.crossing(from, to).is_some())
    }

    /// The part of the way to the lamp that is no higher than the body, and which share of all it is.
    fn way_up(&self, point: [f64; 3], lamp: [f64; 3]) -> Option<([f64; 2], [f64; 2], f64)> {
        let [x, y, z] = point;
        if z >= self.height || lamp[2] <= z {
            return None;
        }
        let share = ((self.height - z) / (lamp[2] - z)).min(1.0);
        Some(([x, y], [x + share * (lamp[0] - x), y + share * (lamp[1] - y)], share))
    }

    fn is_far_from(&self, from: [f64; 2], to: [f64; 2], spread: f64) -> bool {
        let [x, y, radius] = self.bound;
        segment_square([x, y], from, to) > (radius + spread).powi(2)
    }

    fn holds(&self, [x, y]: [f64; 2]) -> bool {
        match &self.edges {
            Edges::Circle([cx, cy, radius]) => {
                (x - cx).powi(2) + (y - cy).powi(2) <= radius.powi(2)
            }
            Edges::Polygon(corners) => polygon_holds(corners, [x, y]),
        }
    }

    fn crossing(&self, from: [f64; 2], to: [f64; 2]) -> Option<Crossing> {
        let (ex, ey) = (to[0] - from[0], to[1] - from[1]);
        match &self.edges {
            Edges::Circle([cx, cy, radius]) => {
                // |from + s e - c|² = r², the smaller root: a segment enters from outside.
                let (px, py) = (from[0] - cx, from[1] - cy);
                let (a, b) = (ex * ex + ey * ey, px * ex + py * ey);
                let square = b * b - a * (px * px + py * py - radius * radius);
                if square < 0.0 || a == 0.0 {
                    return None;
                }
                let share = (-b - square.sqrt()) / a;
                let normal = [(px + share * ex) / radius, (py + share * ey) / radius];
                (0.0..=1.0).contains(&share).then_some(Crossing { share, edge: 0, normal })
            }
            Edges::Polygon(corners) => {
                let sides = corners.iter().zip(corners.iter().cycle().skip(1)).zip(0..);
                let crossed = sides.filter_map(|((a, b), edge)| {
                    let (share, normal) = crossing(from, [ex, ey], *a, *b)?;
                    Some(Crossing { share, edge, normal })
                });
                crossed.min_by(|a, b| a.share.total_cmp(&b.share))
            }
        }
    }
}

/// Where the segment from `from` along `e` crosses the edge from `a` to `b`, and that edge's normal on the
/// segment's side.
fn crossing(
    from: [f64; 2],
    [ex, ey]: [f64; 2],
    [ax, ay]: [f64; 2],
    [bx, by]: [f64; 2],
) -> Option<(f64, [f64; 2])> {
    let (wx, wy, px, py) = (bx - ax, by - ay, ax - from[0], ay - from[1]);
    let across = ex * wy - ey * wx;
    if across == 0.0 {
        return None;
    }
    let share = (px * wy - py * wx) / across;
    let along = (px * ey - py * ex) / across;
    if !(0.0..=1.0).contains(&share) || !(0.0..=1.0).contains(&along) {
        return None;
    }
    let length = wx.hypot(wy).copysign(across);
    Some((share, [-wy / length, wx / length]))
}

impl Mark {
    /// The colour of the mark at a point of the top of a robot with this radius at `pose`; `None` beside it.
    pub(super) fn colour(&self, pose: TruePose, radius: f64, [x, y]: [f64; 2]) -> Option<Colour> {
        let (sin, cos) = pose.heading.sin_cos();
        let (dx, dy) = (x - pose.x, y - pose.y);
        let (ahead, left) = (dx * cos + dy * sin, dy * cos - dx * sin);
        match self {
            Self::Triangle(colour) => {
                let (ahead, left) = (ahead / radius, left / radius);
                let half = HALF_BASE * (APEX - ahead) / (APEX - BASE);
                (ahead > BASE && left.abs() < half).then_some(*colour)
            }
            Self::Tag { side, cells } => {
                let count = cells.len().isqrt();
                let cell = side / count as f64;
                let (column, row) = ((side / 2.0 + ahead) / cell, (side / 2.0 - left) / cell);
                if column < 0.0 || row < 0.0 || column >= count as f64 {
                    return None;
                }
                let white = *cells.get(row as usize * count + column as usize)?;
                Some(if white { [245; 3] } else { [15; 3] })
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn ray(from: [f64; 3], to: [f64; 2]) -> Ray {
        let slope = [0, 1].map(|axis| (to[axis] - from[axis]) / from[2]);
        Ray { from, slope }
    }

    #[test]
    fn a_ray_meets_the_top_or_the_side_that_faces_it() {
        let body = Body::new(&Shape::Rect([1.0, 1.0, 2.0, 2.0]), 0.5);
        // From 1 m above x = 0 down to x = 2: at the height of the top it is over x = 1 exactly.
        let top = body.hit(&ray([0.0, 1.5, 1.0], [2.2, 1.5])).unwrap();
        assert_eq!((top.face, top.point[2]), (0, 0.5));
        let side = body.hit(&ray([0.0, 1.5, 1.0], [1.25, 1.5])).unwrap();
        assert!((side.point[0] - 1.0).abs() < 1e-12 && (side.point[2] - 0.2).abs() < 1e-12);
        assert_eq!(side.normal, [-1.0, 0.0, 0.0]);
        assert_eq!(body.hit(&ray([0.0, 1.5, 1.0], [0.9, 1.5])), None);
        let disc = Body::new(&Shape::Circle([1.5, 1.5, 0.5]), 0.5);
        let side = disc.hit(&ray([0.0, 1.5, 1.0], [1.25, 1.5])).unwrap();
        assert!((side.point[0] - 1.0).abs() < 1e-12 && (side.normal[0] + 1.0).abs() < 1e-12);
    }

    #[test]
    fn a_notch_is_looked_into() {
        let ell = [[0.0, 0.0], [2.0, 0.0], [2.0, 1.0], [1.0, 1.0], [1.0, 2.0], [0.0, 2.0]];
        let body = Body::new(&Shape::Polygon(ell.to_vec()), 0.1);
        assert_eq!(body.hit(&ray([1.5, 1.5, 2.0], [1.5, 1.5])), None);
        assert_eq!(body.hit(&ray([0.5, 1.5, 2.0], [0.5, 1.5])).unwrap().face, 0);
    }

    #[test]
    fn a_shadow_is_as_long_as_similar_triangles_say() {
        let body = Body::new(&Shape::Rect([1.0, 0.0, 1.2, 1.0]), 0.5);
        let lamp = [0.2, 0.5, 1.5];
        // The top's far edge, 1 m from the lamp's foot, throws its shadow 1.5 m from it.
        for (x, dark) in [(1.69, true), (1.71, false), (1.3, true), (0.9, false)] {
            assert_eq!(body.blocks([x, 0.5, 0.0], lamp), dark, "{x}");
            assert!(!dark || body.may_block([x, 0.5, 0.0], lamp, 0.1));
        }
    }

    #[test]
    fn a_mark_points_ahead_and_a_tag_has_its_right_edge_there() {
        let pose = TruePose { x: 1.0, y: 1.0, heading: std::f64::consts::FRAC_PI_2 };
        let triangle = Mark::Triangle([1; 3]);
        assert_eq!(triangle.colour(pose, 0.1, [1.0, 1.07]), Some([1; 3]));
        assert_eq!(triangle.colour(pose, 0.1, [1.0, 0.93]), None);
        // One white cell: the top right one. Ahead is up, so that it lies up and to the left.
        let tag = Mark::Tag { side: 0.1, cells: vec![false, true, false, false] };
        assert_eq!(tag.colour(pose, 0.1, [0.98, 1.02]), Some([245; 3]));
        for at in [[1.02, 1.02], [0.98, 0.98], [1.02, 0.98]] {
            assert_eq!(tag.colour(pose, 0.1, at), Some([15; 3]));
        }
        assert_eq!(tag.colour(pose, 0.1, [1.06, 1.0]), None);
    }
}
