//! The studio: a local server, and the page it gives to the user's browser.
//!
//! The server listens on 127.0.0.1 alone. Every request carries the token of this start and names a host that is
//! allowed ([`access`]); files are read below the folders that were given and written below one working folder
//! ([`roots`]). Runs (reading a program, planning a job, testing strength) wait in a queue and are done one at a time on a
//! thread of their own ([`runs`]); what they compute is up to an [`Engine`], which the command line implements with the
//! code of its own commands. Toolpaths cross the wire as eight bytes a segment, layer by layer ([`records`]).
//!
//! Cost: a program of n beads takes 32 n bytes in the server. Limits: HTTP/1.1 without encryption; one user; runs are
//! kept until the program ends or are dropped by the page.

pub mod access;
mod api;
mod assets;
mod engine;
mod openapi;
pub mod records;
pub mod roots;
pub mod runs;
mod serve;
mod uploads;

pub use api::{description, router};
pub use assets::LICENCES_OF_PAGE;
pub use engine::{Damage, Engine, Finished, JobText, Output, Refusal};
pub use serve::{Options, serve};

use std::path::PathBuf;
use std::sync::Arc;

use access::Access;
use roots::Roots;
use runs::Runs;
use tokio::sync::Semaphore;

/// Most streams of events at a time. Source: chosen; a page holds one, and a browser six connections to a host.
const MOST_STREAMS: usize = 32;

/// All that requests share.
pub struct Studio {
    /// Who may ask.
    pub access: Access,
    /// Which files may be read and written.
    pub roots: Arc<Roots>,
    /// The queue.
    pub runs: Runs,
    /// What does the work of runs.
    pub engine: Arc<dyn Engine>,
    /// Largest upload, bytes.
    pub max_upload: u64,
    /// The file that the page opens first.
    pub opened: Option<PathBuf>,
    /// Path before every address, without a slash at its end; empty for none.
    pub base: String,
    /// One permit for each stream of events.
    pub streams: Arc<Semaphore>,
}
