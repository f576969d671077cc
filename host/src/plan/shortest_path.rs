//! The shortest global path by Dijkstra's algorithm with a priority queue [Alghannam, Sec. III].
//!
//! Deviation: the paper names no edge cost. A step's cost is the length of the local path across the
//! area, which depends on where the path entered it; the states are therefore pairs of area and
//! entry point. What comes out is the path that is shortest *before* useless points are dropped.

use super::local_path::exit_point;
use super::ranked::Ranked;
use crate::grid::{Area, LatticePoint, MiniMatrix};
use std::collections::{BinaryHeap, HashSet};

/// A sequence of neighbouring areas from the start's to the goal's.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct GlobalPath {
    /// The areas, each once.
    pub areas: Vec<Area>,
}

/// An area reached at one entry point.
struct Step {
    area: Area,
    entry: LatticePoint,
    parent: usize,
    length: f64,
}

/// The global path of least local length from the start's to the goal's area, or `None` if the
/// areas do not connect.
///
/// `ends` are the areas, `points` the points of start and goal; the example is at
/// [`super::entry_exit_points`].
pub fn shortest_path(
    matrix: &MiniMatrix,
    ends: (Area, Area),
    points: (LatticePoint, LatticePoint),
) -> Option<GlobalPath> {
    let (start, goal) = points;
    let mut steps = vec![Step { area: ends.0, entry: start, parent: 0, length: 0.0 }];
    let mut queue = BinaryHeap::from([Ranked { cost: 0.0, index: 0 }]);
    let mut settled = HashSet::new();
    let mut best: Option<(f64, usize)> = None;
    while let Some(Ranked { cost, index }) = queue.pop() {
        if best.is_some_and(|(length, _)| length <= cost) {
            break;
        }
        let Step { area, entry, length, .. } = steps[index];
        if !settled.insert((area, entry)) {
            continue;
        }
        if area == ends.1 {
            let whole = length + entry.distance(goal);
            if best.is_none_or(|(length, _)| whole < length) {
                best = Some((whole, index));
            }
            continue;
        }
        for next in matrix.next_areas(area) {
            let exit = exit_point(matrix, entry, area, next);
            let length = length + entry.distance(exit);
            if !settled.contains(&(next, exit)) {
                queue.push(Ranked { cost: length, index: steps.len() });
                steps.push(Step { area: next, entry: exit, parent: index, length });
            }
        }
    }
    best.map(|(_, last)| trace(&steps, last))
}

/// The areas from the first step to `last`. A shortest way enters no area twice: its points in one
/// area can be joined inside it.
fn trace(steps: &[Step], last: usize) -> GlobalPath {
    let mut areas = vec![steps[last].area];
    let mut at = last;
    while at != 0 {
        at = steps[at].parent;
        areas.push(steps[at].area);
    }
    areas.reverse();
    GlobalPath { areas }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::grid::{EnlargedArena, LatticeRect};

    fn numbers(path: &GlobalPath) -> Vec<usize> {
        path.areas.iter().map(|area| area.number()).collect()
    }

    fn between(boxes: &[[i32; 4]], start: (i32, i32), goal: (i32, i32)) -> Option<Vec<usize>> {
        let boxes = boxes.iter().map(|&[a, b, c, d]| LatticeRect::new(a, b, c, d)).collect();
        let whole = LatticeRect::new(0, 0, 9, 9);
        let arena = EnlargedArena::new(whole, whole, boxes);
        let mut matrix = MiniMatrix::from_borders(&arena).unwrap();
        let [start, goal] = [start, goal].map(|(x, y)| LatticePoint::new(x, y));
        let ends = (matrix.mark_terminal(start).unwrap(), matrix.mark_terminal(goal).unwrap());
        shortest_path(&matrix, ends, (start, goal)).as_ref().map(numbers)
    }

    #[test]
    fn the_way_round_a_box_takes_the_shorter_side() {
        // Areas 1 2 3 / 4 box 6 / 7 8 9; from 4 to 6 above the middle the upper side is shorter.
        assert_eq!(between(&[[3, 3, 6, 6]], (1, 5), (8, 5)), Some(vec![4, 2, 6]));
        assert_eq!(between(&[[3, 3, 6, 6]], (1, 4), (8, 4)), Some(vec![4, 8, 6]));
    }

    #[test]
    fn a_walled_goal_has_no_path() {
        assert_eq!(between(&[[3, 0, 4, 9]], (1, 1), (8, 8)), None);
        assert_eq!(between(&[[0, 0, 4, 4], [4, 4, 9, 9]], (1, 5), (5, 1)), None, "corner touch");
    }

    #[test]
    fn start_and_goal_in_one_area_need_no_other() {
        assert_eq!(between(&[], (1, 1), (8, 8)), Some(vec![1]));
    }
}
