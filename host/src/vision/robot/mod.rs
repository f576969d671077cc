//! The robot's top in the plan view, and its heading.

mod disc;
mod pose;
mod seen;
mod standing;
mod triangle;

pub(crate) use disc::Size;
pub(crate) use pose::{RobotTop, find};
pub(crate) use seen::SeenRobot;
pub(crate) use standing::RobotBody;
