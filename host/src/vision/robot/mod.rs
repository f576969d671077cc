//! The robot's top in the plan view, and its heading.

mod disc;
mod pose;

pub(crate) use pose::{RobotTop, find, shown_lean};
