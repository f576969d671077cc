//! What a command works on: a photo, a scene or a plan, told apart by what the file holds.

use super::args::{MethodName, VisionArgs};
use super::error::{CliError, Exit};
use super::output::Output;
use std::collections::BTreeSet;
use std::fs::File;
use std::io::{ErrorKind, Read};
use std::path::{Path, PathBuf};
use std::sync::{Mutex, PoisonError};
use std::time::{Duration, Instant};
use wmr::geometry::{Arena, Pose};
use wmr::map::{CellMap, MapError, RosHead};
use wmr::picture::vision::{NamedPicture, vision_pictures};
use wmr::plan_file::PlanFile;
use wmr::scene::{DEFAULT_ROBOT_RADIUS, Goal, Scene};
use wmr::vision::{self, Camera, DetectOptions, Detection, Method, Photo};

/// What a file holds.
#[derive(Debug)]
pub(crate) enum Input {
    Photo(Box<SeenPhoto>),
    Scene(Scene),
    Plan(Box<PlanFile>),
}

/// A photo and what was seen in it.
#[derive(Debug)]
pub(crate) struct SeenPhoto {
    pub(crate) bytes: Vec<u8>,
    pub(crate) arena: Arena,
    /// The picture of the empty arena that told the floor, if there was one.
    pub(crate) empty: Option<PathBuf>,
    pub(crate) detection: Detection,
    pub(crate) decode_time: Duration,
    pub(crate) detect_time: Duration,
}

/// A map names no robot: its cells are as wide as whatever moves there.
const MAP_RADIUS: f64 = 0.0;

/// The largest file that is read: 40 megapixels of uncompressed PNG are far below.
const LARGEST_FILE: u64 = 256 << 20;

/// What the robot's disc is taken for, how large a map's cells are, and whether the steps of seeing
/// are to be drawn.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Sight {
    pub(crate) radius: Option<f64>,
    pub(crate) resolution: f64,
    pub(crate) keep_steps: bool,
    /// Where a person says that the robot stands.
    pub(crate) start: Option<Goal>,
}

/// Reads `path`, and if it is a photo, looks at it.
pub(crate) fn read(
    path: &Path,
    vision: &VisionArgs,
    sight: Sight,
    output: Output,
) -> Result<Input, CliError> {
    let bytes = without_byte_order_mark(read_bytes(path)?);
    match bytes.iter().find(|byte| !byte.is_ascii_whitespace()) {
        None => Err(CliError::new(
            Exit::File,
            "file.empty",
            format!("{} is empty", path.display()),
            "give a photo, a scene or a plan",
        )),
        // YAML may be written like JSON.
        Some(b'{') if !is_yaml(path) => read_json(path, &bytes),
        Some(_) if path.extension().is_some_and(|ending| ending == "json") => {
            read_json(path, &bytes)
        }
        Some(_) => match read_cells(path, sight.resolution, output)? {
            Some(map) => Ok(Input::Scene(map.to_scene(sight.radius.unwrap_or(MAP_RADIUS)))),
            None => see(bytes, vision, sight).map(|seen| Input::Photo(Box::new(seen))),
        },
    }
}

fn is_yaml(path: &Path) -> bool {
    path.extension().is_some_and(|ending| ending == "yaml" || ending == "yml")
}

/// Editors on Windows begin a text with a mark that JSON does not know.
fn without_byte_order_mark(bytes: Vec<u8>) -> Vec<u8> {
    match bytes.strip_prefix(b"\xef\xbb\xbf") {
        Some(text) => text.to_vec(),
        None => bytes,
    }
}

/// What was read, so that nothing is written over it.
static READ: Mutex<BTreeSet<PathBuf>> = Mutex::new(BTreeSet::new());

/// From now on that file is not written over. What has no place of its own, such as a pipe, cannot be.
pub(crate) fn remember(path: &Path) {
    if let Ok(path) = std::fs::canonicalize(path) {
        READ.lock().unwrap_or_else(PoisonError::into_inner).insert(path);
    }
}

/// Whether this program has read that file.
pub(crate) fn was_read(path: &Path) -> bool {
    let read = READ.lock().unwrap_or_else(PoisonError::into_inner);
    std::fs::canonicalize(path).is_ok_and(|path| read.contains(&path))
}

/// Reads a file of bounded size.
pub(crate) fn read_bytes(path: &Path) -> Result<Vec<u8>, CliError> {
    let failed = |error: std::io::Error| {
        let help = match error.kind() {
            ErrorKind::NotFound => "check the name; a path is relative to the current folder",
            ErrorKind::PermissionDenied => "change the file's permissions",
            _ => "give the name of a file",
        };
        CliError::new(Exit::File, "file.read", format!("{}: {error}", path.display()), help)
    };
    let mut bytes = Vec::new();
    let file = File::open(path).map_err(failed)?;
    // A device tells no size before it is read.
    file.take(LARGEST_FILE + 1).read_to_end(&mut bytes).map_err(failed)?;
    if bytes.len() as u64 > LARGEST_FILE {
        let (name, most) = (path.display(), LARGEST_FILE >> 20);
        let message = format!("{name} has more than {most} MB");
        return Err(CliError::new(Exit::File, "file.size", message, "scale the picture down"));
    }
    remember(path);
    Ok(bytes)
}

/// The cells of a map, if the name of `path` says that it is one; those of a Moving AI map are
/// `resolution` metres wide.
pub(crate) fn read_cells(
    path: &Path,
    resolution: f64,
    output: Output,
) -> Result<Option<CellMap>, CliError> {
    let ending = path.extension().and_then(|ending| ending.to_str()).unwrap_or_default();
    let failed = |error: MapError| CliError::of(Exit::File, "map", &error).in_file(path);
    let cells = match ending {
        "map" if resolution <= 0.0 => {
            return Err(CliError::usage("a cell has no size", "give --resolution above 0, metres"));
        }
        "map" => CellMap::from_movingai(&String::from_utf8_lossy(&read_bytes(path)?), resolution),
        "yaml" | "yml" => {
            let head = RosHead::from_yaml(&String::from_utf8_lossy(&read_bytes(path)?));
            let head = head.map_err(failed)?;
            let picture = read_map_picture(path, &head.image, output)?;
            CellMap::from_ros(&head, &picture).map(|(map, warnings)| {
                warnings.iter().for_each(|warning| output.say(&format!("warning: {warning}")));
                map
            })
        }
        _ => return Ok(None),
    };
    cells.map(Some).map_err(failed)
}

/// The bytes of the picture that a ROS map names; where nothing has that name, as after a copy from
/// another computer, of the picture with the same last name beside the map.
fn read_map_picture(map: &Path, image: &str, output: Output) -> Result<Vec<u8>, CliError> {
    let image = image.strip_prefix("file://").unwrap_or(image);
    let named = map.with_file_name("").join(image);
    let last = image.rsplit(['/', '\\']).next().unwrap_or(image);
    let beside = map.with_file_name(last);
    if !named.is_file() && beside.is_file() {
        output.say(&format!(
            "the map names {image}, which is not there; {} is taken",
            beside.display()
        ));
        return read_bytes(&beside);
    }
    read_bytes(&named)
}

fn read_json(path: &Path, bytes: &[u8]) -> Result<Input, CliError> {
    let not_json = |error: &dyn std::fmt::Display| {
        CliError::new(
            Exit::File,
            "file.json",
            format!("{}: {error}", path.display()),
            "give a scene or plan file as wmr writes them",
        )
    };
    let text = std::str::from_utf8(bytes).map_err(|error| not_json(&error))?;
    let value: serde_json::Value = serde_json::from_str(text).map_err(|error| not_json(&error))?;
    let format = value.get("format").and_then(serde_json::Value::as_str).unwrap_or_default();
    match format {
        "wmr-plan/1" => Ok(Input::Plan(Box::new(PlanFile::from_json(text)?))),
        "wmr-scene/2" | "wmr-scene/1" | "wmr-arena/1" => Ok(Input::Scene(Scene::from_json(text)?)),
        other => Err(not_json(&format!(
            "its format is {other:?}, not wmr-scene/2, wmr-scene/1, wmr-arena/1 or wmr-plan/1"
        ))),
    }
}

/// The arena's size that a photo needs.
pub(crate) fn arena_of(args: &VisionArgs) -> Result<Arena, CliError> {
    args.arena.ok_or_else(|| {
        CliError::usage(
            "a photo does not tell how large the arena is",
            "add --arena WxH, its inner size in metres, such as --arena 1.6x2.0",
        )
    })
}

/// Decodes a photo and finds what is in it.
pub(crate) fn see(bytes: Vec<u8>, args: &VisionArgs, sight: Sight) -> Result<SeenPhoto, CliError> {
    see_with(bytes, args, sight, camera_and_empty(args)?)
}

/// The same with a camera that is known already, and the file with the picture of the empty arena.
pub(crate) fn see_with(
    bytes: Vec<u8>,
    args: &VisionArgs,
    sight: Sight,
    (camera, empty): (Option<Camera>, Option<PathBuf>),
) -> Result<SeenPhoto, CliError> {
    let started = Instant::now();
    let photo = vision::decode(&bytes)?;
    let decode_time = started.elapsed();
    let arena = arena_of(args)?;
    let options = detect_options(args, sight, (camera, empty.as_deref()))?;
    let started = Instant::now();
    let detection = vision::detect(&photo, arena, &options)?;
    Ok(SeenPhoto { bytes, arena, empty, detection, decode_time, detect_time: started.elapsed() })
}

/// What `args` say of how a photo is to be looked at.
pub(crate) fn detect_options(
    args: &VisionArgs,
    sight: Sight,
    (camera, empty): (Option<Camera>, Option<&Path>),
) -> Result<DetectOptions, CliError> {
    let usual = DetectOptions::default();
    let mount = args.robot_tag_at.map(|at| Pose {
        position: at.position,
        heading: at.heading.unwrap_or(usual.robot_tag_mount.heading),
    });
    Ok(DetectOptions {
        method: match args.method {
            MethodName::Robust => Method::Robust,
            MethodName::Paper => Method::Paper,
        },
        corners: args.corners,
        origin: args.origin.map(Into::into),
        tags: args.tags.map(Into::into),
        robot_tag: args.robot_tag,
        robot_tag_mount: mount.unwrap_or(usual.robot_tag_mount),
        robot_height: args.robot_height.unwrap_or(usual.robot_height),
        goal_tag: args.goal_tag,
        robot_at: sight
            .start
            .filter(|_| args.robot_tag.is_none())
            .map(|place| Pose { position: place.position, heading: place.heading.unwrap_or(0.0) }),
        ignored: args.ignore.clone(),
        robot_radius: sight.radius.unwrap_or(DEFAULT_ROBOT_RADIUS),
        keep_steps: sight.keep_steps,
        camera,
        empty: empty.map(read_picture).transpose()?,
        ..usual
    })
}

/// The camera and the empty picture that `args` name.
pub(crate) fn camera_and_empty(
    args: &VisionArgs,
) -> Result<(Option<Camera>, Option<PathBuf>), CliError> {
    let file = args.camera.as_deref().map(read_camera).transpose()?;
    let empty = empty_picture(args, file.as_ref())?;
    Ok((file.map(|file| file.main), empty))
}

/// Which picture of the empty arena is used: the one given, else the one that the camera file names.
fn empty_picture(
    args: &VisionArgs,
    camera: Option<&CameraFile>,
) -> Result<Option<PathBuf>, CliError> {
    if args.method == MethodName::Paper {
        let message = "the paper's method takes what is near white for floor, not a picture of it";
        let refused = || CliError::usage(message, "leave --empty or --method paper out");
        return if args.empty.is_some() { Err(refused()) } else { Ok(None) };
    }
    let named = || {
        let beside = args.camera.as_deref()?.parent().unwrap_or(Path::new(""));
        Some(beside.join(camera?.empty.as_deref()?))
    };
    Ok(args.empty.clone().or_else(named))
}

/// A second picture; an error names it.
pub(crate) fn read_picture(path: &Path) -> Result<Photo, CliError> {
    let bytes = read_bytes(path)?;
    vision::decode(&bytes).map_err(|error| CliError::from(error).in_file(path))
}

/// A camera file: the camera stands under `main`.
#[derive(serde::Deserialize)]
struct CameraFile {
    main: Camera,
    /// A picture of the empty arena, as a path from the file's folder.
    #[serde(default)]
    empty: Option<PathBuf>,
}

/// A camera file for two pictures.
#[derive(serde::Deserialize)]
struct CameraPairFile {
    a: Camera,
    b: Camera,
}

fn read_camera(path: &Path) -> Result<CameraFile, CliError> {
    read_camera_file(path, "{\"main\": {model, image_size, K, k1, R, t}}")
}

/// The cameras of two pictures.
pub(crate) fn read_camera_pair(path: &Path) -> Result<[Camera; 2], CliError> {
    read_camera_file(path, "{\"a\": {model, image_size, K, k1, R, t}, \"b\": {…}}")
        .map(|CameraPairFile { a, b }| [a, b])
}

fn read_camera_file<T: serde::de::DeserializeOwned>(
    path: &Path,
    shape: &str,
) -> Result<T, CliError> {
    let bytes = read_bytes(path)?;
    serde_json::from_slice(&bytes).map_err(|error| {
        let message = format!("{}: {error}", path.display());
        CliError::new(Exit::File, "camera", message, format!("a camera file is {shape}"))
    })
}

impl SeenPhoto {
    /// The scene that was seen.
    pub(crate) fn scene(&self, radius: Option<f64>) -> Scene {
        Scene::from_detection(&self.detection, self.arena, radius.unwrap_or(DEFAULT_ROBOT_RADIUS))
    }

    /// The steps of seeing, drawn; none unless they were kept.
    pub(crate) fn pictures(&self, radius: f64) -> Vec<NamedPicture> {
        vision_pictures(&self.detection, radius)
    }
}
