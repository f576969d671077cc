//! How far a box leans: where its visible sides end and its top begins. Pixels along the sides, metres else.

use super::projection::LeaningBox;
use super::refine::{PLACES, Sharpener, at};
use super::search::MOST_LEAN;
use crate::geometry::{Point, Side};
use crate::vision::appearance::{Feature, SURE, feature};

/// A foot edge, which may be that of a dark box on a white floor, blurs the light this far, pixels.
const FOOT_BLUR: f64 = 3.0;
/// The edge between two faces blurs the light this far, pixels.
const FACE_BLUR: f64 = 1.0;
/// A first guess of the lean above this is right to so much.
const LEAST_GUESS: f64 = 1.02;
const GUESS_REACH: f64 = 0.03;
/// Without a guess only small leans are possible, and only plain sides count.
const UNGUESSED_REACH: f64 = 0.07;
const UNGUESSED_CONTRAST: f64 = 0.15;
/// Two faces differ by at least this much, a natural logarithm.
const FACE_CONTRAST: f64 = 0.10;
/// Before the step at its end a side changes by at most this share of it.
const EVEN_SIDE: f32 = 0.5;
/// Sides farther from the foot point than this, metres, say no more of the lean.
const GUESS_DISTANCE: f64 = 0.3;
/// The distance of samples across a side, pixels, and of the leans that are tried.
const SIDE_STEP: f64 = 0.5;
const LEAN_STEP: f64 = 0.0025;

impl Sharpener<'_> {
    /// The lean of a box whose sides can be told from its top.
    pub(crate) fn shown_lean(&self, seen: LeaningBox) -> Option<f64> {
        self.foot.and_then(|foot| self.lean(seen, foot))
    }

    /// The lean at which visible sides end and the top begins, if the photo shows that.
    ///
    /// All visible sides end at the same lean; a grain or a stripe on one of them does not.
    pub(super) fn lean(&self, seen: LeaningBox, foot: Point) -> Option<f64> {
        let views: Vec<SideView> = Side::EDGES
            .into_iter()
            .filter(|&side| seen.faces(side, foot))
            .filter_map(|side| self.side_view(seen, foot, side))
            .collect();
        let total: f64 = views.iter().map(|view| view.weight).sum();
        let guessed = seen.lean > LEAST_GUESS;
        let clarity = |index: usize| {
            let lean = 1.0 + index as f64 * LEAN_STEP;
            views.iter().map(|view| view.weight * view.clarity_at(lean, !guessed)).sum::<f64>()
                / total.max(1e-9)
        };
        let clarities: Vec<f64> =
            (0..((MOST_LEAN - 1.0) / LEAN_STEP) as usize).map(clarity).collect();
        let guess = ((seen.lean - 1.0) / LEAN_STEP).round() as usize;
        let (reach, least) = if guessed {
            (GUESS_REACH, FACE_CONTRAST)
        } else {
            (UNGUESSED_REACH, UNGUESSED_CONTRAST)
        };
        let reach = (reach / LEAN_STEP) as usize;
        let near = clarities.iter().enumerate().filter(|(index, _)| index.abs_diff(guess) <= reach);
        let (best, &most) = near.max_by(|a, b| a.1.total_cmp(b.1))?;
        (most > least).then_some(1.0 + best as f64 * LEAN_STEP)
    }

    /// The colours from the foot of a visible side inwards.
    fn side_view(&self, seen: LeaningBox, foot: Point, side: Side) -> Option<SideView> {
        let (base, bounds): ([f64; 4], [f64; 4]) = (seen.base.into(), seen.bounds(foot).into());
        let origin = if side.is_upright() { foot.x } else { foot.y };
        let distance = (base[side.edge()] - origin).abs();
        let scale = self.scale(seen.base, side);
        let deepest = ((MOST_LEAN - 1.0) * distance)
            .min(0.7 * (bounds[side.edge()] - bounds[side.opposite().edge()]).abs());
        let count = (deepest * scale / SIDE_STEP) as usize;
        if count < 8 {
            return None;
        }
        let along =
            if side.is_upright() { [Side::Upper, Side::Lower] } else { [Side::Right, Side::Left] };
        let length = (base[along[0].edge()] - base[along[1].edge()]).abs();
        let colours = (0..count).map(|index| {
            let mut sum = [0f32; 3];
            for place in 0..PLACES / 2 {
                let along = 0.15 + 0.7 * (place as f64 + 0.5) / (PLACES / 2) as f64;
                let pixel = self.map.to_photo(at(
                    seen.base,
                    side,
                    along,
                    -(index as f64) * SIDE_STEP / scale,
                ));
                sum.iter_mut().zip(self.photo.light(pixel)).for_each(|(sum, light)| *sum += light);
            }
            feature(sum.map(|value| value / (PLACES / 2) as f32))
        });
        let colours: Vec<Feature> = colours.collect();
        let foot_of_side = at(seen.base, side, 0.5, 0.0);
        let is_floor =
            |&colour: &Feature| self.look.floor.difference(foot_of_side, colour).lit < SURE;
        let floor = colours.iter().map(is_floor).collect();
        Some(SideView {
            colours,
            floor,
            distance: distance * scale,
            weight: length * distance.min(GUESS_DISTANCE),
        })
    }
}

/// The colours from the foot of a visible side inwards, one sample every [`SIDE_STEP`] pixels.
struct SideView {
    colours: Vec<Feature>,
    /// Which of them are those of lit floor.
    floor: Vec<bool>,
    /// From the camera's foot point to the side's foot, pixels.
    distance: f64,
    weight: f64,
}

impl SideView {
    /// How clearly a side ends at a lean: by the step there, and by the faces on both sides of it. Where
    /// nothing else speaks for a side it must be `even` up to there.
    fn clarity_at(&self, lean: f64, even: bool) -> f64 {
        let end = ((lean - 1.0) * self.distance / SIDE_STEP).round() as usize;
        let (first, blur) = ((FOOT_BLUR / SIDE_STEP) as usize, (FACE_BLUR / SIDE_STEP) as usize);
        if end < first + 2 * blur || end + 2 * blur >= self.colours.len() {
            return 0.0;
        }
        // Floor before something dark is no side of it.
        let side = self.floor.get(first..=end - blur).unwrap_or(&[]);
        if 2 * side.iter().filter(|&&is_floor| is_floor).count() > side.len() {
            return 0.0;
        }
        let mean = |from: usize, to: usize| {
            let part = self.colours.get(from..to.min(self.colours.len())).unwrap_or(&[]);
            [0, 1, 2].map(|axis| {
                part.iter().map(|colour| colour[axis]).sum::<f32>() / part.len().max(1) as f32
            })
        };
        let faces = distance(
            mean(first, end - blur + 1),
            mean(end + blur, end + blur + (end - first).max(2 * blur)),
        );
        let change =
            |middle: usize| distance(self.colours[middle - blur], self.colours[middle + blur]);
        let step = change(end);
        // A side is even up to where the top begins; blur and gloss change all the way.
        let before =
            (first + blur..(end + 1).saturating_sub(2 * blur)).map(change).fold(0.0, f32::max);
        if even && before > EVEN_SIDE * step { 0.0 } else { f64::from(faces.min(step)) }
    }
}

fn distance(a: Feature, b: Feature) -> f32 {
    (0..3).map(|part| (a[part] - b[part]).powi(2)).sum::<f32>().sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A side 20 samples high, one unit darker than the top behind it.
    fn side(floor: bool) -> SideView {
        let colours = (0..60).map(|i| [if i < 20 { -1.0 } else { 0.0 }, 0.0, 0.0]).collect();
        SideView { colours, floor: vec![floor; 60], distance: 100.0, weight: 1.0 }
    }

    #[test]
    fn a_side_is_clear_where_the_top_begins_and_floor_is_no_side() {
        // 20 samples of half a pixel are a tenth of 100 pixels.
        assert_eq!(side(false).clarity_at(1.1, true), 1.0);
        assert_eq!(side(true).clarity_at(1.1, true), 0.0);
        // On the top there is no step; with one before it a side that must be even ends there.
        assert_eq!(side(false).clarity_at(1.2, true), 0.0);
        // Too near to the foot and beyond what is seen.
        assert_eq!(side(false).clarity_at(1.02, false), 0.0);
        assert_eq!(side(false).clarity_at(1.3, false), 0.0);
    }
}
