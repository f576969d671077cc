//! A box brought to a fraction of a pixel by all its edges in both pictures at once.
//!
//! | symbol | meaning | unit |
//! |---|---|---|
//! | e | coordinate of an edge of the footprint | m |
//! | h, H | height of the box, of the camera | m |
//! | f | the camera's foot point, same coordinate | m |
//! | k | H / (H − h) | – |
//! | m | where the picture shows the edge on the floor | m |
//!
//! An edge of the top is seen at m = f + k (e − f), the foot of a side that faces the camera at m = e.
//! Gauss and Newton's rule finds the four edges and the height that fit all that is seen; what fits
//! badly counts less (Tukey's biweight). The search's result is a weak prior, so that an edge that is
//! seen nowhere stays where it is. The normal matrix says how far each edge may be off.

use super::gain::{LEAST_HEIGHT, MOST_HEIGHT};
use super::pair::Sight;
use super::raised::{RaisedBox, lean};
use crate::geometry::{Arena, Point, Rect, Side};
use crate::vision::boxes::{LeaningBox, at};
use crate::vision::camera::PlanMap;
use crate::vision::image::{Photo, step};
use crate::vision::least_squares::{NormalEquations, tukey};
use nalgebra::SVector;

/// Profiles along each edge, and the share of it that they stay away from its ends.
const PLACES: usize = 48;
const END_SHARE: f64 = 0.07;
/// The least number of places where an edge must be seen.
const LEAST_PLACES: usize = 6;
/// The distance of samples, and how far an edge may be moved in each round, pixels.
const SAMPLE_STEP: f64 = 0.25;
const REACHES: [f64; 4] = [4.0, 3.0, 2.0, 2.0];
/// Light that changes by less across an edge, linear, shows none.
const LEAST_CHANGE: f32 = 0.006;
/// One standard deviation of a measured edge, pixels; residuals beyond so many of them do not count.
const EDGE_PIXELS: f64 = 0.4;
const OUTLIER: f64 = 6.0;
/// The search's own standard deviations: edges in pixels, the height in metres.
const PRIOR_PIXELS: f64 = 2.5;
const PRIOR_HEIGHT: f64 = 0.03;
/// Margins are so many standard deviations, and this much for the cameras' own error, metres.
const MARGIN_DEVIATIONS: f64 = 2.5;
const CAMERA_ERROR: f64 = 0.002;
/// Edges this close to the arena's side, pixels or metres, lie on it.
const WALL_PIXELS: f64 = 2.0;
const WALL_METRES: f64 = 0.025;

/// The unknowns: the left, lower, right and upper edge, and the height.
type Unknowns = SVector<f64, 5>;

/// A box with how much further out each edge (left, lower, right, upper) may lie, metres.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Refined {
    pub(crate) raised: RaisedBox,
    pub(crate) margin: [f64; 4],
}

/// Moves the edges of a box to where both pictures show them; `all` are the boxes that may hide them.
pub(crate) fn refine(
    sights: &[Sight; 2],
    arena: Arena,
    all: &[RaisedBox],
    start: RaisedBox,
) -> Refined {
    let others: Vec<RaisedBox> = all.iter().copied().filter(|other| *other != start).collect();
    let middle =
        Point::new((start.base.x0 + start.base.x1) / 2.0, (start.base.y0 + start.base.y1) / 2.0);
    let finest = sights.iter().map(|sight| sight.map.scale_at(middle)).fold(1.0, f64::max);
    let pixel = 1.0 / finest;
    let prior = unknowns(start);
    let mut raised = start;
    let mut deviations = [PRIOR_PIXELS * pixel; 4];
    for reach in REACHES {
        let seen = observations(sights, &others, raised, reach);
        let Some((solved, spread)) = fit(sights, &seen, raised, prior, pixel) else { break };
        (raised, deviations) = (solved, spread);
    }
    let margin = deviations.map(|deviation| CAMERA_ERROR + MARGIN_DEVIATIONS * deviation);
    on_walls(Refined { raised, margin }, arena, WALL_METRES.max(WALL_PIXELS * pixel))
}

/// Where a picture shows an edge.
#[derive(Clone, Copy)]
struct Observation {
    eye: usize,
    side: Side,
    /// Whether it is an edge of the top; else it is the foot of a side.
    top: bool,
    /// Its coordinate on the floor, metres.
    place: f64,
    /// The size of a pixel there, metres.
    pixel: f64,
}

fn observations(
    sights: &[Sight; 2],
    others: &[RaisedBox],
    raised: RaisedBox,
    reach: f64,
) -> Vec<Observation> {
    let mut found = Vec::new();
    for (eye, sight) in sights.iter().enumerate() {
        let foot = sight.view.foot;
        let seen = raised.seen(sight.view);
        let hidden: Vec<LeaningBox> = others.iter().map(|other| other.seen(sight.view)).collect();
        let edges = [true, false].into_iter().flat_map(|top| Side::EDGES.map(|side| (side, top)));
        for (side, top) in edges {
            if !top && !seen.faces(side, foot) {
                continue;
            }
            let rect = if top { seen.top(foot) } else { seen.base };
            let pixel = 1.0 / sight.map.scale_at(at(rect, side, 0.5, 0.0)).max(1e-6);
            let view = EdgeView { photo: sight.photo, map: &sight.map, rect, side, pixel, reach };
            let free = |point: Point| hidden.iter().all(|other| other.face(point, foot).is_none());
            if let Some(place) = view.place(free) {
                found.push(Observation { eye, side, top, place, pixel });
            }
        }
    }
    found
}

fn unknowns(raised: RaisedBox) -> Unknowns {
    let [x0, y0, x1, y1] = raised.base.into();
    Unknowns::from([x0, y0, x1, y1, raised.height])
}

/// The box that fits the observations, and one standard deviation of each of its edges.
fn fit(
    sights: &[Sight; 2],
    seen: &[Observation],
    start: RaisedBox,
    prior: Unknowns,
    pixel: f64,
) -> Option<(RaisedBox, [f64; 4])> {
    let mut state = unknowns(start);
    let mut covariance = None;
    for _ in 0..6 {
        let mut sums = NormalEquations::<5>::new(0.0);
        for unknown in 0..5 {
            let deviation = if unknown < 4 { PRIOR_PIXELS * pixel } else { PRIOR_HEIGHT };
            sums.add_prior(unknown, prior[unknown] - state[unknown], deviation.powi(-2));
        }
        for observation in seen {
            let (predicted, row) = predicted(sights, observation, &state);
            let deviation = EDGE_PIXELS * observation.pixel;
            let error = observation.place - predicted;
            let weight = tukey(error / deviation / OUTLIER) / (deviation * deviation);
            sums.add(row, error, weight);
        }
        state += sums.solve()?;
        covariance = sums.covariance();
        state[4] = state[4].clamp(LEAST_HEIGHT, MOST_HEIGHT);
    }
    let spread = covariance?;
    let base = Rect::new(state[0], state[1], state[2], state[3]);
    let upright = base.x0 < base.x1 && base.y0 < base.y1;
    upright.then(|| {
        (RaisedBox { base, height: state[4] }, [0, 1, 2, 3].map(|side| spread[(side, side)].sqrt()))
    })
}

/// Where an edge should be seen, and how that changes with the unknowns.
fn predicted(sights: &[Sight; 2], seen: &Observation, state: &Unknowns) -> (f64, Unknowns) {
    let view = sights[seen.eye].view;
    let (edge, height) = (state[seen.side.edge()], state[4]);
    let mut row = Unknowns::zeros();
    if !seen.top {
        row[seen.side.edge()] = 1.0;
        return (edge, row);
    }
    let foot = if seen.side.is_upright() { view.foot.x } else { view.foot.y };
    let k = lean(view, height);
    row[seen.side.edge()] = k;
    // dk/dh = H / (H − h)² = k² / H.
    row[4] = k * k / view.height * (edge - foot);
    (foot + k * (edge - foot), row)
}

/// Edges at or beyond a side of the arena lie on it.
fn on_walls(mut refined: Refined, arena: Arena, reach: f64) -> Refined {
    let mut edges: [f64; 4] = refined.raised.base.into();
    for (side, wall) in Side::EDGES.into_iter().zip([0.0, 0.0, arena.width, arena.height]) {
        let beyond = (edges[side.edge()] - wall) * side.outward() > 0.0;
        if beyond || (edges[side.edge()] - wall).abs() < reach {
            edges[side.edge()] = wall;
            refined.margin[side.edge()] = CAMERA_ERROR;
        }
    }
    refined.raised.base = edges.into();
    refined
}

/// One edge of a rectangle on the floor's plane and how a picture shows it.
struct EdgeView<'a> {
    photo: &'a Photo,
    map: &'a PlanMap,
    rect: Rect,
    side: Side,
    /// The size of a pixel, metres.
    pixel: f64,
    /// How far the edge may be moved, pixels.
    reach: f64,
}

impl EdgeView<'_> {
    /// The edge's coordinate, metres, by the places where both of its sides are `free`.
    fn place(&self, free: impl Fn(Point) -> bool) -> Option<f64> {
        let mean = self.mean_profile(free)?;
        let change = [0, 1, 2].map(|channel| mean[mean.len() - 1][channel] - mean[0][channel]);
        if change.iter().all(|value| value.abs() < LEAST_CHANGE) {
            return None;
        }
        let edge = at(self.rect, self.side, 0.5, self.outward(step(&mean, Some(change))?));
        Some(if self.side.is_upright() { edge.x } else { edge.y })
    }

    /// The light across the edge from inside to outside, averaged along it.
    fn mean_profile(&self, free: impl Fn(Point) -> bool) -> Option<Vec<[f32; 3]>> {
        let count = (2.0 * (self.reach + 1.0) / SAMPLE_STEP) as usize + 1;
        let mut sums = vec![[0f32; 3]; count];
        let mut places = 0u16;
        for place in 0..PLACES {
            let along = END_SHARE + (1.0 - 2.0 * END_SHARE) * (place as f64 + 0.5) / PLACES as f64;
            let ends = [-1.0, 1.0].map(|sign| self.point(along, sign * self.reach * self.pixel));
            if !ends.iter().all(|&end| free(end) && self.photo.holds(self.map.to_photo(end))) {
                continue;
            }
            places += 1;
            for (index, sum) in sums.iter_mut().enumerate() {
                let pixel = self.map.to_photo(self.point(along, self.outward(index as f64)));
                sum.iter_mut().zip(self.photo.light(pixel)).for_each(|(sum, light)| *sum += light);
            }
        }
        let mean = |sum: [f32; 3]| sum.map(|value| value / f32::from(places));
        (usize::from(places) >= LEAST_PLACES).then(|| sums.into_iter().map(mean).collect())
    }

    fn point(&self, along: f64, outward: f64) -> Point {
        at(self.rect, self.side, along, outward)
    }

    /// How far outward a sample lies, metres.
    fn outward(&self, index: f64) -> f64 {
        (index * SAMPLE_STEP - self.reach - 1.0) * self.pixel
    }
}
