//! Finds the arena, the obstacles and the robot in an overhead picture [Alghannam, Sec. II].
//!
//! ```text
//! bytes ─► photo ─► lines ─► quads ─► border ─► floor map ─► plan view ─► floor and shadow ─► robot
//!                                        ▲                                     │
//!                          camera, corners                                     ├─► paper's steps ─► rectangles
//!                                                                              └─► evidence ─► boxes ─► refined edges
//!                                                                                                       │
//!                                                    Detection: metres, with margins ◄── what is left ◄─┘
//! ```
//! The folders stand in the order of the flow; each names only those above it:
//!
//! | folder | holds |
//! |---|---|
//! | `image` | photo, rasters, connected components, rectangles, edge profiles, faults of a picture; no metres |
//! | `tags` | square tags (ArUco, AprilTag): which they are, where their corners lie |
//! | `camera` | where a floor point is in the photo: camera model, floor map, camera pose, fit to the border's edges |
//! | `plan_view` | the floor seen straight from above |
//! | `empty` | the photo over an even floor, by a picture of the empty arena |
//! | `appearance` | what floor and shadow look like, and which cells are neither |
//! | `border` | lines, quads, the choice of the border, the light along its sides |
//! | `robot` | the robot's top and its heading |
//! | `outline` | the polygon or disc that a contour is |
//! | `boxes` | obstacles from one picture: evidence, search, refined edges with margins, and what no box explains |
//! | `sequence` | pictures one after the other: only what has changed is read again |
//! | `stereo` | obstacles and their heights from two pictures |
//! | `calibrate` | a camera from pictures of the arena's border |
//! | `paper` | the paper's own steps |
//!
//! [`detect`] is the whole flow; each of the paper's steps is a function of its own
//! ([`brightness_view`], [`edge_magnitude`], [`average_filter`], [`histogram_mean`], [`threshold`], [`invert`],
//! [`detect_obstacles`], [`enlarge`], [`obstacle_borders`]), usable alone. Pixels never leave this module
//! but as `corners_px` and as candidates for the border to be drawn; everything else is metres and radians in the arena frame. Two pictures by two
//! calibrated cameras give heights too: [`detect_pair`].
//!
//! `python3 host/benches/vision_peer.py SCENES` compares time with an OpenCV baseline on the same pictures,
//! and shows time and memory over the size of the photo.

mod appearance;
mod border;
mod boxes;
mod calibrate;
mod camera;
mod detect;
mod empty;
mod error;
mod floor_clarity;
mod image;
mod least_squares;
mod locate;
mod marks;
mod options;
mod outline;
mod paper;
mod plan_view;
mod robot;
mod sequence;
mod stereo;
mod tags;
mod warning;

pub use border::{BorderCandidates, PictureCorner, SeenBorder, border_candidates};
pub use calibrate::{CalibratedCamera, KnownOfCamera, ObservedBorder, calibrate_camera};
pub use camera::{Camera, CameraModel, CameraSpread, PlanMap, homography};
pub use detect::{Detection, detect};
pub use empty::check_still;
pub use error::VisionError;
pub use image::{
    CellRect, MAX_PIXELS, Photo, Raster, check_picture, decode, rectangles, srgb_code,
};
pub use options::{DetectOptions, Method};
pub use paper::{
    ObstacleMask, PaperSteps, Segment, Steps, average_filter, brightness, detect_obstacles,
    edge_magnitude, enlarge, histogram_mean, invert, obstacle_borders, paper_obstacles,
    paper_steps, segments, threshold,
};
pub use plan_view::{PlanFrame, brightness_view, plan_view};
pub use sequence::Sequence;
pub use stereo::{PairDetection, PairSteps, RaisedBox, detect_pair};
pub use tags::{Tag, TagDictionary, TagPoint, find_tags};
pub use warning::Warning;
