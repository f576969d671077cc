//! Steps of a watched drive on the simulated robot: what a person's pause holds, and what comes meanwhile.

use super::*;
use crate::geometry::Rect;
use crate::legs::{DEFAULT_LIMITS, LegOptions};
use crate::link::drive::STOP_TIMEOUT;
use crate::plan::PlanOptions;
use crate::scene::{Goal, Scene};
use crate::simulated::robot_in;
use crate::track::pose::PoseSigma;
use crate::watch::route::Router;
use crate::watch::source::SourceError;
use crate::watch::{Look, Sight, Watcher};
use hil_sim::in_process::InProcess;
use hil_sim::simulation::Simulation;
use protocol::motion::Timing;

type Port = Simulation<InProcess>;

const FRAME: Duration = Duration::from_millis(100);
/// How long the robot waits.
const PATIENCE: Duration = Duration::from_secs(2);
/// From a frame to its judgement, and from that to wheels that slow down, s.
const LATENCY: f64 = 0.2;

/// Sees the truth ten times a second, and the boxes that are there at each time, s.
struct Onlooker<F> {
    next: Duration,
    things: F,
}

impl<F: Fn(f64) -> Vec<Rect>> Watcher<Port> for Onlooker<F> {
    fn expect(&mut self, _: Duration, _: Pose) {}

    fn look(&mut self, port: &mut Port, now: Duration) -> Result<Look, SourceError> {
        if now < self.next {
            return Ok(Look::Nothing);
        }
        self.next = now + FRAME;
        let things = (self.things)(now.as_secs_f64());
        Ok(Look::Seen(Sight {
            exposed: now,
            robot: Some(port.truth().pose.into()),
            obstacles: things.into_iter().map(Obstacle::from).collect(),
            relocated: false,
        }))
    }
}

/// Time and true place of each step, what happened, and how it ended.
struct Story {
    path: Vec<(f64, Point)>,
    events: Vec<(f64, WatchEvent)>,
    drive: WatchedDrive,
    result: Result<Pose, WatchError>,
}

/// Along 1.4 m of free floor, as wished at each time, s.
fn drive(things: impl Fn(f64) -> Vec<Rect>, wish: impl Fn(f64) -> Wish) -> Story {
    drive_with(PATIENCE, things, wish)
}

fn drive_with(
    patience: Duration,
    things: impl Fn(f64) -> Vec<Rect>,
    wish: impl Fn(f64) -> Wish,
) -> Story {
    let start = Pose::new(0.3, 0.5, 0.0);
    let scene = Scene::new(2.0, 1.0);
    let mut client = LinkClient::new(robot_in(&scene, start, 1), 1);
    let router = Router {
        scene,
        goal: Goal { position: Point::new(1.7, 0.5), heading: None },
        plan: PlanOptions::default(),
        margins: vec![0.01, 0.0],
        legs: LegOptions { timing: Timing::Limits, reverse: false },
    };
    let route = router.route(&[], start, (0.0, false), &DEFAULT_LIMITS).unwrap();
    let options = WatchOptions { router, sigma: PoseSigma::TAGGED, patience, foresees: true };
    let mut drive = WatchedDrive::new(options, DEFAULT_LIMITS, start, route, Vec::new());
    let mut watcher = Onlooker { next: Duration::ZERO, things };
    let (mut path, mut events) = (Vec::new(), Vec::new());
    let result = loop {
        let now = client.port_mut().now().as_secs_f64();
        let pose = Pose::from(client.port_mut().truth().pose);
        path.push((now, pose.position));
        let mut hear = |at: Duration, what| {
            if let Happening::Watch(event) = what {
                events.push((at.as_secs_f64(), event));
            }
        };
        match drive.step(&mut client, &mut watcher, wish(now), &mut hear) {
            Ok(None) => TimedPort::wait(client.port_mut(), POLL_INTERVAL).unwrap(),
            Ok(Some(pose)) => break Ok(pose),
            Err(error) => break Err(error),
        }
    };
    Story { path, events, drive, result }
}

impl Story {
    fn at(&self, time: f64) -> Point {
        self.path.iter().find(|(at, _)| *at >= time).unwrap().1
    }
}

/// A box that is set down at a time.
fn since(time: f64, rect: Rect) -> impl Fn(f64) -> Vec<Rect> {
    move |now| if now >= time { vec![rect] } else { vec![] }
}

fn paused(time: f64) -> Wish {
    if (1.5..5.5).contains(&time) { Wish::Pause } else { Wish::Drive }
}

/// From 0.4 m/s a robot of 0.8 m/s² stands after 0.5 s. The pause is longer than the patience with a hold.
#[test]
fn a_pause_holds_the_robot_and_costs_no_patience() {
    let story = drive(|_| vec![], paused);
    let end = story.result.as_ref().unwrap();
    assert!(end.position.distance(Point::new(1.7, 0.5)) < 0.005, "{end:?}");
    let (held, later) = (story.at(2.0 + LATENCY), story.at(5.5));
    assert!(held.distance(later) < 1e-3 && later.x < 1.2, "{held:?} {later:?}");
    assert_eq!(story.drive.statistics().waits, 0, "{:?}", story.events);
}

#[test]
fn what_comes_during_a_pause_is_not_driven_into() {
    let rect = Rect::new(1.3, 0.4, 1.4, 0.6);
    let story = drive(since(3.0, rect), paused);
    assert!(story.result.is_ok(), "{:?}", story.events);
    assert!(story.events.iter().all(|(at, _)| !(1.5..5.5).contains(at)), "{:?}", story.events);
    let first = story.events.first().unwrap();
    assert!(matches!(first.1, WatchEvent::Held(Reason::Blocked { .. })), "{first:?}");
    assert!(first.0 < 5.5 + LATENCY, "{first:?}");
    let nearest = |at: &Point| Obstacle::from(rect).footprint.distance(*at);
    let gap = story.path.iter().map(|(_, at)| nearest(at)).fold(f64::INFINITY, f64::min);
    assert!(gap > 0.075, "{gap}");
}

#[test]
fn a_stop_during_a_pause_ends_the_drive() {
    let wish = |time| if time > 3.0 { Wish::Stop } else { paused(time) };
    let story = drive(|_| vec![], wish);
    assert!(matches!(story.result, Err(WatchError::Drive(DriveError::Stopped))));
    let (last, held) = (story.path.last().unwrap(), story.at(2.0 + LATENCY));
    assert!(last.0 < 3.0 + STOP_TIMEOUT.as_secs_f64(), "the robot has confirmed it: {last:?}");
    assert!(last.1.distance(held) < 1e-3, "it has not moved: {last:?} {held:?}");
}

/// It appears beside the way, nearer than a walker gets while the robot brakes, and does not move.
#[test]
fn a_newcomer_beside_the_way_is_waited_for_until_it_is_known() {
    let rect = Rect::new(0.95, 0.68, 1.05, 0.78);
    let story = drive(since(1.5, rect), |_| Wish::Drive);
    let end = story.result.as_ref().unwrap();
    assert!(end.position.distance(Point::new(1.7, 0.5)) < 0.005, "{end:?}");
    let held = story.events.iter().find(|(_, event)| matches!(event, WatchEvent::Held(_)));
    let (held, _) = held.unwrap();
    assert!((1.5..1.5 + LATENCY).contains(held), "{:?}", story.events);
    let resumed = |event: &WatchEvent| matches!(event, WatchEvent::Resumed { .. });
    let (resumed, _) = story.events.iter().find(|(_, event)| resumed(event)).unwrap();
    // Five frames make it known.
    assert!((0.2..0.8).contains(&(resumed - held)), "{:?}", story.events);
    assert_eq!(story.drive.statistics().waits, 1);
}

/// While the robot is paused a box rolls in at 0.15 m/s until it is 10 mm beside it, and after the pause back to 25 mm:
/// less than what is kept from things that may set out again, more than what is kept from those that stand.
#[test]
fn what_has_come_beside_the_robot_and_stays_is_driven_past() {
    // A wall on the other side leaves no way round.
    let wall = Rect::new(0.0, 0.0, 2.0, 0.41);
    let rolls = |time: f64| {
        let below =
            (0.9 - 0.15 * (time - 2.0)).max(0.585 + (0.15 * (time - 6.0)).clamp(0.0, 0.015));
        let rolling = Rect::new(0.62, below, 0.72, below + 0.1);
        if time < 2.0 { vec![wall] } else { vec![wall, rolling] }
    };
    let story = drive_with(4 * PATIENCE, rolls, paused);
    let there = story.at(5.5);
    assert!((0.62..0.72).contains(&there.x), "it rests below the box: {there:?}");
    let end = story.result.as_ref().unwrap();
    assert!(end.position.distance(Point::new(1.7, 0.5)) < 0.005, "{end:?}");
    // It keeps its place from 6.1 s on, and stands again 5 s later.
    let last = story.path.last().unwrap().0;
    assert!(last > 6.1 + 5.0, "{last} s: not before it has kept its place for long");
}
