//! From an overhead photo to a driven robot.
//!
//! ```text
//! photo ─► vision ─► scene ─► grid ─► plan ─► legs ─► link ═serial═ robot
//!          metres    boxes    areas   points  poses   frames
//! ```
//! Every stage is a module, usable alone, that names only what stands to its left;
//! [`picture`] draws what each stage saw; [`uf2`] packs the robot's firmware for flashing.
//!
//! # I/O
//!
//! [`link::port`] opens serial ports and TCP connections, [`link::reopening`] opens them again, and the
//! list of ports reads what Linux says of USB under `/sys`. Everything else is pure: bytes, values and
//! the caller's time in, values out. Nothing here prints, reads a clock on its own account or exits.
//!
//! # Where is what
//!
//! | question | answer |
//! |---|---|
//! | Where is the floor's border chosen? | `vision/border` |
//! | Where are shadows modelled? | `vision/appearance` (`floor`, `shadow`); those that boxes cast in `vision/boxes` (`light`) |
//! | Where does a turned box or a disc get its shape? | `vision/outline`, where `vision/boxes` (`shaped`) finds that boxes explain it badly |
//! | Where are shapes of any form planned around? | `plan/disc` for the exact planner; `grid` (`enlarge`) covers them with rectangles for the paper's |
//! | Where is a way found whose edges are unsure? | `plan/fuzzy`: membership of areas, fast marching, and a taut way on the true shapes |
//! | Where does a box get its margin? | `vision/boxes` (`refine`, and `uncovered` for what no box explains); [`plan::with_margin_fallback`] chooses the margin for driving |
//! | Where is a leg's time made? | [`protocol::motion`], shared by host and robot; [`legs`] asks it |
//! | Where does a lost frame come back? | [`protocol::session`], at both ends; [`link::LinkClient`] is the host's |
//!
//! # Frames and units
//!
//! The arena frame has its origin at the floor's lower-left corner as the picture
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
pub mod shape;
pub mod uf2;
pub mod vision;
pub mod wiring_check;

/// The wire format, whose motion types appear in this crate's signatures.
pub use protocol;
