//! Draws what each stage of the flow saw, as SVG and PNG.

pub mod drive;
mod floor;
pub mod fuzzy;
pub mod grid;
pub mod index;
pub mod motion;
pub mod overhead;
pub mod plan;
pub mod progress;
pub mod replay;
pub mod stereo;
pub mod svg;
pub mod tags;
pub mod vision;
