//! Finds the way from start to goal [Alghannam, Sec. III].
//!
//! ```text
//! grid ─► global paths ─► entry and exit points ─► useless points dropped ─► safety test ─► plan
//! areas   of areas        local paths, 0.1 mm      shortest over the rest    exact         metres
//! ```
//! [`plan`] shows the whole flow. Every path it returns has passed [`LegTest`], which looks at the
//! grown boxes alone and shares nothing with the search. Metres outside, lattice units inside;
//! the first and last waypoint are the given points to the last bit.

mod clearance;
mod ends;
mod error;
mod exact;
mod leg_test;
mod local_path;
mod ranked;
mod shortest_path;
mod tree;

pub use clearance::clearance;
pub use error::{Blocker, End, PlanError};
pub use leg_test::LegTest;
pub use local_path::{drop_useless_points, entry_exit_points};
pub use shortest_path::{GlobalPath, shortest_path};
pub use tree::{NODE_LIMIT, PathTree, TreeNode, global_paths};

use crate::geometry::Point;
use crate::grid::{
    Area, EnlargedArena, LatticePoint, LatticeRect, Margin, MiniMatrix, close_traps, enlarge,
};
use crate::scene::Scene;
use local_path::{Sight, length, shortest_over};

/// How the way is searched.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Planner {
    /// The paper's grid method with Dijkstra's algorithm: one global path, then shortened.
    #[default]
    Grid,
    /// The paper's tree of all global paths, each shortened; the shortest wins.
    Tree,
}

impl Planner {
    /// The planner's name on the command line and in files.
    pub fn name(self) -> &'static str {
        match self {
            Self::Grid => "grid",
            Self::Tree => "tree",
        }
    }
}

/// What to plan with.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct PlanOptions {
    /// How the way is searched.
    pub planner: Planner,
    /// Distance to keep beyond the robot's radius.
    pub margin: Margin,
}

/// A way from start to goal that was tested to be free.
#[derive(Clone, Debug, PartialEq)]
pub struct Plan {
    /// Which planner found it.
    pub planner: Planner,
    /// Where the robot turns, start and goal included, metres.
    pub waypoints: Vec<Point>,
    /// The length of the way, metres.
    pub length: f64,
    /// The least distance of the way to the true obstacles and the arena's border, metres.
    pub clearance: f64,
    /// What the grid method saw on the way.
    pub grid: Option<GridStages>,
}

/// The stages of the grid method, for pictures and for the curious.
#[derive(Clone, Debug, PartialEq)]
pub struct GridStages {
    /// The grown obstacles and the shrunk border.
    pub arena: EnlargedArena,
    /// The mini-matrix with its terminals, before traps are closed.
    pub matrix: MiniMatrix,
    /// The same with the traps closed.
    pub closed: MiniMatrix,
    /// The traps, in the order of closing.
    pub traps: Vec<Area>,
    /// The tree of global paths, if the planner grew one.
    pub tree: Option<PathTree>,
    /// The global path that was chosen.
    pub global_path: GlobalPath,
    /// Its start, entry and exit points and goal.
    pub entry_exit_points: Vec<LatticePoint>,
    /// Those of them that are left when the useless ones are dropped.
    pub kept: Vec<LatticePoint>,
}

/// Plans the way of the robot of `scene` from `start` to `goal`.
///
/// # Errors
/// [`PlanError`] if the arena cannot be prepared, an end is outside or blocked, or nothing leads
/// from one to the other.
///
/// ```
/// use host::{geometry::{Point, Rect}, plan::{PlanOptions, plan}, scene::Scene};
/// let mut scene = Scene::new(1.0, 1.0);
/// scene.obstacles.push(Rect::new(0.4, 0.0, 0.6, 0.5));
/// let plan = plan(&scene, Point::new(0.1, 0.1), Point::new(0.9, 0.1), &PlanOptions::default())?;
/// assert_eq!(plan.waypoints[1], Point::new(0.325, 0.575)); // past the grown box's corner
/// assert_eq!(plan.waypoints.len(), 4);
/// # Ok::<(), host::plan::PlanError>(())
/// ```
pub fn plan(
    scene: &Scene,
    start: Point,
    goal: Point,
    options: &PlanOptions,
) -> Result<Plan, PlanError> {
    let arena = enlarge(scene, &options.margin)?;
    let matrix = MiniMatrix::from_borders(&arena)?;
    let free: Vec<LatticeRect> =
        matrix.areas().filter(|&area| matrix.is_live(area)).map(|area| matrix.rect(area)).collect();
    let from = ends::locate(End::Start, start, scene, &arena, &free)?;
    let to = ends::locate(End::Goal, goal, scene, &arena, &free)?;
    let stages =
        grid_stages(arena, matrix, (from, to), options.planner).ok_or(PlanError::NoPath)?;
    let waypoints = to_waypoints(&stages.kept, start, goal);
    if let Err(leg) = LegTest::new(&stages.arena).check_path(&stages.kept) {
        return Err(PlanError::Unsafe { from: waypoints[leg], to: waypoints[leg + 1] });
    }
    Ok(Plan {
        planner: options.planner,
        length: waypoints.windows(2).map(|leg| leg[0].distance(leg[1])).sum(),
        clearance: clearance(&waypoints, scene),
        waypoints,
        grid: Some(stages),
    })
}

/// The grid method from the mini-matrix to the points of the path; `None` if the areas do not connect.
fn grid_stages(
    arena: EnlargedArena,
    mut matrix: MiniMatrix,
    points: (LatticePoint, LatticePoint),
    planner: Planner,
) -> Option<GridStages> {
    let ends = (matrix.mark_terminal(points.0)?, matrix.mark_terminal(points.1)?);
    let mut closed = matrix.clone();
    let traps = close_traps(&mut closed);
    let mut sight = Sight::new(LegTest::new(&arena));
    let local = |path: &GlobalPath| entry_exit_points(&closed, &path.areas, points.0, points.1);
    let (global_path, tree) = match planner {
        Planner::Grid => (shortest_path(&closed, ends, points)?, None),
        Planner::Tree => {
            let tree = global_paths(&closed, ends, points, NODE_LIMIT);
            let shortened =
                |&at: &usize| length(&shortest_over(&local(&tree.path(at)), &mut sight));
            let lengths: Vec<f64> = tree.arrivals.iter().map(shortened).collect();
            let best = (0..lengths.len()).min_by(|&a, &b| lengths[a].total_cmp(&lengths[b]))?;
            (tree.path(tree.arrivals[best]), Some(tree))
        }
    };
    let entry_exit_points = local(&global_path);
    let kept = shortest_over(&entry_exit_points, &mut sight);
    Some(GridStages { arena, matrix, closed, traps, tree, global_path, entry_exit_points, kept })
}

/// The points in metres, with the given start and goal to the last bit.
fn to_waypoints(points: &[LatticePoint], start: Point, goal: Point) -> Vec<Point> {
    let mut waypoints: Vec<Point> = points.iter().map(|point| point.to_metres()).collect();
    if let [first, .., last] = waypoints.as_mut_slice() {
        (*first, *last) = (start, goal);
        return waypoints;
    }
    vec![start, goal]
}

#[cfg(test)]
mod tests;
