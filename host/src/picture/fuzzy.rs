//! The fuzzy grid as a heat map: how free every area is, and the way that was found through it
//! [Alghannam, Sec. VI].

use super::floor::Floor;
use super::svg::Swatch;
use crate::geometry::Rect;
use crate::plan::{FuzzyStages, MembershipGrid, Plan};
use crate::scene::Scene;

/// The classes of memberships, from blocked to nearly free; wholly free areas stay white.
const LEVELS: [&str; 6] = ["free0", "free1", "free2", "free3", "free4", "free5"];

/// Obstacles, memberships and the way as SVG.
pub fn membership(scene: &Scene, plan: &Plan, stages: &FuzzyStages) -> String {
    let grid = &stages.grid;
    let subtitle = format!(
        "{} × {} areas of {:.1} mm; risk weight {}, cost {:.3} m, greatest risk {:.2}",
        grid.columns(),
        grid.rows(),
        grid.side() * 1000.0,
        stages.weight,
        stages.cost,
        stages.greatest_risk
    );
    let mut floor = Floor::new(scene.arena, "How free every area is", &subtitle);
    for (rect, class) in runs(grid) {
        floor.rect(rect, class);
    }
    floor.obstacles(scene);
    floor.polyline(&plan.waypoints, "path");
    if let (Some(&start), Some(&goal)) = (plan.waypoints.first(), plan.waypoints.last()) {
        floor.ends(start, goal);
    }
    floor.finish(&[
        (Swatch::Fill("obstacle"), "obstacle"),
        (Swatch::Fill(LEVELS[0]), "membership 0: blocked"),
        (Swatch::Fill(LEVELS[2]), "a half"),
        (Swatch::Fill(LEVELS[5]), "nearly 1: free"),
        (Swatch::Line("path"), "path"),
        (Swatch::Dot("start"), "start"),
        (Swatch::Dot("goal"), "goal"),
    ])
}

/// Areas of one class side by side, as one rectangle each; without the free ones.
fn runs(grid: &MembershipGrid) -> Vec<(Rect, &'static str)> {
    let mut runs = Vec::new();
    let side = grid.side();
    for (row, areas) in grid.areas().chunks(grid.columns()).enumerate() {
        let classes: Vec<Option<&str>> =
            areas.iter().map(|area| class(area.membership())).collect();
        let mut column = 0;
        let low = row as f64 * side;
        for run in classes.chunk_by(|a, b| a == b) {
            let from = column as f64 * side;
            column += run.len();
            if let Some(class) = run[0] {
                runs.push((Rect::new(from, low, column as f64 * side, low + side), class));
            }
        }
    }
    runs
}

fn class(membership: f32) -> Option<&'static str> {
    let level = (membership * LEVELS.len() as f32) as usize;
    if membership >= 1.0 { None } else { LEVELS.get(level).copied() }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::Point;
    use crate::plan::{PlanOptions, Planner, plan};
    use crate::shape::Circle;

    #[test]
    fn blocked_areas_are_dark_free_ones_white_and_the_way_is_on_top() {
        let mut scene = Scene::new(1.0, 1.0);
        scene.obstacles.push(Circle::from([0.5, 0.5, 0.1]).into());
        let options = PlanOptions { planner: Planner::Fuzzy, ..Default::default() };
        let plan = plan(&scene, Point::new(0.2, 0.2), Point::new(0.8, 0.8), &options).unwrap();
        let stages = plan.fuzzy.as_deref().unwrap();
        let svg = membership(&scene, &plan, stages);
        let dark: f64 = runs(&stages.grid)
            .iter()
            .filter(|(_, class)| *class == LEVELS[0])
            .map(|(rect, _)| rect.area())
            .sum();
        // The core of 175 mm, and the border's 75 mm all around, but for areas in part.
        let blocked = std::f64::consts::PI * 0.175 * 0.175 + 1.0 - 0.85 * 0.85;
        assert!((dark - blocked).abs() < 0.06 * blocked, "{dark} {blocked}");
        assert!(svg.contains("100 × 100 areas of 10.0 mm") && svg.contains("class=\"path\""));
    }
}
