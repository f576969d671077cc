//! What happens on a watched drive, in words.

use crate::geometry::Point;
use crate::link::describe;
use crate::plan::PlanError;
use crate::shape::Shape;
use crate::track::pose::Caution;
use protocol::message::PlanRefusal;
use std::fmt;
use std::time::Duration;

/// Why the robot is held.
#[derive(Clone, Debug, PartialEq)]
pub enum Reason {
    /// Something stands in the way.
    Blocked {
        /// What it looks like.
        shape: Shape,
        /// Whether it moves.
        moves: bool,
        /// How far ahead the robot would touch it, metres.
        ahead: f64,
    },
    /// No way leads to the goal.
    NoWay(PlanError),
    /// The pose is not known well enough, or the camera is dark.
    Unsure(Caution),
    /// The robot is beside its path by so much, metres.
    OffPath(f64),
    /// The robot was put down elsewhere, so far away, metres.
    Lifted(f64),
    /// Slow legs are no longer needed.
    SeesAgain,
}

impl Reason {
    /// Whether another reason tells a person nothing new.
    pub(super) fn is_like(&self, other: &Self) -> bool {
        use Reason::{Blocked, Unsure};
        match (self, other) {
            (Blocked { .. }, Blocked { .. }) => true,
            (Unsure(a), Unsure(b)) => std::mem::discriminant(a) == std::mem::discriminant(b),
            (a, b) => std::mem::discriminant(a) == std::mem::discriminant(b),
        }
    }
}

/// What happens.
#[derive(Clone, Debug, PartialEq)]
pub enum WatchEvent {
    /// The robot is braking, or waits for another reason than before.
    Held(Reason),
    /// The way is free again, and the robot goes on.
    Resumed {
        /// How long it was held.
        after: Duration,
    },
    /// The robot has other legs.
    Rerouted {
        /// How many.
        legs: usize,
        /// The way's length, metres.
        length: f64,
        /// Whether they begin at rest, where the robot stands; else where the leg under way ends.
        at_rest: bool,
        /// Whether they are driven at half the pace.
        slow: bool,
    },
    /// Other legs came too late; the robot has those that it had.
    NotTaken(PlanRefusal),
    /// A frame was of no use, or the source has trouble.
    Trouble(String),
    /// The camera has moved, and the arena was found again.
    Relocated,
    /// The robot ended so far from its goal, metres and radians, and drives there.
    TouchUp {
        /// Metres.
        distance: f64,
        /// Radians.
        turn: f64,
    },
}

impl fmt::Display for Reason {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Blocked { shape, moves, ahead } => {
                let bounds = shape.bounds();
                let Point { x, y } =
                    Point::new((bounds.x0 + bounds.x1) / 2.0, (bounds.y0 + bounds.y1) / 2.0);
                let thing = match shape {
                    Shape::Rect(_) => "box",
                    Shape::Polygon(_) => "thing",
                    Shape::Circle(_) => "disc",
                };
                // Where the robot would meet what moves is anywhere on the stretch that both reach.
                if *moves {
                    return write!(f, "a {thing} moves into the way from ({x:.2}, {y:.2})");
                }
                write!(
                    f,
                    "a {thing} in the way at ({x:.2}, {y:.2}), {:.0} mm ahead",
                    1000.0 * ahead
                )
            }
            Self::NoWay(error) => write!(f, "{error}"),
            Self::Unsure(caution) => write!(f, "{caution}"),
            Self::OffPath(by) => write!(f, "the robot is {:.0} mm beside its path", 1000.0 * by),
            Self::Lifted(by) => write!(f, "the robot was put down {:.0} mm away", 1000.0 * by),
            Self::SeesAgain => write!(f, "the camera sees the robot again"),
        }
    }
}

impl fmt::Display for WatchEvent {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Held(reason) => write!(f, "{reason}; the robot holds"),
            Self::Resumed { after } => {
                write!(f, "the way is free; the robot goes on after {:.1} s", after.as_secs_f64())
            }
            Self::Rerouted { legs, length, at_rest, slow } => {
                let count = if *legs == 1 { "1 leg".into() } else { format!("{legs} legs") };
                let from =
                    if *at_rest { "from where it stands" } else { "behind the leg under way" };
                let pace = if *slow { ", at half the pace" } else { "" };
                write!(f, "new path of {count}, {length:.2} m, {from}{pace}")
            }
            Self::NotTaken(refusal) => {
                write!(f, "the robot keeps its path, as of the new one {}", describe(refusal))
            }
            Self::Trouble(what) => write!(f, "camera: {what}"),
            Self::Relocated => write!(f, "the camera has moved; the arena was found again"),
            Self::TouchUp { distance, turn } => write!(
                f,
                "the robot stands {:.0} mm and {:.1}° from its goal and drives there",
                1000.0 * distance,
                turn.abs().to_degrees()
            ),
        }
    }
}
