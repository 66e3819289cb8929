//! The page: files of `dist/`, which `cargo xtask page` made from `web/`.

use std::sync::OnceLock;

use axum::http::{HeaderMap, StatusCode, header};
use axum::response::{IntoResponse, Response};
use grainpath_core::hash::splitmix64;

use crate::answers::{accepts_gzip, packed_small};

/// A file of the page.
pub(crate) struct Asset {
    /// Address below the base.
    pub path: &'static str,
    kind: &'static str,
    bytes: &'static [u8],
    packed: OnceLock<Vec<u8>>,
}

macro_rules! asset {
    ($path:literal, $kind:literal, $file:literal) => {
        Asset {
            path: $path,
            kind: $kind,
            bytes: include_bytes!(concat!("../dist/", $file)),
            packed: OnceLock::new(),
        }
    };
}

/// The licences of the packages whose code is in the page.
pub const LICENCES_OF_PAGE: &str = include_str!("../dist/licences.txt");

/// Every file of the page.
pub(crate) static ALL: [Asset; 7] = [
    asset!("/", "text/html; charset=utf-8", "index.html"),
    asset!("/app.js", "text/javascript; charset=utf-8", "app.js"),
    asset!("/shared.js", "text/javascript; charset=utf-8", "shared.js"),
    asset!("/worker.js", "text/javascript; charset=utf-8", "worker.js"),
    asset!("/app.css", "text/css; charset=utf-8", "app.css"),
    asset!("/icon.svg", "image/svg+xml", "icon.svg"),
    asset!("/licences.txt", "text/plain; charset=utf-8", "licences.txt"),
];

/// A hash of the bytes, which changes when they change.
fn hash(bytes: &[u8]) -> u64 {
    let word = |chunk: &[u8]| chunk.iter().fold(0, |w, b| (w << 8) | u64::from(*b));
    bytes.chunks(8).fold(bytes.len() as u64, |h, chunk| splitmix64(h ^ word(chunk)))
}

impl Asset {
    /// Answers with the file, or says that it has not changed. Browsers ask each time; the hash decides.
    pub(crate) fn answer(&'static self, headers: &HeaderMap) -> Response {
        let tag = format!("\"{:016x}\"", hash(self.bytes));
        let known = headers.get(header::IF_NONE_MATCH).and_then(|v| v.to_str().ok());
        if known.is_some_and(|k| k.contains(&tag)) {
            return (StatusCode::NOT_MODIFIED, [(header::ETAG, tag)]).into_response();
        }
        let fixed = [
            (header::CONTENT_TYPE, self.kind),
            (header::CACHE_CONTROL, "no-cache"),
            (header::VARY, "accept-encoding"),
        ];
        if accepts_gzip(headers) {
            let bytes = self.packed.get_or_init(|| packed_small(self.bytes)).as_slice();
            return (fixed, [(header::ETAG, tag)], [(header::CONTENT_ENCODING, "gzip")], bytes)
                .into_response();
        }
        (fixed, [(header::ETAG, tag)], self.bytes).into_response()
    }
}
