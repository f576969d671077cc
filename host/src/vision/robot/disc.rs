//! Discs in the picture, of a known radius and any colour: the places that edges surround.
//!
//! Edge points vote for the centre at the disc's radius; a centre that is seen from many directions is a
//! disc. Its circle is then fitted to the edge in the photo. Metres on the floor's plane, but for votes,
//! which are counted in the look's cells.

use crate::geometry::Point;
use crate::vision::appearance::{Look, feature};
use crate::vision::camera::PlanMap;
use crate::vision::image::{Photo, Raster, step};
use crate::vision::least_squares::{NormalEquations, tukey};
use nalgebra::SVector;
use std::f64::consts::TAU;

/// Directions that votes are sorted into, as bits.
pub(crate) const DIRECTIONS: u32 = 24;
/// A gradient that votes, standard deviations of the floor.
const LEAST_GRADIENT: f32 = 2.5;
/// Votes come from at least this many directions.
const LEAST_DIRECTIONS: u32 = 13;
/// Centres that are looked at.
const MOST_CENTRES: usize = 12;
/// A top whose height is not known is 2 % larger than its disc, more or less 5 %.
const USUAL_ENLARGEMENT: f64 = 1.02;
const USUAL_SLACK: f64 = 0.05;

/// How large a robot's top appears on the floor's plane.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Size {
    /// Its likely radius, metres.
    pub(crate) likely: f64,
    /// By how much more or less it may be, as a share.
    pub(crate) slack: f64,
}

impl Size {
    /// That of a disc of a radius in metres whose height above the floor is not known.
    pub(crate) fn guessed(radius: f64) -> Self {
        Self { likely: USUAL_ENLARGEMENT * radius, slack: USUAL_SLACK }
    }

    /// That of a disc which appears so many times larger than it is.
    pub(crate) fn known(radius: f64, enlargement: f64) -> Self {
        Self { likely: enlargement * radius, slack: 0.0 }
    }

    fn clamp(self, radius: f64) -> f64 {
        radius.clamp((1.0 - self.slack) * self.likely, (1.0 + self.slack) * self.likely)
    }
}

/// The cells (column, row) that edges of many directions surround at a radius, and how many directions.
pub(crate) fn centres(look: &Look, radius: f64) -> Vec<(f64, f64, u32)> {
    let (width, height) = (look.features.width(), look.features.height());
    let mut votes = Raster::filled(width, height, 0u32);
    for row in 1..height - 1 {
        for column in 1..width - 1 {
            let Some((gx, gy)) = gradient(look, column, row) else { continue };
            for sign in [1.0, -1.0] {
                let (dx, dy) = (sign * gx, sign * gy);
                let direction = (dy.atan2(dx) / TAU + 1.0) * f64::from(DIRECTIONS);
                let bit = 1 << (direction as u32 % DIRECTIONS);
                for reach in [-1.0, 0.0, 1.0] {
                    let (x, y) =
                        (column as f64 - (radius + reach) * dx, row as f64 - (radius + reach) * dy);
                    for (i, j) in [(0, 0), (1, 0), (0, 1), (1, 1)] {
                        let (x, y) = (x.floor() as i64 + i, y.floor() as i64 + j);
                        votes.set(x, y, votes.get(x, y).unwrap_or(0) | bit);
                    }
                }
            }
        }
    }
    peaks(look, &votes, radius)
}

/// The direction of a clear gradient of brightness or chroma, as a unit vector.
fn gradient(look: &Look, column: usize, row: usize) -> Option<(f64, f64)> {
    let (x, y) = (column as i64, row as i64);
    let [right, left, down, up] =
        [(x + 1, y), (x - 1, y), (x, y + 1), (x, y - 1)].map(|(x, y)| look.features.get(x, y));
    let (right, left, down, up) = (right?, left?, down?, up?);
    let part = |part: usize| {
        let spread = look.floor.spread[part];
        ((right[part] - left[part]) / spread, (down[part] - up[part]) / spread)
    };
    let parts = [part(0), part(1), part(2)];
    // A length is at most √2 times its greater component: most of the floor needs no roots.
    if parts.iter().all(|(x, y)| x.abs().max(y.abs()) < 0.7 * LEAST_GRADIENT) {
        return None;
    }
    let strongest = parts.into_iter().max_by(|a, b| a.0.hypot(a.1).total_cmp(&b.0.hypot(b.1)))?;
    let length = strongest.0.hypot(strongest.1);
    (length > LEAST_GRADIENT)
        .then(|| (f64::from(strongest.0 / length), f64::from(strongest.1 / length)))
}

/// The places with most directions, at least a radius from one another.
fn peaks(look: &Look, votes: &Raster<u32>, radius: f64) -> Vec<(f64, f64, u32)> {
    let mut places = Vec::new();
    for row in 0..votes.height() {
        for (column, vote) in votes.row(row).iter().enumerate() {
            if vote.count_ones() >= LEAST_DIRECTIONS && look.on_arena(column, row) {
                // Neighbours break ties: the middle of a patch of equal counts is the centre.
                let mut around = 0;
                for (i, j) in [(1, 0), (-1, 0), (0, 1), (0, -1)] {
                    around +=
                        votes.get(column as i64 + i, row as i64 + j).unwrap_or(0).count_ones();
                }
                places.push((8 * vote.count_ones() + around, column as f64, row as f64));
            }
        }
    }
    places.sort_by_key(|place| std::cmp::Reverse(place.0));
    let mut found: Vec<(f64, f64, u32)> = Vec::new();
    for (count, x, y) in places {
        if found.len() < MOST_CENTRES
            && found.iter().all(|other| (other.0 - x).hypot(other.1 - y) > 0.7 * radius)
        {
            found.push((x, y, (count / 8).min(DIRECTIONS)));
        }
    }
    found
}

/// The circle of the robot's top around a rough centre: centre and radius, metres.
pub(crate) fn circle(
    photo: &Photo,
    map: &PlanMap,
    look: &Look,
    rough: Point,
    size: Size,
) -> Option<(Point, f64)> {
    const RAYS: usize = 48;
    const SAMPLES: usize = 25;
    let radius = size.likely;
    let (mut centre, mut fitted) = clearest_circle(photo, map, rough, size);
    for reach in [0.12, 0.10] {
        let mut points = Vec::with_capacity(RAYS);
        for ray in 0..RAYS {
            let angle = TAU * ray as f64 / RAYS as f64;
            let distance =
                |index: f64| fitted * (1.0 - reach + 2.0 * reach * index / (SAMPLES - 1) as f64);
            let point = |index: f64| on_circle(centre, distance(index), angle);
            let lights: Vec<_> =
                (0..SAMPLES).map(|i| photo.light(map.to_photo(point(i as f64)))).collect();
            points.extend(step(&lights, None).map(point));
        }
        let Some((next, next_fitted)) =
            robust_circle(&points, (centre, fitted), size, 1.0 / look.view.scale)
        else {
            break;
        };
        if next.distance(centre) > 0.1 * radius || (next_fitted - fitted).abs() > 0.06 * radius {
            break;
        }
        (centre, fitted) = (next, next_fitted);
    }
    let near = centre.distance(rough) < 0.4 * radius;
    near.then_some((centre, size.clamp(fitted)))
}

pub(crate) fn on_circle(centre: Point, radius: f64, angle: f64) -> Point {
    Point::new(centre.x + radius * angle.cos(), centre.y + radius * angle.sin())
}

/// How clearly two points of the floor's plane differ: the square root of their features' distance.
pub(crate) fn contrast(photo: &Photo, map: &PlanMap, points: [Point; 2]) -> f32 {
    let [a, b] = points.map(|point| feature(photo.light(map.to_photo(point))));
    (0..3).map(|part| (a[part] - b[part]).powi(2)).sum::<f32>().powf(0.25)
}

/// The circle whose inside differs from its outside all around, from a rough one.
///
/// The square roots of the differences are added, so that a few great ones do not outweigh the rest.
/// Shadow and the robot's own side show arcs of other circles nearby; only that of the top is whole.
fn clearest_circle(photo: &Photo, map: &PlanMap, rough: Point, size: Size) -> (Point, f64) {
    const RAYS: usize = 36;
    let radius = size.likely;
    let half = 1.0 / map.scale_at(rough).max(1.0);
    let clarity = |centre: Point, radius: f64| {
        let ray = |ray: usize| {
            let angle = TAU * ray as f64 / RAYS as f64;
            contrast(
                photo,
                map,
                [radius - half, radius + half].map(|r| on_circle(centre, r, angle)),
            )
        };
        (0..RAYS).map(ray).sum::<f32>()
    };
    let mut best = (clarity(rough, radius), rough, radius);
    for step in [0.08 * radius, 0.04 * radius, 0.02 * radius, 0.01 * radius] {
        for _ in 0..10 {
            let (_, at, fitted) = best;
            let before = best.0;
            for (dx, dy, dr) in [
                (1.0, 0.0, 0.0),
                (-1.0, 0.0, 0.0),
                (0.0, 1.0, 0.0),
                (0.0, -1.0, 0.0),
                (0.0, 0.0, 0.5),
                (0.0, 0.0, -0.5),
            ] {
                let (next, larger) = (
                    Point::new(at.x + dx * step, at.y + dy * step),
                    size.clamp(fitted + dr * step),
                );
                let value = clarity(next, larger);
                if value > best.0 {
                    best = (value, next, larger);
                }
            }
            if best.0 <= before {
                break;
            }
        }
    }
    (best.1, best.2)
}

/// Least squares for centre and radius over the points within `width` of the circle, metres.
fn robust_circle(
    points: &[Point],
    (mut centre, mut radius): (Point, f64),
    size: Size,
    width: f64,
) -> Option<(Point, f64)> {
    for round in 0..6 {
        let width = width * f64::from(6 - round).max(1.0) / 2.0;
        let mut sums = NormalEquations::<3>::new(1e-9);
        // A radius that is known takes no part.
        sums.add_prior(2, 0.0, if size.slack > 0.0 { 0.0 } else { 1e9 });
        for point in points {
            let (dx, dy) = (point.x - centre.x, point.y - centre.y);
            let distance = dx.hypot(dy).max(1e-9);
            let error = distance - radius;
            let row = SVector::from([dx / distance, dy / distance, 1.0]);
            sums.add(row, error, tukey(error / width));
        }
        let change = sums.solve()?;
        centre = Point::new(centre.x + change.x, centre.y + change.y);
        radius += change.z;
    }
    (radius.is_finite() && radius > 0.0).then_some((centre, radius))
}
