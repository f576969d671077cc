//! Convex pieces of the free floor and the portals between them: what the interval search runs on.
//!
//! The pieces may be the cells of the sweep or larger convex ones; the search cannot tell. A piece is
//! known by its portals alone, each as a robot in the piece sees it when it looks out: a right and a
//! left end. Lattice units.

use super::sweep::Slabs;
use crate::grid::LatticePoint;

/// One end of a portal.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(in crate::plan) struct PortalEnd {
    pub(in crate::plan) at: LatticePoint,
    /// The number of the box's corner that stands here, or [`NO_CORNER`].
    pub(in crate::plan) corner: u32,
}

/// The end of a portal at which no box's corner stands: there a shortest way never turns.
pub(in crate::plan) const NO_CORNER: u32 = u32::MAX;

impl PortalEnd {
    /// Whether a box's corner stands here.
    pub(in crate::plan) fn has_corner(&self) -> bool {
        self.corner != NO_CORNER
    }
}

/// A straight opening from one piece to the next.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(in crate::plan) struct Portal {
    pub(in crate::plan) right: PortalEnd,
    pub(in crate::plan) left: PortalEnd,
    /// The piece that it leads to.
    pub(in crate::plan) beyond: u32,
    /// Whether all that lies beyond is a dead end: only a way that ends there enters.
    pub(in crate::plan) is_dead_end: bool,
}

impl Portal {
    pub(in crate::plan) fn new(right: PortalEnd, left: PortalEnd, beyond: u32) -> Self {
        Self { right, left, beyond, is_dead_end: false }
    }

    /// Whether both openings lie on one vertical line: what looks in through one never sees the other.
    pub(in crate::plan) fn is_on_line_of(&self, entered: &Portal) -> bool {
        let x = entered.right.at.x;
        entered.left.at.x == x && self.right.at.x == x && self.left.at.x == x
    }

    /// Whether this is the same opening as `entered`, seen from the other side.
    pub(in crate::plan) fn is_back_of(&self, entered: &Portal) -> bool {
        self.right.at == entered.left.at && self.left.at == entered.right.at
    }
}

/// The pieces with their portals.
#[derive(Clone, Debug, Default)]
pub(in crate::plan) struct Mesh {
    /// The portals of piece `i` are `portals[first[i]..first[i + 1]]`.
    first: Vec<u32>,
    portals: Vec<Portal>,
    /// By piece: whether only a way that begins or ends there enters it.
    dead_ends: Vec<bool>,
    pub(in crate::plan) corners: usize,
}

impl Mesh {
    /// The mesh whose pieces are the cells of the sweep.
    pub(super) fn from_slabs(slabs: &Slabs) -> Self {
        let each = slabs.doors.iter().enumerate().flat_map(|(index, door)| {
            let end = |side: usize, y: i32| PortalEnd {
                at: LatticePoint::new(door.x, y),
                // At one point no two doors have a corner: each end can have its own number.
                corner: if door.corners[side] { (2 * index + side) as u32 } else { NO_CORNER },
            };
            let (low, high) = (end(0, door.y0), end(1, door.y1));
            let [left, right] = door.cells;
            [(left, Portal::new(low, high, right)), (right, Portal::new(high, low, left))]
        });
        Self::new(slabs.cells.len(), 2 * slabs.doors.len(), each)
    }

    /// The mesh of `pieces` pieces from their portals, each with the piece that it leads from.
    pub(in crate::plan) fn new(
        pieces: usize,
        corners: usize,
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
        let nowhere = PortalEnd { at: LatticePoint::new(0, 0), corner: NO_CORNER };
        let mut list = vec![Portal::new(nowhere, nowhere, 0); count];
        for (piece, portal) in portals {
            let place = &mut first[piece as usize + 1];
            list[*place as usize] = portal;
            *place += 1;
        }
        first.pop();
        let mut mesh = Self { first, portals: list, dead_ends: Vec::new(), corners };
        mesh.find_dead_ends();
        mesh
    }

    /// Marks pieces with a single portal, then those that have a single one left, and so on: the
    /// paper's un-useful areas.
    fn find_dead_ends(&mut self) {
        let pieces = self.pieces() as u32;
        let mut ways: Vec<u32> = self.first.windows(2).map(|pair| pair[1] - pair[0]).collect();
        self.dead_ends = vec![false; ways.len()];
        let mut waiting: Vec<u32> = (0..pieces).filter(|&piece| ways[piece as usize] < 2).collect();
        if waiting.is_empty() {
            return;
        }
        while let Some(piece) = waiting.pop() {
            self.dead_ends[piece as usize] = true;
            for portal in &self.portals[self.range(piece)] {
                let next = portal.beyond as usize;
                ways[next] = ways[next].saturating_sub(1);
                if ways[next] == 1 && !self.dead_ends[next] {
                    waiting.push(portal.beyond);
                }
            }
        }
        let mut into = Vec::new();
        for piece in (0..pieces).filter(|&piece| self.dead_ends[piece as usize]) {
            into.extend(self.portals[self.range(piece)].iter().map(|portal| portal.beyond));
            for neighbour in into.drain(..) {
                let range = self.range(neighbour);
                let ways = self.portals[range].iter_mut().filter(|way| way.beyond == piece);
                ways.for_each(|way| way.is_dead_end = true);
            }
        }
    }

    /// Whether only a way that begins or ends there enters `piece`.
    pub(in crate::plan) fn is_dead_end(&self, piece: u32) -> bool {
        self.dead_ends[piece as usize]
    }

    pub(in crate::plan) fn pieces(&self) -> usize {
        self.first.len() - 1
    }

    /// The portals out of `piece`.
    pub(in crate::plan) fn portals(&self, piece: u32) -> &[Portal] {
        &self.portals[self.range(piece)]
    }

    /// The numbers of the portals out of `piece`.
    pub(in crate::plan) fn range(&self, piece: u32) -> std::ops::Range<usize> {
        self.first[piece as usize] as usize..self.first[piece as usize + 1] as usize
    }

    pub(in crate::plan) fn portal(&self, number: usize) -> &Portal {
        &self.portals[number]
    }

    /// By piece, the number of its component: pieces of different components are not connected.
    ///
    /// Pieces point to one with a lower number that they are connected with; neighbours have near
    /// numbers, so that this walks through memory in order where a search would jump.
    pub(in crate::plan) fn components(&self) -> Vec<u32> {
        let mut lower: Vec<u32> = (0..self.pieces() as u32).collect();
        for piece in 0..self.pieces() as u32 {
            for portal in self.portals(piece).iter().filter(|portal| portal.beyond < piece) {
                let (a, b) = (lowest(&mut lower, piece), lowest(&mut lower, portal.beyond));
                lower[a.max(b) as usize] = a.min(b);
            }
        }
        for piece in 0..lower.len() {
            lower[piece] = lower[lower[piece] as usize];
        }
        lower
    }
}

/// The lowest piece known to be connected with `piece`; halves the way there.
fn lowest(lower: &mut [u32], mut piece: u32) -> u32 {
    while lower[piece as usize] != piece {
        let further = lower[lower[piece as usize] as usize];
        lower[piece as usize] = further;
        piece = further;
    }
    piece
}

#[cfg(test)]
mod tests {
    use super::super::sweep::sweep;
    use super::*;
    use crate::grid::{EnlargedArena, LatticeRect};

    fn mesh(boxes: Vec<LatticeRect>) -> Mesh {
        let inside = LatticeRect::new(0, 0, 12, 12);
        Mesh::from_slabs(&sweep(&EnlargedArena::new(inside, inside, boxes)))
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
