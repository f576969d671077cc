//! Arenas drawn in code (noise, a gradient of light, rotation, boxes anywhere) are found by both methods.
#![allow(clippy::unwrap_used, reason = "helpers of tests fail as tests do")]

use proptest::prelude::*;
use wmr::geometry::{Arena, Point, Rect};
use wmr::vision::{DetectOptions, Detection, Method, Photo, detect};

const ARENA: Arena = Arena { width: 1.6, height: 1.2 };
/// Pixels per metre; edges are found to two pixels at 8 bit with noise, by the paper's method to four.
const SCALE: f64 = 220.0;
const TOLERANCE: f64 = 2.0 / SCALE;
const PAPER_TOLERANCE: f64 = 4.0 / SCALE;

#[derive(Clone, Debug)]
struct Drawing {
    boxes: Vec<Rect>,
    turn: f64,
    noise: f64,
    gradient: f64,
    seed: u64,
}

impl Drawing {
    /// The brightness code at a floor point: light floor in a dark frame, dark boxes, grey beyond.
    fn code(&self, point: Point) -> f64 {
        let frame = Rect::new(0.0, 0.0, ARENA.width, ARENA.height).distance(point);
        let dark = self.boxes.iter().any(|rect| rect.distance(point) == 0.0);
        let albedo = match frame {
            0.0 if dark => 50.0,
            0.0 => 205.0,
            depth if depth < 0.04 => 35.0,
            _ => 130.0,
        };
        albedo * (1.0 + self.gradient * (point.x / ARENA.width - 0.5))
    }

    fn photo(&self) -> Photo {
        let (width, height) = (480usize, 400usize);
        let (sin, cos) = self.turn.sin_cos();
        let mut random = fastrand::Rng::with_seed(self.seed);
        let pixel = |index: usize| {
            let sum: f64 = [(-0.25, -0.25), (0.25, -0.25), (-0.25, 0.25), (0.25, 0.25)]
                .into_iter()
                .map(|(i, j)| {
                    let x = ((index % width) as f64 + i - 239.5) / SCALE;
                    let y = (199.5 - (index / width) as f64 - j) / SCALE;
                    let (x, y) = (cos * x + sin * y, cos * y - sin * x);
                    self.code(Point::new(x + ARENA.width / 2.0, y + ARENA.height / 2.0))
                })
                .sum();
            [(sum / 4.0 + self.noise * (random.f64() - 0.5)) as u8; 3]
        };
        Photo::from_rgb(width, height, (0..width * height).map(pixel).collect()).unwrap()
    }
}

/// One box in each chosen cell of a 3 × 2 grid, so that none touch.
fn boxes() -> impl Strategy<Value = Vec<Rect>> {
    let one = (any::<bool>(), 0.0..1.0f64, 0.0..1.0f64, 0.1..0.3f64, 0.1..0.3f64);
    prop::collection::vec(one, 6).prop_map(|cells| {
        let chosen = cells.into_iter().enumerate().filter(|(_, cell)| cell.0);
        let rects = chosen.map(|(index, (_, x, y, width, height))| {
            let x = 0.06 + 0.5 * (index % 3) as f64 + x * (0.42 - width);
            let y = 0.06 + 0.56 * (index / 3) as f64 + y * (0.46 - height);
            Rect::new(x, y, x + width, y + height)
        });
        rects.collect()
    })
}

fn found(seen: &Detection, truth: Rect, tolerance: f64) -> bool {
    let truth = <[f64; 4]>::from(truth);
    seen.obstacles.iter().any(|found| {
        let rect = found.footprint.bounds();
        <[f64; 4]>::from(rect).iter().zip(truth).all(|(a, b)| (a - b).abs() < tolerance)
    })
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(12))]

    #[test]
    fn every_box_of_a_drawn_arena_is_found_and_no_other(
        boxes in boxes(), turn in -0.05..0.05f64, noise in 0.0..12.0f64, gradient in -0.2..0.2f64, seed: u64,
    ) {
        let drawing = Drawing { boxes, turn, noise, gradient, seed };
        let photo = drawing.photo();
        for (method, tolerance) in [(Method::Robust, TOLERANCE), (Method::Paper, PAPER_TOLERANCE)] {
            let options = DetectOptions { method, ..DetectOptions::default() };
            let seen = detect(&photo, ARENA, &options).unwrap();
            prop_assert_eq!(seen.obstacles.len(), drawing.boxes.len(), "{:?} {:?}", method, seen.obstacles);
            for &truth in &drawing.boxes {
                prop_assert!(found(&seen, truth, tolerance), "{:?} {:?} {:?}", method, truth, seen.obstacles);
            }
            prop_assert_eq!(seen.robot, None);
        }
    }
}
