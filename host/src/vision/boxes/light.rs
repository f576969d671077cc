//! The lamp, from the shadows of boxes that were found, and the shadow that it makes a box cast.
//!
//! A shadow is what a box hides from the lamp, as its outline is what it hides from the camera: both sweep
//! the footprint away from a foot point. A box of height h leans by k = H / (H − h) about the camera's
//! foot point and by k' = H' / (H' − h) about the lamp's, so that
//! `1 − 1/k' = ratio · (1 − 1/k)` with ratio = H / H', camera's over lamp's height.
//!
//! Deviation: the paper knows no shadows; it leaves them to a second camera [Alghannam, Sec. VI].

use super::evidence::Evidence;
use super::projection::LeaningBox;
use crate::geometry::Point;
use crate::vision::image::Raster;
use std::f64::consts::TAU;

/// Directions, distances (longer sides of the arena) and slopes (distance over height) of lamps that
/// are tried.
const DIRECTIONS: usize = 24;
const DISTANCES: [f64; 5] = [0.25, 0.5, 1.0, 2.0, 4.0];
const SLOPES: [f64; 4] = [0.3, 0.55, 0.9, 1.4];
/// Leans of a box whose sides do not tell.
const LEANS: [f64; 6] = [1.02, 1.04, 1.07, 1.10, 1.14, 1.19];
/// Lamps that are improved.
const IMPROVED: usize = 4;
/// Steps of the improvement: radians, and logarithms of distance and slope.
const STEPS: [f64; 4] = [0.12, 0.06, 0.03, 0.015];
/// The longest shadow that is believed, as a height's share of the lamp's height.
const HIGHEST: f64 = 0.75;
/// Less shadow than this, square metres, tells nothing of the lamp.
const LEAST_SHADOW: f64 = 0.004;
/// The share of the shadow on the floor that the lamp must explain.
const LEAST_SHARE: f64 = 0.5;
/// The same if no box shows how it leans.
const LEAST_UNTOLD: f64 = 0.95;
/// The same less the lit part of the floor that it puts in shadow.
const LEAST_NET: f64 = 0.25;
/// The same if fewer boxes than these show how they lean: flat things of several greys may look so.
const MANY_TOLD: usize = 3;
const LEAST_NET_OF_FEW: f64 = 0.5;
/// Lamps usually hang about as high as cameras; one that does not must explain more by this share.
const USUAL_RATIO: f64 = 1.1;
const RATIO_SPREAD: f64 = 0.9;
const ODD_CHARGE: f32 = 0.15;
/// Every how many-th cell is looked at.
const STRIDE: usize = 2;

/// A lamp above a point of the floor's plane.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Lamp {
    /// The point straight below it, metres.
    pub(crate) foot: Point,
    /// The camera's height over the lamp's.
    pub(crate) ratio: f64,
}

/// A lamp in the terms of the search: where it stands seen from the arena's middle.
#[derive(Clone, Copy)]
struct Place {
    direction: f64,
    distance: f64,
    slope: f64,
}

impl Lamp {
    /// The box as the lamp sees it: what it would see of the outline is in shadow. `None` if the shadow
    /// would never end.
    pub(crate) fn shadow(&self, seen: LeaningBox) -> Option<LeaningBox> {
        let share = self.ratio * (1.0 - 1.0 / seen.lean);
        (share < HIGHEST).then(|| LeaningBox { base: seen.base, lean: 1.0 / (1.0 - share) })
    }

    /// The lamp that explains the shadows of boxes best, if there are shadows and it explains them.
    ///
    /// `leans[i]` is the lean of box i if its sides tell it; `height` is the camera's, metres.
    pub(crate) fn of(
        evidence: &Evidence,
        boxes: &[LeaningBox],
        leans: &[Option<f64>],
        camera: Point,
        height: f64,
    ) -> Option<Self> {
        let free = uncovered_shade(evidence, boxes, camera);
        let stage = Stage { evidence, boxes, leans, free: &free, height };
        let shaded = free.cells().iter().filter(|&&shade| shade > 0.0).count();
        if boxes.is_empty() || (shaded as f64) < LEAST_SHADOW * evidence.frame.scale.powi(2) {
            return None;
        }
        let mut tried: Vec<(f32, Place)> =
            places().map(|place| (stage.score(place), place)).collect();
        tried.sort_by(|a, b| b.0.total_cmp(&a.0));
        let improved = tried.into_iter().take(IMPROVED).map(|start| stage.improve(start));
        let (_, place) = improved.max_by(|a, b| a.0.total_cmp(&b.0))?;
        let lamp = stage.lamp(place);
        let told = leans.iter().flatten().count();
        let least = if told > 0 { LEAST_SHARE } else { LEAST_UNTOLD };
        let least_net = if told < MANY_TOLD { LEAST_NET_OF_FEW } else { LEAST_NET };
        // Cells that should be in shadow but are lit speak against the lamp.
        let net = f64::from(stage.score(place)) * (STRIDE * STRIDE) as f64 / shaded as f64;
        (stage.share(lamp) > least && net > least_net).then_some(lamp)
    }
}

fn places() -> impl Iterator<Item = Place> {
    (0..DIRECTIONS).flat_map(|index| {
        let direction = TAU * index as f64 / DIRECTIONS as f64;
        DISTANCES.into_iter().flat_map(move |distance| {
            SLOPES.into_iter().map(move |slope| Place { direction, distance, slope })
        })
    })
}

/// How shaded cells are that no outline covers; those at a rim of shadow, which may be blur, do not count.
fn uncovered_shade(evidence: &Evidence, boxes: &[LeaningBox], camera: Point) -> Raster<f32> {
    let shade = &evidence.shade;
    Raster::from_fn(shade.width(), shade.height(), |column, row| {
        let (x, y) = (column as i64, row as i64);
        let here = shade.get(x, y).unwrap_or(0.0);
        let rim = here > 0.0
            && [(x + 1, y), (x - 1, y), (x, y + 1), (x, y - 1)]
                .into_iter()
                .any(|(x, y)| shade.get(x, y).unwrap_or(0.0) <= 0.0);
        let point = evidence.frame.point(column as f64, row as f64);
        let covered = || boxes.iter().any(|seen| seen.face(point, camera).is_some());
        if here == 0.0 || rim || covered() { 0.0 } else { here }
    })
}

/// What a lamp is judged by.
struct Stage<'a> {
    evidence: &'a Evidence,
    boxes: &'a [LeaningBox],
    leans: &'a [Option<f64>],
    free: &'a Raster<f32>,
    height: f64,
}

impl Stage<'_> {
    fn lamp(&self, place: Place) -> Lamp {
        let arena = self.evidence.frame.arena;
        let distance = place.distance * arena.width.max(arena.height);
        let (sin, cos) = place.direction.sin_cos();
        let foot =
            Point::new(arena.width / 2.0 + distance * cos, arena.height / 2.0 + distance * sin);
        Lamp { foot, ratio: self.height * place.slope / distance }
    }

    /// How much more shaded than lit cells a lamp's shadows cover; boxes whose lean is not known take the best.
    fn score(&self, place: Place) -> f32 {
        let lamp = self.lamp(place);
        let of_box = |(seen, lean): (&LeaningBox, &Option<f64>)| match lean {
            Some(lean) => self.of_shadow(lamp, LeaningBox { lean: *lean, ..*seen }),
            None => LEANS
                .map(|lean| self.of_shadow(lamp, LeaningBox { lean, ..*seen }))
                .into_iter()
                .fold(0.0, f32::max),
        };
        let sum: f32 = self.boxes.iter().zip(self.leans).map(of_box).sum();
        let odd = ((lamp.ratio / USUAL_RATIO).ln() / RATIO_SPREAD).powi(2).min(1.0);
        sum * (1.0 - ODD_CHARGE * odd as f32)
    }

    fn of_shadow(&self, lamp: Lamp, seen: LeaningBox) -> f32 {
        let mut sum = 0.0;
        if let Some(shadow) = lamp.shadow(seen) {
            self.evidence.each_covered(shadow, lamp.foot, STRIDE, |index, _| {
                sum += self.free.cells()[index];
            });
        }
        sum
    }

    fn improve(&self, start: (f32, Place)) -> (f32, Place) {
        let mut best = start;
        for step in STEPS {
            for _ in 0..8 {
                let before = best.0;
                for (turn, far, low) in [
                    (step, 1.0, 1.0),
                    (-step, 1.0, 1.0),
                    (0.0, step.exp(), 1.0),
                    (0.0, (-step).exp(), 1.0),
                    (0.0, 1.0, step.exp()),
                    (0.0, 1.0, (-step).exp()),
                ] {
                    let place = Place {
                        direction: best.1.direction + turn,
                        distance: best.1.distance * far,
                        slope: best.1.slope * low,
                    };
                    let score = self.score(place);
                    if score > best.0 {
                        best = (score, place);
                    }
                }
                if best.0 <= before {
                    break;
                }
            }
        }
        best
    }

    /// The share of the shaded cells that the shadows of a lamp cover.
    fn share(&self, lamp: Lamp) -> f64 {
        let known: Vec<LeaningBox> = self
            .boxes
            .iter()
            .zip(self.leans)
            .map(|(seen, lean)| {
                let best = |a: &f64, b: &f64| {
                    let of = |lean: f64| self.of_shadow(lamp, LeaningBox { lean, ..*seen });
                    of(*a).total_cmp(&of(*b))
                };
                let free = LEANS.into_iter().max_by(best);
                LeaningBox { lean: lean.or(free).unwrap_or(seen.lean), ..*seen }
            })
            .collect();
        let shadows: Vec<LeaningBox> = known.iter().filter_map(|&seen| lamp.shadow(seen)).collect();
        let (mut all, mut explained) = (0usize, 0usize);
        for (index, &shade) in self.free.cells().iter().enumerate() {
            if shade > 0.0 {
                let point = self.evidence.point(index);
                all += 1;
                explained += usize::from(
                    shadows.iter().any(|shadow| shadow.face(point, lamp.foot).is_some()),
                );
            }
        }
        explained as f64 / all.max(1) as f64
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::{Arena, Rect};
    use crate::vision::PlanFrame;

    #[test]
    fn a_lamp_two_thirds_as_high_as_the_camera_makes_longer_shadows() {
        // h = 0.5 m below a camera at 3 m and a lamp at 2 m: k = 3 / 2.5, k' = 2 / 1.5.
        let lamp = Lamp { foot: Point::new(0.0, 0.0), ratio: 1.5 };
        let seen = LeaningBox { base: Rect::new(1.0, 1.0, 1.2, 1.4), lean: 1.2 };
        let shadow = lamp.shadow(seen).unwrap();
        assert!((shadow.lean - 4.0 / 3.0).abs() < 1e-12, "{shadow:?}");
        assert_eq!(shadow.base, seen.base);
        assert_eq!(lamp.shadow(LeaningBox { lean: 3.0, ..seen }), None);
    }

    #[test]
    fn the_lamp_is_found_by_the_shadows_it_makes() {
        let arena = Arena { width: 2.0, height: 1.5 };
        let (camera, truth) =
            (Point::new(1.1, 0.7), Lamp { foot: Point::new(2.6, 1.9), ratio: 1.2 });
        let boxes: Vec<LeaningBox> = [
            (Rect::new(0.3, 0.3, 0.5, 0.6), 1.10),
            (Rect::new(1.3, 0.4, 1.6, 0.5), 1.06),
            (Rect::new(0.7, 1.0, 0.8, 1.2), 1.14),
        ]
        .map(|(base, lean)| LeaningBox { base, lean })
        .into();
        let frame = PlanFrame::new(arena, 100.0, 0.1);
        let (width, height) = frame.size();
        let shade = Raster::from_fn(width, height, |column, row| {
            let point = frame.point(column as f64, row as f64);
            let shaded = boxes.iter().filter_map(|&seen| truth.shadow(seen));
            let mut shaded = shaded.map(|shadow| shadow.face(point, truth.foot).is_some());
            if shaded.any(|shaded| shaded) { 1.0 } else { -1.0 }
        });
        let evidence = Evidence { shade, ..Evidence::drawn(frame, |_| 0.0) };
        let leans: Vec<Option<f64>> = vec![Some(1.10), None, Some(1.14)];
        let lamp = Lamp::of(&evidence, &boxes, &leans, camera, 3.0).unwrap();
        // Direction and distance trade off; what counts is where a shadow falls: to two cells of the search.
        let other = LeaningBox { base: Rect::new(1.0, 0.2, 1.2, 0.4), lean: 1.08 };
        let [a, b] = [truth, lamp]
            .map(|lamp| <[f64; 4]>::from(lamp.shadow(other).unwrap().bounds(lamp.foot)));
        assert!(a.iter().zip(b).all(|(a, b)| (a - b).abs() < 0.02), "{a:?} {b:?} {lamp:?}");
    }
}
