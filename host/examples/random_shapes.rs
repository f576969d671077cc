//! How well random shapes on random floors are found: `cargo run --release -p wmr --example random_shapes [N [FIRST]]`.
//!
//! Draws N arenas (1000 if not told) from the seed FIRST on, of 480 × 360 pixels with turned boxes, discs, polygons, walls of 1.5 pixels
//! and more, touching ones, uneven light and noise, and prints how far a drawn point lies outside of the reported
//! shapes and margins, pixels, how many shapes were invented, and how well the areas agree.

#[path = "../tests/drawn_shapes/mod.rs"]
mod drawn_shapes;

use drawn_shapes::Drawing;

/// Arenas in which a drawn point lies farther out than this, pixels, are named.
const MOST_OUT: f64 = 2.0;

fn main() {
    let count = std::env::args().nth(1).and_then(|text| text.parse().ok()).unwrap_or(1000);
    let (mut worst, mut bad, mut invented, mut agreement) = (0.0_f64, 0, 0, 0.0);
    let first: u64 = std::env::args().nth(2).and_then(|text| text.parse().ok()).unwrap_or(0);
    for seed in first..first + count {
        let drawing = Drawing::random(seed);
        let outcome = drawing.outcome();
        if outcome.out > MOST_OUT || outcome.invented > 0 {
            println!("arena {seed}: {outcome:.2?}, {} shapes drawn", drawing.shapes.len());
        }
        worst = worst.max(outcome.out);
        bad += u32::from(outcome.out > MOST_OUT);
        invented += outcome.invented;
        agreement += outcome.agreement;
    }
    println!(
        "{count} arenas: out by more than {MOST_OUT} pixels in {bad}, at most {worst:.1}; {invented} shapes invented; areas agree to {:.3}",
        agreement / count.max(1) as f64
    );
}
