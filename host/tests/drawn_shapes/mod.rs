//! Random arenas with shapes of every kind, drawn by code that shares nothing with what finds them: turned
//! boxes, discs, polygons, walls of 1.5 pixels and more, touching ones, uneven light, noise.
#![allow(dead_code, reason = "each program uses a part")]
#![allow(clippy::unwrap_used, reason = "helpers of tests fail as tests do")]

use std::f64::consts::TAU;
use wmr::geometry::{Arena, Point};
use wmr::scene::Obstacle;
use wmr::shape::{Circle, Polygon, Shape};
use wmr::vision::{DetectOptions, Photo, detect};

pub(crate) const ARENA: Arena = Arena { width: 1.2, height: 0.9 };
/// Pixels per metre.
pub(crate) const SCALE: f64 = 400.0;
/// The frame around the floor, pixels.
const FRAME: usize = 20;
/// Each pixel is the mean of so many places a side.
const PLACES: usize = 4;
/// Shapes keep this far from the border, metres.
const INSIDE: f64 = 0.06;
/// The least width of a wall, pixels.
const THINNEST: f64 = 1.5;

/// What was drawn: shapes on a floor.
pub(crate) struct Drawing {
    pub(crate) shapes: Vec<Shape>,
    photo: Photo,
}

/// How well what was found holds what was drawn.
#[derive(Debug)]
pub(crate) struct Outcome {
    /// How far a drawn point lies outside of all shapes with their margins, pixels.
    pub(crate) out: f64,
    /// Found shapes of which less than a fifth was drawn.
    pub(crate) invented: usize,
    /// The area that was both found, without margins, and drawn over what was either.
    pub(crate) agreement: f64,
}

fn polygon(corners: &[(f64, f64)]) -> Option<Shape> {
    let inside = |&(x, y): &(f64, f64)| {
        (INSIDE..ARENA.width - INSIDE).contains(&x) && (INSIDE..ARENA.height - INSIDE).contains(&y)
    };
    let is_inside = corners.iter().all(inside);
    let corners = corners.iter().map(|&(x, y)| Point::new(x, y)).collect();
    is_inside.then(|| Polygon::new(corners).ok().map(Shape::Polygon)).flatten()
}

/// A rectangle of half sides `a` and `b` turned by `angle` about a point.
fn turned(centre: (f64, f64), angle: f64, a: f64, b: f64) -> Option<Shape> {
    let (sin, cos) = angle.sin_cos();
    let corner = |(u, v): (f64, f64)| (centre.0 + u * cos - v * sin, centre.1 + u * sin + v * cos);
    polygon(&[(-a, -b), (a, -b), (a, b), (-a, b)].map(corner))
}

/// One or two shapes that touch; none if they would leave the floor.
fn shapes(random: &mut fastrand::Rng) -> Vec<Shape> {
    let mut between = |low: f64, high: f64| low + (high - low) * random.f64();
    let centre = (between(0.1, 1.1), between(0.1, 0.8));
    let angle = between(0.0, TAU);
    let (a, b) = (between(0.03, 0.12), between(0.02, 0.08));
    let (length, width) = (between(0.08, 0.3), between(THINNEST, 8.0) / SCALE);
    let radii: Vec<f64> = (0..7).map(|_| between(0.04, 0.13)).collect();
    let corners = 3 + between(0.0, 5.0) as usize;
    let star = |(index, radius): (usize, &f64)| {
        let turn = angle + TAU * index as f64 / corners as f64;
        (centre.0 + radius * turn.cos(), centre.1 + radius * turn.sin())
    };
    let beside = (centre.0 + (a + b) * angle.cos(), centre.1 + (a + b) * angle.sin());
    let kind = between(0.0, 7.0) as usize;
    let disc =
        Shape::Circle(Circle { centre: Point::new(centre.0, centre.1), radius: a.min(0.09) });
    let found: Vec<Option<Shape>> = match kind {
        0 => vec![turned(centre, angle, a, b)],
        1 => vec![turned(centre, 0.0, a, b)],
        2 => vec![Some(disc)],
        3 => vec![polygon(&radii.iter().take(corners).enumerate().map(star).collect::<Vec<_>>())],
        4 => vec![turned(centre, angle, length, width / 2.0)],
        5 => vec![turned(centre, TAU / 4.0 * (kind % 2) as f64, length, width / 2.0)],
        _ => vec![turned(centre, angle, a, b), turned(beside, angle, b, b)],
    };
    let found: Option<Vec<Shape>> = found.into_iter().collect();
    found.unwrap_or_default()
}

impl Drawing {
    /// The arena of a seed; every fifth is empty.
    pub(crate) fn random(seed: u64) -> Self {
        let mut random = fastrand::Rng::with_seed(seed);
        let mut drawn: Vec<Shape> = Vec::new();
        for _ in 0..if seed.is_multiple_of(5) { 0 } else { random.usize(1..7) } {
            let new = shapes(&mut random);
            let apart = |a: &Shape, b: &Shape| a.outline().iter().all(|&at| b.distance(at) > 0.03);
            if new.iter().all(|a| drawn.iter().all(|b| apart(a, b) && apart(b, a))) {
                drawn.extend(new);
            }
        }
        let photo = photo(&drawn, &mut random);
        Self { shapes: drawn, photo }
    }

    /// Detects and compares.
    pub(crate) fn outcome(&self) -> Outcome {
        self.compared(&self.found())
    }

    /// The obstacles that are reported, the corners being given.
    pub(crate) fn found(&self) -> Vec<Obstacle> {
        let (left, top) = (FRAME as f64 - 0.5, FRAME as f64 - 0.5);
        let (right, low) = (left + ARENA.width * SCALE, top + ARENA.height * SCALE);
        let corners = Some([[left, low], [right, low], [right, top], [left, top]]);
        let options = DetectOptions { corners, ..DetectOptions::default() };
        detect(&self.photo, ARENA, &options).unwrap().obstacles
    }

    fn compared(&self, found: &[Obstacle]) -> Outcome {
        let (columns, rows) = ((ARENA.width * SCALE) as usize, (ARENA.height * SCALE) as usize);
        let (mut out, mut both, mut any) = (0.0_f64, 0.0_f64, 0.0_f64);
        let mut of_shape = vec![(0_usize, 0_usize); found.len()];
        for index in 0..columns * rows {
            let (x, y) = ((index % columns) as f64 + 0.5, (index / columns) as f64 + 0.5);
            let point = Point::new(x / SCALE, ARENA.height - y / SCALE);
            let is_drawn = self.shapes.iter().any(|shape| shape.contains(point));
            let mut is_found = false;
            for (obstacle, (true_cells, cells)) in found.iter().zip(&mut of_shape) {
                if obstacle.footprint.contains(point) {
                    is_found = true;
                    *cells += 1;
                    *true_cells += usize::from(is_drawn);
                }
            }
            both += f64::from(u8::from(is_drawn && is_found));
            any += f64::from(u8::from(is_drawn || is_found));
            if is_drawn {
                let distance = found.iter().map(|seen| seen.distance(point)).fold(9.0, f64::min);
                out = out.max(distance * SCALE);
            }
        }
        let invented = of_shape.iter().filter(|(is_true, all)| 5 * is_true < *all).count();
        Outcome { out, invented, agreement: if any > 0.0 { both / any } else { 1.0 } }
    }
}

/// A floor with a frame, shapes of one reflectance each, light that falls off to one side and to the corners,
/// and noise of up to two codes.
fn photo(shapes: &[Shape], random: &mut fastrand::Rng) -> Photo {
    let is_light = random.bool();
    let (floor, frame) = if is_light { (0.75, 0.03) } else { (0.12, 0.7) };
    let reflectances: Vec<f64> = shapes
        .iter()
        .map(|_| if is_light { 0.03 + 0.25 * random.f64() } else { 0.4 + 0.4 * random.f64() })
        .collect();
    let (fall, turn, corner) = (0.25 * random.f64(), TAU * random.f64(), 0.2 * random.f64());
    let noise = 2.0 * random.f64();
    let width = (ARENA.width * SCALE) as usize + 2 * FRAME;
    let height = (ARENA.height * SCALE) as usize + 2 * FRAME;
    let reflectance = |x: f64, y: f64| {
        let point =
            Point::new((x - FRAME as f64) / SCALE, ARENA.height - (y - FRAME as f64) / SCALE);
        let Point { x, y } = point;
        if x < 0.0 || y < 0.0 || x > ARENA.width || y > ARENA.height {
            return frame;
        }
        let on = shapes.iter().position(|shape| shape.contains(point));
        on.map_or(floor, |index| reflectances[index])
    };
    let pixels = (0..width * height).map(|index| {
        let (column, row) = (index % width, index / width);
        let place = |k: usize| (k as f64 + 0.5) / PLACES as f64;
        let mean = (0..PLACES * PLACES)
            .map(|k| reflectance(column as f64 + place(k % PLACES), row as f64 + place(k / PLACES)))
            .sum::<f64>()
            / (PLACES * PLACES) as f64;
        let (x, y) = (column as f64 / width as f64 - 0.5, row as f64 / height as f64 - 0.5);
        let light = 1.0 - fall * (x * turn.cos() + y * turn.sin() + 0.5) - corner * (x * x + y * y);
        let code = 255.0 * (mean * light).powf(1.0 / 2.2) + noise * (2.0 * random.f64() - 1.0);
        [code.round().clamp(0.0, 255.0) as u8; 3]
    });
    Photo::from_rgb(width, height, pixels.collect()).unwrap()
}
