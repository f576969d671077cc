//! With a picture of the empty arena the floor may look like anything, as long as the camera stands still.

#![allow(clippy::unwrap_used, reason = "helpers of tests fail as tests do")]

mod drawn_floor;

use drawn_floor::{ARENA, Drawing, Floor};
use std::f64::consts::PI;
use wmr::geometry::Rect;
use wmr::vision::{DetectOptions, Photo, VisionError, check_still, detect};

/// A pixel and a half.
const EDGE_TOLERANCE: f64 = 0.005;

fn boxes() -> [(Rect, [f32; 3]); 3] {
    [
        (Rect::new(0.2, 0.2, 0.45, 0.38), [0.3, 0.05, 0.04]),
        (Rect::new(0.75, 0.55, 0.95, 0.85), [0.05, 0.12, 0.4]),
        (Rect::new(1.05, 0.15, 1.17, 0.4), [0.75, 0.72, 0.68]),
    ]
}

/// The rectangles that are found with or without the empty picture.
fn found(photo: &Photo, empty: Option<Photo>) -> Vec<[f64; 4]> {
    let options = DetectOptions { empty, ..DetectOptions::default() };
    let seen = detect(photo, ARENA, &options).unwrap();
    seen.obstacles.iter().map(|obstacle| obstacle.footprint.bounds().into()).collect()
}

/// Whether exactly the drawn boxes were found.
fn are_right(found: &[[f64; 4]], drawn: &[(Rect, [f32; 3])]) -> bool {
    let near = |rect: &[f64; 4], drawn: &Rect| {
        let drawn: [f64; 4] = (*drawn).into();
        rect.iter().zip(drawn).all(|(a, b)| (a - b).abs() < EDGE_TOLERANCE)
    };
    found.len() == drawn.len()
        && drawn.iter().all(|(drawn, _)| found.iter().any(|rect| near(rect, drawn)))
}

#[test]
fn boxes_on_tiles_and_wood_are_seen_only_with_the_empty_picture() {
    let drawn = boxes();
    for floor in [Floor::Tiles, Floor::Wood] {
        let photo = Drawing { boxes: &drawn, ..Drawing::empty(floor, 1) }.photo();
        let without = found(&photo, None);
        let with = found(&photo, Some(Drawing::empty(floor, 2).photo()));
        assert!(are_right(&with, &drawn), "{floor:?}: {with:?}");
        if matches!(floor, Floor::Tiles) {
            assert!(!are_right(&without, &drawn), "{without:?}");
        }
    }
}

#[test]
fn an_arena_that_is_still_empty_has_no_obstacles_whatever_the_light() {
    for floor in [Floor::Tiles, Floor::Wood, Floor::Plain] {
        for (seed, gain) in [(3, [0.5; 3]), (4, [1.2, 1.0, 0.8]), (5, [2.0; 3])] {
            let photo = Drawing { gain, slope: 0.3, ..Drawing::empty(floor, seed) }.photo();
            let seen = found(&photo, Some(Drawing::empty(floor, 9).photo()));
            assert!(seen.is_empty(), "{floor:?} {gain:?}: {seen:?}");
        }
    }
}

#[test]
fn lamps_and_white_balance_move_no_edge() {
    let drawn = boxes();
    for (seed, gain) in [(3, [0.5; 3]), (4, [1.2, 1.0, 0.8]), (5, [1.3; 3])] {
        let drawing =
            Drawing { boxes: &drawn, gain, slope: 0.3, ..Drawing::empty(Floor::Tiles, seed) };
        let seen = found(&drawing.photo(), Some(Drawing::empty(Floor::Tiles, 9).photo()));
        assert!(are_right(&seen, &drawn), "{gain:?}: {seen:?}");
    }
}

#[test]
fn a_moved_camera_is_refused_with_its_shift_and_one_that_stands_is_not() {
    let drawn = boxes();
    let mut random = fastrand::Rng::with_seed(11);
    for floor in [Floor::Tiles, Floor::Wood, Floor::Plain] {
        let empty = Drawing::empty(floor, 1).photo();
        let drawing = Drawing { boxes: &drawn, gain: [0.8, 0.9, 1.0], ..Drawing::empty(floor, 2) };
        check_still(&drawing.photo(), &empty).unwrap();
        let angle = random.f64() * 2.0 * PI;
        let shift = [angle.cos(), angle.sin()];
        let shifted = Drawing { shift, ..drawing.clone() }.photo();
        let Err(VisionError::EmptyMoved { shift, .. }) = check_still(&shifted, &empty) else {
            panic!("{floor:?} shifted by {shift:?}")
        };
        assert!((shift - 1.0).abs() < 0.15, "{shift}");
        let turned = Drawing { turn: -0.1 * PI / 180.0, ..drawing.clone() }.photo();
        let Err(VisionError::EmptyMoved { turn, .. }) = check_still(&turned, &empty) else {
            panic!("{floor:?} turned")
        };
        assert!((turn.to_degrees() + 0.1).abs() < 0.02, "{turn}");
        let far = Drawing { shift: [37.0, -21.0], turn: 0.1, ..drawing }.photo();
        let error = check_still(&far, &empty).unwrap_err();
        assert!(
            matches!(error, VisionError::EmptyMoved { .. } | VisionError::EmptyUnlike { .. }),
            "{error:?}"
        );
    }
}

#[test]
fn pictures_of_two_sizes_are_refused() {
    let photo = Drawing::empty(Floor::Plain, 1).photo();
    let small = Photo::from_rgb(100, 80, vec![[90; 3]; 8000]).unwrap();
    let options = DetectOptions { empty: Some(small), ..DetectOptions::default() };
    let error = detect(&photo, ARENA, &options).unwrap_err();
    assert!(matches!(error, VisionError::EmptySize { empty: [100, 80], .. }), "{error:?}");
}
