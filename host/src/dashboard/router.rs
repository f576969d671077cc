//! Which request goes where, and how large and long it may be.

use super::error::Failure;
use super::{Dashboard, base, files, handlers, lookout, security, socket};
use axum::extract::{DefaultBodyLimit, Request};
use axum::http::{HeaderName, HeaderValue, StatusCode};
use axum::middleware::{Next, from_fn, from_fn_with_state};
use axum::response::Response;
use axum::routing::{MethodRouter, get, post};
use axum::{Router, middleware};
use std::time::Duration;

/// A photo of 40 megapixels is smaller as PNG or JPEG.
const LARGEST_PHOTO: usize = 64 << 20;
/// A scene of 2000 obstacles is much smaller.
const LARGEST_DOCUMENT: usize = 1 << 20;
/// A request that is not complete after this long is given up.
const LONGEST_REQUEST: Duration = Duration::from_secs(60);

/// All requests: method, path and what answers.
pub(super) fn routes() -> Vec<(&'static str, &'static str, MethodRouter<Dashboard>)> {
    let photo = post(handlers::photo).layer(DefaultBodyLimit::max(LARGEST_PHOTO));
    vec![
        ("get", "/", get(files::page)),
        ("get", "/page/{file}", get(files::file)),
        ("get", "/api/openapi.json", get(files::openapi)),
        ("get", "/api/state", get(handlers::state)),
        ("get", "/api/run.jsonl", get(handlers::run_log)),
        ("get", "/api/photo", get(handlers::show_photo)),
        ("post", "/api/photo", photo),
        ("post", "/api/corners", post(handlers::corners)),
        ("post", "/api/detect", post(handlers::detect)),
        ("get", "/api/scene", get(handlers::scene_file)),
        ("post", "/api/scene", post(handlers::scene)),
        ("post", "/api/steps", post(handlers::steps)),
        ("get", "/api/steps/{name}", get(handlers::step)),
        ("post", "/api/plan", post(handlers::plan)),
        ("post", "/api/cancel", post(handlers::cancel)),
        ("post", "/api/drive", post(handlers::drive)),
        ("post", "/api/pause", post(handlers::pause)),
        ("post", "/api/resume", post(handlers::resume)),
        ("post", "/api/stop", post(handlers::stop)),
        ("post", "/api/jog", post(handlers::jog)),
        ("post", "/api/camera", post(lookout::switch)),
        ("get", "/api/camera/frame", get(lookout::frame)),
        ("post", "/api/things", post(lookout::things)),
        ("get", "/api/ports", get(base::ports)),
        ("post", "/api/connect", post(base::connect)),
        ("post", "/api/parameters", post(base::parameters)),
        ("post", "/api/course", post(base::course)),
        ("post", "/api/calibrate", post(base::calibrate)),
        ("post", "/api/faults", post(base::faults)),
        ("get", "/api/frames", get(base::frames)),
        ("get", "/api/runs", get(base::runs)),
        ("get", "/api/runs/{name}", get(base::run)),
        ("get", "/api/runs/{name}/{file}", get(base::run_file)),
        ("get", "/ws", get(socket::open)),
    ]
}

/// Answers every request.
pub(super) fn router(dashboard: Dashboard) -> Router {
    let all = routes()
        .into_iter()
        .fold(Router::new(), |router, (_, path, answer)| router.route(path, answer));
    all.fallback(handlers::unknown)
        .layer(DefaultBodyLimit::max(LARGEST_DOCUMENT))
        .layer(from_fn(bounded))
        .layer(from_fn_with_state(dashboard.clone(), security::check))
        .layer(middleware::map_response(hardened))
        .with_state(dashboard)
}

/// Gives up a request that takes too long. An open socket is answered at once and not bounded.
async fn bounded(request: Request, next: Next) -> Result<Response, Failure> {
    tokio::time::timeout(LONGEST_REQUEST, next.run(request)).await.map_err(|_| {
        let help = "send less, or over a better network";
        Failure::new(StatusCode::REQUEST_TIMEOUT, "http.slow", "the request took too long", help)
    })
}

/// What a browser is told about every answer.
async fn hardened(mut response: Response) -> Response {
    let heads = [
        (
            "content-security-policy",
            "default-src 'self'; img-src 'self' blob: data:; media-src 'self' blob:; frame-ancestors 'none'; base-uri 'none'; form-action 'none'",
        ),
        ("x-content-type-options", "nosniff"),
        ("x-frame-options", "DENY"),
        ("referrer-policy", "no-referrer"),
        ("cross-origin-resource-policy", "same-origin"),
    ];
    for (name, value) in heads {
        response
            .headers_mut()
            .insert(HeaderName::from_static(name), HeaderValue::from_static(value));
    }
    response
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::Value;
    use std::collections::BTreeSet;

    fn document() -> Value {
        serde_json::from_str(files::OPENAPI).unwrap()
    }

    #[test]
    fn openapi_describes_what_is_routed_and_nothing_else() {
        let document = document();
        let described: BTreeSet<(String, String)> = document["paths"]
            .as_object()
            .unwrap()
            .iter()
            .flat_map(|(path, methods)| {
                methods
                    .as_object()
                    .unwrap()
                    .keys()
                    .map(move |method| (method.clone(), path.clone()))
            })
            .collect();
        let routed: BTreeSet<(String, String)> = routes()
            .into_iter()
            .map(|(method, path, _)| (method.to_owned(), path.to_owned()))
            .collect();
        assert_eq!(described, routed);
    }

    #[test]
    fn openapi_names_no_schema_that_is_not_there() {
        let document = document();
        let text = files::OPENAPI;
        let schemas = document["components"]["schemas"].as_object().unwrap();
        let named: BTreeSet<&str> = text
            .split("#/components/schemas/")
            .skip(1)
            .filter_map(|rest| rest.split('"').next())
            .collect();
        assert!(named.iter().all(|name| schemas.contains_key(*name)), "{named:?}");
        assert!(schemas.keys().all(|name| named.contains(name.as_str())), "{named:?}");
    }

    /// The view is the document of the library, whose schema is held against its type.
    #[test]
    fn openapi_s_view_has_the_fields_of_the_document() {
        let text = include_str!("../../schemas/watch-view.schema.json");
        let schema: Value = serde_json::from_str(text).unwrap();
        let view = &document()["components"]["schemas"]["WatchView"];
        let names = |of: &Value| -> BTreeSet<String> {
            of["properties"].as_object().unwrap().keys().cloned().collect()
        };
        assert_eq!(names(view), names(&schema));
        let thing = &view["properties"]["things"]["items"];
        assert_eq!(names(thing), names(&schema["$defs"]["ThingDocument"]));
    }

    #[test]
    fn every_change_asks_for_the_token() {
        let document = document();
        for (path, methods) in document["paths"].as_object().unwrap() {
            if let Some(post) = methods.get("post") {
                assert!(post["security"].is_array(), "{path}");
            }
        }
    }
}
