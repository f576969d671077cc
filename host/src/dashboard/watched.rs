//! A drive that the camera watches: the first look, and the drive on the robot's thread.
//!
//! It begins as `wmr drive --watch` does: the newest frame is the photo, in which the robot's place and what stands
//! around it are seen, and the way to the goal on the desk is planned anew in it. What a person has corrected of
//! the photo holds for every frame of a real camera; under a simulated one stands what is on the desk, corrections
//! and all. Metres and radians in the arena frame.

use super::camera::Shot;
use super::corrections::Corrections;
use super::desk::{Desk, SILENT};
use super::driving::{ends, in_words};
use super::error::Failure;
use super::live::{Live, RunStatus};
use super::reading::Reading;
use super::robot::{RobotThread, stopped};
use super::{Dashboard, lock};
use crate::cli::args::{VisionArgs, WayArgs};
use crate::cli::endpoint::SimulatedRobot;
use crate::cli::error::CliError;
use crate::cli::input::{self, Sight};
use crate::cli::run::{Run, RunClock};
use crate::cli::watch::{Manner, first_pose, watched};
use crate::cli::way::{self, MarginRule, PlannedWay};
use axum::http::StatusCode;
use serde_json::json;
use std::sync::{Arc, Mutex};
use std::time::{Duration, Instant};
use wmr::document::{EventDocument, ViewDocument, WatchDocument};
use wmr::geometry::{Arena, Point, Pose};
use wmr::link::LinkError;
use wmr::link::drive::{DriveEvent, POLL_INTERVAL, TimedPort, Wish};
use wmr::link::mission::MissionEvent;
use wmr::scene::{Goal, Obstacle, Scene};
use wmr::track::pose::PoseSigma;
use wmr::vision::{self, Camera};
use wmr::watch::{Eye, Happening, WatchError, WatchedDrive};

/// The robot waits for a way so long, as on the command line.
const PATIENCE: Duration = Duration::from_secs(60);
/// A camera that is on sends a frame within so long.
const FIRST_FRAME: Duration = Duration::from_secs(5);
/// While there is none, it is looked for so often.
const FRAME_INTERVAL: Duration = Duration::from_millis(20);
/// Pages get what is known so often.
const VIEW_INTERVAL: Duration = Duration::from_millis(50);
/// More things are not drawn, and more events not written down.
const MOST_THINGS: usize = 100;
const MOST_EVENTS: usize = 1000;

/// What the first look at the newest frame needs, taken from the desk.
pub(super) struct FirstLook {
    reading: Reading,
    /// Whether the camera is simulated: it is known by its lens, and shows what stands on the desk.
    lens: Option<Camera>,
    arena: Arena,
    radius: f64,
    corners: Option<[[f64; 2]; 4]>,
    /// Where the robot stands by the plan.
    start: Option<Pose>,
    goal: Option<Goal>,
    /// Where a map has the arena's corner.
    origin: Option<Point>,
    corrections: Corrections,
    way: WayArgs,
}

/// A drive that is ready to begin.
#[derive(Debug)]
pub(super) struct WatchedTask {
    pub(super) way: PlannedWay,
    /// The frame that it begins with, as a picture file.
    pub(super) photo: Vec<u8>,
    eye: Eye,
    arena: Arena,
    obstacles: Vec<Obstacle>,
    corrections: Corrections,
    manner: Manner,
}

/// The newest frame of the camera, as soon as there is one that shows the floor as it is wanted.
pub(super) async fn newest_frame(dashboard: &Dashboard) -> Result<Arc<Shot>, Failure> {
    let began = tokio::time::Instant::now();
    loop {
        if let Some(shot) = dashboard.camera.newest() {
            return Ok(shot);
        }
        if began.elapsed() > FIRST_FRAME {
            let help = "look whether the camera is on and sends, or switch it off";
            let status = StatusCode::SERVICE_UNAVAILABLE;
            return Err(Failure::new(status, "camera.silent", "the camera sends no picture", help));
        }
        tokio::time::sleep(FRAME_INTERVAL).await;
    }
}

impl FirstLook {
    /// What the desk says of a frame of a camera, by its lens if it is simulated.
    pub(super) fn new(desk: &Desk, lens: Option<Camera>, shot: &Shot) -> Result<Self, Failure> {
        let Some((scene, way)) = desk.planned() else {
            let help = "choose a start and a goal";
            return Err(Failure::missing("plan.none", "there is no plan to drive", help));
        };
        let is_simulated = lens.is_some();
        Ok(Self {
            reading: if is_simulated { Reading::default() } else { desk.reading() },
            arena: scene.arena,
            radius: scene.robot_radius,
            // Corners that were put by hand are those of this camera if its frames are like the photo.
            corners: desk.corners_in(shot.size).filter(|_| !is_simulated),
            start: scene.start,
            goal: scene.goal,
            origin: scene.origin,
            corrections: if is_simulated { Corrections::default() } else { desk.corrections() },
            way: WayArgs { start: None, goal: None, ..way },
            lens,
        })
    }

    /// How the frame is to be looked at.
    fn vision_args(&self) -> Result<VisionArgs, Failure> {
        let args = self.reading.vision_args()?;
        // Where a person has put the corners they are.
        let tags = args.tags.filter(|_| self.corners.is_none());
        Ok(VisionArgs { arena: Some(self.arena), corners: self.corners, tags, ..args })
    }

    /// Looks at the frame, and plans in it.
    pub(super) fn see(self, shot: &Shot) -> Result<WatchedTask, Failure> {
        let args = self.vision_args()?;
        let start =
            self.start.map(|pose| Goal { position: pose.position, heading: Some(pose.heading) });
        let sight = Sight { radius: Some(self.radius), resolution: 1.0, keep_steps: false, start };
        let camera = self.lens.clone().or(self.reading.camera());
        let options = input::detect_options(&args, sight, (camera, None))?;
        let detection =
            vision::detect(&shot.photo, self.arena, &options).map_err(CliError::from)?;
        let mut scene = Scene::from_detection(&detection, self.arena, self.radius);
        scene.obstacles = self.corrections.applied_to(&scene.obstacles);
        scene.start = scene.start.or(self.start);
        scene.goal = self.goal.or(scene.goal);
        scene.origin = self.origin;
        let planner = way::planner(self.way.planner);
        let way = way::plan_way(&scene, planner, &self.way, MarginRule::ForDriving, SILENT)?;
        let sigma = if args.robot_tag.is_some() { PoseSigma::TAGGED } else { PoseSigma::MARKED };
        Ok(WatchedTask {
            way,
            photo: shot.bytes.to_vec(),
            eye: Eye::new((*shot.photo).clone(), self.arena, options, &detection),
            arena: self.arena,
            obstacles: scene.obstacles,
            corrections: self.corrections,
            manner: Manner { margin: self.way.margin, sigma, patience: PATIENCE },
        })
    }
}

impl RobotThread {
    /// Drives to its end, or to where it is cut short.
    pub(super) fn drive_watched(
        &mut self,
        task: &WatchedTask,
        stops: u64,
    ) -> Result<(Run, Option<CliError>), CliError> {
        let way = &task.way;
        let start = first_pose(way);
        self.suit(SimulatedRobot::for_timing(way.legs.timing))?;
        let limits = self.greet(stops)?;
        let mut run = Run::new(Vec::new(), limits, start);
        run.origin = way::origin(&way.file.scene);
        run.goal = way.file.waypoints.last().copied();
        let obstacles = task.obstacles.clone();
        let mut drive = watched(way, &task.manner, limits, obstacles, SILENT);
        let result = self.follow_watched(&mut drive, &mut run, task, stops);
        (run.legs, run.results) = (drive.legs().to_vec(), drive.results().to_vec());
        run.watch = Some(WatchDocument { counts: drive.statistics(), events: self.told() });
        if let Some(client) = &mut self.client {
            run.truth = client.port_mut().truth();
            run.link = client.statistics();
        }
        match result {
            Ok(pose) => {
                run.end = pose;
                Ok((run, None))
            }
            Err(error) => Ok((run, Some(error))),
        }
    }

    fn told(&self) -> Vec<EventDocument> {
        lock(&self.live).run.told.clone()
    }

    /// Steps the drive to its end, and shows how it goes.
    fn follow_watched(
        &mut self,
        drive: &mut WatchedDrive,
        run: &mut Run,
        task: &WatchedTask,
        stops: u64,
    ) -> Result<Pose, CliError> {
        let speed = if self.is_simulated() { self.settings.speed } else { 1.0 };
        let Some(client) = &mut self.client else { return Err(stopped()) };
        if drive.mission().legs().is_empty() {
            return Ok(first_pose(&task.way));
        }
        let (live, controls, camera) = (&self.live, &self.controls, &self.settings.camera);
        let corrections = task.corrections.clone();
        let mut watcher = camera.watch(task.eye.clone(), task.arena, corrections, speed);
        let began = client.port_mut().now();
        let mut notes = Notes { run, live, clock: RunClock::default(), began };
        let mut shown = None::<Instant>;
        loop {
            let wish = match (controls.stops() != stops, controls.is_paused()) {
                (true, _) => Wish::Stop,
                (false, true) => Wish::Pause,
                (false, false) => Wish::Drive,
            };
            if camera.is_behind() {
                // No time passes for a robot whose world waits: its last word grows no older.
                lock(live).keep_word();
            }
            if wish == Wish::Stop {
                watcher.hurry();
            }
            let mut hear = |at, what| notes.hear(at, what);
            let arrived = drive.step(client, &mut watcher, wish, &mut hear).map_err(ended)?;
            if shown.is_none_or(|last| last.elapsed() >= VIEW_INTERVAL) {
                shown = Some(Instant::now());
                show(drive, client.port_mut().now(), &mut lock(live).run);
            }
            if let Some(pose) = arrived {
                return Ok(pose);
            }
            client.port_mut().wait(POLL_INTERVAL).map_err(LinkError::from)?;
        }
    }
}

/// Writes down what happens.
struct Notes<'a> {
    run: &'a mut Run,
    live: &'a Mutex<Live>,
    clock: RunClock,
    /// When the drive began, by the port's clock.
    began: Duration,
}

impl Notes<'_> {
    fn hear(&mut self, at: Duration, what: Happening) {
        match what {
            Happening::Drive(DriveEvent::Mission(event)) => {
                self.run.record(event, &mut self.clock);
                if let MissionEvent::Telemetry(telemetry) = event {
                    let time = self.run.samples.last().map(|sample| sample.time);
                    lock(self.live).hear_on_way(telemetry, time);
                }
            }
            Happening::Drive(_) => {}
            Happening::Watch(event) => {
                let told = EventDocument::new(at.saturating_sub(self.began), &event);
                let mut live = lock(self.live);
                if live.run.told.len() < MOST_EVENTS {
                    live.run.told.push(told);
                }
            }
        }
    }
}

/// Puts down what a page draws.
fn show(drive: &WatchedDrive, now: Duration, run: &mut RunStatus) {
    let progress = drive.mission().progress();
    run.legs = drive.mission().legs().iter().map(ends).collect();
    run.leg = usize::from(progress.next);
    run.view = ViewDocument::new(drive, now).map(|mut view| {
        view.things.truncate(MOST_THINGS);
        json!(view)
    });
}

fn ended(error: WatchError) -> CliError {
    match error {
        WatchError::Drive(error) => in_words(error),
        error => error.into(),
    }
}
