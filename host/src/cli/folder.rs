//! A folder of results: photo, scene, plan, run, and a picture of each step.

use super::args::VisionArgs;
use super::error::{CliError, Exit};
use super::input::{Input, SeenPhoto, was_read};
use super::replay;
use super::run::Run;
use super::way::PlannedWay;
use serde_json::json;
use std::path::{Path, PathBuf};
use wmr::legs::{from_wire, planned_poses};
use wmr::picture;
use wmr::picture::drive::drive_picture;
use wmr::picture::index::{INDEX_HEAD, index_html};
use wmr::picture::motion::{TimedPose, motion_svg};
use wmr::picture::progress::progress_svg;
use wmr::picture::vision::{NamedPicture, border_picture};
use wmr::plan_file::PlanFile;
use wmr::run_log::RunLog;
use wmr::vision::{border_candidates, decode};

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

    /// Draws the candidates for the border, if it is searched for in this photo: also one that is refused has them.
    pub(crate) fn border(&self, bytes: &[u8], args: &VisionArgs) -> Result<(), CliError> {
        let is_known = args.corners.is_some() || args.tags.is_some() || args.camera.is_some();
        let Some(arena) = args.arena.filter(|_| !is_known) else { return Ok(()) };
        // A file that is no photo is refused by name where it is looked at.
        let Ok(photo) = decode(bytes) else { return Ok(()) };
        let candidates = border_candidates(&photo, arena, args.origin.map(Into::into));
        self.pictures(&[border_picture(&photo, &candidates)])
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
        // A robot that never said a word has nothing to be drawn.
        if let Ok(log) = RunLog::from_jsonl(&run.lines()) {
            let log = log.in_arena_frame(run.origin);
            self.replay(&way.file, &log, 1.0)?;
        }
        self.over_photo(input, way, &measured)?;
        self.index("A drive of wmr")
    }

    /// Draws a drive over the photo that it was planned on, if there is one.
    fn over_photo(
        &self,
        input: &Input,
        way: &PlannedWay,
        measured: &[TimedPose],
    ) -> Result<(), CliError> {
        let Input::Photo(seen) = input else { return Ok(()) };
        let Some(steps) = &seen.detection.steps else { return Ok(()) };
        let driven: Vec<_> = measured.iter().map(|at| at.pose).collect();
        let radius = way.file.scene.robot_radius;
        let picture = drive_picture(steps, &way.file.waypoints, &driven, radius);
        self.write("16_drive.svg", picture.as_bytes())
    }

    /// Draws a drive that moves, and how far it was beside its way; the names of the files.
    pub(crate) fn replay(
        &self,
        plan: &PlanFile,
        run: &RunLog,
        speed: f64,
    ) -> Result<[&'static str; 2], CliError> {
        let files = ["17_replay.svg", "18_deviation.svg"];
        self.write(files[0], replay::moving(plan, run, speed).as_bytes())?;
        let deviation = progress_svg(&plan.waypoints, &run.lines);
        self.write(files[1], deviation.as_bytes())?;
        Ok(files)
    }

    /// Writes the page that shows all pictures that are in the folder.
    pub(crate) fn index(&self, title: &str) -> Result<(), CliError> {
        let entries = std::fs::read_dir(&self.0).into_iter().flatten().flatten();
        let names: Vec<String> =
            entries.filter_map(|entry| entry.file_name().into_string().ok()).collect();
        let names: Vec<&str> = names.iter().map(String::as_str).collect();
        self.write("index.html", index_html(title, &names).as_bytes())
    }

    pub(crate) fn write(&self, name: &str, bytes: &[u8]) -> Result<(), CliError> {
        let is_kind = |older: &[u8]| is_result(name, older);
        write_named(&self.0.join(name), bytes, "result of wmr", is_kind)
    }
}

/// Puts a file in the place of another of its own kind, whole or not at all, whenever this program may be killed.
///
/// What is no file, such as a pipe, is written to.
pub(crate) fn replace_named(
    path: &Path,
    bytes: &[u8],
    kind: &str,
    is_kind: impl Fn(&[u8]) -> bool,
) -> Result<(), CliError> {
    // A link stays one: what it leads to is replaced.
    let path = &std::fs::canonicalize(path).unwrap_or_else(|_| path.to_owned());
    if path.exists() && !path.is_file() {
        return write_file(path, bytes);
    }
    if !may_write(path, bytes, kind, is_kind)? {
        return Ok(());
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

/// Writes a file that a person named: over an older one of its own kind, never over anything else.
pub(crate) fn write_named(
    path: &Path,
    bytes: &[u8],
    kind: &str,
    is_kind: impl Fn(&[u8]) -> bool,
) -> Result<(), CliError> {
    if may_write(path, bytes, kind, is_kind)? { write_file(path, bytes) } else { Ok(()) }
}

/// Whether there is anything to write; an error if that would destroy what this program has read, or what is not
/// of its kind.
fn may_write(
    path: &Path,
    bytes: &[u8],
    kind: &str,
    is_kind: impl Fn(&[u8]) -> bool,
) -> Result<bool, CliError> {
    // A file that cannot be read is no reason: writing says what is wrong with it.
    let older = if path.is_file() { std::fs::read(path).unwrap_or_default() } else { Vec::new() };
    if was_read(path) {
        if older == bytes {
            return Ok(false);
        }
        let message = format!("{} is what this command reads; it stays as it is", path.display());
        return Err(exists(message));
    }
    if older.is_empty() || is_kind(&older) {
        return Ok(true);
    }
    Err(exists(format!("{} is there and is no {kind}; it stays as it is", path.display())))
}

fn exists(message: String) -> CliError {
    CliError::new(Exit::Usage, "file.exists", message, "give another name to write to")
}

/// Writes a file whole.
fn write_file(path: &Path, bytes: &[u8]) -> Result<(), CliError> {
    std::fs::write(path, bytes).map_err(|error| write_error(path, &error))
}

/// Whether a file of a results folder is one that this program may have written under that name.
fn is_result(name: &str, older: &[u8]) -> bool {
    match name.rsplit_once('.') {
        Some((_, "html")) => older.starts_with(INDEX_HEAD.as_bytes()),
        Some((_, "svg")) => older.starts_with(b"<svg"),
        Some((_, "json")) => has_format(older, "wmr-"),
        Some((_, "jsonl")) => older.starts_with(b"{"),
        _ => image::guess_format(older).is_ok(),
    }
}

/// Whether a file is JSON that names a format that begins so.
pub(crate) fn has_format(bytes: &[u8], format: &str) -> bool {
    #[derive(serde::Deserialize)]
    struct Head {
        format: String,
    }
    serde_json::from_slice::<Head>(bytes).is_ok_and(|head| head.format.starts_with(format))
}

pub(crate) fn write_error(path: &Path, error: &std::io::Error) -> CliError {
    let message = format!("{}: {error}", path.display());
    CliError::new(Exit::File, "file.write", message, "choose another place")
}
