//! Why there is no plan, with the numbers a person needs to change that.

use super::{AREA_LIMIT, Gap, LARGEST_RISK_WEIGHT};
use crate::geometry::{Arena, Point};
use crate::grid::GridError;
use std::fmt;

/// One end of the way.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum End {
    /// Where the robot stands.
    Start,
    /// Where it is to go.
    Goal,
}

impl fmt::Display for End {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        out.write_str(match self {
            Self::Start => "start",
            Self::Goal => "goal",
        })
    }
}

/// Why there is no plan. Lengths in metres, arena frame; obstacles by their index in the scene.
#[derive(Clone, Debug, PartialEq, thiserror::Error, miette::Diagnostic)]
pub enum PlanError {
    /// The arena cannot be prepared for planning.
    #[error(transparent)]
    #[diagnostic(transparent)]
    Grid(#[from] GridError),
    /// An end of the way is no point of the arena.
    #[error("the {end} ({:.4}, {:.4}) m lies outside the arena of {} × {} m", .point.x, .point.y, .arena.width, .arena.height)]
    #[diagnostic(help("choose a point inside{}", meant(.point, .arena)))]
    Outside {
        /// Which end.
        end: End,
        /// Where it is.
        point: Point,
        /// The floor's size.
        arena: Arena,
    },
    /// The robot cannot stand at an end of the way: it would touch an obstacle or the border.
    #[error("{}", blocked_text(.end, .point, .by))]
    #[diagnostic(help("{}", beside(.nearest)))]
    Blocked {
        /// Which end.
        end: End,
        /// Where it is.
        point: Point,
        /// What the robot would touch.
        by: Blocker,
        /// The nearest point where the robot can stand, if there is any.
        nearest: Option<Point>,
    },
    /// No way leads from start to goal.
    #[error("no way leads from the start to the goal: {}", no_path_text(.gap))]
    #[diagnostic(help("{}", cure(.gap)))]
    NoPath {
        /// The widest gap that the robot would have to pass, if there is one at all.
        gap: Option<Gap>,
    },
    /// Inflation by a disc was asked for together with something that only knows squares.
    #[error(
        "inflation by a disc goes with the exact planner and the shortest path alone, or with the fuzzy planner"
    )]
    #[diagnostic(help("choose these, or --inflation square"))]
    DiscNeedsExact,
    /// The fuzzy planner was asked for together with something that it does not know.
    #[error("the fuzzy planner inflates obstacles by a disc and weighs length against risk")]
    #[diagnostic(help("leave out --inflation and --cost, or choose --planner exact"))]
    FuzzyAlone,
    /// The weight of risk is no number that one can plan with.
    #[error("a risk weight of {weight} is not possible")]
    #[diagnostic(help("give --risk 0 to {LARGEST_RISK_WEIGHT}"))]
    RiskWeight {
        /// What was given.
        weight: f64,
    },
    /// The fuzzy grid would have too many areas, or none.
    #[error("areas of {} mm would be {columns} × {rows} of them, and {AREA_LIMIT} are possible", .side * 1000.0)]
    #[diagnostic(help("give a larger --area"))]
    Areas {
        /// The side of an area, metres.
        side: f64,
        /// How many side by side.
        columns: usize,
        /// How many one upon the other.
        rows: usize,
    },
    /// There is a way, but the areas of the fuzzy grid are too coarse to find it.
    #[error("a way leads to the goal, but areas of {:.2} mm are too coarse for its gaps", .side * 1000.0)]
    #[diagnostic(help("give a smaller --area, or --planner exact"))]
    Coarse {
        /// The side of the smallest areas tried, metres.
        side: f64,
    },
    /// The independent test refused the path that the planner found.
    #[error("the path found fails the safety test between ({:.4}, {:.4}) and ({:.4}, {:.4}) m", .from.x, .from.y, .to.x, .to.y)]
    #[diagnostic(help("this is a bug of the planner, nothing was planned"))]
    Unsafe {
        /// Where the refused leg begins.
        from: Point,
        /// Where it ends.
        to: Point,
    },
}

/// What keeps the robot from standing somewhere.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Blocker {
    /// An obstacle grown by radius and margin.
    Obstacle {
        /// Its index in the scene.
        index: usize,
        /// How deep inside, along x and y, metres.
        depth: [f64; 2],
    },
    /// An obstacle inflated by a disc as large as radius and margin.
    Inflated {
        /// Its index in the scene.
        index: usize,
        /// By how much the point is too near to it, metres.
        depth: f64,
    },
    /// The arena's border.
    Border {
        /// By how much the point is too near, metres.
        depth: f64,
    },
    /// Two obstacles, or an obstacle and the border, that leave no gap at this point.
    Gap,
}

impl PlanError {
    /// The same error with its points given in another frame, in which the arena's lower left corner
    /// lies at `origin`, metres.
    #[must_use]
    pub fn seen_from(mut self, origin: Point) -> Self {
        let moved = |at: &mut Point| *at = Point::new(at.x + origin.x, at.y + origin.y);
        match &mut self {
            Self::Outside { point, .. } => moved(point),
            Self::Blocked { point, nearest, .. } => {
                moved(point);
                nearest.iter_mut().for_each(moved);
            }
            Self::Unsafe { from, to } => {
                moved(from);
                moved(to);
            }
            Self::Grid(_)
            | Self::NoPath { .. }
            | Self::DiscNeedsExact
            | Self::FuzzyAlone
            | Self::RiskWeight { .. }
            | Self::Areas { .. }
            | Self::Coarse { .. } => {}
        }
        self
    }

    /// A short name of the kind of error, for programs.
    ///
    /// ```
    /// assert_eq!(wmr::plan::PlanError::NoPath { gap: None }.code(), "no_path");
    /// ```
    pub fn code(&self) -> &'static str {
        match self {
            Self::Grid(GridError::TooManyAreas { .. }) => "too_many_areas",
            Self::Grid(_) => "bad_arena",
            Self::Outside { end: End::Start, .. } => "start_outside",
            Self::Outside { end: End::Goal, .. } => "goal_outside",
            Self::Blocked { end: End::Start, .. } => "start_blocked",
            Self::Blocked { end: End::Goal, .. } => "goal_blocked",
            Self::NoPath { .. } => "no_path",
            Self::DiscNeedsExact => "disc_needs_exact",
            Self::FuzzyAlone => "fuzzy_alone",
            Self::RiskWeight { .. } => "bad_risk_weight",
            Self::Areas { .. } => "bad_area",
            Self::Coarse { .. } => "areas_too_coarse",
            Self::Unsafe { .. } => "unsafe_path",
        }
    }
}

/// What was perhaps meant by a point that would lie inside in centimetres or millimetres.
fn meant(point: &Point, arena: &Arena) -> String {
    let inside = |at: f64, size: f64| (0.0..=size).contains(&at);
    let units = [("cm", 100.0), ("mm", 1000.0)];
    let fits = |(_, per_metre): &(&str, f64)| {
        inside(point.x / per_metre, arena.width) && inside(point.y / per_metre, arena.height)
    };
    // So near to the corner nobody meant another unit.
    let is_far = point.x.max(point.y) > 2.0 * arena.width.max(arena.height);
    units.into_iter().filter(|_| is_far).find(fits).map_or(String::new(), |(unit, _)| {
        format!("; did you mean {}{unit},{}{unit}?", point.x, point.y)
    })
}

fn blocked_text(end: &End, point: &Point, by: &Blocker) -> String {
    let why = match by {
        Blocker::Obstacle { index, depth: [x, y] } => format!(
            "lies {:.1} by {:.1} cm inside obstacle {} grown by the robot's radius and margin",
            x * 100.0,
            y * 100.0,
            index + 1
        ),
        Blocker::Inflated { index, depth } => format!(
            "is {:.1} cm too near to obstacle {} for the robot's radius and margin",
            depth * 100.0,
            index + 1
        ),
        Blocker::Border { depth } => {
            format!("is {:.1} cm too near to the arena's border for the robot", depth * 100.0)
        }
        Blocker::Gap => "lies in a gap that leaves the robot no room".to_owned(),
    };
    format!("the {end} ({:.4}, {:.4}) m {why}", point.x, point.y)
}

fn beside(nearest: &Option<Point>) -> String {
    match nearest {
        Some(free) => format!("the nearest free point is ({:.4}, {:.4})", free.x, free.y),
        None => "no point of the arena is free".to_owned(),
    }
}

fn no_path_text(gap: &Option<Gap>) -> String {
    match gap {
        Some(gap) => format!(
            "the best way through is a gap of {:.1} cm between {} and {}, the robot with its margin \
             needs {:.1} cm",
            gap.width * 100.0,
            gap.between[0],
            gap.between[1],
            gap.need * 100.0
        ),
        None => "obstacles that touch each other or the border shut it off".to_owned(),
    }
}

fn cure(gap: &Option<Gap>) -> &'static str {
    match gap {
        Some(_) => "widen the gap, or give a smaller radius or margin",
        None => "move one of them",
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_point_in_another_unit_is_recognised() {
        let arena = Arena { width: 1.6, height: 2.0 };
        let of = |x, y| meant(&Point::new(x, y), &arena);
        assert_eq!(of(140.0, 175.0), "; did you mean 140cm,175cm?");
        assert_eq!(of(1400.0, 1750.0), "; did you mean 1400mm,1750mm?");
        assert_eq!([of(1.7, 0.5), of(-140.0, 175.0), of(9000.0, 1.0)], ["", "", ""]);
    }
}
