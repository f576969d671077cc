//! Vision on ray-traced pictures whose truth is known.

use std::f64::consts::PI;
use wmr::geometry::{Arena, Rect};
use wmr::vision::{DetectOptions, Method, decode, detect};

/// Two pixels of these pictures; boxes of 33 cm height lean by nothing in an orthographic view.
const EDGE_TOLERANCE: f64 = 0.005;
const POSITION_TOLERANCE: f64 = 0.003;
const HEADING_TOLERANCE: f64 = 0.06;

struct Truth {
    file: &'static [u8],
    arena: Arena,
    boxes: &'static [[f64; 4]],
    robot: [f64; 3],
}

fn touching_a_wall() -> Truth {
    Truth {
        file: include_bytes!("../../tests/fixtures/L1_d03_robot.png"),
        arena: Arena { width: 2.45, height: 1.38 },
        boxes: &[
            [0.582, 0.83, 0.831, 1.057],
            [2.184, 0.087, 2.244, 0.724],
            [0.181, 0.397, 0.37, 0.579],
            [1.136, 0.0, 1.587, 0.315],
            [1.023, 0.525, 1.276, 0.653],
            [1.251, 0.886, 1.506, 0.976],
        ],
        robot: [1.943, 0.457, 0.855],
    }
}

fn black_robot() -> Truth {
    Truth {
        file: include_bytes!("../assets/demo.png"),
        arena: Arena { width: 1.3, height: 1.55 },
        boxes: &[
            [0.313, 0.233, 0.638, 0.653],
            [1.011, 0.505, 1.184, 0.664],
            [0.57, 0.704, 0.673, 0.808],
            [1.043, 1.094, 1.3, 1.374],
            [0.064, 0.855, 0.391, 1.276],
            [0.73, 0.991, 0.801, 1.469],
            [0.117, 0.439, 0.209, 0.582],
            [0.115, 1.363, 0.355, 1.527],
        ],
        robot: [0.163, 0.696, 1.521],
    }
}

fn agrees(found: Rect, truth: [f64; 4], tolerance: f64) -> bool {
    <[f64; 4]>::from(found).iter().zip(truth).all(|(a, b)| (a - b).abs() < tolerance)
}

#[test]
fn boxes_and_robot_are_where_they_were_drawn() {
    for Truth { file, arena, boxes, robot } in [touching_a_wall(), black_robot()] {
        let seen = detect(&decode(file).unwrap(), arena, &DetectOptions::default()).unwrap();
        assert_eq!(seen.obstacles.len(), boxes.len());
        for &truth in boxes {
            assert!(
                seen.obstacles.iter().any(|found| agrees(
                    found.footprint.bounds(),
                    truth,
                    EDGE_TOLERANCE
                )),
                "{truth:?}"
            );
        }
        let pose = seen.robot.unwrap();
        let turn = (pose.heading - robot[2] + PI).rem_euclid(2.0 * PI) - PI;
        assert!(
            (pose.position.x - robot[0]).hypot(pose.position.y - robot[1]) < POSITION_TOLERANCE,
            "{pose:?}"
        );
        assert!(turn.abs() < HEADING_TOLERANCE, "{pose:?}");
    }
}

#[test]
fn the_papers_method_finds_the_same_boxes_more_coarsely() {
    let Truth { file, arena, boxes, .. } = touching_a_wall();
    let options = DetectOptions { method: Method::Paper, ..DetectOptions::default() };
    let seen = detect(&decode(file).unwrap(), arena, &options).unwrap();
    assert_eq!(seen.obstacles.len(), boxes.len());
    for &truth in boxes {
        assert!(
            seen.obstacles.iter().any(|found| agrees(
                found.footprint.bounds(),
                truth,
                3.0 * EDGE_TOLERANCE
            )),
            "{truth:?}"
        );
    }
}
