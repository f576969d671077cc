//! Whether a leg begins where the robot is by then: legs are absolute, so nothing else keeps them together.
//!
//! A plan may begin anywhere along its first leg, as one that is resumed does; every other leg begins where
//! the one before it ends. Metres.

use super::{Leg, Position};
use crate::units::Metres;

/// So far beside its place a leg may begin: a photo places a robot to 0.1 m, and a camera may correct it on
/// the way. What is further off was meant for another place, and the robot would cut across to it.
pub const LARGEST_GAP: Metres = Metres(0.15);

impl Leg {
    /// Whether it begins within [`LARGEST_GAP`] of `end`, where the leg before it ends.
    ///
    /// # Errors
    /// How far off it begins.
    pub fn follows(&self, end: Position) -> Result<(), Metres> {
        within(Position { x: self.start.x, y: self.start.y }, end)
    }

    /// Whether `place` lies within [`LARGEST_GAP`] of the straight way from its start to its goal.
    ///
    /// # Errors
    /// How far beside it lies.
    pub fn passes(&self, place: Position) -> Result<(), Metres> {
        let (x, y) = (self.goal.x.0 - self.start.x.0, self.goal.y.0 - self.start.y.0);
        let (dx, dy) = (place.x.0 - self.start.x.0, place.y.0 - self.start.y.0);
        let square = x * x + y * y;
        let share = if square > 0.0 { ((dx * x + dy * y) / square).clamp(0.0, 1.0) } else { 0.0 };
        within(Position::new(self.start.x.0 + share * x, self.start.y.0 + share * y), place)
    }
}

fn within(a: Position, b: Position) -> Result<(), Metres> {
    let (dx, dy) = (b.x.0 - a.x.0, b.y.0 - a.y.0);
    let square = dx * dx + dy * dy;
    // What is not a number is within nothing.
    if square <= LARGEST_GAP.0 * LARGEST_GAP.0 { Ok(()) } else { Err(Metres(libm::sqrtf(square))) }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::motion::{Direction, Pose, Timing};

    fn leg(goal: Position) -> Leg {
        Leg {
            plan: 1,
            index: 0,
            start: Pose::new(1.0, 1.0, 0.0),
            goal,
            goal_heading: None,
            direction: Direction::Forward,
            timing: Timing::Limits,
        }
    }

    #[test]
    fn gaps_by_hand() {
        let along = leg(Position::new(3.0, 1.0));
        assert_eq!(along.follows(Position::new(1.0, 1.14)), Ok(()));
        let Err(Metres(gap)) = along.follows(Position::new(0.7, 1.4)) else { unreachable!() };
        assert!((gap - 0.5).abs() < 1e-6, "{gap}");
        // Half-way, 0.1 m beside; beyond the goal; and before the start.
        assert_eq!(along.passes(Position::new(2.0, 1.1)), Ok(()));
        assert!(along.passes(Position::new(2.0, 0.8)).is_err());
        assert!(along.passes(Position::new(3.2, 1.0)).is_err());
        assert!(along.passes(Position::new(0.8, 1.0)).is_err());
        assert_eq!(along.passes(Position::new(0.9, 1.0)), Ok(()));
        assert!(along.passes(Position::new(f32::NAN, 1.0)).is_err());
        // A turn on the spot has no way but its place.
        let turn = leg(Position::new(1.0, 1.0));
        assert_eq!(turn.passes(Position::new(1.1, 1.1)), Ok(()));
        assert!(turn.passes(Position::new(1.2, 1.0)).is_err());
    }
}
