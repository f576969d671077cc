//! What lies on the desk: the photo, the scene that was seen in it or drawn by hand, and the plan in it.
//!
//! Each has a revision that grows with every change; a page that shows an older one fetches it again.
//! What rests on something that has changed is taken off: a plan never outlives its scene.

use super::corrections::Corrections;
use super::error::Failure;
use super::planned::plan_document;
use super::reading::Reading;
use super::requests::{DetectRequest, PlanRequest};
use crate::cli::args::WayArgs;
use crate::cli::demo;
use crate::cli::detect::detection_document;
use crate::cli::error::CliError;
use crate::cli::input::{self, SeenPhoto, Sight};
use crate::cli::output::Output;
use crate::cli::way::PlannedWay;
use axum::http::StatusCode;
use serde_json::{Value, json};
use std::sync::Arc;
use wmr::geometry::{Arena, Pose};
use wmr::picture::vision::NamedPicture;
use wmr::scene::{DEFAULT_ROBOT_RADIUS, Obstacle, Scene};
use wmr::vision;

/// Nothing is printed while a request is worked on: what there is to say goes back to the page.
pub(super) const SILENT: Output = Output { json: true, quiet: true };

/// More obstacles than this are no arena that a person edits; planning would keep the page waiting.
const MOST_OBSTACLES: usize = 2000;

/// All that people work on.
#[derive(Debug)]
pub(super) struct Desk {
    pub(super) photo: Option<Arc<DeskPhoto>>,
    arena: Option<Arena>,
    robot_radius: f64,
    /// Corners that were moved by hand.
    corners: Option<[[f64; 2]; 4]>,
    reading: Reading,
    /// What was corrected before the scene that lies here.
    corrections: Corrections,
    /// The pictures of the steps that were asked for last.
    pub(super) steps: Arc<Vec<NamedPicture>>,
    pub(super) scene: Option<DeskScene>,
    pub(super) plan: Option<DeskPlan>,
    pub(super) revisions: Revisions,
}

/// How often each thing has changed.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, serde::Serialize)]
pub(super) struct Revisions {
    pub(super) photo: u64,
    pub(super) scene: u64,
    pub(super) plan: u64,
}

/// A photo that can be decoded.
#[derive(Debug)]
pub(super) struct DeskPhoto {
    pub(super) bytes: Vec<u8>,
    pub(super) content_type: &'static str,
    /// Width and height as seen, pixels.
    size: [usize; 2],
    /// What is wrong with the picture itself, as the error that looking at it would end with.
    note: Option<Value>,
}

/// The scene, with what is known of how it was seen.
#[derive(Clone, Debug)]
pub(super) struct DeskScene {
    scene: Scene,
    /// The document of `wmr detect --json`, if a photo was looked at.
    detection: Option<Value>,
    /// What was recognised, before it was corrected.
    recognised: Vec<Obstacle>,
}

/// What came of planning.
#[derive(Debug)]
pub(super) struct DeskPlan {
    /// What was asked for.
    args: WayArgs,
    pub(super) result: Result<Box<PlannedWay>, CliError>,
}

impl Default for Desk {
    fn default() -> Self {
        Self {
            photo: None,
            arena: None,
            robot_radius: DEFAULT_ROBOT_RADIUS,
            corners: None,
            reading: Reading::default(),
            corrections: Corrections::default(),
            steps: Arc::default(),
            scene: None,
            plan: None,
            revisions: Revisions::default(),
        }
    }
}

impl DeskPhoto {
    /// Checks that `bytes` are a photo that can be worked on and that a browser shows.
    pub(super) fn new(bytes: Vec<u8>) -> Result<Self, Failure> {
        let content_type = match bytes.as_slice() {
            [0x89, b'P', b'N', b'G', ..] => "image/png",
            [0xff, 0xd8, ..] => "image/jpeg",
            [b'B', b'M', ..] => "image/bmp",
            _ => {
                let help = "give a complete PNG or JPEG file";
                let status = StatusCode::UNPROCESSABLE_ENTITY;
                return Err(Failure::new(
                    status,
                    "photo",
                    "this file is no photo that a page can show",
                    help,
                ));
            }
        };
        let photo = vision::decode(&bytes).map_err(CliError::from)?;
        let size = [photo.width(), photo.height()];
        let fault = vision::check_picture(&photo).err().map(CliError::from);
        let note = fault.map(|error| json!(error.failure()));
        Ok(Self { bytes, content_type, size, note })
    }
}

impl Desk {
    /// Lays a photo on the desk; all that was seen before is taken off.
    pub(super) fn take_photo(&mut self, photo: DeskPhoto) {
        self.photo = Some(Arc::new(photo));
        self.corners = None;
        self.revisions.photo += 1;
        self.take_off_scene();
        self.corrections = Corrections::default();
    }

    /// Lays the bundled photo on the desk, with its arena's size.
    pub(super) fn take_sample(&mut self) -> Result<(), CliError> {
        let photo = DeskPhoto::new(demo::PHOTO.to_vec()).map_err(|failure| failure.error)?;
        self.take_photo(photo);
        self.arena = Some(demo::ARENA);
        self.robot_radius = DEFAULT_ROBOT_RADIUS;
        Ok(())
    }

    /// Takes over where the person sees the arena's corners.
    pub(super) fn take_corners(&mut self, corners: Option<[[f64; 2]; 4]>) -> Result<(), Failure> {
        if corners.iter().flatten().flatten().any(|number| !number.is_finite()) {
            return Err(Failure::bad_request("a corner is not finite"));
        }
        self.corners = corners;
        self.take_off_scene();
        Ok(())
    }

    /// What a look at the photo needs.
    pub(super) fn look(&self, request: &DetectRequest) -> Result<Look, Failure> {
        let photo = self.photo.clone().ok_or_else(|| {
            Failure::missing(
                "photo.none",
                "there is no photo yet",
                "choose one, or take the sample",
            )
        })?;
        let arena = request.arena.or(self.arena);
        let robot_radius = request.robot_radius.unwrap_or(self.robot_radius);
        let reading = request.reading.clone().unwrap_or_else(|| self.reading.clone());
        reading.check()?;
        Ok(Look {
            photo,
            arena,
            robot_radius,
            reading,
            afresh: request.afresh,
            corners: self.corners,
            revision: self.revisions.photo,
        })
    }

    /// Lays down what was seen, corrected as before, unless the photo has changed meanwhile; the document of
    /// `wmr detect`.
    pub(super) fn take_detection(&mut self, look: &Look, seen: &SeenPhoto) -> Value {
        let document = json!(detection_document(seen, look.robot_radius));
        if look.revision == self.revisions.photo && look.corners == self.corners {
            let is_same_arena = self.arena == look.arena;
            self.arena = look.arena;
            self.robot_radius = look.robot_radius;
            self.reading = look.reading.clone();
            self.take_off_scene();
            if look.afresh || !is_same_arena {
                self.corrections = Corrections::default();
            }
            let mut scene = seen.scene(Some(look.robot_radius));
            let recognised = scene.obstacles.clone();
            scene.obstacles = self.corrections.applied_to(&recognised);
            self.scene = Some(DeskScene { scene, detection: Some(document.clone()), recognised });
        }
        document
    }

    /// Lays down a scene that was drawn or corrected by hand.
    pub(super) fn take_scene(&mut self, document: &Value) -> Result<(), Failure> {
        let scene = read_scene(document)?;
        if self.arena.is_some_and(|arena| arena != scene.arena) {
            self.photo = None;
            self.corners = None;
            self.revisions.photo += 1;
        }
        let (last, earlier) = (self.scene.clone(), self.corrections.clone());
        self.take_off_scene();
        self.arena = Some(scene.arena);
        self.robot_radius = scene.robot_radius;
        let last = last.filter(|_| self.photo.is_some());
        let is_seen = last.as_ref().is_some_and(|last| last.detection.is_some());
        self.corrections = if is_seen { earlier } else { Corrections::default() };
        let (detection, recognised) =
            last.map(|last| (last.detection, last.recognised)).unwrap_or_default();
        self.scene = Some(DeskScene { scene, detection, recognised });
        Ok(())
    }

    /// The scene to plan in: that of the request, or the one on the desk.
    pub(super) fn scene_for(&self, request: &PlanRequest) -> Result<Scene, Failure> {
        if let Some(document) = &request.scene {
            return read_scene(document);
        }
        self.scene.as_ref().map(|desk| desk.scene.clone()).ok_or_else(|| {
            Failure::missing(
                "scene.none",
                "there is no scene yet",
                "choose a photo and let it be recognised",
            )
        })
    }

    /// Lays down what came of planning in `scene`.
    pub(super) fn take_plan(
        &mut self,
        scene: Scene,
        (args, result): (WayArgs, Result<Box<PlannedWay>, CliError>),
    ) -> Revisions {
        let last = self.scene.take();
        let (detection, recognised) =
            last.map(|desk| (desk.detection, desk.recognised)).unwrap_or_default();
        self.arena = Some(scene.arena);
        self.robot_radius = scene.robot_radius;
        self.revisions.scene += 1;
        self.scene = Some(DeskScene { scene, detection, recognised });
        self.revisions.plan += 1;
        self.plan = Some(DeskPlan { args, result });
        self.revisions
    }

    /// The scene that was planned in, with what was asked for, if there is a way.
    pub(super) fn planned(&self) -> Option<(&Scene, WayArgs)> {
        let plan = self.plan.as_ref().filter(|plan| plan.result.is_ok())?;
        Some((&self.scene.as_ref()?.scene, plan.args.clone()))
    }

    /// The scene, and where the robot stands in it.
    pub(super) fn start(&self) -> Option<(&Scene, Pose)> {
        let scene = &self.scene.as_ref()?.scene;
        Some((scene, scene.start?))
    }

    /// How the photo is read.
    pub(super) fn reading(&self) -> Reading {
        self.reading.clone()
    }

    /// Corners that were put by hand in a photo of that size, pixels.
    pub(super) fn corners_in(&self, size: [usize; 2]) -> Option<[[f64; 2]; 4]> {
        let is_same = self.photo.as_ref().is_some_and(|photo| photo.size == size);
        self.corners.filter(|_| is_same)
    }

    /// What a person has corrected of what was recognised.
    pub(super) fn corrections(&self) -> Corrections {
        match &self.scene {
            Some(DeskScene { scene, detection: Some(_), recognised }) => {
                Corrections::between(recognised, &scene.obstacles, &self.corrections)
            }
            _ => self.corrections.clone(),
        }
    }

    /// Looks once more, keeping the pictures of the steps; what was planned is drawn as well.
    pub(super) fn steps(&self) -> (Option<Look>, Option<Box<PlannedWay>>, f64) {
        let look = self.look(&DetectRequest::default()).ok();
        let look = look.filter(|look| look.arena.is_some());
        let way = self.plan.as_ref().and_then(|plan| plan.result.as_ref().ok());
        (look, way.cloned(), self.robot_radius)
    }

    fn take_off_scene(&mut self) {
        self.corrections = self.corrections();
        self.scene = None;
        self.plan = None;
        self.revisions.scene += 1;
        self.revisions.plan += 1;
    }

    /// The outlines of what was recognised and is no obstacle, as in a scene.
    fn erased(&self) -> Value {
        let arena = self.arena.unwrap_or(Arena { width: 1.0, height: 1.0 });
        let mut scene = Scene::new(arena.width, arena.height);
        scene.obstacles = self.corrections().erased.into_iter().map(Obstacle::from).collect();
        json!(scene)["obstacles"].clone()
    }

    /// The scene as a file has it.
    pub(super) fn scene_file(&self) -> Option<Value> {
        self.scene.as_ref().map(|desk| json!(desk.scene))
    }

    /// Everything on the desk.
    pub(super) fn document(&self) -> Value {
        let photo = self.photo.as_ref().map(|photo| {
            let [width, height] = photo.size;
            json!({"width": width, "height": height, "type": photo.content_type, "note": photo.note})
        });
        let scene = self.scene.as_ref().map(|desk| &desk.scene);
        let plan = self.plan.as_ref().map(|plan| match &plan.result {
            Ok(way) => plan_document(way),
            Err(error) => json!(error.document()),
        });
        json!({
            "revision": self.revisions,
            "photo": photo,
            "arena": self.arena,
            "robot_radius": self.robot_radius,
            "corners_px": self.corners,
            "reading": self.reading,
            "erased": self.erased(),
            "detection": self.scene.as_ref().and_then(|desk| desk.detection.as_ref()),
            "scene": scene,
            "plan": plan,
        })
    }
}

/// What a look at a photo needs, taken from the desk so that the desk is free meanwhile.
#[derive(Clone, Debug)]
pub(super) struct Look {
    photo: Arc<DeskPhoto>,
    arena: Option<Arena>,
    robot_radius: f64,
    reading: Reading,
    afresh: bool,
    corners: Option<[[f64; 2]; 4]>,
    revision: u64,
}

impl Look {
    /// Looks.
    pub(super) fn see(&self, keep_steps: bool) -> Result<SeenPhoto, Failure> {
        let mut args = self.reading.vision_args()?;
        args.arena = self.arena;
        args.corners = self.corners;
        if args.corners.is_some() {
            // Where a person has put the corners they are.
            args.tags = None;
        }
        let sight =
            Sight { radius: Some(self.robot_radius), resolution: 1.0, keep_steps, start: None };
        Ok(input::see_with(self.photo.bytes.clone(), &args, sight, (self.reading.camera(), None))?)
    }
}

/// A scene as in a file.
fn read_scene(document: &Value) -> Result<Scene, Failure> {
    let scene = Scene::from_json(&document.to_string()).map_err(CliError::from)?;
    let count = scene.obstacles.len();
    if count > MOST_OBSTACLES {
        let message =
            format!("{count} obstacles are too many for a page, at most {MOST_OBSTACLES} are");
        return Err(Failure::bad_request(message));
    }
    Ok(scene)
}
