//! Convex pieces of the free floor and the portals between them: what the interval search runs on.
//!
//! The pieces may be the cells of the sweep or larger convex ones; the search cannot tell. A piece is
//! known by its portals alone, each as a robot in the piece sees it when it looks out: a right and a
//! left end. Lattice units.

use super::sweep::Slabs;
use crate::grid::LatticePoint;

/// One end of a portal.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct PortalEnd {
    pub(super) at: LatticePoint,
    /// The same for every portal that ends here, if a box's corner stands here.
    pub(super) vertex: u32,
    /// Whether a box's corner stands here: only there a shortest way turns.
    pub(super) is_corner: bool,
}

/// A straight opening from one piece to the next.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Portal {
    pub(super) right: PortalEnd,
    pub(super) left: PortalEnd,
    /// The piece that it leads to.
    pub(super) beyond: u32,
}

/// The pieces with their portals.
#[derive(Clone, Debug, Default)]
pub(super) struct Mesh {
    /// The portals of piece `i` are `portals[first[i]..first[i + 1]]`.
    first: Vec<u32>,
    portals: Vec<Portal>,
    pub(super) vertices: usize,
}

impl Mesh {
    /// The mesh whose pieces are the cells of the sweep.
    pub(super) fn from_slabs(slabs: &Slabs) -> Self {
        let each = slabs.doors.iter().enumerate().flat_map(|(index, door)| {
            let end = |side: usize, y: i32| PortalEnd {
                at: LatticePoint::new(door.x, y),
                // At one point no two doors have a corner: each end can have its own number.
                vertex: (2 * index + side) as u32,
                is_corner: door.corners[side],
            };
            let (low, high) = (end(0, door.y0), end(1, door.y1));
            let [left, right] = door.cells;
            [
                (left, Portal { right: low, left: high, beyond: right }),
                (right, Portal { right: high, left: low, beyond: left }),
            ]
        });
        Self::new(slabs.cells.len(), 2 * slabs.doors.len(), each)
    }

    /// The mesh of `pieces` pieces from their portals, each with the piece that it leads from.
    pub(super) fn new(
        pieces: usize,
        vertices: usize,
        portals: impl Iterator<Item = (u32, Portal)> + Clone,
    ) -> Self {
        let mut first = vec![0_u32; pieces + 2];
        let mut count = 0;
        for (piece, _) in portals.clone() {
            first[piece as usize + 2] += 1;
            count += 1;
        }
        for index in 2..first.len() {
            first[index] += first[index - 1];
        }
        let nowhere = PortalEnd { at: LatticePoint::new(0, 0), vertex: 0, is_corner: false };
        let mut list = vec![Portal { right: nowhere, left: nowhere, beyond: 0 }; count];
        for (piece, portal) in portals {
            let place = &mut first[piece as usize + 1];
            list[*place as usize] = portal;
            *place += 1;
        }
        first.pop();
        Self { first, portals: list, vertices }
    }

    pub(super) fn pieces(&self) -> usize {
        self.first.len() - 1
    }

    /// The portals out of `piece`.
    pub(super) fn portals(&self, piece: u32) -> &[Portal] {
        let piece = piece as usize;
        &self.portals[self.first[piece] as usize..self.first[piece + 1] as usize]
    }

    /// By piece, the number of its component: pieces of different components are not connected.
    pub(super) fn components(&self) -> Vec<u32> {
        const UNSEEN: u32 = u32::MAX;
        let mut component = vec![UNSEEN; self.pieces()];
        let mut waiting = Vec::new();
        let mut count = 0;
        for piece in 0..self.pieces() as u32 {
            if component[piece as usize] != UNSEEN {
                continue;
            }
            component[piece as usize] = count;
            waiting.push(piece);
            while let Some(at) = waiting.pop() {
                for portal in self.portals(at) {
                    if component[portal.beyond as usize] == UNSEEN {
                        component[portal.beyond as usize] = count;
                        waiting.push(portal.beyond);
                    }
                }
            }
            count += 1;
        }
        component
    }
}

#[cfg(test)]
mod tests {
    use super::super::sweep::sweep;
    use super::*;
    use crate::grid::{EnlargedArena, LatticeRect};

    fn mesh(boxes: Vec<LatticeRect>) -> Mesh {
        let inside = LatticeRect::new(0, 0, 12, 12);
        Mesh::from_slabs(&sweep(&EnlargedArena { border: inside, inside, boxes }))
    }

    #[test]
    fn a_portal_s_right_end_is_to_the_right_for_who_looks_out() {
        let mesh = mesh(vec![LatticeRect::new(3, 4, 6, 7)]);
        let out_of_the_first = mesh.portals(0)[0];
        assert_eq!(out_of_the_first.beyond, 1);
        assert_eq!(out_of_the_first.right.at, LatticePoint::new(3, 0));
        assert_eq!(out_of_the_first.left.at, LatticePoint::new(3, 4));
        let back = mesh.portals(1).iter().find(|portal| portal.beyond == 0).unwrap();
        assert_eq!((back.right, back.left), (out_of_the_first.left, out_of_the_first.right));
    }

    #[test]
    fn a_wall_makes_two_components() {
        let wall = LatticeRect::new(5, 0, 6, 12);
        assert_eq!(mesh(vec![wall]).components(), [0, 1]);
        assert_eq!(mesh(vec![]).components(), [0]);
    }
}
