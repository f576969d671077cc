//! `wmr drive`: a robot, real or simulated, along a plan.

use super::args::DriveArgs;
use super::endpoint::{self, SimulatedRobot, SimulatedWorld};
use super::error::{CliError, Exit};
use super::folder::Folder;
use super::input::{self, Input, Sight};
use super::mission::{self, Beginning, Resume, place};
use super::output::Output;
use super::run::{Driven, Run, count_of_legs};
use super::sim::{check_camera, short_faults};
use super::way::{self, MarginRule, PlannedWay};
use hil_sim::script::Script;
use hil_sim::world::CollisionLog;
use protocol::motion::Limits;
use wmr::geometry::{Point, Pose};
use wmr::link::standing::Tolerance;

/// `wmr drive`.
pub(crate) fn run(args: &DriveArgs, output: Output) -> Result<(), CliError> {
    let path = args
        .input
        .as_deref()
        .ok_or_else(|| CliError::usage("what is to be driven?", "give a plan, photo or scene"))?;
    let input = input::read(
        path,
        &args.vision,
        Sight {
            radius: args.way.radius,
            resolution: args.way.resolution,
            keep_steps: args.log.is_some(),
            start: args.way.start,
        },
        output,
    )?;
    let asked = &args.way;
    let way = way::find(&input, asked, MarginRule::ForDriving, output)?;
    let resume = if args.resume { Resume::Wanted } else { Resume::Offered };
    let folder = args.log.as_deref().map(|path| Folder::begin(path, &input, &way)).transpose()?;
    let tolerance = match &input {
        _ if args.from_start => None,
        Input::Photo(_) => Some(Tolerance::SEEN),
        Input::Scene(_) | Input::Plan(_) => Some(Tolerance::WRITTEN),
    };
    let script = short_faults("--sim-fault", &args.sim_fault)?;
    check_camera(&script, false, "--watch sim")?;
    let (seed, error) = (args.sim_seed, args.sim_start_error);
    let begin = Begin { tolerance, resume, seed, error, script };
    let driven = drive_way(&way, &args.port, begin, output)?;
    let outcome = tell(&driven, output);
    keep(outcome, output, || folder.map_or(Ok(()), |folder| folder.run(&input, &way, &driven.run)))
}

/// Prints what became of a drive; an error unless it reached its goal.
pub(crate) fn tell(driven: &Driven, output: Output) -> Result<(), CliError> {
    let Driven { run, error } = driven;
    if let Some(error) = error {
        return Err(error.clone());
    }
    output.result(&run.document(), &describe_run(run))?;
    arrived(run)
}

/// Writes a drive down once its `outcome` is told: that comes first, and survives a full disk.
pub(crate) fn keep(
    outcome: Result<(), CliError>,
    output: Output,
    write: impl FnOnce() -> Result<(), CliError>,
) -> Result<(), CliError> {
    match (outcome, write()) {
        (Ok(()), Err(error)) => Err(CliError { after_result: true, ..error }),
        (Err(error), Err(unwritten)) => {
            output.say(&format!("{}; the log is not whole", unwritten.message));
            Err(error)
        }
        (outcome, Ok(())) => outcome,
    }
}

/// How a drive begins.
#[derive(Clone, Debug)]
pub(crate) struct Begin {
    /// How far from its start the robot may know itself to stand; `None` if it was carried there.
    pub(crate) tolerance: Option<Tolerance>,
    pub(crate) resume: Resume,
    /// Which robot is simulated.
    pub(crate) seed: u64,
    /// How far beside its start a simulated robot really stands: metres, radians.
    pub(crate) error: Option<(f64, f64)>,
    /// What goes wrong with a simulated robot.
    pub(crate) script: Script,
}

/// A pose so far beside `pose`, to the side that `seed` has it.
pub(super) fn beside(pose: Pose, error: Option<(f64, f64)>, seed: u64) -> Pose {
    let Some((distance, turn)) = error else { return pose };
    // Turns by the golden section never fall on each other.
    let direction = std::f64::consts::TAU * (seed as f64 * 0.618_033_988_75).fract();
    let (sin, cos) = direction.sin_cos();
    let Point { x, y } = pose.position;
    let turn = if seed.is_multiple_of(2) { turn } else { -turn };
    Pose::new(x + distance * cos, y + distance * sin, pose.heading + turn)
}

/// Drives a way on the port of that name.
pub(crate) fn drive_way(
    way: &PlannedWay,
    port: &str,
    Begin { tolerance, resume, seed, error, script }: Begin,
    output: Output,
) -> Result<Driven, CliError> {
    let file = &way.file;
    let first = file.waypoints.first().copied().unwrap_or(Point::new(0.0, 0.0));
    let start = Pose { position: first, heading: file.start_heading() };
    let world = SimulatedWorld::new(&file.scene, beside(start, error, seed), seed);
    let world = SimulatedWorld { script: Some(script), ..world };
    let endpoint = endpoint::open(port, world, SimulatedRobot::for_timing(way.legs.timing))?;
    let legs = |limits: &Limits| way.legs_for(limits, output);
    let mut driven =
        mission::drive(endpoint, Beginning { start, tolerance }, legs, resume, output)?;
    driven.run.origin = way::origin(&file.scene);
    driven.run.goal = file.waypoints.last().copied();
    Ok(driven)
}

/// An error if the robot says that it is done, but is not where it should be; for after the result.
fn arrived(run: &Run) -> Result<(), CliError> {
    if run.reached() {
        return Ok(());
    }
    let (position, heading) = run.error();
    let message = format!(
        "the robot ended {:.0} mm and {:.1}° from its goal",
        position * 1000.0,
        heading.to_degrees()
    );
    let help = "look for slipping wheels, then drive again";
    let error = CliError::new(Exit::Robot, "robot.missed", message, help);
    Err(CliError { after_result: true, ..error })
}

/// A run, for people.
fn describe_run(run: &Run) -> String {
    let (position, heading) = run.error();
    let known = if run.truth.is_some() { "true" } else { "measured" };
    let mut text = format!(
        "{} in {:.2} s; {known} end pose {}, {:.1} mm and {:.2}° from the goal\n",
        count_of_legs(run.results.len()),
        run.duration(),
        place(run.in_map_frame(run.best_pose())),
        position * 1000.0,
        heading.to_degrees()
    );
    if let Some(collision_log) = run.truth.and_then(|truth| truth.collision_log) {
        let CollisionLog { collisions, min_clearance, .. } = collision_log;
        text += &describe_collisions(collisions, min_clearance);
    }
    text
}

/// What a simulated robot touched, for people.
pub(crate) fn describe_collisions(collisions: u32, min_clearance: f64) -> String {
    let times = match collisions {
        1 => "1 collision".to_owned(),
        other => format!("{other} collisions"),
    };
    let gap = min_clearance * 1000.0;
    if gap < 0.0 {
        return format!(
            "{times}; the robot overlapped an obstacle or the border by {:.0} mm\n",
            -gap
        );
    }
    format!("{times}; smallest gap beside the robot {gap:.0} mm\n")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn collisions_are_told_in_words() {
        assert_eq!(
            describe_collisions(0, 0.012),
            "0 collisions; smallest gap beside the robot 12 mm\n"
        );
        assert_eq!(
            describe_collisions(1, -0.17),
            "1 collision; the robot overlapped an obstacle or the border by 170 mm\n"
        );
    }

    #[test]
    fn a_robot_beside_its_start_is_as_far_from_it_as_was_said() {
        let start = Pose::new(0.5, 0.4, 1.0);
        assert_eq!(beside(start, None, 3), start);
        for seed in 0..9 {
            let pose = beside(start, Some((0.02, 0.05)), seed);
            assert!((pose.position.distance(start.position) - 0.02).abs() < 1e-12);
            assert!(((pose.heading - start.heading).abs() - 0.05).abs() < 1e-12);
        }
        let [a, b] = [1, 2].map(|seed| beside(start, Some((0.02, 0.0)), seed));
        assert!(a.position.distance(b.position) > 0.01, "to another side");
    }
}
