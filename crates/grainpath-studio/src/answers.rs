//! Error answers, and answers made of bytes.

use axum::extract::rejection::{JsonRejection, QueryRejection, StringRejection};
use axum::http::{HeaderMap, StatusCode, header};
use axum::response::{IntoResponse, Response};
use serde_json::json;

use crate::refusal::Refusal;
use crate::runs::{MOST_KEPT, MOST_SURFACES};

/// Largest job file that is read, bytes. Source: chosen; jobs have some kilobytes.
pub(crate) const MAX_JOB_BYTES: u64 = 4 << 20;

/// An error as JSON, with its status.
pub(crate) fn refused(status: StatusCode, message: &str) -> Response {
    (status, axum::Json(json!({ "ok": false, "error": message }))).into_response()
}

/// An error that is sent in place of the answer.
pub(crate) struct Problem(StatusCode, String);

impl Problem {
    pub(crate) fn new(status: StatusCode, message: impl Into<String>) -> Self {
        Self(status, message.into())
    }

    /// A job is larger than those that are read.
    pub(crate) fn large_job() -> Self {
        let limit = in_words(MAX_JOB_BYTES);
        Self::new(
            StatusCode::PAYLOAD_TOO_LARGE,
            format!("the job is larger than {limit}, the limit of a job file"),
        )
    }

    pub(crate) fn missing() -> Self {
        let words = format!(
            "no such job: the studio keeps its latest {MOST_KEPT} jobs, of shapes, stress and supports the latest \
             {MOST_SURFACES} each, until it is closed; run it again"
        );
        Self::new(StatusCode::NOT_FOUND, words)
    }
}

impl IntoResponse for Problem {
    fn into_response(self) -> Response {
        refused(self.0, &self.1)
    }
}

impl From<Refusal> for Problem {
    fn from(refusal: Refusal) -> Self {
        Self(StatusCode::UNPROCESSABLE_ENTITY, refusal.message)
    }
}

/// A number of bytes in words.
pub(crate) fn in_words(bytes: u64) -> String {
    if bytes < 1_000_000 { format!("{bytes} bytes") } else { format!("{:.1} MB", bytes as f64 * 1e-6) }
}

/// The body of a request cannot be used. All that are limited hold jobs.
fn wrong_body(status: StatusCode, words: String) -> Problem {
    if status == StatusCode::PAYLOAD_TOO_LARGE { Problem::large_job() } else { Problem(status, words) }
}

impl From<JsonRejection> for Problem {
    fn from(rejection: JsonRejection) -> Self {
        wrong_body(rejection.status(), rejection.body_text())
    }
}

impl From<QueryRejection> for Problem {
    fn from(rejection: QueryRejection) -> Self {
        Self(rejection.status(), rejection.body_text())
    }
}

impl From<StringRejection> for Problem {
    fn from(rejection: StringRejection) -> Self {
        wrong_body(rejection.status(), rejection.body_text())
    }
}

/// The error answer for a panic in the thread that made an answer.
pub(crate) fn fault(_: tokio::task::JoinError) -> Problem {
    Problem::new(StatusCode::INTERNAL_SERVER_ERROR, "a fault of grainpath; the terminal shows where")
}

/// Whether the client accepts gzip.
pub(crate) fn accepts_gzip(headers: &HeaderMap) -> bool {
    let given = headers.get(header::ACCEPT_ENCODING).and_then(|v| v.to_str().ok()).unwrap_or_default();
    // `gzip;q=0` says that it is not wanted (RFC 9110, section 12.5.3).
    given.split(',').any(|word| {
        let (name, weight) = word.split_once(';').unwrap_or((word, "q=1"));
        let weight = weight.trim().trim_start_matches("q=").parse::<f64>();
        name.trim().eq_ignore_ascii_case("gzip") && weight != Ok(0.0)
    })
}

/// Bytes as gzip, for answers that are made once.
pub(crate) fn packed(bytes: &[u8]) -> Vec<u8> {
    gzip(bytes, flate2::Compression::fast())
}

/// Bytes as gzip, as small as it gets: for the page, which is packed once for all visits.
pub(crate) fn packed_small(bytes: &[u8]) -> Vec<u8> {
    gzip(bytes, flate2::Compression::best())
}

fn gzip(bytes: &[u8], level: flate2::Compression) -> Vec<u8> {
    use std::io::Write;
    let mut encoder = flate2::write::GzEncoder::new(Vec::new(), level);
    // Writing to memory cannot fail.
    let written = encoder.write_all(bytes).and_then(|()| encoder.finish());
    written.unwrap_or_default()
}

/// An answer of bytes; `is_packed` says that they are gzip.
pub(crate) fn binary(bytes: Vec<u8>, is_packed: bool) -> Response {
    let mut response = ([(header::CONTENT_TYPE, "application/octet-stream")], bytes).into_response();
    if is_packed {
        response.headers_mut().insert(header::CONTENT_ENCODING, header::HeaderValue::from_static("gzip"));
    }
    response
}
