//! Why there is no way: the narrowest gap on the best way through.
//!
//! The best way through is the one that the widest robot could take. Its width is found by halving:
//! a robot of that width still passes, one a unit (0.1 mm) wider on either side does not, and what
//! that one would touch on both sides makes the gap.

use super::disc::DiscArena;
use super::exact::Exact;
use super::leg_check::crosses;
use crate::geometry::Point;
use crate::geometry::Rect;
use crate::grid::{EnlargedArena, LatticePoint, LatticeRect, UNITS_PER_METRE, enlarge};
use crate::scene::Scene;
use crate::shape::Shape;
use std::fmt;

/// A gap too narrow for the robot.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Gap {
    /// How wide it is, metres.
    pub width: f64,
    /// How wide the robot is with its margin, metres.
    pub need: f64,
    /// What makes it.
    pub between: [Side; 2],
}

/// One side of a gap.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Side {
    /// The obstacle with this index in the scene.
    Obstacle(usize),
    /// The arena's border.
    Border,
}

impl fmt::Display for Side {
    /// Obstacles are counted from 1.
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Obstacle(index) => write!(out, "obstacle {}", index + 1),
            Self::Border => out.write_str("the border"),
        }
    }
}

/// The gap that keeps the robot of `scene` from getting from `start` to `goal`; `None` if not even a
/// point could pass.
pub(super) fn narrowest_gap(
    scene: &Scene,
    margin: f64,
    start: LatticePoint,
    goal: LatticePoint,
) -> Option<Gap> {
    let by = scene.robot_radius + margin;
    let arena = |units: i32| enlarge(&for_radius(scene, units), 0.0).ok();
    let passes = |units: i32| Some(Exact::new(&arena(units)?).connects(start, goal));
    let (mut narrow, mut wide) = (0, (by * UNITS_PER_METRE).ceil() as i32);
    if !passes(narrow)? {
        return None;
    }
    while wide - narrow > 1 {
        let middle = (narrow + wide) / 2;
        if passes(middle)? { narrow = middle } else { wide = middle }
    }
    let open = arena(narrow)?;
    let path = Exact::new(&open).shortest(start, goal)?;
    let (between, width) = sides(scene, &open, &arena(wide)?, &path)?;
    Some(Gap { width, need: 2.0 * by, between })
}

/// `scene` for a robot whose radius is so many units.
fn for_radius(scene: &Scene, units: i32) -> Scene {
    Scene { robot_radius: f64::from(units) / UNITS_PER_METRE, ..scene.clone() }
}

/// As [`narrowest_gap`], under inflation by a disc: its width is the least distance of the two shapes.
pub(super) fn disc_gap(scene: &Scene, margin: f64, start: Point, goal: Point) -> Option<Gap> {
    let by = scene.robot_radius + margin;
    let arena = |units: i32| DiscArena::new(&for_radius(scene, units), 0.0).ok();
    let passes = |units: i32| arena(units).is_some_and(|arena| arena.connects(start, goal));
    let (mut narrow, mut wide) = (0, (by * UNITS_PER_METRE).ceil() as i32);
    if !passes(narrow) {
        return None;
    }
    while wide - narrow > 1 {
        let middle = (narrow + wide) / 2;
        if passes(middle) { narrow = middle } else { wide = middle }
    }
    let path = arena(narrow)?.shortest(&for_radius(scene, narrow), start, goal).ok()?.waypoints;
    // What the path passes on both sides is no further from it than the robot's radius and an arc's
    // tangents; what is no further apart than that robot is wide is what the next wider one touches.
    let reach = f64::from(wide) / UNITS_PER_METRE + 2.0 * NEAR;
    let near: Vec<usize> = (0..scene.obstacles.len())
        .filter(|&index| {
            let footprint = &scene.obstacles[index].footprint;
            path.windows(2).any(|leg| footprint.leg_distance(leg[0], leg[1]) <= reach)
        })
        .collect();
    let passed = 2.0 * f64::from(narrow) / UNITS_PER_METRE;
    let (between, width) = narrowest_pair(scene, &near, passed)?;
    Some(Gap { width, need: 2.0 * by, between })
}

/// How much further than the robot's radius what it passes may lie, metres: tangents replace arcs.
const NEAR: f64 = 0.001;

/// The two of these obstacles, or one of them and the border, that are least far apart but far enough for
/// a robot that is `passed` metres wide: others are near the path, but it does not lead between them.
fn narrowest_pair(scene: &Scene, near: &[usize], passed: f64) -> Option<([Side; 2], f64)> {
    let shape = |index: usize| &scene.obstacles[index].footprint;
    let pairs = near.iter().enumerate().flat_map(|(place, &i)| {
        near[..place]
            .iter()
            .map(move |&j| ([Side::Obstacle(j), Side::Obstacle(i)], apart_of(shape(i), shape(j))))
    });
    let to_border = near.iter().map(|&i| {
        let bounds = shape(i).bounds();
        let (right, above) = (scene.arena.width - bounds.x1, scene.arena.height - bounds.y1);
        let least = bounds.x0.min(bounds.y0).min(right).min(above);
        ([Side::Obstacle(i), Side::Border], least)
    });
    let is_passed = |(_, width): &([Side; 2], f64)| *width > 0.0 && *width >= passed;
    pairs.chain(to_border).filter(is_passed).min_by(|a, b| a.1.total_cmp(&b.1))
}

/// The distance between two shapes, metres.
fn apart_of(a: &Shape, b: &Shape) -> f64 {
    // A disc is as far as its centre, less its radius.
    if let Shape::Circle(disc) = b {
        return (a.distance(disc.centre) - disc.radius).max(0.0);
    }
    let outline = b.outline();
    let edges = outline.iter().zip(outline.iter().cycle().skip(1));
    edges.map(|(&from, &to)| a.leg_distance(from, to)).fold(f64::INFINITY, f64::min)
}

/// The two sides that the path passes between in the `open` arena and that meet in the `shut` one,
/// and how far they truly are apart, metres.
fn sides(
    scene: &Scene,
    open: &EnlargedArena,
    shut: &EnlargedArena,
    path: &[LatticePoint],
) -> Option<([Side; 2], f64)> {
    let bounds = |index: usize| {
        let owner = *shut.owners.get(index)?;
        Some((owner, scene.obstacles.get(owner)?.footprint.bounds()))
    };
    let near: Vec<usize> = (0..shut.boxes.len())
        .filter(|&index| {
            path.windows(2).any(|leg| crosses(leg[0], leg[1], widened(shut.boxes[index])))
        })
        .collect();
    let meet = |a: LatticeRect, b: LatticeRect| {
        let common = a.intersection(b);
        common.x0 <= common.x1 && common.y0 <= common.y1
    };
    for (place, &i) in near.iter().enumerate() {
        let (first, rect) = bounds(i)?;
        if let Some(width) = to_border(i, rect, scene, open, shut) {
            return Some(([Side::Obstacle(first), Side::Border], width));
        }
        for &j in &near[..place] {
            if meet(shut.boxes[i], shut.boxes[j]) && !meet(open.boxes[i], open.boxes[j]) {
                let (second, other) = bounds(j)?;
                return Some((
                    [Side::Obstacle(second), Side::Obstacle(first)],
                    apart(&rect, &other),
                ));
            }
        }
    }
    None
}

/// The box with its edges so much further out that a path through a gap of two units, what the open
/// arena leaves at most, crosses the boxes on either side wherever it runs.
fn widened(rect: LatticeRect) -> LatticeRect {
    LatticeRect::new(rect.x0 - 3, rect.y0 - 3, rect.x1 + 3, rect.y1 + 3)
}

/// The true distance to the side of the border that the box meets in the `shut` arena only, metres.
fn to_border(
    index: usize,
    rect: Rect,
    scene: &Scene,
    open: &EnlargedArena,
    shut: &EnlargedArena,
) -> Option<f64> {
    let between = |arena: &EnlargedArena| {
        let (grown, inside) = (arena.boxes[index], arena.inside);
        [grown.x0 - inside.x0, grown.y0 - inside.y0, inside.x1 - grown.x1, inside.y1 - grown.y1]
    };
    let (open, shut) = (between(open), between(shut));
    let side = (0..4).find(|&side| open[side] > 0 && shut[side] <= 0)?;
    let (right, above) = (scene.arena.width - rect.x1, scene.arena.height - rect.y1);
    Some([rect.x0, rect.y0, right, above][side])
}

/// How wide a square robot passes between the two.
fn apart(a: &Rect, b: &Rect) -> f64 {
    let x = (b.x0 - a.x1).max(a.x0 - b.x1);
    let y = (b.y0 - a.y1).max(a.y0 - b.y1);
    x.max(y)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::plan::{PlanError, PlanOptions, plan};

    fn refused(obstacles: &[[f64; 4]]) -> PlanError {
        let mut scene = Scene::new(2.0, 1.0);
        scene.obstacles = obstacles.iter().map(|&numbers| Rect::from(numbers).into()).collect();
        let ends = [Point::new(0.2, 0.5), Point::new(1.8, 0.5)];
        plan(&scene, ends[0], ends[1], &PlanOptions::default()).unwrap_err()
    }

    #[test]
    fn the_widest_of_the_narrow_gaps_is_named_with_its_width() {
        // A wall of three boxes: gaps of 11 and of 6 cm.
        let error = refused(&[[0.9, 0.0, 1.1, 0.3], [0.9, 0.41, 1.1, 0.7], [0.9, 0.76, 1.1, 1.0]]);
        let PlanError::NoPath { gap: Some(gap) } = &error else { panic!("{error}") };
        assert_eq!(gap.between, [Side::Obstacle(0), Side::Obstacle(1)]);
        assert!((gap.width - 0.11).abs() < 1e-12 && (gap.need - 0.15).abs() < 1e-12);
        assert!(error.to_string().contains(
            "a gap of 11.0 cm between obstacle 1 and obstacle 2, the robot with its margin needs 15.0 cm"
        ));
    }

    #[test]
    fn a_gap_at_the_border_names_the_border() {
        let PlanError::NoPath { gap } = refused(&[[0.9, 0.1, 1.1, 1.0]]) else { panic!() };
        let gap = gap.unwrap();
        assert_eq!(gap.between, [Side::Obstacle(0), Side::Border]);
        assert!((gap.width - 0.1).abs() < 1e-12);
    }

    #[test]
    fn a_closed_wall_has_no_gap() {
        assert_eq!(refused(&[[0.9, 0.0, 1.1, 1.0]]), PlanError::NoPath { gap: None });
    }
}
