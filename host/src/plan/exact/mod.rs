//! The exact shortest path among the grown boxes: cells, portals, interval search.
//!
//! ```text
//! EnlargedArena ─► sweep ─► Mesh ─► Search::shortest ─► points
//!                  cells    portals  cones, exact signs
//! ```
//! "Exact" is meant for the box-enlarged arena: obstacles keep their square corners when they grow,
//! as in the paper. Lattice units.

mod mesh;
mod search;
mod sweep;
mod view;

use super::box_index::BoxIndex;
use crate::grid::{EnlargedArena, LatticePoint, LatticeRect};
use mesh::Mesh;
use search::{Query, Search};
use sweep::{Slabs, sweep};

/// An arena made ready for exact queries.
#[derive(Clone, Debug)]
pub(super) struct Exact {
    cells: Vec<LatticeRect>,
    mesh: Mesh,
    /// By cell.
    components: Vec<u32>,
    /// The cells by place, once many queries are expected.
    index: Option<BoxIndex>,
    search: Search,
}

impl Exact {
    pub(super) fn new(arena: &EnlargedArena) -> Self {
        let slabs = sweep(arena);
        let mesh = Mesh::from_slabs(&slabs);
        let components = mesh.components();
        let Slabs { cells, .. } = slabs;
        Self { cells, mesh, components, index: None, search: Search::default() }
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

    /// Whether a way leads from one free point to the other.
    pub(super) fn connects(&self, start: LatticePoint, goal: LatticePoint) -> bool {
        let (from, to) = (self.cells_at(start), self.cells_at(goal));
        self.are_connected(&from, &to)
    }

    /// The points of the shortest way, start and goal included; `None` if there is none.
    pub(super) fn shortest(
        &mut self,
        start: LatticePoint,
        goal: LatticePoint,
    ) -> Option<Vec<LatticePoint>> {
        let (from, to) = (self.cells_at(start), self.cells_at(goal));
        if !self.are_connected(&from, &to) {
            return None;
        }
        let query = Query { start, goal, start_pieces: &from, goal_pieces: &to };
        self.search.shortest(&self.mesh, &query)
    }

    fn are_connected(&self, from: &[u32], to: &[u32]) -> bool {
        let component = |cell: &u32| self.components[*cell as usize];
        from.iter().any(|a| to.iter().any(|b| component(a) == component(b)))
    }

    /// The cells that hold `point`, edges included.
    fn cells_at(&self, point: LatticePoint) -> Vec<u32> {
        let holds = |cell: &usize| self.cells[*cell].contains(point);
        match &self.index {
            Some(index) => index.at(point).filter(holds).map(|cell| cell as u32).collect(),
            None => (0..self.cells.len()).filter(holds).map(|cell| cell as u32).collect(),
        }
    }
}

#[cfg(test)]
mod oracle;
#[cfg(test)]
mod tests;
