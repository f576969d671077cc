//! The floor's four edges: lines and quads in the photo, the choice among them, and the light along each side.

mod candidates;
mod find;
mod light;
mod lines;
mod nested;
mod quads;
mod sides;
#[cfg(test)]
mod tests;

pub(crate) use find::{check_arena, find, given};
pub(crate) use light::{changes, company, shown};
