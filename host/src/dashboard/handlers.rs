//! What each request does. Nothing here waits for the robot: an order is queued or a wish is set.

use super::desk::DeskPhoto;
use super::error::Failure;
use super::requests::{
    CornersRequest, DetectRequest, DriveRequest, HoldName, JogRequest, PlanRequest, SampleRequest,
};
use super::robot::{Order, Task};
use super::watched::newest_frame;
use super::{Dashboard, base, lock, lookout, planned, steps};
use crate::cli::way;
use axum::Json;
use axum::body::Bytes;
use axum::extract::{Path, State};
use axum::http::header::{CACHE_CONTROL, CONTENT_TYPE};
use axum::http::{HeaderMap, StatusCode};
use axum::response::{IntoResponse, Response};
use serde::de::DeserializeOwned;
use serde_json::{Value, json};
use std::sync::Arc;

pub(super) type Answer = Result<Json<Value>, Failure>;

/// A jog goes at most so far, metres: a held key asks again.
const MOST_JOG: f64 = 0.05;
/// And turns at most so far, radians.
const MOST_JOG_TURN: f64 = 0.3;

/// Everything that a page shows.
pub(super) async fn state(State(dashboard): State<Dashboard>) -> Json<Value> {
    Json(state_document(&dashboard))
}

fn state_document(dashboard: &Dashboard) -> Value {
    let camera = dashboard.camera.document(&dashboard.camera_sources());
    let mut document = lock(&dashboard.desk).document();
    let live = lock(&dashboard.live);
    if let Some(fields) = document.as_object_mut() {
        fields.insert("faults".into(), json!(dashboard.faults.get()));
        fields.insert("camera".into(), camera);
        fields.insert("run".into(), live.run_document());
        fields.insert("base".into(), live.base_document());
        fields.insert("drive".into(), live.drive_document(dashboard.controls.is_paused()));
    }
    document
}

/// The photo as it was sent.
pub(super) async fn show_photo(State(dashboard): State<Dashboard>) -> Result<Response, Failure> {
    let photo = lock(&dashboard.desk).photo.clone().ok_or_else(|| {
        Failure::missing("photo.none", "there is no photo yet", "choose one, or take the sample")
    })?;
    let head = [(CONTENT_TYPE, photo.content_type), (CACHE_CONTROL, "no-store")];
    Ok((head, photo.bytes.clone()).into_response())
}

/// The lines of `run.jsonl` of the last drive.
pub(super) async fn run_log(State(dashboard): State<Dashboard>) -> Response {
    let lines = lock(&dashboard.live).run.lines.clone();
    ([(CONTENT_TYPE, "application/jsonl"), (CACHE_CONTROL, "no-store")], lines).into_response()
}

/// A new photo, or the bundled one.
pub(super) async fn photo(
    State(dashboard): State<Dashboard>,
    headers: HeaderMap,
    body: Bytes,
) -> Answer {
    let kind = headers.get(CONTENT_TYPE).and_then(|value| value.to_str().ok()).unwrap_or_default();
    if kind.starts_with("application/json") {
        let SampleRequest { sample } = parse(&body)?;
        take_sample(&dashboard, &sample).await?;
    } else {
        let photo = dashboard.jobs.run(move |_| DeskPhoto::new(body.to_vec())).await?;
        lock(&dashboard.desk).take_photo(photo);
    }
    Ok(Json(state_document(&dashboard)))
}

/// The bundled photo, or the newest frame of the camera.
async fn take_sample(dashboard: &Dashboard, name: &str) -> Result<(), Failure> {
    match name {
        "demo" => {
            let desk = dashboard.desk.clone();
            dashboard.jobs.run(move |_| Ok(lock(&desk).take_sample()?)).await
        }
        "camera" => {
            let shot = newest_frame(dashboard).await?;
            let bytes = shot.bytes.to_vec();
            let photo = dashboard.jobs.run(move |_| DeskPhoto::new(bytes)).await?;
            lock(&dashboard.desk).take_photo(photo);
            Ok(())
        }
        name => {
            let message = format!("there is no sample {name:?}; there are demo and camera");
            Err(Failure::bad_request(message))
        }
    }
}

/// Where the person sees the arena's corners.
pub(super) async fn corners(State(dashboard): State<Dashboard>, body: Bytes) -> Answer {
    let CornersRequest { corners_px } = parse(&body)?;
    lock(&dashboard.desk).take_corners(corners_px)?;
    Ok(Json(state_document(&dashboard)))
}

/// Looks at the photo.
pub(super) async fn detect(State(dashboard): State<Dashboard>, body: Bytes) -> Answer {
    let request: DetectRequest = parse_or_default(&body)?;
    let look = lock(&dashboard.desk).look(&request)?;
    let (look, seen) = dashboard
        .jobs
        .run(move |_| {
            let seen = look.see(false)?;
            Ok((look, seen))
        })
        .await?;
    let document = lock(&dashboard.desk).take_detection(&look, &seen);
    Ok(Json(document))
}

/// The scene as a file, corrections and all.
pub(super) async fn scene_file(State(dashboard): State<Dashboard>) -> Answer {
    let scene = lock(&dashboard.desk).scene_file();
    scene.map(Json).ok_or_else(|| {
        Failure::missing(
            "scene.none",
            "there is no scene yet",
            "choose a photo and let it be recognised",
        )
    })
}

/// Draws the steps from the photo to the path.
pub(super) async fn steps(State(dashboard): State<Dashboard>) -> Answer {
    let (look, way, radius) = lock(&dashboard.desk).steps();
    let pictures = dashboard
        .jobs
        .run(move |going| planned::draw_steps(look.as_ref(), way.as_deref(), radius, going))
        .await?;
    let document = steps::document(&pictures);
    lock(&dashboard.desk).steps = Arc::new(pictures);
    Ok(Json(document))
}

/// A picture of the steps that were drawn last.
pub(super) async fn step(
    State(dashboard): State<Dashboard>,
    Path(name): Path<String>,
) -> Result<Response, Failure> {
    let pictures = lock(&dashboard.desk).steps.clone();
    let Some(picture) = pictures.iter().find(|picture| picture.name == name) else {
        return Err(unknown().await);
    };
    let head = [(CONTENT_TYPE, steps::content_type(&name)), (CACHE_CONTROL, "no-store")];
    Ok((head, picture.bytes.clone()).into_response())
}

/// A scene that was drawn or corrected by hand.
pub(super) async fn scene(State(dashboard): State<Dashboard>, body: Bytes) -> Answer {
    let document: Value = parse(&body)?;
    lock(&dashboard.desk).take_scene(&document)?;
    Ok(Json(state_document(&dashboard)))
}

/// Plans again.
pub(super) async fn plan(State(dashboard): State<Dashboard>, body: Bytes) -> Answer {
    let request: PlanRequest = parse_or_default(&body)?;
    let args = request.way_args()?;
    let mut scene = lock(&dashboard.desk).scene_for(&request)?;
    way::take_ends(&mut scene, &args);
    let (scene, planned, answer) = dashboard
        .jobs
        .run(move |_| {
            let result = planned::plan(&scene, &args);
            let answer = match &result {
                Ok(way) => Ok(planned::plan_document(way)),
                Err(error) => Err(error.clone()),
            };
            Ok((scene, (args, result), answer))
        })
        .await?;
    let revisions = lock(&dashboard.desk).take_plan(scene, planned);
    // The page that asked knows what it shows; others fetch it.
    let revision = json!(revisions);
    match answer {
        Ok(mut document) => {
            if let Some(fields) = document.as_object_mut() {
                fields.insert("revision".into(), revision);
            }
            Ok(Json(document))
        }
        Err(error) => {
            let mut error = error;
            error.details.insert("revision".into(), revision);
            Err(error.into())
        }
    }
}

/// Drives the plan on the desk.
pub(super) async fn drive(State(dashboard): State<Dashboard>, body: Bytes) -> Answer {
    let request: DriveRequest = parse_or_default(&body)?;
    let stops = dashboard.controls.stops();
    let (way, photo) = {
        let desk = lock(&dashboard.desk);
        if request.plan.is_some_and(|seen| seen != desk.revisions.plan) {
            return Err(Failure::missing(
                "plan.stale",
                "the plan has changed since this page showed it",
                "look at the new one, then drive",
            ));
        }
        match desk.plan.as_ref().map(|plan| &plan.result) {
            Some(Ok(way)) => (way.clone(), desk.photo.clone()),
            _ => {
                return Err(Failure::missing(
                    "plan.none",
                    "there is no plan to drive",
                    "choose a start and a goal",
                ));
            }
        }
    };
    dashboard.controls.set_unattended(request.unattended);
    if dashboard.camera.source().is_some() {
        return lookout::begin(&dashboard, stops).await;
    }
    order(&dashboard, Task::Drive(way, photo))
}

/// Moves the robot a little.
pub(super) async fn jog(State(dashboard): State<Dashboard>, body: Bytes) -> Answer {
    let task = match parse(&body)? {
        JogRequest { distance: None, turn: None, hold: Some(hold), begin } => {
            let hold = match hold {
                HoldName::Held(hold) => Some(hold),
                HoldName::LetGo(_) => None,
            };
            return base::hold(&dashboard, hold, begin);
        }
        JogRequest { distance: Some(distance), turn: None, hold: None, .. }
            if distance.abs() <= MOST_JOG =>
        {
            Task::Ahead(distance)
        }
        JogRequest { distance: None, turn: Some(turn), hold: None, .. }
            if turn.abs() <= MOST_JOG_TURN =>
        {
            Task::Turn(turn)
        }
        _ => {
            return Err(Failure::bad_request(format!(
                "a jog is either a distance of at most {MOST_JOG} m or a turn of at most {MOST_JOG_TURN} rad"
            )));
        }
    };
    order(&dashboard, task)
}

pub(super) fn order(dashboard: &Dashboard, task: Task) -> Answer {
    order_since(dashboard, task, dashboard.controls.stops())
}

/// Orders something that was asked for when there had been so many stops.
pub(super) fn order_since(dashboard: &Dashboard, task: Task, stops: u64) -> Answer {
    let busy = || Failure::missing("robot.busy", "the robot is under way", "wait, or stop it");
    let mut live = lock(&dashboard.live);
    if live.run.active {
        return Err(busy());
    }
    dashboard.controls.set_paused(false);
    if let Task::Held(hold) = task {
        dashboard.controls.begin_holding(hold);
    }
    dashboard.orders.try_send(Order { task, stops }).map_err(|_| busy())?;
    live.run.begin();
    Ok(Json(json!({"run": live.run.revision})))
}

/// Holds the robot on its path.
pub(super) async fn pause(State(dashboard): State<Dashboard>) -> Answer {
    wish_while_driving(&dashboard, true)
}

/// Lets it go on.
pub(super) async fn resume(State(dashboard): State<Dashboard>) -> Answer {
    wish_while_driving(&dashboard, false)
}

fn wish_while_driving(dashboard: &Dashboard, paused: bool) -> Answer {
    if !lock(&dashboard.live).run.active {
        return Err(Failure::missing(
            "robot.idle",
            "the robot is not under way",
            "choose a goal and drive",
        ));
    }
    dashboard.controls.set_paused(paused);
    Ok(Json(json!({ "paused": paused })))
}

/// Gives up the photo or plan that is being worked on.
pub(super) async fn cancel(State(dashboard): State<Dashboard>) -> Answer {
    let was_busy = dashboard.jobs.is_busy();
    dashboard.jobs.cancel();
    Ok(Json(json!({ "cancelled": was_busy })))
}

/// Stops the robot, whatever else there is.
pub(super) async fn stop(State(dashboard): State<Dashboard>) -> Answer {
    dashboard.controls.stop();
    Ok(Json(json!({"stopped": true})))
}

/// Nothing has that name.
pub(super) async fn unknown() -> Failure {
    Failure::new(StatusCode::NOT_FOUND, "http.path", "there is nothing here", "the page is at /")
}

pub(super) fn parse<T: DeserializeOwned>(body: &Bytes) -> Result<T, Failure> {
    serde_json::from_slice(body).map_err(Failure::bad_request)
}

pub(super) fn parse_or_default<T: DeserializeOwned + Default>(body: &Bytes) -> Result<T, Failure> {
    if body.is_empty() { Ok(T::default()) } else { parse(body) }
}
