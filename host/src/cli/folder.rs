//! A folder of results: photo, scene, plan, run, and a picture of each step.

use super::error::{CliError, Exit};
use super::input::{Input, SeenPhoto};
use super::run::Run;
use super::way::PlannedWay;
use serde_json::json;
use std::path::{Path, PathBuf};
use wmr::legs::{from_wire, planned_poses};
use wmr::picture;
use wmr::picture::drive::drive_picture;
use wmr::picture::motion::{TimedPose, motion_svg};
use wmr::picture::vision::NamedPicture;

/// An existing folder.
#[derive(Debug)]
pub(crate) struct Folder(PathBuf);

impl Folder {
    /// Creates the folder if need be; what is in it stays, but for files of the same names.
    pub(crate) fn create(path: &Path) -> Result<Self, CliError> {
        std::fs::create_dir_all(path).map_err(|error| {
            let message = format!("{}: {error}", path.display());
            CliError::new(Exit::File, "file.write", message, "choose another folder")
        })?;
        Ok(Self(path.to_owned()))
    }

    /// Creates the folder for a drive and writes down all that is known before the robot moves: a
    /// folder that cannot be written costs no drive, and a drive that fails leaves its plan.
    pub(crate) fn begin(path: &Path, input: &Input, way: &PlannedWay) -> Result<Self, CliError> {
        let folder = Self::create(path)?;
        folder.input(input, way.file.scene.robot_radius)?;
        folder.plan(way)?;
        Ok(folder)
    }

    /// Writes down what the command worked on.
    pub(crate) fn input(&self, input: &Input, radius: f64) -> Result<(), CliError> {
        match input {
            Input::Photo(seen) => self.vision(seen, radius),
            Input::Scene(_) | Input::Plan(_) => Ok(()),
        }
    }

    /// Writes down a photo and the steps of seeing it.
    pub(crate) fn vision(&self, seen: &SeenPhoto, radius: f64) -> Result<(), CliError> {
        self.write("photo", &seen.bytes)?;
        self.pictures(&seen.pictures(radius))
    }

    /// Writes down two photos of one arena.
    pub(crate) fn pair(&self, first: &[u8], second: &[u8]) -> Result<(), CliError> {
        self.write("photo_a", first)?;
        self.write("photo_b", second)
    }

    /// Writes down pictures of steps.
    pub(crate) fn pictures(&self, pictures: &[NamedPicture]) -> Result<(), CliError> {
        pictures.iter().try_for_each(|picture| self.write(picture.name, &picture.bytes))
    }

    /// Writes down a way and the steps of finding it.
    pub(crate) fn plan(&self, way: &PlannedWay) -> Result<(), CliError> {
        self.write("scene.json", format!("{}\n", json!(way.file.scene)).as_bytes())?;
        self.write("plan.json", format!("{}\n", json!(way.file)).as_bytes())?;
        let Some(plan) = &way.plan else { return Ok(()) };
        let scene = &way.file.scene;
        if let Some(stages) = &plan.grid {
            self.write(
                "10_border_lines.svg",
                picture::grid::border_lines(scene, stages).as_bytes(),
            )?;
            self.write("11_mini_matrix.svg", picture::grid::mini_matrix(scene, stages).as_bytes())?;
            self.write(
                "12_traps_closed.svg",
                picture::grid::closed_traps(scene, stages).as_bytes(),
            )?;
            if let Some(tree) = &stages.tree {
                self.write("13_tree.svg", picture::plan::path_tree(tree, stages).as_bytes())?;
            }
        }
        if let Some(stages) = &plan.fuzzy {
            let picture = picture::fuzzy::membership(scene, plan, stages);
            self.write("13_membership.svg", picture.as_bytes())?;
        }
        self.write("14_path.svg", picture::plan::path(scene, plan, &way.options).as_bytes())
    }

    /// Writes down a run; of a photo, also its path over the plan view.
    pub(crate) fn run(&self, input: &Input, way: &PlannedWay, run: &Run) -> Result<(), CliError> {
        let planned: Vec<_> = planned_poses(run.rest(), &run.limits)
            .into_iter()
            .map(|(time, pose)| TimedPose { time, pose })
            .collect();
        let measured: Vec<_> = run
            .samples
            .iter()
            .map(|sample| TimedPose { time: sample.time, pose: from_wire(sample.telemetry.pose) })
            .collect();
        self.write("run.jsonl", run.lines().as_bytes())?;
        self.write("15_motion.svg", motion_svg(&planned, &measured).as_bytes())?;
        let Input::Photo(seen) = input else { return Ok(()) };
        let Some(steps) = &seen.detection.steps else { return Ok(()) };
        let driven: Vec<_> = measured.iter().map(|at| at.pose).collect();
        let radius = way.file.scene.robot_radius;
        let picture = drive_picture(steps, &way.file.waypoints, &driven, radius);
        self.write("16_drive.svg", picture.as_bytes())
    }

    fn write(&self, name: &str, bytes: &[u8]) -> Result<(), CliError> {
        write_file(&self.0.join(name), bytes)
    }
}

/// Puts a file in the place of another, whole or not at all, whenever this program may be killed.
///
/// What is no file, such as a pipe, is written to.
pub(crate) fn replace_file(path: &Path, bytes: &[u8]) -> Result<(), CliError> {
    // A link stays one: what it leads to is replaced.
    let path = &std::fs::canonicalize(path).unwrap_or_else(|_| path.to_owned());
    if path.exists() && !path.is_file() {
        return write_file(path, bytes);
    }
    let mut name = path.file_name().unwrap_or_default().to_owned();
    name.push(format!(".{}.new", std::process::id()));
    let new = path.with_file_name(name);
    let replaced = std::fs::write(&new, bytes).and_then(|()| std::fs::rename(&new, path));
    replaced.map_err(|error| {
        // Not there is as good as removed.
        let _ = std::fs::remove_file(&new);
        write_error(path, &error)
    })
}

/// Writes a file whole.
pub(crate) fn write_file(path: &Path, bytes: &[u8]) -> Result<(), CliError> {
    std::fs::write(path, bytes).map_err(|error| write_error(path, &error))
}

/// Writes a file that a person named: over an older one of its own kind, never over anything else.
pub(crate) fn write_named(
    path: &Path,
    bytes: &[u8],
    kind: &str,
    is_kind: impl Fn(&[u8]) -> bool,
) -> Result<(), CliError> {
    // A file that cannot be read is no reason: writing says what is wrong with it.
    let older = std::fs::read(path).unwrap_or_default();
    if older.is_empty() || is_kind(&older) {
        return write_file(path, bytes);
    }
    let message = format!("{} is there and is no {kind}; it stays as it is", path.display());
    Err(CliError::new(Exit::Usage, "file.exists", message, "give another name to write to"))
}

/// Whether a file is JSON that names this format at its head.
pub(crate) fn has_format(bytes: &[u8], format: &str) -> bool {
    #[derive(serde::Deserialize)]
    struct Head {
        format: String,
    }
    serde_json::from_slice::<Head>(bytes).is_ok_and(|head| head.format == format)
}

fn write_error(path: &Path, error: &std::io::Error) -> CliError {
    let message = format!("{}: {error}", path.display());
    CliError::new(Exit::File, "file.write", message, "choose another place")
}
