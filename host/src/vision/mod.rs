//! Finds the arena, the obstacles and the robot in an overhead picture [Alghannam, Sec. II].
//!
//! ```text
//! bytes ─► photo ─► lines ─► quads ─► border ─► plan map ─► look (floor, shadow) ─► robot
//!                                        ▲                    │
//!                          camera, corners                    ├─► paper steps (edges … borders) ─► rectangles
//!                                                             └─► evidence ─► boxes (lean, lamp) ─► sharpen
//!                                                                                               │
//!                                                    Detection: metres, with margins ◄──────────┘
//! ```
//! [`detect`] is the whole flow; each of the paper's steps is a function of its own
//! ([`brightness_view`], [`edge_magnitude`], [`average_filter`], [`histogram_mean`], [`threshold`], [`invert`],
//! [`detect_obstacles`], [`enlarge`], [`obstacle_borders`]), usable alone. Pixels never leave this module
//! but as `corners_px`; everything else is metres and radians in the arena frame. Two pictures by two
//! calibrated cameras give heights too: [`detect_pair`].
//!
//! `python3 host/benches/vision_peer.py SCENES` compares time with an OpenCV baseline on the same pictures,
//! and shows time and memory over the size of the photo.

mod align;
mod arena;
mod balance;
mod border;
mod border_light;
mod boxes;
mod brightness_view;
mod camera;
mod camera_fit;
mod candidates;
mod cover;
mod detect;
mod disc;
mod edges;
mod error;
mod evidence;
mod faults;
mod floor;
mod implausible;
mod lamp;
mod lattice;
mod leaning;
mod lines;
mod look;
mod mask;
mod merging;
mod paper;
mod paper_method;
mod photo;
mod plan_map;
mod plan_view;
mod profile;
mod proposals;
mod quads;
mod raster;
mod rectangles;
mod robot;
mod robust;
mod runs;
mod shadow;
mod sharpen;
mod sides;
mod stereo;
mod uncovered;
mod viewpoint;

pub use brightness_view::brightness_view;
pub use camera::{Camera, CameraModel, CameraSpread};
pub use camera_fit::{CalibratedCamera, KnownOfCamera, ObservedBorder, calibrate_camera};
pub use detect::{DetectOptions, Detection, Method, detect};
pub use edges::{average_filter, edge_magnitude, histogram_mean, invert, threshold};
pub use error::VisionError;
pub use faults::check_picture;
pub use mask::{ObstacleMask, Segment, enlarge, obstacle_borders, segments};
pub use paper::{PaperSteps, brightness, detect_obstacles, paper_obstacles, paper_steps};
pub use paper_method::Steps;
pub use photo::{MAX_PIXELS, Photo, decode, srgb_code};
pub use plan_map::{PlanMap, homography};
pub use plan_view::{PlanFrame, plan_view};
pub use raster::Raster;
pub use rectangles::{CellRect, rectangles};
pub use stereo::{PairDetection, PairSteps, RaisedBox, detect_pair};
