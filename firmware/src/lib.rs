//! The robot without a board: bytes, encoder counts and elapsed time in, motor duty and bytes out.
//!
//! ```text
//! bytes ─► link end ─► leg queue ─► leg runner ─► tracker ─► kinematics ─► wheel loop ─► duty
//!                                      ▲
//! counts ─► odometry ─► pose ──────────┘          robot: all of it as one value
//! ```
//! The control law is that of [Alghannam, Sec. IV]: [`chained_form`] and [`cosine_switch`] hold it in n
//! dimensions, `leg_runner` drives the three intervals of a leg with it. SI units, arena frame.
//! Nothing here knows of pins, executors or clocks; nothing allocates or panics.
#![cfg_attr(not(test), no_std)]
#![warn(clippy::indexing_slicing)]

mod battery;
pub mod chained_form;
pub mod controller;
pub mod cosine_switch;
mod effort;
pub mod kinematics;
mod leg_queue;
mod leg_runner;
mod light;
mod link_end;
mod math;
pub mod odometry;
mod outbox;
mod pace;
pub mod parameter_store;
mod pose_gate;
mod pose_history;
mod progress;
pub mod robot;
pub mod signals;
mod speed_limiter;
mod tracker;
mod version;
mod wheel_loop;
mod wheel_pair;
