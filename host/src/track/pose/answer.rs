//! What becomes of a camera's pose.

use super::GATE;
use crate::geometry::Pose;
use std::time::Duration;

/// What became of a camera's pose that was taken in.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Accepted {
    /// It was the first.
    Placed,
    /// It agrees with the estimate.
    Fused {
        /// The squared Mahalanobis distance, of which [`GATE`] is the most.
        squared: f64,
        /// How far it lay from the estimate, metres.
        distance: f64,
        /// By how much its heading was further counter-clockwise than the estimate's, radians.
        turn: f64,
    },
    /// The robot is elsewhere, as frame after frame says: it was lifted. The filter has begun again there.
    Kidnapped {
        /// How far it lies from the old estimate, metres.
        distance: f64,
        /// By how much its heading is further counter-clockwise, radians.
        turn: f64,
        /// How many frames agree.
        frames: u32,
    },
}

/// Why a camera's pose was not taken in.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub enum Rejected {
    /// It lies further away than the covariance explains.
    #[error(
        "the camera sees the robot {:.0} mm and {:.1}° from the estimate, where {:.0} mm are usual \
         (squared distance {squared:.0}, the gate is {GATE})",
        1000.0 * .distance, .turn.to_degrees(), 1000.0 * .expected
    )]
    Outlier {
        /// The squared Mahalanobis distance; above [`GATE`].
        squared: f64,
        /// How far from the estimate, metres.
        distance: f64,
        /// By how much its heading is further counter-clockwise, radians.
        turn: f64,
        /// The standard deviation of the distance that was expected, metres.
        expected: f64,
        /// How many outliers in a row agree with each other, this one included.
        frames: u32,
    },
    /// It was exposed before another that was taken in, or longer ago than steps are kept.
    #[error("the frame was exposed {:.0} ms before the oldest moment that is kept", 1000.0 * .by.as_secs_f64())]
    TooOld {
        /// By how much it is too old.
        by: Duration,
    },
    /// It was exposed after the last telemetry: ask again when telemetry has caught up.
    #[error("the frame was exposed {:.0} ms after the last telemetry", 1000.0 * .by.as_secs_f64())]
    AheadOfTelemetry {
        /// By how much.
        by: Duration,
    },
    /// No telemetry has come yet.
    #[error("the robot has sent no telemetry yet")]
    NoTelemetry,
    /// A number is not finite, or a standard deviation not above 0.
    #[error("the pose ({:.3}, {:.3}, {:.3}) with its standard deviations makes no sense", .0.position.x, .0.position.y, .0.heading)]
    NotSane(Pose),
}
