//! Starts the server, serves the page, and ends the server.

use std::net::{Ipv4Addr, SocketAddr};
use std::sync::Arc;
use std::time::{Duration, Instant};

use tokio::net::TcpListener;

use crate::api::router;
use crate::engine::Engine;
use crate::refusal::{Refusal, plain};
use crate::runs::Phase;
use crate::studio::{Options, Studio};

/// Time that a run has to stop when the server ends. Source: measured for the command line, whose stages stop within 0.26 s
/// in the median. A run that has not stopped ends with the process.
const GRACE: Duration = Duration::from_millis(300);

/// Serves until Ctrl-C or SIGTERM. `ready` is called with the address to open as soon as the server listens.
///
/// # Errors
/// [`Refusal`] where the server cannot be started.
pub fn serve(options: &Options, engine: Arc<dyn Engine>, ready: impl FnOnce(&str)) -> Result<(), Refusal> {
    let studio = Arc::new(Studio::new(options, engine)?);
    let wrong = |e: std::io::Error| Refusal::usage(format!("cannot listen on 127.0.0.1: {}", plain(&e)));
    // Two threads answer requests; the planner has threads of its own.
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
    // The runtime is not waited for, because open streams of events would keep it running.
    runtime.shutdown_background();
    served
}

/// Waits for the first signal that asks the program to end.
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
            // If the handler cannot be installed, Ctrl-C ends the process at once, which is acceptable.
            let _ = tokio::signal::ctrl_c().await;
        })
    }
}
