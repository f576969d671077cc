//! How well predicted sets hold real tracks: `cargo run --release --example tracks -- FILE.csv [SCALE]`.
//!
//! The file has the columns `time_s,id,x_m,y_m`; lengths are multiplied by SCALE, 0.125 where none is
//! given. Every track is sampled ten times a second by straight lines between its points and seen with an
//! error of 5 mm in each coordinate. For each time ahead the table says which share of the sets held the truth,
//! and how large they were on average beside the disc that just holds 99 % of the same predictions' errors.

use std::collections::BTreeMap;
use std::error::Error;
use std::time::Duration;
use wmr::geometry::Point;
use wmr::shape::{Circle, Shape};
use wmr::track::obstacles::Tracker;

const FRAME: Duration = Duration::from_millis(100);
const SIGMA: f64 = 0.005;
/// Frames after which a track's predictions count.
const SETTLED: usize = 5;
const RADIUS: f64 = 0.05;

type Samples = Vec<(f64, f64)>;

fn main() -> Result<(), Box<dyn Error>> {
    let mut arguments = std::env::args().skip(1);
    let file = arguments.next().ok_or("name a CSV file with the columns time_s,id,x_m,y_m")?;
    let scale = arguments.next().map_or(Ok(0.125), |scale| scale.parse())?;
    let tracks = read(&std::fs::read_to_string(&file)?, scale)?;
    let mut random = fastrand::Rng::with_seed(1);
    let mut samples: BTreeMap<u32, Samples> =
        [2, 5, 7, 10, 15, 20].map(|ahead| (ahead, Vec::new())).into();
    for track in &tracks {
        follow(track, &mut random, &mut samples);
    }
    println!("{} tracks at a scale of {scale}", tracks.len());
    println!("ahead s  samples  mean mm  p95 mm  p99 mm  held %  area / p99 disc");
    for (ahead, samples) in &mut samples {
        print(f64::from(*ahead) * FRAME.as_secs_f64(), samples);
    }
    Ok(())
}

/// Tracks sampled at every frame.
fn read(text: &str, scale: f64) -> Result<Vec<Vec<Point>>, Box<dyn Error>> {
    let mut points: BTreeMap<String, Vec<[f64; 3]>> = BTreeMap::new();
    for line in text.lines().skip(1).filter(|line| !line.trim().is_empty()) {
        let fields: Vec<&str> = line.split(',').collect();
        let [time, id, x, y] = fields[..] else {
            return Err(format!("{line:?} has not four columns").into());
        };
        let number = |text: &str| text.trim().parse::<f64>();
        let point = [number(time)?, scale * number(x)?, scale * number(y)?];
        points.entry(id.into()).or_default().push(point);
    }
    Ok(points.into_values().map(|points| sampled(&points)).filter(|t| t.len() >= 30).collect())
}

fn sampled(points: &[[f64; 3]]) -> Vec<Point> {
    let mut track = Vec::new();
    for pair in points.windows(2) {
        let ([t0, x0, y0], [t1, x1, y1]) = (pair[0], pair[1]);
        let frames = ((t1 - t0) / FRAME.as_secs_f64()).round().max(1.0) as usize;
        track.extend((0..frames).map(|frame| {
            let share = frame as f64 / frames as f64;
            Point::new(x0 + share * (x1 - x0), y0 + share * (y1 - y0))
        }));
    }
    track
}

fn follow(track: &[Point], random: &mut fastrand::Rng, samples: &mut BTreeMap<u32, Samples>) {
    let mut noise = || SIGMA * ((0..12).map(|_| random.f64()).sum::<f64>() - 6.0);
    let mut tracker = Tracker::new(SIGMA);
    let mut time = Duration::ZERO;
    for (frame, &there) in track.iter().enumerate() {
        let centre = Point::new(there.x + noise(), there.y + noise());
        tracker.update(time, &[Circle { centre, radius: RADIUS }.into()]);
        time += FRAME;
        let [seen] = tracker.tracks() else { continue };
        for (&ahead, samples) in samples.iter_mut().filter(|_| frame >= SETTLED) {
            let Some(later) = track.get(frame + ahead as usize) else { continue };
            let set = seen.predicted(ahead * FRAME);
            if let Shape::Circle(Circle { centre, .. }) = set.footprint {
                samples.push((centre.distance(*later), set.reach));
            }
        }
    }
}

fn print(ahead: f64, samples: &mut Samples) {
    let count = samples.len() as f64;
    let held = samples.iter().filter(|(error, reach)| error <= reach).count() as f64 / count;
    let area = samples.iter().map(|(_, reach)| reach * reach).sum::<f64>() / count;
    samples.sort_by(|a, b| a.0.total_cmp(&b.0));
    let quantile = |share: f64| samples[((count - 1.0) * share) as usize].0;
    let mean = samples.iter().map(|(error, _)| error).sum::<f64>() / count;
    println!(
        "{ahead:7.1}  {:7}  {:7.0}  {:6.0}  {:6.0}  {:6.2}  {:.2}",
        samples.len(),
        1000.0 * mean,
        1000.0 * quantile(0.95),
        1000.0 * quantile(0.99),
        100.0 * held,
        area / quantile(0.99).powi(2),
    );
}
