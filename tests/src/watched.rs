//! Drives that a simulated camera watches, in virtual time: frames are rendered, seen and answered to.
//!
//! The camera hangs 2.5 m above an arena of 2.0 × 1.5 m and sends frames of 640 × 480 pixels, ten a second,
//! 80 ms late. The robot has a tag on its top. Metres, seconds, radians, arena frame.

use hil_sim::base::{BaseParameters, Faults, TruePose, WheeledBase};
use hil_sim::camera::{Camera, Lens, Light, Look, Mark, Sensor, Stream, Timing};
use hil_sim::in_process::InProcess;
use hil_sim::script::Script;
use hil_sim::simulation::Simulation;
use hil_sim::world::{CollisionLog, Shape, World};
use std::time::{Duration, Instant};
use wmr::geometry::{Arena, Point, Pose, wrap_angle};
use wmr::legs::{DEFAULT_LIMITS, LegOptions, to_legs, to_wire};
use wmr::link::LinkClient;
use wmr::link::mission::Mission;
use wmr::plan::{DRIVE_MARGINS, PlanOptions};
use wmr::protocol::motion::{self, Leg};
use wmr::scene::{Goal, Scene};
use wmr::track::pose::{Calibration, PoseSigma};
use wmr::vision::{DetectOptions, Detection, Photo, TagDictionary, detect};
use wmr::watch::source::SourceError;
use wmr::watch::{
    self, Expected, Eye, Happening, Router, WatchError, WatchEvent, WatchOptions, WatchStatistics,
    WatchedDrive, Watcher,
};

pub(crate) const SIZE: [f64; 2] = [2.0, 1.5];
/// The arena.
pub const ARENA: Arena = Arena { width: SIZE[0], height: SIZE[1] };
/// The robot's radius.
pub const RADIUS: f64 = 0.075;
/// How well a tag tells the pose.
pub const SIGMA: PoseSigma = PoseSigma { position: 0.003, heading: 0.012 };
/// The tag on the robot's top, and its side.
pub(crate) const TAG: usize = 7;
const TAG_SIDE: f64 = 0.09;
/// How high the camera hangs.
pub(crate) const HEIGHT: f64 = 2.5;
type Port = Simulation<InProcess>;

const LEG_OPTIONS: LegOptions = LegOptions { timing: motion::Timing::Limits, reverse: true };
const TIMING: Timing =
    Timing { rate: 10.0, latency: Duration::from_millis(80), lost: 0.0, seed: 1 };

/// What is to be driven.
#[derive(Clone, Debug)]
pub struct Case {
    /// What stands on the floor from the beginning.
    pub shapes: Vec<Shape>,
    /// Where the robot begins.
    pub start: TruePose,
    /// Where it is to go, one place after the other.
    pub goals: Vec<Goal>,
    /// Its base.
    pub base: BaseParameters,
    /// How its wheels slip.
    pub slips: Faults,
    /// What goes wrong, as `wmr sim --fault` takes it, from the first frame on.
    pub faults: Vec<String>,
    /// How long the robot waits for a way.
    pub patience: Duration,
}

impl Case {
    /// A drive over an empty floor, from x, y, heading to x, y, heading.
    pub fn new([x, y, heading]: [f64; 3], goal: [f64; 3]) -> Self {
        Self {
            shapes: Vec::new(),
            start: TruePose { x, y, heading },
            goals: vec![goal_at(goal)],
            base: BaseParameters::seeded(1),
            slips: Faults::default(),
            faults: Vec::new(),
            patience: Duration::from_secs(20),
        }
    }
}

/// A goal at x, y, heading.
pub fn goal_at([x, y, heading]: [f64; 3]) -> Goal {
    Goal { position: Point::new(x, y), heading: Some(heading) }
}

/// What became of a drive.
#[derive(Debug)]
pub struct Outcome {
    /// How the last drive ended.
    pub result: Result<Pose, WatchError>,
    /// Where the robot really is, after each drive.
    pub ends: Vec<TruePose>,
    /// What it has touched.
    pub collisions: CollisionLog,
    /// What was told, and when.
    pub events: Vec<(Duration, WatchEvent)>,
    /// Time and true position every 5 ms.
    pub path: Vec<(f64, Point)>,
    /// What was counted, of the last drive.
    pub statistics: WatchStatistics,
    /// What the last drive has taught of the base.
    pub calibration: Option<Calibration>,
    /// How long each frame took to be looked at, on this computer.
    pub frame_times: Vec<Duration>,
}

impl Outcome {
    /// How far the robot has really ended from the last goal, and how much it is turned.
    pub fn error(&self, case: &Case) -> (f64, f64) {
        error(*self.ends.last().unwrap(), case)
    }

    /// The true speed around a time, over 0.2 s.
    pub fn speed(&self, time: f64) -> f64 {
        let at = |time: f64| self.path.iter().find(|(at, _)| *at >= time).map(|(_, point)| *point);
        at(time - 0.1).zip(at(time + 0.1)).map_or(0.0, |(a, b)| a.distance(b) / 0.2)
    }

    /// How many events are like this.
    pub fn told(&self, is: impl Fn(&WatchEvent) -> bool) -> usize {
        self.events.iter().filter(|(_, event)| is(event)).count()
    }

    /// What happened, for the reader of a failed test.
    pub fn story(&self) -> String {
        let line =
            |(at, event): &(Duration, WatchEvent)| format!("{:.2} s: {event}\n", at.as_secs_f64());
        let told: String = self.events.iter().map(line).collect();
        format!(
            "{told}{:?} {:?} {:?} {:?}",
            self.result, self.ends, self.collisions, self.statistics
        )
    }
}

/// Drives to each goal in turn.
pub fn drive(case: &Case) -> Outcome {
    let (mut simulation, first) = simulation(case);
    let camera = Some(simulation.camera_mut().unwrap().camera().lens().into());
    let options = DetectOptions {
        robot_radius: RADIUS,
        robot_tag: Some(TAG),
        camera,
        ..DetectOptions::default()
    };
    let seen = detect(&first, ARENA, &options).unwrap();
    let mut script = Script::default();
    for fault in &case.faults {
        script.faults.extend(Script::parse_short(fault).unwrap().faults);
    }
    simulation.run_script(script);
    let mut client = LinkClient::new(simulation, 1);
    let eye = Eye::new(first, ARENA, options, &seen);
    let mut watcher = Overhead::new(eye);
    let mut outcome = Outcome {
        result: Ok(seen.robot.unwrap()),
        ends: Vec::new(),
        collisions: CollisionLog::default(),
        events: Vec::new(),
        path: Vec::new(),
        statistics: WatchStatistics::default(),
        calibration: None,
        frame_times: Vec::new(),
    };
    for goal in &case.goals {
        let Ok(start) = outcome.result else { break };
        drive_to(*goal, (start, &seen), case, (&mut client, &mut watcher), &mut outcome);
    }
    outcome.path = watcher.path;
    outcome.frame_times = watcher.frame_times;
    outcome.collisions = client.port_mut().truth().collision_log.unwrap();
    outcome
}

fn drive_to(
    goal: Goal,
    (start, seen): (Pose, &Detection),
    case: &Case,
    (client, watcher): (&mut LinkClient<Port>, &mut Overhead),
    outcome: &mut Outcome,
) {
    let router = Router {
        scene: Scene::from_detection(seen, ARENA, RADIUS),
        goal,
        plan: PlanOptions::default(),
        margins: DRIVE_MARGINS.to_vec(),
        legs: LEG_OPTIONS,
    };
    let obstacles = seen.obstacles.clone();
    let route = router.route(&obstacles, start, (0.0, false), &DEFAULT_LIMITS).unwrap();
    let options = WatchOptions { router, sigma: SIGMA, patience: case.patience, foresees: true };
    let mut drive = WatchedDrive::new(options, DEFAULT_LIMITS, start, route, obstacles);
    outcome.result = drive.run(
        client,
        watcher,
        || false,
        |at, what| {
            if let Happening::Watch(event) = what {
                outcome.events.push((at, event));
            }
        },
    );
    outcome.ends.push(client.port_mut().truth().pose);
    outcome.statistics = drive.statistics();
    outcome.calibration = drive.calibration();
}

/// How far from the last goal the same robot ends, and how much it is turned, with nothing but its wheels to tell it
/// where it is.
pub fn drive_blind(case: &Case) -> (f64, f64) {
    let (simulation, _) = simulation(case);
    let mut from = Pose::from(case.start);
    let mut legs = Vec::new();
    for goal in &case.goals {
        let path = [from.position, goal.position];
        legs.extend(to_legs(&path, from.heading, goal.heading, &LEG_OPTIONS, &DEFAULT_LIMITS));
        from = Pose { position: goal.position, heading: goal.heading.unwrap_or(from.heading) };
    }
    let mut mission = Mission::new(numbered(legs), to_wire(case.start.into()));
    let mut client = LinkClient::new(simulation, 1);
    wmr::link::drive::drive(&mut client, &mut mission, || false, |_, _| {}).unwrap();
    error(client.port_mut().truth().pose, case)
}

/// The legs of one plan.
fn numbered(legs: Vec<Leg>) -> Vec<Leg> {
    let plan = legs.first().map_or(0, |leg| leg.plan);
    legs.into_iter().zip(0..).map(|(leg, index)| Leg { plan, index, ..leg }).collect()
}

/// How far from the last goal a robot is, and how much it is turned.
fn error(truth: TruePose, case: &Case) -> (f64, f64) {
    let goal = case.goals.last().unwrap();
    let heading = goal.heading.unwrap_or(truth.heading);
    let distance = Point::new(truth.x, truth.y).distance(goal.position);
    (distance, wrap_angle(truth.heading - heading).abs())
}

/// The robot on its floor, and the first frame.
fn simulation(case: &Case) -> (Simulation<InProcess>, Photo) {
    let world =
        World { size: SIZE, shapes: case.shapes.clone(), movers: Vec::new(), robot_radius: RADIUS };
    let mut base = WheeledBase::new(case.base, case.start);
    base.set_faults(case.slips);
    let cells = TagDictionary::named("4X4_50").unwrap().cells(TAG).unwrap();
    let mark = Mark::Tag { side: TAG_SIDE, cells };
    let look = Look { mark, robot: [240; 3], ..Look::default() };
    let lens = Lens::above(SIZE, HEIGHT, [640, 480]);
    let camera = Camera::new(lens, Light::beside(SIZE), look, Sensor::default());
    let mut simulation = Simulation::new(InProcess::default(), base, Some(world))
        .with_camera(Stream::new(camera, TIMING));
    loop {
        simulation.wait(Duration::from_millis(5)).unwrap();
        if let Some(frame) = simulation.take_frame() {
            return (simulation, Photo::try_from(&frame).unwrap());
        }
    }
}

/// Looks at the frames of the simulated camera, and notes where the robot really is.
struct Overhead {
    eye: Eye,
    expected: Expected,
    path: Vec<(f64, Point)>,
    frame_times: Vec<Duration>,
}

impl Overhead {
    fn new(eye: Eye) -> Self {
        Self { eye, expected: Expected::default(), path: Vec::new(), frame_times: Vec::new() }
    }
}

impl Watcher<Port> for Overhead {
    fn expect(&mut self, at: Duration, pose: Pose) {
        self.expected.push(at, pose);
    }

    fn look(&mut self, port: &mut Port, now: Duration) -> Result<watch::Look, SourceError> {
        let truth = port.truth().pose;
        self.path.push((now.as_secs_f64(), Point::new(truth.x, truth.y)));
        let Some(frame) = port.take_frame() else { return Ok(watch::Look::Nothing) };
        let began = Instant::now();
        let sight = self.eye.look(
            &Photo::try_from(&frame).unwrap(),
            frame.exposed,
            self.expected.at(frame.exposed),
        );
        self.frame_times.push(began.elapsed());
        Ok(match sight {
            Ok(sight) => watch::Look::Seen(sight),
            Err(error) => watch::Look::Failed(error.to_string()),
        })
    }
}
