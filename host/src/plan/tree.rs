//! All global paths as a tree [Alghannam, Sec. III].
//!
//! The root is the start's area; the children of an area are the available areas around it, the one
//! nearest to the goal leftmost. A branch ends at the goal or where it is dead.
//!
//! Deviation: the number of simple paths grows exponentially with the areas (the paper's own scene
//! has more than 100 000), so two things bound the tree. A branch takes no detour: it never enters an
//! area that it could have entered from an earlier one than the last. And it stops growing at
//! [`NODE_LIMIT`] nodes. It grows best first, in rounds: in the first every area is left by its
//! shortest branch alone (this is Dijkstra's algorithm, and never cut short, so that a way is found if
//! there is one), in the second by its two shortest, then by four, and so on until nothing is left or
//! the limit is reached. What was not followed is counted.

use super::local_path::exit_point;
use super::ranked::Ranked;
use super::shortest_path::GlobalPath;
use crate::grid::{Area, LatticePoint, MiniMatrix};
use std::collections::BinaryHeap;

/// A tree with this many nodes grows no more once it holds the shortest branch to every area.
pub const NODE_LIMIT: usize = 20_000;

/// A node of the tree: an area as the end of one branch.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TreeNode {
    /// The area.
    pub area: Area,
    /// The node before it; the root is its own parent.
    pub parent: usize,
    /// Where the branch enters the area, units.
    pub entry: LatticePoint,
    /// The branch's local path up to there, units.
    pub length: f64,
}

/// The tree of global paths from the start's area.
#[derive(Clone, Debug, PartialEq)]
pub struct PathTree {
    /// The nodes; parents come before their children, the root first.
    pub nodes: Vec<TreeNode>,
    /// The nodes at which a branch reached the goal's area.
    pub arrivals: Vec<usize>,
    /// Branches that were not followed any further because of the limit.
    pub cut: usize,
}

impl PathTree {
    /// The global path that ends at `node`.
    pub fn path(&self, node: usize) -> GlobalPath {
        let mut areas: Vec<Area> = self.branch(node).map(|at| self.nodes[at].area).collect();
        areas.reverse();
        GlobalPath { areas }
    }

    /// The nodes from `node` back to the root.
    fn branch(&self, node: usize) -> impl Iterator<Item = usize> {
        let parent = |&at: &usize| (at != 0).then(|| self.nodes[at].parent);
        std::iter::successors(Some(node), parent)
    }
}

/// The tree of global paths without detours from the first of `ends` to the second, growing up to
/// `limit` nodes.
///
/// ```
/// use wmr::{geometry::Rect, grid::{LatticePoint, MiniMatrix, enlarge}, plan, scene::Scene};
/// let mut scene = Scene::new(1.0, 1.0);
/// scene.obstacles.push(Rect::new(0.4, 0.4, 0.6, 0.6).into()); // a ring of eight areas around it
/// let mut matrix = MiniMatrix::from_borders(&enlarge(&scene, 0.0)?)?;
/// let [start, goal] = [1000, 9000].map(|x| LatticePoint::new(x, 5000));
/// let ends = (matrix.mark_terminal(start).unwrap(), matrix.mark_terminal(goal).unwrap());
/// let tree = plan::global_paths(&matrix, ends, (start, goal), plan::NODE_LIMIT);
/// assert_eq!((tree.arrivals.len(), tree.cut), (2, 0)); // above the box and below it
/// # Ok::<(), wmr::grid::GridError>(())
/// ```
pub fn global_paths(
    matrix: &MiniMatrix,
    ends: (Area, Area),
    points: (LatticePoint, LatticePoint),
    limit: usize,
) -> PathTree {
    let root = TreeNode { area: ends.0, parent: 0, entry: points.0, length: 0.0 };
    let mut growth = Growth {
        tree: PathTree { nodes: vec![root], arrivals: Vec::new(), cut: 0 },
        left: vec![0; matrix.areas().count()],
        matrix,
        goal: (ends.1, points.1),
        limit,
    };
    let mut waiting = vec![Ranked { cost: 0.0, index: 0 }];
    let mut branches_per_area = 1;
    while !waiting.is_empty() && (branches_per_area == 1 || growth.tree.nodes.len() < limit) {
        waiting = growth.round(waiting, branches_per_area);
        branches_per_area *= 2;
    }
    growth.tree.cut = waiting.len();
    growth.tree
}

/// A tree while it grows.
struct Growth<'a> {
    tree: PathTree,
    /// By area, how many branches went on from it.
    left: Vec<usize>,
    matrix: &'a MiniMatrix,
    goal: (Area, LatticePoint),
    limit: usize,
}

impl Growth<'_> {
    /// Follows the `waiting` branches best first, from each area at most `per_area` in all; returns
    /// those that wait for the next round.
    fn round(&mut self, waiting: Vec<Ranked>, per_area: usize) -> Vec<Ranked> {
        let mut queue = BinaryHeap::from(waiting);
        let mut postponed = Vec::new();
        while let Some(branch) = queue.pop() {
            let area = self.tree.nodes[branch.index].area;
            if area == self.goal.0 {
                self.tree.arrivals.push(branch.index);
            } else if self.left[area.index()] == per_area
                || (per_area > 1 && self.tree.nodes.len() >= self.limit)
            {
                postponed.push(branch);
            } else {
                self.left[area.index()] += 1;
                queue.extend(self.children(branch.index));
            }
        }
        postponed
    }

    /// Adds the children of `node`, nearest to the goal first.
    fn children(&mut self, node: usize) -> Vec<Ranked> {
        let TreeNode { area, entry, length, .. } = self.tree.nodes[node];
        let is_new = |next: &Area| !self.is_detour(node, *next);
        let mut next: Vec<Area> = self.matrix.next_areas(area).filter(is_new).collect();
        let goal = self.goal.1;
        next.sort_by(|&a, &b| self.distance(a, goal).total_cmp(&self.distance(b, goal)));
        let first = self.tree.nodes.len();
        for area_after in next {
            let exit = exit_point(self.matrix, entry, area, area_after);
            let length = length + entry.distance(exit);
            self.tree.nodes.push(TreeNode { area: area_after, parent: node, entry: exit, length });
        }
        let ranked = |index: usize| Ranked { cost: self.tree.nodes[index].length, index };
        (first..self.tree.nodes.len()).map(ranked).collect()
    }

    /// Whether the branch that ends at `node` could have entered `next` before.
    fn is_detour(&self, node: usize, next: Area) -> bool {
        let visited =
            |area: Area| self.tree.branch(node).skip(1).any(|at| self.tree.nodes[at].area == area);
        visited(next) || self.matrix.next_areas(next).any(visited)
    }

    fn distance(&self, area: Area, goal: LatticePoint) -> f64 {
        self.matrix.rect(area).clamp(goal).distance(goal)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::grid::{EnlargedArena, LatticeRect};

    fn tree(boxes: &[[i32; 4]], limit: usize) -> PathTree {
        let boxes = boxes.iter().map(|&[a, b, c, d]| LatticeRect::new(a, b, c, d)).collect();
        let whole = LatticeRect::new(0, 0, 20, 20);
        let arena = EnlargedArena::new(whole, whole, boxes);
        let mut matrix = MiniMatrix::from_borders(&arena).unwrap();
        let (start, goal) = (LatticePoint::new(0, 0), LatticePoint::new(20, 20));
        let ends = (matrix.mark_terminal(start).unwrap(), matrix.mark_terminal(goal).unwrap());
        global_paths(&matrix, ends, (start, goal), limit)
    }

    const FOUR: [[i32; 4]; 4] = [[2, 2, 4, 4], [6, 7, 9, 9], [11, 3, 14, 5], [15, 12, 17, 16]];

    #[test]
    fn every_path_is_simple_and_no_two_are_equal() {
        let tree = tree(&FOUR[..2], 100_000);
        let mut paths: Vec<Vec<Area>> =
            tree.arrivals.iter().map(|&at| tree.path(at).areas).collect();
        for path in &paths {
            let mut areas = path.clone();
            areas.sort_unstable();
            areas.dedup();
            assert_eq!(areas.len(), path.len());
        }
        paths.sort();
        paths.dedup();
        assert_eq!((paths.len(), tree.cut), (tree.arrivals.len(), 0));
    }

    #[test]
    fn a_bounded_tree_still_holds_the_shortest_branch_and_counts_what_it_cut() {
        let shortest = |tree: &PathTree| {
            tree.arrivals.iter().map(|&at| tree.nodes[at].length).fold(f64::INFINITY, f64::min)
        };
        let large = shortest(&tree(&FOUR, 50_000));
        // The first limit is reached in the first round, the second one later.
        for limit in [10, 2000] {
            let small = tree(&FOUR, limit);
            assert!(small.cut > 0, "nothing was cut at {limit}");
            assert_eq!(shortest(&small), large);
        }
    }
}
