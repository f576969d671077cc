//! Pairs of pictures drawn in code: boxes on a grained floor with painted shadow, seen by two cameras.

use super::*;
use crate::geometry::Rect;
use crate::vision::camera::CameraModel;
use proptest::prelude::*;

const ARENA: Arena = Arena { width: 1.6, height: 1.2 };
const SIZE: [usize; 2] = [480, 360];
/// A pixel is 4.5 mm wide on the floor; edges are found to half of one.
const EDGE_TOLERANCE: f64 = 0.006;
/// Disparity grows by 0.3 m of baseline a metre of height: two pixels.
const HEIGHT_TOLERANCE: f64 = 0.03;

fn camera(x: f64, y: f64) -> Camera {
    Camera {
        model: CameraModel::Perspective,
        image_size: SIZE,
        matrix: [[560.0, 0.0, 239.5], [0.0, 560.0, 179.5], [0.0, 0.0, 1.0]],
        k1: -0.03,
        rotation: [[1.0, 0.0, 0.0], [0.0, -1.0, 0.0], [0.0, 0.0, -1.0]],
        translation: [-x, y, 2.5],
        spread: None,
    }
}

fn cameras() -> [Camera; 2] {
    [camera(0.45, 0.65), camera(1.15, 0.6)]
}

/// Light from 0 to 1 where the ray from `eye` to a floor point ends.
fn light(eye: [f64; 3], floor: Point, boxes: &[RaisedBox], shadow: Rect) -> f64 {
    // The highest point of the ray inside a box is the one that is seen.
    let seen = boxes.iter().filter_map(|raised| {
        let at = |height: f64| {
            let share = height / eye[2];
            Point::new(floor.x + share * (eye[0] - floor.x), floor.y + share * (eye[1] - floor.y))
        };
        let steps = 60;
        (0..=steps)
            .rev()
            .map(|step| raised.height * f64::from(step) / f64::from(steps))
            .find(|&height| raised.base.distance(at(height)) == 0.0)
            .map(|height| (height, height >= raised.height))
    });
    match seen.max_by(|a, b| a.0.total_cmp(&b.0)) {
        Some((_, true)) => 0.12,
        Some((_, false)) => 0.05,
        None => {
            let on =
                floor.x > 0.0 && floor.x < ARENA.width && floor.y > 0.0 && floor.y < ARENA.height;
            let grain = 0.03 * ((floor.x * 90.0).sin() * (floor.y * 70.0).cos());
            let shade = if shadow.distance(floor) == 0.0 { 0.4 } else { 1.0 };
            if on { (0.6 + grain) * shade } else { 0.02 }
        }
    }
}

fn drawn(camera: &Camera, boxes: &[RaisedBox], shadow: Rect, exposure: f64) -> Photo {
    let blank = Photo::from_rgb(SIZE[0], SIZE[1], vec![[0; 3]; SIZE[0] * SIZE[1]]).unwrap();
    let map = camera.plan_map(&blank).unwrap();
    let view = camera.viewpoint().unwrap();
    let eye = [view.foot.x, view.foot.y, view.height];
    let mut random = fastrand::Rng::with_seed(7);
    let pixels = (0..SIZE[0] * SIZE[1]).map(|index| {
        let (column, row) = ((index % SIZE[0]) as f64, (index / SIZE[0]) as f64);
        let sum: f64 = [(-0.25, -0.25), (0.25, -0.25), (-0.25, 0.25), (0.25, 0.25)]
            .into_iter()
            .map(|(i, j)| light(eye, map.to_floor([column + i, row + j]), boxes, shadow))
            .sum();
        let noise = 0.008 * (random.f64() - 0.5);
        [crate::vision::image::srgb_code((exposure * sum / 4.0 + noise) as f32); 3]
    });
    Photo::from_rgb(SIZE[0], SIZE[1], pixels.collect()).unwrap()
}

fn seen(boxes: &[RaisedBox], shadow: Rect) -> PairDetection {
    let cameras = cameras();
    let (a, b) = (drawn(&cameras[0], boxes, shadow, 1.0), drawn(&cameras[1], boxes, shadow, 0.8));
    let options = DetectOptions { keep_steps: true, ..DetectOptions::default() };
    detect_pair([&a, &b], [&cameras[0], &cameras[1]], ARENA, &options).unwrap()
}

fn agrees(seen: &PairDetection, truth: RaisedBox) -> bool {
    let edges = |rect: Rect| <[f64; 4]>::from(rect);
    seen.detection.obstacles.iter().any(|found| {
        let worst = edges(found.footprint.bounds())
            .into_iter()
            .zip(edges(truth.base))
            .map(|(a, b)| (a - b).abs());
        worst.fold(0.0, f64::max) < EDGE_TOLERANCE
            && found.height.is_some_and(|height| (height - truth.height).abs() < HEIGHT_TOLERANCE)
    })
}

const SHADOW: Rect = Rect { x0: 0.9, y0: 0.75, x1: 1.2, y1: 1.0 };

#[test]
fn footprints_and_heights_are_found_and_shadow_is_none() {
    let boxes = [
        RaisedBox { base: Rect::new(0.2, 0.2, 0.5, 0.4), height: 0.3 },
        RaisedBox { base: Rect::new(1.2, 0.25, 1.35, 0.6), height: 0.15 },
    ];
    let seen = seen(&boxes, SHADOW);
    assert_eq!(seen.detection.obstacles.len(), 2, "{:?}", seen.detection);
    assert!(boxes.iter().all(|&truth| agrees(&seen, truth)), "{:?}", seen.detection);
    assert_eq!(seen.steps.map(|steps| steps.boxes.len()), Some(2));
}

#[test]
fn shadow_alone_is_an_empty_arena() {
    let seen = seen(&[], SHADOW);
    assert!(seen.detection.obstacles.is_empty(), "{:?}", seen.detection);
}

#[test]
fn cameras_that_see_no_heights_are_refused() {
    let [a, b] = cameras();
    let photo = drawn(&a, &[], SHADOW, 1.0);
    let pair = |a: &Camera, b: &Camera| {
        detect_pair([&photo, &photo], [a, b], ARENA, &DetectOptions::default())
    };
    assert!(matches!(pair(&a, &a), Err(VisionError::Pair { .. })));
    let flat = Camera { model: CameraModel::Orthographic, ..b };
    assert!(matches!(pair(&a, &flat), Err(VisionError::Pair { .. })));
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(6))]

    #[test]
    fn a_box_anywhere_is_found(
        x in 0.1..1.1f64, y in 0.1..0.7f64, width in 0.15..0.3f64, depth in 0.15..0.3f64, height in 0.12..0.4f64,
    ) {
        let truth = RaisedBox { base: Rect::new(x, y, x + width, y + depth), height };
        let seen = seen(&[truth], Rect::new(0.02, 1.0, 0.3, 1.15));
        prop_assert_eq!(seen.detection.obstacles.len(), 1, "{:?}", seen.detection);
        prop_assert!(agrees(&seen, truth), "{:?}", seen.detection);
    }
}
