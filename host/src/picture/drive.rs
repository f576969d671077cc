//! The plan view with the planned path and the driven one over it, as SVG.

use super::vision::{drawn, opened, plan_view_picture, robot};
use crate::geometry::{Point, Pose};
use crate::vision::Steps;
use std::fmt::Write;

/// The colours of what is planned and what is driven.
const PLANNED: &str = "#ffffff";
const DRIVEN: &str = "#1f6fd6";

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
    let mut line = |points: &mut dyn Iterator<Item = Point>, colour, width| {
        svg.push_str("<polyline points=\"");
        for point in points {
            let (x, y) = drawn(arena, point);
            // Writing into a string cannot fail.
            let _ = write!(svg, "{x:.1},{y:.1} ");
        }
        let _ = writeln!(
            svg,
            "\" fill=\"none\" stroke=\"{colour}\" stroke-width=\"{width}\" stroke-linejoin=\"round\" stroke-linecap=\"round\"/>"
        );
    };
    line(&mut planned.iter().copied(), PLANNED, 9);
    line(&mut driven.iter().map(|pose| pose.position), DRIVEN, 4);
    svg + "</svg>\n"
}
