//! Where a floor point is in the photo: camera model, the map between floor and photo, the camera's pose, and
//! the fit of that map to the border's edges.

pub(crate) mod border_fit;
mod floor_map;
mod model;
mod pose;

pub(crate) use border_fit::side_point;
pub use floor_map::{PlanMap, homography};
pub use model::{Camera, CameraModel, CameraSpread};
pub(crate) use pose::{
    COLUMN_NOISE, FOCAL_SPREAD, STATED_NOISE, StatedFit, USUAL_FOCAL, Viewpoint, columns,
};
