//! Draws what each stage of the flow saw, as SVG.

mod floor;
pub mod grid;
pub mod plan;
pub mod svg;
pub mod vision;
