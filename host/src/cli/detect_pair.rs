//! `wmr detect A B`: obstacles with their heights in two photos by two cameras.

use super::args::DetectArgs;
use super::detect::{describe, detection_document, read_photo};
use super::error::CliError;
use super::folder::Folder;
use super::input::{self, SeenPhoto};
use super::output::Output;
use serde_json::json;
use std::fmt::Write;
use std::path::Path;
use std::time::Instant;
use wmr::picture::stereo::pair_pictures;
use wmr::vision::{self, DetectOptions, PairDetection};

/// `wmr detect A B`.
pub(super) fn run(args: &DetectArgs, second: &Path, output: Output) -> Result<(), CliError> {
    let arena = input::arena_of(&args.vision)?;
    let camera = args.vision.camera.as_deref().unwrap_or(Path::new(""));
    let [a, b] = input::read_camera_pair(camera)?;
    let (bytes, others) = (read_photo(&args.photo)?, read_photo(second)?);
    let started = Instant::now();
    let photos = [vision::decode(&bytes)?, vision::decode(&others)?];
    let decode_time = started.elapsed();
    let options = DetectOptions {
        robot_radius: args.radius,
        keep_steps: args.steps.is_some(),
        ..DetectOptions::default()
    };
    let started = Instant::now();
    let seen = vision::detect_pair([&photos[0], &photos[1]], [&a, &b], arena, &options)?;
    let detect_time = started.elapsed();
    if let Some(folder) = &args.steps {
        let folder = Folder::create(folder)?;
        folder.pictures(&pair_pictures(&seen, args.radius))?;
        folder.pair(&bytes, &others)?;
    }
    let PairDetection { detection, .. } = seen;
    let heights: Vec<f64> =
        detection.obstacles.iter().filter_map(|obstacle| obstacle.height).collect();
    let photo = SeenPhoto { bytes, arena, empty: None, detection, decode_time, detect_time };
    let mut document = detection_document(&photo, args.radius);
    if let Some(fields) = document.as_object_mut() {
        fields.insert("heights".into(), json!(heights));
    }
    let mut text = describe(&photo);
    for (index, height) in heights.iter().enumerate() {
        let _ = writeln!(text, "  {}: {height:.3} m tall", index + 1);
    }
    output.result(&document, &text)
}
