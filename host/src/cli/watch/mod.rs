//! `wmr drive --watch`: a drive that a camera watches.
//!
//! The first frame is the photo that the drive begins with, whatever the input is: the input says how large the
//! arena is and where to go, and on `--port sim` what really stands there.

mod frames;
mod offer;

use super::args::{DriveArgs, VisionArgs, WayArgs};
use super::drive::{beside, keep, tell};
use super::endpoint::{self, Endpoint, Paced, SimulatedRobot, SimulatedWorld};
use super::error::{CliError, Exit};
use super::folder::Folder;
use super::input::{self, Input, SeenPhoto, Sight};
use super::mission;
use super::output::Output;
use super::run::{Driven, Run, RunClock, count_of_legs};
use super::sim::short_faults;
use super::way::{self, MarginRule, PlannedWay};
#[cfg(feature = "dashboard")]
pub(crate) use frames::camera_over;
use frames::{First, Frames, Watching};
use protocol::motion::Limits;
use std::time::Duration;
use wmr::document::{EventDocument, WatchDocument};
use wmr::geometry::Pose;
use wmr::link::drive::DriveEvent;
use wmr::link::{LinkClient, check_robot};
use wmr::plan::DRIVE_MARGINS;
use wmr::scene::{Goal, Obstacle, Scene};
use wmr::track::pose::PoseSigma;
use wmr::vision::{self, Camera, DetectOptions};
use wmr::watch::source::SourceError;
use wmr::watch::{Eye, Happening, Reason, Route, Router, WatchError, WatchOptions, WatchedDrive};

/// What is known before the first frame.
struct Known {
    /// What the input holds, if there is one.
    scene: Option<Scene>,
    vision: VisionArgs,
    way: WayArgs,
}

/// `wmr drive --watch`.
pub(crate) fn run(args: &DriveArgs, source: &str, output: Output) -> Result<(), CliError> {
    mission::catch_interrupts();
    let known = known(args, output)?;
    let First { bytes, camera, frames } = if source == "sim" {
        let robot = SimulatedRobot::for_timing(way::leg_options(&known.way).timing);
        frames::simulated(simulated_world(args, &known)?, robot, args)?
    } else {
        frames::live(source, output)?
    };
    let (input, options) = see(args, &known, bytes, camera)?;
    let Input::Photo(seen) = &input else { return Err(no_frame()) };
    let way = plan(seen, &known, output)?;
    let folder = args.log.as_deref().map(|path| Folder::begin(path, &input, &way)).transpose()?;
    let eye = Eye::new(vision::decode(&seen.bytes)?, seen.arena, options, &seen.detection);
    let (endpoint, watching) = match frames {
        Frames::Simulated(endpoint) => (endpoint, Watching::simulated(eye)),
        Frames::Live(source) => {
            let endpoint = live_endpoint(args, &known, &way)?;
            let delay = Duration::from_secs_f64(args.watch_delay);
            let watching = Watching::live(source, eye, endpoint.as_ref(), delay);
            (endpoint, watching)
        }
    };
    let driven = drive(args, &way, (endpoint, watching), seen.detection.obstacles.clone(), output)?;
    let outcome = tell(&driven, output);
    keep(outcome, output, || folder.map_or(Ok(()), |folder| folder.run(&input, &way, &driven.run)))
}

fn no_frame() -> CliError {
    CliError::new(Exit::Bug, "watch.frame", "a frame is no photo", "please report this")
}

/// What the input and the options say.
fn known(args: &DriveArgs, output: Output) -> Result<Known, CliError> {
    let sight = Sight {
        radius: args.way.radius,
        resolution: args.way.resolution,
        keep_steps: false,
        start: args.way.start,
    };
    let read = |path: &std::path::PathBuf| input::read(path, &args.vision, sight, output);
    let mut made_for = None;
    let scene = match args.input.as_ref().map(read).transpose()? {
        None => None,
        Some(Input::Photo(seen)) => Some(seen.scene(args.way.radius)),
        Some(Input::Scene(scene)) => Some(scene),
        Some(Input::Plan(file)) => {
            made_for = file.made_for;
            let goal = file.waypoints.last();
            let goal = goal.map(|&position| Goal { position, heading: file.goal_heading() });
            let start = file.waypoints.first();
            let heading = file.start_heading();
            let start = start.map(|&position| Pose { position, heading });
            Some(Scene { start, goal, ..file.scene.clone() })
        }
    };
    let arena = args.vision.arena.or(scene.as_ref().map(|scene| scene.arena));
    let radius = args.way.radius.or(scene.as_ref().map(|scene| scene.robot_radius));
    Ok(Known {
        vision: VisionArgs { arena, ..args.vision.clone() },
        way: WayArgs { radius, ..way::as_made(&args.way, made_for) },
        scene,
    })
}

/// What really stands on the floor of a simulated robot, which begins where the input or `--start` says.
fn simulated_world(args: &DriveArgs, known: &Known) -> Result<SimulatedWorld, CliError> {
    if args.port != "sim" && !args.port.starts_with("elf:") {
        return Err(CliError::usage(
            "a simulated camera sees a simulated robot alone",
            "say --port sim, or give the --watch of your camera",
        ));
    }
    let Some(scene) = &known.scene else {
        let message = "what does the simulated camera see?";
        return Err(CliError::usage(message, "give a scene, plan or photo too"));
    };
    let asked = known
        .way
        .start
        .map(|start| Pose { position: start.position, heading: start.heading.unwrap_or(0.0) });
    let start = asked.or(scene.start).ok_or_else(|| {
        CliError::usage("where does the simulated robot stand?", "add --start x,y,deg")
    })?;
    world_of(args, scene, start)
}

fn world_of(args: &DriveArgs, scene: &Scene, start: Pose) -> Result<SimulatedWorld, CliError> {
    let start = beside(start, args.sim_start_error, args.sim_seed);
    let script = Some(short_faults("--sim-fault", &args.sim_fault)?);
    Ok(SimulatedWorld { script, ..SimulatedWorld::new(scene, start, args.sim_seed) })
}

/// The port to a robot that a real camera watches; a simulated one keeps to the clock on the wall.
fn live_endpoint(
    args: &DriveArgs,
    known: &Known,
    way: &PlannedWay,
) -> Result<Box<dyn Endpoint>, CliError> {
    let scene = known.scene.as_ref().unwrap_or(&way.file.scene);
    let world = world_of(args, scene, first_pose(way))?;
    let endpoint = endpoint::open(&args.port, world, SimulatedRobot::for_timing(way.legs.timing))?;
    Ok(if endpoint.epoch().is_some() { endpoint } else { Box::new(Paced::new(endpoint)) })
}

/// Looks at the first frame, by a simulated camera's own lens if there is one and nothing else is said.
fn see(
    args: &DriveArgs,
    known: &Known,
    bytes: Vec<u8>,
    simulated: Option<Camera>,
) -> Result<(Input, DetectOptions), CliError> {
    let start = args.way.start.or(known.scene.as_ref().and_then(|scene| {
        scene.start.map(|start| Goal { position: start.position, heading: Some(start.heading) })
    }));
    let radius = known.way.radius;
    let sight =
        Sight { radius, resolution: args.way.resolution, keep_steps: args.log.is_some(), start };
    let (camera, empty) = input::camera_and_empty(&known.vision)?;
    let says = known.vision.corners.is_some() || known.vision.tags.is_some();
    let camera = camera.or(simulated.filter(|_| !says));
    let options = input::detect_options(&known.vision, sight, (camera.clone(), empty.as_deref()))?;
    let options = DetectOptions { keep_steps: false, ..options };
    let seen = input::see_with(bytes, &known.vision, sight, (camera, empty))?;
    Ok((Input::Photo(Box::new(seen)), options))
}

/// The way by the first frame.
fn plan(seen: &SeenPhoto, known: &Known, output: Output) -> Result<PlannedWay, CliError> {
    seen.detection.warnings.iter().for_each(|warning| output.say(&format!("warning: {warning}")));
    let scene = seen.scene(known.way.radius);
    let input = known.scene.as_ref();
    let goal = input.and_then(|scene| scene.goal).or(scene.goal);
    let origin = input.and_then(|scene| scene.origin);
    let scene = Scene { goal, origin, ..scene };
    // The robot stands where it is seen; what was said of it helped to see it.
    let way =
        WayArgs { start: known.way.start.filter(|_| scene.start.is_none()), ..known.way.clone() };
    way::plan_way(&scene, way::planner(way.planner), &way, MarginRule::ForDriving, output)
}

/// Where a way begins.
pub(crate) fn first_pose(way: &PlannedWay) -> Pose {
    let first = way.file.waypoints.first().copied();
    let position = first.unwrap_or(wmr::geometry::Point::new(0.0, 0.0));
    Pose { position, heading: way.file.start_heading() }
}

/// Drives the way while the camera watches.
fn drive(
    args: &DriveArgs,
    way: &PlannedWay,
    (endpoint, mut watching): (Box<dyn Endpoint>, Watching),
    obstacles: Vec<Obstacle>,
    output: Output,
) -> Result<Driven, CliError> {
    let nonce = endpoint.nonce();
    let mut client = LinkClient::new(endpoint, nonce);
    let robot = mission::connect(&mut client)?;
    client.check_protocol()?;
    check_robot(&robot)?;
    let start = first_pose(way);
    let mut run = Run::new(Vec::new(), robot.limits, start);
    run.origin = way::origin(&way.file.scene);
    run.goal = way.file.waypoints.last().copied();
    let identity = mission::identify(&mut client)?;
    mission::warn_of_wiring(&mut client, identity, output)?;
    let how = Manner {
        margin: args.way.margin,
        sigma: if args.vision.robot_tag.is_some() { PoseSigma::TAGGED } else { PoseSigma::MARKED },
        patience: Duration::from_secs_f64(args.watch_patience),
    };
    let mut drive = watched(way, &how, robot.limits, obstacles, output);
    let described = mission::describe_robot(&robot);
    output.say(&format!("robot: {described}; {}", count_of_legs(drive.mission().legs().len())));
    if drive.mission().legs().is_empty() {
        run.truth = client.port_mut().truth();
        return Ok(Driven { run, error: None });
    }
    let mut events = Vec::new();
    let (mut clock, began) = (RunClock::default(), client.port_mut().now());
    let result =
        drive.run(&mut client, &mut watching, mission::stop_wanted, |at, what| match what {
            Happening::Drive(DriveEvent::Mission(event)) => run.record(event, &mut clock),
            Happening::Drive(DriveEvent::PortLost) => {
                output.say("the port is gone; the robot waits for it")
            }
            Happening::Drive(DriveEvent::PortBack) => output.say("the port is back"),
            Happening::Watch(event) => {
                let told = EventDocument::new(at.saturating_sub(began), &event);
                output.say(&format!("{:.1} s: {}", told.time, told.text));
                events.push(told);
            }
        });
    let result = mission::finish(&mut client, result.map_err(CliError::from));
    (run.legs, run.results) = (drive.legs().to_vec(), drive.results().to_vec());
    run.watch = Some(WatchDocument { counts: drive.statistics(), events });
    run.truth = client.port_mut().truth();
    run.link = client.statistics();
    match result {
        Ok(pose) => {
            run.end = pose;
            offer::calibration(&mut client, drive.calibration(), &args.port, output);
            Ok(Driven { run, error: None })
        }
        Err(error) => Ok(Driven { run, error: Some(error) }),
    }
}

/// How a drive is watched.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Manner {
    /// The margin that somebody asks for, metres.
    pub(crate) margin: Option<f64>,
    /// How well one frame tells the robot's pose.
    pub(crate) sigma: PoseSigma,
    /// How long the robot waits for a way.
    pub(crate) patience: Duration,
}

/// The drive that begins with a way, which was planned around `obstacles`.
pub(crate) fn watched(
    way: &PlannedWay,
    how: &Manner,
    limits: Limits,
    obstacles: Vec<Obstacle>,
    output: Output,
) -> WatchedDrive {
    let file = &way.file;
    let position = file.waypoints.last().copied().unwrap_or(first_pose(way).position);
    let router = Router {
        scene: file.scene.clone(),
        goal: Goal { position, heading: file.goal_heading() },
        plan: way.options.clone(),
        margins: how.margin.map_or(DRIVE_MARGINS.to_vec(), |margin| vec![margin]),
        legs: way.legs,
    };
    let legs = way.legs_for(&limits, output);
    let route = Route { legs, length: file.length, margin: way.options.margin };
    let Manner { sigma, patience, .. } = *how;
    let options = WatchOptions { router, sigma, patience, foresees: true };
    WatchedDrive::new(options, limits, first_pose(way), route, obstacles)
}

impl From<SourceError> for CliError {
    fn from(error: SourceError) -> Self {
        let exit = match error {
            SourceError::Unknown(_)
            | SourceError::Device(_)
            | SourceError::Encrypted(_)
            | SourceError::Address(_) => Exit::Usage,
            _ => Exit::File,
        };
        Self::of(exit, "watch.source", &error)
    }
}

impl From<WatchError> for CliError {
    fn from(error: WatchError) -> Self {
        match error {
            WatchError::Drive(error) => error.into(),
            WatchError::Source(_) => Self::of(Exit::Robot, "watch.source", &error),
            WatchError::GaveUp { reason: Reason::NoWay(_), .. } => {
                Self::of(Exit::NoPath, "watch.no_way", &error)
            }
            WatchError::GaveUp { .. } => Self::of(Exit::Robot, "watch.waited", &error),
        }
    }
}
