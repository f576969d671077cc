//! How the build time grows with the number of boxes.

use crate::micros;
use wmr::geometry::Rect;
use wmr::plan::{PlanOptions, PreparedArena};
use wmr::scene::Scene;
use std::time::Instant;

/// Times each arena is built.
const BUILDS: usize = 15;

/// Prints the build time of random arenas, the least of some, which load disturbs least, and the exponent of its growth.
pub fn print() {
    let options = PlanOptions::default();
    let mut ends = Vec::new();
    println!("| N | build µs |\n|---|---|");
    for count in [100, 1000, 10_000, 100_000] {
        let scene = random(count);
        let times = (0..BUILDS).map(|_| {
            let begin = Instant::now();
            std::hint::black_box(PreparedArena::new(&scene, &options).is_ok());
            micros(begin)
        });
        let time = times.fold(f64::INFINITY, f64::min);
        println!("| {count} | {time:.1} |");
        ends.push((count as f64, time));
    }
    if let (Some(first), Some(last)) = (ends.first(), ends.last()) {
        println!("exponent {:.3}", (last.1 / first.1).ln() / (last.0 / first.0).ln());
    }
}

/// `count` boxes of 0.1 to 0.5 m on 0.8 m² each, as in the arenas that peers were measured on.
fn random(count: usize) -> Scene {
    let side = (0.8 * count as f64).sqrt();
    let mut scene = Scene::new(side, side);
    let mut state = 0x9E37_79B9_7F4A_7C15_u64;
    let mut next = || {
        // SplitMix64.
        state = state.wrapping_add(0x9E37_79B9_7F4A_7C15);
        let mut z = state;
        z = (z ^ (z >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
        ((z ^ (z >> 31)) >> 11) as f64 / (1_u64 << 53) as f64
    };
    scene.obstacles = (0..count)
        .map(|_| {
            let (w, h) = (0.1 + 0.4 * next(), 0.1 + 0.4 * next());
            let (x, y) = (next() * (side - w), next() * (side - h));
            let whole = |metres: f64| (metres * 1000.0).round() / 1000.0;
            Rect::new(whole(x), whole(y), whole(x + w), whole(y + h)).into()
        })
        .collect();
    scene
}
