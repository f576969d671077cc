//! Every row of a scenario file against its length: Moving AI `.scen`, or lines `sx sy gx gy length`.
//!
//! Points are integer corners of cells, y counted down from the top; lengths are in cells.

use crate::{median, micros};
use wmr::geometry::Point;
use wmr::map::CellMap;
use wmr::plan::{PlanOptions, PreparedArena};
use std::time::Instant;

struct Row {
    start: Point,
    goal: Point,
    length: f64,
}

/// Prints how the lengths on the map at `map` compare with the `rows`, and the median time of a query.
pub fn print(map: &str, rows: &str) {
    let text = std::fs::read_to_string(map).expect("the map can be read");
    let cells = CellMap::from_movingai(&text, 1.0).expect("the file is a Moving AI map");
    let scene = cells.to_scene(0.0);
    let text = std::fs::read_to_string(rows).expect("the rows can be read");
    let rows: Vec<Row> = text.lines().filter_map(|line| parse(line, cells.rows)).collect();
    let options = PlanOptions::default();
    let begin = Instant::now();
    let mut arena = PreparedArena::new(&scene, &options).expect("the map can be planned on");
    let build = micros(begin);
    let (mut worst, mut failed, mut first, mut again) = (0.0_f64, 0, Vec::new(), Vec::new());
    for row in &rows {
        let begin = Instant::now();
        match arena.plan(row.start, row.goal) {
            Ok(plan) => worst = worst.max((plan.length - row.length).abs() / row.length.max(1.0)),
            Err(_) => failed += 1,
        }
        first.push(micros(begin));
    }
    for row in &rows {
        let begin = Instant::now();
        std::hint::black_box(arena.plan(row.start, row.goal).is_ok());
        again.push(micros(begin));
    }
    println!(
        "| {map} | {} boxes | {} rows | {failed} failed | off by {worst:.1e} at most | build {build:.0} µs | new query {:.1} µs | again {:.1} µs |",
        scene.obstacles.len(),
        rows.len(),
        median(&mut first),
        median(&mut again)
    );
}

/// A row of nine fields as in `.scen`, or of five.
fn parse(line: &str, height: usize) -> Option<Row> {
    let fields: Vec<f64> = line.split_whitespace().filter_map(|word| word.parse().ok()).collect();
    let &[sx, sy, gx, gy, length] = fields.get(fields.len().checked_sub(5)?..)? else {
        return None;
    };
    let at = |x: f64, y: f64| Point::new(x, height as f64 - y);
    Some(Row { start: at(sx, sy), goal: at(gx, gy), length })
}
