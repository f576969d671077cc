//! The floor's four edges: lines and quads in the photo, the choice among them, and the light along each side.

mod candidates;
mod consensus;
mod enlarge;
mod find;
mod given;
mod light;
mod lines;
mod nested;
mod origin;
mod quads;
mod refine;
mod seen;
mod sides;
#[cfg(test)]
mod tests;

pub(crate) use find::{check_arena, find};
pub(crate) use given::{By, given, is_convex};
pub(crate) use light::{changes, company, shown};
pub use origin::PictureCorner;
pub(crate) use origin::lowest_left;
pub use seen::{BorderCandidates, SeenBorder, border_candidates};
