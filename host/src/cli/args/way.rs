//! Which way is looked for, and how it is driven.

use crate::cli::quantity;
use clap::{Args, ValueEnum};
use wmr::plan::FuzzyOptions;
use wmr::scene::Goal;

/// Which way is looked for.
#[derive(Debug, Clone, Args)]
pub(crate) struct WayArgs {
    /// Where the robot stands: x,y or x,y,heading.
    #[arg(long, value_parser = quantity::place, allow_hyphen_values = true, value_name = "x,y[,deg]")]
    pub(crate) start: Option<Goal>,
    /// Where it is to go: x,y or x,y,heading.
    #[arg(long, value_parser = quantity::place, allow_hyphen_values = true, value_name = "x,y[,deg]")]
    pub(crate) goal: Option<Goal>,
    /// Radius of the disc that covers the robot [default: the input's, or 0.075].
    #[arg(long, value_parser = quantity::distance, value_name = "R")]
    pub(crate) radius: Option<f64>,
    /// Distance to keep beyond the radius [default: 0; drive: 10 mm where there is room].
    #[arg(long, value_parser = quantity::distance, value_name = "M")]
    pub(crate) margin: Option<f64>,
    /// How the way is looked for.
    #[arg(long, value_enum, default_value_t = PlannerName::Exact)]
    pub(crate) planner: PlannerName,
    /// With --planner fuzzy: how many metres of detour a metre at full risk is worth, 0 to 1000.
    #[arg(long, value_parser = quantity::risk_weight, default_value = "10", value_name = "WEIGHT")]
    pub(crate) risk: f64,
    /// With --planner fuzzy: the side of an area [default: 10 mm, more in a very large arena].
    #[arg(long, value_parser = quantity::area_side, value_name = "M")]
    pub(crate) area: Option<f64>,
    /// What makes a way good; only the exact planner looks at anything but the length.
    #[arg(long, value_enum, default_value_t = CostName::Length)]
    pub(crate) cost: CostName,
    /// The shape by which obstacles are inflated, as large as the robot's radius and margin [default: square
    /// where every obstacle is an upright rectangle, else disc].
    #[arg(long, value_enum)]
    pub(crate) inflation: Option<InflationName>,
    /// Side of a cell of a Moving AI map.
    #[arg(long, value_parser = quantity::length, default_value = "1", value_name = "M")]
    pub(crate) resolution: f64,
    /// How the time of a leg is chosen [default: as in the plan that is driven, or limits].
    #[arg(long, value_enum)]
    pub(crate) timing: Option<TimingName>,
    /// With --timing paper: how long each leg takes, seconds [default: as in the plan that is driven, or 9].
    #[arg(long, value_parser = quantity::leg_time, value_name = "SECONDS")]
    pub(crate) leg_time: Option<f64>,
    /// Never drive backwards; with --timing paper it never does.
    #[arg(long)]
    pub(crate) no_reverse: bool,
}

/// As on a command line without options.
impl Default for WayArgs {
    fn default() -> Self {
        Self {
            start: None,
            goal: None,
            radius: None,
            margin: None,
            planner: PlannerName::Exact,
            risk: FuzzyOptions::default().risk,
            area: None,
            cost: CostName::Length,
            inflation: None,
            resolution: 1.0,
            timing: None,
            leg_time: None,
            no_reverse: false,
        }
    }
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(crate) enum InflationName {
    /// Rectangles stay rectangles, as in the paper; other shapes are covered by rectangles first.
    Square,
    /// Corners become arcs, driven along tangents less than 0.5 mm outside (exact planner, shortest path).
    Disc,
}

impl From<InflationName> for wmr::plan::Inflation {
    fn from(name: InflationName) -> Self {
        match name {
            InflationName::Square => Self::Square,
            InflationName::Disc => Self::Disc,
        }
    }
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(crate) enum PlannerName {
    /// The exact shortest path among the enlarged obstacles.
    Exact,
    /// The paper's grid method: Dijkstra over areas and their entry points.
    Grid,
    /// The paper's tree of all global paths.
    Tree,
    /// The fuzzy grid: trades length for risk where edges are unsure.
    Fuzzy,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(crate) enum CostName {
    /// The shortest way.
    Length,
    /// The quickest way within the wheels' limits.
    Time,
    /// The way with the fewest turns.
    Turns,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(crate) enum TimingName {
    /// As short as the wheels' limits allow.
    Limits,
    /// Three equal intervals, as in the paper.
    Paper,
}
