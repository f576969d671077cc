//! Requests about the camera over the arena: on and off, its newest frame, things set down under a simulated one,
//! and the drives that it watches.

use super::camera::{SIMULATED, Thing};
use super::error::Failure;
use super::handlers::{Answer, order_since, parse};
use super::robot::Task;
use super::watched::{FirstLook, newest_frame};
use super::{Dashboard, lock};
use crate::cli::error::CliError;
use axum::Json;
use axum::body::Bytes;
use axum::extract::State;
use axum::http::header::{CACHE_CONTROL, CONTENT_TYPE};
use axum::response::{IntoResponse, Response};
use hil_sim::motion::Motion;
use hil_sim::world::Shape;
use serde::Deserialize;
use serde_json::json;
use std::time::Duration;

/// What `wmr serve` was told of a camera.
#[derive(Clone, Debug, Default)]
pub(super) struct GivenCamera {
    /// The source, as `--watch` names it.
    pub(super) source: Option<String>,
    /// How much older its pictures are than it says.
    pub(super) delay: Duration,
}

/// `POST /api/camera`.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct CameraRequest {
    /// One of the sources that the state names; `null` switches the camera off.
    source: Option<String>,
}

/// `POST /api/things`: a box that is set down, and where it rolls.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct ThingRequest {
    at: [f64; 2],
    /// Its width and depth.
    #[serde(default = "ThingRequest::usual_size")]
    size: [f64; 2],
    to: Option<[f64; 2]>,
    #[serde(default = "ThingRequest::usual_speed")]
    speed: f64,
}

/// What can stand in a usual arena, metres and m/s.
const SIDES: std::ops::RangeInclusive<f64> = 0.02..=1.0;
const SPEEDS: std::ops::RangeInclusive<f64> = 0.01..=1.0;

impl ThingRequest {
    fn usual_size() -> [f64; 2] {
        [0.12; 2]
    }

    fn usual_speed() -> f64 {
        0.15
    }

    /// The thing, where the arena's lower left corner lies at `origin`.
    fn thing(&self, origin: [f64; 2]) -> Result<Thing, Failure> {
        let numbers = [self.at, self.to.unwrap_or(self.at)].concat();
        if numbers.iter().any(|number| !number.is_finite()) {
            return Err(Failure::bad_request("a place is not finite"));
        }
        let has_size = self.size.iter().all(|side| SIDES.contains(side));
        if !has_size || !SPEEDS.contains(&self.speed) {
            return Err(Failure::bad_request(format!(
                "a box has sides from {} to {} m, and rolls at {} to {} m/s",
                SIDES.start(),
                SIDES.end(),
                SPEEDS.start(),
                SPEEDS.end()
            )));
        }
        let [x, y] = [0, 1].map(|axis| self.at[axis] - origin[axis]);
        let motion = match self.to {
            None => Motion::Still,
            Some(to) => Motion::Way {
                shifts: vec![[0, 1].map(|axis| to[axis] - self.at[axis])],
                speed: self.speed,
                again: false,
            },
        };
        let [half_width, half_depth] = self.size.map(|side| side / 2.0);
        let shape = Shape::Rect([x - half_width, y - half_depth, x + half_width, y + half_depth]);
        Ok(Thing { shape, motion })
    }
}

impl Dashboard {
    /// The cameras that a page may switch on: a simulated one over a simulated robot, and the one that the program
    /// was started with.
    pub(super) fn camera_sources(&self) -> Vec<&str> {
        let is_simulated = lock(&self.live).is_simulated();
        let given = self.given_camera.source.as_deref().filter(|given| *given != SIMULATED);
        given.into_iter().chain(is_simulated.then_some(SIMULATED)).collect()
    }

    /// Switches one of them on.
    pub(super) fn switch_on(&self, source: &str) -> Result<(), CliError> {
        let delay = self.given_camera.delay;
        self.camera.switch_on(source, delay)?;
        self.arrange(false);
        Ok(())
    }

    /// Puts what lies on the desk under the simulated camera, if that is on and there is a scene with a start; the
    /// robot stands there again if something has changed, or if that is `wished`.
    pub(super) fn arrange(&self, wished: bool) {
        if !self.camera.is_simulated() {
            return;
        }
        let desk = lock(&self.desk);
        if let Some((scene, start)) = desk.start() {
            self.camera.arrange(scene, start, wished);
        }
    }
}

/// Switches a camera on or off.
pub(super) async fn switch(State(dashboard): State<Dashboard>, body: Bytes) -> Answer {
    let CameraRequest { source } = parse(&body)?;
    if lock(&dashboard.live).run.active {
        return Err(Failure::missing("robot.busy", "the robot is under way", "wait, or stop it"));
    }
    match source {
        None => dashboard.camera.switch_off(),
        // A page may not have any file of this computer read, nor any address asked.
        Some(source) if dashboard.camera_sources().contains(&source.as_str()) => {
            dashboard.switch_on(&source)?;
        }
        Some(source) => {
            let known = dashboard.camera_sources().join(", ");
            return Err(Failure::bad_request(format!(
                "{source:?} is none of the cameras here: {known}; wmr serve --watch names another"
            )));
        }
    }
    Ok(Json(json!({"camera": dashboard.camera.document(&dashboard.camera_sources())})))
}

/// The newest frame.
pub(super) async fn frame(State(dashboard): State<Dashboard>) -> Result<Response, Failure> {
    let shot = dashboard.camera.shown().ok_or_else(|| {
        Failure::missing("camera.none", "there is no picture yet", "switch a camera on")
    })?;
    let head = [(CONTENT_TYPE, shot.content_type), (CACHE_CONTROL, "no-store")];
    Ok((head, shot.bytes.clone()).into_response())
}

/// Sets something down under the simulated camera.
pub(super) async fn things(State(dashboard): State<Dashboard>, body: Bytes) -> Answer {
    let request: ThingRequest = parse(&body)?;
    let origin = lock(&dashboard.desk).start().and_then(|(scene, _)| scene.origin);
    let thing = request.thing(origin.map_or([0.0; 2], |corner| [corner.x, corner.y]))?;
    if !dashboard.camera.is_simulated() || !dashboard.camera.set_down(thing) {
        return Err(Failure::missing(
            "camera.no_floor",
            "nothing can be set down: there is no simulated floor, or it is full",
            "plan a way, then switch the simulated camera on, or off and on again",
        ));
    }
    Ok(Json(json!({"set_down": true})))
}

/// Begins a drive that the camera watches, unless it is stopped before.
pub(super) async fn begin(dashboard: &Dashboard, stops: u64) -> Answer {
    dashboard.arrange(true);
    let shot = newest_frame(dashboard).await?;
    let lens = dashboard.camera.lens();
    let look = FirstLook::new(&lock(&dashboard.desk), lens, &shot)?;
    let task = dashboard.jobs.run(move |_| look.see(&shot)).await?;
    order_since(dashboard, Task::Watched(Box::new(task)), stops)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn thing(text: &str) -> Result<Thing, String> {
        let request: ThingRequest =
            serde_json::from_str(text).map_err(|error| error.to_string())?;
        request.thing([1.0, 2.0]).map_err(|failure| failure.error.message)
    }

    #[test]
    fn a_box_stands_or_rolls_in_the_arena_s_frame() {
        let still = thing(r#"{"at":[1.5,2.25],"size":[0.5,0.25]}"#).unwrap();
        let shape = Shape::Rect([0.25, 0.125, 0.75, 0.375]);
        assert_eq!((still.shape, still.motion), (shape, Motion::Still));
        let rolls = thing(r#"{"at":[1.5,2.25],"to":[1.5,2.75],"speed":0.25}"#).unwrap();
        assert_eq!(rolls.motion.shift(1.0), [0.0, 0.25]);
        assert_eq!(rolls.motion.shift(9.0), [0.0, 0.5], "it stays where it was sent");
    }

    #[test]
    fn what_is_no_box_is_refused() {
        for text in [
            r#"{"at":[1,2],"size":[0,0.1]}"#,
            r#"{"at":[1,2],"size":[9,0.1]}"#,
            r#"{"at":[1,2],"to":[2,2],"speed":5}"#,
            r#"{"at":[1]}"#,
            r#"{"at":[1,2],"width":1}"#,
        ] {
            assert!(thing(text).is_err(), "{text}");
        }
    }
}
