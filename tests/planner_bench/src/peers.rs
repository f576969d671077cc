//! The crates that the planner is measured against.

use crate::Measured;
use wmr::geometry::{Point, Rect};
use wmr::scene::Scene;
use polyanya::{Mesh, Triangulation};

/// The obstacles grown by the radius, cut off at the shrunk border, and that border.
fn grown(scene: &Scene) -> (Rect, Vec<Rect>) {
    let r = scene.robot_radius;
    let inside = Rect::new(r, r, scene.arena.width - r, scene.arena.height - r);
    let grow = |b: &Rect| {
        Rect::new(
            (b.x0 - r).max(inside.x0),
            (b.y0 - r).max(inside.y0),
            (b.x1 + r).min(inside.x1),
            (b.y1 + r).min(inside.y1),
        )
    };
    let rects = scene.obstacles.iter().map(|obstacle| obstacle.footprint.bounds());
    let boxes = rects.map(|rect| grow(&rect)).filter(|b| b.x0 < b.x1 && b.y0 < b.y1).collect();
    (inside, boxes)
}

/// `polyanya` on its own constrained Delaunay triangulation, or on rectangles between vertical lines.
pub struct Crate(Mesh);

impl Crate {
    pub fn new(scene: &Scene, merge: bool) -> Self {
        let (inside, boxes) = grown(scene);
        let corners = |b: &Rect| {
            [(b.x0, b.y0), (b.x1, b.y0), (b.x1, b.y1), (b.x0, b.y1)]
                .map(|(x, y)| polyanya_vec(x, y))
        };
        let mut triangulation = Triangulation::from_outer_edges(&corners(&inside));
        triangulation.add_obstacles(boxes.iter().map(|b| corners(b).to_vec()));
        let mut mesh = triangulation.as_navmesh();
        if merge {
            while mesh.merge_polygons() {}
        }
        mesh.bake();
        Self(mesh)
    }

    /// A mesh of the floor in `inside` around these outlines.
    pub fn around(inside: &Rect, outlines: &[Vec<Point>], merge: bool) -> Self {
        let vertices =
            |points: &[Point]| points.iter().map(|p| polyanya_vec(p.x, p.y)).collect::<Vec<_>>();
        let mut triangulation = Triangulation::from_outer_edges(&vertices(&inside.corners()));
        triangulation.add_obstacles(outlines.iter().map(|outline| vertices(outline)));
        let mut mesh = triangulation.as_navmesh();
        if merge {
            while mesh.merge_polygons() {}
        }
        mesh.bake();
        Self(mesh)
    }

    pub fn slabs(scene: &Scene) -> Self {
        let (inside, boxes) = grown(scene);
        Self(crate::slabs::mesh(&inside, &boxes).expect("slabs are a mesh"))
    }
}

fn polyanya_vec(x: f64, y: f64) -> glam::Vec2 {
    glam::vec2(x as f32, y as f32)
}

impl Measured for Crate {
    fn length(&mut self, start: [f64; 2], goal: [f64; 2]) -> Option<f64> {
        let [start, goal] = [start, goal].map(|[x, y]| polyanya_vec(x, y));
        self.0.path(start, goal).map(|path| f64::from(path.length))
    }
}

/// `pathfinding`'s A* on a grid of 1 cm with eight neighbours.
pub struct Cells {
    width: i32,
    height: i32,
    blocked: Vec<bool>,
}

const CELL: f64 = 0.01;

impl Cells {
    pub fn new(scene: &Scene) -> Self {
        let (inside, boxes) = grown(scene);
        let cell = |metres: f64| (metres / CELL) as i32;
        let (width, height) = (cell(scene.arena.width) + 1, cell(scene.arena.height) + 1);
        let centre = |cell: i32| (f64::from(cell) + 0.5) * CELL;
        let mut blocked = vec![false; (width * height) as usize];
        for y in 0..height {
            for x in 0..width {
                let (px, py) = (centre(x), centre(y));
                let within =
                    inside.x0 <= px && px <= inside.x1 && inside.y0 <= py && py <= inside.y1;
                blocked[(y * width + x) as usize] = !within;
            }
        }
        for b in boxes {
            for y in cell(b.y0)..=cell(b.y1) {
                for x in cell(b.x0)..=cell(b.x1) {
                    if b.contains(wmr::geometry::Point::new(centre(x), centre(y))) {
                        blocked[(y * width + x) as usize] = true;
                    }
                }
            }
        }
        Self { width, height, blocked }
    }

    fn is_free(&self, x: i32, y: i32) -> bool {
        (0..self.width).contains(&x)
            && (0..self.height).contains(&y)
            && !self.blocked[(y * self.width + x) as usize]
    }
}

impl Measured for Cells {
    fn length(&mut self, start: [f64; 2], goal: [f64; 2]) -> Option<f64> {
        const STRAIGHT: u32 = 10_000;
        const DIAGONAL: u32 = 14_142;
        let [start, goal] = [start, goal].map(|[x, y]| ((x / CELL) as i32, (y / CELL) as i32));
        let next = |&(x, y): &(i32, i32)| {
            let mut steps = Vec::with_capacity(8);
            for (dx, dy) in [(1, 0), (0, 1), (-1, 0), (0, -1), (1, 1), (-1, 1), (-1, -1), (1, -1)] {
                let beside =
                    dx == 0 || dy == 0 || (self.is_free(x + dx, y) && self.is_free(x, y + dy));
                if beside && self.is_free(x + dx, y + dy) {
                    let cost = if dx == 0 || dy == 0 { STRAIGHT } else { DIAGONAL };
                    steps.push(((x + dx, y + dy), cost));
                }
            }
            steps
        };
        let rest = |&(x, y): &(i32, i32)| {
            let (dx, dy) = (x.abs_diff(goal.0), y.abs_diff(goal.1));
            STRAIGHT * dx.max(dy) + (DIAGONAL - STRAIGHT) * dx.min(dy)
        };
        let (_, cost) = pathfinding::prelude::astar(&start, next, rest, |at| *at == goal)?;
        Some(f64::from(cost) / f64::from(STRAIGHT) * CELL)
    }
}
