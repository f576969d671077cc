//! Requests about the base itself: ports, its numbers, faults of a simulated one, frames, past runs.

use super::calibrating::{CalibrateRequest, CalibrateTask, CourseRequest};
use super::error::Failure;
use super::faults::SimulatedFaults;
use super::handlers::{Answer, order, parse, parse_or_default, unknown};
use super::live::Hold;
use super::requests::{ConnectRequest, ParametersRequest};
use super::robot::{Order, Task};
use super::service::ParameterTask;
use super::{Dashboard, archive, live, lock};
use crate::cli::error::CliError;
use crate::cli::params;
use axum::Json;
use axum::body::Bytes;
use axum::extract::{Path, State};
use axum::http::StatusCode;
use axum::http::header::{CACHE_CONTROL, CONTENT_DISPOSITION, CONTENT_TYPE};
use axum::response::{IntoResponse, Response};
use serde_json::{Value, json};
use std::time::Duration;
use tokio::sync::oneshot;
use wmr::link::port;

/// A robot that is there answers within this long.
const ANSWER_TIMEOUT: Duration = Duration::from_secs(8);

/// The ports that there are: the simulated robot, what the program was started with, and serial ports.
pub(super) async fn ports(State(dashboard): State<Dashboard>) -> Answer {
    let ports = dashboard.jobs.run(|_| Ok(port::list().unwrap_or_default())).await?;
    let mut names = vec![json!({"name": "sim", "kind": "simulated robot"})];
    let first: &str = &dashboard.first_port;
    if first != "sim" {
        names.push(json!({"name": first, "kind": "given at the start"}));
    }
    for info in ports.iter().filter(|info| info.port_name != first) {
        let kind = if port::is_robot(info) { "wmr robot" } else { "something else" };
        names.push(json!({"name": info.port_name, "kind": kind}));
    }
    Ok(Json(json!({"ports": names})))
}

/// Another robot from now on.
pub(super) async fn connect(State(dashboard): State<Dashboard>, body: Bytes) -> Answer {
    let ConnectRequest { port } = parse(&body)?;
    // A page may not have any file of this computer opened.
    let is_known = port == "sim"
        || port == *dashboard.first_port
        || port == "auto"
        || port.starts_with("tcp://")
        || port::list().unwrap_or_default().iter().any(|info| info.port_name == port);
    if !is_known {
        return Err(Failure::bad_request(format!(
            "{port:?} is not one of the ports here; sim, auto, tcp://HOST:PORT or one of /api/ports"
        )));
    }
    let stays_simulated = live::is_simulated(&port);
    queue(&dashboard, Task::Connect(port))?;
    if dashboard.camera.is_simulated() && !stays_simulated {
        dashboard.camera.switch_off();
    }
    Ok(Json(json!({"connecting": true})))
}

/// A task that moves nothing.
fn queue(dashboard: &Dashboard, task: Task) -> Result<(), Failure> {
    let busy = || Failure::missing("robot.busy", "the robot is under way", "wait, or stop it");
    if lock(&dashboard.live).run.active {
        return Err(busy());
    }
    let stops = dashboard.controls.stops();
    dashboard.orders.try_send(Order { task, stops }).map_err(|_| busy())
}

/// The robot's numbers, read or changed.
pub(super) async fn parameters(State(dashboard): State<Dashboard>, body: Bytes) -> Answer {
    let request: ParametersRequest = parse_or_default(&body)?;
    let change = |(name, value): (&String, &f64)| params::named_change(name, *value as f32);
    let changes = request.values.iter().map(change).collect::<Result<Vec<_>, _>>();
    let changes = changes.map_err(Failure::bad_request)?;
    let (reply, answer) = oneshot::channel();
    queue(&dashboard, Task::Parameters(ParameterTask { changes, keep: request.keep, reply }))?;
    answered(answer).await
}

/// What the robot's thread answers.
async fn answered(answer: oneshot::Receiver<Result<Value, CliError>>) -> Answer {
    match tokio::time::timeout(ANSWER_TIMEOUT, answer).await {
        Ok(Ok(answer)) => Ok(Json(answer?)),
        _ => Err(Failure::new(
            StatusCode::SERVICE_UNAVAILABLE,
            "robot.silent",
            "the robot does not answer",
            "check its cable and battery",
        )),
    }
}

/// Drives one of the courses of a calibration.
pub(super) async fn course(State(dashboard): State<Dashboard>, body: Bytes) -> Answer {
    let request: CourseRequest = parse(&body)?;
    order(&dashboard, Task::Course(request.course()?))
}

/// The lengths that explain where the courses ended, given to the robot.
pub(super) async fn calibrate(State(dashboard): State<Dashboard>, body: Bytes) -> Answer {
    let request: CalibrateRequest = parse(&body)?;
    let (reply, answer) = oneshot::channel();
    let task = CalibrateTask { runs: request.runs()?, keep: request.keep, reply };
    queue(&dashboard, Task::Calibrate(task))?;
    answered(answer).await
}

/// What goes wrong with a simulated robot.
pub(super) async fn faults(State(dashboard): State<Dashboard>, body: Bytes) -> Answer {
    let faults: SimulatedFaults = parse_or_default(&body)?;
    faults.check()?;
    dashboard.faults.set(faults);
    Ok(Json(json!({ "faults": faults })))
}

/// The last frames on the link.
pub(super) async fn frames(State(dashboard): State<Dashboard>) -> Json<Value> {
    Json(dashboard.frames.document())
}

/// A button that is pressed, held or let go.
pub(super) fn hold(dashboard: &Dashboard, hold: Option<Hold>, begins: bool) -> Answer {
    let Some(hold) = hold else {
        dashboard.controls.let_go();
        return Ok(Json(json!({"held": false})));
    };
    if !begins {
        // What was let go, stopped or has failed starts again only with a new press.
        return Ok(Json(json!({"held": dashboard.controls.keep_holding(hold)})));
    }
    order(dashboard, Task::Held(hold))
}

/// The drives that were kept.
pub(super) async fn runs(State(dashboard): State<Dashboard>) -> Answer {
    let archive = dashboard.archive.clone();
    Ok(Json(dashboard.jobs.run(move |_| Ok(archive.list())).await?))
}

/// One of them.
pub(super) async fn run(State(dashboard): State<Dashboard>, Path(name): Path<String>) -> Answer {
    let archive = dashboard.archive.clone();
    let document = dashboard.jobs.run(move |_| Ok(archive.open(&name))).await?;
    document.map(Json).ok_or_else(no_run)
}

/// A file of one of them.
pub(super) async fn run_file(
    State(dashboard): State<Dashboard>,
    Path((name, file)): Path<(String, String)>,
) -> Result<Response, Failure> {
    let (archive, wanted) = (dashboard.archive.clone(), file.clone());
    let bytes = dashboard.jobs.run(move |_| Ok(archive.read(&name, &wanted))).await?;
    let Some(bytes) = bytes else { return Err(unknown().await) };
    let head = [
        (CONTENT_TYPE, archive::content_type(&file, &bytes).to_owned()),
        (CACHE_CONTROL, "no-store".to_owned()),
        (CONTENT_DISPOSITION, format!("attachment; filename=\"{file}\"")),
    ];
    Ok((head, bytes).into_response())
}

fn no_run() -> Failure {
    let error: CliError = archive::not_there();
    Failure { status: StatusCode::NOT_FOUND, error }
}
