//! Finds the way from start to goal [Alghannam, Sec. III].
//!
//! ```text
//!           ┌► MiniMatrix ─► global paths ─► entry and exit points ─► useless points dropped ┐
//! enlarge ──┤  (the paper's: Planner::Grid, Planner::Tree)                                     ├► safety ─► plan
//! squares   └► cells ─► portals ─► interval search   (Planner::Exact) ────────────────────────┤  test      metres
//! inflate ─┬─► trapezoids ─► portals ─► interval search   (Planner::Exact) ───────────────────┤
//! disc     └─► fuzzy grid ─► fast marching ─► taut way     (Planner::Fuzzy) ──────────────────┘
//! ```
//! [`plan`] shows the whole flow; [`PreparedArena`] keeps what many queries share. Every path has
//! passed [`LegTest`], which looks at the grown boxes alone, or under inflation by a disc a test of the
//! distances to the shapes themselves; neither shares anything with the search.
//! Metres outside, lattice units inside; the first and last waypoint are the given points to the last bit.

mod box_index;
mod clearance;
mod cost;
mod disc;
mod ends;
mod error;
mod exact;
mod exit;
mod fuzzy;
mod gap;
mod leg_check;
mod local_path;
mod margins;
mod paper;
mod prepared;
mod ranked;
mod shortest_path;
mod tree;

pub use clearance::clearance;
pub use cost::Cost;
pub use disc::inflated_contours;
pub use error::{Blocker, End, PlanError};
pub use fuzzy::{
    AREA_LIMIT, DEFAULT_AREA, FuzzyArea, FuzzyOptions, FuzzyStages, LARGEST_RISK_WEIGHT,
    MembershipGrid,
};
pub use gap::{Gap, Side};
pub use leg_check::LegTest;
pub use local_path::{drop_useless_points, entry_exit_points};
pub use margins::{DRIVE_MARGINS, MarginPlan, with_margin_fallback};
pub use paper::GridStages;
pub use prepared::PreparedArena;
pub use shortest_path::{GlobalPath, shortest_path};
pub use tree::{NODE_LIMIT, PathTree, TreeNode, global_paths};

use crate::geometry::Point;
use crate::scene::{Obstacle, Scene};
use serde::{Deserialize, Serialize};

/// How the way is searched.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Planner {
    /// The exact shortest path among the grown boxes.
    #[default]
    Exact,
    /// The paper's grid method with Dijkstra's algorithm: one global path, then shortened.
    Grid,
    /// The paper's tree of all global paths, each shortened; the shortest wins.
    Tree,
    /// The fuzzy grid: the way that trades length for risk where edges are unsure.
    Fuzzy,
}

impl Planner {
    /// The planner's name on the command line and in files.
    pub fn name(self) -> &'static str {
        match self {
            Self::Exact => "exact",
            Self::Grid => "grid",
            Self::Tree => "tree",
            Self::Fuzzy => "fuzzy",
        }
    }
}

/// The shape by which obstacles are inflated (their Minkowski sum with it): as large as the robot's
/// radius and the margin together.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
#[serde(rename_all = "lowercase")]
pub enum Inflation {
    /// A square: rectangles stay rectangles, as in the paper; other shapes are covered by rectangles first.
    Square,
    /// A disc: corners become arcs, driven as legs along tangents less than half a millimetre outside.
    Disc,
}

/// What to plan with.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct PlanOptions {
    /// How the way is searched.
    pub planner: Planner,
    /// Distance to keep beyond the robot's radius and the obstacles' own margins, metres.
    pub margin: f64,
    /// What makes a way good; only the exact planner looks at anything but the length.
    pub cost: Cost,
    /// How obstacles are inflated; a disc goes with the fuzzy planner, and with the exact planner and the
    /// length as cost.
    /// `None` leaves it to [`PlanOptions::inflation_for`].
    pub inflation: Option<Inflation>,
    /// What the fuzzy planner alone looks at.
    pub fuzzy: FuzzyOptions,
}

impl PlanOptions {
    /// How the obstacles of `scene` are inflated: as asked for; if nobody asks, by a square as in the
    /// paper where all of them are upright rectangles, else by a disc where the planner can do so. The
    /// fuzzy planner always does.
    ///
    /// ```
    /// use wmr::plan::{Inflation, PlanOptions, Planner};
    /// let mut scene = wmr::scene::Scene::new(1.0, 1.0);
    /// assert_eq!(PlanOptions::default().inflation_for(&scene), Inflation::Square);
    /// scene.obstacles.push(wmr::shape::Circle::from([0.5, 0.5, 0.1]).into());
    /// assert_eq!(PlanOptions::default().inflation_for(&scene), Inflation::Disc);
    /// let grid = PlanOptions { planner: Planner::Grid, ..Default::default() };
    /// assert_eq!(grid.inflation_for(&scene), Inflation::Square);
    /// ```
    pub fn inflation_for(&self, scene: &Scene) -> Inflation {
        let knows_discs = self.planner == Planner::Exact && self.cost == Cost::Length;
        let is_rect = |obstacle: &Obstacle| obstacle.footprint.as_rect().is_some();
        match self.inflation {
            Some(asked) => asked,
            None if self.planner == Planner::Fuzzy => Inflation::Disc,
            None if knows_discs && !scene.obstacles.iter().all(is_rect) => Inflation::Disc,
            None => Inflation::Square,
        }
    }
}

/// A way from start to goal that was tested to be free.
#[derive(Clone, Debug, PartialEq)]
pub struct Plan {
    /// Which planner found it.
    pub planner: Planner,
    /// How the obstacles were inflated.
    pub inflation: Inflation,
    /// Where the robot turns, start and goal included, metres.
    pub waypoints: Vec<Point>,
    /// The length of the way, metres.
    pub length: f64,
    /// The least distance of the way to the true obstacles and the arena's border, metres. With an
    /// exit leg it may be less than radius and margin, but never less than at the start.
    pub clearance: f64,
    /// The length of the first leg, metres, if the robot stands nearer to an obstacle than radius and
    /// margin allow (parked at a wall, say) and that leg only leads it away.
    pub exit_leg: Option<f64>,
    /// What the grid method saw on the way.
    pub grid: Option<GridStages>,
    /// What the fuzzy planner saw on the way.
    pub fuzzy: Option<Box<FuzzyStages>>,
}

/// Plans the way of the robot of `scene` from `start` to `goal`.
///
/// # Errors
/// [`PlanError`] if the arena cannot be prepared, an end is outside or blocked, or nothing leads
/// from one to the other.
///
/// ```
/// use wmr::{geometry::{Point, Rect}, plan::{PlanOptions, plan}, scene::Scene};
/// let mut scene = Scene::new(1.0, 1.0);
/// scene.obstacles.push(Rect::new(0.4, 0.0, 0.6, 0.5).into());
/// let plan = plan(&scene, Point::new(0.1, 0.1), Point::new(0.9, 0.1), &PlanOptions::default())?;
/// assert_eq!(plan.waypoints[1], Point::new(0.325, 0.575)); // past the grown box's corner
/// assert_eq!(plan.waypoints.len(), 4);
/// # Ok::<(), wmr::plan::PlanError>(())
/// ```
pub fn plan(
    scene: &Scene,
    start: Point,
    goal: Point,
    options: &PlanOptions,
) -> Result<Plan, PlanError> {
    PreparedArena::new(scene, options)?.plan(start, goal)
}

#[cfg(test)]
mod tests;
