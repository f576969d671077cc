//! Random arenas with shapes of all kinds, planned and driven on bases that are slightly off.
//!
//! | envelope | lengths off by | encoders | wheels | camera |
//! |---|---|---|---|---|
//! | A | 0.05 % | ± 1 count | grip | none |
//! | B | 0.1 % | ± 1 count | one slips by 20 % for 0.2 s on each leg | 5 Hz, 100 ms late, σ 2 mm and 0.3° |
//!
//! Shapes are not solid here, so that every overlap of more than 0.1 mm counts.

use crate::POLL;
use hil_sim::base::{BaseParameters, EncoderFault, Faults, TruePose, WheeledBase};
use hil_sim::in_process::InProcess;
use hil_sim::simulation::Simulation;
use hil_sim::world;
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
        match drawn_way(&mut random) {
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
fn drawn_way(random: &mut fastrand::Rng) -> Option<(Scene, Vec<Point>)> {
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
        true_world(&scene).clearance(pose) > MARGIN
    };
    if !room(start) || !room(goal) {
        return None;
    }
    let options = PlanOptions { margin: MARGIN, ..PlanOptions::default() };
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

fn true_world(scene: &Scene) -> world::World {
    world::World {
        size: [scene.arena.width, scene.arena.height],
        shapes: scene.obstacles.iter().map(|shape| true_shape(&shape.footprint)).collect(),
        robot_radius: scene.robot_radius,
    }
}

fn true_shape(shape: &Shape) -> world::Shape {
    match shape {
        Shape::Rect(rect) => world::Shape::Rect((*rect).into()),
        Shape::Circle(circle) => world::Shape::Circle((*circle).into()),
        Shape::Polygon(polygon) => {
            world::Shape::Polygon(polygon.corners().iter().map(|&at| at.into()).collect())
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
    let simulation = Simulation::new(InProcess::default(), base, Some(true_world(scene)));
    let options = LegOptions { timing: Timing::Limits, reverse: false };
    let legs = to_legs(way, heading, None, &options, &DEFAULT_LIMITS);
    let pose = Pose::new(first.x as f32, first.y as f32, heading as f32);
    let mut client = LinkClient::new(simulation, seed as u32 + 1);
    let mut mission = Mission::new(legs, pose);
    let mut trouble = Trouble::new(envelope, random);
    let failure = loop {
        let now = client.port_mut().now();
        match mission.step(&mut client, now) {
            Err(error) => break Some(error.to_string()),
            Ok(events) if events.iter().any(|event| matches!(event, MissionEvent::Done(_))) => {
                break None;
            }
            Ok(_) if now > LONGEST => break Some("endless".into()),
            Ok(_) => trouble.make(&mut client, now),
        }
        client.port_mut().wait(POLL).unwrap();
    };
    let truth = client.port_mut().truth();
    let goal = way.last().unwrap();
    let log = truth.collision_log.unwrap();
    let error = (truth.pose.x - goal.x).hypot(truth.pose.y - goal.y);
    let error = failure.is_none().then_some(error);
    End { error, failure, collided: log.collisions > 0, gap: log.min_clearance }
}

/// What goes wrong on the way.
struct Trouble<'a> {
    envelope: Envelope,
    random: &'a mut fastrand::Rng,
    leg: Option<u16>,
    slips: Option<(Duration, usize)>,
    frames: VecDeque<(Duration, TruePose)>,
}

impl<'a> Trouble<'a> {
    fn new(envelope: Envelope, random: &'a mut fastrand::Rng) -> Self {
        Self { envelope, random, leg: None, slips: None, frames: VecDeque::new() }
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
                && (begin..begin + Duration::from_millis(200)).contains(&now)
            {
                faults.slip[wheel] = 0.2;
            }
            self.look(client, now);
        }
        client.port_mut().base_mut().set_faults(faults);
    }

    fn look(&mut self, client: &mut LinkClient<Simulation<InProcess>>, now: Duration) {
        if now.as_millis().is_multiple_of(200) {
            self.frames.push_back((now, client.port_mut().truth().pose));
        }
        let late =
            |(exposed, _): &mut (Duration, TruePose)| now >= *exposed + Duration::from_millis(100);
        let Some((exposed, pose)) = self.frames.pop_front_if(late) else { return };
        let mut error =
            |sigma: f64| sigma * ((0..12).map(|_| self.random.f64()).sum::<f64>() - 6.0);
        let (x, y) = (pose.x + error(0.002), pose.y + error(0.002));
        let heading = pose.heading + error(0.3f64.to_radians());
        // The simulation ticks every 5 ms from the start, so its clock is the robot's.
        let ticks = (exposed.as_millis() / 5) as u32;
        let pose = Pose::new(x as f32, y as f32, heading as f32);
        client.send(Command::SetPose(CameraPose { ticks, pose }));
    }
}
