//! The triangle on the robot's top: which way it points, and with that where the top's centre is.
//!
//! The disc shows two colours, and a pixel at the triangle's edge a mixture of both. With m the share of the
//! triangle at a place and f what is seen there, the pose is searched for whose m explains most of f:
//!
//! ```text
//! R² = Σ cov(f, m)² / (var(m) Σ var(f)), both sums over the parts of f
//! ```
//! The triangle is lopsided on the disc, so this tells heading and centre together, and the top's edge is not
//! needed where it looks like the robot's side. Metres on the floor's plane, radians.

use crate::geometry::{Point, wrap_angle};
use crate::vision::appearance::{Feature, Look, feature};
use crate::vision::camera::PlanMap;
use crate::vision::image::Photo;
use std::f64::consts::{PI, TAU};

/// The triangle: its apex is ahead of the centre, its base behind, shares of the radius.
pub(super) const APEX: f64 = 0.8;
pub(super) const BASE: f64 = -0.533;
pub(super) const HALF_BASE: f64 = 0.373;
/// The part of the disc that is looked at, a share of its radius: the rest may be its edge's blur.
const INSIDE: f64 = 0.88;
/// Headings tried first.
const HEADINGS: usize = 72;
/// The centre is at most this far from that of the circle, shares of the radius.
const REACH: f64 = 0.2;
/// Steps of the search, shares of the radius and radians: from the first, halved, down to the last.
const FIRST_STEP: f64 = 0.04;
const LAST_STEP: f64 = 0.001;

/// Where a triangle is, in the frame of the disc's rough centre and in shares of its radius.
#[derive(Clone, Copy)]
struct Triangle {
    x: f64,
    y: f64,
    heading: f64,
}

impl Triangle {
    /// How far inside its nearest edge a place is; outside it is negative.
    fn depth(self, x: f64, y: f64) -> f64 {
        let (sin, cos) = self.heading.sin_cos();
        let (x, y) = (x - self.x, y - self.y);
        let (ahead, aside) = (x * cos + y * sin, (y * cos - x * sin).abs());
        let slope = HALF_BASE / (APEX - BASE);
        let flank = ((APEX - ahead) * slope - aside) / 1f64.hypot(slope);
        flank.min(ahead - BASE)
    }
}

/// What the disc shows.
struct Places {
    /// Places in shares of the radius, and what is seen there.
    seen: Vec<(f64, f64, Feature)>,
    /// The width of a blurred edge, shares of the radius.
    blur: f64,
}

impl Places {
    fn of(photo: &Photo, map: &PlanMap, look: &Look, centre: Point, radius: f64) -> Self {
        const GRID: i32 = 18;
        let mut seen = Vec::new();
        for (j, i) in (-GRID..=GRID).flat_map(|j| (-GRID..=GRID).map(move |i| (j, i))) {
            let (x, y) = (f64::from(i) / f64::from(GRID), f64::from(j) / f64::from(GRID));
            if x.hypot(y) < 1.0 {
                let (x, y) = (INSIDE * x, INSIDE * y);
                let at = Point::new(centre.x + x * radius, centre.y + y * radius);
                let shown = feature(photo.light(map.to_photo(at)));
                seen.push((x, y, [0, 1, 2].map(|part| shown[part] / look.floor.spread[part])));
            }
        }
        // A pixel, or the distance of places where that is more.
        let pixel = 1.0 / (map.scale_at(centre) * radius);
        Self { seen, blur: pixel.max(INSIDE / f64::from(GRID)) }
    }

    /// The share of the variance that a triangle of one colour on a disc of another explains.
    fn explained(&self, triangle: Triangle) -> f64 {
        let count = self.seen.len() as f64;
        let (mut share, mut shares) = (0.0, 0.0);
        let (mut sums, mut squares, mut products) = ([0.0; 3], [0.0; 3], [0.0; 3]);
        for &(x, y, seen) in &self.seen {
            let m = (0.5 + triangle.depth(x, y) / self.blur).clamp(0.0, 1.0);
            share += m;
            shares += m * m;
            for part in 0..3 {
                let value = f64::from(seen[part]);
                sums[part] += value;
                squares[part] += value * value;
                products[part] += value * m;
            }
        }
        let variance = shares - share * share / count;
        let (mut explained, mut total) = (0.0, 0.0);
        for part in 0..3 {
            total += squares[part] - sums[part] * sums[part] / count;
            explained += (products[part] - sums[part] * share / count).powi(2);
        }
        // Less than the floor's own noise is no triangle.
        explained / (variance.max(f64::MIN_POSITIVE) * total.max(count))
    }

    /// The heading that explains most with the triangle in the middle.
    fn turned(&self) -> (f64, Triangle) {
        let tried = (0..HEADINGS).map(|i| {
            let heading = -PI + TAU * i as f64 / HEADINGS as f64;
            let triangle = Triangle { x: 0.0, y: 0.0, heading };
            (self.explained(triangle), triangle)
        });
        let none = (0.0, Triangle { x: 0.0, y: 0.0, heading: 0.0 });
        tried.max_by(|a, b| a.0.total_cmp(&b.0)).unwrap_or(none)
    }

    /// The pose that explains most, from a rough one.
    fn settled(&self, mut best: (f64, Triangle)) -> (f64, Triangle) {
        let mut step = FIRST_STEP;
        while step > LAST_STEP {
            let Triangle { x, y, heading } = best.1;
            let tried = [(1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0)].into_iter();
            let next = tried
                .flat_map(|(dx, dy, turn)| [step, -step].map(|by| (by * dx, by * dy, by * turn)));
            let next = next.map(|(dx, dy, turn)| Triangle {
                x: x + dx,
                y: y + dy,
                heading: heading + turn,
            });
            let next = next.filter(|next| next.x.hypot(next.y) < REACH);
            let next =
                next.map(|next| (self.explained(next), next)).max_by(|a, b| a.0.total_cmp(&b.0));
            match next {
                Some(next) if next.0 > best.0 => best = next,
                _ => step /= 2.0,
            }
        }
        best
    }
}

/// The centre and the heading of a top of a radius whose centre is roughly known, and the share of its
/// colours' variance that the triangle explains.
pub(super) fn read(
    photo: &Photo,
    map: &PlanMap,
    look: &Look,
    (centre, radius): (Point, f64),
) -> (Point, f64, f64) {
    let places = Places::of(photo, map, look, centre, radius);
    let (explained, seen) = places.settled(places.turned());
    let centre = Point::new(centre.x + seen.x * radius, centre.y + seen.y * radius);
    (centre, wrap_angle(seen.heading), explained)
}
