//! The robot near where it is expected. Metres and radians in the arena frame.

use crate::geometry::{Point, Pose, Rect};
use crate::shape::{Polygon, Shape};
use crate::vision::appearance::Look;
use crate::vision::boxes::Known;
use crate::vision::camera::PlanMap;
use crate::vision::image::Photo;
use crate::vision::options::DetectOptions;
use crate::vision::robot::{self, RobotTop, SeenRobot};
use crate::vision::tags::{self, TagDictionary, find_tags};

/// Tags are looked for in parts of the photo that begin at multiples of so many pixels: dark is told from light by squares
/// of them.
const ALIGNED: usize = 4;

/// How far around a robot its shadow and what it hides change, radii.
const ROBOT_REACH: f64 = 2.5;

/// A robot and what it changes around it.
pub(super) struct NearbyRobot {
    pub(super) seen: SeenRobot,
    pub(super) top: RobotTop,
    /// The floor around it, which looks otherwise when it has moved.
    pub(super) surroundings: Rect,
    /// The places that its tag covers.
    pub(super) covered: Vec<Shape>,
}

impl NearbyRobot {
    fn new(seen: SeenRobot, covered: Vec<Shape>, options: &DetectOptions) -> Self {
        let top = seen.top(options.robot_body(), options.robot_tag_mount);
        Self { seen, top, surroundings: around(top.centre, options), covered }
    }

    /// A robot that shows no mark.
    pub(super) fn told(pose: Pose, options: &DetectOptions) -> Self {
        Self::new(SeenRobot::Told(pose), Vec::new(), options)
    }
}

fn around(point: Point, options: &DetectOptions) -> Rect {
    Rect::around(&[point]).widened([ROBOT_REACH * options.robot_radius; 4])
}

/// The robot near where it is expected, by its tag in the photo as it was taken, or by its disc.
pub(super) fn robot(
    (photo, taken): (&Photo, &Photo),
    (map, known): (&PlanMap, &Known),
    options: &DetectOptions,
    expected: Pose,
) -> Option<NearbyRobot> {
    let window = around(expected.position, options);
    if let Some(id) = options.robot_tag {
        let tags = tags_in(taken, map, window);
        let tag = tags.iter().find(|tag| tag.id == id)?;
        let patches = tags.iter().filter_map(|tag| Polygon::new(tags::patch(tag, map)).ok());
        let covered = patches.map(Shape::from).collect();
        return Some(NearbyRobot::new(SeenRobot::Tag(tags::pose(tag, map)), covered, options));
    }
    let look = Look::within(photo, map, known.floor(), known.frames(), window);
    let size = options.robot_body().top_size(options.camera.as_ref());
    let top = robot::find(photo, map, &look, size)?;
    Some(NearbyRobot::new(SeenRobot::Disc(top), Vec::new(), options))
}

/// The tags in a window of the floor.
fn tags_in(photo: &Photo, map: &PlanMap, window: Rect) -> Vec<tags::Tag> {
    let seen = Rect::around(&window.corners().map(|corner| {
        let [x, y] = map.to_photo(corner);
        Point::new(x, y)
    }));
    let first = |edge: f64| edge.max(0.0) as usize / ALIGNED * ALIGNED;
    let after = |edge: f64, length: usize| (edge.max(0.0) as usize + 2).min(length);
    let (x0, y0) = (first(seen.x0), first(seen.y0));
    let (x1, y1) = (after(seen.x1, photo.width()), after(seen.y1, photo.height()));
    if x1 < x0 + ALIGNED || y1 < y0 + ALIGNED {
        return Vec::new();
    }
    let mut found = find_tags(&photo.part([x0, y0], [x1, y1]), &TagDictionary::usual());
    for corner in found.iter_mut().flat_map(|tag| &mut tag.corners_px) {
        *corner = [corner[0] + x0 as f64, corner[1] + y0 as f64];
    }
    found
}
