//! The paper's experiment, and the grid method on arenas that nobody drew for it.

use super::*;
use crate::geometry::Rect;
use crate::grid::Area;
use crate::map::CellMap;
use proptest::prelude::*;

/// The experiment of the paper as reconstructed in `assets/paper.json` [Alghannam, Sec. V].
fn paper(planner: Planner) -> Plan {
    let scene = Scene::from_json(include_str!("../../assets/paper.json")).unwrap();
    let (start, goal) = (scene.start.unwrap().position, scene.goal.unwrap().position);
    plan(&scene, start, goal, &PlanOptions { planner, ..Default::default() }).unwrap()
}

#[test]
fn the_paper_s_mini_matrix_is_7_by_5_with_start_48_and_goal_13() {
    let stages = paper(Planner::Grid).grid.unwrap();
    // 9 × 7 with the dead ring along the border.
    assert_eq!(
        stages.matrix.elements(),
        [
            [0, 0, 0, 0, 0, 0, 0],
            [0, 1, 1, 1, 1, 2, 0],
            [0, 1, 1, 1, 0, 1, 0],
            [0, 1, 1, 1, 0, 0, 0],
            [0, 0, 1, 1, 0, 0, 0],
            [0, 0, 1, 1, 0, 1, 0],
            [0, 0, 1, 1, 1, 2, 0],
            [0, 0, 0, 1, 1, 1, 0],
            [0, 0, 0, 0, 0, 0, 0],
        ]
    );
    let terminals: Vec<usize> = stages
        .matrix
        .areas()
        .filter(|&area| stages.matrix.kind(area) == crate::grid::AreaKind::Terminal)
        .map(Area::number)
        .collect();
    assert_eq!(terminals, [13, 48]);
}

#[test]
fn exactly_areas_20_and_41_of_the_paper_are_traps_with_six_zeros_each() {
    let stages = paper(Planner::Grid).grid.unwrap();
    let numbers: Vec<usize> = stages.traps.iter().map(|area| area.number()).collect();
    assert_eq!(numbers, [20, 41]);
    for &trap in &stages.traps {
        let around = stages.matrix.around(trap);
        let zeros = around.iter().flatten().filter(|next| !stages.matrix.is_live(**next));
        assert_eq!(zeros.count(), 6);
    }
}

#[test]
fn the_paper_s_best_path_has_three_legs() {
    for planner in [Planner::Exact, Planner::Grid, Planner::Tree] {
        let plan = paper(planner);
        let corners = [(1.4, 0.35), (0.875, 0.475), (0.875, 1.525), (1.4, 1.75)];
        assert_eq!(plan.waypoints, corners.map(|(x, y)| Point::new(x, y)));
        assert!((plan.length - 2.160_859).abs() < 1e-6);
        assert!((plan.clearance - 0.075).abs() < 1e-12);
    }
}

#[test]
fn the_paper_s_tree_is_drawn_whole() {
    let tree = paper(Planner::Tree).grid.unwrap().tree.unwrap();
    assert_eq!((tree.nodes.len(), tree.arrivals.len(), tree.cut), (665, 98, 0));
}

#[test]
fn start_and_goal_in_one_area_are_joined_by_a_straight_line() {
    let scene = Scene::new(1.0, 1.0);
    let ends = [Point::new(0.2, 0.3), Point::new(0.812_345_6, 0.7)];
    let plan = plan(&scene, ends[0], ends[1], &PlanOptions::default()).unwrap();
    assert_eq!(plan.waypoints, ends);
    let same = super::plan(&scene, ends[0], ends[0], &PlanOptions::default()).unwrap();
    assert_eq!((same.length, same.waypoints.len()), (0.0, 2));
}

#[test]
fn a_walled_goal_is_an_error() {
    let mut scene = Scene::new(1.0, 1.0);
    scene.obstacles.push(Rect::new(0.45, 0.0, 0.55, 1.0).into());
    let error = plan(&scene, Point::new(0.1, 0.1), Point::new(0.9, 0.9), &PlanOptions::default());
    assert_eq!(error.unwrap_err().code(), "no_path");
}

/// Boxes in steps of 5 cm in an arena of 2 × 2 m, so that touching and flush edges abound.
fn coarse_scene() -> impl Strategy<Value = Scene> {
    let side = (0..38_i32, 1..10_i32);
    proptest::collection::vec((side.clone(), side), 0..9).prop_map(|boxes| {
        let mut scene = Scene::new(2.0, 2.0);
        scene.robot_radius = 0.05;
        let metres = |steps: i32| f64::from(steps) / 20.0;
        scene.obstacles = boxes
            .iter()
            .map(|&((x, w), (y, h))| {
                Rect::new(metres(x), metres(y), metres(x + w), metres(y + h)).into()
            })
            .collect();
        scene
    })
}

proptest! {
    #[test]
    fn no_path_comes_nearer_than_the_radius_and_exact_is_the_shortest(
        scene in coarse_scene(),
        ends in proptest::array::uniform4(0.06..1.94_f64),
    ) {
        let (start, goal) = (Point::new(ends[0], ends[1]), Point::new(ends[2], ends[3]));
        let mut lengths = Vec::new();
        for planner in [Planner::Exact, Planner::Grid, Planner::Tree] {
            match plan(&scene, start, goal, &PlanOptions { planner, ..Default::default() }) {
                // What an exit leg may do is tested with it.
                Ok(plan) if plan.exit_leg.is_some() => return Ok(()),
                Ok(plan) => {
                    // Half a unit is what an end may move on the lattice.
                    prop_assert!(plan.clearance >= 0.05 - 0.75e-4, "{}", plan.clearance);
                    lengths.push(plan.length);
                }
                Err(error) => prop_assert!(!matches!(error, PlanError::Unsafe { .. }), "{error}"),
            }
        }
        prop_assert!(matches!(lengths.len(), 0 | 3), "one planner finds a way, another none");
        let exact = lengths.first().copied().unwrap_or_default();
        prop_assert!(lengths.iter().all(|&other| exact <= other * (1.0 + 1e-9)), "{lengths:?}");
    }
}

#[test]
fn exact_lengths_are_those_of_the_arenas_and_the_paper_s_are_not_far_off() {
    for text in [
        include_str!("../../../tests/fixtures/gap_n10_s0.json"),
        include_str!("../../../tests/fixtures/over_n10_s0.json"),
    ] {
        let scene = Scene::from_json(text).unwrap();
        for planner in [Planner::Exact, Planner::Grid, Planner::Tree] {
            let options = PlanOptions { planner, ..Default::default() };
            let mut arena = PreparedArena::new(&scene, &options).unwrap();
            for query in &scene.queries {
                let plan = arena.plan(query.start, query.goal).unwrap();
                // The files give nine decimals.
                let (least, most) = (query.length.unwrap() - 1e-9, query.length.unwrap() + 1e-9);
                let bound = if planner == Planner::Exact { 1.0 } else { WORST_OF_THE_PAPER };
                assert!(least <= plan.length && plan.length <= most * bound, "{}", plan.length);
            }
        }
    }
}

#[test]
fn the_tree_among_eight_boxes_ends_within_its_bound_and_counts_what_it_cut() {
    let mut scene = Scene::new(3.0, 3.0);
    scene.obstacles = (0..8)
        .map(|i| {
            let (x, y) = (0.4 + 0.8 * f64::from(i % 3), 0.4 + 0.8 * f64::from(i / 3));
            let shift = 0.05 * f64::from(i);
            Rect::new(x + shift / 2.0, y + shift, x + 0.25, y + shift + 0.2).into()
        })
        .collect();
    let ends = [Point::new(0.2, 0.2), Point::new(2.8, 2.8)];
    let options = PlanOptions { planner: Planner::Tree, ..Default::default() };
    let found = plan(&scene, ends[0], ends[1], &options).unwrap();
    let tree = found.grid.unwrap().tree.unwrap();
    // An area has at most eight children, and the last to grow may begin just below the limit.
    assert!(tree.nodes.len() < NODE_LIMIT + 8 && !tree.arrivals.is_empty());
    assert!(tree.cut > 0, "this many boxes have more paths than the limit");
    let exact = plan(&scene, ends[0], ends[1], &PlanOptions::default()).unwrap();
    assert!(found.length >= exact.length - 1e-9);
}

/// A first query searches by cones, the next ones use roads: both must give the length to 1e-9 of it.
fn assert_exact(scene: &Scene, rows: &[(Point, Point, f64)]) {
    let options = PlanOptions::default();
    let mut asked_before = PreparedArena::new(scene, &options).unwrap();
    for &(start, goal, exact) in rows {
        let first = PreparedArena::new(scene, &options).unwrap().plan(start, goal).unwrap();
        let again = asked_before.plan(start, goal).unwrap();
        for length in [first.length, again.length] {
            // The files give nine decimals.
            let slack = 1e-9 * exact.max(1.0) + 0.5e-9;
            assert!(
                (length - exact).abs() <= slack,
                "{length} instead of {exact}: {start:?} {goal:?}"
            );
        }
    }
}

#[test]
fn lengths_in_arenas_of_100_boxes_are_exact() {
    for text in [
        include_str!("../../../tests/fixtures/gap_n100_s0.json"),
        include_str!("../../../tests/fixtures/over_n100_s2.json"),
    ] {
        let scene = Scene::from_json(text).unwrap();
        let row = |query: &crate::scene::Query| (query.start, query.goal, query.length.unwrap());
        assert_exact(&scene, &scene.queries.iter().map(row).collect::<Vec<_>>());
    }
}

#[test]
fn lengths_on_maps_of_moving_ai_are_exact_also_where_three_corners_lie_on_one_ray() {
    for (map, rows) in [
        (
            include_str!("../../../tests/fixtures/movingai/arena.map"),
            include_str!("../../../tests/fixtures/movingai/arena.rows"),
        ),
        (
            include_str!("../../../tests/fixtures/movingai/lak103d.map"),
            include_str!("../../../tests/fixtures/movingai/lak103d.rows"),
        ),
    ] {
        let cells = CellMap::from_movingai(map, 1.0).unwrap();
        let row = |line: &str| {
            let fields: Vec<f64> = line.split(' ').map(|field| field.parse().unwrap()).collect();
            let [sx, sy, gx, gy, length] = fields[..] else { panic!("{line}") };
            let at = |x: f64, y: f64| Point::new(x, cells.rows as f64 - y);
            (at(sx, sy), at(gx, gy), length)
        };
        assert_exact(&cells.to_scene(0.0), &rows.lines().map(row).collect::<Vec<_>>());
    }
}

/// How much longer than the shortest the paper's ways are on these arenas at most: 1.0076, rounded up.
const WORST_OF_THE_PAPER: f64 = 1.01;
