//! Where the robot stands whose top or tag is seen.
//!
//! What is z above the floor appears λ = h / (h − z) times as far from the foot point of a camera at the height h,
//! and λ times as large: the place under it is `foot + (seen − foot) / λ`. Metres and radians in the arena frame.

use super::disc::Size;
use super::pose::{RobotTop, shown_lean};
use crate::geometry::{Point, Pose, wrap_angle};
use crate::vision::camera::{Camera, FOCAL_SPREAD, PlanMap, STATED_NOISE, Viewpoint};
use crate::vision::image::Photo;

/// What is known of the robot: the radius of its disc and the height of its top, metres.
#[derive(Clone, Copy, Debug)]
pub(crate) struct RobotBody {
    pub(crate) radius: f64,
    pub(crate) height: f64,
}

impl RobotBody {
    /// How large its top appears.
    pub(crate) fn top_size(self, camera: Option<&Camera>) -> Size {
        match camera.filter(|camera| camera.knows_height()) {
            Some(camera) => {
                let enlargement =
                    camera.viewpoint().map_or(1.0, |view| view.enlargement(self.height));
                Size::known(self.radius, enlargement)
            }
            None => Size::guessed(self.radius),
        }
    }

    /// Where it stands if its top is seen, from a viewpoint of which the height is known or guessed; from so far away
    /// that nothing leans without one.
    ///
    /// With a guess, the base beside the top tells if that is seen, else the guess and the top's size, each as far as
    /// it is to be trusted.
    pub(crate) fn under(
        self,
        photo: &Photo,
        map: &PlanMap,
        top: RobotTop,
        view: Option<Viewpoint>,
    ) -> Pose {
        let position = view.map_or(top.centre, |view| {
            let by_height = view.enlargement(self.height);
            let shown = || shown_lean(photo, map, top, view.foot, self.radius);
            let lean = match view.knows_height {
                true => by_height,
                false => shown().unwrap_or_else(|| self.likely_lean(by_height, top)),
            };
            lowered(top.centre, view.foot, lean)
        });
        Pose { position, heading: top.heading }
    }

    /// By how much that may be wrong where only a guess tells how its top leans, metres: it may not lean at all.
    pub(crate) fn doubt(self, photo: &Photo, map: &PlanMap, top: RobotTop, view: Viewpoint) -> f64 {
        if shown_lean(photo, map, top, view.foot, self.radius).is_some() {
            return 0.0;
        }
        let lean = self.likely_lean(view.enlargement(self.height), top);
        top.centre.distance(lowered(top.centre, view.foot, lean))
    }

    /// The mean of how much its top leans by the guessed height and by its size.
    fn likely_lean(self, by_height: f64, top: RobotTop) -> f64 {
        let by_size = (top.radius / self.radius).max(1.0);
        let [height, size] =
            [(by_height - 1.0) * FOCAL_SPREAD, STATED_NOISE].map(|sigma| sigma.powi(2));
        (by_height * size + by_size * height) / (height + size)
    }

    /// Where it stands if its tag, as high as its top, appears at a pose on the floor's plane; `mount` is the tag's
    /// pose in the robot's frame: x ahead, y to the left.
    pub(crate) fn under_tag(self, seen: Pose, mount: Pose, view: Option<Viewpoint>) -> Pose {
        let at = view.map_or(seen.position, |view| {
            lowered(seen.position, view.foot, view.enlargement(self.height))
        });
        let heading = wrap_angle(seen.heading - mount.heading);
        let (sin, cos) = heading.sin_cos();
        let Point { x, y } = mount.position;
        let position = Point::new(at.x - cos * x + sin * y, at.y - sin * x - cos * y);
        Pose { position, heading }
    }
}

/// The floor point under what appears at `point`, which leans away from `foot` by the factor `lean`.
fn lowered(point: Point, foot: Point, lean: f64) -> Point {
    Point::new(foot.x + (point.x - foot.x) / lean, foot.y + (point.y - foot.y) / lean)
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::FRAC_PI_2;

    const BODY: RobotBody = RobotBody { radius: 0.075, height: 0.5 };

    #[test]
    fn what_is_a_fifth_of_the_way_up_is_lowered_by_a_fifth() {
        let photo = Photo::from_rgb(64, 64, vec![[9; 3]; 4096]).unwrap();
        let arena = crate::geometry::Arena { width: 2.0, height: 2.0 };
        let corners = [[0.0, 63.0], [63.0, 63.0], [63.0, 0.0], [0.0, 0.0]];
        let map = PlanMap::from_corners(&photo, arena, corners, 0.0).unwrap();
        let view =
            Viewpoint { foot: Point::new(1.0, 0.0), height: 2.5, spread: 0.0, knows_height: true };
        let top = RobotTop {
            centre: Point::new(2.0, 1.0),
            radius: 0.09,
            heading: 0.3,
            certainty: 1.0,
            base: Point::new(2.0, 1.0),
        };
        let pose = BODY.under(&photo, &map, top, Some(view));
        assert!(pose.position.distance(Point::new(1.8, 0.8)) < 1e-12, "{pose:?}");
    }

    #[test]
    fn a_tag_beside_the_middle_and_turned_tells_where_the_robot_is() {
        // The robot looks up; its tag is 40 mm ahead and 10 mm to the left, its right edge to the left.
        let mount = Pose::new(0.04, 0.01, FRAC_PI_2);
        let pose = BODY.under_tag(Pose::new(0.99, 0.54, -2.0 * FRAC_PI_2), mount, None);
        assert!(pose.position.distance(Point::new(1.0, 0.5)) < 1e-12, "{pose:?}");
        assert!((pose.heading - FRAC_PI_2).abs() < 1e-12);
    }
}
