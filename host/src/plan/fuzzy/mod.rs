//! The fuzzy grid: a way that trades length for risk among obstacles whose edges are not sure
//! [Alghannam, Sec. VI].
//!
//! ```text
//! shapes ─► risk of ─► membership ─► fast ─────► way down ─► taut, on the ─► distance test ─► points
//! margins   a place    of areas      marching    the costs   true shapes     on the shapes
//! ```
//! The paper leaves open how areas with a membership between free and blocked are planned through. Here
//! the way has the least integral of 1 + w r along it, with the risk r = 1 - membership and a weight w:
//! additive, so that the best way's parts are best ways. Where no edge is unsure that is the length, and
//! the way becomes the exact planner's. The areas only decide on which sides obstacles are passed; where
//! the way runs is then decided on the shapes themselves.
//!
//! If the areas are too coarse for a gap they are halved a few times; where the way leads through risk,
//! areas of half the side have a say. Metres.

mod march;
mod membership;
mod risk;
mod soft;
mod tighten;
mod weights;

pub use membership::{AREA_LIMIT, FuzzyArea, MembershipGrid};

use super::PlanError;
use super::disc::{DiscArena, NoWay};
use crate::geometry::{Arena, Point};
use crate::scene::{Obstacle, Scene};
use march::{Quest, march};
use risk::RiskField;
use std::collections::BTreeMap;
use tighten::tighten;
use weights::FuzzyWay;

/// How many times areas are halved to find a way through gaps.
const HALVINGS: usize = 3;

/// The side of an area where nobody asks for another, metres.
pub const DEFAULT_AREA: f64 = 0.01;

/// Where nobody asks, areas are made larger so that there are no more of them than this.
const COMFORTABLE: f64 = 500_000.0;

/// A way with no more risk than this may only graze a band, because it has few corners: one that keeps
/// clear of it is looked for, too.
const GRAZING: f64 = 0.1;

/// What it may cost more to keep clear of a band that is only grazed, as a part of the cost.
const GRAZED: f64 = 5e-4;

/// The largest weight of risk.
pub const LARGEST_RISK_WEIGHT: f64 = 1000.0;

/// What the fuzzy planner plans with.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FuzzyOptions {
    /// How many metres of detour a metre at full risk is worth, 0 to [`LARGEST_RISK_WEIGHT`].
    pub risk: f64,
    /// The side of an area, metres; `None` for [`DEFAULT_AREA`], or more in a very large arena.
    pub area: Option<f64>,
}

impl Default for FuzzyOptions {
    fn default() -> Self {
        Self { risk: 10.0, area: None }
    }
}

impl FuzzyOptions {
    /// The side of an area in `arena`, metres.
    pub fn area_in(&self, arena: Arena) -> f64 {
        let comfortable = (arena.width * arena.height / COMFORTABLE).sqrt();
        self.area.unwrap_or(DEFAULT_AREA.max(comfortable))
    }
}

/// What the fuzzy planner saw.
#[derive(Clone, Debug, PartialEq)]
pub struct FuzzyStages {
    /// The membership of every area.
    pub grid: MembershipGrid,
    /// The weight of risk.
    pub weight: f64,
    /// The length plus the weight times the integral of the risk, metres.
    pub cost: f64,
    /// The greatest risk on the way, 0 to 1.
    pub greatest_risk: f64,
}

/// A scene made ready for the fuzzy planner.
#[derive(Clone, Debug)]
pub(super) struct FuzzyArena {
    /// The scene with its cores alone: obstacles without margins.
    cores: Scene,
    field: RiskField,
    /// By how often areas were halved.
    grids: Vec<MembershipGrid>,
    side: f64,
    weight: f64,
    /// The cores for the exact planner: it tests ways, and says what is wrong where none is found.
    exact: DiscArena,
}

/// A way with what the planner saw.
#[derive(Clone, Debug)]
pub(super) struct FuzzyPlan {
    pub(super) waypoints: Vec<Point>,
    pub(super) exits: bool,
    pub(super) stages: FuzzyStages,
}

/// Why there is no way.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum NoFuzzyWay {
    /// As for the exact planner.
    Exact(NoWay),
    /// There is a way, but not along areas of this size.
    Coarse {
        /// The side of the smallest areas tried, metres.
        side: f64,
    },
}

impl FuzzyArena {
    /// `scene` for its robot, which keeps `margin` metres more from everything.
    ///
    /// # Errors
    /// [`PlanError::Grid`] as for the exact planner, [`PlanError::RiskWeight`] and [`PlanError::Areas`].
    pub(super) fn new(
        scene: &Scene,
        margin: f64,
        options: FuzzyOptions,
    ) -> Result<Self, PlanError> {
        let FuzzyOptions { risk: weight, .. } = options;
        if !(0.0..=LARGEST_RISK_WEIGHT).contains(&weight) {
            return Err(PlanError::RiskWeight { weight });
        }
        let core = |obstacle: &Obstacle| Obstacle { margin: [0.0; 4], ..obstacle.clone() };
        let cores =
            Scene { obstacles: scene.obstacles.iter().map(core).collect(), ..scene.clone() };
        let exact = DiscArena::new(&cores, margin)?;
        let side = options.area_in(scene.arena);
        let field = RiskField::new(scene, margin);
        let first = grid_of(&field, scene.arena, side)?;
        Ok(Self { cores, field, grids: vec![first], side, weight, exact })
    }

    /// The cores as a scene, and the exact planner for them.
    pub(super) fn exact(&self) -> (&Scene, &DiscArena) {
        (&self.cores, &self.exact)
    }

    /// The way from `start` to `goal`, which are its first and last point to the last bit.
    ///
    /// A robot that stands in a core is led out of it first, as by the exact planner.
    ///
    /// # Errors
    /// [`NoFuzzyWay`].
    pub(super) fn plan(&mut self, start: Point, goal: Point) -> Result<FuzzyPlan, NoFuzzyWay> {
        let (from, exits) =
            self.exact.beginning(&self.cores, start, goal).map_err(NoFuzzyWay::Exact)?;
        let way = self.way(from, goal)?;
        let mut waypoints = way.points;
        if exits {
            waypoints.insert(0, start);
        }
        let stages = FuzzyStages {
            grid: self.grids[0].clone(),
            weight: self.weight,
            cost: way.length + self.weight * way.integral,
            greatest_risk: way.greatest,
        };
        Ok(FuzzyPlan { waypoints, exits, stages })
    }

    /// Whether the way over `waypoints` is free, by the shapes alone.
    ///
    /// # Errors
    /// The index of the refused leg.
    pub(super) fn check_path(&self, waypoints: &[Point], exits: bool) -> Result<(), usize> {
        self.exact.check_path(waypoints, exits)
    }

    fn way(&mut self, start: Point, goal: Point) -> Result<FuzzyWay, NoFuzzyWay> {
        let weight = self.weight;
        let unavoidable = self.field.at(start).max(self.field.at(goal));
        let mut found: BTreeMap<[u64; 2], FuzzyWay> = BTreeMap::new();
        let mut find = |weight: f64, ceiling: f64| {
            let key = [weight.to_bits(), ceiling.to_bits()];
            if let Some(way) = found.get(&key) {
                return Ok(way.clone());
            }
            let mut way = self.find(start, goal, weight, ceiling)?;
            if way.greatest > unavoidable && way.greatest <= GRAZING {
                let clear = self.find(start, goal, weight, unavoidable);
                let is_as_good =
                    |clear: &FuzzyWay| clear.cost(weight) <= way.cost(weight) * (1.0 + GRAZED);
                way = clear.ok().filter(is_as_good).unwrap_or(way);
            }
            found.insert(key, way.clone());
            Ok(way)
        };
        weights::for_weight(weight, unavoidable, &mut find)
    }

    /// The way with the least cost; areas are halved until there is one, if there is any.
    fn find(
        &mut self,
        start: Point,
        goal: Point,
        weight: f64,
        ceiling: f64,
    ) -> Result<FuzzyWay, NoFuzzyWay> {
        for halvings in 0..=HALVINGS {
            if self.grids.len() == halvings {
                if halvings == 1 && !self.exact.connects(start, goal) {
                    return Err(NoFuzzyWay::Exact(NoWay::Apart));
                }
                let side = self.side / f64::from(1 << halvings);
                match grid_of(&self.field, self.cores.arena, side) {
                    Ok(grid) => self.grids.push(grid),
                    Err(_) => break,
                }
            }
            let grid = &self.grids[halvings];
            let quest = Quest { field: &self.field, grid, start, goal, weight, ceiling };
            if let Some(points) = on_grid(&quest) {
                let way = judged(&quest, points);
                let is_sure = way.integral == 0.0 || halvings == HALVINGS;
                return Ok(if is_sure {
                    way
                } else {
                    self.finer(way, (start, goal), halvings + 1, (weight, ceiling))
                });
            }
            // Below a ceiling there is a way already, that of a smaller weight.
            if ceiling.is_finite() {
                break;
            }
        }
        if !self.exact.connects(start, goal) {
            return Err(NoFuzzyWay::Exact(NoWay::Apart));
        }
        let side = self.grids.last().map_or(self.side, MembershipGrid::side);
        Err(NoFuzzyWay::Coarse { side })
    }
}

impl FuzzyArena {
    /// `way`, or a cheaper one that areas of half the side show: where a way leads through risk, the risk
    /// of whole areas may mislead it.
    fn finer(
        &mut self,
        way: FuzzyWay,
        (start, goal): (Point, Point),
        halvings: usize,
        (weight, ceiling): (f64, f64),
    ) -> FuzzyWay {
        if self.grids.len() == halvings {
            let side = self.side / f64::from(1 << halvings);
            match grid_of(&self.field, self.cores.arena, side) {
                Ok(grid) => self.grids.push(grid),
                Err(_) => return way,
            }
        }
        let grid = &self.grids[halvings];
        let quest = Quest { field: &self.field, grid, start, goal, weight, ceiling };
        match on_grid(&quest).map(|points| judged(&quest, points)) {
            Some(finer) if finer.cost(weight) < way.cost(weight) => finer,
            _ => way,
        }
    }
}

/// The grid with areas of `side` metres.
fn grid_of(field: &RiskField, arena: Arena, side: f64) -> Result<MembershipGrid, PlanError> {
    let (columns, rows) = MembershipGrid::size(arena, side);
    let is_possible = side > 0.0 && columns.saturating_mul(rows) <= AREA_LIMIT;
    if !is_possible {
        return Err(PlanError::Areas { side, columns, rows });
    }
    Ok(MembershipGrid::new(field, arena, side))
}

/// The taut way found by the areas, start first; `None` if they lead nowhere.
fn on_grid(quest: &Quest) -> Option<Vec<Point>> {
    if quest.start == quest.goal {
        return Some(vec![quest.start]);
    }
    let arrival = march(*quest)?;
    let taut = |way: Option<Vec<Point>>| {
        let mut way = way?;
        way.push(quest.start);
        way.reverse();
        tighten(quest, &way)
    };
    taut(arrival.way_back(quest)).or_else(|| taut(arrival.steps_back(quest)))
}

/// A way with its length and its risk.
fn judged(quest: &Quest, points: Vec<Point>) -> FuzzyWay {
    let (mut integral, mut greatest) = (0.0, 0.0_f64);
    for leg in points.windows(2) {
        let is_end = leg.iter().any(|&at| at == quest.start || at == quest.goal);
        // Every leg of a taut way can be driven.
        let risk = quest.field.leg(leg[0], leg[1], f64::INFINITY, is_end).unwrap_or_default();
        integral += risk.integral;
        greatest = greatest.max(risk.greatest);
    }
    let length = points.windows(2).map(|leg| leg[0].distance(leg[1])).sum();
    FuzzyWay { points, length, integral, greatest }
}
