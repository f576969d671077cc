//! The loop: a mission stepped to its end while a camera watches.

mod arrival;
mod judge;
mod moving;
mod outcome;
mod pose;

pub use outcome::{Happening, WatchError, WatchOptions, WatchStatistics};

use super::event::{Reason, WatchEvent};
use super::floor::{Floor, Hazard};
use super::route::{Route, goals};
use super::{Look, Watcher};
use crate::geometry::{Point, Pose};
use crate::legs::to_wire;
use crate::link::drive::{DriveError, DriveEvent, Driver, POLL_INTERVAL, TimedPort, Wish};
use crate::link::mission::{Mission, MissionEvent};
use crate::link::{LinkClient, LinkError};
use crate::scene::Obstacle;
use crate::track::pose::{Calibration, Estimate, PoseFilter};
use protocol::message::LegResult;
use protocol::motion::{Leg, Limits};
use std::time::Duration;

/// Without a frame the way is judged this often.
const JUDGE_INTERVAL: Duration = Duration::from_millis(100);
/// Trouble with frames is told this often at most.
const TROUBLE_INTERVAL: Duration = Duration::from_secs(2);
/// A robot sets out once it knows of all that is so near, m, whether it moves; or after so long.
const NEAR: f64 = 0.5;
const LOOKED: Duration = Duration::from_secs(1);

#[derive(Clone, Debug)]
struct Hold {
    since: Duration,
    reason: Reason,
    /// The legs that the robot has are of no use any more.
    replans: bool,
}

/// The legs that the robot drives, and what they were planned for.
#[derive(Clone, Debug)]
struct Course {
    obstacles: Vec<Obstacle>,
    margin: f64,
    slow: bool,
}

/// A drive that a camera watches.
#[derive(Debug)]
pub struct WatchedDrive {
    options: WatchOptions,
    limits: Limits,
    start: Pose,
    mission: Mission,
    driver: Driver,
    filter: PoseFilter,
    floor: Floor,
    course: Course,
    /// What the legs that are on their way were planned for.
    next_course: Option<Course>,
    hold: Option<Hold>,
    /// A person wants the robot to rest on its path.
    is_paused: bool,
    /// Whether the filter knows where the robot began.
    is_placed: bool,
    /// The time of the last telemetry that the filter has.
    filter_time: Duration,
    /// Since when the robot has the legs that it drives.
    legs_since: Duration,
    /// A sight whose exposure telemetry has not reached yet.
    pending: Option<(Duration, Pose)>,
    /// The robot's clock when the leg under way began, ticks.
    leg_began: u32,
    judged: Duration,
    /// When the drive began, and whether the robot has looked around since.
    looks_since: Option<Duration>,
    has_looked: bool,
    troubled: Option<Duration>,
    ended: Option<(Duration, u32)>,
    touch_ups: u32,
    ending: Option<WatchError>,
    events: Vec<WatchEvent>,
    legs: Vec<Leg>,
    results: Vec<LegResult>,
    statistics: WatchStatistics,
}

impl WatchedDrive {
    /// The drive along `route`, which was planned around `obstacles` and begins at `start`.
    pub fn new(
        options: WatchOptions,
        limits: Limits,
        start: Pose,
        route: Route,
        obstacles: Vec<Obstacle>,
    ) -> Self {
        let mut floor = if options.foresees { Floor::default() } else { Floor::still() };
        floor.update(Duration::ZERO, &obstacles, (None, 0.0));
        Self {
            mission: Mission::new(route.legs, to_wire(start)),
            filter: PoseFilter::new(&limits),
            course: Course { obstacles, margin: route.margin, slow: false },
            options,
            limits,
            start,
            driver: Driver::default(),
            floor,
            next_course: None,
            hold: None,
            is_paused: false,
            is_placed: false,
            filter_time: Duration::ZERO,
            legs_since: Duration::ZERO,
            pending: None,
            leg_began: 0,
            judged: Duration::ZERO,
            looks_since: None,
            has_looked: false,
            troubled: None,
            ended: None,
            touch_ups: 0,
            ending: None,
            events: Vec::new(),
            legs: Vec::new(),
            results: Vec::new(),
            statistics: WatchStatistics::default(),
        }
    }

    /// The legs that were driven to their ends, counted from 0.
    pub fn legs(&self) -> &[Leg] {
        &self.legs
    }

    /// How they ended.
    pub fn results(&self) -> &[LegResult] {
        &self.results
    }

    /// What was counted.
    pub fn statistics(&self) -> WatchStatistics {
        self.statistics
    }

    /// What the camera has taught of the base.
    pub fn calibration(&self) -> Option<Calibration> {
        self.filter.calibration()
    }

    /// The mission as it is.
    pub fn mission(&self) -> &Mission {
        &self.mission
    }

    /// Where the robot is at a time, by wheels and camera.
    pub fn estimate(&self, time: Duration) -> Option<Estimate> {
        self.filter.estimate(time)
    }

    /// Why the robot is held; `None` while it drives.
    pub fn held(&self) -> Option<&Reason> {
        self.hold.as_ref().map(|hold| &hold.reason)
    }

    /// The goals of the legs still to drive.
    pub fn way(&self) -> Vec<Point> {
        let next = usize::from(self.mission.progress().next);
        goals(self.mission.legs().get(next..).unwrap_or_default())
    }

    /// What stands on the floor.
    pub fn hazards(&self) -> Vec<Hazard> {
        self.floor.hazards()
    }

    /// Drives to the goal; where the robot then is. `stop_asked` is read at each step.
    ///
    /// # Errors
    /// [`WatchError`]; the robot has stopped then, or does so by itself when the link is silent.
    pub fn run<P: TimedPort>(
        &mut self,
        client: &mut LinkClient<P>,
        watcher: &mut impl Watcher<P>,
        stop_asked: impl Fn() -> bool,
        mut on_event: impl FnMut(Duration, Happening),
    ) -> Result<Pose, WatchError> {
        let wish = || if stop_asked() { Wish::Stop } else { Wish::Drive };
        loop {
            if let Some(pose) = self.step(client, watcher, wish(), &mut on_event)? {
                return Ok(pose);
            }
            client.port_mut().wait(POLL_INTERVAL).map_err(LinkError::from)?;
        }
    }

    /// One step at the port's time, as somebody wishes: where the robot is once it has reached the goal. Between
    /// two steps lies a wait of [`POLL_INTERVAL`]. A robot that is paused rests on its path and is looked at, but
    /// nothing is decided before it may go on.
    ///
    /// # Errors
    /// [`WatchError`]; the robot has stopped then, or does so by itself when the link is silent.
    pub fn step<P: TimedPort>(
        &mut self,
        client: &mut LinkClient<P>,
        watcher: &mut impl Watcher<P>,
        wish: Wish,
        on_event: &mut impl FnMut(Duration, Happening),
    ) -> Result<Option<Pose>, WatchError> {
        let now = client.port_mut().now();
        self.pause(wish == Wish::Pause, now);
        self.look_around(now);
        let mut heard = Vec::new();
        let driven = self.drive_on(client, now, wish == Wish::Stop, &mut heard);
        for event in heard {
            self.hear(event, client);
            on_event(now, Happening::Drive(event));
        }
        let result = driven.and_then(|()| {
            self.look(client, watcher, now);
            self.judge(client, now);
            self.finish(client, now)
        });
        let happened = std::mem::take(&mut self.events);
        happened.into_iter().for_each(|event| on_event(now, Happening::Watch(event)));
        result
    }

    /// Whoever waits because a person wants it loses no patience, and looks again before it goes on.
    fn pause(&mut self, is_paused: bool, now: Duration) {
        self.is_paused = is_paused;
        if is_paused {
            self.judged = Duration::ZERO;
            self.hold.iter_mut().for_each(|hold| hold.since = now);
        }
    }

    /// Notes whether what is near was seen often enough to set out.
    fn look_around(&mut self, now: Duration) {
        let since = *self.looks_since.get_or_insert(now);
        let here = self.start.position;
        let is_open =
            |hazard: &Hazard| !hazard.is_known && hazard.obstacle.footprint.distance(here) < NEAR;
        self.has_looked =
            self.has_looked || now > since + LOOKED || !self.floor.hazards().iter().any(is_open);
    }

    /// One step of the mission, or of a link on which nothing is driven.
    fn drive_on<P: TimedPort>(
        &mut self,
        client: &mut LinkClient<P>,
        now: Duration,
        stop_asked: bool,
        heard: &mut Vec<DriveEvent>,
    ) -> Result<(), WatchError> {
        if self.ended.is_some() {
            let before = client.telemetry().map(|last| last.ticks);
            client.poll(now)?;
            if stop_asked {
                return Err(DriveError::Stopped.into());
            }
            let new = client.telemetry().filter(|last| Some(last.ticks) != before);
            heard.extend(new.map(|last| DriveEvent::Mission(MissionEvent::Telemetry(*last))));
            return Ok(());
        }
        let wish = if stop_asked || self.ending.is_some() {
            Wish::Stop
        } else if self.hold.is_some() || self.is_paused || !self.has_looked {
            Wish::Pause
        } else {
            Wish::Drive
        };
        let mut collect = |event, _: &Mission| heard.push(event);
        let arrived = self.driver.step(client, &mut self.mission, &|| wish, &mut collect);
        match arrived {
            Ok(Some(_)) => self.ended = Some((now, 0)),
            Ok(None) => {}
            Err(DriveError::Stopped) if !stop_asked => {
                return Err(self.ending.take().unwrap_or(DriveError::Stopped.into()));
            }
            Err(error) => return Err(error.into()),
        }
        Ok(())
    }

    fn hear<P: TimedPort>(&mut self, event: DriveEvent, client: &LinkClient<P>) {
        let DriveEvent::Mission(event) = event else { return };
        match event {
            MissionEvent::Accepted { .. } => self.begin_legs(client),
            MissionEvent::Telemetry(telemetry) => self.hear_telemetry(&telemetry, client),
            MissionEvent::LegDone(result) => {
                self.leg_began = client.telemetry().map_or(self.leg_began, |last| last.ticks);
                let index = self.legs.len() as u16;
                if let Some(leg) = self.mission.legs().get(usize::from(result.index)) {
                    self.legs.push(Leg { index, ..*leg });
                    self.results.push(LegResult { index, ..result });
                }
            }
            MissionEvent::Replaced { .. } => {
                self.statistics.replans += 1;
                if let Some(course) = self.next_course.take() {
                    self.course = course;
                }
            }
            MissionEvent::NotReplaced(refusal) => {
                self.next_course = None;
                self.events.push(WatchEvent::NotTaken(refusal));
                // What is driven now was not found free: look again at once.
                self.judged = Duration::ZERO;
            }
            MissionEvent::PoseRefused(_) => {
                self.statistics.refused += 1;
                self.filter.refused();
            }
            MissionEvent::Connected(_) | MissionEvent::Done(_) => {}
        }
    }

    /// Takes in what the camera has.
    fn look<P: TimedPort>(
        &mut self,
        client: &mut LinkClient<P>,
        watcher: &mut impl Watcher<P>,
        now: Duration,
    ) {
        if let Some(estimate) = self.filter.estimate(now) {
            watcher.expect(now, estimate.pose);
        } else {
            watcher.expect(now, self.start);
        }
        match watcher.look(client.port_mut(), now) {
            Ok(Look::Nothing) => {}
            Ok(Look::Seen(sight)) => {
                self.statistics.frames += 1;
                self.statistics.used += 1;
                if sight.relocated {
                    self.events.push(WatchEvent::Relocated);
                }
                let radius = self.options.router.scene.robot_radius;
                let robot = sight
                    .robot
                    .or_else(|| self.estimate(sight.exposed).map(|estimate| estimate.pose));
                let at = robot.map(|pose| pose.position);
                self.floor.update(sight.exposed, &sight.obstacles, (at, radius));
                self.pending = sight.robot.map(|pose| (sight.exposed, pose)).or(self.pending);
                self.judged = Duration::ZERO;
            }
            Ok(Look::Failed(why)) => {
                self.statistics.frames += 1;
                self.trouble(now, why);
            }
            Err(error) => {
                self.ending.get_or_insert(WatchError::Source(error));
            }
        }
        self.take_pose(client);
    }

    fn trouble(&mut self, now: Duration, why: String) {
        if self.troubled.is_none_or(|last| now >= last + TROUBLE_INTERVAL) {
            self.troubled = Some(now);
            self.events.push(WatchEvent::Trouble(why));
        }
    }
}

#[cfg(test)]
#[cfg(feature = "simulation")]
mod on_a_simulated_robot;
