//! What a request is answered that cannot be carried out: the error document of the command line, with a
//! status that says whose fault it is.

use crate::cli::error::{CliError, Exit};
use axum::Json;
use axum::extract::rejection::JsonRejection;
use axum::http::StatusCode;
use axum::response::{IntoResponse, Response};
use std::fmt::Display;

/// A refusal.
#[derive(Clone, Debug)]
pub(super) struct Failure {
    pub(super) status: StatusCode,
    pub(super) error: CliError,
}

impl Failure {
    pub(super) fn new(status: StatusCode, code: &str, message: impl Display, help: &str) -> Self {
        Self { status, error: CliError::new(Exit::Usage, code, message, help) }
    }

    /// A request that makes no sense.
    pub(super) fn bad_request(message: impl Display) -> Self {
        let help = "openapi.json at /api/openapi.json describes every request";
        Self::new(StatusCode::BAD_REQUEST, "http.request", message, help)
    }

    /// Something has to be there before.
    pub(super) fn missing(code: &str, message: &str, help: &str) -> Self {
        Self::new(StatusCode::CONFLICT, code, message, help)
    }
}

impl From<CliError> for Failure {
    fn from(error: CliError) -> Self {
        let status = match error.exit {
            Exit::Bug => StatusCode::INTERNAL_SERVER_ERROR,
            Exit::Usage => StatusCode::BAD_REQUEST,
            Exit::File | Exit::NoPath => StatusCode::UNPROCESSABLE_ENTITY,
            Exit::Port | Exit::Link => StatusCode::SERVICE_UNAVAILABLE,
            Exit::Robot | Exit::Interrupted => StatusCode::CONFLICT,
        };
        Self { status, error }
    }
}

impl From<JsonRejection> for Failure {
    fn from(rejection: JsonRejection) -> Self {
        Self { status: rejection.status(), ..Self::bad_request(rejection.body_text()) }
    }
}

impl IntoResponse for Failure {
    fn into_response(self) -> Response {
        (self.status, Json(self.error.document())).into_response()
    }
}
