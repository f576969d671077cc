//! Which part of a picture a body and its shadow can reach. Pixels.

use super::lens::Lens;
use super::light::Lamp;
use super::solid::Body;
use std::ops::Range;

/// A lens bends straight edges, so that each is looked at in so many places. Between them it bends them by the
/// square of this less than as a whole: a bend of 50 pixels to less than one.
const PARTS: usize = 8;
/// What it bends them between those places, pixels.
const BEND: f64 = 1.0;

/// A rectangle of pixels.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct Region {
    pub(super) columns: Range<usize>,
    pub(super) rows: Range<usize>,
}

impl Region {
    pub(super) fn whole([width, height]: [usize; 2]) -> Self {
        Self { columns: 0..width, rows: 0..height }
    }

    pub(super) fn width(&self) -> usize {
        self.columns.len()
    }

    /// The same with so many pixels more on each side, as far as the picture has them.
    pub(super) fn grown(&self, by: usize, [width, height]: [usize; 2]) -> Self {
        let grown = |range: &Range<usize>, end: usize| {
            range.start.saturating_sub(by)..(range.end + by).min(end)
        };
        Self { columns: grown(&self.columns, width), rows: grown(&self.rows, height) }
    }

    fn overlaps(&self, other: &Self) -> bool {
        let overlap = |a: &Range<usize>, b: &Range<usize>| a.start < b.end && b.start < a.end;
        overlap(&self.columns, &other.columns) && overlap(&self.rows, &other.rows)
    }

    fn joined(&self, other: &Self) -> Self {
        let joined = |a: &Range<usize>, b: &Range<usize>| a.start.min(b.start)..a.end.max(b.end);
        Self {
            columns: joined(&self.columns, &other.columns),
            rows: joined(&self.rows, &other.rows),
        }
    }
}

/// The regions of bodies and their shadows, each grown by `margin`; those that overlap are one.
pub(super) fn regions_of<'a>(
    bodies: impl Iterator<Item = &'a Body>,
    lens: &Lens,
    lamp: &Lamp,
    margin: usize,
) -> Vec<Region> {
    let mut regions: Vec<Region> = Vec::new();
    for body in bodies {
        let Some(mut region) = region_of(body, lens, lamp, margin) else { continue };
        while let Some(other) = regions.iter().position(|other| other.overlaps(&region)) {
            region = region.joined(&regions.swap_remove(other));
        }
        regions.push(region);
    }
    regions
}

/// The corners of an outline, and points between them.
fn in_parts(corners: &[[f64; 2]]) -> impl Iterator<Item = [f64; 2]> {
    let edges = corners.iter().zip(corners.iter().cycle().skip(1));
    edges.flat_map(|(a, b)| {
        (0..PARTS)
            .map(|part| part as f64 / PARTS as f64)
            .map(|share| [0, 1].map(|axis| a[axis] + share * (b[axis] - a[axis])))
    })
}

/// Where a body and its shadow are in the picture; `None` if they are beside it.
fn region_of(body: &Body, lens: &Lens, lamp: &Lamp, margin: usize) -> Option<Region> {
    let [width, height] = lens.image_size;
    let mut low = [f64::INFINITY; 2];
    let mut high = [f64::NEG_INFINITY; 2];
    let mut is_whole = false;
    for [x, y] in in_parts(&body.hull()) {
        let shadow = lamp.shadow_of([x, y, body.height]);
        is_whole |= shadow.is_none();
        let shadow = shadow.unwrap_or_default().map(|[x, y]| [x, y, 0.0]);
        for point in shadow.into_iter().chain([[x, y, 0.0], [x, y, body.height]]) {
            let Some(pixel) = lens.project(point) else {
                is_whole = true;
                continue;
            };
            for axis in 0..2 {
                low[axis] = low[axis].min(pixel[axis]);
                high[axis] = high[axis].max(pixel[axis]);
            }
        }
    }
    if is_whole {
        return Some(Region::whole(lens.image_size));
    }
    let margin = BEND + margin as f64;
    let range = |axis: usize, end: usize| {
        let first = (low[axis] - margin).floor().max(0.0) as usize;
        let last = (high[axis] + margin).ceil().max(-1.0) + 1.0;
        first.min(end)..(last as usize).min(end)
    };
    let region = Region { columns: range(0, width), rows: range(1, height) };
    (!region.columns.is_empty() && !region.rows.is_empty()).then_some(region)
}
