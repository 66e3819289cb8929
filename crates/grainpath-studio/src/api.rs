//! The HTTP interface, version 1: files, jobs, layers.
//!
//! Addresses below `/v1/` answer with JSON; layers and damage are binary. An error is
//! `{"ok": false, "error": "..."}` with the sentence that the command line prints. `docs/studio.md` lists the addresses.

use std::convert::Infallible;
use std::path::{Path as FilePath, PathBuf};
use std::sync::Arc;
use std::time::Duration;

use axum::Json;
use axum::Router;
use axum::body::Body;
use axum::extract::rejection::{JsonRejection, QueryRejection, StringRejection};
use axum::extract::{DefaultBodyLimit, Path, Query, State};
use axum::http::{HeaderMap, StatusCode, header};
use axum::middleware;
use axum::response::sse::{Event, KeepAlive, Sse};
use axum::response::{IntoResponse, Response};
use axum::routing::{MethodRouter, delete, get, post, put};
use futures_util::Stream;
use futures_util::stream::unfold;
use grainpath_gcode::{Limits, simulate};
use serde::{Deserialize, Serialize};
use serde_json::json;

use crate::answers::{MAX_JOB_BYTES, Problem, accepts_gzip, binary, fault, in_words, packed, refused};
use crate::engine::{CaseValues, Finished, JobText, Pictured, StressSurface};
use crate::file_kind::FileKind;
use crate::gate::check;
use crate::openapi::{self, Route};
use crate::records::Records;
use crate::refusal::{Refusal, plain};
use crate::roots::{Roots, safe_name, temporary, write_whole};
use crate::runs::{Kind, Run, State as RunState};
use crate::studio::Studio;
use crate::{assets, cut_view, drafts, history, runs, surface_bytes, uploads};

/// Filament diameter for programs that state none, mm. Source: the nominal diameter of common filament, which the command
/// line uses too.
const FILAMENT_MM: f64 = 1.75;
/// Largest program that is read, bytes. Source: the limit of the command line, a third of 24 GiB of memory.
const MAX_PROGRAM_BYTES: u64 = 8 << 30;
/// Time between two checks of the progress of a run. Source: chosen; ten events a second look continuous.
const EVENT_INTERVAL: Duration = Duration::from_millis(100);
/// The greatest number of layers in one answer. Source: chosen; the page asks for fewer at a time.
const MOST_LAYERS: usize = 4096;

type Shared = State<Arc<Studio>>;

/// Every address of the interface, as its entry in the description and its handler.
fn routes() -> Vec<(Route, MethodRouter<Arc<Studio>>)> {
    let upload = post(uploads::upload).layer(uploads::no_limit_of_axum());
    vec![
        (openapi::STATE, get(state)),
        (openapi::FILES, get(files)),
        (openapi::TEXT, get(text)),
        (openapi::SAVE, post(save).layer(DefaultBodyLimit::max(MAX_JOB_BYTES as usize))),
        (openapi::PICTURE, get(picture)),
        (openapi::JOB_FOR, get(job_for)),
        (openapi::EXAMPLES, get(examples)),
        (openapi::EXAMPLE, post(example)),
        (openapi::UPLOAD, upload),
        (openapi::LIST, get(list)),
        (openapi::BEGIN, post(add).layer(DefaultBodyLimit::max(MAX_WANTED_BYTES))),
        (openapi::CHECK, post(check_job).layer(DefaultBodyLimit::max(MAX_JOB_BYTES as usize))),
        (openapi::ONE, get(one)),
        (openapi::CANCEL, delete(cancel)),
        (openapi::EVENTS, get(events)),
        (openapi::RESULT, get(result)),
        (openapi::LAYERS, get(layer_index)),
        (openapi::PART_PICTURE, get(part_picture)),
        (openapi::LAYER_PICTURE, get(layer_picture)),
        (openapi::CASE_PICTURE, get(case_picture)),
        (openapi::RECORDS, get(layer_records)),
        (openapi::ANGLES, get(layer_angles)),
        (openapi::RESERVE, get(layer_reserve)),
        (openapi::DAMAGE, get(damage)),
        (openapi::SURFACE, get(surface_bytes)),
        (openapi::PART_FILE, get(part_file)),
        (openapi::STRESSED, get(stressed)),
        (openapi::CASE, get(case)),
        (openapi::SECTION, get(section_bytes)),
        (openapi::LINES, get(lines)),
        (openapi::BRANCHES, get(branches)),
        (openapi::HISTORY, get(history_rows)),
        (openapi::DRAFTS, get(draft_rows)),
        (openapi::KEEP, put(keep).layer(DefaultBodyLimit::max(MAX_DRAFT_BYTES))),
        (openapi::OUTPUT, get(output)),
        (openapi::SCHEMA, get(schema)),
        (openapi::PROFILES, get(profiles)),
        (openapi::OPENAPI, get(|| async { Json(description()) })),
    ]
}

/// The interface in the form of OpenAPI 3.1.
pub fn description() -> serde_json::Value {
    let rows: Vec<Route> = routes().into_iter().map(|(route, _)| route).collect();
    openapi::description(&rows)
}

/// All addresses of the studio; every request is checked first.
pub fn router(studio: Arc<Studio>) -> Router {
    let base = studio.base.clone();
    let at = |path: &str| format!("{base}{path}");
    let mut router = Router::new();
    for (route, answers) in routes() {
        router = router.route(&at(route.path), answers);
    }
    for asset in &assets::ALL {
        let answer = move |headers: HeaderMap| async move { asset.answer(&headers) };
        router = router.route(&at(asset.path), get(answer));
    }
    router
        .fallback(|| async { refused(StatusCode::NOT_FOUND, "no such address; docs/studio.md lists them") })
        .layer(middleware::from_fn_with_state(Arc::clone(&studio), check))
        .with_state(studio)
}

type Answer<T> = Result<T, Problem>;

async fn state(State(studio): Shared) -> impl IntoResponse {
    let shown = |p: &PathBuf| p.display().to_string();
    let opened = studio.opened.as_ref().map(|p| json!({ "path": shown(p), "kind": FileKind::from_path(p) }));
    Json(json!({
        "ok": true, "version": env!("CARGO_PKG_VERSION"), "opened": opened,
        "work": studio.roots.work().display().to_string(),
        "roots": studio.roots.readable_folders().iter().map(shown).collect::<Vec<_>>(),
        "max_upload_bytes": studio.max_upload,
    }))
}

#[derive(Deserialize)]
struct PathQuery {
    path: String,
}

/// A file in the listing of a folder.
#[derive(Serialize)]
struct FileRow {
    name: String,
    path: String,
    bytes: u64,
    kind: FileKind,
}

/// The greatest number of files, and of folders, that a listing has.
/// Source: chosen; the folder of a scan has some thousands.
const MOST_ROWS: usize = 5000;

fn listing(roots: &Roots, folder: &FilePath) -> Result<serde_json::Value, Refusal> {
    let folder = roots.readable(folder)?;
    let wrong = |e: std::io::Error| Refusal::input(format!("{}: {}", folder.display(), plain(&e)));
    let (mut folders, mut files) = (Vec::new(), Vec::new());
    for entry in std::fs::read_dir(&folder).map_err(wrong)?.flatten() {
        let name = entry.file_name().to_string_lossy().into_owned();
        // Hidden files are not listed, since they are mostly settings of other programs.
        if name.starts_with('.') {
            continue;
        }
        // The real path follows links, so a link that leads out of the roots is not listed.
        let Ok(real) = roots.readable(&entry.path()) else { continue };
        let Ok(metadata) = std::fs::metadata(&real) else { continue };
        let path = entry.path().display().to_string();
        if metadata.is_dir() {
            folders.push((name, path));
        } else if metadata.is_file() {
            let kind = FileKind::from_path(&entry.path());
            files.push(FileRow { name, path, bytes: metadata.len(), kind });
        }
    }
    folders.sort();
    files.sort_by(|a, b| a.name.cmp(&b.name));
    let n = folders.len() + files.len();
    folders.truncate(MOST_ROWS);
    files.truncate(MOST_ROWS);
    let parent = folder.parent().filter(|p| roots.readable(p).is_ok()).map(|p| p.display().to_string());
    let folders: Vec<_> = folders.iter().map(|(name, path)| json!({ "name": name, "path": path })).collect();
    Ok(json!({ "ok": true, "path": folder.display().to_string(), "parent": parent, "folders": folders,
               "files": files, "left_out": n.saturating_sub(folders.len() + files.len()) }))
}

async fn files(
    State(studio): Shared,
    query: Result<Query<PathQuery>, QueryRejection>,
) -> Answer<Json<serde_json::Value>> {
    let Query(query) = query?;
    let roots = Arc::clone(&studio.roots);
    let read = tokio::task::spawn_blocking(move || listing(&roots, FilePath::new(&query.path))).await;
    Ok(Json(read.map_err(fault)??))
}

fn job_text(roots: &Roots, path: &FilePath) -> Result<JobText, Refusal> {
    let real = roots.readable(path)?;
    let shown = real.display().to_string();
    let wrong = |what: &str| Refusal::usage(format!("{shown}: {what}"));
    let metadata = std::fs::metadata(&real).map_err(|e| wrong(&plain(&e)))?;
    if !metadata.is_file() {
        return Err(wrong("is no file"));
    }
    if metadata.len() > MAX_JOB_BYTES {
        let limit = in_words(MAX_JOB_BYTES);
        return Err(wrong(&format!("is too large for a job file, which has {limit} at most")));
    }
    let text = std::fs::read(&real).map_err(|e| wrong(&plain(&e)))?;
    let text = String::from_utf8(text).map_err(|_| wrong("is not UTF-8 text"))?;
    let folder = real.parent().map(FilePath::to_owned).unwrap_or_default();
    Ok(JobText { text, name: shown, folder })
}

async fn text(
    State(studio): Shared,
    query: Result<Query<PathQuery>, QueryRejection>,
) -> Answer<Json<serde_json::Value>> {
    let Query(query) = query?;
    let path = PathBuf::from(query.path);
    if FileKind::from_path(&path) != FileKind::Job {
        return Err(Refusal::usage(format!("{}: only job files (.toml) are shown", path.display())).into());
    }
    let job = job_text(&studio.roots, &path)?;
    Ok(Json(json!({ "ok": true, "text": job.text, "folder": job.folder.display().to_string() })))
}

/// Writes a job under a new name below the working folder; a file that is there is left as it is.
fn save_text(roots: &Roots, name: &FilePath, text: &str) -> Result<PathBuf, Problem> {
    if FileKind::from_path(name) != FileKind::Job {
        let message = format!("{}: a job file ends in .toml", name.display());
        return Err(Refusal::usage(message).into());
    }
    let path = roots.writable(&roots.work().join(name))?;
    let shown = path.display().to_string();
    let wrong =
        |e: std::io::Error| Problem::from(Refusal::usage(format!("cannot write {shown}: {}", plain(&e))));
    let folder = path.parent().unwrap_or(roots.work());
    std::fs::create_dir_all(folder).map_err(wrong)?;
    // Under a temporary name first, so that a full disk leaves no half of a job.
    let mut file = temporary(folder).map_err(wrong)?;
    std::io::Write::write_all(&mut file, text.as_bytes()).map_err(wrong)?;
    match file.persist_noclobber(&path) {
        Ok(_) => Ok(path),
        Err(e) if e.error.kind() == std::io::ErrorKind::AlreadyExists => {
            let message = format!("{shown} is there already; choose another name");
            Err(Problem::new(StatusCode::CONFLICT, message))
        }
        Err(e) => Err(wrong(e.error)),
    }
}

async fn save(
    State(studio): Shared,
    query: Result<Query<PathQuery>, QueryRejection>,
    text: Result<String, StringRejection>,
) -> Answer<(StatusCode, Json<serde_json::Value>)> {
    let (Query(query), text) = (query?, text?);
    let bytes = text.len();
    let roots = Arc::clone(&studio.roots);
    let written = move || save_text(&roots, FilePath::new(&query.path), &text);
    let path = tokio::task::spawn_blocking(written).await.map_err(fault)??;
    let answer = json!({ "ok": true, "path": path.display().to_string(), "bytes": bytes });
    Ok((StatusCode::CREATED, Json(answer)))
}

/// The job that `grainpath slice` would make for a file, with the settings that it assumes.
async fn job_for(
    State(studio): Shared,
    query: Result<Query<PathQuery>, QueryRejection>,
) -> Answer<Json<serde_json::Value>> {
    let Query(query) = query?;
    let path = studio.roots.readable(FilePath::new(&query.path))?;
    let engine = Arc::clone(&studio.engine);
    let file = path.clone();
    let text = tokio::task::spawn_blocking(move || engine.job_for(&file)).await.map_err(fault)??;
    let folder = path.parent().map(|p| p.display().to_string()).unwrap_or_default();
    Ok(Json(json!({ "ok": true, "text": text, "folder": folder })))
}

async fn examples(State(studio): Shared) -> Json<serde_json::Value> {
    let rows = studio.engine.examples();
    let rows: Vec<_> = rows.iter().map(|e| json!({ "name": e.name, "about": e.about })).collect();
    Json(json!({ "ok": true, "examples": rows }))
}

/// Writes an example to a new folder and returns the path of its job.
fn write_example(studio: &Studio, name: &str) -> Result<PathBuf, Refusal> {
    let Some(files) = studio.engine.example(name) else {
        let names: Vec<&str> = studio.engine.examples().iter().map(|e| e.name).collect();
        return Err(Refusal::usage(format!("no example {name:?}; there are {}", names.join(", "))));
    };
    let folder = studio.roots.new_folder(&safe_name(name))?;
    for (file, content) in &files {
        write_whole(&folder.join(file), content)?;
    }
    let job = files.first().map(|(file, _)| file.as_str()).unwrap_or_default();
    Ok(folder.join(job))
}

async fn example(
    State(studio): Shared,
    query: Result<Query<uploads::NameQuery>, QueryRejection>,
) -> Answer<Json<serde_json::Value>> {
    let Query(query) = query?;
    let own = Arc::clone(&studio);
    let path =
        tokio::task::spawn_blocking(move || write_example(&own, &query.name)).await.map_err(fault)??;
    let bytes = std::fs::metadata(&path).map(|m| m.len()).unwrap_or_default();
    Ok(Json(json!({ "ok": true, "path": path.display().to_string(), "bytes": bytes })))
}

/// A run that the page asks for.
#[derive(Deserialize)]
#[serde(tag = "kind", rename_all = "lowercase", deny_unknown_fields)]
enum Wanted {
    /// Reads a program.
    View { file: String },
    /// Shows the shape of a job.
    Shape(GivenJob),
    /// Solves the loads of a job, without paths.
    Stress(GivenJob),
    /// Ranks the poses of a job's part.
    Orient(GivenJob),
    /// Grows the supports of a job.
    Supports(GivenJob),
    /// Plans a job. A text is saved first, in the folder of the run.
    Plan(GivenJob),
    /// Tests the part of a job, or a program with the loads and the material of a job.
    Strength(GivenTest),
}

/// A job: a file, or a text with a name for its run.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct GivenJob {
    file: Option<String>,
    text: Option<String>,
    name: Option<String>,
    /// The text of the file as the page shows it. A file that reads otherwise by now is refused.
    shown: Option<String>,
}

/// A job of a strength test, as [`GivenJob`], and the program that is tested in place of its plan.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct GivenTest {
    file: Option<String>,
    text: Option<String>,
    name: Option<String>,
    shown: Option<String>,
    program: Option<String>,
}

/// A file's name without its ending.
fn stem(path: &FilePath) -> String {
    path.file_stem().map(|s| s.to_string_lossy().into_owned()).unwrap_or_default()
}

/// Reads a program.
fn view(file: &FilePath, diagnostics: &grainpath_core::Diagnostics) -> Result<Finished, Refusal> {
    diagnostics.begin(grainpath_core::diagnostics::Stage::Read, 0);
    let shown = file.display().to_string();
    let wrong = |what: String| Refusal::input(format!("{shown}: {what}"));
    let metadata = std::fs::metadata(file).map_err(|e| wrong(plain(&e)))?;
    if !metadata.is_file() {
        return Err(wrong("is a folder; a file is needed".to_owned()));
    }
    if metadata.len() > MAX_PROGRAM_BYTES {
        return Err(wrong(format!(
            "has {} bytes; more than {MAX_PROGRAM_BYTES} are not read",
            metadata.len()
        )));
    }
    let bytes = std::fs::read(file).map_err(|e| wrong(plain(&e)))?;
    let program = simulate(&bytes, FILAMENT_MM, &Limits::default()).map_err(|e| wrong(e.to_string()))?;
    diagnostics.check().map_err(|e| wrong(e.to_string()))?;
    let report = json!({
        "ok": true, "layers": program.layers.len(), "printed_mm": program.printed_mm,
        "travel_mm": program.travel_mm, "extruded_mm3": program.extruded_mm3, "filament_mm": program.filament_mm,
        "time_s": program.time_s, "generator": program.generator,
    });
    let warnings = program.warnings.clone();
    Ok(Finished { report, program: Arc::new(program), warnings, ..Finished::default() })
}

const FILE_OR_TEXT: &str = "a job needs either \"file\" or \"text\"";

/// The job of a file, unless the file reads otherwise than the page has `shown` it.
fn job_of_file(roots: &Roots, file: &str, shown: Option<&str>) -> Result<JobText, Refusal> {
    let job = job_text(roots, FilePath::new(file))?;
    // A text area has neither a mark of the byte order nor CR at the ends of lines.
    let as_shown = |text: &str| text.trim_start_matches('\u{feff}').replace("\r\n", "\n");
    if shown.is_some_and(|shown| as_shown(shown) != as_shown(&job.text)) {
        return Err(Refusal::usage(format!(
            "{}: has changed on the disk since it was opened; open it again, or save what is shown under another name",
            job.name
        )));
    }
    Ok(job)
}

impl GivenJob {
    /// The job and the new folder of its run. A job that is a text is saved there.
    fn in_folder(self, roots: &Roots) -> Result<(JobText, PathBuf), Refusal> {
        match (self.file, self.text) {
            (Some(file), None) => {
                let job = job_of_file(roots, &file, self.shown.as_deref())?;
                let folder = roots.new_folder(&safe_name(&stem(FilePath::new(&file))))?;
                Ok((job, folder))
            }
            (None, Some(text)) => {
                let folder = roots.new_folder(&safe_name(self.name.as_deref().unwrap_or("job")))?;
                let path = folder.join("job.toml");
                write_whole(&path, text.as_bytes())?;
                // Paths in the text are relative to the saved file, so that the command line reads the file in the same way.
                let name = path.display().to_string();
                Ok((JobText { text, name, folder: folder.clone() }, folder))
            }
            (Some(_), Some(_)) | (None, None) => Err(Refusal::usage(FILE_OR_TEXT)),
        }
    }

    /// The job without a folder, and its title. If the job is a text, its paths are relative to the working folder.
    fn unsaved(self, roots: &Roots) -> Result<(JobText, String), Refusal> {
        match (self.file, self.text) {
            (Some(file), None) => {
                let job = job_of_file(roots, &file, self.shown.as_deref())?;
                Ok((job, stem(FilePath::new(&file))))
            }
            (None, Some(text)) => {
                let title = self.name.unwrap_or_else(|| "job".to_owned());
                Ok((JobText { text, name: "job.toml".to_owned(), folder: roots.work().to_owned() }, title))
            }
            (Some(_), Some(_)) | (None, None) => Err(Refusal::usage(FILE_OR_TEXT)),
        }
    }
}

fn begin(studio: &Studio, wanted: Wanted) -> Result<Arc<Run>, Refusal> {
    let roots = Arc::clone(&studio.roots);
    let engine = Arc::clone(&studio.engine);
    match wanted {
        Wanted::View { file } => {
            let file = roots.readable(FilePath::new(&file))?;
            let title = file.file_name().map(|n| n.to_string_lossy().into_owned()).unwrap_or_default();
            studio.runs.add(Kind::View, title, Box::new(move |d, _| view(&file, d)))
        }
        Wanted::Shape(given) => {
            let (job, title) = given.unsaved(&roots)?;
            studio.runs.add(Kind::Shape, title, Box::new(move |d, _| engine.shape(&job, &roots, d)))
        }
        Wanted::Stress(given) => {
            let (job, title) = given.unsaved(&roots)?;
            studio.runs.add(Kind::Stress, title, Box::new(move |d, _| engine.stress(&job, &roots, d)))
        }
        Wanted::Orient(given) => {
            let (job, title) = given.unsaved(&roots)?;
            studio.runs.add(Kind::Orient, title, Box::new(move |d, _| engine.orient(&job, &roots, d)))
        }
        Wanted::Supports(given) => {
            let (job, title) = given.unsaved(&roots)?;
            studio.runs.add(Kind::Supports, title, Box::new(move |d, _| engine.supports(&job, &roots, d)))
        }
        Wanted::Plan(given) => {
            let input = given.file.as_ref().map(PathBuf::from);
            let (job, out) = given.in_folder(&roots)?;
            let title = stem(&out);
            let name = title.clone();
            let work: runs::Work = Box::new(move |d, ready| {
                let mut finished = engine.plan(&job, &out, &roots, d, ready)?;
                history::add(&roots, Kind::Plan, &name, input.as_deref(), &mut finished);
                Ok(finished)
            });
            studio.runs.add(Kind::Plan, title, work)
        }
        Wanted::Strength(GivenTest { file, text, name, shown, program }) => {
            let program = program.map(|p| roots.readable(FilePath::new(&p))).transpose()?;
            let input = program.clone().or_else(|| file.as_ref().map(PathBuf::from));
            let (job, out) = GivenJob { file, text, name, shown }.in_folder(&roots)?;
            let name = stem(&out);
            let title = name.clone();
            let work: runs::Work = Box::new(move |d, _| {
                let mut finished = engine.strength(&job, program.as_deref(), &roots, d)?;
                history::add(&roots, Kind::Strength, &name, input.as_deref(), &mut finished);
                Ok(finished)
            });
            studio.runs.add(Kind::Strength, title, work)
        }
    }
}

/// Largest request that begins a run, bytes. A text of a job may take more as JSON, where each quotation mark and each end
/// of a line is two characters.
const MAX_WANTED_BYTES: usize = 2 * MAX_JOB_BYTES as usize;

impl Wanted {
    /// The text of its job, if it has one.
    fn text(&self) -> Option<&str> {
        match self {
            Self::View { .. } => None,
            Self::Shape(job)
            | Self::Stress(job)
            | Self::Orient(job)
            | Self::Supports(job)
            | Self::Plan(job) => job.text.as_deref(),
            Self::Strength(test) => test.text.as_deref(),
        }
    }
}

/// Reads the text of a job as a run of it would, and answers with its error.
async fn check_job(
    State(studio): Shared,
    text: Result<String, StringRejection>,
) -> Answer<Json<serde_json::Value>> {
    let (text, engine, roots) = (text?, Arc::clone(&studio.engine), Arc::clone(&studio.roots));
    let checked = move || {
        let given = GivenJob { file: None, text: Some(text), name: None, shown: None };
        let (job, _) = given.unsaved(&roots)?;
        engine.check(&job, &roots)
    };
    // A job with an error was checked as well as one without: the request succeeded.
    let error =
        tokio::task::spawn_blocking(checked).await.map_err(fault)?.err().map(|refusal| refusal.message);
    Ok(Json(json!({ "ok": error.is_none(), "error": error })))
}

async fn add(
    State(studio): Shared,
    wanted: Result<Json<Wanted>, JsonRejection>,
) -> Answer<(StatusCode, Json<RunState>)> {
    let Json(wanted) = wanted?;
    if wanted.text().is_some_and(|text| text.len() as u64 > MAX_JOB_BYTES) {
        return Err(Problem::large_job());
    }
    let own = Arc::clone(&studio);
    let run = tokio::task::spawn_blocking(move || begin(&own, wanted)).await.map_err(fault)??;
    Ok((StatusCode::ACCEPTED, Json(studio.runs.state(&run))))
}

async fn list(State(studio): Shared) -> Json<serde_json::Value> {
    let all: Vec<RunState> = studio.runs.all().iter().map(|r| studio.runs.state(r)).collect();
    Json(json!({ "ok": true, "jobs": all }))
}

fn found(studio: &Studio, id: u64) -> Answer<Arc<Run>> {
    studio.runs.get(id).ok_or_else(Problem::missing)
}

/// The result of a job that is done. The error says why there is none.
fn done(studio: &Studio, id: u64) -> Answer<Arc<runs::Result>> {
    let run = found(studio, id)?;
    run.result().ok_or_else(|| not_done(studio, &run))
}

fn not_done(studio: &Studio, run: &Run) -> Problem {
    let why = studio.runs.state(run).error.unwrap_or_else(|| "the job is not done yet".to_owned());
    Problem::new(StatusCode::CONFLICT, why)
}

/// The program of a job that has one already. The error says why there is none.
fn drawn(studio: &Studio, id: u64) -> Answer<Arc<runs::Drawn>> {
    let run = found(studio, id)?;
    run.drawn().ok_or_else(|| not_done(studio, &run))
}

async fn one(State(studio): Shared, Path(id): Path<u64>) -> Answer<Json<RunState>> {
    let run = found(&studio, id)?;
    Ok(Json(studio.runs.state(&run)))
}

async fn cancel(State(studio): Shared, Path(id): Path<u64>) -> Answer<StatusCode> {
    let run = found(&studio, id)?;
    studio.runs.cancel(&run);
    Ok(StatusCode::NO_CONTENT)
}

/// States of a run as events, until the run is over. An event is sent when the state has changed since the last one.
fn states(studio: Arc<Studio>, run: Arc<Run>) -> impl Stream<Item = Result<Event, Infallible>> {
    let phases = run.phases();
    unfold((studio, run, phases, None, 0_u64), |(studio, run, mut phases, last, n)| async move {
        let is_over = |s: &RunState| s.phase.is_over();
        if last.as_ref().is_some_and(is_over) {
            return None;
        }
        let mut last = last;
        loop {
            // Wait before looking again: in a long stage, steps are counted between any two looks.
            if last.is_some() {
                tokio::select! {
                    _ = phases.changed() => {}
                    () = tokio::time::sleep(EVENT_INTERVAL) => {}
                }
            }
            let state = studio.runs.state(&run);
            // If only the time has changed, one event a second is enough: the page counts the time itself.
            let news = |old: &RunState| {
                let still = RunState { elapsed_s: old.elapsed_s, ..state.clone() } == *old;
                !still || state.elapsed_s - old.elapsed_s >= 1.0
            };
            if last.as_ref().is_none_or(news) {
                last = Some(state.clone());
                let event = Event::default().id((n + 1).to_string()).json_data(&state);
                // The state holds only numbers and texts, so turning it into JSON cannot fail.
                let event = event.unwrap_or_default();
                return Some((Ok(event), (studio, run, phases, last, n + 1)));
            }
        }
    })
}

async fn events(State(studio): Shared, Path(id): Path<u64>) -> Answer<Response> {
    let run = found(&studio, id)?;
    let Ok(permit) = Arc::clone(&studio.streams).try_acquire_owned() else {
        return Err(Problem::new(StatusCode::TOO_MANY_REQUESTS, "too many event streams; close a page"));
    };
    let stream = futures_util::StreamExt::map(states(studio, run), move |event| {
        // The permit lives as long as the stream.
        let _held = &permit;
        event
    });
    Ok(Sse::new(stream).keep_alive(KeepAlive::default()).into_response())
}

async fn result(State(studio): Shared, Path(id): Path<u64>) -> Answer<Json<serde_json::Value>> {
    let result = done(&studio, id)?;
    let finished = &result.finished;
    let outputs: Vec<_> = (finished.outputs.iter())
        .map(|o| json!({ "kind": o.kind, "path": o.path.display().to_string() }))
        .collect();
    Ok(Json(json!({
        "ok": true, "report": finished.report, "warnings": finished.warnings, "outputs": outputs,
        "angles": finished.angles.is_some(), "reserve": finished.reserve.is_some(),
        "cases": finished.stress.as_ref().map(|s| s.cases.iter().map(|c| c.name.as_str()).collect::<Vec<_>>()),
        "damage": finished.damage.as_ref().map(|d| json!({ "cell_mm": d.cell_mm, "angle_rad": d.angle_rad, "cells": d.cells.len(), "states": d.states })),
    })))
}

async fn layer_index(State(studio): Shared, Path(id): Path<u64>) -> Answer<Response> {
    let drawn = drawn(&studio, id)?;
    Ok(Json(drawn.records.index()).into_response())
}

/// The layers `a-b` of `n`, counted from 0, both included.
fn layer_range(range: &str, n: usize) -> Answer<std::ops::RangeInclusive<usize>> {
    let wrong = || {
        let wanted =
            format!("layers are \"FIRST-LAST\" with numbers below {n}, at most {MOST_LAYERS} at a time");
        Problem::new(StatusCode::BAD_REQUEST, wanted)
    };
    let parsed = range.split_once('-').and_then(|(a, b)| Some((a.parse().ok()?, b.parse().ok()?)));
    let (first, last): (usize, usize) = parsed.ok_or_else(wrong)?;
    if first > last || last >= n || last - first >= MOST_LAYERS {
        return Err(wrong());
    }
    Ok(first..=last)
}

/// Records of the layers `a-b`, counted from 0, both included, one layer after the other in the order of the index.
async fn layer_records(
    State(studio): Shared,
    Path((id, range)): Path<(u64, String)>,
    headers: HeaderMap,
) -> Answer<Response> {
    let drawn = drawn(&studio, id)?;
    let range = layer_range(&range, drawn.program.layers.len())?;
    let layers =
        move || Ok(drawn.program.layers[range].iter().flat_map(|l| drawn.records.layer(l)).collect());
    made(&headers, layers).await
}

/// The angle to the load of the same records, a byte each.
async fn layer_angles(
    State(studio): Shared,
    Path((id, range)): Path<(u64, String)>,
    headers: HeaderMap,
) -> Answer<Response> {
    bytes_of_beads(
        &studio,
        (id, &range),
        &headers,
        |f| f.angles.as_deref(),
        "the paths of this job follow no guide",
    )
    .await
}

/// The reserve of the same records, a byte each.
async fn layer_reserve(
    State(studio): Shared,
    Path((id, range)): Path<(u64, String)>,
    headers: HeaderMap,
) -> Answer<Response> {
    bytes_of_beads(
        &studio,
        (id, &range),
        &headers,
        |f| f.reserve.as_deref(),
        "this job tells no reserve of its beads",
    )
    .await
}

/// A byte for each record of layers `a-b`, from those of the beads; 404 with the reason `why_not` where a job has none.
async fn bytes_of_beads(
    studio: &Studio,
    (id, range): (u64, &str),
    headers: &HeaderMap,
    of_beads: fn(&Finished) -> Option<&[Vec<u8>]>,
    why_not: &'static str,
) -> Answer<Response> {
    let result = done(studio, id)?;
    let range = layer_range(range, result.finished.program.layers.len())?;
    made(headers, move || {
        let none = || Problem::new(StatusCode::NOT_FOUND, why_not);
        let of_beads = of_beads(&result.finished).ok_or_else(none)?;
        let layers = range
            .map(|k| (&result.finished.program.layers[k], of_beads.get(k).map_or(&[][..], Vec::as_slice)));
        Ok(layers.flat_map(|(layer, of_beads)| Records::of_beads(layer, of_beads)).collect())
    })
    .await
}

/// A picture that the engine draws on a blocking thread.
async fn pictured(draw: impl FnOnce() -> Result<Vec<u8>, Problem> + Send + 'static) -> Answer<Response> {
    let png = tokio::task::spawn_blocking(draw).await.map_err(fault)??;
    Ok(([(header::CONTENT_TYPE, "image/png"), (header::CACHE_CONTROL, "no-cache")], png).into_response())
}

async fn part_picture(State(studio): Shared, Path(id): Path<u64>) -> Answer<Response> {
    let run = found(&studio, id)?;
    let engine = Arc::clone(&studio.engine);
    // A plan that still runs has a program before it has a result.
    if let Some(drawn) = run.drawn().filter(|drawn| !drawn.program.layers.is_empty()) {
        return pictured(move || Ok(engine.picture(Pictured::Part(&drawn.program)))).await;
    }
    let result = done(&studio, id)?;
    pictured(move || {
        let none = || Problem::new(StatusCode::NOT_FOUND, "this job shows no part");
        let surface = result.finished.surface.as_ref().ok_or_else(none)?;
        Ok(engine.picture(Pictured::Shape(surface)))
    })
    .await
}

async fn layer_picture(State(studio): Shared, Path((id, range)): Path<(u64, String)>) -> Answer<Response> {
    let drawn = drawn(&studio, id)?;
    let engine = Arc::clone(&studio.engine);
    let range = layer_range(&range, drawn.program.layers.len())?;
    pictured(move || Ok(engine.picture(Pictured::Layer(&drawn.program, *range.end())))).await
}

async fn case_picture(State(studio): Shared, Path((id, number)): CasePath) -> Answer<Response> {
    let result = done(&studio, id)?;
    let engine = Arc::clone(&studio.engine);
    pictured(move || {
        let (stress, case) = case_of(&result.finished, number)?;
        Ok(engine.picture(Pictured::Stress(stress, case)))
    })
    .await
}

/// Broken elements: x, y, z in mm, the share of stiffness lost and the state in which it broke, as 32-bit floats.
async fn damage(State(studio): Shared, Path(id): Path<u64>) -> Answer<Response> {
    let result = done(&studio, id)?;
    let none = || Problem::new(StatusCode::NOT_FOUND, "this job tested no strength");
    let damage = result.finished.damage.as_ref().ok_or_else(none)?;
    let bytes = damage.cells.iter().flat_map(|(at, lost, state)| [at[0], at[1], at[2], *lost, *state as f32]);
    Ok(binary(bytes.flat_map(f32::to_le_bytes).collect(), false))
}

/// An answer of bytes that are made from a result on a blocking thread, since this may take long.
async fn made(
    headers: &HeaderMap,
    make: impl FnOnce() -> Result<Vec<u8>, Problem> + Send + 'static,
) -> Answer<Response> {
    let is_packed = accepts_gzip(headers);
    let bytes = tokio::task::spawn_blocking(move || {
        make().map(|bytes| if is_packed { packed(&bytes) } else { bytes })
    });
    Ok(binary(bytes.await.map_err(fault)??, is_packed))
}

async fn surface_bytes(State(studio): Shared, Path(id): Path<u64>, headers: HeaderMap) -> Answer<Response> {
    let result = done(&studio, id)?;
    let none = || Problem::new(StatusCode::NOT_FOUND, "this job shows no shape");
    made(&headers, move || result.finished.surface.as_ref().map(surface_bytes::part).ok_or_else(none)).await
}

async fn part_file(State(studio): Shared, Path(id): Path<u64>) -> Answer<Json<serde_json::Value>> {
    let result = done(&studio, id)?;
    let none = || Problem::new(StatusCode::NOT_FOUND, "this job read no part");
    let file = result.finished.part_file.clone().ok_or_else(none)?;
    let path = file.path().display().to_string();
    let changed = tokio::task::spawn_blocking(move || file.has_changed()).await.map_err(fault)?;
    Ok(Json(json!({ "ok": true, "path": path, "changed": changed })))
}

const NO_STRESS: &str = "this job solved no such load case";

async fn stressed(State(studio): Shared, Path(id): Path<u64>, headers: HeaderMap) -> Answer<Response> {
    let result = done(&studio, id)?;
    let none = || Problem::new(StatusCode::NOT_FOUND, NO_STRESS);
    made(&headers, move || result.finished.stress.as_ref().map(surface_bytes::stressed).ok_or_else(none))
        .await
}

/// An answer of bytes that are made from the values of a load case.
async fn case_bytes(
    studio: &Studio,
    (id, number): (u64, usize),
    headers: &HeaderMap,
    bytes: impl FnOnce(&StressSurface, &CaseValues) -> Vec<u8> + Send + 'static,
) -> Answer<Response> {
    let result = done(studio, id)?;
    made(headers, move || case_of(&result.finished, number).map(|(stress, case)| bytes(stress, case))).await
}

/// A load case that a job solved, counted from 0.
fn case_of(finished: &Finished, number: usize) -> Result<(&StressSurface, &CaseValues), Problem> {
    let stress = finished.stress.as_ref();
    let found = stress.and_then(|stress| Some((stress, stress.cases.get(number)?)));
    found.ok_or_else(|| Problem::new(StatusCode::NOT_FOUND, NO_STRESS))
}

type CasePath = Path<(u64, usize)>;

async fn case(State(studio): Shared, Path(of): CasePath, headers: HeaderMap) -> Answer<Response> {
    case_bytes(&studio, of, &headers, |_, case| surface_bytes::case(case)).await
}

#[derive(Deserialize)]
struct Plane {
    axis: Axis,
    at: f32,
}

#[derive(Clone, Copy, Deserialize)]
#[serde(rename_all = "lowercase")]
enum Axis {
    X,
    Y,
    Z,
}

async fn section_bytes(
    State(studio): Shared,
    Path(of): CasePath,
    query: Result<Query<Plane>, QueryRejection>,
    headers: HeaderMap,
) -> Answer<Response> {
    let Query(Plane { axis, at }) = query?;
    if !at.is_finite() {
        return Err(Refusal::usage(format!("at is {at} and should be a position on the axis, mm")).into());
    }
    let cut = move |stress: &StressSurface, case: &CaseValues| {
        surface_bytes::section(&cut_view::cut(&stress.volume, &case.inside, axis as usize, at))
    };
    case_bytes(&studio, of, &headers, cut).await
}

async fn lines(State(studio): Shared, Path(of): CasePath, headers: HeaderMap) -> Answer<Response> {
    case_bytes(&studio, of, &headers, |_, case| surface_bytes::lines(&case.lines)).await
}

async fn branches(State(studio): Shared, Path(id): Path<u64>, headers: HeaderMap) -> Answer<Response> {
    let result = done(&studio, id)?;
    let none = || Problem::new(StatusCode::NOT_FOUND, "this job grew no supports");
    made(&headers, move || result.finished.branches.as_deref().map(surface_bytes::branches).ok_or_else(none))
        .await
}

async fn history_rows(State(studio): Shared) -> Answer<Json<serde_json::Value>> {
    let roots = Arc::clone(&studio.roots);
    let rows = tokio::task::spawn_blocking(move || history::told(&roots)).await.map_err(fault)?;
    Ok(Json(json!({ "ok": true, "runs": rows })))
}

/// Largest request that keeps a draft, bytes: the changed text and that of the file.
const MAX_DRAFT_BYTES: usize = 2 * MAX_JOB_BYTES as usize;

async fn draft_rows(State(studio): Shared) -> Answer<Json<serde_json::Value>> {
    let roots = Arc::clone(&studio.roots);
    let rows = tokio::task::spawn_blocking(move || drafts::told(&roots)).await.map_err(fault)??;
    Ok(Json(json!({ "ok": true, "drafts": rows })))
}

async fn keep(
    State(studio): Shared,
    draft: Result<Json<drafts::Draft>, JsonRejection>,
) -> Answer<StatusCode> {
    let Json(draft) = draft?;
    tokio::task::spawn_blocking(move || drafts::keep(&studio.roots, draft)).await.map_err(fault)??;
    Ok(StatusCode::NO_CONTENT)
}

/// A file that a job wrote.
async fn output(State(studio): Shared, Path((id, kind)): Path<(u64, String)>) -> Answer<Response> {
    let result = done(&studio, id)?;
    let output = result.finished.outputs.iter().find(|o| o.kind == kind);
    let output = output.ok_or_else(|| Problem::new(StatusCode::NOT_FOUND, "the job wrote no such file"))?;
    let real = studio.roots.readable(&output.path)?;
    let wrong =
        |e: std::io::Error| Problem::from(Refusal::input(format!("{}: {}", real.display(), plain(&e))));
    let file = tokio::fs::File::open(&real).await.map_err(wrong)?;
    let length = file.metadata().await.map_err(wrong)?.len();
    let name = safe_name(&real.file_name().map(|n| n.to_string_lossy().into_owned()).unwrap_or_default());
    // Names beyond ASCII would need another form of the header. If no character is left, the browser uses the address.
    let name: String = name.chars().filter(char::is_ascii).collect();
    let headers = [
        (header::CONTENT_TYPE, "application/octet-stream".to_owned()),
        (header::CONTENT_LENGTH, length.to_string()),
        (header::CONTENT_DISPOSITION, format!("attachment; filename=\"{name}\"")),
    ];
    Ok((headers, streamed(file)).into_response())
}

/// The bytes of a file, read as they are sent.
fn streamed(file: tokio::fs::File) -> Body {
    Body::from_stream(unfold(file, |mut file| async move {
        use tokio::io::AsyncReadExt;
        // Source: chosen; a quarter of a mebibyte a read keeps up with any disk.
        let mut chunk = Vec::with_capacity(1 << 18);
        match file.read_buf(&mut chunk).await {
            Ok(0) => None,
            Ok(_) => Some((Ok(chunk), file)),
            Err(e) => Some((Err(e), file)),
        }
    }))
}

/// A photograph, for the page to show it.
async fn picture(State(studio): Shared, query: Result<Query<PathQuery>, QueryRejection>) -> Answer<Response> {
    let Query(query) = query?;
    let real = studio.roots.readable(FilePath::new(&query.path))?;
    if FileKind::from_path(&real) != FileKind::Photo {
        return Err(Refusal::usage(format!("{}: only photographs are shown", real.display())).into());
    }
    let wrong =
        |e: std::io::Error| Problem::from(Refusal::input(format!("{}: {}", real.display(), plain(&e))));
    // A pipe would be waited for without end, and a folder has no bytes.
    let about = tokio::fs::metadata(&real).await.map_err(wrong)?;
    if !about.is_file() {
        return Err(Refusal::usage(format!("{}: only photographs are shown", real.display())).into());
    }
    let length = about.len();
    let file = tokio::fs::File::open(&real).await.map_err(wrong)?;
    let ending = real.extension().unwrap_or_default().to_string_lossy().to_ascii_lowercase();
    let kind = if ending.starts_with('j') { "jpeg".to_owned() } else { ending };
    let headers =
        [(header::CONTENT_TYPE, format!("image/{kind}")), (header::CONTENT_LENGTH, length.to_string())];
    Ok((headers, streamed(file)).into_response())
}

/// The schema of job files: what `grainpath schema` prints.
async fn schema() -> Json<serde_json::Value> {
    Json(grainpath_job::json_schema())
}

async fn profiles() -> Json<serde_json::Value> {
    let rows = grainpath_job::PROFILES.iter();
    let rows = rows.map(|p| json!({ "kind": p.kind, "name": p.name, "about": p.about(), "toml": p.text }));
    Json(json!({ "ok": true, "profiles": rows.collect::<Vec<_>>() }))
}
