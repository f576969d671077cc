//! From an overhead photo to a driven robot.
//!
//! ```text
//! photo ─► vision ─► scene ─► grid ─► plan ─► legs ─► link ═serial═ robot
//!          metres    boxes    areas   points  poses   frames
//! ```
//! Every stage is a module, usable alone, that names only what stands to its left;
//! [`picture`] draws what each stage saw; [`uf2`] packs the robot's firmware for flashing. The library performs no I/O beyond decoding bytes it is given.
//!
//! Frames and units: the arena frame has its origin at the floor's lower-left corner as the picture
//! shows it, x to the right, y up, headings counter-clockwise from +x in (-π, π]; lengths in metres.

pub mod calibration;
pub mod geometry;
pub mod grid;
pub mod legs;
pub mod link;
pub mod map;
pub mod picture;
pub mod plan;
pub mod plan_file;
pub mod scene;
pub mod uf2;
pub mod vision;
