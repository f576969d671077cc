//! Measures the planner against the crates `polyanya` and `pathfinding`, in one run, on one thread.
//!
//! ```text
//! cargo run --release --manifest-path tests/planner_bench/Cargo.toml -- ARENA.json...
//! ```
//! Every time is a median over the arena's queries, and the least of [`ROUNDS`] such medians, taken in
//! turns. "First plan" starts from the scene and ends with a path; "next" is a query that was not asked
//! before, on what is built; "repeated" one that was. Ours is the whole library call: growing, search,
//! safety test and clearance. The peers get the grown boxes as a gift and only search.
//!
//! Instead of files: `shapes` measures random polygons, `growth` prints the build time of random arenas from 100 to 100 000 boxes,
//! `paper ARENA.json...` how far from the shortest way the paper's modes end, `rows MAP ROWS...` every
//! row of Moving AI scenarios against its length.

mod growth;
mod memory;
mod paper;
mod peers;
mod rows;
mod shapes;
mod slabs;

use wmr::plan::{PlanOptions, PreparedArena};
use wmr::scene::Scene;
use std::time::Instant;

/// Times each query is repeated on a built structure.
const REPEATS: usize = 15;

/// Times everything is measured.
const ROUNDS: usize = 3;

/// Seconds after which first plans are no longer repeated; after twice as many no more are measured.
const FIRST_PLANS: f64 = 2.0;

fn main() {
    let files: Vec<String> = std::env::args().skip(1).collect();
    match files.first().map(String::as_str) {
        Some("growth") => return growth::print(),
        Some("shapes") => return shapes::print(),
        Some("paper") => return paper::print(&files[1..]),
        Some("rows") => {
            return files[1..].chunks(2).for_each(|pair| rows::print(&pair[0], &pair[1]));
        }
        _ => {}
    }
    println!(
        "| arena | N | what | first plan µs | build µs | next µs | repeated µs | length / exact max | failed | peak KiB |"
    );
    println!("|---|---|---|---|---|---|---|---|---|---|");
    for file in &files {
        let text = std::fs::read_to_string(file).expect("the arena can be read");
        let scene = Scene::from_json(&text).expect("the arena is a scene");
        let name = file.rsplit('/').next().unwrap_or(file);
        let few = scene.obstacles.len() <= 100;
        let mut peers: Vec<Peer> = vec![
            ("wmr exact", Box::new(|| measure(&scene, Ours::new))),
            (
                "polyanya, CDT",
                Box::new(|| measure(&scene, |scene| peers::Crate::new(scene, false))),
            ),
            (
                "polyanya, CDT + merge",
                Box::new(|| measure(&scene, |scene| peers::Crate::new(scene, true))),
            ),
            ("polyanya, slabs", Box::new(|| measure(&scene, peers::Crate::slabs))),
        ];
        if few {
            peers.push(("pathfinding A*, 1 cm", Box::new(|| measure(&scene, peers::Cells::new))));
        }
        let mut rows: Vec<Row> = peers.iter().map(|(_, measure)| measure()).collect();
        for _ in 1..ROUNDS {
            rows.iter_mut().zip(&peers).for_each(|(row, (_, measure))| row.take_less(&measure()));
        }
        for (row, (what, _)) in rows.iter().zip(&peers) {
            println!(
                "| {name} | {} | {what} | {:.2} | {:.2} | {:.2} | {:.2} | {:.9} | {} | {} |",
                scene.obstacles.len(),
                row.first,
                row.build,
                row.next,
                row.repeated,
                row.ratio,
                row.failed,
                row.memory / 1024
            );
        }
    }
}

/// A name and what measures it once.
type Peer<'a> = (&'static str, Box<dyn Fn() -> Row + 'a>);

/// Something that plans on one scene.
trait Measured {
    /// The length of the way, metres.
    fn length(&mut self, start: [f64; 2], goal: [f64; 2]) -> Option<f64>;
}

struct Ours<'a>(PreparedArena<'a>);

impl<'a> Ours<'a> {
    fn new(scene: &'a Scene) -> Self {
        static OPTIONS: std::sync::LazyLock<PlanOptions> =
            std::sync::LazyLock::new(PlanOptions::default);
        Self(PreparedArena::new(scene, &OPTIONS).expect("the arena can be planned on"))
    }
}

impl Measured for Ours<'_> {
    fn length(&mut self, start: [f64; 2], goal: [f64; 2]) -> Option<f64> {
        self.0.plan(start.into(), goal.into()).ok().map(|plan| plan.length)
    }
}

#[derive(Default)]
struct Row {
    first: f64,
    build: f64,
    next: f64,
    repeated: f64,
    ratio: f64,
    failed: usize,
    memory: usize,
}

impl Row {
    /// Keeps the lesser of each time.
    fn take_less(&mut self, other: &Self) {
        self.first = self.first.min(other.first);
        self.build = self.build.min(other.build);
        self.next = self.next.min(other.next);
        self.repeated = self.repeated.min(other.repeated);
    }
}

fn measure<'a, M: Measured>(scene: &'a Scene, build: impl Fn(&'a Scene) -> M) -> Row {
    let queries: Vec<_> = scene
        .queries
        .iter()
        .map(|q| (q.start.into(), q.goal.into(), q.length.unwrap_or(f64::NAN)))
        .collect();
    let mut row = Row::default();
    let (mut firsts, mut builds) = (Vec::new(), Vec::new());
    let all = Instant::now();
    for &(start, goal, _) in &queries {
        let (mut first, mut only) = (Vec::new(), Vec::new());
        while first.len() < REPEATS
            && (first.is_empty() || all.elapsed().as_secs_f64() < FIRST_PLANS)
        {
            let begin = Instant::now();
            let mut built = build(scene);
            only.push(micros(begin));
            std::hint::black_box(built.length(start, goal));
            first.push(micros(begin));
        }
        builds.push(median(&mut only));
        firsts.push(median(&mut first));
        if all.elapsed().as_secs_f64() > 2.0 * FIRST_PLANS {
            break;
        }
    }
    let before = memory::restart_peak();
    let mut built = build(scene);
    let mut next: Vec<f64> = queries
        .iter()
        .map(|&(start, goal, _)| {
            let begin = Instant::now();
            std::hint::black_box(built.length(start, goal));
            micros(begin)
        })
        .collect();
    let mut repeated = Vec::new();
    for &(start, goal, exact) in &queries {
        let mut times = Vec::new();
        for _ in 0..REPEATS {
            let begin = Instant::now();
            let length = std::hint::black_box(built.length(start, goal));
            times.push(micros(begin));
            match length {
                Some(length) => row.ratio = row.ratio.max(length / exact),
                None => row.failed += 1,
            }
        }
        repeated.push(median(&mut times));
    }
    row.failed /= REPEATS;
    row.memory = memory::peak() - before;
    (row.first, row.build) = (median(&mut firsts), median(&mut builds));
    (row.next, row.repeated) = (median(&mut next), median(&mut repeated));
    row
}

fn micros(begin: Instant) -> f64 {
    begin.elapsed().as_secs_f64() * 1e6
}

fn median(times: &mut [f64]) -> f64 {
    times.sort_by(f64::total_cmp);
    times[times.len() / 2]
}
