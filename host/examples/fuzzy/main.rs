//! What the fuzzy planner reaches, in figures: `cargo run --release -p wmr --example fuzzy`.
//!
//! It draws scenes of discs and turned boxes from seeds, and judges the ways by the exact planner where
//! edges are sure, by fast marching on a grid four times finer where they are not.

mod reference;

use std::f64::consts::TAU;
use std::time::Instant;
use wmr::geometry::{Arena, Point};
use wmr::plan::{FuzzyOptions, Inflation, Plan, PlanError, PlanOptions, Planner, clearance, plan};
use wmr::scene::{Obstacle, Scene};
use wmr::shape::{Circle, Polygon, Shape};

/// The areas of the figures, metres.
const AREA: f64 = 0.01;

const START: Point = Point::new(0.1, 0.1);
const GOAL: Point = Point::new(1.9, 1.4);

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let scenes = binary_scenes(200);
    convergence(&scenes)?;
    lengths(&scenes)?;
    soft_costs(60)?;
    let soft: Vec<Scene> = (0..200).filter_map(|seed| scene(1000 + seed, 0.06)).collect();
    greatest_risks(&soft)?;
    times()
}

/// A scene of 200 × 150 areas from a seed, with margins up to `margin`; `None` if no way leads through it.
fn scene(seed: u64, margin: f64) -> Option<Scene> {
    let mut random = fastrand::Rng::with_seed(seed);
    let mut scene = Scene::new(2.0, 1.5);
    let mut between = |low: f64, high: f64| low + random.f64() * (high - low);
    for index in 0..9 {
        let centre = Point::new(between(0.0, 2.0), between(0.0, 1.5));
        let size = between(0.04, 0.16);
        let shape = if index % 2 == 0 {
            Shape::from(Circle { centre, radius: size })
        } else {
            let (turn, flat) = (between(0.0, TAU), between(0.2, 1.2));
            let corners = [flat, TAU / 2.0 - flat, TAU / 2.0 + flat, TAU - flat].map(|angle| {
                let angle = angle + turn;
                Point::new(centre.x + size * angle.cos(), centre.y + size * angle.sin())
            });
            Polygon::new(corners.to_vec()).ok()?.into()
        };
        let margin = if margin > 0.0 { between(0.2, 1.0) * margin } else { 0.0 };
        let room = [START, GOAL].map(|end| shape.distance(end) - scene.robot_radius - margin);
        if room.iter().all(|&room| room > 0.02) {
            scene.obstacles.push(Obstacle { footprint: shape, margin: [margin; 4], height: None });
        }
    }
    exact(&scene).is_ok().then_some(scene)
}

fn binary_scenes(count: usize) -> Vec<Scene> {
    (0..).filter_map(|seed| scene(seed, 0.0)).take(count).collect()
}

/// The exact way among the cores of a scene.
fn exact(scene: &Scene) -> Result<Plan, PlanError> {
    let mut cores = scene.clone();
    cores.obstacles.iter_mut().for_each(|obstacle| obstacle.margin = [0.0; 4]);
    let options = PlanOptions { inflation: Some(Inflation::Disc), ..PlanOptions::default() };
    plan(&cores, START, GOAL, &options)
}

fn fuzzy(scene: &Scene, area: f64, risk: f64) -> Result<Plan, PlanError> {
    let fuzzy = FuzzyOptions { risk, area: Some(area) };
    plan(scene, START, GOAL, &PlanOptions { planner: Planner::Fuzzy, fuzzy, ..Default::default() })
}

/// Median and greatest.
fn spread(values: &mut [f64]) -> (f64, f64) {
    values.sort_by(f64::total_cmp);
    let median = values.get(values.len() / 2).copied().unwrap_or(f64::NAN);
    (median, values.last().copied().unwrap_or(f64::NAN))
}

fn convergence(scenes: &[Scene]) -> Result<(), PlanError> {
    println!("length of the way / exact length, {} scenes without margins", scenes.len().min(50));
    println!("  area    median   greatest  corners of the way");
    for area in [0.04, 0.02, 0.01, 0.005] {
        let (mut ratios, mut corners) = (Vec::new(), 0);
        for scene in scenes.iter().take(50) {
            let way = fuzzy(scene, area, 10.0)?;
            ratios.push(way.length / exact(scene)?.length);
            corners += way.waypoints.len() - 2;
        }
        let (median, greatest) = spread(&mut ratios);
        let corners = corners as f64 / ratios.len() as f64;
        println!("  {:2.0} mm  {median:.5}   {greatest:.5}  {corners:.1}", area * 1000.0);
    }
    Ok(())
}

fn lengths(scenes: &[Scene]) -> Result<(), PlanError> {
    let (mut ratios, mut free) = (Vec::new(), 0);
    let mut corners = [0, 0];
    for (number, scene) in scenes.iter().enumerate() {
        let (way, best) = (fuzzy(scene, AREA, 10.0)?, exact(scene)?);
        free += usize::from(clearance(&way.waypoints, scene) >= scene.robot_radius - 1e-9);
        ratios.push(way.length / best.length);
        corners[0] += way.waypoints.len() - 2;
        corners[1] += best.waypoints.len() - 2;
        if way.length > 1.005 * best.length {
            println!("  scene {number}: {:.4} m, exact {:.4} m", way.length, best.length);
        }
    }
    let (median, greatest) = spread(&mut ratios);
    println!(
        "{} scenes, areas of 10 mm: {free} ways free; length / exact {median:.5} median, {greatest:.5} at most; \
         corners {} (exact {})",
        scenes.len(),
        corners[0],
        corners[1]
    );
    Ok(())
}

fn soft_costs(count: u64) -> Result<(), PlanError> {
    println!("cost / least cost by fast marching of second order at {} mm", AREA * 250.0);
    for weight in [1.0, 3.0, 10.0, 50.0] {
        let mut ratios = Vec::new();
        for seed in 0..count {
            let Some(scene) = scene(500 + seed, 0.08) else { continue };
            let best = reference::least_cost(&scene, (START, GOAL), AREA / 4.0, weight);
            let (Some(best), way) = (best, fuzzy(&scene, AREA, weight)?) else { continue };
            let ratio = reference::cost_along(&scene, &way.waypoints, weight).0 / best;
            if ratio > 1.005 {
                println!("  seed {}: {ratio:.5}", 500 + seed);
            }
            ratios.push(ratio);
        }
        let (median, greatest) = spread(&mut ratios);
        println!(
            "  weight {weight:4}: {median:.5} median, {greatest:.5} at most, {} scenes",
            ratios.len()
        );
    }
    Ok(())
}

fn greatest_risks(scenes: &[Scene]) -> Result<(), PlanError> {
    let weights =
        [0.0, 0.05, 0.1, 0.3, 0.5, 1.0, 1.5, 3.0, 7.0, 10.0, 30.0, 70.0, 150.0, 400.0, 1000.0];
    let (mut rises, mut falls, mut steepest) = (0, 0, 0.0_f64);
    for scene in scenes {
        let mut before = f64::INFINITY;
        for weight in weights {
            let way = fuzzy(scene, AREA, weight)?;
            let greatest = way.fuzzy.map_or(0.0, |stages| stages.greatest_risk);
            rises += usize::from(greatest > before);
            falls += usize::from(greatest < before && before.is_finite());
            steepest = steepest.max(greatest - before);
            before = greatest;
        }
    }
    println!(
        "{} scenes with {} weights each: the greatest risk rises {rises} times, falls {falls} times",
        scenes.len(),
        weights.len()
    );
    if rises > 0 {
        println!("  by {steepest:.6} at most");
    }
    Ok(())
}

fn times() -> Result<(), Box<dyn std::error::Error>> {
    for (name, margin) in [("sure edges", 0.0), ("margins of 30 mm", 0.03)] {
        let scene = eight_discs(margin);
        let mut least = [f64::INFINITY; 2];
        for _ in 0..30 {
            let fuzzy = FuzzyOptions { risk: 10.0, area: Some(AREA) };
            let options = PlanOptions { planner: Planner::Fuzzy, fuzzy, ..Default::default() };
            let began = Instant::now();
            let mut arena = wmr::plan::PreparedArena::new(&scene, &options)?;
            let built = began.elapsed();
            arena.plan(START, GOAL)?;
            let whole = began.elapsed();
            for (least, time) in least.iter_mut().zip([built, whole - built]) {
                *least = least.min(time.as_secs_f64() * 1000.0);
            }
        }
        println!(
            "200 x 150 areas, eight discs, {name}: {:.2} ms to build, {:.2} ms to plan (least of 30)",
            least[0], least[1]
        );
    }
    Ok(())
}

/// The scene of `host/benches/fuzzy_peer.py`.
fn eight_discs(margin: f64) -> Scene {
    let discs = [
        [0.45, 0.35, 0.10],
        [0.90, 0.30, 0.12],
        [1.45, 0.40, 0.10],
        [0.40, 0.85, 0.12],
        [0.95, 0.80, 0.14],
        [1.50, 0.95, 0.12],
        [0.60, 1.25, 0.08],
        [1.20, 1.25, 0.10],
    ];
    let arena = Arena { width: 2.0, height: 1.5 };
    let obstacle = |disc: [f64; 3]| Obstacle {
        footprint: Circle::from(disc).into(),
        margin: [margin; 4],
        height: None,
    };
    let obstacles = discs.map(obstacle).to_vec();
    Scene { obstacles, ..Scene::new(arena.width, arena.height) }
}
