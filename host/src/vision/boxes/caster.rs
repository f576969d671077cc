//! A box that looks like the floor and is told by the shadow that it casts.
//!
//! Under a known lamp a shadow that no box explains has one that is not seen: what the lamp sees of a box less what
//! the camera sees of it is the dark patch. The footprint and the height that agree with the patch best are searched
//! for from its bounds on, edge by edge. The patch stays an obstacle: it may be a thing as dark as shadow, and is
//! taken for nothing else if it fills its bounds as a thing does. Metres in the arena frame.
//!
//! Deviation: the paper knows no shadows; it leaves them to a second camera [Alghannam, Sec. VI].

use super::light::Lamp;
use super::projection::LeaningBox;
use super::refine::Bounded;
use super::uncovered::Explained;
use crate::geometry::{Point, Rect};
use crate::vision::appearance::{FOREIGN, Look};
use crate::vision::image::{Raster, around, marked, regions};

/// The least agreement: cells that are dark and should be, over those that are one or the other.
const LEAST_AGREEMENT: f64 = 0.75;
/// Leans that are tried first, and steps of edges (metres) and of the lean's excess (natural logarithm).
const LEANS: [f64; 5] = [1.03, 1.06, 1.10, 1.14, 1.19];
const STEPS: [f64; 4] = [0.04, 0.02, 0.01, 0.005];
const LEAN_SHARE: f64 = 8.0;
/// Four edges and the lean, each to either side; and rounds with each step at most.
const MOVES: usize = 10;
const ROUNDS: usize = 12;
/// How far its edges may be off: they are told by the ends of a blurred shadow.
const MARGIN: f64 = 0.025;
/// Thinner or lower things have no shadow that tells.
const LEAST_SIDE: f64 = 0.02;
const LEAST_LEAN: f64 = 1.01;
/// Cells this near to a box are blurred with it.
const BLUR: f64 = 2.0;

/// The least shadow that tells what casts it, square metres.
const LEAST_SHADE: f64 = 0.002;
/// The places around it that count: metres, and how many at most.
const REACH: f64 = 0.25;
const MOST_PLACES: f64 = 2500.0;

/// A place near a shadow: whether it is dark.
#[derive(Clone, Copy, Debug)]
struct Place {
    point: Point,
    is_dark: bool,
}

impl Explained<'_> {
    /// The boxes that look like floor and cast what else is as dark as shadow, under a known lamp.
    pub(super) fn unseen_casters(&self) -> Vec<Bounded> {
        let (Some(lamp), Some(camera)) = (self.lamp, self.foot) else { return Vec::new() };
        let shade = self.unexplained_shade();
        let least = LEAST_SHADE * self.look.view.scale.powi(2);
        let patches = regions(&shade).into_iter().filter(|patch| patch.len() as f64 > least);
        let caster = |patch: Vec<usize>| {
            let bounds = self.metres(around(&patch, shade.width()));
            let places = self.places(&marked(&patch, shade.width()), bounds);
            caster(&places, bounds, (camera, lamp))
        };
        patches.filter_map(caster).collect()
    }

    /// The cells as dark as shadow that no box with a height hides or shades, nor robot or border.
    fn unexplained_shade(&self) -> Raster<bool> {
        let Look { view, features, floor, .. } = self.look;
        // What was taken for a flat thing may be the shadow itself.
        let casts: Vec<_> =
            self.casts().into_iter().filter(|cast| cast.0.lean > LEAST_LEAN).collect();
        Raster::from_fn(features.width(), features.height(), |column, row| {
            let point = view.point(column as f64, row as f64);
            let difference = floor.difference(point, features.row(row)[column]);
            difference.lit > FOREIGN
                && difference.floor <= FOREIGN
                && floor.inside(point) > 0.0
                && !self.is_near_robot(point)
                && !self.is_of_high_box(point)
                && !self.is_in_light_shadow(point, &casts)
        })
    }

    fn is_of_high_box(&self, point: Point) -> bool {
        let blur = BLUR / self.look.view.scale;
        let mut high = self.boxes.iter().filter(|seen| seen.lean > LEAST_LEAN);
        high.any(|seen| seen.spans(self.foot, point, blur))
    }

    /// The places around a patch where it can be seen whether there is shadow.
    fn places(&self, patch: &Raster<bool>, bounds: Rect) -> Vec<Place> {
        let view = &self.look.view;
        let near = bounds.widened([REACH; 4]);
        let every = (near.area() / MOST_PLACES).sqrt() * view.scale;
        let every = every.ceil().max(1.0) as usize;
        let rows = (0..patch.height()).step_by(every);
        let cells =
            rows.flat_map(|row| (0..patch.width()).step_by(every).map(move |column| (column, row)));
        let place = |(column, row): (usize, usize)| Place {
            point: view.point(column as f64, row as f64),
            is_dark: patch.row(row)[column],
        };
        let is_plain = |place: &Place| {
            near.contains(place.point)
                && self.look.floor.inside(place.point) > 0.0
                && (place.is_dark || !self.is_of_high_box(place.point))
        };
        cells.map(place).filter(is_plain).collect()
    }
}

/// The box that casts a shadow of which `bounds` hold the dark places; `None` if no box agrees with it.
fn caster(places: &[Place], bounds: Rect, (camera, lamp): (Point, Lamp)) -> Option<Bounded> {
    let agreement = |seen: LeaningBox| agreement(places, seen, camera, lamp);
    let starts = LEANS.into_iter().filter_map(|lean| {
        let shadow = lamp.shadow(LeaningBox { base: bounds, lean })?;
        let base = LeaningBox::within(bounds, lamp.foot, shadow.lean).base;
        let start = LeaningBox { base, lean };
        is_possible(start).then(|| improved(start, agreement))
    });
    let (best, agreed) = starts.max_by(|a, b| a.1.total_cmp(&b.1))?;
    // A patch that fills its bounds is more simply a thing as dark as shadow.
    let inside = places.iter().filter(|place| bounds.contains(place.point));
    let filled = inside.clone().filter(|place| place.is_dark).count() as f64;
    let is_plain = filled > agreed * inside.count() as f64;
    (agreed > LEAST_AGREEMENT && !is_plain)
        .then_some(Bounded { rect: best.base, margin: [MARGIN; 4] })
}

fn is_possible(seen: LeaningBox) -> bool {
    let Rect { x0, y0, x1, y1 } = seen.base;
    x1 - x0 > LEAST_SIDE && y1 - y0 > LEAST_SIDE && seen.lean > LEAST_LEAN
}

/// The share of the places dark or said to be that are both.
fn agreement(places: &[Place], seen: LeaningBox, camera: Point, lamp: Lamp) -> f64 {
    let Some(shadow) = lamp.shadow(seen) else { return 0.0 };
    let (mut both, mut either) = (0_usize, 0_usize);
    for &Place { point, is_dark } in places {
        let is_shaded =
            shadow.face(point, lamp.foot).is_some() && seen.face(point, camera).is_none();
        both += usize::from(is_dark && is_shaded);
        either += usize::from(is_dark || is_shaded);
    }
    both as f64 / either.max(1) as f64
}

/// The box that agrees best near another one, and how well.
fn improved(start: LeaningBox, agreement: impl Fn(LeaningBox) -> f64) -> (LeaningBox, f64) {
    let mut best = (start, agreement(start));
    for step in STEPS {
        for _ in 0..ROUNDS {
            let before = best.1;
            for which in 0..MOVES {
                let tried = moved(best.0, which, step);
                let agreed = if is_possible(tried) { agreement(tried) } else { 0.0 };
                if agreed > best.1 {
                    best = (tried, agreed);
                }
            }
            if best.1 <= before {
                break;
            }
        }
    }
    best
}

/// A box with one of its edges, or its lean, moved a step to either side.
fn moved(seen: LeaningBox, which: usize, step: f64) -> LeaningBox {
    let sign = if which.is_multiple_of(2) { 1.0 } else { -1.0 };
    let mut edges: [f64; 4] = seen.base.into();
    match edges.get_mut(which / 2) {
        Some(edge) => *edge += sign * step,
        None => {
            let lean = 1.0 + (seen.lean - 1.0) * (sign * LEAN_SHARE * step).exp();
            return LeaningBox { lean, ..seen };
        }
    }
    let [x0, y0, x1, y1] = edges;
    LeaningBox { base: Rect::new(x0, y0, x1, y1), ..seen }
}

#[cfg(test)]
mod tests {
    use super::*;

    const CAMERA: Point = Point::new(1.0, 0.8);
    const LAMP: Lamp = Lamp { foot: Point::new(2.2, 0.1), ratio: 1.1 };

    /// Places a centimetre apart, dark where `is_dark` says.
    fn places(is_dark: impl Fn(Point) -> bool) -> (Vec<Place>, Rect) {
        let place = |i: usize| {
            let point = Point::new((i % 200) as f64 * 0.01, (i / 200) as f64 * 0.01);
            Place { point, is_dark: is_dark(point) }
        };
        let all: Vec<Place> = (0..200 * 160).map(place).collect();
        let dark: Vec<Point> = all.iter().filter(|p| p.is_dark).map(|p| p.point).collect();
        (all, Rect::around(&dark))
    }

    #[test]
    fn a_box_that_is_not_seen_stands_where_its_shadow_tells() {
        for (base, lean) in [
            (Rect::new(0.60, 0.87, 0.85, 1.05), 1.05),
            (Rect::new(0.30, 0.40, 0.40, 0.70), 1.10),
            (Rect::new(1.20, 1.00, 1.50, 1.10), 1.08),
        ] {
            let truth = LeaningBox { base, lean };
            let shadow = LAMP.shadow(truth).unwrap();
            let (places, bounds) = places(|point| {
                shadow.face(point, LAMP.foot).is_some() && truth.face(point, CAMERA).is_none()
            });
            let found = caster(&places, bounds, (CAMERA, LAMP)).unwrap();
            let (edges, true_edges): ([f64; 4], [f64; 4]) = (found.rect.into(), base.into());
            let off = edges.iter().zip(true_edges).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
            assert!(off < MARGIN, "{found:?} {base:?}");
        }
    }

    #[test]
    fn no_box_casts_a_dark_cross() {
        let is_dark = |point: Point| {
            let (x, y) = ((point.x - 0.7).abs(), (point.y - 1.0).abs());
            x < 0.03 && y < 0.15 || y < 0.03 && x < 0.15
        };
        let (places, bounds) = places(is_dark);
        assert_eq!(caster(&places, bounds, (CAMERA, LAMP)), None);
    }
}
