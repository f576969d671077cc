//! Words about the camera over a simulated robot.

use super::super::quantity;
use clap::Args;
use std::path::PathBuf;
use std::time::Duration;

/// The camera of `wmr sim`.
#[derive(Clone, Debug, Args)]
pub(crate) struct CameraArgs {
    /// Save what a camera over the arena sees into this folder: PNG pictures, frames.jsonl with their times
    /// and the truth, and camera.json for detect --camera.
    #[arg(long, value_name = "DIR", conflicts_with = "lockstep")]
    pub(crate) camera_out: Option<PathBuf>,
    /// Offer the camera's pictures at this address or port, such as 127.0.0.1:8080 or 8080: the stream
    /// (MJPEG) at /stream, the newest picture at /snapshot.jpg.
    #[arg(long, value_name = "ADDR", conflicts_with_all = ["lockstep", "scenario"])]
    pub(crate) camera_http: Option<String>,
    /// The size of the camera's pictures, pixels.
    #[arg(long, value_parser = quantity::picture_size, default_value = "640x480", value_name = "WxH")]
    pub(crate) camera_size: [usize; 2],
    /// How many pictures it takes in a second.
    #[arg(long, value_parser = quantity::frame_rate, default_value = "10", value_name = "N")]
    pub(crate) camera_rate: f64,
    /// From a picture's exposure until it is there.
    #[arg(long, value_parser = quantity::latency, default_value = "80ms", value_name = "TIME")]
    pub(crate) camera_latency: Duration,
}

impl CameraArgs {
    /// Whether there is a camera at all.
    pub(crate) fn is_used(&self) -> bool {
        self.camera_out.is_some() || self.camera_http.is_some()
    }
}
