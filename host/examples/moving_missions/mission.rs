//! One mission: what moves, from where to where, and what becomes of it. Metres, seconds.

use crate::replay::{Replay, Track};
use hil_sim::in_process::InProcess;
use hil_sim::simulation::Simulation;
use std::time::{Duration, Instant};
use wmr::dynamic::{Demand, DynamicArena, Future, Quest};
use wmr::geometry::{Arena, Point, Pose, Rect};
use wmr::legs::{DEFAULT_LIMITS, LegOptions, duration};
use wmr::link::LinkClient;
use wmr::link::drive::{POLL_INTERVAL, Wish};
use wmr::plan::{DRIVE_MARGINS, PlanOptions};
use wmr::protocol::motion::Timing;
use wmr::scene::{Goal, Scene};
use wmr::shape::Shape;
use wmr::simulated::robot_in;
use wmr::track::obstacles::Tracker;
use wmr::track::pose::PoseSigma;
use wmr::watch::source::SourceError;
use wmr::watch::{Look, Route, Router, Sight, WatchOptions, WatchedDrive, Watcher};

const LEGS: LegOptions = LegOptions { timing: Timing::Limits, reverse: true };
const SIGMA: PoseSigma = PoseSigma { position: 0.003, heading: 0.012 };
/// Half the side of a box, and the robot's radius.
const HALF: f64 = 0.05;
const RADIUS: f64 = 0.075;
/// The camera: from frame to frame, how late, with what error, and which share is lost.
const FRAME: f64 = 0.1;
const LATE: f64 = 0.1;
const ERROR: f64 = 0.005;
const LOST: f64 = 0.02;
/// What reaches over the border is shown as far as it is inside, if that is so wide, m.
const SHOWS: f64 = 0.01;
/// A robot that has moved and turned no more within this time rests: corrections of its pose make it twitch.
const WITHIN: f64 = 0.1;
const MOVED: f64 = 1e-3;
const TURNED: f64 = 0.02;
/// An overlap that counts.
const OVERLAP: f64 = 1e-4;
/// How far from its goal a robot has reached it.
const REACHED: f64 = 0.01;
/// The oracle knows all that happens so long.
const KNOWN: f64 = 40.0;
/// Predictions for so long ahead are held against the truth, in so many frames, once a thing was seen so often.
const AHEAD: f64 = 2.0;
const PREDICTED: u32 = 80;
const KNOWN_IN: u32 = 5;

/// What became of a drive.
#[derive(Clone, Debug, Default)]
pub(crate) struct Drive {
    pub(crate) contacts: u32,
    pub(crate) reached: bool,
    pub(crate) time: f64,
    pub(crate) holds: u32,
    pub(crate) replans: u32,
    /// How long the host took from each frame to what it told the robot, ms.
    pub(crate) judging: Vec<f64>,
}

/// What became of a mission.
#[derive(Clone, Debug)]
pub(crate) struct Outcome {
    pub(crate) seed: u64,
    /// By one who sees nothing that moves: its contacts are those of the undelayed drive.
    pub(crate) alone: Drive,
    pub(crate) predicted: Drive,
    pub(crate) replanned: Drive,
    /// In times of the plan without things that move.
    pub(crate) oracle: f64,
    /// How far off each prediction was after two seconds, and how far off it may have been, m.
    pub(crate) predictions: Vec<(f64, f64)>,
}

/// What is to be done.
pub(crate) struct Task<'a> {
    scene: Scene,
    start: Pose,
    goal: Goal,
    began: f64,
    tracks: Vec<&'a Track>,
    seed: u64,
}

impl<'a> Task<'a> {
    /// A mission drawn by its number.
    pub(crate) fn new(replay: &'a Replay, seed: u64) -> Self {
        let mut random = fastrand::Rng::with_seed(seed);
        let (arena, inset) = (replay.arena, RADIUS + 0.05);
        let end = replay.tracks.iter().map(|track| track.span().1).fold(0.0, f64::max);
        loop {
            let began = random.f64() * end;
            let count = random.usize(1..=4);
            // Those that are on the floor during a usual mission.
            let mut near: Vec<&Track> = replay
                .tracks
                .iter()
                .filter(|track| track.span().0 < began + 4.0 && track.span().1 > began + 1.0)
                .collect();
            random.shuffle(&mut near);
            let mut place = || {
                let within = |size: f64, share: f64| inset + share * (size - 2.0 * inset);
                Point::new(within(arena.width, random.f64()), within(arena.height, random.f64()))
            };
            let (from, to) = (place(), place());
            let heading = random.f64() * std::f64::consts::TAU - std::f64::consts::PI;
            let is_near = |track: &&Track| track.at(began).distance(from) < 0.25;
            if near.len() < count || from.distance(to) < 1.0 || near.iter().take(count).any(is_near)
            {
                continue;
            }
            near.truncate(count);
            return Self {
                scene: Scene { robot_radius: RADIUS, ..Scene::new(arena.width, arena.height) },
                start: Pose { position: from, heading },
                goal: Goal { position: to, heading: None },
                began,
                tracks: near,
                seed,
            };
        }
    }

    /// Drives it in all ways.
    pub(crate) fn run(&self) -> Outcome {
        Outcome {
            seed: self.seed,
            alone: self.alone(),
            predicted: self.foreseeing(),
            replanned: self.drive(true, false),
            oracle: self.plan_knowing_all(),
            predictions: self.predictions(),
        }
    }

    /// Drives it without seeing what moves.
    pub(crate) fn alone(&self) -> Drive {
        self.drive(false, true)
    }

    /// Drives it with predictions of what moves.
    pub(crate) fn foreseeing(&self) -> Drive {
        self.drive(true, true)
    }

    fn router(&self) -> Router {
        Router {
            scene: self.scene.clone(),
            goal: self.goal,
            plan: PlanOptions::default(),
            margins: DRIVE_MARGINS.to_vec(),
            legs: LEGS,
        }
    }

    fn route(&self) -> Route {
        let route = self.router().route(&[], self.start, (0.0, false), &DEFAULT_LIMITS);
        route.unwrap_or(Route { legs: Vec::new(), length: 0.0, margin: 0.0 })
    }

    fn drive(&self, sees: bool, foresees: bool) -> Drive {
        let mut client = LinkClient::new(robot_in(&self.scene, self.start, self.seed), 1);
        let mut camera = Camera::new(self, sees);
        let options = WatchOptions {
            router: self.router(),
            sigma: SIGMA,
            patience: Duration::from_secs(30),
            foresees,
        };
        let shown = camera.shown(0.0);
        let mut drive = WatchedDrive::new(options, DEFAULT_LIMITS, self.start, self.route(), shown);
        let mut judging = Vec::new();
        let result = loop {
            let (frames, began) = (camera.frames, Instant::now());
            match drive.step(&mut client, &mut camera, Wish::Drive, &mut |_, _| ()) {
                Ok(None) => {}
                end => break end,
            }
            if camera.frames > frames {
                judging.push(1000.0 * began.elapsed().as_secs_f64());
            }
            if client.port_mut().wait(POLL_INTERVAL).is_err() {
                break Ok(None);
            }
        };
        let end = Pose::from(client.port_mut().truth().pose).position;
        let counts = drive.statistics();
        Drive {
            contacts: camera.contacts,
            reached: matches!(result, Ok(Some(_))) && end.distance(self.goal.position) < REACHED,
            time: camera.rests_since,
            holds: counts.waits,
            replans: counts.replans,
            judging,
        }
    }

    /// The time of the best plan for one who knows how everything will move.
    fn plan_knowing_all(&self) -> f64 {
        let futures: Vec<Future> = self.tracks.iter().map(|track| self.truth(track)).collect();
        let demand = Demand { keep: RADIUS + DRIVE_MARGINS[0], sure: KNOWN };
        let quest = Quest {
            from: self.start,
            start: 0.0,
            goal: self.goal,
            within: f64::INFINITY,
            way: &[],
            futures: &futures,
        };
        let plan = DynamicArena::new(&self.scene, DEFAULT_LIMITS, LEGS, demand).plan(&quest);
        let alone = duration(&self.route().legs, &DEFAULT_LIMITS);
        if plan.waits_for.is_none() { plan.arrival / alone } else { f64::INFINITY }
    }

    /// Holds predictions of what moves against the truth.
    fn predictions(&self) -> Vec<(f64, f64)> {
        let mut camera = Camera::new(self, true);
        let mut tracker = Tracker::default();
        let mut found = Vec::new();
        for frame in 0..PREDICTED {
            let time = FRAME * f64::from(frame);
            if camera.random.f64() < LOST {
                continue;
            }
            tracker.update(Duration::from_secs_f64(time), &camera.shown(time));
            for track in tracker.tracks().iter().filter(|track| track.frames() >= KNOWN_IN) {
                let off = |other: &&&Track| {
                    other.at(self.began + time).distance(track.footprint().bounds().centre())
                };
                let nearest = self.tracks.iter().min_by(|a, b| off(a).total_cmp(&off(b)));
                let later = self.began + time + AHEAD;
                let Some(truth) = nearest.filter(|truth| later <= truth.span().1) else { continue };
                let set = track.predicted(Duration::from_secs_f64(AHEAD));
                found.push((set.footprint.bounds().centre().distance(truth.at(later)), set.reach));
            }
        }
        found
    }

    /// How a thing will really move.
    fn truth(&self, track: &Track) -> Future {
        let first = track.at(self.began);
        let moves = (0..(KNOWN / 0.1) as u32).map(|layer| {
            let there = track.at(self.began + 0.1 * f64::from(layer));
            ([there.x - first.x, there.y - first.y], 0.0)
        });
        Future::new(footprint(first), moves)
    }
}

fn bounds(at: Point) -> Rect {
    Rect::new(at.x - HALF, at.y - HALF, at.x + HALF, at.y + HALF)
}

fn footprint(at: Point) -> Shape {
    bounds(at).into()
}

/// A camera over the floor, which also notes what really happens.
struct Camera<'a> {
    tracks: Vec<&'a Track>,
    /// Whether it shows what moves.
    sees: bool,
    began: f64,
    random: fastrand::Rng,
    frames: u32,
    arena: Arena,
    poses: Vec<(f64, Pose)>,
    touches: bool,
    contacts: u32,
    rests_since: f64,
}

impl<'a> Camera<'a> {
    fn new(task: &Task<'a>, sees: bool) -> Self {
        Self {
            tracks: task.tracks.clone(),
            sees,
            began: task.began,
            random: fastrand::Rng::with_seed(task.seed ^ 0x5eed),
            frames: 0,
            arena: task.scene.arena,
            poses: Vec::new(),
            touches: false,
            contacts: 0,
            rests_since: 0.0,
        }
    }

    fn noise(&mut self, sigma: f64) -> f64 {
        sigma * ((0..12).map(|_| self.random.f64()).sum::<f64>() - 6.0)
    }

    /// What a frame shows.
    fn shown(&mut self, time: f64) -> Vec<wmr::scene::Obstacle> {
        let Arena { width, height } = self.arena;
        let there: Vec<Point> =
            self.tracks.iter().map(|track| track.at(self.began + time)).collect();
        let seen = |at: Point| {
            let at = Point::new(at.x + self.noise(ERROR), at.y + self.noise(ERROR));
            let Rect { x0, y0, x1, y1 } = bounds(at);
            let seen = Rect::new(x0.max(0.0), y0.max(0.0), x1.min(width), y1.min(height));
            let shows = self.sees && seen.x1 - seen.x0 > SHOWS && seen.y1 - seen.y0 > SHOWS;
            shows.then(|| seen.into())
        };
        there.into_iter().filter_map(seen).collect()
    }

    /// Notes where the robot is, and whether it touches something while it moves.
    fn note(&mut self, now: f64, pose: Pose) {
        let before = self.poses.iter().rev().find(|(at, _)| *at <= now - WITHIN);
        let moves = before.is_some_and(|(_, before)| {
            let turned = wmr::geometry::wrap_angle(pose.heading - before.heading).abs();
            pose.position.distance(before.position) > MOVED || turned > TURNED
        });
        let touches = self.tracks.iter().any(|track| {
            footprint(track.at(self.began + now)).distance(pose.position) < RADIUS - OVERLAP
        });
        self.contacts += u32::from(touches && moves && !self.touches);
        self.touches = touches && (moves || self.touches);
        if moves {
            self.rests_since = now;
        }
        self.poses.push((now, pose));
    }
}

impl Watcher<Simulation<InProcess>> for Camera<'_> {
    fn expect(&mut self, _: Duration, _: Pose) {}

    fn look(
        &mut self,
        port: &mut Simulation<InProcess>,
        now: Duration,
    ) -> Result<Look, SourceError> {
        let now = now.as_secs_f64();
        self.note(now, port.truth().pose.into());
        let exposed = FRAME * f64::from(self.frames);
        if now < exposed + LATE {
            return Ok(Look::Nothing);
        }
        self.frames += 1;
        let pose = self.poses.iter().rev().find(|(at, _)| *at <= exposed).map(|(_, pose)| *pose);
        let Some(pose) = pose.filter(|_| self.random.f64() >= LOST) else {
            return Ok(Look::Nothing);
        };
        let robot = Pose::new(
            pose.position.x + self.noise(SIGMA.position),
            pose.position.y + self.noise(SIGMA.position),
            pose.heading + self.noise(SIGMA.heading),
        );
        Ok(Look::Seen(Sight {
            exposed: Duration::from_secs_f64(exposed),
            robot: Some(robot),
            obstacles: self.shown(exposed),
            relocated: false,
        }))
    }
}
