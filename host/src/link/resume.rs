//! Where the rest of a plan begins after a mission was cut short.
//!
//! A robot that restarts takes its place for the origin and counts its wheels' turns from there, so
//! its own pose is how far it rolled since. [`after_restart`] adds that to the pose it last reported;
//! [`check_beside_leg`] makes sure that the rest of the leg begins there. Metres and radians, arena frame.

use crate::geometry::{Point, Pose, square_to_leg};
use crate::legs::from_wire;
use protocol::motion::Leg;

/// The rest of a leg may begin this far beside it: what plans for driving keep free beyond the
/// robot's radius, metres.
pub const MAX_BESIDE: f64 = 0.010;

/// A robot that coasts after a restart comes no further than this, metres: V²/2A and as much again.
pub const MAX_ROLL: f64 = 0.2;

/// Why the rest of a plan cannot be driven from where the robot stands.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error, miette::Diagnostic)]
pub enum ResumeError {
    /// It was moved, not only coasted, after its restart.
    #[error("the robot has moved {:.0} mm since it restarted", distance * 1000.0)]
    #[diagnostic(help("plan again from where it stands, with --start x,y,heading"))]
    Moved {
        /// How far, metres.
        distance: f64,
    },
    /// It stands beside the leg that it is to go on with.
    #[error(
        "the robot stands at ({:.3}, {:.3}) m, {:.1}°, {:.0} mm beside leg {} of the plan",
        pose.position.x, pose.position.y, pose.heading.to_degrees(), distance * 1000.0, leg + 1
    )]
    #[diagnostic(help("plan again from there with --start x,y,heading"))]
    Beside {
        /// Where it stands.
        pose: Pose,
        /// How far from the leg, metres.
        distance: f64,
        /// The leg, counted from 0.
        leg: u16,
    },
}

/// Where a robot stands that was at `last` and has moved by `since` in its own frame after a restart.
///
/// # Errors
/// [`ResumeError::Moved`] beyond [`MAX_ROLL`].
pub fn after_restart(last: Pose, since: Pose) -> Result<Pose, ResumeError> {
    let Point { x, y } = since.position;
    let (sin, cos) = last.heading.sin_cos();
    let distance = x.hypot(y);
    if distance > MAX_ROLL {
        return Err(ResumeError::Moved { distance });
    }
    Ok(Pose::new(
        last.position.x + cos * x - sin * y,
        last.position.y + sin * x + cos * y,
        last.heading + since.heading,
    ))
}

/// Checks that the rest of leg `next` of `legs` begins beside it. Behind the last leg nothing is left to check.
///
/// # Errors
/// [`ResumeError::Beside`] if `pose` is farther from the leg than [`MAX_BESIDE`].
pub fn check_beside_leg(legs: &[Leg], next: u16, pose: Pose) -> Result<(), ResumeError> {
    let Some(leg) = legs.get(usize::from(next)) else { return Ok(()) };
    let start = from_wire(leg.start).position;
    let goal = Point::new(leg.goal.x.0.into(), leg.goal.y.0.into());
    let distance = square_to_leg(pose.position, start, goal).sqrt();
    if distance <= MAX_BESIDE {
        return Ok(());
    }
    Err(ResumeError::Beside { pose, distance, leg: next })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::legs::{DEFAULT_LIMITS, LegOptions, to_legs};

    #[test]
    fn a_robot_rolls_on_ahead_of_itself() {
        let last = Pose::new(1.0, 2.0, std::f64::consts::FRAC_PI_2);
        let pose = after_restart(last, Pose::new(0.1, 0.0, 0.25)).unwrap();
        assert!(pose.position.distance(Point::new(1.0, 2.1)) < 1e-12, "{pose:?}");
        assert_eq!(pose.heading, last.heading + 0.25);
        let error = after_restart(last, Pose::new(0.0, 0.3, 0.0)).unwrap_err();
        assert_eq!(error.to_string(), "the robot has moved 300 mm since it restarted");
    }

    #[test]
    fn a_robot_far_beside_its_leg_does_not_go_on() {
        let path = [Point::new(0.2, 0.5), Point::new(0.8, 0.5)];
        let legs = to_legs(
            &path,
            0.0,
            None,
            &LegOptions { timing: protocol::motion::Timing::Limits, reverse: true },
            &DEFAULT_LIMITS,
        );
        let check = |y| check_beside_leg(&legs, 0, Pose::new(0.5, y, 0.0));
        assert_eq!(check(0.509), Ok(()));
        let error = check(0.530).unwrap_err();
        assert_eq!(
            error.to_string(),
            "the robot stands at (0.500, 0.530) m, 0.0°, 30 mm beside leg 1 of the plan"
        );
        let behind = check_beside_leg(&legs, legs.len() as u16, Pose::new(9.0, 9.0, 0.0));
        assert_eq!(behind, Ok(()), "nothing is left to drive");
    }
}
