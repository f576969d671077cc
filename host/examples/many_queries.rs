//! Many queries on one arena, prepared once: `cargo run --release -p wmr --example many_queries`.

use std::time::Instant;
use wmr::geometry::{Point, Rect};
use wmr::plan::{PlanError, PlanOptions, PreparedArena};
use wmr::scene::Scene;

fn main() -> Result<(), PlanError> {
    // A store of 30 × 30 m: shelves in rows, with a gap in each at another place.
    let mut store = Scene::new(30.0, 30.0);
    for row in 0..14 {
        let y = 1.5 + 2.0 * f64::from(row);
        let gap = 3.0 + f64::from(row * 7 % 24);
        store.obstacles.push(Rect::new(0.0, y, gap, y + 0.5).into());
        store.obstacles.push(Rect::new(gap + 1.0, y, 30.0, y + 0.5).into());
    }
    let options = PlanOptions::default();
    let began = Instant::now();
    let mut arena = PreparedArena::new(&store, &options)?;
    println!("prepared in {:.1?}", began.elapsed());
    // The first query searches; those that follow find roads between corners, and keep them.
    for round in 1..=3 {
        let began = Instant::now();
        let mut metres = 0.0;
        for column in 1..30 {
            let x = f64::from(column);
            metres += arena.plan(Point::new(x, 0.5), Point::new(30.0 - x, 29.5))?.length;
        }
        println!("round {round}: 29 ways, {metres:.1} m together, in {:.1?}", began.elapsed());
    }
    Ok(())
}
