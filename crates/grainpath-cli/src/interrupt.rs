//! Ctrl-C and SIGTERM: the run ends at once, whatever it is doing, and writes nothing more.
//!
//! The signal sets the cancellation flag, which loops check. Code that cannot check it (a factorization, a
//! decompressor) may go on, but after a short grace the thread of the handler ends the process. Files are written
//! under a temporary name and renamed. The rename and the end of the process lock each other out, so that
//! each file exists whole or not at all, and temporary files are removed.
//!
//! Measured: `cargo xtask bench stops` sends signals at random moments of each stage; the times to exit are in
//! docs/commands.md.

use std::io::{self, Write as _};
use std::path::PathBuf;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::time::Duration;

use grainpath_core::Diagnostics;
use tempfile::NamedTempFile;

use crate::{ExitCode, Failure};

/// The time in which a run may end by itself. Source: derived. A run should end 0.2 s after the signal, and the system
/// needs up to 0.1 s of this to free the memory of a large run.
const GRACE: Duration = Duration::from_millis(60);

/// Whether a signal has arrived.
static INTERRUPTED: AtomicBool = AtomicBool::new(false);
/// Whether failures are also printed as JSON.
static JSON: AtomicBool = AtomicBool::new(false);
/// The run that is going on.
static RUNNING: Mutex<Option<Arc<Diagnostics>>> = Mutex::new(None);
/// Temporary files that have not been renamed yet, and the number of files that have.
static OUTPUTS: Mutex<Outputs> = Mutex::new(Outputs { temporary: Vec::new(), n_written: 0 });

struct Outputs {
    temporary: Vec<PathBuf>,
    n_written: usize,
}

fn outputs() -> MutexGuard<'static, Outputs> {
    OUTPUTS.lock().unwrap_or_else(PoisonError::into_inner)
}

/// Sets whether failures are also printed as JSON.
pub(crate) fn set_json(json: bool) {
    JSON.store(json, Ordering::Relaxed);
}

/// Ends the program on Ctrl-C and SIGTERM from now on, also while it waits for a pipe.
pub(crate) fn watch() {
    // The error for a second handler is ignored: the first handler stays.
    let _ = ctrlc::set_handler(|| {
        INTERRUPTED.store(true, Ordering::SeqCst);
        if let Some(run) = running().as_ref() {
            run.stop();
        }
        std::thread::sleep(GRACE);
        end();
    });
}

/// Lets a signal stop this run; it takes the place of an earlier one.
pub(crate) fn stops(run: Arc<Diagnostics>) {
    *running() = Some(run);
    watch();
}

fn running() -> MutexGuard<'static, Option<Arc<Diagnostics>>> {
    RUNNING.lock().unwrap_or_else(PoisonError::into_inner)
}

/// Removes the temporary files of runs that are still going on when the program ends.
#[cfg(feature = "studio")]
pub(crate) fn remove_temporary() {
    INTERRUPTED.store(true, Ordering::SeqCst);
    outputs().temporary.drain(..).for_each(|path| drop(std::fs::remove_file(path)));
}

/// Removes temporary files, prints what was written before the signal, and ends the process.
pub(crate) fn end() -> ! {
    // The lock is held until the process ends, so that no file is renamed any more.
    let outputs = outputs();
    outputs.temporary.iter().for_each(|path| drop(std::fs::remove_file(path)));
    let line = match outputs.n_written {
        0 => "interrupted; nothing was written".to_owned(),
        1 => "interrupted; one file had been written".to_owned(),
        n => format!("interrupted; {n} files had been written"),
    };
    let code = ExitCode::Interrupted.number();
    if JSON.load(Ordering::Relaxed) {
        let report = serde_json::json!({ "ok": false, "error": line, "code": code });
        // An error of standard output is ignored, since the run ends with an error code anyway.
        let _ = writeln!(io::stdout(), "{report}");
    }
    eprintln!("grainpath: {line}");
    std::process::exit(code.into());
}

/// A temporary file that is removed if the run is interrupted.
pub(crate) struct Temporary(PathBuf);

impl Temporary {
    /// Makes a temporary file and registers it for removal. The lock keeps the process from ending between both steps.
    ///
    /// # Errors
    /// The error of `make`.
    pub(crate) fn create(
        make: impl FnOnce() -> io::Result<NamedTempFile>,
    ) -> io::Result<(NamedTempFile, Self)> {
        let mut outputs = outputs();
        let file = make()?;
        outputs.temporary.push(file.path().to_owned());
        drop(outputs);
        let watched = Self(file.path().to_owned());
        Ok((file, watched))
    }

    /// Calls `rename`, which gives the file its final name, unless the run was interrupted.
    ///
    /// # Errors
    /// The error of `rename`, or [`ExitCode::Interrupted`] after an interruption.
    pub(crate) fn finish<T>(self, rename: impl FnOnce() -> Result<T, Failure>) -> Result<T, Failure> {
        let mut outputs = outputs();
        if INTERRUPTED.load(Ordering::SeqCst) {
            return Err(Failure { code: ExitCode::Interrupted, ..Failure::usage("interrupted") });
        }
        let result = rename()?;
        outputs.n_written += 1;
        drop(outputs);
        Ok(result)
    }
}

impl Drop for Temporary {
    fn drop(&mut self) {
        outputs().temporary.retain(|path| *path != self.0);
    }
}
