//! Where ways over time are looked for: what stands, what is asked, and whether a leg is free.

use super::plan::DynamicPlan;
use super::search::Search;
use super::{Demand, Future, LegMotion};
use crate::geometry::{Point, Pose};
use crate::legs::LegOptions;
use crate::scene::{Goal, Scene};
use crate::shape::Shape;
use protocol::motion::Limits;

/// The step of time in which legs are tried near what is forbidden, s; the longest where there is risk, and where
/// there is none.
const STEP: f64 = 0.02;
const RISK_STEP: f64 = 0.1;
const LONG_STEP: f64 = 1.0;
/// A leg along something that stands comes no nearer if by less than this, m.
const NEARER: f64 = 0.001;
/// The planner's places lie on a lattice of this, m.
const LATTICE: f64 = 2e-4;

/// What stands, and what is asked of the way.
#[derive(Clone, Debug)]
pub struct DynamicArena<'a> {
    pub(super) scene: &'a Scene,
    pub(super) limits: Limits,
    pub(super) options: LegOptions,
    pub(super) demand: Demand,
    /// What stands, and how much more is to be kept from it, m.
    standing: Vec<(Shape, f64)>,
}

/// From where to where, and when.
#[derive(Clone, Copy, Debug)]
pub struct Quest<'a> {
    /// Where the robot rests.
    pub from: Pose,
    /// When it may begin, s from the moment of the predictions.
    pub start: f64,
    /// Where to.
    pub goal: Goal,
    /// Ways that cost as much are of no use, s.
    pub within: f64,
    /// Places on the way among what stands, if one is known: corners that no cell lies near.
    pub way: &'a [Point],
    /// What moves.
    pub futures: &'a [Future],
}

impl<'a> DynamicArena<'a> {
    /// The arena of `scene`, whose obstacles stand, for a robot that drives legs of this kind.
    pub fn new(scene: &'a Scene, limits: Limits, options: LegOptions, demand: Demand) -> Self {
        let standing = scene.obstacles.iter().map(|obstacle| match obstacle.footprint.as_rect() {
            Some(rect) => (rect.widened(obstacle.margin).into(), 0.0),
            None => {
                let margin = obstacle.margin.iter().copied().fold(0.0, f64::max);
                (obstacle.footprint.clone(), margin)
            }
        });
        Self { scene, limits, options, demand, standing: standing.collect() }
    }

    /// The way that reaches the goal soonest.
    pub fn plan(&self, quest: &Quest) -> DynamicPlan {
        Search::new(self, quest).run()
    }

    /// Whether what stands leaves a straight way; a robot too near to something may leave it.
    pub(super) fn is_clear(&self, a: Point, b: Point) -> bool {
        let keep = self.demand.keep - LATTICE;
        let arena = self.scene.arena;
        let off = |at: f64, size: f64| at.min(size - at);
        let inside = |at: Point| off(at.x, arena.width).min(off(at.y, arena.height));
        inside(b) >= keep.min(inside(a))
            && self.standing.iter().all(|(shape, margin)| {
                let need = (keep + margin).min(shape.distance(a) - NEARER);
                shape.leg_distance(a, b) >= need
            })
    }

    /// The integral of the risk on a leg, s; when and with what it meets, if it does. Nothing comes nearer to the
    /// robot than at the `fastest`, m/s.
    pub(super) fn risk_of(
        &self,
        motion: &LegMotion,
        (quest, fastest): (&Quest, f64),
        begins: f64,
    ) -> Result<f64, (f64, usize)> {
        let length = motion.times()[2];
        let (mut time, mut risk) = (0.0, 0.0);
        loop {
            let place = motion.position(time);
            let band = self.demand.at(quest.futures, place, begins + time);
            if let Some(nearest) = band.nearest.filter(|_| band.gap < 0.0) {
                return Err((begins + time, nearest));
            }
            if time >= length {
                return Ok(risk);
            }
            let (free, longest) =
                if band.risk > 0.0 { (band.gap, RISK_STEP) } else { (band.slack, LONG_STEP) };
            let step = (free / fastest).clamp(STEP, longest).min(length - time);
            risk += band.risk * step;
            time += step;
        }
    }
}
