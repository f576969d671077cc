//! A folder of frames: a PNG each, and what is known of it as a line in `frames.jsonl`.
//!
//! A picture has its name only when it is whole, so that a program may take each as it comes.

use crate::cli::calibrate_camera::is_camera;
use crate::cli::error::{CliError, Exit};
use crate::cli::folder::{replace_named, write_error};
use hil_sim::camera::{Frame, Lens};
use image::ExtendedColorType;
use image::ImageEncoder;
use image::codecs::png::{CompressionType, FilterType, PngEncoder};
use serde_json::json;
use std::fs::File;
use std::io::Write;
use std::path::{Path, PathBuf};
use wmr::document::FrameLine;
use wmr::geometry::Pose;
use wmr::vision::Camera;

/// The name of the list of frames.
const LIST: &str = "frames.jsonl";

/// A folder that fills.
#[derive(Debug)]
pub(super) struct Files {
    folder: PathBuf,
    list: File,
    count: u32,
}

impl Files {
    /// Creates the folder, with the camera's file; one that holds frames already is left alone.
    pub(super) fn create(folder: &Path, lens: &Lens) -> Result<Self, CliError> {
        std::fs::create_dir_all(folder).map_err(|error| write_error(folder, &error))?;
        let path = folder.join(LIST);
        let list = File::create_new(&path).map_err(|error| match error.kind() {
            std::io::ErrorKind::AlreadyExists => {
                let message = format!("{} holds the frames of another run", folder.display());
                CliError::new(Exit::File, "file.exists", message, "name another folder")
            }
            _ => write_error(&path, &error),
        })?;
        let camera = format!("{:#}\n", json!({"main": Camera::from(lens)}));
        replace_named(&folder.join("camera.json"), camera.as_bytes(), "camera", is_camera)?;
        Ok(Self { folder: folder.to_owned(), list, count: 0 })
    }

    /// Saves a frame.
    pub(super) fn save(&mut self, frame: &Frame) -> Result<(), CliError> {
        self.count += 1;
        let name = format!("frame_{:06}.png", self.count);
        let is_picture = |older: &[u8]| image::guess_format(older).is_ok();
        replace_named(&self.folder.join(&name), &png(frame)?, "picture", is_picture)?;
        let robot = frame.stage.robot();
        let line = FrameLine {
            file: name,
            exposed: frame.exposed.as_secs_f64(),
            delivered: frame.delivered.as_secs_f64(),
            true_pose: robot.map(Pose::from),
            moving: frame.stage.movers().map(|body| body.shape.outline()).collect(),
        };
        writeln!(self.list, "{}", json!(line))
            .map_err(|error| write_error(&self.folder.join(LIST), &error))
    }
}

/// The picture file of a frame.
pub(in crate::cli) fn png(frame: &Frame) -> Result<Vec<u8>, CliError> {
    let mut bytes = Vec::new();
    // Filters that follow the picture make the files of a noisy camera no smaller, but take time.
    PngEncoder::new_with_quality(&mut bytes, CompressionType::Fast, FilterType::Up)
        .write_image(&frame.rgb, frame.width as u32, frame.height as u32, ExtendedColorType::Rgb8)
        .map_err(|error| super::not_encoded(&error))?;
    Ok(bytes)
}
