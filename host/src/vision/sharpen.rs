//! Rectangles brought to a fraction of a pixel: every edge is moved to the step of linear light.
//!
//! Along an edge, profiles across it are averaged where the edge is seen against the floor; the step
//! of the mean is the edge. An edge that cannot be seen keeps its place and gets a wider margin.

use super::look::{FOREIGN, Look};
use super::photo::Photo;
use super::plan_map::PlanMap;
use super::profile::step;
use crate::geometry::{Arena, Point, Rect};

/// Profiles along each edge.
const PLACES: usize = 48;
/// Places stay this share of the edge away from its ends.
const END_SHARE: f64 = 0.06;
/// How far an edge may be moved, pixels.
const REACH: f64 = 3.0;
/// The distance of samples, pixels.
const SAMPLE_STEP: f64 = 0.25;
/// The least number of places where an edge must be seen.
const LEAST_PLACES: usize = 5;
/// Edges this close to the arena's side lie on it, pixels.
const WALL_PIXELS: f64 = 2.0;
/// A seen edge is good to this many pixels, and this many metres for the map's own error.
const SEEN_PIXELS: f64 = 0.5;
const SEEN_METRES: f64 = 0.001;
/// An edge that is not seen, pixels.
const UNSEEN_PIXELS: f64 = 3.0;

/// A rectangle with how much further out each edge (left, lower, right, upper) may lie, metres.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Bounded {
    pub(crate) rect: Rect,
    pub(crate) margin: [f64; 4],
}

/// Moves each edge of `rect` to where the photo shows it.
pub(crate) fn sharpen(photo: &Photo, map: &PlanMap, look: &Look, rect: Rect) -> Bounded {
    let arena = look.frame.arena;
    let mut edges = [rect.x0, rect.y0, rect.x1, rect.y1];
    let mut margin = [0.0; 4];
    for _ in 0..2 {
        for side in 0..4 {
            let now = Rect::from(edges);
            let scale = map.scale_at(middle(now, side)).max(1e-6);
            let seen = EdgeView { photo, map, look, rect: now, side, scale }.place();
            margin[side] =
                SEEN_METRES + if seen.is_some() { SEEN_PIXELS } else { UNSEEN_PIXELS } / scale;
            edges[side] = seen.unwrap_or(edges[side]);
            if let Some(wall) = wall(arena, side, edges[side], WALL_PIXELS / scale) {
                edges[side] = wall;
                margin[side] = SEEN_METRES;
            }
        }
    }
    Bounded { rect: edges.into(), margin }
}

/// The arena's side that an edge lies on, if it does.
fn wall(arena: Arena, side: usize, edge: f64, reach: f64) -> Option<f64> {
    let wall = [0.0, 0.0, arena.width, arena.height][side];
    let outside = if side < 2 { edge < wall } else { edge > wall };
    (outside || (edge - wall).abs() < reach).then_some(wall)
}

fn middle(rect: Rect, side: usize) -> Point {
    at(rect, side, 0.5, 0.0)
}

/// The point at a share of an edge, moved `outward`, metres.
fn at(rect: Rect, side: usize, along: f64, outward: f64) -> Point {
    let (x, y) = (rect.x0 + along * (rect.x1 - rect.x0), rect.y0 + along * (rect.y1 - rect.y0));
    match side {
        0 => Point::new(rect.x0 - outward, y),
        1 => Point::new(x, rect.y0 - outward),
        2 => Point::new(rect.x1 + outward, y),
        _ => Point::new(x, rect.y1 + outward),
    }
}

/// One edge and how it is seen.
struct EdgeView<'a> {
    photo: &'a Photo,
    map: &'a PlanMap,
    look: &'a Look,
    rect: Rect,
    side: usize,
    scale: f64,
}

impl EdgeView<'_> {
    /// The edge's coordinate, metres.
    fn place(&self) -> Option<f64> {
        let count = (2.0 * (REACH + 1.0) / SAMPLE_STEP) as usize + 1;
        let outward = |index: f64| (index * SAMPLE_STEP - REACH - 1.0) / self.scale;
        let mut sums = vec![[0f32; 3]; count];
        let mut places = 0;
        for place in 0..PLACES {
            let along = END_SHARE + (1.0 - 2.0 * END_SHARE) * (place as f64 + 0.5) / PLACES as f64;
            if !self.borders_floor(along) {
                continue;
            }
            places += 1;
            for (index, sum) in sums.iter_mut().enumerate() {
                let pixel =
                    self.map.to_photo(at(self.rect, self.side, along, outward(index as f64)));
                sum.iter_mut().zip(self.photo.light(pixel)).for_each(|(sum, light)| *sum += light);
            }
        }
        if places < LEAST_PLACES {
            return None;
        }
        let mean: Vec<[f32; 3]> =
            sums.iter().map(|sum| sum.map(|value| value / places as f32)).collect();
        let change = [0, 1, 2].map(|channel| mean[count - 1][channel] - mean[0][channel]);
        let index = step(&mean, Some(change))?;
        let edge = at(self.rect, self.side, 0.5, outward(index));
        Some(if self.side.is_multiple_of(2) { edge.x } else { edge.y })
    }

    /// Whether floor lies outside the edge and something else inside.
    fn borders_floor(&self, along: f64) -> bool {
        let difference = |outward: f64| {
            self.look
                .difference_at(at(self.rect, self.side, along, outward / self.scale))
                .map(|difference| difference.floor)
        };
        let outside = difference(REACH).is_some_and(|value| value < FOREIGN);
        outside && difference(-REACH).is_some_and(|value| value > FOREIGN)
    }
}
