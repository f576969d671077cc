//! The fuzzy planner beside the exact one, a slow second opinion and what can be computed by hand.
#![allow(clippy::unwrap_used, reason = "helpers of tests fail as tests do")]

#[path = "../examples/fuzzy/reference.rs"]
mod reference;

use proptest::prelude::*;
use wmr::geometry::{Point, Rect};
use wmr::plan::{FuzzyOptions, Inflation, Plan, PlanError, PlanOptions, Planner, clearance, plan};
use wmr::scene::{Obstacle, Scene};
use wmr::shape::{Circle, Polygon, Shape};

const START: Point = Point::new(0.1, 0.1);
const GOAL: Point = Point::new(1.1, 0.7);

fn fuzzy(scene: &Scene, risk: f64, start: Point, goal: Point) -> Result<Plan, PlanError> {
    let fuzzy = FuzzyOptions { risk, area: None };
    plan(scene, start, goal, &PlanOptions { planner: Planner::Fuzzy, fuzzy, ..Default::default() })
}

fn greatest_risk(plan: &Plan) -> f64 {
    plan.fuzzy.as_deref().unwrap().greatest_risk
}

/// Discs and turned squares that leave start and goal alone.
fn scene(numbers: &[[f64; 5]]) -> Scene {
    let mut scene = Scene::new(1.2, 0.8);
    for &[x, y, size, turn, margin] in numbers {
        let centre = Point::new(1.2 * x, 0.8 * y);
        let size = 0.02 + 0.08 * size;
        let footprint = if turn < 0.5 {
            Shape::from(Circle { centre, radius: size })
        } else {
            let corner = |quarter: u8| {
                let angle = std::f64::consts::FRAC_PI_2 * (f64::from(quarter) + 2.0 * turn);
                Point::new(centre.x + size * angle.cos(), centre.y + size * angle.sin())
            };
            Polygon::new((0..4).map(corner).collect()).unwrap().into()
        };
        let margin = 0.04 * margin;
        let ends = [START, GOAL].map(|end| footprint.distance(end));
        if ends.iter().all(|&far| far > scene.robot_radius + margin + 0.01) {
            scene.obstacles.push(Obstacle { footprint, margin: [margin; 4], height: None });
        }
    }
    scene
}

fn without_margins(mut scene: Scene) -> Scene {
    scene.obstacles.iter_mut().for_each(|obstacle| obstacle.margin = [0.0; 4]);
    scene
}

fn exact(scene: &Scene) -> Option<Plan> {
    let options = PlanOptions { inflation: Some(Inflation::Disc), ..PlanOptions::default() };
    plan(scene, START, GOAL, &options).ok()
}

/// Two tangents of the inflated disc and the arc between them: its radius is 0.175 m, and the ends lie
/// 0.5 m from its centre.
#[test]
fn around_a_disc_the_way_is_two_tangents_and_an_arc() {
    let mut scene = Scene::new(1.4, 1.0);
    scene.obstacles.push(Circle::from([0.7, 0.5, 0.1]).into());
    let way = fuzzy(&scene, 0.0, Point::new(0.2, 0.5), Point::new(1.2, 0.5)).unwrap();
    let (radius, far) = (0.175_f64, 0.5_f64);
    let arc = std::f64::consts::PI - 2.0 * (radius / far).acos();
    let best = 2.0 * (far * far - radius * radius).sqrt() + radius * arc;
    assert!((best..1.002 * best).contains(&way.length), "{} {best}", way.length);
    assert!(way.clearance >= 0.075 - 1e-9);
}

/// The gap is 190 mm wide between margins of 40 mm: in its middle 20 mm are left of each, a risk of a half
/// on 0.2 m. Straight through are 1 m and 0.1 m of risk; the way round is 0.3 m longer or more.
#[test]
fn a_risky_gap_is_taken_until_the_detour_is_cheaper() {
    let mut scene = Scene::new(1.4, 1.4);
    let walls = [Rect::new(0.6, 0.5, 0.8, 0.95), Rect::new(0.6, 0.0, 0.8, 0.31)];
    scene.obstacles = walls.map(|rect| Obstacle { margin: [0.04; 4], ..rect.into() }).to_vec();
    let way = |weight: f64| fuzzy(&scene, weight, Point::new(0.2, 0.405), Point::new(1.2, 0.405));
    let straight = way(1.0).unwrap();
    assert!((straight.length - 1.0).abs() < 1e-3, "{}", straight.length);
    assert!((greatest_risk(&straight) - 0.5).abs() < 0.01);
    let round = way(100.0).unwrap();
    assert!(round.length > 1.3, "{} m", round.length);
    assert_eq!(greatest_risk(&round), 0.0);
}

#[test]
fn what_cannot_be_planned_is_refused_with_its_numbers() {
    let scene = scene(&[]);
    let plan = |change: fn(&mut PlanOptions)| {
        let mut options = PlanOptions { planner: Planner::Fuzzy, ..Default::default() };
        change(&mut options);
        plan(&scene, START, GOAL, &options).unwrap_err().code()
    };
    assert_eq!(plan(|options| options.fuzzy.risk = -1.0), "bad_risk_weight");
    assert_eq!(plan(|options| options.fuzzy.risk = f64::NAN), "bad_risk_weight");
    assert_eq!(plan(|options| options.fuzzy.area = Some(1e-6)), "bad_area");
    assert_eq!(plan(|options| options.fuzzy.area = Some(0.0)), "bad_area");
    assert_eq!(plan(|options| options.inflation = Some(Inflation::Square)), "fuzzy_alone");
    let mut shut = scene.clone();
    shut.obstacles.push(Rect::new(0.5, 0.0, 0.6, 0.7).into());
    let refused = fuzzy(&shut, 1.0, START, GOAL).unwrap_err();
    let options = PlanOptions { inflation: Some(Inflation::Disc), ..PlanOptions::default() };
    assert_eq!(refused.code(), "no_path");
    assert_eq!(
        Err(refused),
        wmr::plan::plan(&shut, START, GOAL, &options),
        "as the exact planner does"
    );
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(40))]

    #[test]
    fn where_edges_are_sure_the_way_is_free_and_as_short_as_the_exact_one(
        numbers in proptest::collection::vec(proptest::array::uniform5(0.0..1.0_f64), 0..6),
    ) {
        let scene = without_margins(scene(&numbers));
        let Some(best) = exact(&scene) else { return Ok(()) };
        let way = fuzzy(&scene, 10.0, START, GOAL).unwrap();
        prop_assert!(clearance(&way.waypoints, &scene) >= scene.robot_radius - 1e-7);
        prop_assert!(way.length <= 1.01 * best.length, "{} {}", way.length, best.length);
        let back = fuzzy(&scene, 10.0, GOAL, START).unwrap();
        prop_assert!((way.length / back.length - 1.0).abs() <= 0.01, "{} {}", way.length, back.length);
    }

    #[test]
    fn more_weight_never_leads_through_greater_risk(
        numbers in proptest::collection::vec(proptest::array::uniform5(0.0..1.0_f64), 1..6),
        [a, b] in proptest::array::uniform2(-2.0..3.0_f64),
    ) {
        let scene = scene(&numbers);
        prop_assume!(exact(&without_margins(scene.clone())).is_some());
        let risk = |weight: f64| {
            let way = fuzzy(&scene, weight, START, GOAL).unwrap();
            (greatest_risk(&way), reference::cost_along(&scene, &way.waypoints, 0.0).1)
        };
        let (less, more) = (risk(10_f64.powf(a.min(b))), risk(10_f64.powf(a.max(b))));
        prop_assert!(more.0 <= less.0, "{less:?} {more:?}");
        // What is reported is what fine sampling finds, but for its step.
        prop_assert!(less.1 <= less.0 + 1e-9 && less.0 <= less.1 + 0.03, "{less:?}");
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(8))]

    #[test]
    fn the_cost_is_hardly_above_that_of_fast_marching_on_finer_areas(
        numbers in proptest::collection::vec(proptest::array::uniform5(0.0..1.0_f64), 1..6),
        weight in 0.5..20.0_f64,
    ) {
        let scene = scene(&numbers);
        let Some(least) = reference::least_cost(&scene, (START, GOAL), 0.005, weight) else { return Ok(()) };
        let way = fuzzy(&scene, weight, START, GOAL).unwrap();
        let cost = reference::cost_along(&scene, &way.waypoints, weight).0;
        prop_assert!(cost <= 1.015 * least, "{cost} {least}");
        let told = way.fuzzy.unwrap().cost;
        prop_assert!((told - cost).abs() <= 0.002 * cost, "told {told}, sampled {cost}");
    }
}
