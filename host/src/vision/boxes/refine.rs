//! Rectangles brought to a fraction of a pixel: every edge is moved to the step of linear light.
//!
//! Along an edge, profiles across it are averaged where the edge is seen against the floor; the step
//! of the mean is the edge. An edge that cannot be seen keeps its place and gets a wider margin.

use super::projection::LeaningBox;
use crate::geometry::{Arena, Point, Rect, Side};
use crate::scene::Obstacle;
use crate::vision::appearance::{FOREIGN, Look};
use crate::vision::camera::PlanMap;
use crate::vision::image::{Photo, step};

/// Profiles along each edge.
pub(super) const PLACES: usize = 48;
/// Places stay this share of the edge away from its ends.
const END_SHARE: f64 = 0.06;
/// How far an edge may be moved at least, pixels, and cells of the view that it was found in.
const REACH: f64 = 3.0;
const REACH_CELLS: f64 = 1.0;
/// The distance of samples, pixels.
const SAMPLE_STEP: f64 = 0.25;
/// The least number of places where an edge must be seen.
const LEAST_PLACES: usize = 5;
/// Edges this close to the arena's side, pixels or metres, lie on it: a gap as narrow leads nowhere.
const WALL_PIXELS: f64 = 2.0;
const WALL_METRES: f64 = 0.01;
/// A seen edge is good to this many pixels, and this many metres for the map's own error.
const SEEN_PIXELS: f64 = 0.5;
const SEEN_METRES: f64 = 0.001;
/// How much lower than measured a lean may be: at least so much, or a share of what it exceeds 1 by where
/// sides show it and where only the shadow does.
const LEAN_MARGIN: f64 = 0.01;
const SHOWN_DOUBT: f64 = 0.2;
const SHADED_DOUBT: f64 = 0.8;
/// An edge that is not seen, pixels.
const UNSEEN_PIXELS: f64 = 3.0;

/// A rectangle with how much further out each edge (left, lower, right, upper) may lie, metres.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Bounded {
    pub(crate) rect: Rect,
    pub(crate) margin: [f64; 4],
}

impl Bounded {
    pub(crate) fn obstacle(&self) -> Obstacle {
        Obstacle { margin: self.margin, ..self.rect.into() }
    }
}

/// The tools that every edge of one picture needs.
#[derive(Clone, Copy)]
pub(crate) struct Sharpener<'a> {
    pub(crate) photo: &'a Photo,
    pub(crate) map: &'a PlanMap,
    pub(crate) look: &'a Look,
    /// The camera's foot point; `None` if boxes do not lean.
    pub(crate) foot: Option<Point>,
    /// How far that may be off, metres.
    pub(crate) foot_error: f64,
    /// Cells per metre of the view that boxes were found in.
    pub(crate) coarse: f64,
    /// Whether the lamp is known, so that shadows tell the lean of boxes.
    pub(crate) lit: bool,
}

impl Sharpener<'_> {
    /// Moves each edge of a box to where the photo shows it.
    ///
    /// Sides that face the camera are seen at their foot, the others at the top, from where the lean
    /// leads to the foot; the lean is measured at the top edges of the sides that are seen. The box is returned
    /// with the lean that was taken.
    pub(crate) fn sharpen(&self, seen: LeaningBox) -> (LeaningBox, Bounded) {
        let arena = self.look.frame.arena;
        let foot = self.foot.unwrap_or(Point::new(0.0, 0.0));
        let mut seen = if self.foot.is_some() { seen } else { LeaningBox { lean: 1.0, ..seen } };
        let mut margin = [0.0; 4];
        let mut doubt = 0.0;
        for _ in 0..2 {
            let mut edges: [f64; 4] = seen.base.into();
            if self.foot.is_some() {
                self.near_edges(seen, foot, &mut edges, &mut margin);
                let near = LeaningBox { base: edges.into(), ..seen };
                // A lean that is not seen is taken as none: the outline always covers the box.
                let shown = self.lean(near, foot);
                let lean = shown.unwrap_or(if self.lit { seen.lean } else { 1.0 });
                let share = if shown.is_some() { SHOWN_DOUBT } else { SHADED_DOUBT };
                doubt = LEAN_MARGIN.max(share * (lean - 1.0)).min(lean - 1.0);
                seen = LeaningBox { lean, base: far_kept(seen, foot, edges, lean) };
                edges = seen.base.into();
            }
            self.far_edges(seen, foot, doubt, &mut edges, &mut margin);
            for margin in &mut margin {
                *margin += self.foot_error * (seen.lean - 1.0);
            }
            for side in Side::EDGES {
                let scale = self.scale(edges.into(), side);
                if let Some(wall) =
                    wall(arena, side, edges[side.edge()], WALL_METRES.max(WALL_PIXELS / scale))
                {
                    edges[side.edge()] = wall;
                    margin[side.edge()] = SEEN_METRES;
                }
            }
            seen.base = edges.into();
        }
        (seen, Bounded { rect: seen.base, margin })
    }

    pub(super) fn scale(&self, rect: Rect, side: Side) -> f64 {
        self.map.scale_at(middle(rect, side)).max(1e-6)
    }

    /// How far an edge is searched for from where it was found, pixels: where the photo is finer than the plan view
    /// as far as a cell of that, but less than a third across the rectangle.
    fn reach(&self, rect: Rect, side: Side) -> f64 {
        let scale = self.scale(rect, side);
        let across = if side.is_upright() { rect.x1 - rect.x0 } else { rect.y1 - rect.y0 };
        (REACH_CELLS * scale / self.coarse).min(across * scale / 3.0).max(REACH)
    }

    /// Measures the feet of the sides that face the camera.
    fn near_edges(
        &self,
        seen: LeaningBox,
        foot: Point,
        edges: &mut [f64; 4],
        margin: &mut [f64; 4],
    ) {
        for side in Side::EDGES.into_iter().filter(|&side| seen.faces(side, foot)) {
            let view = EdgeView {
                tools: *self,
                rect: (*edges).into(),
                side,
                scale: self.scale(seen.base, side),
                reach: self.reach(seen.base, side),
            };
            let place = view.place();
            margin[side.edge()] = edge_margin(place.is_some(), view.scale);
            edges[side.edge()] = place.unwrap_or(edges[side.edge()]);
        }
    }

    /// Measures the top edges of the other sides and takes them down to the floor.
    fn far_edges(
        &self,
        seen: LeaningBox,
        foot: Point,
        doubt: f64,
        edges: &mut [f64; 4],
        margin: &mut [f64; 4],
    ) {
        let leans = self.foot.is_some();
        let top = seen.top(foot);
        for side in Side::EDGES.into_iter().filter(|&side| !leans || !seen.faces(side, foot)) {
            let view = EdgeView {
                tools: *self,
                rect: top,
                side,
                scale: self.scale(seen.base, side),
                reach: self.reach(top, side),
            };
            let place = view.place();
            margin[side.edge()] = edge_margin(place.is_some(), view.scale);
            let origin = if side.is_upright() { foot.x } else { foot.y };
            if let Some(edge) = place {
                edges[side.edge()] =
                    if leans { origin + (edge - origin) / seen.lean } else { edge };
            }
            if leans {
                let lowest = seen.lean - doubt;
                margin[side.edge()] +=
                    (edges[side.edge()] - origin).abs() * (seen.lean / lowest - 1.0);
            }
        }
    }
}

/// The base whose far edges keep the top where it was when the lean changes.
fn far_kept(seen: LeaningBox, foot: Point, edges: [f64; 4], lean: f64) -> Rect {
    let mut kept = edges;
    for side in Side::EDGES.into_iter().filter(|&side| !seen.faces(side, foot)) {
        let origin = if side.is_upright() { foot.x } else { foot.y };
        kept[side.edge()] = origin + (edges[side.edge()] - origin) * seen.lean / lean;
    }
    kept.into()
}

fn edge_margin(seen: bool, scale: f64) -> f64 {
    SEEN_METRES + if seen { SEEN_PIXELS } else { UNSEEN_PIXELS } / scale
}

/// The arena's side that an edge lies on, if it does.
fn wall(arena: Arena, side: Side, edge: f64, reach: f64) -> Option<f64> {
    let wall = [0.0, 0.0, arena.width, arena.height][side.edge()];
    let outside = (edge - wall) * side.outward() > 0.0;
    (outside || (edge - wall).abs() < reach).then_some(wall)
}

fn middle(rect: Rect, side: Side) -> Point {
    at(rect, side, 0.5, 0.0)
}

/// The point at a share of an edge, moved `outward`, metres.
pub(crate) fn at(rect: Rect, side: Side, along: f64, outward: f64) -> Point {
    let (x, y) = (rect.x0 + along * (rect.x1 - rect.x0), rect.y0 + along * (rect.y1 - rect.y0));
    match side {
        Side::Left => Point::new(rect.x0 - outward, y),
        Side::Lower => Point::new(x, rect.y0 - outward),
        Side::Right => Point::new(rect.x1 + outward, y),
        Side::Upper => Point::new(x, rect.y1 + outward),
    }
}

/// One edge and how it is seen.
struct EdgeView<'a> {
    tools: Sharpener<'a>,
    rect: Rect,
    side: Side,
    scale: f64,
    /// How far the edge may be moved, pixels.
    reach: f64,
}

impl EdgeView<'_> {
    /// The edge's coordinate against the floor, metres.
    fn place(&self) -> Option<f64> {
        let mean = self.mean_profile(|along| self.borders_floor(along))?;
        let change = [0, 1, 2].map(|channel| mean[mean.len() - 1][channel] - mean[0][channel]);
        Some(self.coordinate(step(&mean, Some(change))?))
    }

    /// The light across the edge from inside to outside, averaged over the places where it is `usable`.
    fn mean_profile(&self, usable: impl Fn(f64) -> bool) -> Option<Vec<[f32; 3]>> {
        let count = (2.0 * (self.reach + 1.0) / SAMPLE_STEP) as usize + 1;
        let mut sums = vec![[0f32; 3]; count];
        let mut places = 0;
        for place in 0..PLACES {
            let along = END_SHARE + (1.0 - 2.0 * END_SHARE) * (place as f64 + 0.5) / PLACES as f64;
            if !usable(along) {
                continue;
            }
            places += 1;
            for (index, sum) in sums.iter_mut().enumerate() {
                let pixel = self.tools.map.to_photo(at(
                    self.rect,
                    self.side,
                    along,
                    self.outward(index as f64),
                ));
                sum.iter_mut()
                    .zip(self.tools.photo.light(pixel))
                    .for_each(|(sum, light)| *sum += light);
            }
        }
        let mean = |sum: [f32; 3]| sum.map(|value| value / places as f32);
        (places >= LEAST_PLACES).then(|| sums.into_iter().map(mean).collect())
    }

    fn outward(&self, index: f64) -> f64 {
        (index * SAMPLE_STEP - self.reach - 1.0) / self.scale
    }

    fn coordinate(&self, index: f64) -> f64 {
        let edge = at(self.rect, self.side, 0.5, self.outward(index));
        if self.side.is_upright() { edge.x } else { edge.y }
    }

    /// Whether floor lies outside the edge and something else inside.
    fn borders_floor(&self, along: f64) -> bool {
        let difference = |outward: f64| {
            let point = at(self.rect, self.side, along, outward / self.scale);
            self.tools.look.difference_at(point).map(|difference| difference.floor)
        };
        let outside = difference(self.reach).is_some_and(|value| value < FOREIGN);
        outside && difference(-self.reach).is_some_and(|value| value > FOREIGN)
    }
}
