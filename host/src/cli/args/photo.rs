//! How a photo is read.

use crate::cli::quantity;
use clap::{Args, ValueEnum};
use std::path::PathBuf;
use wmr::geometry::Arena;
use wmr::scene::Goal;
use wmr::shape::Circle;

/// How a photo is read.
#[derive(Clone, Debug, Default, Args)]
pub(crate) struct VisionArgs {
    /// Inner size of the arena, such as 1.6x2.0; needed for a photo.
    #[arg(long, value_parser = quantity::arena, value_name = "WxH")]
    pub(crate) arena: Option<Arena>,
    /// The floor's corners in the photo, pixels, counter-clockwise from the lower left: "x,y x,y x,y x,y".
    #[arg(long, value_parser = quantity::corners, allow_hyphen_values = true, value_name = "CORNERS")]
    pub(crate) corners: Option<[[f64; 2]; 4]>,
    /// Which corner of the picture is (0, 0); the width runs from there counter-clockwise. Without it: the corner lowest
    /// at the left, or where --corners begin.
    #[arg(long, value_enum, conflicts_with = "camera", value_name = "CORNER")]
    pub(crate) origin: Option<CornerName>,
    /// Tags (ArUco 4x4 to 7x7, AprilTag) stand in the arena's four corners: which of their points is the corner.
    #[arg(long, value_enum, conflicts_with = "corners", value_name = "POINT")]
    pub(crate) tags: Option<TagPointName>,
    /// The tag on the robot's top: in its middle, its right edge ahead, unless --robot-tag-at says otherwise.
    #[arg(long, value_name = "ID")]
    pub(crate) robot_tag: Option<usize>,
    /// Where the tag is on the robot: how far its centre is ahead and to the left of the robot's middle, and by how
    /// much its right edge is turned counter-clockwise from straight ahead.
    #[arg(long, value_parser = quantity::place, allow_hyphen_values = true, requires = "robot_tag", value_name = "X,Y[,DEG]")]
    pub(crate) robot_tag_at: Option<Goal>,
    /// Height of the robot's top, or of its tag, above the floor; 0.07 without.
    #[arg(long, value_parser = quantity::distance, value_name = "H")]
    pub(crate) robot_height: Option<f64>,
    /// A tag that lies where the robot is to go.
    #[arg(long, value_name = "ID")]
    pub(crate) goal_tag: Option<usize>,
    /// A disc in which nothing is an obstacle: x,y and radius; may be given several times.
    #[arg(long, value_parser = quantity::disc, allow_hyphen_values = true, value_name = "X,Y,R")]
    pub(crate) ignore: Vec<Circle>,
    /// A calibrated camera: JSON with model, image_size, K, k1, R and t under "main", or for two pictures
    /// under "a" and "b"; "empty" may name a picture of the empty arena beside it.
    #[arg(long, value_name = "FILE")]
    pub(crate) camera: Option<PathBuf>,
    /// A picture of the empty arena by the same camera, which has not moved since: what differs from it is an
    /// obstacle, whatever the floor looks like.
    #[arg(long, value_name = "PHOTO")]
    pub(crate) empty: Option<PathBuf>,
    /// How obstacles are found.
    #[arg(long, value_enum, default_value_t = MethodName::Robust)]
    pub(crate) method: MethodName,
}

/// A corner of the arena as the picture shows it.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(crate) enum CornerName {
    LowerLeft,
    LowerRight,
    UpperRight,
    UpperLeft,
}

impl From<CornerName> for wmr::vision::PictureCorner {
    fn from(name: CornerName) -> Self {
        match name {
            CornerName::LowerLeft => Self::LowerLeft,
            CornerName::LowerRight => Self::LowerRight,
            CornerName::UpperRight => Self::UpperRight,
            CornerName::UpperLeft => Self::UpperLeft,
        }
    }
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(crate) enum TagPointName {
    /// The corner of the black square furthest from the arena's middle.
    Outer,
    /// Its centre.
    Centre,
    /// The corner of the black square nearest to the arena's middle.
    Inner,
}

impl From<TagPointName> for wmr::vision::TagPoint {
    fn from(name: TagPointName) -> Self {
        match name {
            TagPointName::Outer => Self::Outer,
            TagPointName::Centre => Self::Centre,
            TagPointName::Inner => Self::Inner,
        }
    }
}

#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, ValueEnum)]
pub(crate) enum MethodName {
    /// Against uneven light, shadows and coloured floors.
    #[default]
    Robust,
    /// The paper's own steps.
    Paper,
}
