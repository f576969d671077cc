//! The straight line along a side on which the most places show the border.
//!
//! A fit by least squares follows the strongest step near where it starts. Where a wall has a gap, or another edge runs
//! at a small angle to it, that fit can end between the two, with few of its places on either. Here all steps like the
//! border's count, and every straight line near the side is tried (Hough, over its two ends).

use crate::geometry::{Arena, Side};
use crate::vision::camera::PlanMap;
use crate::vision::camera::border_fit::{FITTING_SHARE, PLACES, Profiles, along};
use crate::vision::image::{Photo, steps_like};

/// How far from the map's side a line's ends are tried, a share of the photo's longer side.
const REACH_SHARE: f64 = 0.02;
/// A step on a line lies this close to it, pixels, at least.
const LEAST_CLOSE: f64 = 1.0;

/// So many lines at most are of interest, each so many times that distance from the better ones.
const MOST_LINES: usize = 6;
const APART: f64 = 3.0;

/// A straight line near a side.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Line {
    /// The share of the side's places that show the border on it.
    pub(super) share: f64,
    /// How far it is inward of the map's side at that side's start and end, metres.
    pub(super) inward: [f64; 2],
}

impl Line {
    /// A line with the share of places that have a step on it.
    fn with_share([start, end]: [f64; 2], seen: &[(f64, Vec<f64>)], close: f64) -> Self {
        let on = |(along, steps): &&(f64, Vec<f64>)| {
            let inward = start + along * (end - start);
            steps.iter().any(|step| (step - inward).abs() < close)
        };
        let share = seen.iter().filter(on).count() as f64 / seen.len() as f64;
        Self { share, inward: [start, end] }
    }

    /// How far another line is away at the end where it is farther, metres.
    fn distance(&self, other: &Self) -> f64 {
        let [start, end] = [0, 1].map(|end| (self.inward[end] - other.inward[end]).abs());
        start.max(end)
    }
}

/// The straight lines near a side of a map on which the most places show a change of light like `change`, the best first.
pub(super) fn lines(
    photo: &Photo,
    map: &PlanMap,
    arena: Arena,
    side: Side,
    change: [f32; 3],
) -> Vec<Line> {
    let reach = REACH_SHARE * photo.longer_side();
    let profiles = Profiles::across(photo, map, arena, side, reach);
    let mut lights = Vec::new();
    let mut seen = Vec::with_capacity(PLACES);
    for place in 0..PLACES {
        profiles.at(place, &mut lights);
        let steps = steps_like(&lights, change).map(|index| profiles.inward(index));
        seen.push((along(place), steps.collect::<Vec<_>>()));
    }
    let close_px = (FITTING_SHARE * photo.longer_side()).max(LEAST_CLOSE);
    let close = close_px * (profiles.inward(0.0) - profiles.inward(1.0)) / Profiles::STEP;
    let tried = (reach / close_px) as i32;
    let ends = || (-tried..=tried).map(|step| f64::from(step) * close);
    let all = ends().flat_map(|start| ends().map(move |end| [start, end]));
    let mut lines: Vec<Line> = all.map(|ends| Line::with_share(ends, &seen, close)).collect();
    lines.sort_by(|a, b| b.share.total_cmp(&a.share));
    let mut apart: Vec<Line> = Vec::new();
    for line in lines {
        if apart.len() == MOST_LINES {
            break;
        }
        if apart.iter().all(|better| better.distance(&line) > APART * close) {
            apart.push(line);
        }
    }
    apart
}
