//! Obstacles from one picture: evidence, proposals, the search for boxes with their visible sides and shadows,
//! the refinement of their edges with margins, and all that no box explains.

mod balance;
mod candidates;
mod evidence;
mod find;
mod footprint;
mod implausible;
mod light;
mod merging;
mod projection;
mod proposals;
mod refine;
mod search;
mod shaped;
mod tighten;
mod uncovered;

pub(crate) use evidence::Evidence;
pub(crate) use find::{Found, find};
pub(crate) use implausible::lined_sides;
pub(crate) use projection::{Face, LeaningBox};
pub(crate) use refine::{Bounded, at};
