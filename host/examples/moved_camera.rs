//! How surely a moved camera is noticed: `cargo run --release --example moved_camera`.
//!
//! Two hundred drawn pairs of pictures, an empty floor and one with boxes and shadows in other light: once by a
//! camera that stands still, once by one that moved by a pixel in any direction or turned by 0.1° either way.

#![allow(clippy::unwrap_used, reason = "an example may fail as a test does")]

#[path = "../tests/drawn_floor/mod.rs"]
mod drawn_floor;

use drawn_floor::{ARENA, Drawing, Floor};
use std::f64::consts::TAU;
use wmr::geometry::Rect;
use wmr::vision::check_still;

const CASES: u64 = 200;
const FLOORS: [Floor; 3] = [Floor::Tiles, Floor::Wood, Floor::Plain];

/// A rectangle somewhere on the floor.
fn rect(random: &mut fastrand::Rng) -> Rect {
    let (width, height) = (0.05 + 0.3 * random.f64(), 0.05 + 0.3 * random.f64());
    let x = random.f64() * (ARENA.width - width);
    let y = random.f64() * (ARENA.height - height);
    Rect::new(x, y, x + width, y + height)
}

fn main() {
    let (mut noticed, mut false_alarms) = (0, 0);
    for case in 0..CASES {
        let mut random = fastrand::Rng::with_seed(case);
        let floor = FLOORS[case as usize % FLOORS.len()];
        let boxes: Vec<_> = (0..random.usize(0..8))
            .map(|_| (rect(&mut random), std::array::from_fn(|_| 0.02 + 0.6 * random.f32())))
            .collect();
        let shadows: Vec<_> = (0..random.usize(0..6))
            .map(|_| (rect(&mut random), 0.3 + 0.5 * random.f32()))
            .collect();
        let lamp = 0.5 + random.f32();
        let gain = std::array::from_fn(|_| lamp * (0.8 + 0.4 * random.f32()));
        let slope = 0.4 * random.f32();
        let empty = Drawing::empty(floor, 2 * case).photo();
        let base = Drawing::empty(floor, 2 * case + 1);
        let still = Drawing { boxes: &boxes, shadows: &shadows, gain, slope, ..base };
        false_alarms += usize::from(check_still(&still.photo(), &empty).is_err());
        let angle = random.f64() * TAU;
        let (shift, turn) = match case % 2 {
            0 => ([angle.cos(), angle.sin()], 0.0),
            _ => ([0.0; 2], 0.1_f64.to_radians() * angle.sin().signum()),
        };
        let moved = Drawing { shift, turn, ..still };
        noticed += usize::from(check_still(&moved.photo(), &empty).is_err());
    }
    println!("moved: {noticed} of {CASES} noticed; standing still: {false_alarms} false alarms");
}
