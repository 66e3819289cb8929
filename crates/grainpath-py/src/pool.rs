//! The threads that plans are computed on.
//!
//! The pool belongs to the process that made it: a child made by `fork`, as `multiprocessing` does on Linux, has the
//! pool's memory without its threads, and would wait for ever. A pool of another process is therefore never used.

use std::process;
use std::sync::{Arc, Mutex, PoisonError};

use grainpath_cli::Failure;
use rayon::{ThreadPool, ThreadPoolBuilder};

/// Stack of a thread. Source: the stack of a main thread on Linux, on which the command line plans.
const STACK_BYTES: usize = 8 << 20;
/// The greatest number of threads that is accepted; a larger one is an error. Source: the limit of the command line.
const MAX_THREADS: usize = 1024;

/// The pool for plans that set no number of threads, with the id of the process that made it.
static SHARED: Mutex<Option<(u32, Arc<ThreadPool>)>> = Mutex::new(None);

/// A new pool of `threads` threads, or the shared pool, which has a thread for each core.
///
/// # Errors
/// For a number out of range, and where the system gives no threads.
pub(crate) fn threads(threads: Option<usize>) -> Result<Arc<ThreadPool>, Failure> {
    if let Some(n) = threads {
        if n == 0 || n > MAX_THREADS {
            return Err(Failure::usage(format!("threads = {n} should be from 1 to {MAX_THREADS}")));
        }
        return made(n).map(Arc::new);
    }
    let mut shared = SHARED.lock().unwrap_or_else(PoisonError::into_inner);
    match &*shared {
        Some((process, pool)) if *process == process::id() => Ok(Arc::clone(pool)),
        Some(_) | None => {
            let pool = Arc::new(made(0)?);
            // Dropping the parent's pool would wait for its threads, which do not exist in this process.
            if let Some((_, of_parent)) = shared.replace((process::id(), Arc::clone(&pool))) {
                std::mem::forget(of_parent);
            }
            Ok(pool)
        }
    }
}

/// A pool of `n` threads; 0 means one for each core.
fn made(n: usize) -> Result<ThreadPool, Failure> {
    let pool = ThreadPoolBuilder::new().num_threads(n).stack_size(STACK_BYTES).build();
    pool.map_err(|e| Failure::usage(format!("threads: {e}")))
}
