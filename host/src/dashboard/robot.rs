//! The thread that has the robot: it keeps the link alive, drives, and stops whenever it is asked to.
//!
//! It waits for nobody but its port: orders come through a queue that is looked at between drives, pause
//! and stop through [`Controls`], which are read at each step of 2 ms.

use super::archive::Archive;
use super::calibrating::CalibrateTask;
use super::camera::Lookout;
use super::desk::DeskPhoto;
use super::faults::FaultWish;
use super::frames::FrameLog;
use super::live::{Controls, Hold, Live, RunStatus};
use super::paced::Paced;
use super::service::ParameterTask;
use super::watched::WatchedTask;
use super::{live, lock};
use crate::cli::endpoint::{self, SimulatedRobot, SimulatedWorld};
use crate::cli::error::{CliError, Exit};
use crate::cli::run::Run;
use crate::cli::way::PlannedWay;
use protocol::message::Report;
use protocol::motion::Limits;
use protocol::parameters::Parameters;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::mpsc::{Receiver, SyncSender, TryRecvError, sync_channel};
use std::sync::{Arc, Mutex};
use std::thread::JoinHandle;
use std::time::{Duration, Instant};
use wmr::calibration::Course;
use wmr::geometry::Point;
use wmr::legs::planned_end;
use wmr::link::drive::{TimedPort, wait_for};
use wmr::link::{LinkClient, LinkError};

/// Which robot.
#[derive(Clone, Debug)]
pub(super) struct RobotSettings {
    pub(super) port: String,
    pub(super) speed: f64,
    pub(super) seed: u64,
    pub(super) faults: FaultWish,
    pub(super) camera: Lookout,
    pub(super) frames: FrameLog,
    pub(super) archive: Archive,
}

/// What the robot is to do next.
#[derive(Debug)]
pub(super) struct Order {
    pub(super) task: Task,
    /// How many stops there had been when this was asked for.
    pub(super) stops: u64,
}

#[derive(Debug)]
pub(super) enum Task {
    /// The way, and the photo in which it was planned.
    Drive(Box<PlannedWay>, Option<Arc<DeskPhoto>>),
    /// The same while the camera watches.
    Watched(Box<WatchedTask>),
    /// So far ahead of where it stands, or behind; metres.
    Ahead(f64),
    /// So far to the left, radians.
    Turn(f64),
    /// For as long as somebody holds a button.
    Held(Hold),
    /// Another port from now on.
    Connect(String),
    Parameters(ParameterTask),
    /// One of the courses of a calibration.
    Course(Course),
    Calibrate(CalibrateTask),
}

/// A step of the link between drives.
const IDLE_STEP: Duration = Duration::from_millis(4);
/// A port that could not be opened is tried again after this long.
const RETRY: Duration = Duration::from_secs(1);
/// At the end the robot is given this long to hear the stop.
const END_PATIENCE: Duration = Duration::from_millis(500);
/// After its legs have ended it says so within so long: it may still brake.
const REST_PATIENCE: Duration = Duration::from_millis(500);
/// The trail has a point at most so often, seconds.
const TRAIL_INTERVAL: f64 = 0.1;
/// And at most so close to the last, metres.
const TRAIL_STEP: f64 = 0.002;

/// Starts the thread.
pub(super) fn spawn(
    settings: RobotSettings,
    live: Arc<Mutex<Live>>,
    controls: Arc<Controls>,
) -> (SyncSender<Order>, JoinHandle<()>) {
    let (sender, orders) = sync_channel(1);
    let thread = std::thread::spawn(move || {
        let mut robot = RobotThread {
            settings,
            live,
            controls,
            client: None,
            next_try: Instant::now(),
            stops: 0,
            deadman: None,
            own_parameters: None,
            robot: SimulatedRobot::Default,
        };
        // A panic ends the link, so the robot stops by itself within 0.3 s; the next one can start again.
        while catch_unwind(AssertUnwindSafe(|| robot.run(&orders))).is_err() {
            robot.client = None;
            robot.deadman = None;
            let help = "the robot stops by itself; drive again, and please report it";
            let error = CliError::new(Exit::Bug, "bug", "the robot's thread has failed", help);
            robot.end_run(None, Some(&error));
        }
    });
    (sender, thread)
}

pub(super) struct RobotThread {
    pub(super) settings: RobotSettings,
    pub(super) live: Arc<Mutex<Live>>,
    pub(super) controls: Arc<Controls>,
    pub(super) client: Option<LinkClient<Paced>>,
    pub(super) next_try: Instant,
    /// The stops that the robot was told of.
    stops: u64,
    /// The button that must be held for the robot to move.
    pub(super) deadman: Option<Hold>,
    /// The numbers that a person has given the simulated robot.
    pub(super) own_parameters: Option<Parameters>,
    /// Which robot is simulated.
    robot: SimulatedRobot,
}

impl RobotThread {
    fn run(&mut self, orders: &Receiver<Order>) {
        while !self.controls.has_ended() {
            match orders.try_recv() {
                Ok(order) => self.carry_out(order),
                Err(TryRecvError::Empty) => self.idle(),
                Err(TryRecvError::Disconnected) => break,
            }
        }
        self.say_goodbye();
    }

    pub(super) fn is_simulated(&self) -> bool {
        live::is_simulated(&self.settings.port)
    }

    /// Opens the port, with `world` around a simulated robot.
    pub(super) fn open(
        &self,
        world: SimulatedWorld,
        robot: SimulatedRobot,
    ) -> Result<LinkClient<Paced>, CliError> {
        let endpoint = endpoint::open(&self.settings.port, world, robot)?;
        let RobotSettings { speed, frames, faults, camera, .. } = &self.settings;
        let wishes = (faults.clone(), camera.clone());
        let port = Paced::new(endpoint, *speed, frames.clone(), wishes);
        let nonce = port.nonce();
        Ok(LinkClient::new(port, nonce))
    }

    /// Opens the port in place of what is open.
    pub(super) fn use_robot(
        &mut self,
        world: SimulatedWorld,
        robot: SimulatedRobot,
    ) -> Result<(), CliError> {
        self.client = Some(self.open(world, robot)?);
        self.robot = robot;
        Ok(())
    }

    /// Sees to it that there is a robot, and where it is simulated that it is this one; it stays where it is.
    pub(super) fn suit(&mut self, robot: SimulatedRobot) -> Result<(), CliError> {
        let is_other = self.is_simulated() && self.robot != robot;
        if self.client.is_none() || is_other {
            self.use_robot(SimulatedWorld::nowhere(self.settings.seed), robot)?;
            self.client.iter_mut().for_each(|client| client.port_mut().arrange());
        }
        Ok(())
    }

    /// Keeps the link alive while there is nothing to do.
    fn idle(&mut self) {
        if self.client.is_none() {
            if Instant::now() < self.next_try {
                return std::thread::sleep(IDLE_STEP);
            }
            let nowhere = SimulatedWorld::nowhere(self.settings.seed);
            if let Err(error) = self.use_robot(nowhere, SimulatedRobot::Default) {
                return self.lose(&error);
            }
        }
        self.client.iter_mut().for_each(|client| client.port_mut().arrange());
        if let Err(error) = self.listen() {
            self.lose(&error);
        }
    }

    /// One step of the link: passes on a stop, and takes in what the robot says.
    fn listen(&mut self) -> Result<(), CliError> {
        let Some(client) = &mut self.client else { return Ok(()) };
        let stops = self.controls.stops();
        if self.stops != stops {
            self.stops = stops;
            client.stop();
        }
        let now = client.port_mut().now();
        let reports = client.poll(now)?;
        {
            let mut live = lock(&self.live);
            live.robot = client.robot().copied();
            if let Some(telemetry) = client.telemetry()
                && live.telemetry.is_none_or(|last| last.ticks != telemetry.ticks)
            {
                live.hear(*telemetry);
            }
            for report in reports {
                if let Report::Battery(battery) = report {
                    live.battery = Some(battery);
                }
            }
        }
        client.port_mut().wait(IDLE_STEP).map_err(LinkError::from)?;
        Ok(())
    }

    pub(super) fn lose(&mut self, error: &CliError) {
        self.client = None;
        self.next_try = Instant::now() + RETRY;
        lock(&self.live).lose(serde_json::json!(error.failure()));
    }

    fn carry_out(&mut self, order: Order) {
        let task = match order.task {
            Task::Connect(port) => return self.connect(port),
            Task::Parameters(task) => return self.serve_parameters(task),
            Task::Calibrate(task) => return self.serve_calibration(task),
            task => task,
        };
        if order.stops != self.controls.stops() {
            return self.end_run(None, Some(&stopped()));
        }
        let result = match task {
            Task::Drive(way, photo) => {
                let photo = photo.as_ref().map(|photo| photo.bytes.as_slice());
                self.drive_and_keep(&way, photo, |robot| robot.drive(&way, order.stops))
            }
            Task::Watched(task) => {
                let drive = |robot: &mut Self| robot.drive_watched(&task, order.stops);
                self.drive_and_keep(&task.way, Some(&task.photo), drive)
            }
            Task::Held(hold) => self.move_held(hold, order.stops),
            Task::Ahead(distance) => self.move_by(distance, 0.0, order.stops),
            Task::Turn(angle) => self.move_by(0.0, angle, order.stops),
            Task::Course(course) => self.drive_course(course, order.stops),
            Task::Connect(_) | Task::Parameters(_) | Task::Calibrate(_) => Ok(()),
        };
        self.stops = order.stops;
        self.end_move(result);
    }

    /// Says how a move has ended, if nobody has yet.
    fn end_move(&mut self, result: Result<(), CliError>) {
        match result {
            Ok(()) => {
                let mut live = lock(&self.live);
                if live.run.active {
                    live.run.end(None, None, String::new());
                }
            }
            Err(error) => {
                self.end_run(None, Some(&error));
                if matches!(error.exit, Exit::Link | Exit::Port) {
                    self.lose(&error);
                }
            }
        }
    }

    /// Waits until the robot has said who it is.
    pub(super) fn greet(&mut self, stops: u64) -> Result<Limits, CliError> {
        let Some(client) = &mut self.client else { return Err(no_link()) };
        let controls = &self.controls;
        let robot = wait_for(
            client,
            || controls.stops() != stops,
            |client, now| {
                client.poll(now)?;
                Ok::<_, LinkError>(client.robot().copied())
            },
        )?;
        let robot = robot.ok_or_else(stopped)?;
        lock(&self.live).robot = Some(robot);
        Ok(robot.limits)
    }

    pub(super) fn end_run(&self, run: Option<&Run>, error: Option<&CliError>) {
        let report = run.map(|run| {
            let mut report = serde_json::json!(run.document());
            if let Some(fields) = report.as_object_mut() {
                let planned = planned_end(&run.legs, &run.limits);
                fields.insert("planned_end".into(), serde_json::json!(planned));
            }
            report
        });
        let lines = run.map(Run::lines).unwrap_or_default();
        let error = error.map(|error| serde_json::json!(error.failure()));
        lock(&self.live).run.end(report, error, lines);
        self.controls.set_paused(false);
    }

    /// Listens until the robot says that it rests, but not for long: what it reports of the end of its legs may come
    /// before its word of where that was.
    pub(super) fn hear_rest(&mut self) {
        let until = Instant::now() + REST_PATIENCE;
        while self.client.is_some() && !lock(&self.live).rests() && Instant::now() < until {
            if self.listen().is_err() {
                return;
            }
        }
    }

    /// Leaves a robot at rest.
    fn say_goodbye(&mut self) {
        let until = Instant::now() + END_PATIENCE;
        while self.client.is_some() && Instant::now() < until {
            if self.listen().is_err() {
                return;
            }
            if self.client.as_ref().is_some_and(|client| client.last_stop().1) {
                return;
            }
        }
    }
}

impl RunStatus {
    /// A drive is asked for.
    pub(super) fn begin(&mut self) {
        *self = Self { revision: self.revision + 1, active: true, ..Self::default() };
    }

    pub(super) fn follow(&mut self, time: f64, at: Point) {
        let last = self.trail.last().copied();
        let is_new = last.is_none_or(|last| last.distance(at) > TRAIL_STEP);
        if is_new && (last.is_none() || time - self.time_of_trail >= TRAIL_INTERVAL) {
            self.trail.push(at);
            self.time_of_trail = time;
        }
        self.time = time;
    }

    fn end(
        &mut self,
        report: Option<serde_json::Value>,
        error: Option<serde_json::Value>,
        lines: String,
    ) {
        self.revision += 1;
        self.active = false;
        self.report = report;
        self.error = error;
        self.lines = lines;
    }
}

pub(super) fn no_link() -> CliError {
    let help = "check its port, cable and battery";
    CliError::new(Exit::Link, "link.none", "there is no link to the robot", help)
}

pub(super) fn stopped() -> CliError {
    CliError::new(
        Exit::Robot,
        "robot.stopped",
        "the robot was stopped",
        "plan again from where it stands",
    )
}
