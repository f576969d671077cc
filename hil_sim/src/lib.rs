//! A base that exists only in software: motors, wheels, encoders, wires and virtual time.
//!
//! ```text
//! serial port, TCP, in process ─► wire ─► simulation ─► firmware (logic, or the flashed ELF) ─► base ─► world ─► camera
//! ```
//! It knows boxes, not scenes, and nothing of planning. Kinematics here are its own.

pub mod base;
pub mod camera;
pub mod emulator;
pub mod encoder;
pub mod in_process;
pub mod lockstep;
pub mod motion;
pub mod noise;
pub mod physics;
pub mod presets;
#[cfg(unix)]
pub mod pty;
pub mod realtime;
pub mod scenario;
pub mod script;
pub mod simulation;
pub mod tcp;
mod toml_file;
pub mod wire;
pub mod world;
