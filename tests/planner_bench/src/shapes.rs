//! Polygons of 3 to 12 corners: ours, from the scene on, beside `polyanya`, which gets the inflated
//! outlines as a gift.

use crate::{ROUNDS, Row, measure, peers};
use std::time::Instant;
use wmr::geometry::{Point, Rect};
use wmr::plan::{PlanOptions, PreparedArena, inflated_contours};
use wmr::scene::{Query, Scene};
use wmr::shape::Polygon;

/// Queries of each arena.
const QUERIES: usize = 20;

/// Prints one table of times and the exponent with which the build grows.
pub fn print() {
    println!("| polygons | what | first plan µs | build µs | next µs | repeated µs | length / ours |");
    println!("|---|---|---|---|---|---|---|");
    let mut builds = Vec::new();
    for count in [10, 100, 1000, 10_000] {
        let scene = random(count);
        let contours: Vec<Vec<Point>> =
            inflated_contours(&scene, 0.0).expect("the arena can be planned on");
        let inside = {
            let r = scene.robot_radius;
            Rect::new(r, r, scene.arena.width - r, scene.arena.height - r)
        };
        let ours = || measure(&scene, crate::Ours::new);
        let cdt = || measure(&scene, |_| peers::Crate::around(&inside, &contours, false));
        let merged = || measure(&scene, |_| peers::Crate::around(&inside, &contours, true));
        let mut kinds: Vec<(&str, Box<dyn Fn() -> Row>)> = vec![("wmr exact", Box::new(ours))];
        if count < 10_000 {
            kinds.push(("polyanya, CDT", Box::new(cdt)));
            kinds.push(("polyanya, CDT + merge", Box::new(merged)));
        }
        let mut rows: Vec<Row> = kinds.iter().map(|(_, measure)| measure()).collect();
        for _ in 1..ROUNDS {
            rows.iter_mut().zip(&kinds).for_each(|(row, (_, measure))| row.take_less(&measure()));
        }
        builds.push((count as f64, rows[0].build));
        for (row, (what, _)) in rows.iter().zip(&kinds) {
            println!(
                "| {count} | {what} | {:.1} | {:.1} | {:.1} | {:.1} | {:.6} |",
                row.first, row.build, row.next, row.repeated, row.ratio
            );
        }
    }
    if let (Some(first), Some(last)) = (builds.get(1), builds.last()) {
        println!(
            "build, 100 to 10 000 polygons: exponent {:.3}",
            (last.1 / first.1).ln() / (last.0 / first.0).ln()
        );
    }
}

/// `count` convex polygons of 0.1 to 0.5 m on 0.8 m² each, with queries between free places whose lengths
/// are ours.
fn random(count: usize) -> Scene {
    let side = (0.8 * count as f64).sqrt();
    let mut scene = Scene::new(side, side);
    let mut state = 0x9E37_79B9_7F4A_7C15_u64;
    let mut next = move || {
        // SplitMix64.
        state = state.wrapping_add(0x9E37_79B9_7F4A_7C15);
        let mut z = state;
        z = (z ^ (z >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
        ((z ^ (z >> 31)) >> 11) as f64 / (1_u64 << 53) as f64
    };
    while scene.obstacles.len() < count {
        let radius = 0.05 + 0.2 * next();
        let (x, y) = (radius + next() * (side - 2.0 * radius), radius + next() * (side - 2.0 * radius));
        let mut angles: Vec<f64> =
            (0..3 + (10.0 * next()) as usize).map(|_| std::f64::consts::TAU * next()).collect();
        angles.sort_by(f64::total_cmp);
        let corner = |angle: &f64| Point::new(x + radius * angle.cos(), y + radius * angle.sin());
        if let Ok(polygon) = Polygon::new(angles.iter().map(corner).collect()) {
            scene.obstacles.push(polygon.into());
        }
    }
    let empty = scene.clone();
    let options = PlanOptions::default();
    let mut arena = PreparedArena::new(&empty, &options).expect("the arena can be planned on");
    let began = Instant::now();
    while scene.queries.len() < QUERIES && began.elapsed().as_secs() < 60 {
        let mut place = || Point::new(next() * side, next() * side);
        let (start, goal) = (place(), place());
        if let Ok(plan) = arena.plan(start, goal)
            && plan.exit_leg.is_none()
        {
            scene.queries.push(Query { start, goal, length: Some(plan.length) });
        }
    }
    scene
}
