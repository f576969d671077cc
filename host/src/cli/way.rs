//! From an input to a way through its arena: ends, margins, planner, legs.

use super::args::{CostName, PlannerName, TimingName, WayArgs};
use super::error::{CliError, Exit};
use super::input::Input;
use super::output::Output;
use protocol::motion::{Leg, Limits, Timing};
use protocol::units::Seconds;
use std::time::{Duration, Instant};
use wmr::geometry::{Point, Pose};
use wmr::legs::{DEFAULT_LIMITS, LegOptions, duration, paper_timing};
use wmr::plan::{
    Cost, DRIVE_MARGINS, FuzzyOptions, MarginPlan, Plan, PlanOptions, Planner, with_margin_fallback,
};
use wmr::plan_file::{MadeFor, PlanFile, PlanTiming};
use wmr::scene::{Goal, Scene};

/// A way, and all that led to it.
#[derive(Clone, Debug)]
pub(crate) struct PlannedWay {
    pub(crate) file: PlanFile,
    /// `None` if the way was read from a file.
    pub(crate) plan: Option<Plan>,
    /// What it was planned with.
    pub(crate) options: PlanOptions,
    /// How its legs are made.
    pub(crate) legs: LegOptions,
}

/// Which margins may be used beyond the radius.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum MarginRule {
    /// None, unless asked for.
    AsAsked,
    /// 10 mm where there is room, unless asked for.
    ForDriving,
}

/// Plans the way that `args` ask for in `input`.
///
/// A plan is taken as it is, unless another start, goal, radius or more margin is asked for.
pub(crate) fn find(
    input: &Input,
    args: &WayArgs,
    rule: MarginRule,
    output: Output,
) -> Result<PlannedWay, CliError> {
    let planner = planner(args.planner);
    match input {
        Input::Plan(file) if asks_nothing_else(args) && keeps_margin(file, args, rule) => {
            let legs = leg_options(&as_made(args, file.made_for));
            let options = PlanOptions::default();
            Ok(PlannedWay { file: (**file).clone(), plan: None, options, legs })
        }
        Input::Plan(file) => {
            output.say(if asks_nothing_else(args) {
                "the plan keeps less than the margin for driving, so its way is planned again; --margin 0 drives it as it is"
            } else {
                "the plan is for another start, goal or radius, so its way is planned again"
            });
            let heading = file.goal_heading();
            let goal = file.waypoints.last().map(|position| Goal { position: *position, heading });
            let start = file
                .waypoints
                .first()
                .map(|&position| Pose { position, heading: file.start_heading() });
            let scene = Scene { start, goal, ..file.scene.clone() };
            let args = as_made(args, file.made_for);
            plan_way(&with_radius(&scene, args.radius), planner, &args, rule, output)
        }
        Input::Scene(scene) => {
            plan_way(&with_radius(scene, args.radius), planner, args, rule, output)
        }
        Input::Photo(seen) => plan_way(&seen.scene(args.radius), planner, args, rule, output),
    }
}

/// Whether a plan's own ends and radius are wanted.
fn asks_nothing_else(args: &WayArgs) -> bool {
    args.start.is_none() && args.goal.is_none() && args.radius.is_none()
}

/// Half a lattice step more or less is the same margin, metres.
const MARGIN_TOLERANCE: f64 = 1e-4;

fn keeps_margin(file: &PlanFile, args: &WayArgs, rule: MarginRule) -> bool {
    let wanted = args.margin.unwrap_or(match rule {
        MarginRule::AsAsked => 0.0,
        MarginRule::ForDriving => DRIVE_MARGINS[0],
    });
    file.clearance + MARGIN_TOLERANCE >= file.scene.robot_radius + wanted
}

/// Plans in `scene`, whose obstacles may lie further out by their `margins`, metres.
pub(crate) fn plan_way(
    scene: &Scene,
    planner: Planner,
    args: &WayArgs,
    rule: MarginRule,
    output: Output,
) -> Result<PlannedWay, CliError> {
    let (start, goal) = ends(scene, args)?;
    let scene = Scene { start: Some(start), goal: Some(goal), ..scene.clone() };
    let tried: &[f64] = match (args.margin, rule) {
        (Some(asked), _) => &[asked],
        (None, MarginRule::AsAsked) => &[0.0],
        (None, MarginRule::ForDriving) => &DRIVE_MARGINS,
    };
    let options = |margin| plan_options(args, planner, margin);
    let began = Instant::now();
    let MarginPlan { plan, margin, preparing, searching } =
        with_margin_fallback(&scene, start.position, goal.position, tried, &options(0.0), || {
            began.elapsed()
        })
        .map_err(|error| error.seen_from(origin(&scene)))?;
    let microseconds = |time: Duration| time.as_secs_f64() * 1e6;
    let timing = PlanTiming { build: microseconds(preparing), query: microseconds(searching) };
    if tried.first() != Some(&margin) {
        output.say(&format!(
            "there is no room for a margin of 10 mm; keeping {:.0} mm",
            margin * 1000.0
        ));
    }
    if let Some(length) = plan.exit_leg {
        output.say(&format!(
            "the robot stands too near to something; its first {:.0} mm only lead away from it",
            length * 1000.0
        ));
    }
    if let Some(cut) =
        plan.grid.as_ref().and_then(|stages| stages.tree.as_ref()).map(|tree| tree.cut)
        && cut > 0
    {
        output.say(&format!(
            "the tree of global paths was bounded: {cut} branches were not followed to their end"
        ));
    }
    let plan = with_grid(plan, &scene, (start, goal), options(margin));
    let legs = leg_options(args);
    let file = PlanFile::new(&plan, &scene, MadeFor::new(&legs, &DEFAULT_LIMITS), timing);
    Ok(PlannedWay { file, plan: Some(plan), options: options(margin), legs })
}

/// What `args` ask the planner for.
pub(crate) fn plan_options(args: &WayArgs, planner: Planner, margin: f64) -> PlanOptions {
    PlanOptions {
        planner,
        margin,
        cost: cost(args.cost),
        inflation: args.inflation.map(Into::into),
        fuzzy: FuzzyOptions { risk: args.risk, area: args.area },
    }
}

/// In an arena of so few obstacles the grid method takes no time worth mentioning.
const FEW_OBSTACLES: usize = 60;

/// The exact planner needs no mini-matrix; people and pictures like one all the same.
fn with_grid(plan: Plan, scene: &Scene, (start, goal): (Pose, Goal), options: PlanOptions) -> Plan {
    if plan.grid.is_some() || plan.fuzzy.is_some() || scene.obstacles.len() > FEW_OBSTACLES {
        return plan;
    }
    let options =
        PlanOptions { planner: Planner::Grid, margin: options.margin, ..PlanOptions::default() };
    let grid = wmr::plan::plan(scene, start.position, goal.position, &options);
    Plan { grid: grid.ok().and_then(|plan| plan.grid), ..plan }
}

impl PlannedWay {
    /// The legs that a robot with `limits` drives: those of the plan; if others are needed, that is said.
    pub(crate) fn legs_for(&self, limits: &Limits, output: Output) -> Vec<Leg> {
        let legs = self.file.legs_for(&self.legs, limits);
        if self.file.planned_legs().as_ref() != Some(&legs)
            || duration(&legs, limits) != self.file.duration
        {
            let (now, then) = (MadeFor::new(&self.legs, limits), self.file.duration);
            let made_for = match self.file.made_for {
                Some(made_for) => format!("were made for {made_for}"),
                None => "were made for limits that its file does not name".to_owned(),
            };
            output.say(&format!(
                "the plan's legs {made_for}; for {now} they are made again: {:.2} s, not {then:.2} s",
                duration(&legs, limits)
            ));
        }
        legs
    }
}

/// How long a leg takes by the paper's timing, if nobody says, seconds [Alghannam, Sec. V].
const PAPER_LEG_TIME: f64 = 9.0;

/// How legs are made, as `args` ask.
pub(crate) fn leg_options(args: &WayArgs) -> LegOptions {
    match args.timing.unwrap_or(TimingName::Limits) {
        TimingName::Limits => LegOptions { timing: Timing::Limits, reverse: !args.no_reverse },
        TimingName::Paper => {
            let seconds = args.leg_time.unwrap_or(PAPER_LEG_TIME);
            LegOptions { timing: paper_timing(Seconds(seconds as f32)), reverse: false }
        }
    }
}

/// What `args` ask for, and where they do not say how legs are made, as those of a plan were made.
pub(crate) fn as_made(args: &WayArgs, made_for: Option<MadeFor>) -> WayArgs {
    let Some(MadeFor { leg_time, reverse, .. }) = made_for else { return args.clone() };
    let planned = if leg_time.is_some() { TimingName::Paper } else { TimingName::Limits };
    WayArgs {
        timing: args.timing.or(Some(planned)),
        leg_time: args.leg_time.or(leg_time),
        no_reverse: args.no_reverse || (planned == TimingName::Limits && !reverse),
        ..args.clone()
    }
}

/// The time since then, microseconds.
pub(crate) fn microseconds(since: Instant) -> f64 {
    since.elapsed().as_secs_f64() * 1e6
}

/// The planner of that name.
pub(crate) fn planner(name: PlannerName) -> Planner {
    match name {
        PlannerName::Exact => Planner::Exact,
        PlannerName::Grid => Planner::Grid,
        PlannerName::Tree => Planner::Tree,
        PlannerName::Fuzzy => Planner::Fuzzy,
    }
}

/// What makes a way good, by its name.
pub(crate) fn cost(name: CostName) -> Cost {
    match name {
        CostName::Length => Cost::Length,
        CostName::Time => Cost::Time(DEFAULT_LIMITS),
        CostName::Turns => Cost::Turns,
    }
}

/// `scene` for a robot of another radius, if one is given.
pub(crate) fn with_radius(scene: &Scene, radius: Option<f64>) -> Scene {
    Scene { robot_radius: radius.unwrap_or(scene.robot_radius), ..scene.clone() }
}

/// Where the arena's lower left corner lies in the frame that a person gives and reads points in: the
/// map's, or the arena's own.
pub(crate) fn origin(scene: &Scene) -> Point {
    scene.origin.unwrap_or(Point::new(0.0, 0.0))
}

/// Gives `scene` the start and goal that `args` ask for, if any.
#[cfg(feature = "dashboard")]
pub(crate) fn take_ends(scene: &mut Scene, args: &WayArgs) {
    let corner = origin(scene);
    let in_arena = |at: Point| Point::new(at.x - corner.x, at.y - corner.y);
    let heading = scene.start.map_or(0.0, |start| start.heading);
    scene.start = args.start.map_or(scene.start, |start| {
        let heading = start.heading.unwrap_or(heading);
        Some(Pose { position: in_arena(start.position), heading })
    });
    scene.goal = args
        .goal
        .map_or(scene.goal, |goal| Some(Goal { position: in_arena(goal.position), ..goal }));
}

/// Start and goal as asked for, or as the input has them.
pub(crate) fn ends(scene: &Scene, args: &WayArgs) -> Result<(Pose, Goal), CliError> {
    let corner = origin(scene);
    let in_arena = |at: Point| Point::new(at.x - corner.x, at.y - corner.y);
    let asked = args.start.map(|place| Pose {
        position: in_arena(place.position),
        heading: place.heading.or(scene.start.map(|pose| pose.heading)).unwrap_or(0.0),
    });
    let query = scene.queries.first();
    let start =
        asked.or(scene.start).or(query.map(|query| Pose { position: query.start, heading: 0.0 }));
    let goal = args
        .goal
        .map(|goal| Goal { position: in_arena(goal.position), ..goal })
        .or(scene.goal)
        .or(query.map(|query| Goal { position: query.goal, heading: None }));
    let missing = |what: &str, option: &str| {
        let message = format!("where is the {what}? The input does not say");
        CliError::new(
            Exit::Usage,
            &format!("plan.no_{what}"),
            message,
            format!("add --{option} x,y, metres from the lower left corner"),
        )
    };
    Ok((
        start.ok_or_else(|| missing("start", "start"))?,
        goal.ok_or_else(|| missing("goal", "goal"))?,
    ))
}
