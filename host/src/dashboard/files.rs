//! The page, in the binary: it works without a network and cannot be lost.

use super::Dashboard;
use super::error::Failure;
use super::handlers::unknown;
use axum::extract::{Path, State};
use axum::http::header::{CACHE_CONTROL, CONTENT_TYPE};
use axum::response::{IntoResponse, Response};

const HTML: &str = "text/html; charset=utf-8";
const CSS: &str = "text/css; charset=utf-8";
const JAVASCRIPT: &str = "text/javascript; charset=utf-8";

/// The page's own text; the token takes the place of [`TOKEN_PLACE`].
const PAGE: &str = include_str!("page/index.html");
const TOKEN_PLACE: &str = "{{token}}";

/// What the interface is, for programs.
pub(super) const OPENAPI: &str = include_str!("openapi.json");

macro_rules! files {
    ($($name:literal: $kind:ident),* $(,)?) => {
        [$(($name, $kind, include_str!(concat!("page/", $name)))),*]
    };
}

/// Name, kind and text of each file that the page asks for.
pub(super) const FILES: [(&str, &str, &str); 24] = files! {
    "style.css": CSS,
    "app.js": JAVASCRIPT,
    "api.js": JAVASCRIPT,
    "dom.js": JAVASCRIPT,
    "state.js": JAVASCRIPT,
    "actions.js": JAVASCRIPT,
    "floor.js": JAVASCRIPT,
    "stage.js": JAVASCRIPT,
    "hands.js": JAVASCRIPT,
    "photo.js": JAVASCRIPT,
    "boxes.js": JAVASCRIPT,
    "plan.js": JAVASCRIPT,
    "drive.js": JAVASCRIPT,
    "bar.js": JAVASCRIPT,
    "camera.js": JAVASCRIPT,
    "live.js": JAVASCRIPT,
    "seen.js": JAVASCRIPT,
    "watch.js": JAVASCRIPT,
    "reading.js": JAVASCRIPT,
    "steps.js": JAVASCRIPT,
    "plots.js": JAVASCRIPT,
    "runs.js": JAVASCRIPT,
    "base.js": JAVASCRIPT,
    "calibrate.js": JAVASCRIPT,
};

/// The page. Beyond loopback only who has the token gets here; a browser on this computer gets the token
/// with the page, where pages of other origins cannot read it.
pub(super) async fn page(State(dashboard): State<Dashboard>) -> Response {
    answer(HTML, PAGE.replace(TOKEN_PLACE, dashboard.guard.token.text()))
}

/// A style or module of the page.
pub(super) async fn file(Path(name): Path<String>) -> Result<Response, Failure> {
    match FILES.iter().find(|(file, _, _)| *file == name) {
        Some((_, kind, text)) => Ok(answer(kind, *text)),
        None => Err(unknown().await),
    }
}

pub(super) async fn openapi() -> Response {
    answer("application/json", OPENAPI)
}

/// Never from a cache: another version of the program may be served at the same address.
fn answer(kind: &'static str, text: impl IntoResponse) -> Response {
    ([(CONTENT_TYPE, kind), (CACHE_CONTROL, "no-store")], text).into_response()
}
