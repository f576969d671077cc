//! What the host and the robot both know: units, motion, messages, frames and session rules.
//!
//! ```text
//! units ─► motion ─► parameters, plan, telemetry ─► message ─► schema, frame ─► session
//! ```
//! Nothing here knows of pictures, motors or ports; there is no allocation, no clock and no I/O.
#![cfg_attr(not(test), no_std)]
#![warn(clippy::indexing_slicing)]

pub mod frame;
pub mod message;
pub mod motion;
pub mod parameters;
pub mod plan;
pub mod schema;
pub mod session;
pub mod telemetry;
pub mod trigonometry;
pub mod units;
