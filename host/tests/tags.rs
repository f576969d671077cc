//! Tags that were drawn by other code than finds them: all found, corners to a tenth of a pixel, nothing else.

#![allow(clippy::unwrap_used, reason = "helpers of tests fail as tests do")]

mod drawn_tags;

use drawn_tags::{Canvas, DrawnTag};
use proptest::prelude::*;
use std::f64::consts::TAU;
use wmr::geometry::{Arena, Point};
use wmr::shape::Circle;
use wmr::vision::{
    DetectOptions, Tag, TagDictionary, TagPoint, VisionError, detect, find_tags, homography,
};

/// A tag on a small piece of floor and what is found there.
fn seen(drawn: &DrawnTag, smear: usize, seed: u64) -> Vec<Tag> {
    let mut random = fastrand::Rng::with_seed(seed);
    let mut canvas = Canvas::floor(200, 200, &mut random);
    canvas.tag(drawn);
    if smear > 1 {
        canvas.smear(smear);
    }
    find_tags(&canvas.photo(0.8, 2.0, &mut random), &TagDictionary::usual())
}

fn worst_corner(drawn: &DrawnTag, tag: &Tag) -> f64 {
    let pairs = drawn.corners.iter().zip(&tag.corners_px);
    pairs.map(|(a, b)| (a[0] - b[0]).hypot(a[1] - b[1])).fold(0.0, f64::max)
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(48))]

    #[test]
    fn a_tag_of_twenty_pixels_is_found_whichever_way_it_lies(
        family in 0..3usize, id in 0..30usize, side in 20.0..60.0f64,
        turn in 0.0..TAU, tilt in 0.0..1.0f64, axis in 0.0..TAU, seed in 0..1000u64,
    ) {
        let dictionary = TagDictionary::named(["4X4_50", "6X6_250", "36h11"][family]).unwrap();
        let lying = |side: f64| DrawnTag::tilted((dictionary, id), [99.3, 101.6], side, [turn, tilt, axis]);
        let drawn = lying(side * side / lying(side).shortest_side());
        let found = seen(&drawn, 1, seed);
        prop_assert_eq!(found.len(), 1);
        prop_assert_eq!((found[0].id, found[0].dictionary.side()), (id, dictionary.side()));
        prop_assert!(worst_corner(&drawn, &found[0]) < 0.5, "{:?} {:?}", drawn, found);
    }
}

#[test]
fn a_tag_is_read_through_three_pixels_of_motion() {
    let dictionary = TagDictionary::named("4X4_50").unwrap();
    for id in 0..20 {
        let turn = id as f64 * 0.31;
        let drawn = DrawnTag::tilted((dictionary, id), [90.0, 100.0], 20.0, [turn, 0.2, 1.0]);
        let found = seen(&drawn, 3, id as u64);
        assert_eq!(found.iter().map(|tag| tag.id).collect::<Vec<_>>(), [id]);
        // The smeared picture's own middle is within half a pixel of the drawn one.
        assert!(worst_corner(&drawn, &found[0]) < 0.7, "{found:?}");
    }
}

#[test]
fn a_floor_without_tags_shows_none() {
    let all: Vec<TagDictionary> = TagDictionary::usual();
    for seed in 0..20 {
        let mut random = fastrand::Rng::with_seed(seed);
        let photo = Canvas::floor(320, 240, &mut random).photo(0.8, 2.0, &mut random);
        assert_eq!(find_tags(&photo, &all), []);
    }
}

const ARENA: Arena = Arena { width: 1.6, height: 1.2 };

/// Where the arena's corners appear: seen at an angle, on a floor without any border.
const SEEN: [[f64; 2]; 4] = [[60.0, 520.0], [715.0, 505.0], [640.0, 70.0], [130.0, 62.0]];

/// The arena with tags of `which` corners, a tag on the robot at (0.4, 0.5) that looks up and to the left,
/// one at the goal, and a dark box; tags are 90 mm wide.
fn arena(which: &[usize]) -> wmr::vision::Photo {
    let floor = [[0.0, 0.0], [1.6, 0.0], [1.6, 1.2], [0.0, 1.2]];
    let map = homography(floor, SEEN).unwrap();
    let pixel = |[x, y]: [f64; 2]| {
        let image = map * nalgebra::Vector3::new(x, y, 1.0);
        [image.x / image.z, image.y / image.z]
    };
    let mut random = fastrand::Rng::with_seed(5);
    let mut canvas = Canvas { width: 760, height: 580, codes: vec![175.0; 760 * 580] };
    canvas.fill([[0.9, 0.5], [1.2, 0.5], [1.2, 0.8], [0.9, 0.8]].map(pixel), |_| Some(35.0));
    let dictionary = TagDictionary::named("4X4_50").unwrap();
    let mut tag = |id: usize, [x, y]: [f64; 2], turn: f64| {
        // Clockwise as the picture shows them, from the tag's own top left, whose right edge points to `turn`.
        let corners =
            [[-1.0, 1.0], [1.0, 1.0], [1.0, -1.0], [-1.0, -1.0]].map(|[u, v]: [f64; 2]| {
                let (u, v) = (0.045 * u, 0.045 * v);
                let (sin, cos) = turn.sin_cos();
                pixel([x + u * cos - v * sin, y + u * sin + v * cos])
            });
        canvas.tag(&DrawnTag { dictionary, id, corners });
    };
    let corners = [[0.045, 0.045], [1.555, 0.045], [1.555, 1.155], [0.045, 1.155]];
    which.iter().for_each(|&corner| tag(10 + corner, corners[corner], 0.0));
    tag(7, [0.4, 0.5], 2.0);
    tag(8, [1.4, 0.95], 0.5);
    canvas.photo(0.7, 2.0, &mut random)
}

fn by_tags() -> DetectOptions {
    DetectOptions {
        tags: Some(TagPoint::Outer),
        robot_tag: Some(7),
        goal_tag: Some(8),
        robot_height: 0.0,
        ..DetectOptions::default()
    }
}

#[test]
fn tags_give_arena_robot_and_goal_and_are_no_obstacles() {
    let seen = detect(&arena(&[0, 1, 2, 3]), ARENA, &by_tags()).unwrap();
    for (found, drawn) in seen.corners_px.iter().zip(SEEN) {
        assert!((found[0] - drawn[0]).hypot(found[1] - drawn[1]) < 0.4, "{found:?} {drawn:?}");
    }
    let robot = seen.robot.unwrap();
    assert!(robot.position.distance(Point::new(0.4, 0.5)) < 0.002, "{robot:?}");
    assert!((robot.heading - 2.0).abs() < 0.02, "{robot:?}");
    assert!(seen.goal.unwrap().distance(Point::new(1.4, 0.95)) < 0.002);
    assert_eq!(seen.obstacles.len(), 1, "{:?}", seen.obstacles);
    assert!(seen.obstacles[0].footprint.contains(Point::new(1.05, 0.65)));
}

/// The corners that have no tag are found so well, pixels of a picture of SEEN's size.
const BRIDGED: f64 = 3.0;

#[test]
fn corners_without_a_tag_follow_from_the_other_tags() {
    let sights: [(&[usize], &str); 4] = [
        (&[0, 1, 3], "upper right of"),
        (&[1, 2, 3], "lower left of"),
        (&[0, 2], "lower right and the upper left of"),
        (&[0, 1], "upper right and the upper left of"),
    ];
    for (which, missing) in sights {
        let seen = detect(&arena(which), ARENA, &by_tags()).unwrap();
        assert!(seen.warnings[0].to_string().contains(missing), "{which:?} {:?}", seen.warnings);
        for (found, drawn) in seen.corners_px.iter().zip(SEEN) {
            let off = (found[0] - drawn[0]).hypot(found[1] - drawn[1]);
            assert!(off < BRIDGED, "{which:?}: {found:?} {drawn:?}, {:?}", seen.warnings);
        }
    }
}

#[test]
fn one_corner_tag_is_refused_and_named() {
    let error = detect(&arena(&[3]), ARENA, &by_tags()).unwrap_err();
    assert_eq!(error, VisionError::CornerTags { seen: vec![13] });
    assert!(error.to_string().starts_with("one tag (13) was found in"), "{error}");
}

#[test]
fn tags_of_other_sizes_than_one_another_are_not_bridged() {
    // The goal's tag taken for one of a corner fits nowhere.
    let options = DetectOptions { goal_tag: None, ..by_tags() };
    let error = detect(&arena(&[0, 1]), ARENA, &options).unwrap_err();
    assert!(matches!(&error, VisionError::CornerTags { seen } if seen.len() == 3), "{error}");
}

#[test]
fn a_tag_that_is_not_in_the_robots_middle_says_where_that_is() {
    let mount = wmr::geometry::Pose::new(0.03, -0.02, 0.5);
    let options = DetectOptions { robot_tag_mount: mount, ..by_tags() };
    let robot = detect(&arena(&[0, 1, 2, 3]), ARENA, &options).unwrap().robot.unwrap();
    // The tag is at (0.4, 0.5) and points to 2.0 rad; the robot looks 0.5 rad further clockwise.
    let (sin, cos) = 1.5f64.sin_cos();
    let middle = Point::new(0.4 - 0.03 * cos - 0.02 * sin, 0.5 - 0.03 * sin + 0.02 * cos);
    assert!(robot.position.distance(middle) < 0.002, "{robot:?}");
    assert!((robot.heading - 1.5).abs() < 0.02, "{robot:?}");
}

#[test]
fn what_is_to_be_ignored_and_an_unmarked_robot_are_no_obstacles() {
    let options = DetectOptions {
        robot_tag: None,
        robot_at: Some(wmr::geometry::Pose::new(0.4, 0.5, 1.0)),
        ignored: vec![Circle { centre: Point::new(1.05, 0.65), radius: 0.25 }],
        ..by_tags()
    };
    // The robot's tag is one more tag, but none of the four that stand furthest out.
    let seen = detect(&arena(&[0, 1, 2, 3]), ARENA, &options).unwrap();
    assert_eq!(seen.robot, options.robot_at);
    assert!(seen.obstacles.is_empty(), "{:?}", seen.obstacles);
}
