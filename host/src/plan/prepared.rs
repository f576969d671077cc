//! An arena prepared once for many queries.

use super::clearance::clearance_by;
use super::cost::best_way;
use super::exact::Exact;
use super::exit::exit_point;
use super::gap::narrowest_gap;
use super::paper::grid_stages;
use super::round::Round;
use super::{Cost, End, Inflation, LegTest, Plan, PlanError, PlanOptions, Planner, ends};
use crate::geometry::Point;
use crate::grid::{EnlargedArena, LatticePoint, LatticeRect, MiniMatrix, UNITS_PER_METRE, enlarge};
use crate::scene::Scene;

/// A radius this close to a whole unit, in units, is meant to be whole.
const MEANT_WHOLE: f64 = 1e-6;

/// A scene made ready for planning with one set of options.
#[derive(Clone, Debug)]
pub struct PreparedArena<'a> {
    scene: &'a Scene,
    options: &'a PlanOptions,
    arena: EnlargedArena,
    test: LegTest,
    method: Method,
    was_asked: bool,
}

/// What the planner searches.
#[derive(Clone, Debug)]
enum Method {
    Exact(Box<Exact>),
    /// The exact one for square inflation stands by: the length of its path is a bound.
    Round {
        exact: Box<Exact>,
        round: Box<Round>,
    },
    Paper {
        matrix: Box<MiniMatrix>,
        free: Vec<LatticeRect>,
    },
}

impl<'a> PreparedArena<'a> {
    /// Prepares `scene`: grows its obstacles and cuts the floor into cells or areas.
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
        let arena = enlarge(scene, &options.margin)?;
        let is_round = options.inflation == Inflation::Disc;
        if is_round && (options.planner != Planner::Exact || options.cost != Cost::Length) {
            return Err(PlanError::RoundNeedsExact);
        }
        let method = match options.planner {
            Planner::Exact if is_round => {
                let radius = scene.robot_radius + options.margin.uniform;
                // Rounded down: the boxes were rounded outwards by what is missing.
                let radius = (radius * UNITS_PER_METRE + MEANT_WHOLE).floor() as i32;
                let round = Box::new(Round::new(&arena, radius));
                Method::Round { exact: Box::new(Exact::new(&arena)), round }
            }
            Planner::Exact => Method::Exact(Box::new(Exact::new(&arena))),
            Planner::Grid | Planner::Tree => {
                let matrix = Box::new(MiniMatrix::from_borders(&arena)?);
                let live = matrix.areas().filter(|&area| matrix.is_live(area));
                Method::Paper { free: live.map(|area| matrix.rect(area)).collect(), matrix }
            }
        };
        let test = LegTest::new(&arena);
        Ok(Self { scene, options, arena, test, method, was_asked: false })
    }

    /// Plans the way from `start` to `goal`.
    ///
    /// # Errors
    /// [`PlanError`] if an end is outside or blocked, or nothing leads from one to the other.
    pub fn plan(&mut self, start: Point, goal: Point) -> Result<Plan, PlanError> {
        if let Method::Exact(exact) | Method::Round { exact, .. } = &mut self.method {
            if self.was_asked {
                exact.expect_many(self.arena.inside);
            }
            self.was_asked = true;
        }
        let to = self.locate(End::Goal, goal)?;
        let (from, exits) = match self.locate(End::Start, start) {
            Ok(at) => (at, false),
            Err(blocked @ PlanError::Blocked { .. }) => {
                (self.exit(start, to).ok_or(blocked)?, true)
            }
            Err(error) => return Err(error),
        };
        let no_path =
            || PlanError::NoPath { gap: narrowest_gap(self.scene, &self.options.margin, from, to) };
        let (points, grid) = match &mut self.method {
            Method::Exact(exact) => {
                let shortest = exact.shortest(from, to).ok_or_else(no_path)?;
                (best_way(self.options.cost, &self.arena, &self.test, shortest), None)
            }
            Method::Round { exact, round } => {
                let square = match exact.holds(from) && exact.holds(to) {
                    true => exact.shortest(from, to),
                    false => None,
                };
                (round.shortest(from, to, square).ok_or_else(no_path)?, None)
            }
            Method::Paper { matrix, .. } => {
                let grows_tree = self.options.planner == Planner::Tree;
                let stages = grid_stages(&self.arena, &self.test, matrix, (from, to), grows_tree);
                let stages = stages.ok_or_else(no_path)?;
                (stages.kept.clone(), Some(stages))
            }
        };
        let waypoints = to_waypoints(&points, start, goal, exits);
        let checked = match &self.method {
            Method::Round { round, .. } => round.check_path(&points),
            _ => self.test.check_path(&points),
        };
        if let Err(leg) = checked {
            let leg = leg + usize::from(exits);
            return Err(PlanError::Unsafe { from: waypoints[leg], to: waypoints[leg + 1] });
        }
        Ok(Plan {
            planner: self.options.planner,
            length: waypoints.windows(2).map(|leg| leg[0].distance(leg[1])).sum(),
            clearance: clearance_by(self.test.index(), &waypoints, self.scene),
            exit_leg: exits.then(|| waypoints[0].distance(waypoints[1])),
            waypoints,
            grid,
        })
    }

    fn locate(&self, end: End, point: Point) -> Result<LatticePoint, PlanError> {
        let is_free = |at: LatticePoint| match &self.method {
            Method::Exact(exact) => exact.holds(at),
            Method::Round { round, .. } => round.holds(at),
            Method::Paper { free, .. } => free.iter().any(|rect| rect.contains(at)),
        };
        ends::locate(end, point, self.scene, &self.arena, is_free, self.free())
    }

    /// Where the robot of a blocked `start` gets out to a place from which it reaches `goal`.
    fn exit(&self, start: Point, goal: LatticePoint) -> Option<LatticePoint> {
        let by_areas;
        let exact = match &self.method {
            Method::Exact(exact) | Method::Round { exact, .. } => exact.as_ref(),
            // Areas are connected as cells are: both are the same floor.
            Method::Paper { .. } => {
                by_areas = Exact::new(&self.arena);
                &by_areas
            }
        };
        let exit = |leads_on: &dyn Fn(LatticePoint) -> bool| {
            exit_point(start, self.scene, &self.arena, self.free(), leads_on)
        };
        let connected = exit(&|exit| exact.connects(exit, goal));
        // A disc may pass where squares do not.
        let is_round = matches!(self.method, Method::Round { .. });
        connected.or_else(|| exit(&|_| true).filter(|_| is_round))
    }

    /// The rectangles in which the robot's centre may be, edges included.
    fn free(&self) -> &[LatticeRect] {
        match &self.method {
            Method::Exact(exact) | Method::Round { exact, .. } => exact.free(),
            Method::Paper { free, .. } => free,
        }
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
