//! What boxes and a lamp explain of a picture together, and what they leave.
//!
//! All in cells of the evidence: a cell that is surely no background and that nothing explains counts 1.

use super::evidence::Evidence;
use super::projection::LeaningBox;
use super::search::{CELL_CHARGE, SHADOW_DOUBT, Search, face_cost};
use crate::vision::image::{Raster, regions};

/// What a box costs when whole explanations are compared, in least gains.
const BOX_CHARGE: f32 = 8.0;

/// How much of the floor is in shadow, square metres.
pub(super) fn shaded_area(evidence: &Evidence) -> f64 {
    let shaded: f32 = evidence.shade.cells().iter().map(|shade| shade.max(0.0)).sum();
    f64::from(shaded) / evidence.frame.scale.powi(2)
}

impl Search<'_> {
    /// The cost of every cell before any box: what is not floor, and shadow that nothing casts.
    pub(crate) fn unexplained(&self) -> Raster<f32> {
        let mut cost = self.evidence.background.clone();
        if self.lamp.is_some() {
            self.doubt_shadow(&mut cost);
        }
        cost
    }

    /// Raises the cost of shadow that nothing is known to cast.
    fn doubt_shadow(&self, cost: &mut Raster<f32>) {
        for (cost, shade) in cost.cells_mut().iter_mut().zip(self.evidence.shade.cells()) {
            *cost = cost.max(SHADOW_DOUBT * shade.max(0.0));
        }
    }

    /// What boxes explain together.
    pub(crate) fn explained(&self, found: &[LeaningBox]) -> f32 {
        let mut cost = self.unexplained();
        let mut sum = 0.0;
        for &seen in found {
            sum += self.gain(seen, &cost) - self.least_gain() as f32;
            self.explain(&mut cost, seen);
        }
        sum
    }

    /// What outlines of any shape would explain beyond boxes: all that is connected and of one colour.
    pub(crate) fn explained_by_outlines(&self, found: &[LeaningBox]) -> f32 {
        let mut cost = self.unexplained();
        found.iter().for_each(|&seen| self.explain(&mut cost, seen));
        let (weight, features) = (self.evidence.weight.cells(), self.evidence.features.cells());
        let beyond = |patch: &Vec<usize>| {
            let all: f32 = patch.iter().map(|&cell| weight[cell]).sum();
            let mean = [0, 1, 2].map(|part| {
                let sum: f32 = patch.iter().map(|&cell| weight[cell] * features[cell][part]).sum();
                sum / all.max(1.0)
            });
            let saved = |&cell: &usize| {
                let left = face_cost(features[cell], mean) + CELL_CHARGE;
                weight[cell] * (cost.cells()[cell] - left)
            };
            patch.iter().map(saved).sum::<f32>().max(0.0)
        };
        regions(&self.evidence.foreign()).iter().map(beyond).sum()
    }

    /// What boxes and the lamp leave unexplained, in cells, with a charge for every box.
    pub(crate) fn left_over(&self, found: &[LeaningBox]) -> f32 {
        let mut cost = self.evidence.background.clone();
        self.doubt_shadow(&mut cost);
        found.iter().for_each(|&seen| self.explain(&mut cost, seen));
        let weighted = cost.cells().iter().zip(self.evidence.weight.cells());
        let left: f32 = weighted.map(|(cost, weight)| cost * weight).sum();
        left + found.len() as f32 * BOX_CHARGE * self.least_gain() as f32
    }

    /// The share of the shadow that neither lies in the outline of a box nor is cast by one.
    pub(crate) fn unexplained_shade(&self, found: &[LeaningBox]) -> f32 {
        let mut cost = self.unexplained();
        found.iter().for_each(|&seen| self.explain(&mut cost, seen));
        let (mut left, mut all) = (0.0, 0.0);
        for (shade, cost) in self.evidence.shade.cells().iter().zip(cost.cells()) {
            all += shade.max(0.0);
            left += if *cost < SHADOW_DOUBT * shade { 0.0 } else { shade.max(0.0) };
        }
        left / all.max(1.0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::{Arena, Rect};
    use crate::vision::plan_view::PlanFrame;

    #[test]
    fn a_box_leaves_less_than_none_and_half_a_box_less_than_a_whole_one_explains() {
        let drawn = Rect::new(0.5, 0.3, 0.9, 0.6);
        let arena = Arena { width: 2.0, height: 1.0 };
        let frame = PlanFrame::new(arena, 100.0, 0.1);
        let evidence =
            Evidence::drawn(frame, |point| if drawn.contains(point) { -1.0 } else { 0.0 });
        let search = Search { evidence: &evidence, foot: None, lamp: None };
        let left = |rect: Rect| search.left_over(&[LeaningBox { base: rect, lean: 1.0 }]);
        // 0.4 × 0.3 m are 1200 cells; the charge is 8 times 0.001 m².
        assert!((search.left_over(&[]) - 1200.0).abs() < 1.0);
        assert!((left(drawn) - 80.0).abs() < 1.0, "{}", left(drawn));
        let half = left(Rect::new(0.5, 0.3, 0.7, 0.6));
        assert!((half - 680.0).abs() < 35.0, "{half}");
    }

    #[test]
    fn an_outline_of_one_colour_explains_an_ell_beyond_its_box_and_one_of_two_colours_does_not() {
        let (foot, bar) = (Rect::new(0.5, 0.3, 0.9, 0.5), Rect::new(0.5, 0.5, 0.6, 0.8));
        let arena = Arena { width: 2.0, height: 1.0 };
        let beyond = |of_bar: f32| {
            let frame = PlanFrame::new(arena, 100.0, 0.1);
            let evidence = Evidence::drawn(frame, |point| match point {
                _ if foot.contains(point) => -1.0,
                _ if bar.contains(point) => of_bar,
                _ => 0.0,
            });
            let search = Search { evidence: &evidence, foot: None, lamp: None };
            search.explained_by_outlines(&[LeaningBox { base: foot, lean: 1.0 }])
        };
        // The bar has 300 cells; each of all 1100 costs what a cell of a box does.
        assert!((beyond(-1.0) - (300.0 - 1100.0 * CELL_CHARGE)).abs() < 5.0, "{}", beyond(-1.0));
        assert!(beyond(-2.2) < 1.0, "{}", beyond(-2.2));
    }
}
