//! Boxes as the best explanation of what is not floor.
//!
//! A box explains the cells of its outline: each visible face has one colour, and a cell costs as much as
//! it differs from its face's, at most 1, against its cost of being background. The gain of a box is what
//! it saves, less a charge for being there and one for visible sides that look like the top. Boxes
//! are added best first; each is improved by moving the edges of its outline and its lean in shrinking
//! steps, given all others.

use super::candidates::Candidate;
use super::evidence::Evidence;
use super::light::Lamp;
use super::projection::{Face, LeaningBox};
use crate::geometry::{Point, Rect};
use crate::vision::appearance::Feature;
use crate::vision::image::Raster;

/// How far a cell may be off its face's colour (brightness, chroma, chroma).
const FACE_SPREAD: Feature = [0.40, 0.16, 0.16];
/// A side whose mean colour is this far from the top's is seen as one.
const SIDE_CONTRAST: f32 = 0.2;
/// Every cell of a box costs a little: what floor explains nearly as well is floor.
pub(crate) const CELL_CHARGE: f32 = 0.06;
/// The outermost cells of an outline are blurred with what is around it: they only pull the edge to
/// where the background ends.
const RIM: f64 = 1.0;
const RIM_SHARE: f32 = 0.5;
/// A side this narrow, in cells, may be the blur of an edge.
const BLURRED_WIDTH: f32 = 1.3;
/// What a cell of shadow costs that no box casts, and a lit cell where a box would cast shadow.
pub(crate) const SHADOW_DOUBT: f32 = 0.35;
const LIT_CHARGE: f32 = 0.35;
/// What a cell of a side costs that cannot be told from the top.
const SIDE_CHARGE: f32 = 0.35;
/// A box gains at least what this many square metres of unexplained cells cost.
const LEAST_AREA: f64 = 0.0010;
/// A box is at least this wide, metres.
const LEAST_SIDE: f64 = 0.02;
/// The steepest lean.
pub(crate) const MOST_LEAN: f64 = 1.25;
/// Leans that candidates start with.
const LEANS: [f64; 4] = [1.0, 1.04, 1.09, 1.16];
/// Steps of the search: cells for edges, and for the lean.
const STEPS: [(f64, f64); 4] = [(4.0, 0.04), (2.0, 0.02), (1.0, 0.01), (0.5, 0.005)];
/// How often each move is tried at each size of steps.
const MOST_PASSES: usize = 12;
/// Boxes that are looked for at most.
const MOST_BOXES: usize = 40;
/// How often all boxes are improved together.
const ROUNDS: usize = 2;

/// A search for boxes in one picture.
pub(crate) struct Search<'a> {
    pub(crate) evidence: &'a Evidence,
    /// The camera's foot point; `None` if boxes do not lean.
    pub(crate) foot: Option<Point>,
    /// The lamp, if it is known: then boxes must explain all shadow.
    pub(crate) lamp: Option<Lamp>,
}

/// A box with what it saves.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Scored {
    pub(crate) gain: f32,
    pub(crate) seen: LeaningBox,
}

impl Search<'_> {
    /// The boxes that explain the evidence best, from rectangles that may be outlines or tops.
    pub(crate) fn run(&self, proposals: &[Rect]) -> Vec<LeaningBox> {
        self.run_from(proposals, &[])
    }

    /// The same, from boxes too that may be there as they are.
    pub(crate) fn run_from(&self, proposals: &[Rect], likely: &[LeaningBox]) -> Vec<LeaningBox> {
        let mut cost = self.unexplained();
        let mut found: Vec<LeaningBox> = Vec::new();
        let readings = proposals.iter().flat_map(|&rect| self.readings(rect));
        let mut candidates: Vec<Candidate> = readings
            .chain(likely.iter().copied())
            .map(|seen| self.candidate(seen, &cost))
            .collect();
        while found.len() < MOST_BOXES {
            let Some(best) = self.best(&mut candidates, &cost) else { break };
            if f64::from(best.gain) < self.least_gain() {
                break;
            }
            self.explain(&mut cost, best.seen);
            self.renew(&mut candidates, &cost, best.seen);
            found.push(best.seen);
        }
        self.merge(&mut found);
        for _ in 0..ROUNDS {
            self.improve_all(&mut found);
        }
        found
    }

    /// Calls `visit` with the index of every cell that a box puts in shadow.
    fn each_shaded(&self, seen: LeaningBox, mut visit: impl FnMut(usize)) {
        let Some(lamp) = self.lamp else { return };
        let Some(shadow) = lamp.shadow(seen) else { return };
        let foot = self.foot();
        let shade = self.evidence.shade.cells();
        self.evidence.each_covered(shadow, lamp.foot, 1, |index, point| {
            if shade[index] != 0.0 && seen.face(point, foot).is_none() {
                visit(index);
            }
        });
    }

    /// What a box must gain.
    pub(crate) fn least_gain(&self) -> f64 {
        LEAST_AREA * self.evidence.frame.scale * self.evidence.frame.scale
    }

    pub(crate) fn foot(&self) -> Point {
        let arena = self.evidence.frame.arena;
        self.foot.unwrap_or(Point::new(arena.width / 2.0, arena.height / 2.0))
    }

    /// The boxes that a rectangle may be the outline or the top of.
    fn readings(&self, rect: Rect) -> Vec<LeaningBox> {
        let foot = self.foot();
        let leans = if self.foot.is_some() { &LEANS[..] } else { &LEANS[..1] };
        let outline = leans.iter().map(|&lean| LeaningBox::within(rect, foot, lean));
        let top = leans.iter().skip(1).map(|&lean| LeaningBox::under(rect, foot, lean));
        outline.chain(top).collect()
    }

    /// Every box given the others; boxes that no longer gain enough are dropped.
    fn improve_all(&self, found: &mut Vec<LeaningBox>) {
        for index in (0..found.len()).rev() {
            let mut cost = self.unexplained();
            for (other, &seen) in found.iter().enumerate() {
                if other != index {
                    self.explain(&mut cost, seen);
                }
            }
            let start = Scored { gain: self.gain(found[index], &cost), seen: found[index] };
            let best = self.improve(start, &cost);
            if f64::from(best.gain) < self.least_gain() {
                found.remove(index);
            } else {
                found[index] = best.seen;
            }
        }
    }

    /// Moves outline and lean in shrinking steps as long as the gain grows.
    pub(crate) fn improve(&self, start: Scored, cost: &Raster<f32>) -> Scored {
        self.improve_seen(start, cost, |_| ())
    }

    /// The same; `visit` is called with every box that is tried.
    pub(crate) fn improve_seen(
        &self,
        start: Scored,
        cost: &Raster<f32>,
        mut visit: impl FnMut(LeaningBox),
    ) -> Scored {
        let mut best = start;
        let moves = if self.foot.is_some() { 10 } else { 8 };
        for (cells, lean_step) in STEPS {
            let step = cells / self.evidence.frame.scale;
            let mut failed = 0;
            for change in (0..moves).cycle().take(MOST_PASSES * moves) {
                let seen = self.changed(best.seen, change, step, lean_step);
                visit(seen);
                let gain = self.gain(seen, cost);
                failed += 1;
                if gain > best.gain {
                    best = Scored { gain, seen };
                    failed = 0;
                }
                if failed == moves {
                    break;
                }
            }
        }
        best
    }

    /// One of the moves of a box: 0 to 7 move an edge of the outline, 8 and 9 change the lean.
    fn changed(&self, seen: LeaningBox, change: usize, step: f64, lean_step: f64) -> LeaningBox {
        let foot = self.foot();
        let mut edges: [f64; 4] = seen.bounds(foot).into();
        let sign = if change.is_multiple_of(2) { 1.0 } else { -1.0 };
        let mut lean = seen.lean;
        match edges.get_mut(change / 2) {
            Some(edge) => *edge += sign * step,
            None => lean = (lean + sign * lean_step).clamp(1.0, MOST_LEAN),
        }
        LeaningBox::within(edges.into(), foot, lean)
    }

    /// What a box saves against a cost of every cell.
    pub(crate) fn gain(&self, seen: LeaningBox, cost: &Raster<f32>) -> f32 {
        let base = seen.base;
        let arena = self.evidence.frame.arena;
        let slack = 2.0 / self.evidence.frame.scale;
        let stands = base.x0 > -slack
            && base.y0 > -slack
            && base.x1 < arena.width + slack
            && base.y1 < arena.height + slack;
        if !stands || base.x1 - base.x0 < LEAST_SIDE || base.y1 - base.y0 < LEAST_SIDE {
            return f32::NEG_INFINITY;
        }
        let faces = self.faces(seen, cost);
        let (weight, features) = (self.evidence.weight.cells(), self.evidence.features.cells());
        let costs = cost.cells();
        let mut gain = 0.0;
        self.each_cell(seen, |index, face, rim| {
            let saved = if rim {
                RIM_SHARE * (costs[index] - 0.5)
            } else {
                costs[index] - face_cost(features[index], faces[face as usize].colour) - CELL_CHARGE
            };
            gain += weight[index] * saved;
        });
        for (side, length) in
            [(Face::AcrossX, base.y1 - base.y0), (Face::AcrossY, base.x1 - base.x0)]
        {
            let cells = faces[side as usize].cells;
            gain -= SIDE_CHARGE * cells * (1.0 - self.side_clarity(&faces, side, length));
        }
        self.each_shaded(seen, |index| {
            let shade = self.evidence.shade.cells()[index];
            // What is no floor even in shadow is not explained by a shadow.
            let left = cost.cells()[index] - self.evidence.background.cells()[index];
            let saved =
                if shade > 0.0 { left.clamp(0.0, SHADOW_DOUBT) } else { LIT_CHARGE * shade };
            gain += self.evidence.weight.cells()[index] * saved;
        });
        gain
    }

    /// How clearly a side of a length in metres can be told from the top, 0 to 1.
    fn side_clarity(&self, faces: &[FaceColour; 3], side: Face, length: f64) -> f32 {
        let side = &faces[side as usize];
        let width = side.cells / (length * self.evidence.frame.scale).max(1.0) as f32;
        let wide = ((width - BLURRED_WIDTH) / BLURRED_WIDTH).clamp(0.0, 1.0);
        wide * (difference(side.colour, faces[Face::Top as usize].colour) / SIDE_CONTRAST).min(1.0)
    }

    /// The mean colour and size of each face; cells that are likely background hardly count.
    fn faces(&self, seen: LeaningBox, cost: &Raster<f32>) -> [FaceColour; 3] {
        let mut faces = [FaceColour::default(); 3];
        let (weight, features) = (self.evidence.weight.cells(), self.evidence.features.cells());
        let costs = cost.cells();
        self.each_cell(seen, |index, face, rim| {
            let share = if rim { 0.02 } else { 1.0 };
            let counts = weight[index] * (costs[index] + 0.05) * share;
            let face = &mut faces[face as usize];
            face.weight += counts;
            face.cells += weight[index];
            for (sum, value) in face.colour.iter_mut().zip(features[index]) {
                *sum += counts * value;
            }
        });
        faces.map(|face| FaceColour {
            colour: face.colour.map(|sum| sum / face.weight.max(1e-6)),
            ..face
        })
    }

    /// Lowers the cost of the cells that a box explains.
    pub(crate) fn explain(&self, cost: &mut Raster<f32>, seen: LeaningBox) {
        let faces = self.faces(seen, cost);
        self.each_cell(seen, |index, face, rim| {
            let of_face =
                face_cost(self.evidence.features.cells()[index], faces[face as usize].colour);
            let cell = &mut cost.cells_mut()[index];
            *cell = cell.min(if rim { 0.0 } else { of_face });
        });
        self.each_shaded(seen, |index| {
            if self.evidence.shade.cells()[index] > 0.0 {
                cost.cells_mut()[index] =
                    cost.cells()[index].min(self.evidence.background.cells()[index]);
            }
        });
    }

    /// Calls `visit` with every cell of a box's outline, its face and whether it is in the blurred rim.
    fn each_cell(&self, seen: LeaningBox, mut visit: impl FnMut(usize, Face, bool)) {
        let foot = self.foot();
        let frame = &self.evidence.frame;
        let bounds = seen.bounds(foot);
        let (left, upper) = frame.cell(Point::new(bounds.x0, bounds.y1));
        let (right, lower) = frame.cell(Point::new(bounds.x1, bounds.y0));
        let (width, height) = (self.evidence.features.width(), self.evidence.features.height());
        let first = |edge: f64| edge.ceil().max(0.0) as usize;
        let after = |edge: f64, length: usize| ((edge.floor() + 1.0).max(0.0) as usize).min(length);
        let columns: Vec<_> = (first(left)..after(right, width))
            .map(|column| {
                let x = column as f64;
                let leans = seen.leans_at_x(frame.point(x, 0.0).x, foot);
                (column, leans, (x - left).min(right - x))
            })
            .collect();
        for row in first(upper)..after(lower, height) {
            let y = row as f64;
            let leans = seen.leans_at_y(frame.point(0.0, y).y, foot);
            let within = (y - upper).min(lower - y);
            for &(column, across, depth) in &columns {
                if let Some(face) = seen.face_within(across, leans) {
                    visit(row * width + column, face, depth.min(within) < RIM);
                }
            }
        }
    }
}

/// The mean colour of a face and how many cells it has.
#[derive(Clone, Copy, Default)]
struct FaceColour {
    colour: Feature,
    weight: f32,
    cells: f32,
}

/// What it costs that a cell belongs to a face of a colour, 0 to 1.
pub(crate) fn face_cost(seen: Feature, colour: Feature) -> f32 {
    let square: f32 =
        (0..3).map(|part| ((seen[part] - colour[part]) / FACE_SPREAD[part]).powi(2)).sum();
    square.min(1.0)
}

fn difference(a: Feature, b: Feature) -> f32 {
    (0..3).map(|part| (a[part] - b[part]).powi(2)).sum::<f32>().sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::Arena;
    use crate::vision::PlanFrame;

    const FOOT: Point = Point::new(1.0, 0.5);

    /// A floor of colour 0 with boxes drawn on it: tops 1 darker, sides 1.6 darker.
    fn evidence(boxes: &[LeaningBox]) -> Evidence {
        let frame = PlanFrame::new(Arena { width: 2.0, height: 1.0 }, 100.0, 0.1);
        Evidence::drawn(frame, |point| {
            let dark = boxes.iter().find_map(|seen| seen.face(point, FOOT));
            dark.map_or(0.0, |face| if face == Face::Top { -1.0 } else { -1.6 })
        })
    }

    #[test]
    fn base_and_lean_are_found_from_a_rough_outline() {
        let truth = LeaningBox { base: Rect::new(1.4, 0.6, 1.6, 0.8), lean: 1.12 };
        let evidence = evidence(&[truth]);
        let found = Search { evidence: &evidence, foot: Some(FOOT), lamp: None }
            .run(&[Rect::new(1.38, 0.6, 1.7, 0.86)]);
        assert_eq!(found.len(), 1);
        let errors: Vec<f64> = <[f64; 4]>::from(found[0].base)
            .iter()
            .zip(<[f64; 4]>::from(truth.base))
            .map(|(a, b)| a - b)
            .collect();
        assert!(errors.iter().all(|error| error.abs() < 0.015), "{errors:?} {found:?}");
    }

    #[test]
    fn an_empty_floor_has_no_boxes() {
        let evidence = evidence(&[]);
        let search = Search { evidence: &evidence, foot: Some(FOOT), lamp: None };
        assert!(search.run(&[Rect::new(0.3, 0.3, 0.6, 0.6)]).is_empty());
    }
}
