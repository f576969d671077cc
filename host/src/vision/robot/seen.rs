//! How the robot was seen, and where it stands then. Metres and radians in the arena frame.

use super::pose::RobotTop;
use super::standing::RobotBody;
use crate::geometry::Pose;
use crate::vision::camera::{PlanMap, Viewpoint};
use crate::vision::image::Photo;

/// What tells where the robot is.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum SeenRobot {
    /// A tag on its top, which appears at this pose on the floor's plane.
    Tag(Pose),
    /// Its disc.
    Disc(RobotTop),
    /// Nothing in the picture, but the caller.
    Told(Pose),
}

impl SeenRobot {
    /// Its top as it appears; `mount` is the tag's pose in the robot's frame.
    pub(crate) fn top(self, body: RobotBody, mount: Pose) -> RobotTop {
        let known = |pose: Pose| RobotTop {
            centre: pose.position,
            radius: body.radius,
            heading: pose.heading,
            certainty: 1.0,
            base: pose.position,
        };
        match self {
            Self::Tag(seen) => known(body.under_tag(seen, mount, None)),
            Self::Disc(top) => top,
            Self::Told(pose) => known(pose),
        }
    }

    /// Where it stands, seen from a viewpoint whose height is known or guessed.
    pub(crate) fn stands(
        self,
        (photo, map): (&Photo, &PlanMap),
        body: RobotBody,
        mount: Pose,
        view: Option<Viewpoint>,
    ) -> Pose {
        match self {
            Self::Tag(seen) => body.under_tag(seen, mount, view),
            Self::Disc(top) => body.under(photo, map, top, view),
            Self::Told(pose) => pose,
        }
    }
}
