//! The plan view with the planned path and the driven one over it, as SVG.

use super::vision::{drawn, opened, plan_view_picture, robot};
use crate::geometry::{Point, Pose};
use crate::vision::Steps;

/// Draws `planned` (white, wide), the poses that the robot reported (blue) and its disc at both ends,
/// in the arena's frame, metres, over the plan view of `steps`.
pub fn drive_picture(
    steps: &Steps,
    planned: &[Point],
    driven: &[Pose],
    robot_radius: f64,
) -> String {
    let arena = steps.frame.arena;
    let mut svg = opened(arena, &plan_view_picture(steps));
    let radius = robot_radius * super::vision::DRAWN_SCALE;
    for pose in driven.first().into_iter().chain(driven.last()) {
        robot(&mut svg, |point| drawn(arena, point), *pose, radius);
    }
    let mut line = |points: &mut dyn Iterator<Item = Point>, class| {
        svg.polyline(&points.map(|point| drawn(arena, point)).collect::<Vec<_>>(), class);
    };
    line(&mut planned.iter().copied(), "photo-planned");
    line(&mut driven.iter().map(|pose| pose.position), "photo-driven");
    svg.finish(&[])
}
