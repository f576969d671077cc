//! An arena prepared once for many queries.

use super::clearance::{clearance, clearance_by};
use super::cost::best_way;
use super::disc::{DiscArena, NoWay};
use super::exact::Exact;
use super::exit::exit_point;
use super::fuzzy::{FuzzyArena, NoFuzzyWay};
use super::gap::{disc_gap, narrowest_gap};
use super::paper::grid_stages;
use super::{Blocker, Cost, End, Inflation, LegTest, Plan, PlanError, PlanOptions, Planner, ends};
use crate::geometry::Point;
use crate::grid::{EnlargedArena, LatticePoint, LatticeRect, MiniMatrix, enlarge};
use crate::scene::Scene;

/// A scene made ready for planning with one set of options.
#[derive(Clone, Debug)]
pub struct PreparedArena<'a> {
    scene: &'a Scene,
    options: &'a PlanOptions,
    method: Method,
}

/// By what the obstacles are inflated, and what the planner searches.
#[derive(Clone, Debug)]
enum Method {
    Square(Box<SquareArena>),
    Disc(Box<DiscArena>),
    Fuzzy(Box<FuzzyArena>),
}

/// An arena whose obstacles were inflated by a square.
#[derive(Clone, Debug)]
struct SquareArena {
    arena: EnlargedArena,
    test: LegTest,
    search: SquareSearch,
    was_asked: bool,
}

/// What is searched among rectangles.
#[derive(Clone, Debug)]
enum SquareSearch {
    Exact(Box<Exact>),
    Paper { matrix: MiniMatrix, free: Vec<LatticeRect> },
}

impl<'a> PreparedArena<'a> {
    /// Prepares `scene`: inflates its obstacles and cuts the floor into cells or areas.
    ///
    /// # Errors
    /// [`PlanError::Grid`] if the arena cannot be cut.
    ///
    /// ```
    /// use wmr::{geometry::Point, plan::{PlanOptions, PreparedArena}, scene::Scene};
    /// let (scene, options) = (Scene::new(2.0, 1.0), PlanOptions::default());
    /// let mut arena = PreparedArena::new(&scene, &options)?;
    /// let lengths: Vec<f64> = [0.5, 1.5]
    ///     .map(|x| arena.plan(Point::new(0.5, 0.5), Point::new(x, 0.5)).map(|plan| plan.length))
    ///     .into_iter()
    ///     .collect::<Result<_, _>>()?;
    /// assert_eq!(lengths, [0.0, 1.0]);
    /// # Ok::<(), wmr::plan::PlanError>(())
    /// ```
    pub fn new(scene: &'a Scene, options: &'a PlanOptions) -> Result<Self, PlanError> {
        let is_fuzzy = options.planner == Planner::Fuzzy;
        let method = match options.inflation_for(scene) {
            inflation
                if is_fuzzy && (inflation, options.cost) != (Inflation::Disc, Cost::Length) =>
            {
                return Err(PlanError::FuzzyAlone);
            }
            _ if is_fuzzy => {
                Method::Fuzzy(Box::new(FuzzyArena::new(scene, options.margin, options.fuzzy)?))
            }
            Inflation::Disc
                if options.planner != Planner::Exact || options.cost != Cost::Length =>
            {
                return Err(PlanError::DiscNeedsExact);
            }
            Inflation::Disc => Method::Disc(Box::new(DiscArena::new(scene, options.margin)?)),
            Inflation::Square => Method::Square(Box::new(SquareArena::new(scene, options)?)),
        };
        Ok(Self { scene, options, method })
    }

    /// Plans the way from `start` to `goal`.
    ///
    /// # Errors
    /// [`PlanError`] if an end is outside or blocked, or nothing leads from one to the other.
    pub fn plan(&mut self, start: Point, goal: Point) -> Result<Plan, PlanError> {
        match &mut self.method {
            Method::Square(arena) => arena.plan(self.scene, self.options, start, goal),
            Method::Disc(arena) => plan_for_disc(arena, self.scene, self.options, start, goal),
            Method::Fuzzy(arena) => plan_fuzzy(arena, self.scene, self.options, start, goal),
        }
    }
}

impl SquareArena {
    fn new(scene: &Scene, options: &PlanOptions) -> Result<Self, PlanError> {
        let arena = enlarge(scene, options.margin)?;
        let search = match options.planner {
            Planner::Exact => SquareSearch::Exact(Box::new(Exact::new(&arena))),
            Planner::Grid | Planner::Tree | Planner::Fuzzy => {
                let matrix = MiniMatrix::from_borders(&arena)?;
                let live = matrix.areas().filter(|&area| matrix.is_live(area));
                let free = live.map(|area| matrix.rect(area)).collect();
                SquareSearch::Paper { matrix, free }
            }
        };
        Ok(Self { test: LegTest::new(&arena), arena, search, was_asked: false })
    }

    fn plan(
        &mut self,
        scene: &Scene,
        options: &PlanOptions,
        start: Point,
        goal: Point,
    ) -> Result<Plan, PlanError> {
        if let SquareSearch::Exact(exact) = &mut self.search {
            if self.was_asked {
                exact.expect_many(self.arena.inside);
            }
            self.was_asked = true;
        }
        let to = self.locate(scene, End::Goal, goal)?;
        let (from, exits) = match self.locate(scene, End::Start, start) {
            Ok(at) => (at, false),
            Err(blocked @ PlanError::Blocked { .. }) => {
                (self.exit(scene, start, to).ok_or(blocked)?, true)
            }
            Err(error) => return Err(error),
        };
        let no_path = || PlanError::NoPath { gap: narrowest_gap(scene, options.margin, from, to) };
        let (points, grid) = match &mut self.search {
            SquareSearch::Exact(exact) => {
                let shortest = exact.shortest(from, to).ok_or_else(no_path)?;
                (best_way(options.cost, &self.arena, &self.test, shortest), None)
            }
            SquareSearch::Paper { matrix, .. } => {
                let grows_tree = options.planner == Planner::Tree;
                let stages = grid_stages(&self.arena, &self.test, matrix, (from, to), grows_tree);
                let stages = stages.ok_or_else(no_path)?;
                (stages.kept.clone(), Some(stages))
            }
        };
        let waypoints = to_waypoints(&points, start, goal, exits);
        if let Err(leg) = self.test.check_path(&points) {
            let leg = leg + usize::from(exits);
            return Err(PlanError::Unsafe { from: waypoints[leg], to: waypoints[leg + 1] });
        }
        let clearance = clearance_by(&self.test, &self.arena, &waypoints, scene);
        let plan = finished(options, Inflation::Square, waypoints, clearance, exits);
        Ok(Plan { grid, ..plan })
    }

    fn locate(&self, scene: &Scene, end: End, point: Point) -> Result<LatticePoint, PlanError> {
        let is_free = |at: LatticePoint| match &self.search {
            SquareSearch::Exact(exact) => exact.holds(at),
            SquareSearch::Paper { free, .. } => free.iter().any(|rect| rect.contains(at)),
        };
        ends::locate(end, point, scene, &self.arena, is_free, self.free())
    }

    /// Where the robot of a blocked `start` gets out to a place from which it reaches `goal`.
    fn exit(&self, scene: &Scene, start: Point, goal: LatticePoint) -> Option<LatticePoint> {
        let by_areas;
        let exact = match &self.search {
            SquareSearch::Exact(exact) => exact,
            // Areas are connected as cells are: both are the same floor.
            SquareSearch::Paper { .. } => {
                by_areas = Exact::new(&self.arena);
                &by_areas
            }
        };
        exit_point(start, scene, &self.arena, self.free(), |exit| exact.connects(exit, goal))
    }

    /// The rectangles in which the robot's centre may be, edges included.
    fn free(&self) -> &[LatticeRect] {
        match &self.search {
            SquareSearch::Exact(exact) => exact.free(),
            SquareSearch::Paper { free, .. } => free,
        }
    }
}

fn plan_for_disc(
    arena: &mut DiscArena,
    scene: &Scene,
    options: &PlanOptions,
    start: Point,
    goal: Point,
) -> Result<Plan, PlanError> {
    for (end, point) in [(End::Goal, goal), (End::Start, start)] {
        ends::check_within(end, point, scene.arena)?;
    }
    let way = arena
        .shortest(scene, start, goal)
        .map_err(|why| no_way(why, arena, scene, options.margin, (start, goal)))?;
    if let Err(leg) = arena.check_path(&way.waypoints, way.exits) {
        return Err(PlanError::Unsafe { from: way.waypoints[leg], to: way.waypoints[leg + 1] });
    }
    let clearance = clearance(&way.waypoints, scene);
    Ok(finished(options, Inflation::Disc, way.waypoints, clearance, way.exits))
}

/// Why nothing leads from `start` to `goal` in the arena of `scene`.
fn no_way(
    why: NoWay,
    arena: &DiscArena,
    scene: &Scene,
    margin: f64,
    (start, goal): (Point, Point),
) -> PlanError {
    let blocked = |end: End, point: Point| PlanError::Blocked {
        end,
        point,
        by: disc_blocker(arena, scene, margin, point),
        nearest: arena.nearest_free(point),
    };
    match why {
        NoWay::GoalBlocked => blocked(End::Goal, goal),
        NoWay::StartBlocked => blocked(End::Start, start),
        NoWay::Apart => PlanError::NoPath { gap: disc_gap(scene, margin, start, goal) },
    }
}

fn plan_fuzzy(
    arena: &mut FuzzyArena,
    scene: &Scene,
    options: &PlanOptions,
    start: Point,
    goal: Point,
) -> Result<Plan, PlanError> {
    for (end, point) in [(End::Goal, goal), (End::Start, start)] {
        ends::check_within(end, point, scene.arena)?;
    }
    let way = arena.plan(start, goal).map_err(|why| match why {
        NoFuzzyWay::Coarse { side } => PlanError::Coarse { side },
        NoFuzzyWay::Exact(why) => {
            let (cores, exact) = arena.exact();
            no_way(why, exact, cores, options.margin, (start, goal))
        }
    })?;
    if let Err(leg) = arena.check_path(&way.waypoints, way.exits) {
        return Err(PlanError::Unsafe { from: way.waypoints[leg], to: way.waypoints[leg + 1] });
    }
    let clearance = clearance(&way.waypoints, scene);
    let plan = finished(options, Inflation::Disc, way.waypoints, clearance, way.exits);
    Ok(Plan { fuzzy: Some(Box::new(way.stages)), ..plan })
}

/// What the disc at `point` comes too near to: the obstacle it lies deepest in, or else the border.
fn disc_blocker(arena: &DiscArena, scene: &Scene, margin: f64, point: Point) -> Blocker {
    let radius = scene.robot_radius + margin;
    let depth = |index: &usize| {
        let obstacle = &scene.obstacles[*index];
        radius + obstacle.largest_margin() - obstacle.footprint.distance(point)
    };
    let blockers = arena.blockers(point);
    match blockers.iter().max_by(|a, b| depth(a).total_cmp(&depth(b))) {
        Some(index) => Blocker::Inflated { index: *index, depth: depth(index) },
        None => {
            let (width, height) = (scene.arena.width, scene.arena.height);
            let room = point.x.min(point.y).min(width - point.x).min(height - point.y);
            Blocker::Border { depth: radius - room }
        }
    }
}

fn finished(
    options: &PlanOptions,
    inflation: Inflation,
    waypoints: Vec<Point>,
    clearance: f64,
    exits: bool,
) -> Plan {
    Plan {
        planner: options.planner,
        inflation,
        length: waypoints.windows(2).map(|leg| leg[0].distance(leg[1])).sum(),
        clearance,
        exit_leg: exits.then(|| waypoints[0].distance(waypoints[1])),
        waypoints,
        grid: None,
        fuzzy: None,
    }
}

/// The points in metres, with the given start and goal to the last bit; a start that `exits` comes
/// before the first of the points.
fn to_waypoints(points: &[LatticePoint], start: Point, goal: Point, exits: bool) -> Vec<Point> {
    let given = if exits { points } else { points.get(1..).unwrap_or_default() };
    let mut waypoints = vec![start];
    waypoints.extend(given.iter().map(|point| point.to_metres()));
    if let [_, .., last] = waypoints.as_mut_slice() {
        *last = goal;
    }
    waypoints
}
