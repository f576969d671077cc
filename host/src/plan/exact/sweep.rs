//! The free floor as O(N) rectangular cells: the paper's areas with each column merged.
//!
//! A vertical line sweeps over the grown boxes from left to right and knows how many boxes cover
//! each stretch of it. A stretch covered by none is free; it becomes a cell that lasts until its ends
//! change. All boxes that begin or end at one x are taken together, so a box that ends where another
//! begins leaves no gap. N boxes make at most 3N + 1 cells, where the mini-matrix has (2N + 1)² areas.
//!
//! Two cells that share a piece of a vertical edge are joined by a door. A door has a width: cells
//! that touch in a point alone are not joined, so nothing squeezes between touching boxes. Lattice units.

use crate::grid::{EnlargedArena, LatticeRect};

/// Two neighbouring cells and the piece of the edge that they share.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Door {
    /// The cell to the left and the cell to the right.
    pub(super) cells: [u32; 2],
    pub(super) x: i32,
    pub(super) y0: i32,
    pub(super) y1: i32,
    /// Whether a box's corner stands at the lower and at the upper end: only there a shortest way turns.
    pub(super) corners: [bool; 2],
}

/// The free floor cut into cells.
#[derive(Clone, Debug, Default)]
pub(super) struct Slabs {
    pub(super) cells: Vec<LatticeRect>,
    pub(super) doors: Vec<Door>,
}

/// Cuts what is free of `arena` into cells.
pub(super) fn sweep(arena: &EnlargedArena) -> Slabs {
    let inside = arena.inside;
    let events = events(arena);
    let capacity = 3 * arena.boxes.len() + 1;
    let mut sweep = Sweep {
        coverage: Coverage::new(inside),
        open: Vec::new(),
        slabs: Slabs {
            cells: Vec::with_capacity(capacity),
            doors: Vec::with_capacity(capacity * 4 / 3),
        },
        before: Vec::new(),
        after: Vec::new(),
    };
    let mut changed: Vec<(i32, i32)> = Vec::new();
    let mut groups = events.chunk_by(|a, b| a.x == b.x).peekable();
    if let Some(first) = groups.next_if(|group| group[0].x == inside.x0) {
        first.iter().for_each(|event| sweep.coverage.apply(event));
    }
    sweep.replace(inside.x0, Affected { range: (inside.y0, inside.y1), first: 0, step: 0 });
    for group in groups.take_while(|group| group[0].x < inside.x1) {
        group.iter().for_each(|event| sweep.coverage.apply(event));
        changed.clear();
        changed.extend(group.iter().map(|event| (event.y0, event.y1)));
        changed.sort_unstable();
        let mut done = i32::MIN;
        for &range in &changed {
            // What the ranges before have already led to needs no second look.
            if range.1 > done {
                let affected = sweep.affected(range);
                sweep.replace(group[0].x, affected);
                done = affected.range.1;
            }
        }
    }
    for cell in sweep.open {
        sweep.slabs.cells[cell.index as usize].x1 = inside.x1;
    }
    sweep.slabs
}

/// A box begins or ends.
#[derive(Clone, Copy, Debug)]
struct Event {
    x: i32,
    y0: i32,
    y1: i32,
    /// +1 where the box begins, −1 where it ends.
    change: i32,
}

fn events(arena: &EnlargedArena) -> Vec<Event> {
    let mut events = Vec::with_capacity(2 * arena.boxes.len());
    for grown in &arena.boxes {
        let LatticeRect { x0, y0, x1, y1 } = grown.intersection(arena.inside);
        if x0 < x1 && y0 < y1 {
            events.push(Event { x: x0, y0, y1, change: 1 });
            events.push(Event { x: x1, y0, y1, change: -1 });
        }
    }
    events.sort_unstable_by_key(|event| event.x);
    events
}

/// How many boxes cover each stretch of the sweep line: `steps[i].1` from `steps[i].0` up to the next.
struct Coverage {
    steps: Vec<(i32, i32)>,
}

impl Coverage {
    /// Free all along `inside`, covered beyond.
    fn new(inside: LatticeRect) -> Self {
        Self { steps: vec![(inside.y0, 0), (inside.y1, i32::MAX / 2)] }
    }

    fn apply(&mut self, event: &Event) {
        let first = self.split(event.y0, self.steps.partition_point(|step| step.0 < event.y0));
        // A box covers few steps: to walk there is quicker than to search.
        let ahead = self.steps[first..].iter().take_while(|step| step.0 < event.y1).count();
        let last = self.split(event.y1, first + ahead);
        for step in &mut self.steps[first..last] {
            step.1 += event.change;
        }
        // What the same number of boxes covers is one stretch: a free stretch is a whole free interval.
        let mut kept = first;
        for index in first..=last {
            let step = self.steps[index];
            if kept == 0 || self.steps[kept - 1].1 != step.1 {
                self.steps[kept] = step;
                kept += 1;
            }
        }
        self.steps.drain(kept..=last);
    }

    /// The step that begins at `y`, made if there is none; `index` is the first that begins there or above.
    fn split(&mut self, y: i32, index: usize) -> usize {
        if self.steps[index].0 != y {
            self.steps.insert(index, (y, self.steps[index - 1].1));
        }
        index
    }

    /// The step in which the stretch below `y` lies.
    fn below(&self, y: i32) -> usize {
        self.steps.partition_point(|step| step.0 < y).saturating_sub(1)
    }

    /// The free intervals that touch the range, from a step that touches it or lies below.
    fn free(&self, (low, high): (i32, i32), step: usize) -> impl Iterator<Item = (i32, i32)> {
        let touching = self.steps[step..].windows(2).take_while(move |pair| pair[0].0 <= high);
        touching
            .filter(move |pair| pair[0].1 == 0 && pair[1].0 >= low)
            .map(|pair| (pair[0].0, pair[1].0))
    }
}

/// A cell whose right edge the sweep line has not met yet.
#[derive(Clone, Copy, Debug)]
struct OpenCell {
    y0: i32,
    y1: i32,
    index: u32,
}

/// A range in which cells change.
#[derive(Clone, Copy, Debug)]
struct Affected {
    range: (i32, i32),
    /// The first open cell that touches it.
    first: usize,
    /// A step that touches it or lies below.
    step: usize,
}

struct Sweep {
    coverage: Coverage,
    /// From below to above.
    open: Vec<OpenCell>,
    slabs: Slabs,
    /// The open cells in the range that changes, before and after.
    before: Vec<OpenCell>,
    after: Vec<OpenCell>,
}

impl Sweep {
    /// The range that changes with `range`: all free intervals that touch it, before and after, and
    /// those that touch these.
    fn affected(&self, mut range: (i32, i32)) -> Affected {
        let mut first = self.open.partition_point(|cell| cell.y1 < range.0);
        let mut step = self.coverage.below(range.0);
        loop {
            while first > 0 && self.open[first - 1].y1 >= range.0 {
                first -= 1;
            }
            while step > 0 && self.coverage.steps[step].0 >= range.0 {
                step -= 1;
            }
            let before = self.open[first..].iter().take_while(|cell| cell.y0 <= range.1);
            let before = before.map(|cell| (cell.y0, cell.y1));
            let wider = before
                .chain(self.coverage.free(range, step))
                .fold(range, |wide, (y0, y1)| (wide.0.min(y0), wide.1.max(y1)));
            if wider == range {
                return Affected { range, first, step };
            }
            range = wider;
        }
    }

    /// Closes at `x` the cells in `range` that do not go on unchanged, opens those that begin, and
    /// makes the doors between.
    fn replace(&mut self, x: i32, Affected { range, first, step }: Affected) {
        let count = self.open[first..].iter().take_while(|cell| cell.y0 <= range.1).count();
        self.before.clear();
        self.before.extend_from_slice(&self.open[first..first + count]);
        self.after.clear();
        let mut old = self.before.iter().peekable();
        for (y0, y1) in self.coverage.free(range, step) {
            while old.next_if(|cell| (cell.y0, cell.y1) < (y0, y1)).is_some() {}
            let same = old.next_if(|cell| (cell.y0, cell.y1) == (y0, y1));
            self.after.push(same.copied().unwrap_or_else(|| {
                self.slabs.cells.push(LatticeRect::new(x, y0, x, y1));
                OpenCell { y0, y1, index: self.slabs.cells.len() as u32 - 1 }
            }));
        }
        self.open.splice(first..first + count, self.after.iter().copied());
        self.join(x);
    }

    fn join(&mut self, x: i32) {
        let mut right = self.after.iter().peekable();
        for left in &self.before {
            while right.next_if(|cell| cell.y1 <= left.y0).is_some() {}
            if right.next_if(|cell| cell.index == left.index).is_some() {
                continue;
            }
            self.slabs.cells[left.index as usize].x1 = x;
            let mut beside = right.clone();
            while let Some(cell) = beside.next_if(|cell| cell.y0 < left.y1) {
                self.slabs.doors.push(Door {
                    cells: [left.index, cell.index],
                    x,
                    y0: left.y0.max(cell.y0),
                    y1: left.y1.min(cell.y1),
                    corners: [left.y0 != cell.y0, left.y1 != cell.y1],
                });
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn arena(boxes: &[[i32; 4]]) -> EnlargedArena {
        let inside = LatticeRect::new(0, 0, 12, 12);
        let boxes = boxes.iter().map(|&[a, b, c, d]| LatticeRect::new(a, b, c, d)).collect();
        EnlargedArena::new(inside, inside, boxes)
    }

    #[test]
    fn one_box_leaves_four_cells_and_four_doors() {
        let slabs = sweep(&arena(&[[3, 4, 6, 7]]));
        let cells = [[0, 0, 3, 12], [3, 0, 6, 4], [3, 7, 6, 12], [6, 0, 12, 12]];
        assert_eq!(slabs.cells, cells.map(|[a, b, c, d]| LatticeRect::new(a, b, c, d)));
        let door = Door { cells: [0, 1], x: 3, y0: 0, y1: 4, corners: [false, true] };
        assert_eq!(slabs.doors[0], door);
        assert_eq!(slabs.doors.len(), 4);
    }

    #[test]
    fn a_box_that_ends_where_another_begins_leaves_no_gap() {
        assert_eq!(sweep(&arena(&[[0, 0, 5, 12], [5, 0, 12, 12]])).cells, []);
        let corner = sweep(&arena(&[[0, 0, 5, 5], [5, 5, 12, 12]]));
        assert_eq!((corner.cells.len(), corner.doors.len()), (2, 0));
    }

    #[test]
    fn a_wall_of_boxes_with_the_same_height_is_one_wall() {
        let slabs = sweep(&arena(&[[2, 0, 5, 6], [5, 0, 8, 6], [4, 2, 7, 3]]));
        assert_eq!(slabs.cells.len(), 3);
    }

    proptest! {
        #[test]
        fn cells_cover_exactly_what_no_box_covers(
            boxes in proptest::collection::vec(
                proptest::array::uniform4(0..12_i32).prop_map(|[x, y, w, h]| [x, y, x + 1 + w / 3, y + 1 + h / 3]),
                0..12,
            ),
        ) {
            let arena = arena(&boxes);
            let slabs = sweep(&arena);
            for x in 0..12 {
                for y in 0..12 {
                    let covers = |rect: &&LatticeRect| rect.x0 <= x && x < rect.x1 && rect.y0 <= y && y < rect.y1;
                    let free = usize::from(!arena.boxes.iter().any(|grown| covers(&grown)));
                    prop_assert_eq!(slabs.cells.iter().filter(covers).count(), free, "at {},{}", x, y);
                }
            }
            for door in &slabs.doors {
                let [left, right] = door.cells.map(|cell| slabs.cells[cell as usize]);
                prop_assert!(door.y0 < door.y1 && left.x1 == door.x && right.x0 == door.x);
                prop_assert_eq!(door.y0, left.y0.max(right.y0));
                prop_assert_eq!(door.y1, left.y1.min(right.y1));
            }
        }
    }
}
