//! The arena around the base: true shapes and walls, and whether the robot touched one. Metres.

use crate::base::{Contact, TruePose};
use crate::motion::Mover;
use std::time::Duration;

/// Overlaps up to this depth are contact, not collision, m.
const CONTACT: f64 = 0.0001;
/// How far the gap is looked at on either side for the way in which it grows, m.
const NUDGE: f64 = 1e-7;
/// A robot that has bumped against something has left it when it is so far from it, m.
const LEFT: f64 = 0.001;

/// What stands on the floor, m.
#[derive(Clone, Debug, PartialEq)]
pub enum Shape {
    /// A rectangle along the walls: x0, y0, x1, y1.
    Rect([f64; 4]),
    /// A simple polygon, its corners x, y in either direction.
    Polygon(Vec<[f64; 2]>),
    /// A disc: x, y of the centre, radius.
    Circle([f64; 3]),
}

impl Shape {
    /// The same elsewhere, by these lengths, m.
    pub fn shifted(&self, [dx, dy]: [f64; 2]) -> Self {
        match self {
            &Self::Rect([x0, y0, x1, y1]) => Self::Rect([x0 + dx, y0 + dy, x1 + dx, y1 + dy]),
            &Self::Circle([x, y, radius]) => Self::Circle([x + dx, y + dy, radius]),
            Self::Polygon(corners) => {
                Self::Polygon(corners.iter().map(|[x, y]| [x + dx, y + dy]).collect())
            }
        }
    }

    /// Its corners; of a disc, points around it.
    pub fn outline(&self) -> Vec<[f64; 2]> {
        match self {
            &Self::Rect([x0, y0, x1, y1]) => vec![[x0, y0], [x1, y0], [x1, y1], [x0, y1]],
            Self::Polygon(corners) => corners.clone(),
            Self::Circle([x, y, radius]) => (0..48)
                .map(|part| std::f64::consts::TAU * f64::from(part) / 48.0)
                .map(|angle| [x + radius * angle.cos(), y + radius * angle.sin()])
                .collect(),
        }
    }

    /// The distance from the point to the shape's outline, negative inside.
    fn signed_distance(&self, x: f64, y: f64) -> f64 {
        match self {
            Self::Circle([cx, cy, radius]) => (x - cx).hypot(y - cy) - radius,
            Self::Polygon(corners) => polygon_distance(corners, x, y),
            &Self::Rect([x0, y0, x1, y1]) => {
                let (outside_x, outside_y) = ((x0 - x).max(x - x1), (y0 - y).max(y - y1));
                if outside_x <= 0.0 && outside_y <= 0.0 {
                    outside_x.max(outside_y)
                } else {
                    outside_x.max(0.0).hypot(outside_y.max(0.0))
                }
            }
        }
    }
}

/// As [`Shape::signed_distance`].
fn polygon_distance(corners: &[[f64; 2]], x: f64, y: f64) -> f64 {
    let to_edge = |(&a, &b)| segment_square([x, y], a, b);
    let edges = corners.iter().zip(corners.iter().cycle().skip(1));
    let nearest = edges.map(to_edge).fold(f64::INFINITY, f64::min).sqrt();
    if polygon_holds(corners, [x, y]) { -nearest } else { nearest }
}

/// Whether a point lies inside a simple polygon: what goes from it to the right crosses an odd number of edges.
pub(crate) fn polygon_holds(corners: &[[f64; 2]], [x, y]: [f64; 2]) -> bool {
    let edges = corners.iter().zip(corners.iter().cycle().skip(1));
    let crossed = edges.filter(|&(&[ax, ay], &[bx, by])| {
        (ay > y) != (by > y) && x < ax + (y - ay) / (by - ay) * (bx - ax)
    });
    crossed.count() % 2 == 1
}

/// The square of the distance from a point to the segment from `a` to `b`, m².
pub(crate) fn segment_square([x, y]: [f64; 2], [ax, ay]: [f64; 2], [bx, by]: [f64; 2]) -> f64 {
    let (px, py, ex, ey) = (x - ax, y - ay, bx - ax, by - ay);
    let square = ex * ex + ey * ey;
    let share = if square > 0.0 { ((px * ex + py * ey) / square).clamp(0.0, 1.0) } else { 0.0 };
    let (dx, dy) = (px - share * ex, py - share * ey);
    dx * dx + dy * dy
}

/// A true arena.
#[derive(Clone, Debug, PartialEq)]
pub struct World {
    /// Width and height of the floor, m.
    pub size: [f64; 2],
    /// What stands on the floor.
    pub shapes: Vec<Shape>,
    /// Shapes that move.
    pub movers: Vec<Mover>,
    /// Radius of the robot's disc, m.
    pub robot_radius: f64,
}

impl World {
    /// Moves what moves to where it is at `now`.
    pub fn advance(&mut self, now: Duration) {
        self.movers.iter_mut().for_each(|mover| mover.advance(now));
    }

    /// The gap between the robot's disc at `pose` and the nearest shape or wall, m; negative where it overlaps.
    ///
    /// ```
    /// use wmr_sim::{base::TruePose, world::{Shape, World}};
    /// let shapes = vec![Shape::Rect([1.0, 0.0, 1.2, 1.0])];
    /// let world = World { size: [2.0, 1.0], shapes, movers: Vec::new(), robot_radius: 0.1 };
    /// let gap = world.clearance(TruePose { x: 0.5, y: 0.5, heading: 0.0 });
    /// assert!((gap - 0.4).abs() < 1e-12);
    /// ```
    pub fn clearance(&self, pose: TruePose) -> f64 {
        let TruePose { x, y, .. } = pose;
        let [width, height] = self.size;
        let wall = x.min(y).min(width - x).min(height - y);
        let moving = self.movers.iter().map(Mover::shape);
        let nearest = self.shapes.iter().chain(moving).map(|shape| shape.signed_distance(x, y));
        nearest.fold(wall, f64::min) - self.robot_radius
    }

    /// Where the robot's disc at `pose` overlaps a shape or wall, and which way is out: that in which the
    /// gap grows fastest.
    pub fn contact(&self, pose: TruePose) -> Option<Contact> {
        let depth = -self.clearance(pose);
        if depth <= 0.0 {
            return None;
        }
        let gap =
            |dx: f64, dy: f64| self.clearance(TruePose { x: pose.x + dx, y: pose.y + dy, ..pose });
        let [x, y] = [gap(NUDGE, 0.0) - gap(-NUDGE, 0.0), gap(0.0, NUDGE) - gap(0.0, -NUDGE)];
        let length = x.hypot(y);
        // In the very middle between two sides there is no nearest one: any way is as good.
        let normal = if length > 0.0 { [x / length, y / length] } else { [1.0, 0.0] };
        Some(Contact { depth, normal })
    }
}

/// What has happened to the robot in its world so far.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CollisionLog {
    /// How often the robot ran into a shape or wall.
    pub collisions: u32,
    /// The smallest gap so far, m; infinite before the first look.
    pub min_clearance: f64,
    touching: bool,
}

impl Default for CollisionLog {
    fn default() -> Self {
        Self { collisions: 0, min_clearance: f64::INFINITY, touching: false }
    }
}

impl CollisionLog {
    /// Takes in the gap at one moment.
    pub fn observe(&mut self, clearance: f64) {
        let touching = clearance < -CONTACT;
        self.collisions += u32::from(touching && !self.touching);
        self.touching = touching;
        self.min_clearance = self.min_clearance.min(clearance);
    }

    /// Whether the robot touches something now.
    pub fn is_touching(&self) -> bool {
        self.touching
    }

    /// Takes in the gap where shapes keep the robot out, and how deep it would have gone without, m.
    pub fn observe_among_solids(&mut self, clearance: f64, depth: Option<f64>) {
        let bumps = depth.is_some();
        self.collisions += u32::from(bumps && !self.touching);
        self.touching = bumps || (self.touching && clearance < LEFT);
        self.min_clearance = self.min_clearance.min(clearance.min(-depth.unwrap_or(-clearance)));
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn at(x: f64, y: f64) -> TruePose {
        TruePose { x, y, heading: 0.0 }
    }

    #[test]
    fn clearance_to_walls_edges_corners_and_insides() {
        let shapes = vec![Shape::Rect([1.0, 1.0, 2.0, 2.0])];
        let world = World { size: [4.0, 4.0], shapes, movers: Vec::new(), robot_radius: 0.1 };
        assert!((world.clearance(at(0.3, 3.0)) - 0.2).abs() < 1e-12);
        assert!((world.clearance(at(2.5, 1.5)) - 0.4).abs() < 1e-12);
        assert!((world.clearance(at(2.3, 2.4)) - 0.4).abs() < 1e-12);
        assert!((world.clearance(at(1.5, 1.2)) + 0.3).abs() < 1e-12);
    }

    #[test]
    fn a_rectangle_written_as_a_polygon_is_the_same_and_a_disc_is_round() {
        let rect = Shape::Rect([1.0, 1.0, 2.0, 3.0]);
        let corners = vec![[1.0, 1.0], [1.0, 3.0], [2.0, 3.0], [2.0, 1.0]];
        let polygon = Shape::Polygon(corners);
        for (x, y) in [(0.5, 0.5), (1.25, 2.0), (2.5, 1.5), (3.0, 4.0), (1.0, 2.0)] {
            let (a, b) = (rect.signed_distance(x, y), polygon.signed_distance(x, y));
            assert!((a - b).abs() < 1e-12, "({x}, {y}): {a} {b}");
        }
        let disc = Shape::Circle([1.0, 1.0, 0.5]);
        assert_eq!((disc.signed_distance(1.0, 2.0), disc.signed_distance(1.0, 1.25)), (0.5, -0.25));
    }

    #[test]
    fn the_notch_of_a_concave_polygon_is_outside() {
        let ell = [[0.0, 0.0], [2.0, 0.0], [2.0, 1.0], [1.0, 1.0], [1.0, 2.0], [0.0, 2.0]];
        let ell = Shape::Polygon(ell.to_vec());
        assert!((ell.signed_distance(1.5, 1.5) - 0.5).abs() < 1e-12);
        assert!((ell.signed_distance(0.5, 1.5) + 0.5).abs() < 1e-12);
    }

    /// From a random place a little inside, the way out leads out: at once beside one shape, in turns in
    /// the corner of two.
    #[test]
    fn the_way_out_leads_out() {
        let corners = [[3.0, 0.5], [3.5, 1.5], [3.0, 1.2], [2.5, 1.5]];
        let shapes = vec![
            Shape::Rect([1.0, 1.0, 2.0, 2.0]),
            Shape::Circle([0.5, 3.0, 0.2]),
            Shape::Polygon(corners.to_vec()),
        ];
        let world = World { size: [4.0, 4.0], shapes, movers: Vec::new(), robot_radius: 0.1 };
        let mut random = fastrand::Rng::with_seed(1);
        let mut touched = 0;
        for _ in 0..2000 {
            let mut pose = at(4.0 * random.f64(), 4.0 * random.f64());
            let start = world.contact(pose).filter(|contact| contact.depth < 0.05);
            touched += u32::from(start.is_some());
            let mut next = start;
            for _ in 0..8 {
                let Some(Contact { depth, normal: [x, y] }) = next else { break };
                (pose.x, pose.y) = (pose.x + depth * x, pose.y + depth * y);
                next = world.contact(pose);
            }
            if start.is_some() {
                assert!(world.clearance(pose) > -1e-5, "{pose:?} {start:?}");
            }
        }
        assert!(touched > 100);
    }

    #[test]
    fn a_bump_is_one_collision_until_the_robot_has_left() {
        let mut log = CollisionLog::default();
        for (clearance, depth) in
            [(0.1, None), (0.0, Some(0.0002)), (0.0, None), (0.0005, Some(0.0001)), (0.01, None)]
        {
            log.observe_among_solids(clearance, depth);
        }
        assert_eq!((log.collisions, log.min_clearance), (1, -0.0002));
        log.observe_among_solids(0.0, Some(0.0001));
        assert_eq!(log.collisions, 2);
    }

    #[test]
    fn one_long_touch_is_one_collision() {
        let mut collision_log = CollisionLog::default();
        for clearance in [0.1, -0.00005, -0.01, -0.02, 0.05, -0.001] {
            collision_log.observe(clearance);
        }
        assert_eq!(collision_log.collisions, 2);
        assert_eq!(collision_log.min_clearance, -0.02);
    }
}
