//! `wmr calibrate camera`: lens, height and place of one camera or two, from pictures of the arena.
//!
//! ```text
//! photos ─► the border in each ─► one camera for all ─► file for --camera
//! ```

use super::args::CalibrateCameraArgs;
use super::detect::read_photo;
use super::error::CliError;
use super::folder::replace_named;
use super::input::{read_bytes, read_picture};
use super::output::Output;
use std::collections::BTreeMap;
use std::fmt::Write;
use std::path::{Path, PathBuf};
use wmr::document::{CameraDocument, CamerasDocument};
use wmr::vision::{self, CalibratedCamera, KnownOfCamera, ObservedBorder, calibrate_camera};

/// Sides shifted by more than this, squared standard deviations, deserve advice.
const MUCH_STRAIN: f64 = 6.0;
/// A focal length less sure than this share of it deserves advice.
const UNSURE_FOCAL: f64 = 0.03;

/// `wmr calibrate camera`.
pub(crate) fn run(args: &CalibrateCameraArgs, output: Output) -> Result<(), CliError> {
    let cameras = cameras(args)?;
    let mut document = CamerasDocument { empty: None, cameras: BTreeMap::new() };
    let mut text = String::new();
    for camera in &cameras {
        let found = camera.calibrate(args, output)?;
        let _ = write!(text, "{}", describe(camera.name, &found));
        document.cameras.insert(camera.name.into(), camera_document(&found));
    }
    match &args.out {
        Some(path) => {
            if let Some(empty) = &args.empty {
                let name = keep_empty(empty, &args.photos, path)?;
                let _ = writeln!(text, "the picture of the empty arena is kept as {name}");
                document.empty = Some(name);
            }
            let file = format!("{:#}\n", serde_json::json!(document));
            replace_named(path, file.as_bytes(), "camera", is_camera)?;
            let photos = if cameras.len() > 1 { "PHOTO PHOTO_B" } else { "PHOTO" };
            let _ = writeln!(text, "use it: wmr detect {photos} --camera {}", path.display());
        }
        None => text += "nothing is written; add --out camera.json to keep it\n",
    }
    output.result(&document, &text)
}

/// Keeps the picture of the empty arena beside the camera's file; its name there.
fn keep_empty(empty: &Path, photos: &[PathBuf], camera: &Path) -> Result<String, CliError> {
    let picture = read_picture(empty)?;
    for photo in photos {
        vision::check_still(&read_picture(photo)?, &picture)?;
    }
    let ending = empty.extension().unwrap_or_default().to_string_lossy();
    let stem = camera.file_stem().unwrap_or_default().to_string_lossy();
    let name = format!("{stem}.empty.{ending}");
    let is_picture = |older: &[u8]| image::guess_format(older).is_ok();
    let bytes = read_bytes(empty)?;
    replace_named(&camera.with_file_name(&name), &bytes, "picture", is_picture)?;
    Ok(name)
}

/// Whether a file is a camera's.
pub(super) fn is_camera(older: &[u8]) -> bool {
    serde_json::from_slice::<serde_json::Map<_, _>>(older)
        .is_ok_and(|file| ["main", "a"].iter().any(|name| file.contains_key(*name)))
}

/// What is said of one camera.
struct Words<'a> {
    /// Its name in the file.
    name: &'static str,
    photos: &'a [PathBuf],
    elsewhere: &'a [PathBuf],
    known: KnownOfCamera,
    corners: Option<[[f64; 2]; 4]>,
}

/// The cameras that the words are about.
fn cameras(args: &CalibrateCameraArgs) -> Result<Vec<Words<'_>>, CliError> {
    let count = if args.second.is_empty() { 1 } else { 2 };
    for (name, given) in [
        ("--height", args.height.len()),
        ("--focal", args.focal.len()),
        ("--corners", args.corners.len()),
    ] {
        if given != 0 && given != count {
            let message = format!("{name} is given for {given} cameras, the photos are of {count}");
            let help = format!("give {name} for each camera: with --second two, else one");
            return Err(CliError::usage(message, help));
        }
    }
    let names = if count == 1 { ["main", ""] } else { ["a", "b"] };
    let words = |index: usize| Words {
        name: names[index],
        photos: [&args.photos, &args.second][index],
        elsewhere: &args.elsewhere,
        known: KnownOfCamera {
            height: args.height.get(index).copied(),
            focal: args.focal.get(index).copied(),
        },
        corners: args.corners.get(index).copied(),
    };
    Ok((0..count).map(words).collect())
}

impl Words<'_> {
    fn calibrate(
        &self,
        args: &CalibrateCameraArgs,
        output: Output,
    ) -> Result<CalibratedCamera, CliError> {
        let find = |path: &PathBuf, corners| {
            output.say(&format!("looking for the border in {}", path.display()));
            observe(path, args, corners)
        };
        let fixed: Vec<_> =
            self.photos.iter().map(|path| find(path, self.corners)).collect::<Result<_, _>>()?;
        let elsewhere: Vec<_> =
            self.elsewhere.iter().map(|path| find(path, None)).collect::<Result<_, _>>()?;
        Ok(calibrate_camera(args.arena, &fixed, &elsewhere, self.known)?)
    }
}

/// The border in one photo; an error names the photo, for there may be many.
fn observe(
    path: &Path,
    args: &CalibrateCameraArgs,
    corners: Option<[[f64; 2]; 4]>,
) -> Result<ObservedBorder, CliError> {
    let bytes = read_photo(path)?;
    let border =
        vision::decode(&bytes).and_then(|photo| ObservedBorder::find(&photo, args.arena, corners));
    border.map_err(|error| {
        let error = CliError::from(error);
        CliError { message: format!("{}: {}", path.display(), error.message), ..error }
    })
}

/// A camera as it stands in the file: what detect reads, and how sure it is.
fn camera_document(found: &CalibratedCamera) -> CameraDocument {
    CameraDocument {
        camera: found.camera.clone(),
        position: found.position,
        tilt: found.tilt,
        residual_px: found.residual,
        steps: found.steps,
        strain: found.strain,
        mistaken_side: found.mistaken.map(|side| side.to_string()),
        warnings: advice(found),
    }
}

/// What would make the camera surer, or right.
fn advice(found: &CalibratedCamera) -> Vec<String> {
    let share = found.spread.focal / found.camera.matrix[0][0];
    let mut advice = Vec::new();
    if share > UNSURE_FOCAL {
        advice.push(format!(
            "from a tilt of {:.0}° the border tells height and focal length only to {:.0} %; measure the height of the lens above the floor and add --height",
            found.tilt.to_degrees(),
            100.0 * share
        ));
    }
    let look = "to be sure, say with --corners where the floor's corners are";
    if let Some(side) = found.mistaken {
        advice.push(format!(
            "a shadow or a wall's top was probably taken for the border's {side} side; its place is told by the other three; {look}"
        ));
    } else if found.strain > MUCH_STRAIN {
        advice.push(format!(
            "no camera sees the border's sides quite like that: a shadow or a wall's top may have been taken for one; {look}"
        ));
    }
    advice
}

/// A camera, for people.
fn describe(name: &str, found: &CalibratedCamera) -> String {
    let (camera, spread) = (&found.camera, found.spread);
    let ([x, y, z], [sx, sy, sz]) = (found.position, spread.position);
    let ([[focal, _, u], [_, _, v], _], [cx, cy]) = (camera.matrix, spread.principal_point);
    let mut text = format!(
        "camera {name}, tilted by {:.1}°; {} steps of light along the border fit to {:.2} px\n",
        found.tilt.to_degrees(),
        found.steps,
        found.residual
    );
    let mut line = |what: &str, value: &str| {
        let _ = writeln!(text, "  {what:16} {value}");
    };
    line("height", &format!("{z:.3} ± {sz:.3} m"));
    line("above", &format!("({x:.3} ± {sx:.3}, {y:.3} ± {sy:.3}) m"));
    line("focal length", &format!("{focal:.1} ± {:.1} px", spread.focal));
    line("principal point", &format!("({u:.1} ± {cx:.1}, {v:.1} ± {cy:.1}) px"));
    line("lens k1", &format!("{:.4} ± {:.4}", camera.k1, spread.k1));
    for warning in advice(found) {
        let _ = writeln!(text, "warning: {warning}");
    }
    text
}
