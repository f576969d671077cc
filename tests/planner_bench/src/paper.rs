//! How far from the shortest way the paper's two modes end, arena by arena.

use crate::median;
use wmr::plan::{PlanOptions, Planner, PreparedArena};
use wmr::scene::Scene;

/// Prints length / exact of the grid and of the tree over the queries of each scene.
pub fn print(files: &[String]) {
    println!(
        "| arena | N | queries | planner | median | mean | max | exact to 1e-9 | trees cut | branches cut | failed |"
    );
    println!("|---|---|---|---|---|---|---|---|---|---|---|");
    for file in files {
        let text = std::fs::read_to_string(file).expect("the arena can be read");
        let scene = Scene::from_json(&text).expect("the arena is a scene");
        for planner in [Planner::Grid, Planner::Tree] {
            row(file.rsplit('/').next().unwrap_or(file), &scene, planner);
        }
    }
}

fn row(name: &str, scene: &Scene, planner: Planner) {
    let options = PlanOptions { planner, ..PlanOptions::default() };
    let head = format!(
        "| {name} | {} | {} | {} ",
        scene.obstacles.len(),
        scene.queries.len(),
        planner.name()
    );
    let mut arena = match PreparedArena::new(scene, &options) {
        Ok(arena) => arena,
        Err(error) => return println!("{head}| {error} ||||||||"),
    };
    let (mut ratios, mut failed, mut trees, mut branches) = (Vec::new(), 0, 0, 0);
    for query in &scene.queries {
        match (arena.plan(query.start, query.goal), query.length) {
            (Ok(plan), Some(exact)) => {
                ratios.push(plan.length / exact);
                let cut = plan.grid.and_then(|stages| stages.tree).map_or(0, |tree| tree.cut);
                branches += cut;
                trees += usize::from(cut > 0);
            }
            _ => failed += 1,
        }
    }
    let mean = ratios.iter().sum::<f64>() / ratios.len() as f64;
    let exact = ratios.iter().filter(|&&ratio| ratio <= 1.0 + 1e-9).count();
    let middle = median(&mut ratios);
    println!(
        "{head}| {middle:.4} | {mean:.4} | {:.4} | {exact} | {trees} | {branches} | {failed} |",
        ratios.last().copied().unwrap_or(f64::NAN)
    );
}
