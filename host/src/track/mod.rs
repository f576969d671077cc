//! What the camera says over time: where the robot is, and how obstacles move.
//!
//! ```text
//! odometry ─┐
//! camera ───┴► pose     where the robot is and how sure that is
//! shapes ────► obstacles  tracks with velocities, and where each may be soon
//! ```
//! It stands between vision, whose frames it joins, and the dynamic fuzzy grid, which plans with what it
//! predicts. No I/O and no clock: times are the caller's, of any one clock. Metres, radians, arena frame.

pub mod obstacles;
pub mod pose;
