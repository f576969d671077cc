//! The paper's grid method from the mini-matrix to the points of the path [Alghannam, Sec. III].

use super::LegTest;
use super::local_path::{Sight, entry_exit_points, length, shortest_over};
use super::shortest_path::{GlobalPath, shortest_path};
use super::tree::{NODE_LIMIT, PathTree, global_paths};
use crate::grid::{Area, EnlargedArena, LatticePoint, MiniMatrix, close_traps};

/// The stages of the grid method, for pictures and for the curious.
#[derive(Clone, Debug, PartialEq)]
pub struct GridStages {
    /// The grown obstacles and the shrunk border.
    pub arena: EnlargedArena,
    /// The mini-matrix with its terminals, before traps are closed.
    pub matrix: MiniMatrix,
    /// The same with the traps closed.
    pub closed: MiniMatrix,
    /// The traps, in the order of closing.
    pub traps: Vec<Area>,
    /// The tree of global paths, if the planner grew one.
    pub tree: Option<PathTree>,
    /// The global path that was chosen.
    pub global_path: GlobalPath,
    /// Its start, entry and exit points and goal.
    pub entry_exit_points: Vec<LatticePoint>,
    /// Those of them that are left when the useless ones are dropped.
    pub kept: Vec<LatticePoint>,
}

/// The grid method from the mini-matrix to the points of the path, over the tree of all global paths or
/// by Dijkstra's algorithm; `None` if the areas do not connect.
pub(super) fn grid_stages(
    arena: &EnlargedArena,
    test: &LegTest,
    matrix: &MiniMatrix,
    points: (LatticePoint, LatticePoint),
    grows_tree: bool,
) -> Option<GridStages> {
    let mut matrix = matrix.clone();
    let ends = (matrix.mark_terminal(points.0)?, matrix.mark_terminal(points.1)?);
    let mut closed = matrix.clone();
    let traps = close_traps(&mut closed);
    let mut sight = Sight::new(test);
    let local = |path: &GlobalPath| entry_exit_points(&closed, &path.areas, points.0, points.1);
    let (global_path, tree) = match grows_tree {
        false => (shortest_path(&closed, ends, points)?, None),
        true => {
            let tree = global_paths(&closed, ends, points, NODE_LIMIT);
            let shortened =
                |&at: &usize| length(&shortest_over(&local(&tree.path(at)), &mut sight));
            let lengths: Vec<f64> = tree.arrivals.iter().map(shortened).collect();
            let best = (0..lengths.len()).min_by(|&a, &b| lengths[a].total_cmp(&lengths[b]))?;
            (tree.path(tree.arrivals[best]), Some(tree))
        }
    };
    let entry_exit_points = local(&global_path);
    let kept = shortest_over(&entry_exit_points, &mut sight);
    let arena = arena.clone();
    Some(GridStages { arena, matrix, closed, traps, tree, global_path, entry_exit_points, kept })
}
