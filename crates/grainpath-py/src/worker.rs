//! Runs long work on a thread of its own, which the caller's thread watches.
//!
//! The work holds no lock of the interpreter. Meanwhile the caller's thread waits in short steps; in each it looks for
//! Ctrl-C, asks the caller's cancel token, reports progress, and reads the slices that the work asks for. An exception
//! of any of these ends the work and comes back as it was raised. It looks once before the work begins and once after its
//! end as well, so that work of less than a step is not done against a token that is set, nor without any progress.
//!
//! Work is stopped by a flag, which it reads often. Code that reads the flag late (a factorization) is waited for at most
//! [`GRACE`]; then the exception is raised, and the thread ends when it next reads the flag. In this case the command line
//! ends the process, which a module may not do.

use std::cell::Cell;
use std::num::NonZeroUsize;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::Arc;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::mpsc::{self, Receiver, RecvTimeoutError, Sender};
use std::thread;
use std::time::{Duration, Instant};

use grainpath_cli::Failure;
use grainpath_core::Diagnostics;
use grainpath_core::diagnostics::{Progress, Stage};
use pyo3::prelude::*;

use crate::errors::{self, Kind};
use crate::pool;

/// Time between two checks of signals and tokens. Source: derived: Ctrl-C must raise within 0.3 s, and [`GRACE`] takes half
/// of that; a hundred checks a second would make short plans noticeably slower.
const STEP: Duration = Duration::from_millis(25);
/// Time that the caller waits for stopped work to end by itself. Source: derived: as [`STEP`].
const GRACE: Duration = Duration::from_millis(150);

thread_local! {
    /// Whether this thread waits for work already.
    static WAITS: Cell<bool> = const { Cell::new(false) };
}

/// The time for which a thread waits for work. It keeps whether the thread waited before.
struct Waiting(bool);

impl Waiting {
    fn begin() -> Self {
        Self(WAITS.replace(true))
    }
}

impl Drop for Waiting {
    fn drop(&mut self) {
        WAITS.set(self.0);
    }
}

/// A message from the work to the caller's thread.
pub(crate) enum Request {
    /// Slices of the caller's array: the first, and how many. No answer means that reading failed.
    Slices(usize, usize, Sender<Vec<f32>>),
    /// The work has ended.
    Done,
}

/// The Python objects and the number of threads that the caller passed.
#[derive(Default)]
pub(crate) struct Caller<'py> {
    /// Called as `progress(stage, done, total)`.
    pub progress: Option<Bound<'py, PyAny>>,
    /// An object with `is_set()`, such as `threading.Event`.
    pub cancel: Option<Bound<'py, PyAny>>,
    /// Gives slices: `array(first, count)` is an array of float32.
    pub array: Option<Bound<'py, PyAny>>,
    /// Number of threads.
    pub threads: Option<usize>,
}

/// Counts the progress of the work.
#[derive(Default)]
struct Counter {
    /// Index in [`Stage::ALL`] plus one; 0 before the first stage.
    stage: AtomicUsize,
    done: AtomicUsize,
    total: AtomicUsize,
}

/// The counter as a receiver of progress.
struct Counting(Arc<Counter>);

impl Progress for Counting {
    fn begin(&self, stage: Stage, total: usize) {
        // The numbers are only shown to people, so it does no harm to read the new stage with the old total.
        self.0.done.store(0, Ordering::Relaxed);
        self.0.total.store(total, Ordering::Relaxed);
        let index = Stage::ALL.iter().position(|s| *s == stage).unwrap_or_default();
        self.0.stage.store(index + 1, Ordering::Relaxed);
    }

    fn advance(&self, n: usize) {
        self.0.done.fetch_add(n, Ordering::Relaxed);
    }
}

/// Runs `work` and waits for it.
///
/// # Errors
/// The error of the work, `KeyboardInterrupt`, `Cancelled`, an exception of the caller's functions, and `InternalError` for
/// a panic.
pub(crate) fn run<T, W>(py: Python<'_>, caller: &Caller<'_>, work: W) -> PyResult<T>
where
    T: Send + 'static,
    W: FnOnce(&Arc<Diagnostics>, Sender<Request>) -> Result<T, Failure> + Send + 'static,
{
    let waiting = Waiting::begin();
    // A function of the caller's may plan in turn. The work that asked it holds a thread of the shared pool until it has
    // the answer, and with the only one the two would wait for each other.
    let own = || waiting.0.then(|| thread::available_parallelism().map_or(1, NonZeroUsize::get));
    let pool = pool::threads(caller.threads.or_else(own)).map_err(|f| errors::of_failure(py, &f))?;
    let counter = Arc::new(Counter::default());
    let diagnostics = Arc::new(Diagnostics::with_progress(Box::new(Counting(Arc::clone(&counter)))));
    let (requests, receiver) = mpsc::channel();
    let (shared, done) = (Arc::clone(&diagnostics), requests.clone());
    let mut watch = Watch { caller, counter: &counter, shown: (0, 0, 0) };
    watch.look(py)?;
    let thread = thread::Builder::new().name("grainpath".to_owned()).spawn(move || {
        let result = catch_unwind(AssertUnwindSafe(|| pool.install(|| work(&shared, requests))));
        // Sending fails if the caller has left after an interruption; nobody needs the message then.
        let _ = done.send(Request::Done);
        result
    })?;
    let receiver = match watch.until_done(py, receiver) {
        Ok(receiver) => receiver,
        Err((error, receiver)) => {
            diagnostics.stop();
            py.detach(move || leave(&receiver));
            return Err(error);
        }
    };
    drop(receiver);
    match py.detach(move || thread.join()) {
        Ok(Ok(result)) => result.map_err(|f| errors::of_failure(py, &f)),
        Ok(Err(panic)) | Err(panic) => Err(errors::of_panic(py, &*panic)),
    }
}

/// Waits for stopped work to end, at most [`GRACE`]. Requests get no answer, which ends the reading of slices.
fn leave(receiver: &Receiver<Request>) {
    let end = Instant::now() + GRACE;
    while let Some(left) = end.checked_duration_since(Instant::now()) {
        match receiver.recv_timeout(left) {
            Ok(Request::Slices(..)) => {}
            Ok(Request::Done) | Err(_) => return,
        }
    }
}

/// The caller's thread while it waits for the work.
struct Watch<'a, 'py> {
    caller: &'a Caller<'py>,
    counter: &'a Counter,
    /// Stage, done and total that were reported last.
    shown: (usize, usize, usize),
}

impl Watch<'_, '_> {
    /// Serves the requests of the work until it ends. An exception is returned together with the channel.
    fn until_done(
        &mut self,
        py: Python<'_>,
        mut receiver: Receiver<Request>,
    ) -> Result<Receiver<Request>, (PyErr, Receiver<Request>)> {
        loop {
            let (received, back) = py.detach(move || (receiver.recv_timeout(STEP), receiver));
            receiver = back;
            let ended = matches!(received, Ok(Request::Done) | Err(RecvTimeoutError::Disconnected));
            let outcome = match received {
                Ok(Request::Slices(first, count, answer)) => self.slices(first, count, &answer),
                Ok(Request::Done) | Err(_) => Ok(()),
            };
            if let Err(error) = outcome.and_then(|()| self.look(py)) {
                return Err((error, receiver));
            }
            if ended {
                return Ok(receiver);
            }
        }
    }

    /// Reads slices of the caller's array.
    fn slices(&self, first: usize, count: usize, answer: &Sender<Vec<f32>>) -> PyResult<()> {
        let Some(array) = &self.caller.array else { return Ok(()) };
        let read = array.call1((first, count))?;
        let read: numpy::PyReadonlyArray1<'_, f32> = read.extract()?;
        // The work may have been stopped meanwhile.
        let _ = answer.send(read.as_slice()?.to_vec());
        Ok(())
    }

    /// Looks at signals and the token, and reports progress.
    fn look(&mut self, py: Python<'_>) -> PyResult<()> {
        py.check_signals()?;
        if let Some(cancel) = &self.caller.cancel
            && cancel.call_method0("is_set")?.is_truthy()?
        {
            return Err(errors::exception(py, Kind::Cancelled, "cancelled; nothing was written", None, None));
        }
        let Some(progress) = &self.caller.progress else { return Ok(()) };
        let read = |n: &AtomicUsize| n.load(Ordering::Relaxed);
        let now = (read(&self.counter.stage), read(&self.counter.done), read(&self.counter.total));
        if now.0 > 0 && now != self.shown {
            self.shown = now;
            progress.call1((Stage::ALL[now.0 - 1].name(), now.1, now.2))?;
        }
        Ok(())
    }
}
