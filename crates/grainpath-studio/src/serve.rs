//! The server from its start to its end.

use std::net::{Ipv4Addr, SocketAddr};
use std::path::PathBuf;
use std::sync::Arc;
use std::time::{Duration, Instant};

use tokio::net::TcpListener;
use tokio::sync::Semaphore;

use crate::access::Access;
use crate::engine::{Engine, Refusal};
use crate::roots::{Roots, plain};
use crate::runs::{Phase, Runs};
use crate::{MOST_STREAMS, Studio, router};

/// How a studio is started.
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

/// Time that a run gets to stop at the end. Source: measured for the command line, whose stages stop within 0.26 s in the
/// median; the system takes back the memory of what is left.
const GRACE: Duration = Duration::from_millis(300);

impl Studio {
    /// A studio with its checks and an empty queue.
    ///
    /// # Errors
    /// [`Refusal`] for folders and files that are not there.
    pub fn new(options: &Options, engine: Arc<dyn Engine>) -> Result<Self, Refusal> {
        let base = options.base.trim_end_matches('/');
        let is_plain = |c: char| c.is_ascii_alphanumeric() || "/-_.~".contains(c);
        let is_path = base.is_empty() || base.starts_with('/');
        if !is_path || !base.chars().all(is_plain) {
            let given = &options.base;
            return Err(Refusal::usage(format!("--base {given:?} should be a path like /grainpath")));
        }
        let mut folders = options.roots.clone();
        let opened = match &options.file {
            None => None,
            Some(file) => {
                let wrong = |e: std::io::Error| Refusal::input(format!("{}: {}", file.display(), plain(&e)));
                let real = std::fs::canonicalize(file).map_err(wrong)?;
                // Textures, profiles and results lie beside the file that names them.
                folders.extend(real.parent().map(ToOwned::to_owned));
                Some(real)
            }
        };
        let random = |e: getrandom::Error| Refusal::usage(format!("the system gives no random bytes: {e}"));
        Ok(Self {
            access: Access::new(&options.hosts).map_err(random)?,
            roots: Arc::new(Roots::new(&options.work, &folders)?),
            runs: Runs::new(),
            engine,
            max_upload: options.max_upload,
            opened,
            base: base.to_owned(),
            streams: Arc::new(Semaphore::new(MOST_STREAMS)),
        })
    }
}

/// Serves until Ctrl-C or SIGTERM. `ready` is called with the address to open, once it answers.
///
/// # Errors
/// [`Refusal`] where the server cannot be started.
pub fn serve(options: &Options, engine: Arc<dyn Engine>, ready: impl FnOnce(&str)) -> Result<(), Refusal> {
    let studio = Arc::new(Studio::new(options, engine)?);
    let wrong = |e: std::io::Error| Refusal::usage(format!("cannot listen on 127.0.0.1: {}", plain(&e)));
    // Two threads answer; the planner has its own.
    let runtime =
        tokio::runtime::Builder::new_multi_thread().worker_threads(2).enable_all().build().map_err(wrong)?;
    let served = runtime.block_on(async {
        let listener = TcpListener::bind(SocketAddr::from((Ipv4Addr::LOCALHOST, 0))).await.map_err(wrong)?;
        let port = listener.local_addr().map_err(wrong)?.port();
        let (base, token) = (&studio.base, studio.access.token());
        let mut end = std::pin::pin!(end()?);
        ready(&format!("http://127.0.0.1:{port}{base}/?token={token}"));
        let server = axum::serve(listener, router(Arc::clone(&studio)));
        tokio::select! {
            served = server => served.map_err(wrong),
            () = &mut end => Ok(()),
        }
    });
    studio.runs.close();
    let until = Instant::now() + GRACE;
    let is_busy = || studio.runs.all().iter().any(|r| studio.runs.state(r).phase == Phase::Running);
    while is_busy() && Instant::now() < until {
        // Source: chosen; far below the grace.
        std::thread::sleep(Duration::from_millis(5));
    }
    // Open streams of events would keep the runtime waiting.
    runtime.shutdown_background();
    served
}

/// Ends with the first signal that asks the program to end.
fn end() -> Result<impl Future<Output = ()>, Refusal> {
    let wrong = |e: std::io::Error| Refusal::usage(format!("cannot watch for Ctrl-C: {}", plain(&e)));
    #[cfg(unix)]
    {
        use tokio::signal::unix::{SignalKind, signal};
        let mut interrupt = signal(SignalKind::interrupt()).map_err(wrong)?;
        let mut terminate = signal(SignalKind::terminate()).map_err(wrong)?;
        Ok(async move {
            tokio::select! {
                _ = interrupt.recv() => {}
                _ = terminate.recv() => {}
            }
        })
    }
    #[cfg(not(unix))]
    {
        let _ = wrong;
        Ok(async {
            // Without a handler Ctrl-C ends the process at once, which is also an end.
            let _ = tokio::signal::ctrl_c().await;
        })
    }
}
