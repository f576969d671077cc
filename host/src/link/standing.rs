//! Whether a drive begins where the robot stands.
//!
//! A robot that was told where it is keeps count of where it goes, after a mission too. A plan that
//! begins elsewhere would be driven beside its obstacles by as much, so it is refused. A robot that has
//! just started knows nothing of the arena and takes the plan's word. Metres and radians, arena frame.

use crate::geometry::{Pose, wrap_angle};

/// How far from the plan's start the robot may know itself to be.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Tolerance {
    /// Metres.
    pub position: f64,
    /// Radians.
    pub heading: f64,
}

impl Tolerance {
    /// Of a plan whose start was written down: what plans for driving keep free beyond the radius. The
    /// heading moves no edge of a disc, but decides which way a leg is driven.
    pub const WRITTEN: Self = Self { position: 0.010, heading: 0.175 };
    /// Of a start that a photo has just shown: the odometry of a long drive may be wrong by so much.
    pub const SEEN: Self = Self { position: 0.10, heading: 0.52 };
}

/// The robot is not where the plan begins.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error, miette::Diagnostic)]
#[error(
    "the robot knows itself to stand at ({:.3}, {:.3}) m, {:.1}°, but the plan begins at ({:.3}, {:.3}) m, {:.1}°",
    stands.position.x, stands.position.y, stands.heading.to_degrees(),
    begins.position.x, begins.position.y, begins.heading.to_degrees()
)]
#[diagnostic(help(
    "plan again from where it stands, with --start {:.3},{:.3},{:.1}; or, if it was carried back to the plan's start, say --from-start",
    stands.position.x, stands.position.y, stands.heading.to_degrees()
))]
pub struct Elsewhere {
    /// Where the robot stands.
    pub stands: Pose,
    /// Where the plan begins.
    pub begins: Pose,
}

/// Checks that a robot that knows itself to stand at `stands` may begin a plan at `begins`.
///
/// # Errors
/// [`Elsewhere`] beyond `tolerance`.
pub fn check(stands: Pose, begins: Pose, tolerance: Tolerance) -> Result<(), Elsewhere> {
    let distance = stands.position.distance(begins.position);
    let turn = wrap_angle(stands.heading - begins.heading).abs();
    if distance <= tolerance.position && turn <= tolerance.heading {
        Ok(())
    } else {
        Err(Elsewhere { stands, begins })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_plan_begins_where_the_robot_stands() {
        let begins = Pose::new(1.4, 0.35, 3.1);
        let check = |x, y, heading| check(Pose::new(x, y, heading), begins, Tolerance::WRITTEN);
        assert!(check(1.406, 0.3579, -3.1).is_ok(), "almost 10 mm and 5 degrees beside it");
        assert!(check(1.4, 0.3605, 3.1).is_err());
        assert!(check(1.4, 0.35, 2.9).is_err());
        assert!(check(f64::NAN, 0.35, 3.1).is_err());
        let error = check(1.4, 1.75, 0.0).unwrap_err().to_string();
        assert!(error.contains("(1.400, 1.750) m, 0.0°"), "{error}");
        assert!(error.contains("(1.400, 0.350) m, 177.6°"), "{error}");
    }
}
