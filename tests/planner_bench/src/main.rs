//! Measures the planner against the crates `polyanya` and `pathfinding`, in one run, on one thread.
//!
//! ```text
//! cargo run --release --manifest-path tests/planner_bench/Cargo.toml -- ARENA.json...
//! ```
//! Every time is a median over the arena's queries. "First plan" starts from the scene and ends with a
//! path; "repeated" is a query on what is built. Ours is the whole library call: growing, search,
//! safety test and clearance. The peers get the grown boxes as a gift and only search.
//! `growth` instead of files prints the build time of random arenas from 100 to 100 000 boxes.

mod growth;
mod memory;
mod peers;

use host::plan::{PlanOptions, PreparedArena};
use host::scene::Scene;
use std::time::Instant;

/// Times each query is repeated on a built structure.
const REPEATS: usize = 15;

fn main() {
    let files: Vec<String> = std::env::args().skip(1).collect();
    if files == ["growth"] {
        growth::print();
        return;
    }
    println!(
        "| arena | N | what | first plan µs | build µs | repeated µs | length / exact max | failed | peak KiB |"
    );
    println!("|---|---|---|---|---|---|---|---|---|");
    for file in &files {
        let text = std::fs::read_to_string(file).expect("the arena can be read");
        let scene = Scene::from_json(&text).expect("the arena is a scene");
        let name = file.rsplit('/').next().unwrap_or(file);
        let print = |what: &str, row: Row| {
            println!(
                "| {name} | {} | {what} | {:.2} | {:.2} | {:.2} | {:.9} | {} | {} |",
                scene.obstacles.len(),
                row.first,
                row.build,
                row.repeated,
                row.ratio,
                row.failed,
                row.memory / 1024
            );
        };
        print("wmr exact", measure(&scene, |scene| Ours::new(scene)));
        print("polyanya, CDT", measure(&scene, |scene| peers::Crate::new(scene, false)));
        print("polyanya, CDT + merge", measure(&scene, |scene| peers::Crate::new(scene, true)));
        if scene.obstacles.len() <= 100 {
            print("pathfinding A*, 1 cm", measure(&scene, |scene| peers::Cells::new(scene)));
        }
    }
}

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

struct Row {
    first: f64,
    build: f64,
    repeated: f64,
    ratio: f64,
    failed: usize,
    memory: usize,
}

fn measure<'a, M: Measured>(scene: &'a Scene, build: impl Fn(&'a Scene) -> M) -> Row {
    let queries: Vec<_> = scene
        .queries
        .iter()
        .map(|q| (q.start.into(), q.goal.into(), q.length.unwrap_or(f64::NAN)))
        .collect();
    let mut row = Row { first: 0.0, build: 0.0, repeated: 0.0, ratio: 0.0, failed: 0, memory: 0 };
    let (mut firsts, mut builds) = (Vec::new(), Vec::new());
    for &(start, goal, _) in &queries {
        let before = memory::restart_peak();
        let begin = Instant::now();
        let mut built = build(scene);
        builds.push(micros(begin));
        std::hint::black_box(built.length(start, goal));
        firsts.push(micros(begin));
        row.memory = row.memory.max(memory::peak() - before);
    }
    let mut built = build(scene);
    queries.iter().for_each(|&(start, goal, _)| {
        std::hint::black_box(built.length(start, goal));
    });
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
    (row.first, row.build, row.repeated) =
        (median(&mut firsts), median(&mut builds), median(&mut repeated));
    row
}

fn micros(begin: Instant) -> f64 {
    begin.elapsed().as_secs_f64() * 1e6
}

fn median(times: &mut [f64]) -> f64 {
    times.sort_by(f64::total_cmp);
    times[times.len() / 2]
}
