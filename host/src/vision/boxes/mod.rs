//! Obstacles from one picture: evidence, proposals, the search for boxes with their visible sides and shadows,
//! the refinement of their edges with margins, and all that no box explains.

mod balance;
mod border_colours;
mod candidates;
mod caster;
mod evidence;
mod find;
mod floor_lines;
mod footprint;
mod foreign;
mod implausible;
mod lean;
mod light;
mod merging;
mod projection;
mod proposals;
mod refine;
mod robot_shadow;
mod search;
mod shade;
mod shaped;
mod standing;
mod tighten;
mod uncovered;
mod widening;

pub(crate) use evidence::Evidence;
pub(crate) use find::{Found, Known, Trace, find, find_within};
pub(crate) use implausible::lined_sides;
pub(crate) use projection::{Face, LeaningBox};
pub(crate) use refine::{Bounded, at};
