//! Files dropped on the page: streamed to the disk, never held in memory.
//!
//! A file is written under a temporary name below the working folder and gets its name when it is whole. An upload
//! that breaks off or is larger than the limit leaves no file.

use std::io::Write;
use std::sync::Arc;

use axum::Json;
use axum::body::Body;
use axum::extract::rejection::QueryRejection;
use axum::extract::{DefaultBodyLimit, Query, State};
use axum::http::{HeaderMap, StatusCode, header};
use futures_util::StreamExt;
use serde::Deserialize;
use serde_json::json;

use crate::answers::{Problem, in_words};
use crate::refusal::{Refusal, plain};
use crate::roots::{UPLOADS, safe_name, stem_and_ending, temporary};
use crate::studio::Studio;

#[derive(Deserialize)]
pub(crate) struct NameQuery {
    pub name: String,
}

/// Switches off axum's limit of 2 MB, which protects memory: uploads are streamed to the disk.
pub(crate) fn no_limit_of_axum() -> DefaultBodyLimit {
    DefaultBodyLimit::disable()
}

fn too_large(studio: &Studio) -> Problem {
    let advice = "choose it on the server's side instead, or start with a larger --max-upload";
    let limit = in_words(studio.max_upload);
    Problem::new(StatusCode::PAYLOAD_TOO_LARGE, format!("the file is larger than {limit}; {advice}"))
}

/// Writes the body to `uploads/NAME` below the working folder and answers with its path.
pub(crate) async fn upload(
    State(studio): State<Arc<Studio>>,
    query: Result<Query<NameQuery>, QueryRejection>,
    headers: HeaderMap,
    body: Body,
) -> Result<Json<serde_json::Value>, Problem> {
    let Query(query) = query?;
    let announced = headers.get(header::CONTENT_LENGTH).and_then(|v| v.to_str().ok()?.parse::<u64>().ok());
    if announced.is_some_and(|n| n > studio.max_upload) {
        return Err(too_large(&studio));
    }
    let folder = studio.roots.writable(&studio.roots.work().join(UPLOADS))?;
    let shown = folder.display().to_string();
    let wrong =
        |e: std::io::Error| Problem::from(Refusal::usage(format!("cannot write {shown}: {}", plain(&e))));
    std::fs::create_dir_all(&folder).map_err(wrong)?;
    let mut file = temporary(&folder).map_err(wrong)?;
    let (mut chunks, mut length) = (body.into_data_stream(), 0_u64);
    while let Some(chunk) = chunks.next().await {
        let broken = |_| Problem::new(StatusCode::BAD_REQUEST, "the upload broke off; drop the file again");
        let chunk = chunk.map_err(broken)?;
        length += chunk.len() as u64;
        if length > studio.max_upload {
            return Err(too_large(&studio));
        }
        // The system buffers writes, so this waits only if the disk is slower than the upload.
        file.write_all(&chunk).map_err(wrong)?;
    }
    if length == 0 {
        return Err(Refusal::input("the file is empty").into());
    }
    let name = safe_name(&query.name);
    let (stem, ending) = stem_and_ending(&name);
    for k in 1.. {
        let free = if k == 1 { name.clone() } else { format!("{stem}-{k}{ending}") };
        let path = folder.join(free);
        // This fails if the name is taken, so that two pages never write the same file.
        match file.persist_noclobber(&path) {
            Ok(_) => {
                return Ok(Json(json!({ "ok": true, "path": path.display().to_string(), "bytes": length })));
            }
            Err(e) if e.error.kind() == std::io::ErrorKind::AlreadyExists => file = e.file,
            Err(e) => return Err(wrong(e.error)),
        }
    }
    Err(Problem::new(StatusCode::CONFLICT, "no name is free"))
}
