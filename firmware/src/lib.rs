//! The robot without a board: bytes, encoder counts and elapsed time in, motor duty and bytes out.
//!
//! ```text
//! bytes ─► link end ─► leg queue ─► leg runner ─► tracker ─► kinematics ─► wheel loop ─► duty
//!                                      ▲
//! counts ─► odometry ─► pose ──────────┘          robot: all of it as one value
//! ```
//! The control law is that of [Alghannam, Sec. IV]: [`chained_form`] and [`cosine_switch`] hold it in n
//! dimensions, [`leg_runner`] drives the three intervals of a leg with it. SI units, arena frame.
//! Nothing here knows of pins, executors or clocks; nothing allocates or panics.
#![cfg_attr(not(test), no_std)]
#![warn(clippy::indexing_slicing)]

pub mod battery;
pub mod chained_form;
pub mod controller;
pub mod cosine_switch;
pub mod kinematics;
pub mod leg_queue;
pub mod leg_runner;
mod link_end;
pub mod math;
pub mod odometry;
mod outbox;
pub mod pace;
pub mod parameter_store;
pub mod parameters;
pub mod pose_history;
pub mod progress;
pub mod robot;
pub mod signals;
pub mod speed_limiter;
pub mod tracker;
mod version;
pub mod wheel_loop;
pub mod wheel_pair;
