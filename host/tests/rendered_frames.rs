//! Pictures by the simulated camera show `detect` what really stands there.
#![allow(clippy::unwrap_used, reason = "helpers of tests fail as tests do")]

use hil_sim::base::TruePose;
use hil_sim::camera::{self, CameraFaults, Lens, Light, Look, Mark, Sensor};
use hil_sim::world::{Shape, World};
use wmr::geometry::{Arena, Point, Pose, wrap_angle};
use wmr::picture::overhead::overhead_png;
use wmr::scene::Scene;
use wmr::vision::{self, DetectOptions, Detection, Photo, Warning, detect};

const ARENA: Arena = Arena { width: 2.0, height: 1.5 };
const SIZE: [f64; 2] = [2.0, 1.5];
const POSE: TruePose = TruePose { x: 0.45, y: 0.4, heading: 0.7 };
/// A picture has about 230 pixels a metre: one and a half of them for the robot's place, m, and one for
/// the ends of its mark, rad.
const PLACE: f64 = 0.006;
const HEADING: f64 = 0.045;
/// The least share of the boxes' area that is found as such: by the border alone nobody knows how far they
/// lean, with the camera's file a pixel along all edges is lost.
const OVERLAP: f64 = 0.88;
const OVERLAP_KNOWN: f64 = 0.93;

fn world() -> World {
    let shapes = vec![
        Shape::Rect([0.9, 0.3, 1.15, 0.75]),
        Shape::Rect([1.45, 0.9, 1.75, 1.15]),
        Shape::Rect([0.3, 1.0, 0.75, 1.2]),
    ];
    World { size: SIZE, shapes, movers: Vec::new(), robot_radius: 0.075 }
}

fn photo_at(camera: &mut camera::Camera, world: &World, pose: TruePose) -> Photo {
    photo_with(camera, world, pose, &CameraFaults::default())
}

fn photo_with(
    camera: &mut camera::Camera,
    world: &World,
    pose: TruePose,
    faults: &CameraFaults,
) -> Photo {
    let stage = camera.look().stage(world, pose);
    let rgb = camera.picture(&stage, faults, 1);
    let [width, height] = camera.lens().image_size;
    let pixels = rgb.chunks_exact(3).map(|pixel| [pixel[0], pixel[1], pixel[2]]).collect();
    Photo::from_rgb(width, height, pixels).unwrap()
}

/// The area that both cover over that which either covers, counted on places 5 mm apart.
fn overlap(seen: &Detection) -> f64 {
    let (mut both, mut either) = (0.0, 0.0);
    for index in 0..400 * 300 {
        let (x, y) = (f64::from(index % 400) * 0.005, f64::from(index / 400) * 0.005);
        let is_true = world().shapes.iter().any(|shape| match shape {
            Shape::Rect([x0, y0, x1, y1]) => (*x0..*x1).contains(&x) && (*y0..*y1).contains(&y),
            _ => false,
        });
        let is_seen = seen.obstacles.iter().any(|is| is.footprint.contains(Point::new(x, y)));
        both += f64::from(u8::from(is_true && is_seen));
        either += f64::from(u8::from(is_true || is_seen));
    }
    both / either
}

fn check_robot(robot: Option<Pose>) {
    let robot = robot.unwrap();
    let off = robot.position.distance(Point::new(POSE.x, POSE.y));
    assert!(off < PLACE, "{robot:?}");
    assert!(wrap_angle(robot.heading - POSE.heading).abs() < HEADING, "{robot:?}");
}

#[test]
fn from_straight_above_arena_boxes_and_robot_are_found() {
    let mut camera = camera::Camera::above(SIZE, [640, 480]);
    let photo = photo_at(&mut camera, &world(), POSE);
    let seen = detect(&photo, ARENA, &DetectOptions::default()).unwrap();
    for (corner, at) in seen.corners_px.iter().zip([[0.0, 0.0], [2.0, 0.0], [2.0, 1.5], [0.0, 1.5]])
    {
        let [u, v] = camera.lens().project([at[0], at[1], 0.0]).unwrap();
        assert!((corner[0] - u).hypot(corner[1] - v) < 0.5, "{corner:?} {u} {v}");
    }
    check_robot(seen.robot);
    assert!(overlap(&seen) > OVERLAP, "{}", overlap(&seen));
}

/// A camera that stands aside, is tilted and bends straight lines.
fn tilted() -> Lens {
    let lens = Lens::above(SIZE, 2.5, [640, 480]);
    Lens { k1: -0.12, ..lens.moved([0.12, -0.25, 0.4], [-0.09, -0.04, 0.12]) }
}

#[test]
fn through_a_tilted_lens_with_distortion_they_are_found_with_its_camera_file() {
    let mut camera =
        camera::Camera::new(tilted(), Light::beside(SIZE), Look::default(), Sensor::default());
    let options = DetectOptions { camera: Some((&tilted()).into()), ..DetectOptions::default() };
    let all = photo_at(&mut camera, &world(), POSE);
    let seen = detect(&all, ARENA, &options).unwrap();
    check_robot(seen.robot);
    assert!(overlap(&seen) > OVERLAP_KNOWN, "{}", overlap(&seen));
    // Where no box tells how things lean, the camera's height does.
    let empty = World { shapes: Vec::new(), ..world() };
    let alone = photo_at(&mut camera, &empty, POSE);
    let seen = detect(&alone, ARENA, &options).unwrap();
    check_robot(seen.robot);
    assert_eq!(seen.obstacles, []);
}

#[test]
fn a_robot_with_a_tag_is_found_by_it() {
    let id = 7;
    let cells = vision::TagDictionary::named("4X4_50").unwrap().cells(id).unwrap();
    let look = Look { mark: Mark::Tag { side: 0.09, cells }, robot: [240; 3], ..Look::default() };
    let lens = Lens::above(SIZE, 2.5, [640, 480]);
    let mut camera = camera::Camera::new(lens, Light::beside(SIZE), look, Sensor::default());
    let photo = photo_at(&mut camera, &world(), POSE);
    let options = DetectOptions { robot_tag: Some(id), ..DetectOptions::default() };
    check_robot(detect(&photo, ARENA, &options).unwrap().robot);
}

/// Wherever the robot stands and looks, its place and heading are read to a fraction of a pixel if the camera's height
/// is known: m and rad.
const ANYWHERE: f64 = 0.001;
const ANYWHERE_HEADING: f64 = 0.02;
/// In a corner of the picture a top leans the most.
const FAR_OUT: TruePose = TruePose { x: 1.85, y: 0.12, heading: 2.5 };
/// By the border alone it is guessed how far the top leans.
const GUESSED: f64 = 0.006;

/// How far off the robot is found at 24 places in an arena, metres and radians.
fn offs(options: &DetectOptions, world: &World) -> Vec<(f64, f64)> {
    let mut camera = camera::Camera::above(SIZE, [640, 480]);
    let off = |number: usize| {
        let (x, y) = ([0.2, 0.6, 1.0, 1.8][number % 4], [0.15, 0.9, 1.35][number / 4 % 3]);
        let pose = TruePose { x, y, heading: wrap_angle(0.9 * number as f64 + 0.3) };
        let seen = detect(&photo_at(&mut camera, world, pose), ARENA, options).unwrap();
        let Some(robot) = seen.robot else { return (f64::INFINITY, f64::INFINITY) };
        let turned = wrap_angle(robot.heading - pose.heading).abs();
        (robot.position.distance(Point::new(x, y)), turned)
    };
    (0..24).map(off).collect()
}

#[test]
fn a_robot_is_found_wherever_it_stands_and_looks() {
    let camera = camera::Camera::above(SIZE, [640, 480]);
    let known = DetectOptions { camera: Some(camera.lens().into()), ..DetectOptions::default() };
    let empty = World { shapes: Vec::new(), ..world() };
    let seen = offs(&known, &empty);
    assert!(seen.iter().all(|off| off.0 < ANYWHERE && off.1 < ANYWHERE_HEADING), "{seen:?}");
    let seen = offs(&DetectOptions::default(), &empty);
    assert!(seen.iter().all(|off| off.0 < GUESSED && off.1 < ANYWHERE_HEADING), "{seen:?}");
}

#[test]
fn a_robot_whose_place_nothing_tells_is_doubted() {
    let doubted = |photo: &Photo, options: &DetectOptions| {
        let seen = detect(photo, ARENA, options).unwrap();
        assert!(seen.robot.is_some(), "{:?}", seen.warnings);
        seen.warnings.iter().any(|warning| matches!(warning, Warning::RobotPlace { .. }))
    };
    // No side of the robot is drawn, and there is no box.
    let start = Some(Pose::new(FAR_OUT.x, FAR_OUT.y, FAR_OUT.heading));
    let scene = Scene { start, ..Scene::new(SIZE[0], SIZE[1]) };
    let flat = vision::decode(&overhead_png(&scene, 230.0).unwrap()).unwrap();
    assert!(doubted(&flat, &DetectOptions::default()));

    let mut camera = camera::Camera::above(SIZE, [640, 480]);
    let known = DetectOptions { camera: Some(camera.lens().into()), ..DetectOptions::default() };
    let empty = World { shapes: Vec::new(), ..world() };
    for world in [empty, world()] {
        let photo = photo_at(&mut camera, &world, FAR_OUT);
        assert!(!doubted(&photo, &known));
        // Its side is seen, and tells.
        assert!(!doubted(&photo, &DetectOptions::default()));
    }
}

/// How high the boxes are that lean far, m: their tops appear up to 10 cm beside their footprints.
const TALL: f64 = 0.25;
/// The blur along an edge: a pixel and a half, m.
const BLUR: f64 = 0.006;

#[test]
fn the_top_that_is_seen_is_covered_by_margins_unless_the_camera_is_known() {
    let lens = Lens::above(SIZE, 2.5, [640, 480]);
    let look = Look { shape_height: TALL, ..Look::default() };
    let mut camera = camera::Camera::new(lens, Light::beside(SIZE), look, Sensor::default());
    let photo = photo_at(&mut camera, &world(), POSE);
    let is_covered = |seen: &Detection, top: Point| {
        seen.obstacles.iter().any(|obstacle| obstacle.distance(top) < BLUR)
    };
    let guessed = detect(&photo, ARENA, &DetectOptions::default()).unwrap();
    let map = &guessed.map;
    let tops: Vec<Point> = world()
        .shapes
        .iter()
        .filter_map(|shape| match *shape {
            Shape::Rect([x0, y0, x1, y1]) => Some([[x0, y0], [x1, y0], [x1, y1], [x0, y1]]),
            _ => None,
        })
        .flatten()
        .map(|[x, y]| camera.lens().project([x, y, TALL]).unwrap())
        .map(|pixel| map.to_floor(pixel))
        .collect();
    for &top in &tops {
        assert!(is_covered(&guessed, top), "{top:?} {:?}", guessed.obstacles);
    }
    let options = DetectOptions { camera: Some(camera.lens().into()), ..DetectOptions::default() };
    let known = detect(&photo, ARENA, &options).unwrap();
    assert!(overlap(&known) > OVERLAP_KNOWN, "{}", overlap(&known));
    assert!(tops.iter().filter(|&&top| is_covered(&known, top)).count() < tops.len() / 2);
}

#[test]
fn a_dark_camera_is_refused() {
    let mut camera = camera::Camera::above(SIZE, [320, 240]);
    let faults = CameraFaults { dark: true, ..CameraFaults::default() };
    let photo = photo_with(&mut camera, &world(), POSE, &faults);
    assert!(detect(&photo, ARENA, &DetectOptions::default()).is_err());
}
