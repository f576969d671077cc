//! What was seen in photos: `wmr detect` and `wmr calibrate camera`.

use crate::geometry::Pose;
use crate::scene::{Scene, SceneWithMargins};
use crate::vision::{Camera, Detection};
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;
use std::time::Duration;

/// `wmr detect --json`: a scene that `wmr plan` reads, and how it was seen.
#[derive(Clone, Debug, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
pub struct DetectionDocument {
    /// The scene, with a margin for every obstacle.
    #[serde(flatten)]
    pub scene: SceneWithMargins,
    /// The arena's corners in the photo, pixels: lower left, lower right, upper right, upper left.
    pub corners_px: [[f64; 2]; 4],
    /// The robot, if it was seen.
    pub robot: Option<Pose>,
    /// How surely the answer is right, 0 to 1.
    pub confidence: f64,
    /// What the user should know about this answer.
    pub warnings: Vec<String>,
    /// The picture of the empty arena that told the floor, if one was used.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub empty: Option<String>,
    /// How high each obstacle is, metres, where two cameras saw it.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub heights: Option<Vec<f64>>,
    /// How long it took.
    pub timing_ms: DetectionTiming,
}

/// How long seeing took, milliseconds.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
pub struct DetectionTiming {
    /// From the file's bytes to pixels.
    pub decode: f64,
    /// From pixels to obstacles.
    pub detect: f64,
}

impl DetectionDocument {
    /// What was seen as `scene`, decoded and detected in these times.
    pub fn new(
        scene: Scene,
        detection: &Detection,
        decode_time: Duration,
        detect_time: Duration,
    ) -> Self {
        let milliseconds = |time: Duration| time.as_secs_f64() * 1000.0;
        Self {
            scene: scene.into(),
            corners_px: detection.corners_px,
            robot: detection.robot,
            confidence: detection.confidence,
            warnings: detection.warnings.iter().map(ToString::to_string).collect(),
            empty: None,
            heights: None,
            timing_ms: DetectionTiming {
                decode: milliseconds(decode_time),
                detect: milliseconds(detect_time),
            },
        }
    }
}

/// `wmr calibrate camera --json`, and the file that it writes: cameras by name, `main`, or `a` and `b`.
#[derive(Clone, Debug, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
pub struct CamerasDocument {
    /// The picture of the empty arena that is kept beside the file, by name, if one was given.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub empty: Option<String>,
    /// The cameras.
    #[serde(flatten)]
    pub cameras: BTreeMap<String, CameraDocument>,
}

/// A calibrated camera: what `--camera` reads, and how sure it is.
#[derive(Clone, Debug, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
pub struct CameraDocument {
    /// The camera itself.
    #[serde(flatten)]
    pub camera: Camera,
    /// The lens's place, metres: x and y of the point below it, and its height.
    pub position: [f64; 3],
    /// The angle between the camera's axis and straight down, radians.
    pub tilt: f64,
    /// The root mean square distance of the border from where the camera expects it, pixels.
    pub residual_px: f64,
    /// How many steps of light along the border count.
    pub steps: usize,
    /// How far the border had to be bent for a camera to see it so, squared standard deviations.
    pub strain: f64,
    /// The side of the border that was probably taken for another edge.
    pub mistaken_side: Option<String>,
    /// What would make the camera surer, or right.
    pub warnings: Vec<String>,
}
