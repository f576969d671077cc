//! Random arenas with shapes of all kinds, planned and driven on bases that are slightly off.
//!
//! | envelope | lengths off by | encoders | wheels | camera |
//! |---|---|---|---|---|
//! | A | 0.05 % | ± 1 count | grip | none |
//! | B | 0.1 % | ± 1 count | one slips by 20 % for 0.2 s on each leg | 5 Hz, 100 ms late, σ 2 mm and 0.3° |
//!
//! In B the way keeps away from shapes by what a slip can push the robot aside before the camera has said so, and a
//! robot that the camera sees beside its goal at the end drives there, as under `wmr drive --watch`.
//!
//! Shapes are not solid here, so that every overlap of more than 0.1 mm counts.

use crate::POLL;
use hil_sim::base::{BaseParameters, EncoderFault, Faults, TruePose, WheeledBase};
use hil_sim::in_process::InProcess;
use hil_sim::noise::normal;
use hil_sim::simulation::Simulation;
use hil_sim::world::World;
use protocol::message::{CameraPose, Command};
use protocol::motion::{Pose, Timing};
use std::collections::{BTreeMap, VecDeque};
use std::f64::consts::TAU;
use std::time::Duration;
use wmr::geometry::{Point, Rect};
use wmr::legs::{DEFAULT_LIMITS, LegOptions, to_legs};
use wmr::link::LinkClient;
use wmr::link::mission::{Mission, MissionEvent};
use wmr::plan::{PlanOptions, plan};
use wmr::scene::Scene;
use wmr::shape::{Circle, Polygon, Shape};

/// Kept free beside the robot, as `wmr drive` does, m.
const MARGIN: f64 = 0.01;
/// A slip: this share of a wheel's way is lost for so long, s.
const SLIP: f64 = 0.2;
const SLIP_SECONDS: f64 = 0.2;
/// Between two pictures, and from a picture's exposure until the robot knows of it.
const FRAME: Duration = Duration::from_millis(200);
const LATENCY: Duration = Duration::from_millis(100);
/// A robot that has ended is looked at in so many pictures; seen farther from its goal than this, m, it drives
/// there, so often at most.
const LAST_SIGHTS: usize = 4;
const TOUCH_UP: f64 = 0.004;
const MOST_TOUCH_UPS: u32 = 3;
/// Farther from the goal is missed, m.
const REACHED: f64 = 0.01;
/// A mission that is still under way then has not ended.
const LONGEST: Duration = Duration::from_secs(120);

/// How far reality is off.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Envelope {
    /// Small errors, and nobody who corrects them.
    A,
    /// Twice as large, slipping wheels, and a camera.
    B,
}

impl Envelope {
    /// What the way keeps free beside the robot, m.
    ///
    /// A wheel that slips loses l = s V d and turns the robot by l / b, on the average by half of that while it
    /// slips; in that direction it drives on until it hears of the first picture after the slip:
    ///
    /// ```text
    /// margin = MARGIN + V (d / 2 + T + L) s V d / b
    /// ```
    ///
    /// | symbol | meaning | unit |
    /// |---|---|---|
    /// | s, d | share and duration of a slip | 1, s |
    /// | V, b | speed limit, track | m/s, m |
    /// | T, L | between two pictures, latency | s |
    pub fn margin(self) -> f64 {
        if self == Self::A {
            return MARGIN;
        }
        let (speed, track) = (f64::from(DEFAULT_LIMITS.speed.0), f64::from(DEFAULT_LIMITS.track.0));
        let turned = SLIP * speed * SLIP_SECONDS / track;
        let blind = SLIP_SECONDS / 2.0 + FRAME.as_secs_f64() + LATENCY.as_secs_f64();
        MARGIN + speed * blind * turned
    }
}

/// What became of many missions.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Tally {
    /// Missions driven.
    pub driven: u32,
    /// That ended within 10 mm of the goal.
    pub reached: u32,
    /// That touched something.
    pub collided: u32,
    /// The ends of the others, by name.
    pub others: BTreeMap<String, u32>,
    /// Arenas drawn in which no way leads to the goal, or start or goal has no room.
    pub without_way: u32,
    /// How far from the goal the missions ended, m.
    pub errors: Vec<f64>,
    /// The smallest gap beside the robot, m.
    pub least_gap: f64,
}

/// Plans and drives `missions` missions, those of the seeds from `first` on.
pub fn run(envelope: Envelope, first: u64, missions: u32) -> Tally {
    let mut tally = Tally { least_gap: f64::INFINITY, ..Tally::default() };
    for seed in first.. {
        if tally.driven == missions {
            break;
        }
        let mut random = fastrand::Rng::with_seed(seed);
        match drawn_way(&mut random, envelope.margin()) {
            None => tally.without_way += 1,
            Some((scene, way)) => tally.add(&drive(&scene, &way, envelope, seed, &mut random)),
        }
    }
    tally.errors.sort_by(f64::total_cmp);
    tally
}

impl Tally {
    fn add(&mut self, end: &End) {
        self.driven += 1;
        self.collided += u32::from(end.collided);
        self.least_gap = self.least_gap.min(end.gap);
        self.errors.extend(end.error);
        match (&end.failure, end.error) {
            (None, Some(error)) if error <= REACHED => self.reached += 1,
            (None, _) => *self.others.entry("missed".into()).or_default() += 1,
            (Some(failure), _) => *self.others.entry(failure.clone()).or_default() += 1,
        }
    }
}

struct End {
    error: Option<f64>,
    failure: Option<String>,
    collided: bool,
    gap: f64,
}

/// An arena of 1.2 to 2 m with 2 to 6 shapes, and the planned way between two places in it where the robot has
/// room.
fn drawn_way(random: &mut fastrand::Rng, margin: f64) -> Option<(Scene, Vec<Point>)> {
    let [width, height] = [1.2 + 0.8 * random.f64(), 1.2 + 0.8 * random.f64()];
    let mut scene = Scene::new(width, height);
    for _ in 0..random.u32(2..=6) {
        let centre = Point::new(width * random.f64(), height * random.f64());
        scene.obstacles.push(drawn_shape(random, centre, scene.arena.width, height)?.into());
    }
    let mut place =
        || Point::new(0.1 + (width - 0.2) * random.f64(), 0.1 + (height - 0.2) * random.f64());
    let (start, goal) = (place(), place());
    // From closer by a robot may drive off, but touches what it stands beside.
    let room = |at: Point| {
        let pose = TruePose { x: at.x, y: at.y, heading: 0.0 };
        World::from(&scene).clearance(pose) > margin
    };
    if !room(start) || !room(goal) {
        return None;
    }
    let options = PlanOptions { margin, ..PlanOptions::default() };
    let planned = plan(&scene, start, goal, &options).ok()?;
    (planned.waypoints.len() >= 2).then_some((scene, planned.waypoints))
}

/// A rectangle, a disc, a turned rectangle or a polygon with a notch, cut to the arena.
fn drawn_shape(random: &mut fastrand::Rng, at: Point, width: f64, height: f64) -> Option<Shape> {
    let size = 0.05 + 0.15 * random.f64();
    let inside = |point: Point| Point::new(point.x.clamp(0.0, width), point.y.clamp(0.0, height));
    let around = |angle: f64, length: f64| {
        inside(Point::new(at.x + length * angle.cos(), at.y + length * angle.sin()))
    };
    let turned = TAU * random.f64();
    let polygon = |corners: Vec<Point>| Polygon::new(corners).ok().map(Shape::Polygon);
    match random.u8(0..4) {
        0 => {
            let (low, high) = (
                inside(Point::new(at.x - size, at.y - size / 2.0)),
                inside(Point::new(at.x + size, at.y + size / 2.0)),
            );
            Some(Rect::new(low.x, low.y, high.x, high.y).into())
        }
        1 => {
            let room = at.x.min(at.y).min(width - at.x).min(height - at.y);
            let radius = size.min(room);
            (radius > 0.02).then(|| Circle { centre: at, radius }.into())
        }
        2 => {
            let corners = [0.5, 2.6, 3.6, 5.8].map(|angle| around(turned + angle, size));
            polygon(corners.to_vec())
        }
        _ => {
            let arms = [1.0, 0.4, 1.0, 0.9, 0.6];
            let corner = |(index, arm): (usize, f64)| {
                around(turned + TAU * index as f64 / arms.len() as f64, arm * size)
            };
            polygon(arms.into_iter().enumerate().map(corner).collect())
        }
    }
}

fn drive(
    scene: &Scene,
    way: &[Point],
    envelope: Envelope,
    seed: u64,
    random: &mut fastrand::Rng,
) -> End {
    let (first, second) = (way[0], way[1]);
    let heading = (second.y - first.y).atan2(second.x - first.x);
    let off = if envelope == Envelope::A { 0.0005 } else { 0.001 };
    let wrong = [(); 3].map(|()| 1.0 + off * (2.0 * random.f64() - 1.0));
    let start = TruePose { x: first.x, y: first.y, heading };
    let base = WheeledBase::new(BaseParameters::seeded(seed).with_wrong_lengths(wrong), start);
    let simulation = Simulation::new(InProcess::default(), base, Some(scene.into()));
    let mut drive = Drive {
        client: LinkClient::new(simulation, seed as u32 + 1),
        trouble: Trouble::new(envelope, random),
    };
    let goal = way.last().copied().unwrap_or(first);
    let failure = drive.until_goal(way, Pose::new(first.x as f32, first.y as f32, heading as f32));
    let truth = drive.client.port_mut().truth();
    let log = truth.collision_log.unwrap();
    let error = (truth.pose.x - goal.x).hypot(truth.pose.y - goal.y);
    let error = failure.is_none().then_some(error);
    End { error, failure, collided: log.collisions > 0, gap: log.min_clearance }
}

/// A robot on its way.
struct Drive<'a> {
    client: LinkClient<Simulation<InProcess>>,
    trouble: Trouble<'a>,
}

impl Drive<'_> {
    /// Drives along `way` from `pose`, and on while a camera sees that the goal was missed; why it failed.
    fn until_goal(&mut self, way: &[Point], pose: Pose) -> Option<String> {
        let goal = way[way.len() - 1];
        let mut failure = self.along(way, pose);
        for _ in 0..MOST_TOUCH_UPS {
            if failure.is_some() {
                break;
            }
            let Some(seen) = self.look_at_rest() else { break };
            let at = Point::new(seen.x.0.into(), seen.y.0.into());
            if at.distance(goal) <= TOUCH_UP {
                break;
            }
            failure = self.along(&[at, goal], seen);
        }
        failure
    }

    fn along(&mut self, way: &[Point], pose: Pose) -> Option<String> {
        let options = LegOptions { timing: Timing::Limits, reverse: false };
        let legs = to_legs(way, pose.heading.0.into(), None, &options, &DEFAULT_LIMITS);
        let mut mission = Mission::new(legs, pose);
        loop {
            let now = self.client.port_mut().now();
            match mission.step(&mut self.client, now) {
                Err(error) => return Some(error.to_string()),
                Ok(events) if events.iter().any(|event| matches!(event, MissionEvent::Done(_))) => {
                    return None;
                }
                Ok(_) if now > LONGEST => return Some("endless".into()),
                Ok(_) => self.trouble.make(&mut self.client, now),
            }
            self.client.port_mut().wait(POLL).unwrap();
        }
    }

    /// Where a robot that rests is seen, on the average of some pictures; `None` without a camera.
    fn look_at_rest(&mut self) -> Option<Pose> {
        if self.trouble.envelope == Envelope::A {
            return None;
        }
        let since = self.client.port_mut().now();
        self.trouble.seen.clear();
        while self.trouble.seen.len() < LAST_SIGHTS {
            let now = self.client.port_mut().now();
            self.trouble.look(&mut self.client, now);
            // Those exposed before it rested show it elsewhere.
            self.trouble.seen.retain(|(exposed, _)| *exposed >= since);
            self.client.poll(now).ok()?;
            self.client.port_mut().wait(POLL).unwrap();
        }
        let mean = |part: fn(&Pose) -> f32| {
            let parts = self.trouble.seen.iter().map(|(_, pose)| part(pose));
            parts.sum::<f32>() / self.trouble.seen.len() as f32
        };
        let sin = mean(|pose| pose.heading.0.sin());
        let heading = sin.atan2(mean(|pose| pose.heading.0.cos()));
        Some(Pose::new(mean(|pose| pose.x.0), mean(|pose| pose.y.0), heading))
    }
}

/// What goes wrong on the way.
struct Trouble<'a> {
    envelope: Envelope,
    random: &'a mut fastrand::Rng,
    leg: Option<u16>,
    slips: Option<(Duration, usize)>,
    frames: VecDeque<(Duration, TruePose)>,
    /// What the camera has said so far.
    seen: Vec<(Duration, Pose)>,
}

impl<'a> Trouble<'a> {
    fn new(envelope: Envelope, random: &'a mut fastrand::Rng) -> Self {
        Self { envelope, random, leg: None, slips: None, frames: VecDeque::new(), seen: Vec::new() }
    }

    fn make(&mut self, client: &mut LinkClient<Simulation<InProcess>>, now: Duration) {
        let encoders = [EncoderFault::Noisy(1); 2];
        let mut faults = Faults { encoders, ..Faults::default() };
        if self.envelope == Envelope::B {
            let leg = client.telemetry().map(|last| last.leg);
            if leg != self.leg {
                self.leg = leg;
                let delay = Duration::from_secs_f64(0.2 + 0.8 * self.random.f64());
                self.slips = Some((now + delay, self.random.usize(0..2)));
            }
            if let Some((begin, wheel)) = self.slips
                && (begin..begin + Duration::from_secs_f64(SLIP_SECONDS)).contains(&now)
            {
                faults.slip[wheel] = SLIP;
            }
            self.look(client, now);
        }
        client.port_mut().base_mut().set_faults(faults);
    }

    fn look(&mut self, client: &mut LinkClient<Simulation<InProcess>>, now: Duration) {
        if now.as_millis().is_multiple_of(FRAME.as_millis()) {
            self.frames.push_back((now, client.port_mut().truth().pose));
        }
        let late = |(exposed, _): &mut (Duration, TruePose)| now >= *exposed + LATENCY;
        let Some((exposed, pose)) = self.frames.pop_front_if(late) else { return };
        let mut error = |sigma: f64| sigma * normal(self.random);
        let (x, y) = (pose.x + error(0.002), pose.y + error(0.002));
        let heading = pose.heading + error(0.3f64.to_radians());
        // The simulation ticks every 5 ms from the start, so its clock is the robot's.
        let ticks = (exposed.as_millis() / 5) as u32;
        let pose = Pose::new(x as f32, y as f32, heading as f32);
        self.seen.push((exposed, pose));
        client.send(Command::SetPose(CameraPose { ticks, pose }));
    }
}
