//! Changes of jobs that were not saved, in `drafts.json` of the working folder.
//!
//! The page sends each change; a closed tab, another browser and a studio on another port find it again. The file is
//! written anew under a temporary name and renamed, so that it is always whole. A lock file keeps the studios of one folder
//! from writing at the same time. Where two pages change one job, the last change stays.

use std::fs::{File, OpenOptions};
use std::path::Path;
use std::time::{SystemTime, UNIX_EPOCH};

use serde::{Deserialize, Serialize};

use crate::file_kind::FileKind;
use crate::refusal::{Refusal, plain};
use crate::roots::{DRAFTS, DRAFTS_LOCK, Roots, write_whole};

/// The greatest number of drafts that are kept, the newest ones. Source: chosen; a page lists no more.
const MOST: usize = 20;
/// The greatest number of bytes of all their texts. Source: chosen; jobs have some kilobytes.
const MOST_BYTES: usize = 32 << 20;

/// The changed text of a file.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct Draft {
    pub path: String,
    pub kind: FileKind,
    /// The changed text.
    pub text: String,
    /// The text of the file that was changed.
    pub from: String,
    /// The page that sends it, and the number of the change among those of the page: requests of a page that is left may
    /// overtake each other. A change without a page takes the place of any other.
    #[serde(default)]
    pub page: String,
    /// Counts from 0.
    #[serde(default)]
    pub change: u64,
    /// When it was changed last, seconds since 1970; set by the server.
    #[serde(default, rename = "at_s")]
    pub saved_at: u64,
}

fn wrong(path: &Path, what: &str) -> Refusal {
    Refusal::usage(format!("changes that are not saved are kept in {}: {what}", path.display()))
}

/// Waits until no other thread or studio writes the drafts. The lock ends with the file.
fn lock(roots: &Roots) -> Result<File, Refusal> {
    let path = roots.writable(&roots.work().join(DRAFTS_LOCK))?;
    let failed = |e: std::io::Error| wrong(&path, &plain(&e));
    let file = OpenOptions::new().create(true).append(true).open(&path).map_err(failed)?;
    match file.lock() {
        Ok(()) => Ok(file),
        // Some network drives have no locks. One studio in such a folder loses nothing.
        Err(e) if e.kind() == std::io::ErrorKind::Unsupported => Ok(file),
        Err(e) => Err(failed(e)),
    }
}

/// All drafts, the newest first.
pub(crate) fn told(roots: &Roots) -> Result<Vec<Draft>, Refusal> {
    let path = roots.work().join(DRAFTS);
    match std::fs::read(&path) {
        Ok(bytes) => serde_json::from_slice(&bytes)
            .map_err(|e| wrong(&path, &format!("it is no list of drafts ({e}); move it away"))),
        // The file does not exist before the first change.
        Err(e) if e.kind() == std::io::ErrorKind::NotFound => Ok(Vec::new()),
        Err(e) => Err(wrong(&path, &plain(&e))),
    }
}

/// Keeps a draft in place of an earlier one of its file, unless a later one of its page came before it. A text that is that of the file is no change and is forgotten.
pub(crate) fn keep(roots: &Roots, draft: Draft) -> Result<(), Refusal> {
    let _held = lock(roots)?;
    let mut all = told(roots)?;
    // Numbers of different pages cannot be compared; of those the last one to come stays.
    let is_later = |d: &Draft| d.path == draft.path && d.page == draft.page && d.change > draft.change;
    if !draft.page.is_empty() && all.iter().any(is_later) {
        return Ok(());
    }
    all.retain(|d| d.path != draft.path);
    // Undoing all changes brings the text of the file back, which needs no draft.
    if draft.text != draft.from {
        let saved_at = SystemTime::now().duration_since(UNIX_EPOCH).map_or(0, |d| d.as_secs());
        all.insert(0, Draft { saved_at, ..draft });
    }
    let mut bytes = 0;
    let mut is_kept = |d: &Draft| {
        bytes += d.text.len() + d.from.len();
        bytes <= MOST_BYTES
    };
    // The newest ones come first, so the oldest ones go where there are too many.
    let n = all.iter().take(MOST).take_while(|d| is_kept(d)).count();
    all.truncate(n);
    let path = roots.writable(&roots.work().join(DRAFTS))?;
    let failed = |e: std::io::Error| wrong(&path, &plain(&e));
    let bytes = serde_json::to_vec(&all).map_err(|e| failed(e.into()))?;
    write_whole(&path, &bytes)
        .map_err(|e| Refusal::usage(format!("changes that are not saved are not kept: {}", e.message)))
}
