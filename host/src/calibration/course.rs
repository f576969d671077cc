//! The courses that a robot drives to be calibrated: as legs for the robot, as moves for the calculation.
//!
//! Metres and radians from the course's start, x ahead, y to the left.

use crate::geometry::Point;
use crate::legs::named;
use protocol::motion::{Direction, Leg, Pose as WirePose, Position, Timing};
use protocol::units::Radians;
use std::f64::consts::{FRAC_PI_2, PI, TAU};

/// What the robot drives to be calibrated, from the origin along +x.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Course {
    /// Straight ahead.
    Straight {
        /// How far, m.
        length: f64,
    },
    /// On the spot to the left, thirds of a turn at a time.
    Spin {
        /// Whole turns.
        turns: u32,
    },
    /// A square back to its start.
    Square {
        /// Its side, m.
        side: f64,
        /// Whether its corners turn left.
        left: bool,
    },
}

/// A piece of a course, as the robot believes to drive it.
#[derive(Clone, Copy)]
pub(super) enum Move {
    Drive(f64),
    Turn(f64),
}

impl Course {
    /// The courses that determine all lengths, with squares of `side` metres.
    pub fn all(side: f64) -> [Self; 6] {
        let (left, right) = (Self::Square { side, left: true }, Self::Square { side, left: false });
        [Self::Straight { length: side }, Self::Spin { turns: 5 }, left, right, left, right]
    }

    /// The plan that drives the course.
    pub fn legs(self) -> Vec<Leg> {
        let mut from = WirePose::default();
        let mut legs = Vec::new();
        let mut leg = |goal: Point, heading: Option<f64>, arrival: f64| {
            let goal = Position::new(goal.x as f32, goal.y as f32);
            let goal_heading = heading.map(|heading| Radians(heading as f32).wrapped());
            let (index, start) = (legs.len() as u16, from);
            let (direction, timing) = (Direction::Forward, Timing::Limits);
            legs.push(Leg { plan: 0, index, start, goal, goal_heading, direction, timing });
            let heading = goal_heading.unwrap_or(Radians(arrival as f32));
            from = WirePose { x: goal.x, y: goal.y, heading };
        };
        match self {
            Self::Straight { length } => leg(Point::new(length, 0.0), None, 0.0),
            Self::Spin { turns } => {
                for third in 1..=3 * turns {
                    let heading = f64::from(third % 3) * TAU / 3.0;
                    leg(Point::new(0.0, 0.0), Some(heading), heading);
                }
            }
            Self::Square { side, left } => {
                let up = if left { side } else { -side };
                let turn = FRAC_PI_2.copysign(up);
                leg(Point::new(side, 0.0), None, 0.0);
                leg(Point::new(side, up), None, turn);
                leg(Point::new(0.0, up), None, PI);
                leg(Point::new(0.0, 0.0), Some(0.0), 0.0);
            }
        }
        named(legs)
    }

    /// The same as the pieces that the calculation drives.
    pub(super) fn moves(self) -> Vec<Move> {
        match self {
            Self::Straight { length } => vec![Move::Drive(length)],
            Self::Spin { turns } => vec![Move::Turn(f64::from(turns) * TAU)],
            Self::Square { side, left } => {
                let turn = if left { FRAC_PI_2 } else { -FRAC_PI_2 };
                [Move::Drive(side), Move::Turn(turn)].repeat(4)
            }
        }
    }
}
