//! The state of a running studio, shared by all requests.

use std::path::PathBuf;
use std::sync::Arc;

use tokio::sync::Semaphore;

use crate::access::Access;
use crate::engine::Engine;
use crate::refusal::{Refusal, plain};
use crate::roots::Roots;
use crate::runs::Runs;

/// The greatest number of open event streams. Source: chosen; a page holds one, and a browser six connections to a host.
const MOST_STREAMS: usize = 32;

/// Options with which a studio is started.
#[derive(Debug, Clone, Default)]
pub struct Options {
    /// The folder that is written to; it is made if it is missing.
    pub work: PathBuf,
    /// Folders that may be read.
    pub roots: Vec<PathBuf>,
    /// The file that the page opens first.
    pub file: Option<PathBuf>,
    /// Host names that are allowed besides those of this computer.
    pub hosts: Vec<String>,
    /// Path before every address, as `/grainpath`; empty for none.
    pub base: String,
    /// Largest upload, bytes.
    pub max_upload: u64,
}

/// The state that all requests share.
pub struct Studio {
    /// The token and the hosts that requests must name.
    pub access: Access,
    /// Which files may be read and written.
    pub roots: Arc<Roots>,
    /// The queue of runs.
    pub runs: Runs,
    /// The planner and the tests that runs call.
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

impl Studio {
    /// A studio with its checks and an empty queue.
    ///
    /// # Errors
    /// [`Refusal`] for folders and files that are not there.
    pub fn new(options: &Options, engine: Arc<dyn Engine>) -> Result<Self, Refusal> {
        let base = options.base.trim_end_matches('/');
        let is_plain = |c: char| c.is_ascii_alphanumeric() || "/-_.~".contains(c);
        // An empty part would send the browser to another host ("//host"), and browsers take "." and ".." out of an address.
        let is_part = |part: &str| part.chars().any(|c| c != '.');
        let is_path =
            base.is_empty() || base.strip_prefix('/').is_some_and(|rest| rest.split('/').all(is_part));
        if !is_path || !base.chars().all(is_plain) {
            let given = &options.base;
            return Err(Refusal::usage(format!("--base {given:?} should be a path like /grainpath")));
        }
        // A browser's Host is compared without its port.
        let is_host = |host: &str| {
            !host.is_empty() && !host.contains('/') && (host.ends_with(']') || !host.contains(':'))
        };
        if let Some(host) = options.hosts.iter().find(|host| !is_host(host)) {
            return Err(Refusal::usage(format!(
                "--allow-host {host:?} should be a name alone, without http:// and without a port"
            )));
        }
        let mut folders = options.roots.clone();
        let opened = match &options.file {
            None => None,
            Some(file) => {
                let wrong = |e: std::io::Error| Refusal::input(format!("{}: {}", file.display(), plain(&e)));
                let real = std::fs::canonicalize(file).map_err(wrong)?;
                // A file may name textures, profiles and results beside it, so its folder may be read.
                folders.extend(real.parent().map(ToOwned::to_owned));
                Some(real)
            }
        };
        let random = |e: getrandom::Error| Refusal::usage(format!("the system gives no random bytes: {e}"));
        let own = Arc::clone(&engine);
        let exit_code = Box::new(move |kind| own.exit_code(kind));
        Ok(Self {
            access: Access::new(&options.hosts).map_err(random)?,
            roots: Arc::new(Roots::new(&options.work, &folders)?),
            runs: Runs::new(exit_code),
            engine,
            max_upload: options.max_upload,
            opened,
            base: base.to_owned(),
            streams: Arc::new(Semaphore::new(MOST_STREAMS)),
        })
    }
}
