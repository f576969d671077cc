//! The catalogue of degenerate arenas, and random ones against the oracle.

use super::super::LegTest;
use super::oracle::Oracle;
use super::*;
use proptest::prelude::*;

const SIZE: i32 = 12;

fn arena(boxes: &[[i32; 4]]) -> EnlargedArena {
    let inside = LatticeRect::new(0, 0, SIZE, SIZE);
    let boxes = boxes.iter().map(|&[a, b, c, d]| LatticeRect::new(a, b, c, d)).collect();
    EnlargedArena::new(inside, inside, boxes)
}

/// The shortest way, checked against the oracle and the leg test.
fn way(boxes: &[[i32; 4]], start: (i32, i32), goal: (i32, i32)) -> Option<Vec<(i32, i32)>> {
    let arena = arena(boxes);
    let [start, goal] = [start, goal].map(|(x, y)| LatticePoint::new(x, y));
    let mut exact = Exact::new(&arena);
    let points = exact.shortest(start, goal);
    agrees(&arena, start, goal, points.as_deref()).unwrap();
    exact.expect_many(arena.inside);
    exact.lay_roads();
    let by_roads = exact.shortest(start, goal);
    agrees(&arena, start, goal, by_roads.as_deref()).unwrap();
    points.map(|points| points.iter().map(|p| (p.x, p.y)).collect())
}

fn agrees(
    arena: &EnlargedArena,
    start: LatticePoint,
    goal: LatticePoint,
    points: Option<&[LatticePoint]>,
) -> Result<(), TestCaseError> {
    let Some(points) = points else {
        prop_assert_eq!(Oracle::new(arena).shortest(start, goal), None);
        return Ok(());
    };
    prop_assert_eq!(LegTest::new(arena).check_path(points), Ok(()), "{:?}", points);
    let length: f64 = points.windows(2).map(|leg| leg[0].distance(leg[1])).sum();
    let exact = Oracle::new(arena).shortest(start, goal).unwrap_or(-1.0);
    prop_assert!((length - exact).abs() < 1e-9, "{} instead of {}: {:?}", length, exact, points);
    Ok(())
}

#[test]
fn empty_arena_is_crossed_straight() {
    assert_eq!(way(&[], (0, 0), (12, 12)), Some(vec![(0, 0), (12, 12)]));
}

#[test]
fn start_equal_to_goal_is_a_way_of_no_length() {
    assert_eq!(way(&[[3, 3, 6, 6]], (1, 1), (1, 1)), Some(vec![(1, 1), (1, 1)]));
}

#[test]
fn a_box_is_passed_by_its_corners() {
    assert_eq!(way(&[[3, 0, 6, 6]], (1, 1), (8, 1)), Some(vec![(1, 1), (3, 6), (6, 6), (8, 1)]));
}

#[test]
fn zero_gap_is_blocked() {
    assert_eq!(way(&[[4, 0, 8, 5], [4, 5, 8, 12]], (1, 5), (11, 5)), None);
    assert_eq!(way(&[[0, 4, 5, 8], [5, 4, 12, 8]], (5, 1), (5, 11)), None);
}

#[test]
fn corner_touch_is_blocked() {
    assert_eq!(way(&[[0, 0, 6, 6], [6, 6, 12, 12]], (1, 11), (11, 1)), None);
    assert_eq!(way(&[[0, 6, 6, 12], [6, 0, 12, 6]], (1, 1), (11, 11)), None);
}

#[test]
fn a_gap_of_one_unit_is_a_way() {
    assert_eq!(way(&[[4, 0, 8, 5], [4, 6, 8, 12]], (1, 5), (11, 6)), Some(vec![(1, 5), (11, 6)]));
    assert_eq!(way(&[[0, 4, 5, 8], [6, 4, 12, 8]], (5, 1), (5, 11)), Some(vec![(5, 1), (5, 11)]));
}

#[test]
fn start_on_an_edge_and_on_a_corner_is_free() {
    let square = [[3, 3, 8, 8]];
    assert_eq!(way(&square, (3, 5), (8, 5)).map(|way| way.len()), Some(4));
    assert_eq!(way(&square, (3, 3), (8, 8)).map(|way| way.len()), Some(3));
    assert_eq!(way(&square, (3, 8), (8, 8)), Some(vec![(3, 8), (8, 8)]));
}

#[test]
fn duplicates_and_nested_boxes_are_one_box() {
    let one = way(&[[3, 3, 8, 8]], (1, 5), (11, 6));
    assert_eq!(way(&[[3, 3, 8, 8], [3, 3, 8, 8]], (1, 5), (11, 6)), one);
    assert_eq!(way(&[[3, 3, 8, 8], [4, 4, 6, 8], [5, 5, 6, 6]], (1, 5), (11, 6)), one);
}

#[test]
fn a_box_flush_with_the_wall_leaves_no_way_behind_it() {
    assert_eq!(way(&[[5, 0, 7, 11]], (1, 0), (11, 0)).map(|way| way.len()), Some(4));
    assert_eq!(way(&[[5, 0, 7, 12]], (1, 0), (11, 0)), None);
}

#[test]
fn a_collinear_row_of_boxes_is_passed_in_one_leg() {
    let row = [[2, 2, 4, 5], [5, 3, 7, 5], [8, 1, 10, 5]];
    assert_eq!(way(&row, (0, 5), (12, 5)), Some(vec![(0, 5), (12, 5)]));
    let column = [[2, 2, 5, 4], [3, 5, 5, 7], [1, 8, 5, 10]];
    assert_eq!(way(&column, (5, 0), (5, 12)), Some(vec![(5, 0), (5, 12)]));
    let stairs = [[1, 3, 3, 6], [4, 6, 5, 7], [6, 8, 7, 12]];
    assert!(way(&stairs, (2, 2), (8, 12)).is_some());
}

#[test]
fn a_t_of_touching_boxes_is_one_obstacle() {
    assert_eq!(way(&[[2, 6, 10, 8], [5, 0, 7, 6]], (4, 5), (8, 5)).map(|way| way.len()), Some(6));
}

#[test]
fn a_walled_in_goal_has_no_way() {
    let walls = [[4, 4, 9, 5], [4, 8, 9, 9], [4, 5, 5, 8], [8, 5, 9, 8]];
    assert_eq!(way(&walls, (1, 1), (6, 6)), None);
}

#[test]
fn a_box_as_large_as_the_arena_leaves_no_floor() {
    assert!(Exact::new(&arena(&[[0, 0, 12, 12]])).free().is_empty());
    assert!(Exact::new(&arena(&[[-3, -3, 20, 20]])).free().is_empty());
}

#[test]
fn a_way_along_a_wall_turns_where_the_wall_ends() {
    // Up along the left side of the second box, whose edge is in line with the first one's corner.
    assert_eq!(
        way(&[[3, 0, 5, 3], [5, 5, 9, 9], [0, 10, 4, 12]], (1, 1), (9, 11)),
        way(&[[3, 0, 5, 3], [5, 5, 9, 9]], (1, 1), (9, 11))
    );
}

fn boxes() -> impl Strategy<Value = Vec<[i32; 4]>> {
    let one =
        (-1..SIZE, -1..SIZE, 1..6_i32, 1..6_i32).prop_map(|(x, y, w, h)| [x, y, x + w, y + h]);
    proptest::collection::vec(one, 0..14)
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(4000))]
    #[test]
    fn the_way_is_as_short_as_the_oracle_s(
        boxes in boxes(),
        queries in proptest::collection::vec(proptest::array::uniform4(0..=SIZE), 1..6),
    ) {
        let arena = arena(&boxes);
        let mut exact = Exact::new(&arena);
        for [x0, y0, x1, y1] in queries {
            let (start, goal) = (LatticePoint::new(x0, y0), LatticePoint::new(x1, y1));
            if exact.holds(start) && exact.holds(goal) {
                // The first by cones, the others by roads that each query finds and adds to.
                let points = exact.shortest(start, goal);
                agrees(&arena, start, goal, points.as_deref())?;
                exact.expect_many(arena.inside);
                exact.lay_roads();
            }
        }
    }
}
