//! `wmr detect A B`: obstacles with their heights in two photos by two cameras.

use super::args::DetectArgs;
use super::detect::{describe, detection_document, read_photo};
use super::error::CliError;
use super::folder::Folder;
use super::input::{self, SeenPhoto};
use super::output::Output;
use std::fmt::Write;
use std::path::Path;
use std::time::Instant;
use wmr::document::DetectionDocument;
use wmr::picture::stereo::pair_pictures;
use wmr::vision::{self, DetectOptions, PairDetection};

/// `wmr detect A B`.
pub(super) fn run(args: &DetectArgs, second: &Path, output: Output) -> Result<(), CliError> {
    let arena = input::arena_of(&args.vision)?;
    let Some(camera) = args.vision.camera.as_deref() else {
        let message = "two photos need --camera";
        return Err(CliError::usage(
            message,
            "wmr calibrate camera A --second B ... --out FILE makes one",
        ));
    };
    let [a, b] = input::read_camera_pair(camera)?;
    let (bytes, others) = (read_photo(&args.photo)?, read_photo(second)?);
    let started = Instant::now();
    let photos = [vision::decode(&bytes)?, vision::decode(&others)?];
    let decode_time = started.elapsed();
    let usual = DetectOptions::default();
    let options = DetectOptions {
        robot_radius: args.radius,
        robot_height: args.vision.robot_height.unwrap_or(usual.robot_height),
        keep_steps: args.steps.is_some(),
        ..usual
    };
    let started = Instant::now();
    let seen = vision::detect_pair([&photos[0], &photos[1]], [&a, &b], arena, &options)?;
    let detect_time = started.elapsed();
    if let Some(folder) = &args.steps {
        let folder = Folder::create(folder)?;
        folder.pictures(&pair_pictures(&seen, args.radius))?;
        folder.pair(&bytes, &others)?;
        folder.index("What wmr sees in two photos")?;
    }
    let PairDetection { detection, .. } = seen;
    let heights: Vec<f64> =
        detection.obstacles.iter().filter_map(|obstacle| obstacle.height).collect();
    let photo = SeenPhoto { bytes, arena, empty: None, detection, decode_time, detect_time };
    let mut text = describe(&photo);
    for (index, height) in heights.iter().enumerate() {
        let _ = writeln!(text, "  {}: {height:.3} m tall", index + 1);
    }
    let document =
        DetectionDocument { heights: Some(heights), ..detection_document(&photo, args.radius) };
    output.result(&document, &text)
}
