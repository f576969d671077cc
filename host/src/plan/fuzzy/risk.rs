//! The risk of a place and of a leg: how likely the robot's disc would touch something there.
//!
//! Every obstacle has a *core*, its footprint inflated by the robot's radius (and the margin asked for),
//! where the robot's centre never is, and around it a *soft band* as wide as the obstacle's own margin,
//! which says how unsure its edges are. The risk falls linearly over the band:
//!
//! ```text
//! risk 1 |‾‾‾‾‾‾\                r(x) = 1 - s, where s is the share of its margin by which the footprint
//!        | core  \  band                would have to grow until the robot at x touches it
//!      0 |________\________      several obstacles: the greatest of their risks
//! ```
//! The membership "free" of a place is 1 - r. Metres.

use super::soft::Soft;
use crate::geometry::{Point, Rect};
use crate::grid::LatticeRect;
use crate::plan::box_index::BoxIndex;
use crate::scene::{Obstacle, Scene};
use crate::shape::Shape;

/// What float distances and the lattice of the last test may differ by, metres.
const GUARD: f64 = 1e-6;

/// The longest piece of a leg over which risk is integrated with two points, as a part of the narrowest
/// band it passes.
const PIECE: f64 = 0.5;

/// The risk everywhere in an arena.
#[derive(Clone, Debug)]
pub(super) struct RiskField {
    obstacles: Vec<Soft>,
    index: BoxIndex,
    /// Units of the index in a metre.
    scale: f64,
    /// The distance to keep from every footprint.
    keep: f64,
    /// Where the robot's centre may be as far as the border is concerned.
    inside: Rect,
}

/// What a leg costs, if it can be driven at all.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct LegRisk {
    /// The greatest risk on it.
    pub(super) greatest: f64,
    /// The integral of the risk along it, metres.
    pub(super) integral: f64,
}

impl RiskField {
    /// The risk in `scene`; the robot keeps its radius and `margin` metres from every footprint.
    pub(super) fn new(scene: &Scene, margin: f64) -> Self {
        let keep = scene.robot_radius + margin;
        let soft = |obstacle: &Obstacle| Soft {
            footprint: obstacle.footprint.clone(),
            margin: obstacle.margin,
            widest: obstacle.largest_margin(),
            bounds: obstacle
                .footprint
                .bounds()
                .widened([obstacle.largest_margin() + keep + GUARD; 4]),
        };
        let obstacles: Vec<Soft> = scene.obstacles.iter().map(soft).collect();
        let (width, height) = (scene.arena.width, scene.arena.height);
        let inside = Rect::new(keep, keep, width - keep, height - keep);
        // Coordinates of the index stay far below the largest integer.
        let scale = f64::from(1 << 20) / width.max(height);
        let floor = units(Rect::new(0.0, 0.0, width, height), scale);
        let bounds: Vec<LatticeRect> =
            obstacles.iter().map(|obstacle| units(obstacle.bounds, scale)).collect();
        Self { index: BoxIndex::new(floor, &bounds), obstacles, scale, keep, inside }
    }

    /// Where the robot's centre may be as far as the border is concerned.
    pub(super) fn inside(&self) -> Rect {
        self.inside
    }

    /// How many obstacles there are.
    pub(super) fn len(&self) -> usize {
        self.obstacles.len()
    }

    /// Around the core and the band of an obstacle.
    pub(super) fn bounds(&self, obstacle: usize) -> Rect {
        self.obstacles[obstacle].bounds
    }

    /// How far `point` lies outside the core of an obstacle, and outside its band; negative inside.
    pub(super) fn outside(&self, obstacle: usize, point: Point) -> (f64, f64) {
        let soft = &self.obstacles[obstacle];
        let from_core = soft.square(point, point, 0.0).sqrt() - self.keep;
        (from_core, from_core - soft.widest)
    }

    /// Whether the robot fits between two obstacles.
    pub(super) fn is_open_between(&self, a: usize, b: usize) -> bool {
        let (a, b) = (&self.obstacles[a].footprint, &self.obstacles[b].footprint);
        let (outline, less) = match a {
            Shape::Circle(circle) => (vec![circle.centre], circle.radius),
            shape => (shape.outline(), 0.0),
        };
        let edges = outline.iter().zip(outline.iter().cycle().skip(1));
        let least = edges.map(|(&p, &q)| b.leg_distance(p, q)).fold(f64::INFINITY, f64::min);
        least - less >= 2.0 * (self.keep + GUARD)
    }

    /// Whether the robot fits between an obstacle and the border, on any side.
    pub(super) fn is_open_at_border(&self, obstacle: usize) -> bool {
        let bounds = self.obstacles[obstacle].footprint.bounds();
        let room = self.keep + GUARD;
        bounds.x0 - room >= self.inside.x0
            || bounds.y0 - room >= self.inside.y0
            || bounds.x1 + room <= self.inside.x1
            || bounds.y1 + room <= self.inside.y1
    }

    /// The risk at `point`; 1 in a core and beyond the border.
    pub(super) fn at(&self, point: Point) -> f64 {
        if !self.is_inside(point) {
            return 1.0;
        }
        self.near(point, point).map(|number| self.of(number, point)).fold(0.0, f64::max)
    }

    /// The risk at `point` that comes from one obstacle.
    pub(super) fn of(&self, obstacle: usize, point: Point) -> f64 {
        self.obstacles[obstacle].greatest(point, point, self.keep)
    }

    /// Whether the border leaves room for the robot's centre at `point`.
    pub(super) fn is_inside(&self, point: Point) -> bool {
        (self.inside.x0..=self.inside.x1).contains(&point.x)
            && (self.inside.y0..=self.inside.y1).contains(&point.y)
    }

    /// The risk of the straight leg from `a` to `b`; `None` if it meets a core or the border, or if its
    /// risk is anywhere above `ceiling`.
    ///
    /// `near_ends`: at the ends of the way the robot may stand exactly as near as it may.
    pub(super) fn leg(&self, a: Point, b: Point, ceiling: f64, is_end: bool) -> Option<LegRisk> {
        if !(self.is_inside(a) && self.is_inside(b)) {
            return None;
        }
        let mut leg = LegRisk::default();
        let mut narrowest = f64::INFINITY;
        let (mut from, mut to) = (1.0_f64, 0.0_f64);
        for number in self.near(a, b) {
            let soft = &self.obstacles[number];
            if !overlap(&soft.bounds, a, b) {
                continue;
            }
            let distance = soft.square(a, b, 0.0).sqrt();
            let needed = if is_end { self.keep_at(soft, a, b) } else { self.keep + GUARD };
            if distance < needed {
                return None;
            }
            let greatest = soft.greatest_from(distance, (a, b), self.keep);
            if greatest > ceiling {
                return None;
            }
            if greatest > 0.0 {
                leg.greatest = leg.greatest.max(greatest);
                let (first, last) = clipped(&soft.bounds, a, b);
                (from, to) = (from.min(first), to.max(last));
                narrowest = narrowest.min(soft.narrowest());
            }
        }
        if leg.greatest > 0.0 && a != b {
            leg.integral = self.integral(a, b, (from, to), narrowest);
        }
        Some(leg)
    }

    /// The integral of the risk over a part of the leg, in pieces with two Gauss points each.
    fn integral(&self, a: Point, b: Point, (from, to): (f64, f64), narrowest: f64) -> f64 {
        let length = a.distance(b);
        let part = ((to - from) * length).max(0.0);
        let count = (part / (PIECE * narrowest)).ceil().clamp(4.0, 400.0);
        let numbers: Vec<usize> = self.near(a, b).collect();
        let risk = |along: f64| {
            let at = Point::new(a.x + along * (b.x - a.x), a.y + along * (b.y - a.y));
            numbers.iter().map(|&number| self.of(number, at)).fold(0.0, f64::max)
        };
        let piece = (to - from) / count;
        let gauss = [0.5 - 0.5 / 3_f64.sqrt(), 0.5 + 0.5 / 3_f64.sqrt()];
        let sum: f64 = (0..count as u32)
            .flat_map(|index| gauss.map(|at| risk(from + piece * (f64::from(index) + at))))
            .sum();
        sum * part / (2.0 * count)
    }

    /// `at`, or a place near it that is `spare` metres outside of every core and within the border, if so
    /// many `rounds` of moving away from one core after the other lead to one.
    pub(super) fn pushed_out(&self, at: Point, spare: f64, rounds: usize) -> Point {
        let inside = self.inside;
        let mut at = at;
        for _ in 0..rounds {
            let held =
                Point::new(at.x.clamp(inside.x0, inside.x1), at.y.clamp(inside.y0, inside.y1));
            let moved = self.pushed(held, spare);
            if moved == at {
                break;
            }
            at = moved;
        }
        at
    }

    /// `at`, moved away from each obstacle in turn to whose core it is nearer than `spare` metres.
    fn pushed(&self, at: Point, spare: f64) -> Point {
        const STEP: f64 = 1e-6;
        let mut at = at;
        for number in self.near(at, at) {
            let distance = |x: f64, y: f64| self.outside(number, Point::new(x, y)).0;
            let lacking = spare - distance(at.x, at.y);
            if lacking <= 0.0 {
                continue;
            }
            let gx = distance(at.x + STEP, at.y) - distance(at.x - STEP, at.y);
            let gy = distance(at.x, at.y + STEP) - distance(at.x, at.y - STEP);
            let steep = gx.hypot(gy);
            if steep > 0.0 {
                at = Point::new(at.x + lacking * gx / steep, at.y + lacking * gy / steep);
            }
        }
        at
    }

    /// Near an end of the way the robot may be as near as it stands there.
    fn keep_at(&self, soft: &Soft, a: Point, b: Point) -> f64 {
        let stand = soft.square(a, a, 0.0).min(soft.square(b, b, 0.0)).sqrt();
        (self.keep + GUARD).min((stand - 1e-12).max(self.keep - 1e-7))
    }

    fn near(&self, a: Point, b: Point) -> impl Iterator<Item = usize> {
        let span = Rect::new(a.x.min(b.x), a.y.min(b.y), a.x.max(b.x), a.y.max(b.y));
        self.index.near(units(span, self.scale))
    }
}

fn units(rect: Rect, scale: f64) -> LatticeRect {
    let unit = |metres: f64| (metres * scale).floor() as i32;
    LatticeRect::new(unit(rect.x0), unit(rect.y0), unit(rect.x1) + 1, unit(rect.y1) + 1)
}

fn overlap(rect: &Rect, a: Point, b: Point) -> bool {
    a.x.min(b.x) <= rect.x1
        && a.x.max(b.x) >= rect.x0
        && a.y.min(b.y) <= rect.y1
        && a.y.max(b.y) >= rect.y0
}

/// The part of the leg in the rectangle, from 0 at `a` to 1 at `b`.
fn clipped(rect: &Rect, a: Point, b: Point) -> (f64, f64) {
    let mut part = (0.0_f64, 1.0_f64);
    for (from, to, low, high) in [(a.x, b.x, rect.x0, rect.x1), (a.y, b.y, rect.y0, rect.y1)] {
        if from != to {
            let (first, last) = ((low - from) / (to - from), (high - from) / (to - from));
            part = (part.0.max(first.min(last)), part.1.min(first.max(last)));
        }
    }
    if part.0 <= part.1 { part } else { (0.0, 1.0) }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A rectangle with margins of 20, 0, 40 and 10 mm, and a disc with 50 mm, for a robot of 100 mm.
    fn field() -> RiskField {
        let mut scene = Scene::new(3.0, 2.0);
        scene.robot_radius = 0.1;
        let mut rect = Obstacle::from(Rect::new(1.0, 0.5, 1.4, 1.0));
        rect.margin = [0.02, 0.0, 0.04, 0.01];
        let mut disc = Obstacle::from(crate::shape::Circle::from([2.4, 1.0, 0.2]));
        disc.margin = [0.05; 4];
        scene.obstacles = vec![rect, disc];
        RiskField::new(&scene, 0.0)
    }

    #[test]
    fn the_risk_falls_linearly_over_each_margin() {
        let field = field();
        let places = [
            (0.885, 0.75, 0.25), // 15 of 20 mm left of the rectangle's core
            (1.52, 0.75, 0.5),   // 20 of 40 mm to the right
            (1.2, 1.1025, 0.75), // 2.5 of 10 mm above
            (1.2, 0.399, 0.0),   // no margin below
            (2.4, 1.325, 0.5),   // 25 of 50 mm above the disc's core
            (2.4, 1.29, 1.0),    // in the core
            (0.05, 0.5, 1.0),    // beyond the border
            // At a corner both margins count: grown by a half it reaches to (1.42, 1.005), 60 and 80 mm away.
            (1.48, 1.085, 0.5),
        ];
        for (x, y, risk) in places {
            let at = field.at(Point::new(x, y));
            assert!((at - risk).abs() < 1e-6, "({x}, {y}): {at}, not {risk}");
        }
    }

    #[test]
    fn a_leg_has_the_integral_and_the_greatest_of_its_risk() {
        let field = field();
        let leg = |a: [f64; 2], b: [f64; 2]| field.leg(a.into(), b.into(), 1.0, false);
        // Along the right side, at half of its margin.
        let along = leg([1.52, 0.6], [1.52, 0.9]).unwrap();
        assert!(
            (along.greatest - 0.5).abs() < 1e-6 && (along.integral - 0.15).abs() < 1e-6,
            "{along:?}"
        );
        // Away from it over the whole margin: a triangle of 40 mm by 1, less a hair beside the core.
        let away = leg([1.500_002, 0.75], [1.9, 0.75]).unwrap();
        assert!((away.integral - 0.02).abs() < 1e-4, "{away:?}");
        assert_eq!(leg([0.5, 1.3], [1.6, 1.3]), Some(LegRisk::default()));
        assert_eq!(leg([0.5, 0.75], [1.6, 0.75]), None);
        assert_eq!(field.leg([1.52, 0.6].into(), [1.52, 0.9].into(), 0.4, false), None);
    }

    #[test]
    fn only_gaps_as_wide_as_the_robot_are_open() {
        let field = field();
        assert!(field.is_open_between(0, 1) && field.is_open_between(1, 0), "0.8 m apart");
        let mut scene = Scene::new(2.0, 2.0);
        scene.robot_radius = 0.1;
        scene.obstacles = vec![
            crate::shape::Circle::from([1.0, 1.0, 0.2]).into(),
            Rect::new(0.0, 1.399, 2.0, 1.5).into(),
            Rect::new(0.0, 0.5, 2.0, 0.598).into(),
        ];
        let field = RiskField::new(&scene, 0.0);
        assert!(!field.is_open_between(0, 1) && field.is_open_between(0, 2));
    }
}
