//! The way in pictures: the tree of global paths, and the path with its entry and exit points
//! [Alghannam, Sec. III].

use super::floor::{Floor, metres};
use super::grid::grown;
use super::svg::{Svg, Swatch};
use crate::geometry::{Arena, Point, Rect};
use crate::grid::{LatticePoint, enlarge};
use crate::plan::{GridStages, Inflation, PathTree, Plan, PlanOptions, Planner, inflated_contours};
use crate::scene::Scene;

/// Global paths drawn of a tree; more would not be read.
const PATHS_DRAWN: usize = 24;

const LEVEL_WIDTH: f64 = 58.0;
const LEAF_HEIGHT: f64 = 25.0;
const NODE_RADIUS: f64 = 11.0;

/// The tree of global paths as SVG: areas by their numbers, the chosen path thick. Of a large tree
/// the paths shortest before shortening are drawn.
pub fn path_tree(tree: &PathTree, stages: &GridStages) -> String {
    let chosen = tree.arrivals.iter().copied().find(|&at| tree.path(at) == stages.global_path);
    let mut paths = tree.arrivals.clone();
    paths.sort_by(|&a, &b| tree.nodes[a].length.total_cmp(&tree.nodes[b].length));
    paths.truncate(PATHS_DRAWN);
    if let Some(at) = chosen.filter(|at| !paths.contains(at)) {
        paths.pop();
        paths.push(at);
    }
    let layout = Layout::of(tree, &paths);
    let subtitle = format!(
        "{} nodes, {} global paths ({} drawn), {} branches cut",
        tree.nodes.len(),
        tree.arrivals.len(),
        paths.len(),
        tree.cut
    );
    let width = (LEVEL_WIDTH * (layout.depth + 1) as f64 + 140.0).max(640.0);
    let height = LEAF_HEIGHT * paths.len() as f64 + 30.0;
    let mut svg = Svg::new(width, height, "The tree of global paths", &subtitle);
    draw_edges(&mut svg, tree, &layout, chosen);
    draw_nodes(&mut svg, (tree, stages), &layout, chosen);
    svg.finish(&[
        (Swatch::Dot("node"), "area by its number; length by entry and exit points"),
        (Swatch::Line("best-edge"), "chosen: shortest once useless points are dropped"),
    ])
}

/// Where the drawn nodes stand.
struct Layout {
    /// By node: its level and the height of its place, if it is drawn.
    places: Vec<Option<(usize, f64)>>,
    depth: usize,
}

impl Layout {
    /// Leaves one below the other in the order of the tree, every parent in the middle of its children.
    fn of(tree: &PathTree, leaves: &[usize]) -> Self {
        let mut branches: Vec<Vec<usize>> = leaves.iter().map(|&leaf| branch(tree, leaf)).collect();
        branches.sort();
        let depth = branches.iter().map(Vec::len).max().unwrap_or(1) - 1;
        let mut spans: Vec<Option<(usize, f64, f64)>> = vec![None; tree.nodes.len()];
        for (row, branch) in branches.iter().enumerate() {
            let row = row as f64;
            for (level, &node) in branch.iter().enumerate() {
                let top = spans[node].map_or(row, |(_, top, _)| top);
                spans[node] = Some((level, top, row));
            }
        }
        let middle = |(level, top, bottom): (usize, f64, f64)| (level, (top + bottom) / 2.0);
        Self { places: spans.into_iter().map(|span| span.map(middle)).collect(), depth }
    }

    fn pixel(&self, node: usize) -> Option<(f64, f64)> {
        let (level, row) = self.places[node]?;
        let y = super::svg::TITLE_HEIGHT + 28.0 + LEAF_HEIGHT * row;
        Some((34.0 + LEVEL_WIDTH * level as f64, y))
    }
}

/// The nodes from the root to `node`.
fn branch(tree: &PathTree, node: usize) -> Vec<usize> {
    let parent = |&at: &usize| (at != 0).then(|| tree.nodes[at].parent);
    let mut nodes: Vec<usize> = std::iter::successors(Some(node), parent).collect();
    nodes.reverse();
    nodes
}

fn draw_edges(svg: &mut Svg, tree: &PathTree, layout: &Layout, chosen: Option<usize>) {
    let best = chosen.map(|at| branch(tree, at)).unwrap_or_default();
    // The chosen path comes last and so lies on top.
    for thick in [false, true] {
        for (node, [from, to]) in edges(tree, layout) {
            if best.contains(&node) == thick {
                let bend = from.0 + LEVEL_WIDTH * 0.5;
                let class = if thick { "best-edge" } else { "edge" };
                svg.polyline(&[from, (bend, to.1), to], class);
            }
        }
    }
}

/// By node: the places of its parent and of itself.
fn edges(tree: &PathTree, layout: &Layout) -> Vec<(usize, [(f64, f64); 2])> {
    let edge = |node: usize| {
        let from = layout.pixel(tree.nodes[node].parent)?;
        Some((node, [from, layout.pixel(node)?]))
    };
    (1..tree.nodes.len()).filter_map(edge).collect()
}

fn draw_nodes(
    svg: &mut Svg,
    (tree, stages): (&PathTree, &GridStages),
    layout: &Layout,
    chosen: Option<usize>,
) {
    let goal = stages.entry_exit_points.last();
    let best = chosen.map(|at| branch(tree, at)).unwrap_or_default();
    for (node, of) in tree.nodes.iter().enumerate() {
        let Some((x, y)) = layout.pixel(node) else { continue };
        let is_best = best.contains(&node);
        svg.circle((x, y), NODE_RADIUS, if is_best { "best-node" } else { "node" });
        let class = if is_best { "on-dark" } else { "legend" };
        svg.text((x, y + 3.6), class, "middle", 10.0, &of.area.number().to_string());
        if tree.arrivals.contains(&node) {
            // A node's length ends where its branch enters the goal's area.
            let rest = goal.map_or(0.0, |goal| of.entry.distance(*goal));
            let metres = (of.length + rest) / crate::grid::UNITS_PER_METRE;
            svg.text((x + 17.0, y + 4.0), "subtitle", "start", 12.0, &format!("{metres:.3} m"));
        }
    }
}

/// The path as SVG: the areas of the global path, entry and exit points, which of them were dropped,
/// and the legs that are left. `options` are those that it was planned with: they say how obstacles grow.
pub fn path(scene: &Scene, plan: &Plan, options: &PlanOptions) -> String {
    // An exact way owes nothing to the areas, even if they were cut for other pictures.
    let stages = plan.grid.as_ref().filter(|_| plan.planner != Planner::Exact);
    let legs = plan.waypoints.len() - 1;
    let subtitle = format!(
        "{legs} leg{}, {:.3} m long, never nearer than {:.1} cm to an obstacle or the border",
        if legs == 1 { "" } else { "s" },
        plan.length,
        plan.clearance * 100.0
    );
    let mut floor = Floor::new(scene.arena, "The way from start to goal", &subtitle);
    let mut legend = vec![(Swatch::Fill("obstacle"), "obstacle")];
    if let Some(stages) = stages {
        for &area in &stages.global_path.areas {
            floor.rect(metres(stages.closed.rect(area)), "area chosen");
        }
    }
    grown_obstacles(&mut floor, scene, options, &mut legend);
    floor.obstacles(scene);
    if let Some(stages) = stages {
        global_path(&mut floor, stages, &mut legend);
    }
    if let Some(pose) = scene.start {
        floor.robot(pose, scene.robot_radius);
        legend.push((Swatch::Fill("robot"), "robot, true size"));
    }
    floor.polyline(&plan.waypoints, "path");
    legend.push((Swatch::Line("path"), "path"));
    if let Some(stages) = stages {
        points(&mut floor, stages, &mut legend);
    }
    if let (Some(&start), Some(&goal)) = (plan.waypoints.first(), plan.waypoints.last()) {
        floor.ends(start, goal);
        legend.extend([(Swatch::Dot("start"), "start"), (Swatch::Dot("goal"), "goal")]);
    }
    floor.finish(&legend)
}

/// The obstacles as the robot's centre sees them, and the border likewise.
fn grown_obstacles(
    floor: &mut Floor,
    scene: &Scene,
    options: &PlanOptions,
    legend: &mut Vec<(Swatch, &str)>,
) {
    let fill = match options.inflation_for(scene) {
        Inflation::Square => "grown",
        Inflation::Disc => "inflated",
    };
    if fill == "grown" {
        let Ok(arena) = enlarge(scene, options.margin) else { return };
        grown(floor, &arena);
    } else {
        let contours = inflated_contours(scene, options.margin).unwrap_or_default();
        contours.iter().for_each(|contour| floor.polygon(contour, fill));
    }
    let by = scene.robot_radius + options.margin;
    let Arena { width, height } = scene.arena;
    floor.rect(Rect::new(by, by, width - by, height - by), "inside");
    legend.extend([
        (Swatch::Fill(fill), "grown by the radius and margin"),
        (Swatch::Line("inside"), "border shrunk by both"),
    ]);
}

fn global_path(floor: &mut Floor, stages: &GridStages, legend: &mut Vec<(Swatch, &str)>) {
    let local: Vec<Point> = stages.entry_exit_points.iter().map(|p| p.to_metres()).collect();
    floor.polyline(&local, "local");
    legend.extend([
        (Swatch::Fill("area chosen"), "global path"),
        (Swatch::Line("local"), "local path"),
    ]);
}

fn points(floor: &mut Floor, stages: &GridStages, legend: &mut Vec<(Swatch, &str)>) {
    let is_kept = |point: &&LatticePoint| stages.kept.contains(point);
    let (kept, dropped): (Vec<&LatticePoint>, Vec<&LatticePoint>) =
        stages.entry_exit_points.iter().partition(is_kept);
    dropped.iter().for_each(|point| floor.dot(point.to_metres(), 4.5, "dropped"));
    kept.iter().for_each(|point| floor.dot(point.to_metres(), 6.0, "kept"));
    legend.extend([
        (Swatch::Dot("dropped"), "entry and exit point, dropped as useless"),
        (Swatch::Dot("kept"), "kept"),
    ]);
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::grid::Area;
    use crate::plan::plan;

    fn paper() -> (Scene, Plan) {
        let scene = Scene::from_json(include_str!("../../assets/paper.json")).unwrap();
        let (start, goal) = (scene.start.unwrap().position, scene.goal.unwrap().position);
        let options = PlanOptions { planner: Planner::Tree, ..Default::default() };
        let plan = plan(&scene, start, goal, &options).unwrap();
        (scene, plan)
    }

    #[test]
    fn the_tree_names_every_area_of_the_chosen_path() {
        let stages = paper().1.grid.unwrap();
        let svg = path_tree(stages.tree.as_ref().unwrap(), &stages);
        for number in stages.global_path.areas.iter().map(|area: &Area| area.number()) {
            assert!(svg.contains(&format!(">{number}</text>")), "area {number} is missing");
        }
        assert!(svg.contains("98 global paths (24 drawn)"));
    }

    #[test]
    fn the_tree_gives_the_whole_length_of_the_chosen_path() {
        let stages = paper().1.grid.unwrap();
        let svg = path_tree(stages.tree.as_ref().unwrap(), &stages);
        let points = &stages.entry_exit_points;
        let steps = points.iter().zip(&points[1..]).map(|(from, to)| from.distance(*to));
        let metres = steps.sum::<f64>() / crate::grid::UNITS_PER_METRE;
        assert!(svg.contains(&format!(">{metres:.3} m</text>")), "{metres}");
    }

    #[test]
    fn the_path_shows_each_point_once_as_kept_or_dropped() {
        let (scene, plan) = paper();
        let svg = path(&scene, &plan, &PlanOptions::default());
        let dots = |class: &str| svg.matches(&format!("r=\"4.50\" class=\"{class}\"")).count();
        let stages = plan.grid.unwrap();
        assert_eq!(dots("dropped"), stages.entry_exit_points.len() - stages.kept.len());
    }

    #[test]
    fn an_exact_way_is_drawn_with_the_grown_boxes_as_they_grew() {
        let (scene, _) = paper();
        let (start, goal) = (scene.start.unwrap().position, scene.goal.unwrap().position);
        let drawn = |inflation: Inflation| {
            let options = PlanOptions { inflation: Some(inflation), ..Default::default() };
            path(&scene, &plan(&scene, start, goal, &options).unwrap(), &options)
        };
        let (square, round) = (drawn(Inflation::Square), drawn(Inflation::Disc));
        let count = |svg: &str, what: &str| svg.matches(what).count();
        assert_eq!(count(&square, "class=\"grown\""), 5, "four obstacles and the legend");
        assert_eq!(count(&round, "class=\"inflated\""), 5);
        assert_eq!(count(&round, "<polygon"), 4);
    }
}
