//! The dynamic fuzzy grid: a way over time among things that move [Alghannam, Sec. VI].
//!
//! ```text
//! tracks ─► futures ─► memberships of ─► search in cells and ─► legs, each with ─► verified in
//!           sets over  cells, layer by   safe intervals         the time it        small steps
//!           time       layer of time     turn, drive, wait      begins at          of time
//! ```
//! The paper leaves it open: "values change upon the time based on obstacles movements". Here a thing's
//! membership of a place grows where its predicted set comes and decays where it has been
//! ([`Future`], [`TimeGrid`]). What is sure is hard: within the next moments no leg enters a set that holds the
//! truth in 99 % of cases. What is far ahead will be predicted again many times before it matters: there a set
//! is narrower, and its fuzzy edge only costs time ([`Demand`]).
//!
//! The robot turns, drives and turns again, and rests in between; it may wait at rest, where a thing that moves
//! may touch it but it touches nothing. So a way is a sequence of legs with waits before them, and its cost is
//! the time of arrival by the legs' real durations ([`DynamicArena::plan`]). What is driven already is held
//! against the newest prediction by [`Rollout`]: as it goes on, and as it brakes.
//!
//! It stands between tracks and legs, whose results it joins, and the watched drive. Seconds from the moment of
//! planning, metres, radians, arena frame; no clock.

mod arena;
mod demand;
mod future;
mod grid;
mod leg_motion;
mod plan;
mod queue;
mod rollout;
mod search;
mod times;

pub use arena::{DynamicArena, Quest};
pub use demand::{Band, Demand};
pub use future::Future;
pub use grid::{CellIndex, TimeGrid};
pub use leg_motion::LegMotion;
pub use plan::{DynamicPlan, TimedLeg};
pub use rollout::{Contact, Course, Pace, Place, Rollout};

#[cfg(test)]
mod tests;
