//! What a caller of vision knows of camera, arena and robot, and wants to be found. Pixels of the photo, metres and
//! radians.

use crate::geometry::Pose;
use crate::shape::Circle;
use crate::vision::border::PictureCorner;
use crate::vision::camera::{Camera, PlanMap};
use crate::vision::image::Photo;
use crate::vision::robot::RobotBody;
use crate::vision::tags::TagPoint;

/// The robot radius of the paper's experiment, metres [Alghannam, Sec. V].
const PAPER_RADIUS: f64 = 0.075;
/// The height of the robot's top above the floor, metres, if nobody says.
const USUAL_ROBOT_HEIGHT: f64 = 0.07;

/// How obstacles are told from the floor.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Method {
    /// By a model of the floor's colour.
    #[default]
    Robust,
    /// By the paper's edges and near-white floor [Alghannam, Sec. II].
    Paper,
}

/// What the caller knows and wants.
#[derive(Clone, Debug, PartialEq)]
pub struct DetectOptions {
    /// How obstacles are told from the floor.
    pub method: Method,
    /// The arena's corners in the photo, pixels: lower left, lower right, upper right, upper left.
    /// They are searched for if not given.
    pub corners: Option<[[f64; 2]; 4]>,
    /// Which corner of the picture is the arena's origin. If nobody says, given corners begin there; else it is the
    /// lower left one, or the lower right one where the arena's size shows that its width runs up.
    pub origin: Option<PictureCorner>,
    /// The camera, if it is calibrated; corners are then not looked for.
    pub camera: Option<Camera>,
    /// Where floor points are in the photo, if an earlier picture by the same camera has told, which has not
    /// moved since; the border is then not looked for.
    pub map: Option<PlanMap>,
    /// Which point of the tags in the arena's corners is its corner, if there are such tags.
    pub tags: Option<TagPoint>,
    /// The number of the tag on the robot's top, if it has one.
    pub robot_tag: Option<usize>,
    /// Where that tag is on the robot: how far its centre is ahead and to the left of the robot's middle, metres, and
    /// which way its right edge points from straight ahead, radians.
    pub robot_tag_mount: Pose,
    /// The number of a tag that lies where the robot is to go.
    pub goal_tag: Option<usize>,
    /// Where the robot stands if it has no mark: what is seen there is the robot.
    pub robot_at: Option<Pose>,
    /// Places where nothing is an obstacle.
    pub ignored: Vec<Circle>,
    /// The radius of the robot's disc, metres.
    pub robot_radius: f64,
    /// The height of the robot's top above the floor, metres.
    pub robot_height: f64,
    /// Whether the pictures of the steps are kept.
    pub keep_steps: bool,
    /// A picture of the empty arena by the same camera, which has not moved since: the floor is then what it
    /// shows. The paper's method does without.
    pub empty: Option<Photo>,
}

impl DetectOptions {
    /// What the robot is like.
    pub(super) fn robot_body(&self) -> RobotBody {
        RobotBody { radius: self.robot_radius, height: self.robot_height }
    }
}

impl Default for DetectOptions {
    fn default() -> Self {
        Self {
            method: Method::Robust,
            corners: None,
            origin: None,
            camera: None,
            map: None,
            tags: None,
            robot_tag: None,
            robot_tag_mount: Pose::new(0.0, 0.0, 0.0),
            goal_tag: None,
            robot_at: None,
            ignored: Vec::new(),
            robot_radius: PAPER_RADIUS,
            robot_height: USUAL_ROBOT_HEIGHT,
            keep_steps: false,
            empty: None,
        }
    }
}
