//! An entry of a priority queue that gives the cheapest first.

use std::cmp::Ordering;

/// An item with its cost; among equal costs the one that was made first (the lower index) is greater,
/// so that a [`std::collections::BinaryHeap`] gives the cheapest and earliest first.
#[derive(Clone, Copy, Debug)]
pub(super) struct Ranked {
    pub(super) cost: f64,
    pub(super) index: usize,
}

impl Ord for Ranked {
    fn cmp(&self, other: &Self) -> Ordering {
        other.cost.total_cmp(&self.cost).then(other.index.cmp(&self.index))
    }
}

impl PartialOrd for Ranked {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

impl PartialEq for Ranked {
    fn eq(&self, other: &Self) -> bool {
        self.cmp(other) == Ordering::Equal
    }
}

impl Eq for Ranked {}
