//! The exact shortest path among the grown boxes: cells, portals, interval search.
//!
//! ```text
//!                                 ┌► Search::shortest ─► points      the first queries
//! EnlargedArena ─► sweep ─► Mesh ─┤  cones, exact signs
//!                  cells   portals└► Roads::shortest ─► points       those that follow
//!                                    corners in sight of corners
//! ```
//! "Exact" is meant for the box-enlarged arena: obstacles keep their square corners when they grow,
//! as in the paper. Lattice units.

mod mesh;
mod roads;
mod search;
mod sight;
mod sweep;
mod view;

use super::box_index::BoxIndex;
use crate::grid::{EnlargedArena, LatticePoint, LatticeRect};
use roads::Roads;

pub(super) use mesh::{Mesh, NO_CORNER, Portal, PortalEnd};
pub(super) use search::{Query, Search};
use sweep::{Slabs, sweep};

/// From this query on, roads are drawn and used. The first queries that come to a corner pay for its
/// roads: on arenas of 100 to 10 000 boxes some sixty queries cost as much with them as with cones alone.
const ROADS_FROM: u32 = 64;

/// An arena made ready for exact queries.
#[derive(Clone, Debug)]
pub(super) struct Exact {
    cells: Vec<LatticeRect>,
    mesh: Mesh,
    /// By cell.
    components: Vec<u32>,
    /// The cells by place, once many queries are expected.
    index: Option<BoxIndex>,
    /// Once many queries have been asked.
    roads: Option<Box<Roads>>,
    queries: u32,
    search: Search,
}

impl Exact {
    pub(super) fn new(arena: &EnlargedArena) -> Self {
        let slabs = sweep(arena);
        let mesh = Mesh::from_slabs(&slabs);
        let components = mesh.components();
        let Slabs { cells, .. } = slabs;
        Self {
            cells,
            mesh,
            components,
            index: None,
            roads: None,
            queries: 0,
            search: Search::default(),
        }
    }

    /// The free floor as rectangles, edges included.
    pub(super) fn free(&self) -> &[LatticeRect] {
        &self.cells
    }

    /// Whether the robot's centre may be at `point`.
    pub(super) fn holds(&self, point: LatticePoint) -> bool {
        match &self.index {
            Some(index) => index.at(point).any(|cell| self.cells[cell].contains(point)),
            None => self.cells.iter().any(|cell| cell.contains(point)),
        }
    }

    /// Makes what pays from the second query on.
    pub(super) fn expect_many(&mut self, inside: LatticeRect) {
        if self.index.is_none() {
            self.index = Some(BoxIndex::new(inside, &self.cells));
        }
    }

    /// From now on queries go by roads.
    fn lay_roads(&mut self) {
        self.roads.get_or_insert_with(|| Box::new(Roads::new(&self.mesh, &self.cells)));
    }

    /// Whether a way leads from one free point to the other.
    pub(super) fn connects(&self, start: LatticePoint, goal: LatticePoint) -> bool {
        self.are_connected(self.cells_at(start).list(), self.cells_at(goal).list())
    }

    /// The points of the shortest way, start and goal included; `None` if there is none.
    pub(super) fn shortest(
        &mut self,
        start: LatticePoint,
        goal: LatticePoint,
    ) -> Option<Vec<LatticePoint>> {
        let (from, to) = (self.cells_at(start), self.cells_at(goal));
        let (start_pieces, goal_pieces) = (from.list(), to.list());
        if !self.are_connected(start_pieces, goal_pieces) {
            return None;
        }
        self.queries = self.queries.saturating_add(1);
        if self.queries == ROADS_FROM {
            self.lay_roads();
        }
        if let Some(roads) = &mut self.roads {
            return roads.shortest(&self.mesh, (start, start_pieces), (goal, goal_pieces));
        }
        self.search.shortest(&self.mesh, &Query { start, goal, start_pieces, goal_pieces })
    }

    fn are_connected(&self, from: &[u32], to: &[u32]) -> bool {
        let component = |cell: &u32| self.components[*cell as usize];
        from.iter().any(|a| to.iter().any(|b| component(a) == component(b)))
    }

    /// The cells that hold `point`, edges included.
    fn cells_at(&self, point: LatticePoint) -> Holding {
        let mut holding = Holding::default();
        let mut look_at = |cell: usize| {
            if self.cells[cell].contains(point) {
                holding.add(cell as u32);
            }
        };
        match &self.index {
            Some(index) => index.at(point).for_each(look_at),
            None => (0..self.cells.len()).for_each(&mut look_at),
        }
        holding
    }
}

/// The cells that hold one point: one, or two that share the edge on which it lies.
#[derive(Clone, Copy, Debug, Default)]
struct Holding {
    cells: [u32; 2],
    count: usize,
}

impl Holding {
    /// Of free intervals of one x the ends never touch, so a third cell cannot hold the point.
    fn add(&mut self, cell: u32) {
        if let Some(place) = self.cells.get_mut(self.count) {
            *place = cell;
            self.count += 1;
        }
    }

    fn list(&self) -> &[u32] {
        &self.cells[..self.count]
    }
}

#[cfg(test)]
mod oracle;
#[cfg(test)]
mod tests;
