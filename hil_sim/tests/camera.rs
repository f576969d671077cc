//! The simulated camera's pictures against a projection written apart from it, and against themselves.

use std::time::Duration;
use wmr_sim::base::{BaseParameters, TruePose, WheeledBase};
use wmr_sim::camera::{
    Camera, CameraFaults, Frame, Lens, Light, Look, Sensor, Stage, Stream, Timing,
};
use wmr_sim::in_process::InProcess;
use wmr_sim::script::Script;
use wmr_sim::simulation::Simulation;
use wmr_sim::world::{Shape, World};

const SIZE: [f64; 2] = [2.0, 1.5];
const POSE: TruePose = TruePose { x: 0.45, y: 0.4, heading: 0.7 };
/// How far an edge may be from where it should be, pixels.
const EDGE: f64 = 0.15;

fn lens() -> Lens {
    let lens = Lens::above(SIZE, 2.5, [640, 480]);
    Lens { k1: -0.12, ..lens.moved([0.12, -0.25, 0.4], [-0.09, -0.04, 0.12]) }
}

fn camera(lens: Lens, sensor: Sensor) -> Camera {
    // From straight above the camera itself: sides and shadows do not hide edges.
    let light = Light { lamp: [0.9, 0.6, 2.8], radius: 0.1, share: 0.3 };
    Camera::new(lens, light, Look::default(), sensor)
}

fn quiet() -> Sensor {
    Sensor { noise: 0.0, blur: 0.7, ..Sensor::default() }
}

fn world(shapes: Vec<Shape>) -> World {
    World { size: SIZE, shapes, movers: Vec::new(), robot_radius: 0.075 }
}

/// Where a point is seen: matrix times vector, by hand, row by row.
fn projected(lens: &Lens, [x, y, z]: [f64; 3]) -> [f64; 2] {
    let row = |i: usize| {
        lens.rotation[i][0] * x
            + lens.rotation[i][1] * y
            + lens.rotation[i][2] * z
            + lens.translation[i]
    };
    let (nx, ny) = (row(0) / row(2), row(1) / row(2));
    let r2 = nx.powi(2) + ny.powi(2);
    let (dx, dy) = (nx + nx * lens.k1 * r2, ny + ny * lens.k1 * r2);
    [lens.matrix[0][0] * dx + lens.matrix[0][2], lens.matrix[1][1] * dy + lens.matrix[1][2]]
}

/// The linear light of an sRGB value.
fn light(value: u8) -> f64 {
    match f64::from(value) / 255.0 {
        dark if dark < 0.04045 => dark / 12.92,
        share => ((share + 0.055) / 1.055).powf(2.4),
    }
}

/// The sum of the three parts' light at a place between pixels.
fn brightness(rgb: &[u8], [u, v]: [f64; 2]) -> f64 {
    let (column, row) = (u.floor(), v.floor());
    let (du, dv) = (u - column, v - row);
    let at = |dx: usize, dy: usize| {
        let from = 3 * ((row as usize + dy) * 640 + column as usize + dx);
        rgb[from..from + 3].iter().map(|part| light(*part)).sum::<f64>()
    };
    (1.0 - dv) * ((1.0 - du) * at(0, 0) + du * at(1, 0))
        + dv * ((1.0 - du) * at(0, 1) + du * at(1, 1))
}

/// How far outside the edge from `a` to `b` the picture's step lies, pixels: the centre of the brightness's
/// slope across it, which an even step on both sides puts exactly there.
fn step_off(rgb: &[u8], lens: &Lens, a: [f64; 3], b: [f64; 3], share: f64) -> f64 {
    let point = |share: f64| projected(lens, [0, 1, 2].map(|i| a[i] + share * (b[i] - a[i])));
    let ([u, v], [u0, v0], [u1, v1]) = (point(share), point(share - 0.01), point(share + 0.01));
    let length = (u1 - u0).hypot(v1 - v0);
    let (nu, nv) = ((v1 - v0) / length, (u0 - u1) / length);
    let at = |distance: f64| brightness(rgb, [u + distance * nu, v + distance * nv]);
    let (mut slopes, mut moments) = (0.0, 0.0);
    for step in -25..25 {
        let from = f64::from(step) / 10.0;
        let slope = at(from + 0.1) - at(from);
        slopes += slope;
        moments += slope * (from + 0.05);
    }
    assert!(slopes.abs() > 0.3, "no edge at {u} {v}");
    moments / slopes
}

#[test]
fn the_border_lies_where_another_projection_says() {
    let mut camera = camera(lens(), quiet());
    let stage = Stage { size: SIZE, ..Stage::default() };
    let rgb = camera.picture(&stage, &CameraFaults::default(), 1);
    let corners = [[0.0, 0.0, 0.0], [2.0, 0.0, 0.0], [2.0, 1.5, 0.0], [0.0, 1.5, 0.0]];
    for side in 0..4 {
        for share in [0.1, 0.3, 0.5, 0.7, 0.9] {
            let off = step_off(&rgb, &lens(), corners[side], corners[(side + 1) % 4], share);
            assert!(off.abs() < EDGE, "side {side} at {share}: {off}");
        }
    }
}

/// The tops of boxes of two heights lean as far as they should, and so do the feet that are seen.
#[test]
fn the_top_of_a_box_lies_where_another_projection_says() {
    let [x0, y0, x1, y1] = [1.5, 1.0, 1.8, 1.3];
    for height in [0.05, 0.3] {
        let look = Look { shape_height: height, ..Look::default() };
        let light = Light { lamp: [0.9, 0.6, 2.8], radius: 0.1, share: 0.0 };
        let mut camera = Camera::new(lens(), light, look, quiet());
        let mut stage = camera.look().stage(&world(vec![Shape::Rect([x0, y0, x1, y1])]), POSE);
        stage.moving.clear();
        let rgb = camera.picture(&stage, &CameraFaults::default(), 1);
        // Right and far edges of the top, and left and near edges of the foot: against the floor.
        let (top, foot) = (height, 0.0);
        for (a, b) in [
            ([x1, y0, top], [x1, y1, top]),
            ([x1, y1, top], [x0, y1, top]),
            ([x0, y0, foot], [x1, y0, foot]),
            ([x0, y1, foot], [x0, y0, foot]),
        ] {
            for share in [0.4, 0.5, 0.6] {
                let off = step_off(&rgb, &lens(), a, b, share);
                assert!(off.abs() < EDGE, "{height} m, {a:?} {b:?}: {off}");
            }
        }
    }
}

#[test]
fn the_robots_mark_points_where_the_robot_looks() {
    let mut camera = camera(lens(), quiet());
    for heading in [-2.5, -1.0, 0.3, 1.9] {
        let pose = TruePose { heading, ..POSE };
        let stage = camera.look().stage(&world(Vec::new()), pose);
        let rgb = camera.picture(&stage, &CameraFaults::default(), 1);
        let seen = |ahead: f64, left: f64| {
            let (sin, cos) = f64::sin_cos(heading);
            let x = pose.x + ahead * cos - left * sin;
            let y = pose.y + ahead * sin + left * cos;
            brightness(&rgb, projected(&lens(), [x, y, 0.07]))
        };
        let (mark, disc) = (0.03, 1.0);
        for (ahead, left, should) in [
            (0.03, 0.0, mark),
            (-0.02, 0.0, mark),
            (-0.03, 0.018, mark),
            (-0.03, -0.018, mark),
            (0.03, 0.025, disc),
            (0.03, -0.025, disc),
            (-0.057, 0.0, disc),
        ] {
            let is = seen(ahead, left);
            assert!((is - should).abs() < 0.2, "{heading}: {ahead} {left}: {is} not {should}");
        }
    }
}

/// Drawn again only where something moves, a picture is the same to the byte as drawn again as a whole.
#[test]
fn regions_are_drawn_as_the_whole_is() {
    let mut random = fastrand::Rng::with_seed(3);
    let shapes = vec![Shape::Rect([0.9, 0.3, 1.15, 0.75]), Shape::Circle([0.4, 1.1, 0.1])];
    let polygon = vec![[1.4, 0.9], [1.8, 1.0], [1.5, 1.1], [1.6, 1.3]];
    let shapes = [shapes, vec![Shape::Polygon(polygon)]].concat();
    let small = Lens { image_size: [640, 480], ..lens() };
    let light = Light { lamp: [-0.5, 2.0, 1.4], radius: 0.2, share: 0.6 };
    let mut camera = Camera::new(small, light, Look::default(), Sensor::default());
    for number in 0..6 {
        let [x, y] = SIZE.map(|side| side * random.f64());
        let pose = TruePose { x, y, heading: 6.0 * random.f64() };
        let mut stage = camera.look().stage(&world(shapes.clone()), pose);
        stage.moving.push(camera.look().robot_at(TruePose { x: y, y: x / 2.0, ..pose }, 0.06));
        let by_regions = camera.picture(&stage, &CameraFaults::default(), number);
        let whole = Stage {
            still: [stage.still.clone(), stage.moving.clone()].concat(),
            moving: Vec::new(),
            ..stage
        };
        let whole = camera.clone().picture(&whole, &CameraFaults::default(), number);
        let differ = by_regions.iter().zip(&whole).position(|(a, b)| a != b);
        assert_eq!(differ.map(|place| (place / 3 % 640, place / 3 / 640)), None, "{pose:?}");
    }
}

/// A lens bends a long wall far out of the lines between its corners.
#[test]
fn a_long_body_that_moves_is_drawn_whole_through_a_strong_lens() {
    let strong = Lens { k1: -0.5, ..Lens::above(SIZE, 1.2, [640, 480]) };
    let mut camera = camera(strong, Sensor::default());
    for rect in [[0.1, 1.3, 1.9, 1.4], [0.1, 0.1, 1.9, 0.2], [1.75, 0.1, 1.85, 1.4]] {
        let mut stage = camera.look().stage(&world(vec![Shape::Rect(rect)]), POSE);
        let whole = camera.picture(&stage, &CameraFaults::default(), 1);
        stage.moving.append(&mut stage.still);
        assert!(camera.picture(&stage, &CameraFaults::default(), 1) == whole, "{rect:?}");
    }
}

fn stream(timing: Timing) -> Stream {
    Stream::new(Camera::above(SIZE, [32, 24]), timing)
}

/// The frames of so many seconds, fetched every 5 ms; faults by tick.
fn frames(stream: &mut Stream, seconds: u64, faults: impl Fn(u64) -> CameraFaults) -> Vec<Frame> {
    let mut frames = Vec::new();
    for tick in 0..200 * seconds {
        let now = Duration::from_millis(5 * tick);
        stream.set_faults(faults(tick));
        let pose = TruePose { x: 0.3 + 0.001 * tick as f64, ..POSE };
        stream.expose(now, |camera| camera.look().stage(&world(Vec::new()), pose));
        while let Some(frame) = stream.take(now) {
            assert_eq!(frame.rgb.len(), 3 * frame.width * frame.height);
            frames.push(frame);
        }
    }
    frames
}

#[test]
fn frames_come_at_their_rate_and_as_late_as_they_are() {
    let timing = Timing { rate: 10.0, latency: Duration::from_millis(80), ..Timing::default() };
    let seen = frames(&mut stream(timing), 1, |_| CameraFaults::default());
    let times: Vec<_> =
        seen.iter().map(|frame| (frame.exposed.as_millis(), frame.delivered.as_millis())).collect();
    let expected: Vec<_> = (0..10).map(|number| (100 * number, 100 * number + 80)).collect();
    assert_eq!(times, expected);
    assert_ne!(seen[0].rgb, seen[1].rgb);
    let late = |tick| {
        let late = Duration::from_millis(if tick < 60 { 0 } else { 150 });
        CameraFaults { late, ..CameraFaults::default() }
    };
    let seen = frames(&mut stream(timing), 1, late);
    let lateness = seen.iter().map(|frame| (frame.delivered - frame.exposed).as_millis());
    assert_eq!(lateness.collect::<Vec<_>>(), [80, 80, 80, 230, 230, 230, 230, 230]);
    // Frames on time again wait for the last one that is late.
    let late_once = |tick| late(if tick == 60 { 60 } else { 0 });
    let seen = frames(&mut stream(timing), 1, late_once);
    let delivered = seen.iter().map(|frame| frame.delivered.as_millis());
    assert_eq!(delivered.take(7).collect::<Vec<_>>(), [80, 180, 280, 530, 530, 580, 680]);
}

#[test]
fn lost_frames_are_as_many_as_said_and_the_same_again() {
    let timing = Timing { rate: 100.0, lost: 0.3, ..Timing::default() };
    let exposed = || -> Vec<_> {
        let frames = frames(&mut stream(timing), 10, |_| CameraFaults::default());
        frames.iter().map(|frame| frame.exposed).collect()
    };
    let first = exposed();
    assert!((640..760).contains(&first.len()), "{}", first.len());
    assert_eq!(first, exposed());
}

#[test]
fn a_frozen_camera_repeats_itself_and_a_dark_one_shows_nothing() {
    let timing = Timing { rate: 10.0, ..Timing::default() };
    let faults = |tick| CameraFaults {
        frozen: (60..100).contains(&tick),
        dark: tick >= 140,
        ..CameraFaults::default()
    };
    let seen = frames(&mut stream(timing), 1, faults);
    assert!(seen[2].rgb == seen[3].rgb && seen[3].rgb == seen[4].rgb);
    assert!(seen[1].rgb != seen[2].rgb && seen[4].rgb != seen[5].rgb);
    assert!(seen[6].rgb.iter().any(|value| *value > 200));
    assert!(seen[7..].iter().all(|frame| frame.rgb.iter().all(|value| *value < 12)));
}

#[test]
fn a_camera_that_was_moved_sees_everything_elsewhere() {
    let mut camera = camera(Lens::above(SIZE, 2.5, [640, 480]), quiet());
    let stage = Stage { size: SIZE, ..Stage::default() };
    let moved = [[0.05, -0.03, 0.0], [0.0, 0.0, 0.02]];
    let faults = CameraFaults { moved: Some(moved), ..CameraFaults::default() };
    let rgb = camera.picture(&stage, &faults, 1);
    let [by, turn] = moved;
    let lens = camera.lens().moved(by, turn);
    let off = step_off(&rgb, &lens, [0.0, 0.0, 0.0], [2.0, 0.0, 0.0], 0.5);
    assert!(off.abs() < EDGE, "{off}");
    let back = camera.picture(&stage, &CameraFaults::default(), 1);
    let off = step_off(&back, camera.lens(), [0.0, 0.0, 0.0], [2.0, 0.0, 0.0], 0.5);
    assert!(off.abs() < EDGE, "{off}");
}

/// Through the simulation: frames on its virtual time, and faults of a script that come and go.
#[test]
fn a_simulation_has_frames_and_its_script_disturbs_them() {
    let base = WheeledBase::new(BaseParameters::seeded(1), POSE);
    let timing = Timing { rate: 10.0, latency: Duration::from_millis(40), ..Timing::default() };
    let mut simulation = Simulation::new(InProcess::default(), base, Some(world(Vec::new())))
        .with_camera(stream(timing));
    let script = Script::parse_short("camera-dark,at=0.45,for=0.3").unwrap();
    simulation.run_script(script);
    let mut dark = Vec::new();
    for _ in 0..100 {
        simulation.wait(Duration::from_millis(10)).unwrap();
        while let Some(frame) = simulation.take_frame() {
            assert_eq!(frame.delivered - frame.exposed, Duration::from_millis(40));
            dark.push(frame.rgb.iter().all(|value| *value < 12));
        }
    }
    let expected = [false, false, false, false, false, true, true, true, false, false];
    assert_eq!(dark[..10], expected);
}
