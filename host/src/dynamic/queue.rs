//! What a search has reached, and what it may try next, the most promising first.

use super::plan::TimedLeg;
use crate::geometry::Pose;
use protocol::motion::Direction;
use std::cmp::Ordering;

/// A place, reached at a time.
#[derive(Clone, Copy, Debug)]
pub(super) struct Node {
    pub(super) place: usize,
    pub(super) time: f64,
    pub(super) pose: Pose,
    /// Time with what risks cost.
    pub(super) cost: f64,
    pub(super) risk: f64,
    /// From where, and the leg with its beginning and the wait before it.
    pub(super) parent: Option<(usize, TimedLeg)>,
}

/// What may be tried.
#[derive(Clone, Copy, Debug)]
pub(super) enum Next {
    /// A leg to a place that begins after a wait.
    Leg { to: usize, direction: Direction, wait: f64 },
    /// A leg that was tried.
    Tried(Node),
    /// All legs that do not lead to the goal.
    Others,
}

/// What may be tried from a node, and what the way would cost at best, s.
#[derive(Clone, Copy, Debug)]
pub(super) struct Entry {
    pub(super) best: f64,
    pub(super) from: usize,
    pub(super) next: Next,
}

impl PartialEq for Entry {
    fn eq(&self, other: &Self) -> bool {
        self.cmp(other) == Ordering::Equal
    }
}

impl Eq for Entry {}

impl PartialOrd for Entry {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

impl Ord for Entry {
    fn cmp(&self, other: &Self) -> Ordering {
        other.best.total_cmp(&self.best)
    }
}
