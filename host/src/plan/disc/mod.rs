//! The exact shortest path of a disc among shapes of any form.
//!
//! ```text
//! shapes ─► contours ─► border of the ─► trapezoids ─► interval search ─► distance test ─► points
//!           inflated    free floor       portals       (Polyanya)         on the shapes
//! ```
//! Deviation: the paper grows rectangles to rectangles, which keeps the robot up to 41 % of its radius
//! further from a corner than it must, and knows no other shapes. Here every shape is inflated by a disc:
//! arcs are replaced by tangents outside, at most half a millimetre from the true arc. A place between an
//! arc and its tangents is reached by one more straight leg.
//!
//! The lattice is finer than the grid's, so that crossings of contours are rounded by less than can be
//! measured. Whatever is found, [`DistanceTest`] has the last word. Metres outside.

mod contour;
mod distance_test;
mod free_space;
mod trapezoids;

use super::box_index::BoxIndex;
use super::exact::{Mesh, Query, Search};
use crate::geometry::{Point, Rect};
use crate::grid::{GridError, LatticePoint, LatticeRect};
use crate::scene::{Obstacle, Scene};
use crate::shape::Shape;
use contour::{Fine, Inflated, TOLERANCE};
use distance_test::DistanceTest;
use free_space::border_of_free_space;
use trapezoids::{Cell, trapezoids};

/// A way turns at a crossing of two contours only because the crossing was rounded, by so many units.
const ROUNDED: f64 = 4.0;

/// A scene made ready for a disc.
#[derive(Clone, Debug)]
pub(super) struct DiscArena {
    fine: Fine,
    test: DistanceTest,
    cells: Vec<Cell>,
    mesh: Mesh,
    /// By cell.
    components: Vec<u32>,
    /// Where the robot's centre may be as far as the border is concerned.
    inside: LatticeRect,
    /// The cells by place, once many queries are expected.
    index: Option<BoxIndex>,
    search: Search,
    was_asked: bool,
}

/// A way, and whether its first leg only leads to where the robot may be.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct DiscWay {
    pub(super) waypoints: Vec<Point>,
    pub(super) exits: bool,
}

/// The outlines of the obstacles of `scene` inflated by a disc as large as its robot and `margin`, metres,
/// in the scene's order. An outline may cross itself: what it encloses at all is what the robot's centre
/// keeps out of.
///
/// # Errors
/// [`GridError`] if a coordinate is too large or the robot does not fit between the borders.
pub fn inflated_contours(scene: &Scene, margin: f64) -> Result<Vec<Vec<Point>>, GridError> {
    let (fine, _, shapes) = inflated(scene, margin)?;
    let contour =
        |shape: &Inflated| shape.contour(fine).into_iter().map(|at| fine.to_metres(at)).collect();
    Ok(shapes.iter().map(contour).collect())
}

/// Why there is no way.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum NoWay {
    /// The robot cannot stand at the start.
    StartBlocked,
    /// The robot cannot stand at the goal.
    GoalBlocked,
    /// Nothing leads from one to the other.
    Apart,
}

impl DiscArena {
    /// `scene` for its robot, which keeps `margin` metres more from everything.
    ///
    /// # Errors
    /// [`GridError`] if a coordinate is too large or the robot does not fit between the borders.
    pub(super) fn new(scene: &Scene, margin: f64) -> Result<Self, GridError> {
        let (fine, inside, shapes) = inflated(scene, margin)?;
        let contours: Vec<Vec<LatticePoint>> =
            shapes.iter().map(|shape| shape.contour(fine)).collect();
        let (cells, mesh) = trapezoids(&border_of_free_space(inside, &contours));
        Ok(Self {
            fine,
            test: DistanceTest::new(inside, shapes),
            components: mesh.components(),
            cells,
            mesh,
            inside,
            index: None,
            search: Search::default(),
            was_asked: false,
        })
    }

    /// The shortest way from `start` to `goal`, which are its first and last point to the last bit.
    ///
    /// A robot that stands too near to something first drives straight to the nearest free place from
    /// which a way leads on, if it nowhere comes nearer to an obstacle than it stands.
    ///
    /// # Errors
    /// [`NoWay`].
    pub(super) fn shortest(
        &mut self,
        scene: &Scene,
        start: Point,
        goal: Point,
    ) -> Result<DiscWay, NoWay> {
        if self.was_asked && self.index.is_none() {
            let bounds: Vec<LatticeRect> = self.cells.iter().map(Cell::bounds).collect();
            self.index = Some(BoxIndex::new(self.inside, &bounds));
        }
        self.was_asked = true;
        let (from, to, exits) = self.ends(scene, start, goal)?;
        let points = self.between(from, to).ok_or(NoWay::Apart)?;
        let mut waypoints = vec![start];
        let given = if exits { points.as_slice() } else { points.get(1..).unwrap_or_default() };
        waypoints.extend(given.iter().map(|&point| self.fine.to_metres(point)));
        if let [_, .., last] = waypoints.as_mut_slice() {
            *last = goal;
        }
        Ok(DiscWay { waypoints, exits })
    }

    /// Where the robot is free to begin its way, and whether it is first led there from `start`.
    ///
    /// # Errors
    /// [`NoWay::StartBlocked`] or [`NoWay::GoalBlocked`].
    pub(super) fn beginning(
        &self,
        scene: &Scene,
        start: Point,
        goal: Point,
    ) -> Result<(Point, bool), NoWay> {
        let (from, _, exits) = self.ends(scene, start, goal)?;
        Ok((if exits { self.fine.to_metres(from) } else { start }, exits))
    }

    /// The free points between which the way runs, and whether the first is not the start.
    fn ends(
        &self,
        scene: &Scene,
        start: Point,
        goal: Point,
    ) -> Result<(LatticePoint, LatticePoint, bool), NoWay> {
        let to = self.free_point(goal).ok_or(NoWay::GoalBlocked)?;
        match self.free_point(start) {
            Some(from) => Ok((from, to, false)),
            None => Ok((self.exit(scene, start, to).ok_or(NoWay::StartBlocked)?, to, true)),
        }
    }

    /// Whether the way over `waypoints` is free, by the shapes alone; the index of the first leg that is
    /// not, otherwise. A first leg that `exits` has been judged by what it leads away from.
    ///
    /// # Errors
    /// The index of the refused leg.
    pub(super) fn check_path(&self, waypoints: &[Point], exits: bool) -> Result<(), usize> {
        let points: Vec<LatticePoint> = waypoints.iter().map(|&at| self.end(at)).collect();
        let mut legs = points.windows(2).enumerate().skip(usize::from(exits));
        legs.find(|(_, leg)| !self.test.is_free(leg[0], leg[1])).map_or(Ok(()), |(leg, _)| Err(leg))
    }

    /// Whether a way leads from one point to the other.
    pub(super) fn connects(&self, start: Point, goal: Point) -> bool {
        let (Some(from), Some(to)) = (self.free_point(start), self.free_point(goal)) else {
            return false;
        };
        let cells = |at: LatticePoint| self.attached(at).map(|at| self.cells_at(at));
        let (Some(from), Some(to)) = (cells(from), cells(to)) else { return false };
        self.are_connected(&from, &to)
    }

    /// The obstacles that keep the robot from standing at `point`, by their indices.
    pub(super) fn blockers(&self, point: Point) -> Vec<usize> {
        self.test.blockers(self.fine.nearest(point)).collect()
    }

    /// The free point nearest to `point`, metres; `None` if there is no room at all.
    pub(super) fn nearest_free(&self, point: Point) -> Option<Point> {
        let at = self.fine.nearest(point);
        self.by_distance(at).first().map(|&point| self.fine.to_metres(point))
    }

    /// The lattice point less than a unit from `point` at which the robot can stand, if there is one.
    fn free_point(&self, point: Point) -> Option<LatticePoint> {
        Some(self.end(point)).filter(|&at| self.test.holds(at))
    }

    /// The lattice point for an end of a leg: the nearest, or a free one beside it.
    fn end(&self, point: Point) -> LatticePoint {
        let LatticePoint { x, y } = self.fine.nearest(point);
        let around = [(0, 0), (1, 0), (0, 1), (-1, 0), (0, -1), (1, 1), (-1, 1), (-1, -1), (1, -1)]
            .map(|(dx, dy)| LatticePoint::new(x + dx, y + dy));
        around.into_iter().find(|&at| self.test.holds(at)).unwrap_or(around[0])
    }

    /// The points of the shortest way between two places at which the robot can stand.
    fn between(&mut self, from: LatticePoint, to: LatticePoint) -> Option<Vec<LatticePoint>> {
        let (start, goal) = (self.attached(from)?, self.attached(to)?);
        let (start_pieces, goal_pieces) = (self.cells_at(start), self.cells_at(goal));
        if !self.are_connected(&start_pieces, &goal_pieces) {
            return None;
        }
        let (start_pieces, goal_pieces) = (start_pieces.as_slice(), goal_pieces.as_slice());
        let query = Query { start, goal, start_pieces, goal_pieces };
        let mut points = self.search.shortest(&self.mesh, &query)?;
        if start != from {
            points.insert(0, from);
        }
        if goal != to {
            points.push(to);
        }
        self.drop_idle_points(&mut points, start != from, goal != to);
        Some(points)
    }

    /// The point of the mesh from which a way goes on straight to `at`: `at` itself unless it lies between
    /// an arc and its tangents.
    fn attached(&self, at: LatticePoint) -> Option<LatticePoint> {
        if !self.cells_at(at).is_empty() {
            return Some(at);
        }
        let reach = self.fine.units(2.0 * TOLERANCE);
        let mut near =
            self.by_distance(at).into_iter().take_while(|near| at.distance(*near) <= reach);
        near.find(|&near| self.test.is_free(at, near))
    }

    /// The nearest points of all cells, the nearest first.
    fn by_distance(&self, at: LatticePoint) -> Vec<LatticePoint> {
        let mut near: Vec<LatticePoint> =
            self.cells.iter().filter_map(|cell| cell.nearest(at)).collect();
        near.sort_unstable_by(|a, b| at.distance(*a).total_cmp(&at.distance(*b)));
        near
    }

    /// Drops points at which the way bends only because a crossing was rounded, or because an end lies
    /// between an arc and its tangents.
    fn drop_idle_points(&self, points: &mut Vec<LatticePoint>, at_start: bool, at_goal: bool) {
        let mut index = 1;
        while index + 1 < points.len() {
            let (before, at, after) = (points[index - 1], points[index], points[index + 1]);
            let area = crate::grid::turn(before, after, at).unsigned_abs() as f64;
            let is_rounded = area <= ROUNDED * before.distance(after);
            let is_attached = (at_start && index == 1) || (at_goal && index + 2 == points.len());
            if (is_rounded || is_attached) && self.test.is_free(before, after) {
                points.remove(index);
            } else {
                index += 1;
            }
        }
    }

    /// The nearest free point to which the robot of a blocked `start` can drive straight without coming
    /// nearer to anything than it stands, or than it may, and from which a way leads to `goal`.
    fn exit(&self, scene: &Scene, start: Point, goal: LatticePoint) -> Option<LatticePoint> {
        /// What a computed distance may lose to rounding, metres.
        const ROUNDING: f64 = 1e-7;
        let within = (0.0..=scene.arena.width).contains(&start.x)
            && (0.0..=scene.arena.height).contains(&start.y);
        let touches = |obstacle: &Obstacle| obstacle.footprint.distance(start) <= 0.0;
        if !within || scene.obstacles.iter().any(touches) {
            return None;
        }
        // As far as it may lie: a rectangle's own margins are part of it, others' part of the radius.
        let widest: Vec<Shape> = scene.obstacles.iter().map(widest).collect();
        let stands: Vec<f64> = widest.iter().map(|shape| shape.distance(start)).collect();
        let goal_cells = self.cells_at(self.attached(goal)?);
        let is_safe = |exit: LatticePoint| {
            let to = self.fine.to_metres(exit);
            let mut each = widest.iter().zip(self.test.shapes()).zip(&stands);
            each.all(|((shape, inflated), &stand)| {
                let keep = stand.min(f64::from(inflated.radius) / self.fine.units(1.0));
                shape.leg_distance(start, to) >= keep - ROUNDING
            })
        };
        self.by_distance(self.fine.nearest(start)).into_iter().find(|&exit| {
            self.test.holds(exit)
                && is_safe(exit)
                && self.are_connected(&self.cells_at(exit), &goal_cells)
        })
    }

    fn are_connected(&self, from: &[u32], to: &[u32]) -> bool {
        let component = |cell: &u32| self.components[*cell as usize];
        from.iter().any(|a| to.iter().any(|b| component(a) == component(b)))
    }

    /// The cells that hold `point`, edges included.
    fn cells_at(&self, point: LatticePoint) -> Vec<u32> {
        let holds = |&cell: &usize| self.cells[cell].contains(point);
        let mut holding: Vec<u32> = match &self.index {
            Some(index) => index.at(point).filter(holds).map(|cell| cell as u32).collect(),
            None => (0..self.cells.len()).filter(holds).map(|cell| cell as u32).collect(),
        };
        holding.sort_unstable();
        holding.dedup();
        holding
    }
}

/// The lattice for a scene, the shrunk border on it, and the shapes with the radius to keep from each.
fn inflated(scene: &Scene, margin: f64) -> Result<(Fine, LatticeRect, Vec<Inflated>), GridError> {
    if !(margin.is_finite() && margin >= 0.0) {
        return Err(GridError::Margin { metres: margin });
    }
    let radius = scene.robot_radius + margin;
    let (width, height) = (scene.arena.width, scene.arena.height);
    if width.min(height) <= 2.0 * radius {
        return Err(GridError::ArenaTooSmall { arena: scene.arena, need: 2.0 * radius });
    }
    let floor = Rect::new(0.0, 0.0, width, height);
    let fine = lattice_for(scene, floor, radius)?;
    let inside = shrunk(floor, radius, fine);
    let shapes: Vec<Inflated> =
        scene.obstacles.iter().map(|obstacle| Inflated::new(obstacle, radius, fine)).collect();
    Ok((fine, inside, shapes))
}

/// The obstacle with its edges as far out as they may lie; a shape that has no four edges as it is.
fn widest(obstacle: &Obstacle) -> Shape {
    match obstacle.footprint.as_rect() {
        Some(rect) => rect.widened(obstacle.margin).into(),
        None => obstacle.footprint.clone(),
    }
}

/// The finest lattice that holds the scene with everything inflated.
fn lattice_for(scene: &Scene, floor: Rect, radius: f64) -> Result<Fine, GridError> {
    let furthest = |rect: &Rect| {
        [rect.x0, rect.y0, rect.x1, rect.y1].map(f64::abs).into_iter().fold(0.0, f64::max)
    };
    let bounds = scene.obstacles.iter().map(|obstacle| {
        obstacle.footprint.bounds().widened([obstacle.largest_margin() + radius; 4])
    });
    let widest = bounds.chain([floor]).max_by(|a, b| furthest(a).total_cmp(&furthest(b)));
    let rect = widest.unwrap_or(floor);
    Fine::for_reach(furthest(&rect)).ok_or(GridError::TooLarge { rect })
}

/// The floor with its edges `by` metres further in, rounded inwards.
fn shrunk(floor: Rect, by: f64, fine: Fine) -> LatticeRect {
    const MEANT_WHOLE: f64 = 1e-3;
    let up = |metres: f64| (fine.units(metres) - MEANT_WHOLE).ceil() as i32;
    let down = |metres: f64| (fine.units(metres) + MEANT_WHOLE).floor() as i32;
    LatticeRect::new(up(floor.x0 + by), up(floor.y0 + by), down(floor.x1 - by), down(floor.y1 - by))
}

#[cfg(test)]
mod oracle;
#[cfg(test)]
mod tests;
