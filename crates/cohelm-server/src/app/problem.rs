//! An answer that is none, in words: `{"error": …}` and what belongs to it.

use crate::secret::SecretError;
use crate::store::StoreError;
use crate::study::LoginError;
use axum::Json;
use axum::http::{HeaderValue, StatusCode, header};
use axum::response::{IntoResponse, Response};
use serde_json::{Value, json};
use std::time::Duration;

/// After how long to try again when the database could not be written, seconds.
const TRY_AGAIN_S: u64 = 5;

/// An answer that is none.
#[derive(Debug)]
pub struct Problem {
    status: StatusCode,
    body: Value,
    again_s: Option<u64>,
}

impl Problem {
    /// With a sentence for whoever asked.
    pub fn new(status: StatusCode, words: impl Into<String>) -> Self {
        Self { status, body: json!({ "error": words.into() }), again_s: None }
    }

    /// The same with something more in its JSON.
    pub fn with(mut self, name: &str, value: impl Into<Value>) -> Self {
        self.body[name] = value.into();
        self
    }

    /// There is no such thing.
    pub fn not_found(what: &str) -> Self {
        Self::new(StatusCode::NOT_FOUND, what)
    }

    /// Too many requests.
    pub fn too_often(wait: Duration) -> Self {
        let again_s = wait.as_secs() + 1;
        let words = format!("too many requests; wait {again_s} s");
        Self { again_s: Some(again_s), ..Self::new(StatusCode::TOO_MANY_REQUESTS, words) }
    }

    /// Nothing can be stored: the study waits, nothing is lost.
    pub fn paused(error: &StoreError) -> Self {
        tracing::error!(%error, "the database failed; the study pauses");
        let words = format!("the study pauses, nothing is lost: {error}");
        let problem = Self::new(StatusCode::SERVICE_UNAVAILABLE, words).with("paused", true);
        Self { again_s: Some(TRY_AGAIN_S), ..problem }
    }

    /// The sentence.
    pub fn words(&self) -> &str {
        self.body["error"].as_str().unwrap_or_default()
    }
}

impl IntoResponse for Problem {
    fn into_response(self) -> Response {
        let mut response = (self.status, Json(self.body)).into_response();
        if let Some(seconds) = self.again_s {
            response.headers_mut().insert(header::RETRY_AFTER, HeaderValue::from(seconds));
        }
        response
    }
}

impl From<StoreError> for Problem {
    fn from(error: StoreError) -> Self {
        tracing::error!(%error, "the database failed");
        Self::new(StatusCode::INTERNAL_SERVER_ERROR, error.to_string())
    }
}

impl From<SecretError> for Problem {
    fn from(error: SecretError) -> Self {
        tracing::error!(%error, "no secret");
        Self::new(StatusCode::INTERNAL_SERVER_ERROR, error.to_string())
    }
}

impl From<LoginError> for Problem {
    fn from(error: LoginError) -> Self {
        match error {
            LoginError::Wrong => Self::new(StatusCode::UNAUTHORIZED, error.to_string()),
            LoginError::TooOften(wait) => Self::too_often(wait),
            LoginError::Secret(error) => error.into(),
        }
    }
}
