//! How surely, how exactly and how fast tags are found: `cargo run --release --example tags [DIR]`.
//!
//! Twenty pictures a row, 1280 × 960 with five tags each, tilted by 0 to 60 degrees, turned at will, blur
//! 0.8 and noise 2 codes. With DIR the pictures are written there with `truth.json`, for other detectors.

#![allow(clippy::unwrap_used, clippy::expect_used, reason = "an example may fail as a test does")]

#[path = "../tests/drawn_tags/mod.rs"]
mod drawn_tags;

use drawn_tags::{Canvas, DrawnTag};
use std::f64::consts::TAU;
use std::time::Instant;
use wmr::vision::{TagDictionary, find_tags};

const PICTURES: usize = 20;
const ROWS: [[f64; 2]; 6] =
    [[12.0, 16.0], [16.0, 20.0], [20.0, 25.0], [25.0, 40.0], [40.0, 80.0], [80.0, 160.0]];

/// A tag of a shortest side within a range, somewhere around the middle of a field of the picture.
fn random_tag(
    dictionary: TagDictionary,
    centre: [f64; 2],
    [low, high]: [f64; 2],
    random: &mut fastrand::Rng,
) -> DrawnTag {
    let id = random.usize(..dictionary.len());
    let wanted = low + (high - low) * random.f64();
    let turns = [random.f64() * TAU, random.f64() * TAU / 6.0, random.f64() * TAU];
    let centre = centre.map(|value| value + 20.0 * random.f64());
    let rough = DrawnTag::tilted((dictionary, id), centre, wanted, turns).shortest_side();
    DrawnTag::tilted((dictionary, id), centre, wanted * wanted / rough, turns)
}

struct Score {
    drawn: usize,
    found: usize,
    errors: Vec<f64>,
    milliseconds: Vec<f64>,
    phantoms: usize,
}

fn row(name: &str, range: [f64; 2], smear: usize, folder: Option<&std::path::Path>) -> Score {
    let dictionary = TagDictionary::named(name).expect("a known name");
    let mut random = fastrand::Rng::with_seed(7 + range[0] as u64);
    let mut score = Score { drawn: 0, found: 0, errors: vec![], milliseconds: vec![], phantoms: 0 };
    for picture in 0..PICTURES {
        let mut canvas = Canvas::floor(1280, 960, &mut random);
        let fields =
            [[250.0, 230.0], [950.0, 250.0], [620.0, 470.0], [260.0, 700.0], [940.0, 690.0]];
        let tags = fields.map(|centre| random_tag(dictionary, centre, range, &mut random));
        tags.iter().for_each(|tag| canvas.tag(tag));
        if smear > 1 {
            canvas.smear(smear);
        }
        let photo = canvas.photo(0.8, 2.0, &mut random);
        let started = Instant::now();
        let found = find_tags(&photo, &TagDictionary::usual());
        score.milliseconds.push(started.elapsed().as_secs_f64() * 1e3);
        let near = |tag: &DrawnTag, seen: &[[f64; 2]; 4]| {
            let error = |(a, b): (&[f64; 2], &[f64; 2])| (a[0] - b[0]).hypot(a[1] - b[1]);
            tag.corners.iter().zip(seen).map(error).collect::<Vec<f64>>()
        };
        for tag in &tags {
            score.drawn += 1;
            let same = |seen: &&wmr::vision::Tag| {
                seen.id == tag.id
                    && seen.dictionary.side() == dictionary.side()
                    && near(tag, &seen.corners_px).iter().all(|&error| error < 5.0)
            };
            if let Some(seen) = found.iter().find(same) {
                score.found += 1;
                score.errors.extend(near(tag, &seen.corners_px));
            }
        }
        let drawn = |seen: &&wmr::vision::Tag| tags.iter().any(|tag| tag.id == seen.id);
        score.phantoms += found.iter().filter(|seen| !drawn(seen)).count();
        if let Some(folder) = folder {
            let file = format!("{name}_{}_{smear}_{picture:02}", range[0]);
            let pixels = photo.pixels().as_flattened();
            image::save_buffer(
                folder.join(format!("{file}.png")),
                pixels,
                1280,
                960,
                image::ColorType::Rgb8,
            )
            .expect("a folder that can be written");
            let truth: Vec<_> = tags
                .iter()
                .map(|tag| serde_json::json!({"id": tag.id, "corners": tag.corners}))
                .collect();
            std::fs::write(
                folder.join(format!("{file}.json")),
                serde_json::json!(truth).to_string(),
            )
            .expect("a folder that can be written");
        }
    }
    score
}

fn main() {
    let folder = std::env::args().nth(1).map(std::path::PathBuf::from);
    println!("dictionary      side px     smear  found      median  p95 px  ms     phantoms");
    for name in ["4X4_50", "4X4_1000", "5X5_1000", "6X6_250", "36h11", "25h9", "7X7_1000"] {
        let smeared = [([20.0, 20.0], 3), ([30.0, 30.0], 3)];
        for (range, smear) in ROWS.map(|range| (range, 1)).into_iter().chain(smeared) {
            let mut score = row(name, range, smear, folder.as_deref());
            score.errors.sort_by(f64::total_cmp);
            score.milliseconds.sort_by(f64::total_cmp);
            let share = |part: f64| {
                score
                    .errors
                    .get((score.errors.len() as f64 * part) as usize)
                    .copied()
                    .unwrap_or(f64::NAN)
            };
            println!(
                "{name:14} {:4} to {:4} {smear:5}  {:3} of {:3}  {:.3}   {:.3}  {:5.1}  {}",
                range[0],
                range[1],
                score.found,
                score.drawn,
                share(0.5),
                share(0.95),
                score.milliseconds[PICTURES / 2],
                score.phantoms,
            );
        }
    }
}
