//! The border of the free floor: where a robot's centre may be, what several inflated shapes leave.
//!
//! Contours may overlap, touch, lie in one another and reach beyond the arena. `i_overlay` cuts them
//! where they cross and says what lies on either side of each piece; a crossing is rounded to the
//! lattice, so a contour moves by a unit or two at most (the planner's test of every leg looks at the
//! shapes themselves and would notice). Lattice units.

use crate::grid::{LatticePoint, LatticeRect};
use i_overlay::core::fill_rule::FillRule;
use i_overlay::core::overlay::{IntOverlayOptions, Overlay, ShapeType};
use i_overlay::i_float::int::point::IntPoint;
use i_overlay::vector::edge::{CLIP_LEFT, CLIP_RIGHT, SUBJ_LEFT, SUBJ_RIGHT};

/// A piece of the border between free floor and the rest. The pieces meet at their ends alone.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct BorderEdge {
    /// The end that comes first by x, then by y.
    pub(super) from: LatticePoint,
    /// The other end.
    pub(super) to: LatticePoint,
    /// Whether the floor above it is free (to the left of a vertical one); if not, that below it is.
    pub(super) is_free_above: bool,
}

/// The border of what is left of `inside` outside of all `contours`, in no particular order.
pub(super) fn border_of_free_space(
    inside: LatticeRect,
    contours: &[Vec<LatticePoint>],
) -> Vec<BorderEdge> {
    let corners: usize = contours.iter().map(Vec::len).sum();
    let mut overlay = Overlay::<i32>::new_custom(
        corners + 4,
        IntOverlayOptions::keep_all_points(),
        Default::default(),
    );
    let point = |at: &LatticePoint| IntPoint::new(at.x, at.y);
    overlay.add_path_iter(inside.corners().iter().map(point), ShapeType::Subject);
    for contour in contours {
        overlay.add_path_iter(contour.iter().map(point), ShapeType::Clip);
    }
    let edges = overlay.build_separate_vectors(FillRule::NonZero);
    let border = edges.iter().filter_map(|edge| {
        let (a, b) = (LatticePoint::new(edge.a.x, edge.a.y), LatticePoint::new(edge.b.x, edge.b.y));
        let is_free = |arena: u8, shape: u8| edge.fill & arena != 0 && edge.fill & shape == 0;
        let (left, right) = (is_free(SUBJ_LEFT, CLIP_LEFT), is_free(SUBJ_RIGHT, CLIP_RIGHT));
        let (from, to, above) = if a < b { (a, b, left) } else { (b, a, right) };
        (left != right).then_some(BorderEdge { from, to, is_free_above: above })
    });
    border.collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn border(contours: &[&[(i32, i32)]]) -> Vec<BorderEdge> {
        let contours: Vec<Vec<LatticePoint>> = contours
            .iter()
            .map(|contour| contour.iter().map(|&(x, y)| LatticePoint::new(x, y)).collect())
            .collect();
        border_of_free_space(LatticeRect::new(0, 0, 100, 100), &contours)
    }

    /// Twice the area that the border encloses, by the shoelace formula.
    fn doubled_area(border: &[BorderEdge]) -> i64 {
        let part = |edge: &BorderEdge| {
            let (a, b) = (edge.from, edge.to);
            let cross = i64::from(a.x) * i64::from(b.y) - i64::from(b.x) * i64::from(a.y);
            if edge.is_free_above { cross } else { -cross }
        };
        border.iter().map(part).sum()
    }

    #[test]
    fn overlapping_nested_and_outer_shapes_leave_their_union_s_outside() {
        let square: &[(i32, i32)] = &[(10, 10), (30, 10), (30, 30), (10, 30)];
        let over: &[(i32, i32)] = &[(20, 20), (40, 20), (40, 40), (20, 40)];
        let nested: &[(i32, i32)] = &[(12, 12), (14, 12), (13, 14)];
        let across: &[(i32, i32)] = &[(90, 50), (120, 50), (120, 60), (90, 60)];
        let area = doubled_area(&border(&[square, over, nested, across]));
        assert_eq!(area, 2 * (10_000 - 400 - 400 + 100 - 100));
    }

    #[test]
    fn shapes_that_share_an_edge_have_no_border_there() {
        let left: &[(i32, i32)] = &[(10, 10), (30, 10), (30, 30), (10, 30)];
        let right: &[(i32, i32)] = &[(30, 10), (50, 20), (30, 30)];
        let border = border(&[left, right]);
        let shared = |edge: &&BorderEdge| edge.from.x == 30 && edge.to.x == 30;
        assert_eq!(border.iter().find(shared), None);
        assert_eq!(doubled_area(&border), 2 * (10_000 - 400 - 200));
    }
}
