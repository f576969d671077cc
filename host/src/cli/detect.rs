//! `wmr detect`: arena, obstacles and robot in a photo.

use super::args::DetectArgs;
use super::detect_pair;
use super::error::{CliError, Exit};
use super::folder::Folder;
use super::input::{self, SeenPhoto, Sight};
use super::output::Output;
use std::path::Path;
use std::time::Duration;
use wmr::document::DetectionDocument;
use wmr::geometry::Rect;
use wmr::shape::Shape;

/// `wmr detect`.
pub(crate) fn run(args: &DetectArgs, output: Output) -> Result<(), CliError> {
    if let Some(second) = &args.photo_b {
        return detect_pair::run(args, second, output);
    }
    let bytes = read_photo(&args.photo)?;
    let folder = args.steps.as_deref().map(Folder::create).transpose()?;
    if let Some(folder) = &folder {
        folder.border(&bytes, &args.vision)?;
    }
    let seen = input::see(
        bytes,
        &args.vision,
        Sight {
            radius: Some(args.radius),
            resolution: 1.0,
            keep_steps: args.steps.is_some(),
            start: None,
        },
    )?;
    if let Some(folder) = &folder {
        folder.vision(&seen, args.radius)?;
        folder.index("What wmr sees in a photo")?;
    }
    output.result(&detection_document(&seen, args.radius), &describe(&seen))
}

/// The bytes of a photo; an empty file is none.
pub(super) fn read_photo(path: &Path) -> Result<Vec<u8>, CliError> {
    let bytes = input::read_bytes(path)?;
    if bytes.is_empty() {
        let message = format!("{} is empty", path.display());
        return Err(CliError::new(
            Exit::File,
            "file.empty",
            message,
            "give a photo, such as a JPEG",
        ));
    }
    Ok(bytes)
}

/// The document of `wmr detect --json`.
pub(crate) fn detection_document(seen: &SeenPhoto, radius: f64) -> DetectionDocument {
    DetectionDocument {
        empty: seen.empty.as_ref().map(|path| path.display().to_string()),
        ..DetectionDocument::new(
            seen.scene(Some(radius)),
            &seen.detection,
            seen.decode_time,
            seen.detect_time,
        )
    }
}

fn milliseconds(duration: Duration) -> f64 {
    duration.as_secs_f64() * 1000.0
}

/// Where a shape lies, for people.
fn shape_text(shape: &Shape) -> String {
    let Rect { x0, y0, x1, y1 } = shape.bounds();
    let place = format!("x {x0:.3} to {x1:.3} m, y {y0:.3} to {y1:.3} m");
    match shape {
        Shape::Rect(_) => place,
        Shape::Circle(circle) => format!("{place}, a disc of radius {:.3} m", circle.radius),
        Shape::Polygon(polygon) => format!("{place}, {} corners", polygon.corners().len()),
    }
}

/// What was seen, for people.
pub(crate) fn describe(seen: &SeenPhoto) -> String {
    let detection = &seen.detection;
    let mut text = format!(
        "{} obstacles, confidence {:.2}, {:.0} ms\n",
        detection.obstacles.len(),
        detection.confidence,
        milliseconds(seen.decode_time + seen.detect_time),
    );
    if let Some(empty) = &seen.empty {
        text += &format!("the floor is that of {}\n", empty.display());
    }
    for (index, obstacle) in detection.obstacles.iter().enumerate() {
        text += &format!("  {}: {}\n", index + 1, shape_text(&obstacle.footprint));
    }
    match detection.robot {
        Some(pose) => text += &format!("robot at {}\n", super::mission::place(pose)),
        None => text += "no robot seen\n",
    }
    detection.warnings.iter().for_each(|warning| text += &format!("warning: {warning}\n"));
    text
}
