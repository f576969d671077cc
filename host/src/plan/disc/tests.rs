//! Shapes inflated by a disc: by hand, between two bounds that a slow search over other polygons gives,
//! and without a radius against an exact oracle.

use super::oracle::Oracle;
use crate::geometry::{Point, Rect};
use crate::plan::{Inflation, LegTest, PlanOptions, Planner, PreparedArena, plan};
use crate::scene::Scene;
use crate::shape::{Circle, Polygon};
use proptest::prelude::*;
use std::f64::consts::PI;

fn rounded() -> PlanOptions {
    PlanOptions { inflation: Some(Inflation::Disc), ..PlanOptions::default() }
}

/// What tangents within half a millimetre add to an arc of 75 mm radius, at most, as a part of it: their
/// vertices lie that much further out, so the half angle x between two has 1 / cos x = 75.5 / 75, and
/// tan x / x − 1 = 0.0045.
const ARC_EXCESS: f64 = 0.0045;

#[test]
fn around_one_box_the_way_is_tangent_arc_tangent() {
    // A thin wall from the floor up to (1, 0.5); the ends lie symmetrically 0.6 m to its sides.
    let mut scene = Scene::new(2.0, 2.0);
    scene.obstacles.push(Rect::new(0.9999, 0.0, 1.0001, 0.5).into());
    let ends = [Point::new(0.3999, 0.5), Point::new(1.6001, 0.5)];
    let plan = plan(&scene, ends[0], ends[1], &rounded()).unwrap();
    // From each end a tangent to the circle around the corner 0.6 m away, then an arc over what is left
    // of the quarter, then the straight piece over the wall's thickness.
    let (distance, radius) = (0.6_f64, 0.075_f64);
    let tangent = (distance * distance - radius * radius).sqrt();
    let arc = PI / 2.0 - (radius / distance).acos();
    let exact = 2.0 * (tangent + radius * arc) + 0.0002;
    assert!(plan.length >= exact - 1e-9 && plan.length <= exact + 0.001, "{} {exact}", plan.length);
    assert!((0.075..=0.0755).contains(&plan.clearance), "{}", plan.clearance);
    assert!(plan.waypoints.len() > 3);
}

#[test]
fn half_way_round_a_box_the_arcs_are_within_their_part() {
    // Both ends below the box's top at its sides: two whole quarters are driven.
    let mut scene = Scene::new(2.0, 2.0);
    scene.obstacles.push(Rect::new(0.8, 0.0, 1.2, 0.5).into());
    let [start, goal] = [Point::new(0.725, 0.2), Point::new(1.275, 0.2)];
    let plan = plan(&scene, start, goal, &rounded()).unwrap();
    let (straight, arcs) = (0.3 + 0.4 + 0.3, PI * 0.075);
    let slack = arcs * ARC_EXCESS + 0.001;
    assert!(plan.length >= straight + arcs - 1e-9, "{}", plan.length);
    assert!(plan.length <= straight + arcs + slack, "{} {}", plan.length, straight + arcs);
}

#[test]
fn a_gap_at_a_diagonal_that_squares_close_is_open_to_a_disc() {
    // The corners are 0.12·√2 = 0.17 m apart, the robot is 0.15 m wide; squares of it touch.
    let mut scene = Scene::new(2.0, 2.0);
    scene.obstacles =
        [Rect::new(0.0, 0.0, 0.94, 0.94), Rect::new(1.06, 1.06, 2.0, 2.0)].map(Into::into).to_vec();
    let [start, goal] = [Point::new(0.3, 1.7), Point::new(1.7, 0.3)];
    assert_eq!(plan(&scene, start, goal, &PlanOptions::default()).unwrap_err().code(), "no_path");
    let way = plan(&scene, start, goal, &rounded()).unwrap();
    assert!(way.clearance >= 0.075 - 1e-9);
    scene.robot_radius = 0.12 / 2.0 * 2_f64.sqrt() + 0.0001;
    assert_eq!(plan(&scene, start, goal, &rounded()).unwrap_err().code(), "no_path");
}

#[test]
fn zero_gap_stays_blocked() {
    let mut scene = Scene::new(2.0, 2.0);
    let upper = |y0: f64| Rect::new(0.9, y0, 1.1, 2.0).into();
    scene.obstacles = vec![Rect::new(0.9, 0.0, 1.1, 0.925).into(), upper(1.075)];
    let [start, goal] = [Point::new(0.3, 0.7), Point::new(1.7, 1.2)];
    assert_eq!(plan(&scene, start, goal, &rounded()).unwrap_err().code(), "no_path");
    scene.obstacles[1] = upper(1.0755);
    assert!(plan(&scene, start, goal, &rounded()).is_ok());
}

#[test]
fn a_start_between_arc_and_square_needs_no_exit() {
    let mut scene = Scene::new(2.0, 2.0);
    scene.obstacles.push(Rect::new(0.8, 0.8, 1.2, 1.2).into());
    // 0.0778 m from the corner, diagonally: inside the square growth, outside the disc's.
    let start = Point::new(0.745, 0.745);
    let way = plan(&scene, start, Point::new(1.5, 1.5), &rounded()).unwrap();
    assert_eq!(way.exit_leg, None);
    assert!(
        plan(&scene, start, Point::new(1.5, 1.5), &PlanOptions::default())
            .unwrap()
            .exit_leg
            .is_some()
    );
    // Exactly on the arc (a 3-4-5 triangle), inside the tangents' polygon.
    let on_arc = Point::new(1.2 + 0.045, 1.2 + 0.06);
    let way = plan(&scene, on_arc, Point::new(0.3, 0.3), &rounded()).unwrap();
    assert!(way.exit_leg.is_none() && way.clearance >= 0.075 - 1e-9);
}

#[test]
fn inflation_by_a_disc_is_for_the_exact_planner_alone() {
    let scene = Scene::new(2.0, 2.0);
    let options = PlanOptions { planner: Planner::Grid, ..rounded() };
    assert_eq!(PreparedArena::new(&scene, &options).unwrap_err().code(), "disc_needs_exact");
}

/// A shortest way in `f64` over the polygons that replace each box grown by `reach` with `count`
/// vertices on every corner's circle; slow, and of another make than the search.
fn slow(scene: &Scene, reach: f64, count: usize, start: Point, goal: Point) -> Option<f64> {
    let r = scene.robot_radius;
    let polygon = |b: &Rect| -> Vec<Point> {
        let corners = [(b.x1, b.y1, 0.0), (b.x0, b.y1, 0.5), (b.x0, b.y0, 1.0), (b.x1, b.y0, 1.5)];
        corners
            .iter()
            .flat_map(|&(x, y, turned)| {
                (0..=count).map(move |i| {
                    let angle = PI * (turned + 0.5 * i as f64 / count as f64);
                    Point::new(x + reach * angle.cos(), y + reach * angle.sin())
                })
            })
            .collect()
    };
    let rects = scene.obstacles.iter().filter_map(|obstacle| obstacle.footprint.as_rect());
    let polygons: Vec<Vec<Point>> = rects.map(|rect| polygon(&rect)).collect();
    let cross =
        |a: Point, b: Point, c: Point| (b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x);
    let crosses = |a: Point, b: Point, polygon: &[Point]| {
        // The part of the leg that lies inside all sides of the convex polygon.
        let (mut low, mut high) = (0.0_f64, 1.0_f64);
        for (i, &p) in polygon.iter().enumerate() {
            let q = polygon[(i + 1) % polygon.len()];
            let (at_a, at_b) = (cross(p, q, a), cross(p, q, b));
            let depth = 1e-10;
            match (at_a > depth, at_b > depth) {
                (false, false) => return false,
                (true, false) => high = high.min((at_a - depth) / (at_a - at_b)),
                (false, true) => low = low.max((at_a - depth) / (at_a - at_b)),
                (true, true) => {}
            }
        }
        low < high
    };
    let within = |p: &Point| {
        (r..=scene.arena.width - r).contains(&p.x) && (r..=scene.arena.height - r).contains(&p.y)
    };
    let mut points = vec![start, goal];
    points.extend(polygons.iter().flatten().filter(|point| within(point)));
    let mut length = vec![f64::INFINITY; points.len()];
    let mut done = vec![false; points.len()];
    length[0] = 0.0;
    while let Some(at) =
        (0..points.len()).filter(|&i| !done[i]).min_by(|&i, &j| length[i].total_cmp(&length[j]))
    {
        if at == 1 || length[at].is_infinite() {
            break;
        }
        done[at] = true;
        for to in (0..points.len()).filter(|&to| !done[to]) {
            let through = length[at] + points[at].distance(points[to]);
            let is_free = || !polygons.iter().any(|p| crosses(points[at], points[to], p));
            if through < length[to] && is_free() {
                length[to] = through;
            }
        }
    }
    length[1].is_finite().then_some(length[1])
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(120))]
    #[test]
    fn the_length_lies_between_those_of_thinner_and_of_thicker_polygons(
        boxes in proptest::collection::vec(proptest::array::uniform4(0.0..1.0_f64), 1..5),
        [x0, y0, x1, y1] in proptest::array::uniform4(0.1..1.9_f64),
    ) {
        let whole = |metres: f64| (metres * 10_000.0).round() / 10_000.0;
        let mut scene = Scene::new(2.0, 2.0);
        scene.obstacles = boxes.iter().map(|&[x, y, w, h]| {
            let (x, y) = (1.8 * x, 1.8 * y);
            Rect::new(whole(x), whole(y), whole(x + 0.02 + 0.5 * w), whole(y + 0.02 + 0.5 * h)).into()
        }).collect();
        let (start, goal) = (Point::new(whole(x0), whole(y0)), Point::new(whole(x1), whole(y1)));
        let options = rounded();
        let mut arena = PreparedArena::new(&scene, &options).unwrap();
        let found = match arena.plan(start, goal) {
            Ok(plan) if plan.exit_leg.is_none() => Some(plan),
            Err(error) if error.code() == "no_path" => None,
            _ => return Ok(()),
        };
        // Vertices on the circle: the polygon lies inside the disc. On a circle 1.7 mm larger, eight chords
        // over a quarter lie outside the disc's polygon of tangents.
        let least = slow(&scene, 0.075, 6, start, goal);
        match found {
            Some(plan) => {
                prop_assert!(plan.clearance >= 0.075 - 1e-9, "{}", plan.clearance);
                let least = least.unwrap_or(f64::INFINITY);
                prop_assert!(plan.length >= least - 1e-6, "{} below {least}", plan.length);
                if let Some(most) = slow(&scene, 0.0767, 8, start, goal) {
                    prop_assert!(plan.length <= most + 1e-6, "{} above {most}", plan.length);
                }
                let square = crate::plan::plan(&scene, start, goal, &PlanOptions::default());
                if let Ok(square) = square.map_err(|_| ()) {
                    prop_assert!(square.exit_leg.is_some() || plan.length <= square.length + 1e-12);
                }
            }
            None => {
                let thick = slow(&scene, 0.0767, 8, start, goal);
                prop_assert!(thick.is_none(), "a way of {thick:?} exists");
            }
        }
    }
}

#[test]
fn the_square_test_is_stricter_than_the_disc_s() {
    let mut scene = Scene::new(2.0, 2.0);
    scene.obstacles.push(Rect::new(0.8, 0.8, 1.2, 1.2).into());
    let way = plan(&scene, Point::new(0.3, 0.9), Point::new(1.2, 1.66), &rounded()).unwrap();
    let points: Vec<_> =
        way.waypoints.iter().filter_map(|&p| crate::grid::LatticePoint::nearest(p)).collect();
    let arena = crate::grid::enlarge(&scene, 0.0).unwrap();
    assert!(LegTest::new(&arena).check_path(&points).is_err());
}

/// A random simple polygon: corners around a centre, in the order of their angles, so that it may be
/// concave and never crosses itself.
fn star() -> impl Strategy<Value = Vec<(i128, i128)>> {
    let corner = proptest::collection::vec((0..8_u8, 1..7_i128), 3..9);
    (0..21_i128, 0..21_i128, corner).prop_map(|(x, y, mut corners)| {
        const AROUND: [(i128, i128); 8] =
            [(1, 0), (1, 1), (0, 1), (-1, 1), (-1, 0), (-1, -1), (0, -1), (1, -1)];
        corners.sort_unstable();
        corners.dedup_by_key(|(direction, _)| *direction);
        let at = |&(direction, reach): &(u8, i128)| {
            let (dx, dy) = AROUND[usize::from(direction)];
            (x + reach * dx, y + reach * dy)
        };
        corners.iter().map(at).collect()
    })
}

fn to_polygon(corners: &[(i128, i128)]) -> Option<Polygon> {
    let point = |&(x, y): &(i128, i128)| Point::new(x as f64, y as f64);
    Polygon::new(corners.iter().map(point).collect()).ok()
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(2000))]
    /// Small whole coordinates, so that corners in line, touching shapes and shared edges are many.
    #[test]
    fn without_a_radius_the_way_is_as_long_as_the_exact_one(
        stars in proptest::collection::vec(star(), 1..7),
        ends in proptest::collection::vec((0..21_i128, 0..21_i128), 6),
    ) {
        let mut scene = Scene::new(20.0, 20.0);
        scene.robot_radius = 0.0;
        let mut oracle = Oracle { size: 20, polygons: vec![] };
        for star in &stars {
            let Some(polygon) = to_polygon(star) else { continue };
            if polygon.corners().iter().all(|p| (0.0..20.0).contains(&p.x) && (0.0..20.0).contains(&p.y)) {
                let whole = |p: &Point| (p.x as i128, p.y as i128);
                oracle.polygons.push(polygon.corners().iter().map(whole).collect());
                scene.obstacles.push(polygon.into());
            }
        }
        let options = rounded();
        let mut arena = PreparedArena::new(&scene, &options).unwrap();
        for pair in ends.chunks(2) {
            let (start, goal) = (pair[0], pair[1]);
            let point = |at: (i128, i128)| Point::new(at.0 as f64, at.1 as f64);
            if start == goal || !(oracle.is_free(start) && oracle.is_free(goal)) {
                continue;
            }
            let exact = oracle.shortest(start, goal);
            match arena.plan(point(start), point(goal)) {
                Ok(plan) => {
                    let exact = exact.unwrap_or(f64::INFINITY);
                    prop_assert!(
                        (plan.length - exact).abs() <= 1e-6,
                        "{} is not {exact}: {:?} {:?}", plan.length, plan.waypoints, scene.obstacles
                    );
                }
                Err(error) => prop_assert!(
                    exact.is_none(), "{error}, but a way of {exact:?} exists from {start:?} to {goal:?} {:?}", scene.obstacles
                ),
            }
        }
    }
}

#[test]
fn a_turned_box_and_a_disc_are_passed_at_the_radius() {
    let mut scene = Scene::new(2.0, 1.0);
    let turned = [[1.0, 0.3], [1.2, 0.5], [1.0, 0.7], [0.8, 0.5]].map(Point::from).to_vec();
    scene.obstacles.push(Polygon::new(turned).unwrap().into());
    let [start, goal] = [Point::new(0.5, 0.5), Point::new(1.5, 0.5)];
    let way = plan(&scene, start, goal, &PlanOptions::default()).unwrap();
    assert_eq!(way.inflation, Inflation::Disc);
    assert!((0.075..0.0755).contains(&way.clearance), "{}", way.clearance);
    // Two tangents to the circle around the corner (1, 0.7), and the arc between them.
    let (reach, radius) = (0.5_f64.hypot(0.2), 0.075);
    let tangent = (reach * reach - radius * radius).sqrt();
    let arc = 2.0 * (0.2_f64.atan2(0.5) + (radius / reach).asin());
    let exact = 2.0 * tangent + radius * arc;
    assert!(way.length > exact && way.length < exact + 0.0005, "{} {exact}", way.length);

    scene.obstacles = vec![Circle { centre: Point::new(1.0, 0.5), radius: 0.2 }.into()];
    let way = plan(&scene, start, goal, &PlanOptions::default()).unwrap();
    let (reach, radius) = (0.5_f64, 0.275_f64);
    let exact = 2.0 * ((reach * reach - radius * radius).sqrt() + radius * (radius / reach).asin());
    assert!(way.length > exact && way.length < exact + 0.001, "{} {exact}", way.length);
}

#[test]
fn a_gap_between_two_shapes_is_named_with_its_width() {
    let mut scene = Scene::new(2.0, 1.0);
    let wedge = [[0.8, 0.0], [1.2, 0.0], [1.0, 0.5]].map(Point::from).to_vec();
    scene.obstacles.push(Polygon::new(wedge).unwrap().into());
    scene.obstacles.push(Circle { centre: Point::new(1.0, 0.8), radius: 0.2 }.into());
    let error = plan(&scene, Point::new(0.3, 0.5), Point::new(1.7, 0.5), &PlanOptions::default());
    let text = error.unwrap_err().to_string();
    assert!(text.contains("a gap of 10.0 cm between obstacle 1 and obstacle 2"), "{text}");
}

#[test]
fn a_start_too_near_to_a_turned_edge_is_led_straight_away_from_it() {
    let mut scene = Scene::new(2.0, 2.0);
    let turned = [[0.5, 0.0], [2.0, 0.0], [2.0, 1.5]].map(Point::from).to_vec();
    scene.obstacles.push(Polygon::new(turned).unwrap().into());
    // 40 mm from the edge y = x − 0.5.
    let off = 0.04 / 2_f64.sqrt();
    let start = Point::new(1.25 - off, 0.75 + off);
    let way = plan(&scene, start, Point::new(0.3, 1.7), &PlanOptions::default()).unwrap();
    let exit = way.exit_leg.unwrap();
    assert!((0.035..0.036).contains(&exit), "{exit}");
    assert!((way.clearance - 0.04).abs() < 1e-9, "{}", way.clearance);
    let inside = plan(&scene, Point::new(1.5, 0.5), Point::new(0.3, 1.7), &PlanOptions::default());
    assert_eq!(inside.unwrap_err().code(), "start_blocked");
}

#[test]
fn a_margin_of_a_shape_is_kept_too() {
    let mut scene = Scene::new(2.0, 1.0);
    let disc = Circle { centre: Point::new(1.0, 0.5), radius: 0.1 };
    scene.obstacles.push(crate::scene::Obstacle { margin: [0.02; 4], ..disc.into() });
    let options = PlanOptions { margin: 0.005, ..PlanOptions::default() };
    let way = plan(&scene, Point::new(0.3, 0.5), Point::new(1.7, 0.5), &options).unwrap();
    assert!((0.1..0.1005).contains(&way.clearance), "{}", way.clearance);
}

#[test]
fn the_paper_s_planners_cover_shapes_and_keep_off_them() {
    let mut scene = Scene::new(2.0, 2.0);
    let turned = [[0.5, 0.4], [1.6, 1.1], [1.5, 1.3], [0.4, 0.6]].map(Point::from).to_vec();
    scene.obstacles.push(Polygon::new(turned).unwrap().into());
    let [start, goal] = [Point::new(0.3, 1.7), Point::new(1.7, 0.3)];
    let exact = plan(&scene, start, goal, &PlanOptions::default()).unwrap();
    let options = PlanOptions { planner: Planner::Grid, ..PlanOptions::default() };
    let way = plan(&scene, start, goal, &options).unwrap();
    assert_eq!(way.inflation, Inflation::Square);
    assert!(way.clearance >= 0.075 && way.length >= exact.length, "{way:?}");
    assert!(way.grid.is_some());
}
