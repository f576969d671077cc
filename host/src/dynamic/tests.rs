//! Ways over time by hand, against a brute-force search, and held against what moves in small steps.

use super::*;
use crate::geometry::{Point, Pose};
use crate::legs::{DEFAULT_LIMITS, LegOptions, planned_poses, to_legs};
use crate::scene::{Goal, Scene};
use crate::shape::{Circle, Shape};
use proptest::prelude::*;
use protocol::motion::Timing;

const LEGS: LegOptions = LegOptions { timing: Timing::Limits, reverse: true };
const KEEP: f64 = 0.08;
const DISC: f64 = 0.05;
const DEMAND: Demand = Demand { keep: KEEP, sure: 0.7 };
/// Ways are tried every 20 ms: between two of them, at 0.6 m/s past a disc of 0.13 m, they may come nearer by
/// (0.6 × 0.02)² / (8 × 0.13) = 0.14 mm; twice that.
const BETWEEN: f64 = 0.0003;

fn disc(x: f64, y: f64) -> Shape {
    Circle { centre: Point::new(x, y), radius: DISC }.into()
}

/// A disc that moves steadily, and is `reach` unsure for each second ahead.
fn steady(x: f64, y: f64, [vx, vy]: [f64; 2], reach: f64) -> Future {
    let moves = (0..=150).map(|layer| {
        let time = 0.1 * f64::from(layer);
        ([vx * time, vy * time], reach * time)
    });
    Future::new(disc(x, y), moves)
}

fn goal(x: f64, y: f64) -> Goal {
    Goal { position: Point::new(x, y), heading: None }
}

fn quest(from: Pose, goal: Goal, futures: &[Future]) -> Quest<'_> {
    Quest { from, start: 0.0, goal, within: f64::INFINITY, way: &[], futures }
}

fn plan(scene: &Scene, from: Pose, to: Goal, futures: &[Future]) -> DynamicPlan {
    let quest = quest(from, to, futures);
    DynamicArena::new(scene, DEFAULT_LIMITS, LEGS, DEMAND).plan(&quest)
}

/// In a lane without room to pass a disc stands at x = 1 m, and leaves sideways after 6.06 s.
///
/// The robot touches it at x = 0.87 m, 0.67 m from its start. It speeds up for π V / (2 A) = 0.785 s, in which it
/// drives 0.157 m, and goes on at 0.4 m/s: it is there after 2.07 s, so it has to wait for 3.99 s; waits are whole
/// fifths of a second. Behind the disc's place it drives on to 1.6 m, in 1.6 / 0.4 + 0.785 s.
#[test]
fn the_wait_for_a_disc_by_hand() {
    let moves = (0..=100).map(|layer| {
        let gone = if layer < 61 { 0.0 } else { 0.4 * f64::from(layer - 60) };
        ([0.0, gone], 0.0)
    });
    let futures = [Future::new(disc(1.0, 0.095), moves)];
    let scene = Scene::new(2.0, 0.19);
    let plan = plan(&scene, Pose::new(0.2, 0.095, 0.0), goal(1.8, 0.095), &futures);
    assert_eq!((plan.legs.len(), plan.waits_for), (1, None), "{plan:?}");
    assert!((plan.first_wait() - 4.0).abs() < 1e-9, "{}", plan.first_wait());
    assert!((plan.arrival - 8.785).abs() < 0.01, "{}", plan.arrival);
}

#[test]
fn an_empty_floor_is_crossed_at_once() {
    let (from, to) = (Pose::new(0.2, 0.5, 1.0), goal(1.8, 0.7));
    let plan = plan(&Scene::new(2.0, 1.0), from, to, &[]);
    let legs = to_legs(&[from.position, to.position], 1.0, None, &LEGS, &DEFAULT_LIMITS);
    assert_eq!(plan.legs(), legs);
    assert_eq!(plan.arrival, crate::legs::duration(&legs, &DEFAULT_LIMITS));
}

#[test]
fn a_goal_that_stays_taken_is_waited_for_nearby() {
    let futures = [steady(1.6, 0.5, [0.0, 0.0], 0.0)];
    let plan = plan(&Scene::new(2.0, 1.0), Pose::new(0.3, 0.5, 0.0), goal(1.6, 0.5), &futures);
    assert_eq!(plan.waits_for, Some(Some(0)));
    let end = plan.legs.last().map(|timed| LegMotion::new(&timed.leg, &DEFAULT_LIMITS).end);
    let left = end.unwrap().position.distance(Point::new(1.6, 0.5));
    assert!((KEEP + DISC..0.25).contains(&left), "{left}");
}

/// All ways of one leg or two over `places`, each leg after a wait of whole fifths of a second up to `longest`: the
/// earliest arrival. Nothing of it is the planner's but the legs' own course.
fn earliest(places: &[Point], from: Pose, to: Point, futures: &[Future], longest: u32) -> f64 {
    let free = |legs: &[protocol::motion::Leg], begins: f64| {
        planned_poses(legs, &DEFAULT_LIMITS).iter().all(|(time, pose)| {
            futures.iter().all(|future| {
                let there = future.centre(begins + time);
                pose.position.distance(there) >= KEEP + DISC
            })
        })
    };
    let from_rest = |at: Pose, to: Point, begins: f64| {
        let mut best: Vec<(f64, Pose)> = Vec::new();
        for reverse in [false, true] {
            let turned = if reverse { at.heading + std::f64::consts::PI } else { at.heading };
            let options = LegOptions { reverse: false, ..LEGS };
            let mut legs = to_legs(&[at.position, to], turned, None, &options, &DEFAULT_LIMITS);
            if reverse {
                for leg in &mut legs {
                    leg.direction = protocol::motion::Direction::Reverse;
                    leg.start = crate::legs::to_wire(at);
                }
            }
            let end = crate::legs::planned_end(&legs, &DEFAULT_LIMITS).unwrap();
            let long = crate::legs::duration(&legs, &DEFAULT_LIMITS);
            let mut waits = (0..=longest).map(|step| 0.2 * f64::from(step));
            let soonest = waits.find(|wait| free(&legs, begins + wait));
            best.extend(soonest.map(|wait| (begins + wait + long, end)));
        }
        best
    };
    let direct = from_rest(from, to, 0.0);
    let by_two = places.iter().filter(|place| place.distance(to) > 1e-9).flat_map(|&via| {
        let first = from_rest(from, via, 0.0);
        first.into_iter().flat_map(move |(time, pose)| from_rest(pose, to, time))
    });
    direct.into_iter().chain(by_two).map(|(time, _)| time).fold(f64::INFINITY, f64::min)
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(24))]

    /// No way of one leg or two arrives earlier. The planner hopes for durations that are whole ticks at last: by
    /// up to three intervals' rounding and what risk may cost it may be later.
    #[test]
    fn nothing_arrives_earlier(
        x in 0.25f64..0.55, y in 0.0f64..0.6, vx in -0.15f64..0.15, vy in -0.2f64..0.2, heading in -3.0f64..3.0,
    ) {
        let scene = Scene::new(0.8, 0.6);
        let (from, to) = (Pose::new(0.1, 0.3, heading), Point::new(0.7, 0.3));
        let future = steady(x, y, [vx, vy], 0.0);
        prop_assume!(future.centre(0.0).distance(from.position) > KEEP + DISC + 0.01);
        let futures = [future];
        let found = plan(&scene, from, goal(to.x, to.y), &futures);
        let grid = TimeGrid::new(scene.arena, &futures, DEMAND, &[]);
        let inside = |at: &Point| at.x >= KEEP && at.x <= 0.8 - KEEP && at.y >= KEEP && at.y <= 0.6 - KEEP;
        let places: Vec<Point> = (0..grid.len()).map(|index| grid.place(index)).filter(inside).collect();
        let best = earliest(&places, from, to, &futures, 25);
        prop_assert!(best.is_infinite() || found.waits_for.is_none());
        if found.waits_for.is_none() {
            prop_assert!(found.arrival <= best + 0.05, "{} {best} {found:?}", found.arrival);
        }
    }

    /// No plan is ever nearer to where a thing may be than asked.
    #[test]
    fn no_plan_enters_a_predicted_set(
        things in prop::collection::vec((0.0f64..2.0, 0.0f64..1.5, -0.25f64..0.25, -0.25f64..0.25), 1..5),
        to in (0.2f64..1.8, 0.2f64..1.3), heading in -3.0f64..3.0,
    ) {
        let scene = Scene::new(2.0, 1.5);
        let from = Pose::new(0.3, 0.3, heading);
        let futures: Vec<Future> =
            things.iter().map(|&(x, y, vx, vy)| steady(x, y, [vx, vy], 0.05)).collect();
        let quest = quest(from, goal(to.0, to.1), &futures);
        let found = DynamicArena::new(&scene, DEFAULT_LIMITS, LEGS, DEMAND).plan(&quest);
        let demand = Demand { keep: KEEP - BETWEEN, ..DEMAND };
        prop_assert!(found.is_free(&quest, demand, &DEFAULT_LIMITS, 0.005), "{found:?}");
        let mut end = 0.0;
        for timed in &found.legs {
            prop_assert!((timed.begins - end - timed.wait).abs() < 1e-9, "{found:?}");
            end = timed.begins + LegMotion::new(&timed.leg, &DEFAULT_LIMITS).times()[2];
        }
        prop_assert!((found.arrival - end).abs() < 1e-9);
    }
}

/// At 0.4 m/s the robot brakes by 0.8 m/s² within half a second and 0.1 m, after 0.04 s at 0.4 m/s.
#[test]
fn a_robot_that_is_held_rests_a_braking_distance_further() {
    let way = [Point::new(0.2, 0.5), Point::new(1.8, 0.5)];
    let legs = to_legs(&way, 0.0, None, &LEGS, &DEFAULT_LIMITS);
    let rollout = Rollout::new(&legs, &DEFAULT_LIMITS);
    let place = rollout.place(Pose::new(1.0, 0.5, 0.0));
    let course = rollout.course((place, Pace(1.0)), [0.04, f64::INFINITY], &[], DEMAND);
    // Steps of 20 ms: 8 mm at full speed.
    assert!(
        (course.end.x - 1.116).abs() < 0.01 && (course.rests - 0.54).abs() < 0.06,
        "{course:?}"
    );
    let on = rollout.course((place, Pace(1.0)), [f64::INFINITY; 2], &[], DEMAND);
    assert!((on.rests - 2.39).abs() < 0.05 && on.end.distance(way[1]) < 1e-6, "{on:?}");
}

/// A disc crosses the way 0.5 m ahead when the robot is there; half a second earlier the robot must be held.
#[test]
fn a_crossing_disc_is_met_unless_the_robot_is_held() {
    let way = [Point::new(0.2, 0.5), Point::new(1.8, 0.5)];
    let legs = to_legs(&way, 0.0, None, &LEGS, &DEFAULT_LIMITS);
    let rollout = Rollout::new(&legs, &DEFAULT_LIMITS);
    let start = (rollout.place(Pose::new(0.6, 0.5, 0.0)), Pace(1.0));
    let futures = [steady(1.1, 0.25, [0.0, 0.2], 0.0)];
    let course = |held| rollout.course(start, held, &futures, DEMAND);
    let contact = course([f64::INFINITY; 2]).contact.unwrap();
    assert!(contact.future == 0 && (contact.at.x - 0.98).abs() < 0.03, "{contact:?}");
    assert_eq!(course([0.2, f64::INFINITY]).contact, None);
    assert_eq!(course([0.2, 2.2]).contact, None, "and goes on behind it");
}
