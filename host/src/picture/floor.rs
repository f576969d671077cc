//! The arena seen from above as the ground of a picture: metres in, pixels out, y turned down.

use super::svg::{Svg, Swatch, TITLE_HEIGHT};
use crate::geometry::{Arena, Point, Pose, Rect};
use crate::grid::{LatticePoint, LatticeRect};
use crate::scene::Scene;
use crate::shape::Shape;

/// The longer side of the floor in a picture, pixels.
const FLOOR_SIZE: f64 = 760.0;

const PAD: f64 = 18.0;

/// The least width of a picture, so that title and legend have room, pixels.
const LEAST_WIDTH: f64 = 640.0;

/// More obstacles than these are not numbered: nobody could read it.
const MOST_NUMBERED: usize = 60;

/// A picture of the floor in the making.
#[derive(Clone, Debug)]
pub(super) struct Floor {
    pub(super) svg: Svg,
    arena: Arena,
    scale: f64,
    left: f64,
}

impl Floor {
    pub(super) fn new(arena: Arena, title: &str, subtitle: &str) -> Self {
        let scale = FLOOR_SIZE / arena.width.max(arena.height);
        let width = (arena.width * scale + 2.0 * PAD).max(LEAST_WIDTH);
        let svg = Svg::new(width, arena.height * scale + 2.0 * PAD, title, subtitle);
        let mut floor = Self { svg, arena, scale, left: (width - arena.width * scale) / 2.0 };
        floor.rect(Rect::new(0.0, 0.0, arena.width, arena.height), "floor");
        floor.scale_bar();
        floor
    }

    /// The true obstacles, cut off at the arena's border, with the numbers that errors give them.
    pub(super) fn obstacles(&mut self, scene: &Scene) {
        for obstacle in &scene.obstacles {
            self.shape(&obstacle.footprint, "obstacle");
        }
        if scene.obstacles.len() > MOST_NUMBERED {
            return;
        }
        for (index, obstacle) in scene.obstacles.iter().enumerate() {
            let (x, y) = self.pixel(obstacle.footprint.bounds().centre());
            self.svg.text((x, y + 4.5), "on-dark", "middle", 13.0, &(index + 1).to_string());
        }
    }

    /// A bar of a round length with its length, in the upper right corner above the floor.
    fn scale_bar(&mut self) {
        let right = self.left + self.arena.width * self.scale;
        let wanted = self.arena.width.max(self.arena.height) / 5.0;
        let power = 10f64.powf(wanted.log10().floor());
        let factor = [5.0, 2.0, 1.0].into_iter().find(|factor| factor * power <= wanted);
        let length = factor.unwrap_or(1.0) * power;
        let (left, y) = (right - length * self.scale, TITLE_HEIGHT + 4.0);
        let ends = [(left, y - 4.0), (left, y), (right, y), (right, y - 4.0)];
        self.svg.polyline(&ends, "ruler");
        let label = if length < 1.0 {
            format!("{:.0} cm", length * 100.0)
        } else {
            format!("{length:.0} m")
        };
        self.svg.text((left - 6.0, y + 1.0), "number", "end", 12.0, &label);
    }

    /// The robot's disc at its true size, with a line ahead.
    pub(super) fn robot(&mut self, pose: Pose, radius: f64) {
        self.dot(pose.position, radius * self.scale, "robot");
        let Point { x, y } = pose.position;
        let (sin, cos) = pose.heading.sin_cos();
        let ahead = Point::new(x + radius * cos, y + radius * sin);
        self.polyline(&[pose.position, ahead], "heading");
    }

    /// A shape, cut off at the arena's border.
    pub(super) fn shape(&mut self, shape: &Shape, class: &str) {
        match shape {
            Shape::Rect(rect) => self.rect(*rect, class),
            shape => self.polygon(&shape.outline(), class),
        }
    }

    /// What a closed outline encloses of the arena.
    pub(super) fn polygon(&mut self, outline: &[Point], class: &str) {
        let (width, height) = (self.arena.width, self.arena.height);
        // Cut off at one side after the other (Sutherland and Hodgman).
        let inward: [fn(Point, f64, f64) -> f64; 4] =
            [|p, _, _| p.x, |p, _, _| p.y, |p, width, _| width - p.x, |p, _, height| height - p.y];
        let mut cut = outline.to_vec();
        for depth in inward {
            let depth = |p: Point| depth(p, width, height);
            let edges = cut.iter().copied().zip(cut.iter().copied().cycle().skip(1));
            cut = edges
                .flat_map(|(a, b)| {
                    let share = depth(a) / (depth(a) - depth(b));
                    let crossing = Point::new(a.x + share * (b.x - a.x), a.y + share * (b.y - a.y));
                    let is_cut = (depth(a) < 0.0) != (depth(b) < 0.0);
                    [(depth(a) >= 0.0).then_some(a), is_cut.then_some(crossing)]
                })
                .flatten()
                .collect();
        }
        let pixels: Vec<(f64, f64)> = cut.iter().map(|&point| self.pixel(point)).collect();
        self.svg.polygon(&pixels, class);
    }

    pub(super) fn rect(&mut self, rect: Rect, class: &str) {
        let (width, height) = (self.arena.width, self.arena.height);
        let (x0, x1) = (rect.x0.clamp(0.0, width), rect.x1.clamp(0.0, width));
        let (y0, y1) = (rect.y0.clamp(0.0, height), rect.y1.clamp(0.0, height));
        let size = ((x1 - x0) * self.scale, (y1 - y0) * self.scale);
        let corner = self.pixel(Point::new(x0, y1));
        self.svg.rect(corner, size, class);
    }

    pub(super) fn polyline(&mut self, points: &[Point], class: &str) {
        let pixels: Vec<(f64, f64)> = points.iter().map(|&point| self.pixel(point)).collect();
        self.svg.polyline(&pixels, class);
    }

    pub(super) fn dot(&mut self, point: Point, radius: f64, class: &str) {
        let pixel = self.pixel(point);
        self.svg.circle(pixel, radius, class);
    }

    pub(super) fn pixel(&self, point: Point) -> (f64, f64) {
        let x = self.left + point.x * self.scale;
        (x, TITLE_HEIGHT + PAD + (self.arena.height - point.y) * self.scale)
    }

    /// Start and goal as dots.
    pub(super) fn ends(&mut self, start: Point, goal: Point) {
        self.dot(start, 9.0, "start");
        self.dot(goal, 9.0, "goal");
    }

    pub(super) fn finish(self, legend: &[(Swatch, &str)]) -> String {
        self.svg.finish(legend)
    }
}

/// A lattice rectangle in metres.
pub(super) fn metres(rect: LatticeRect) -> Rect {
    let low = LatticePoint::new(rect.x0, rect.y0).to_metres();
    let high = LatticePoint::new(rect.x1, rect.y1).to_metres();
    Rect::new(low.x, low.y, high.x, high.y)
}
