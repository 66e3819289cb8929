//! Messages of a run on its way: warnings, progress, and whether to stop.
//!
//! One `Diagnostics` is shared by all threads of a run. Warnings are sorted before they are read,
//! so they do not depend on the number of threads.

use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{self, RecvTimeoutError};
use std::sync::{Arc, Mutex, OnceLock};
use std::time::{Duration, Instant};

use crate::warning::{Warning, WarningId};

/// A stage of a run, in the order a user sees them.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
#[allow(missing_docs)]
pub enum Stage {
    Read,
    Slice,
    Guide,
    Fill,
    Support,
    Order,
    Write,
    Strength,
}

impl Stage {
    /// Every stage, in order.
    pub const ALL: [Self; 8] = [
        Self::Read,
        Self::Slice,
        Self::Guide,
        Self::Fill,
        Self::Support,
        Self::Order,
        Self::Write,
        Self::Strength,
    ];

    /// The key of the stage in the JSON report's `stages_s`.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Read => "read",
            Self::Slice => "slice",
            Self::Guide => "guide",
            Self::Fill => "fill",
            Self::Support => "support",
            Self::Order => "order",
            Self::Write => "write",
            Self::Strength => "strength",
        }
    }
}

/// Receiver of progress. It is called often and from any thread, so it has to be cheap.
pub trait Progress: Send + Sync {
    /// `stage` begins, with `total` steps (0 when unknown).
    fn begin(&self, stage: Stage, total: usize);
    /// `n` more steps of the current stage are done.
    fn advance(&self, n: usize);
}

/// The run was interrupted by the user.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
#[error("interrupted; nothing was written")]
pub struct Interrupted;

/// Whether a run was asked to stop. Copies share one flag, so that solvers which know no [`Diagnostics`] can hold one.
///
/// ```
/// use grainpath_core::Diagnostics;
///
/// let diagnostics = Diagnostics::default();
/// let flag = diagnostics.cancel_flag();
/// assert!(flag.check().is_ok());
/// diagnostics.stop();
/// assert!(flag.check().is_err());
/// ```
#[derive(Debug, Clone, Default)]
pub struct CancelFlag(Arc<AtomicBool>);

impl CancelFlag {
    /// Err once a stop was asked for. Long loops call this at least ten times a second.
    ///
    /// # Errors
    /// [`Interrupted`] after [`Diagnostics::stop`].
    pub fn check(&self) -> Result<(), Interrupted> {
        if self.0.load(Ordering::Relaxed) { Err(Interrupted) } else { Ok(()) }
    }
}

/// Collects warnings from every thread, passes progress on, holds the cancellation flag, and reads the clock.
///
/// ```
/// use grainpath_core::{Diagnostics, WarningId};
///
/// let diagnostics = Diagnostics::default();
/// diagnostics.warn(WarningId::UnitAssumed, "the drawing states no unit; it is taken for mm");
/// assert_eq!(diagnostics.warnings()[0].id.name(), "unit-assumed");
/// assert!(diagnostics.check().is_ok());
/// diagnostics.stop();
/// assert!(diagnostics.check().is_err(), "long loops end here");
/// ```
pub struct Diagnostics {
    warnings: Mutex<Vec<Warning>>,
    progress: Option<Box<dyn Progress>>,
    cancel: CancelFlag,
    clock_s: fn() -> f64,
}

impl Default for Diagnostics {
    /// Without progress, on the system's clock.
    fn default() -> Self {
        Self {
            warnings: Mutex::default(),
            progress: None,
            cancel: CancelFlag::default(),
            clock_s: system_clock_s,
        }
    }
}

/// Seconds since the first call, of a clock that never goes back.
fn system_clock_s() -> f64 {
    static FIRST: OnceLock<Instant> = OnceLock::new();
    FIRST.get_or_init(Instant::now).elapsed().as_secs_f64()
}

impl Diagnostics {
    /// Reports progress to `progress`.
    pub fn with_progress(progress: Box<dyn Progress>) -> Self {
        Self { progress: Some(progress), ..Self::default() }
    }

    /// Takes the time from `clock_s`: seconds since any moment, never going back. WebAssembly has no clock of its own.
    ///
    /// ```
    /// use grainpath_core::Diagnostics;
    ///
    /// assert_eq!(Diagnostics::default().with_clock(|| 12.5).now_s(), 12.5);
    /// ```
    pub fn with_clock(self, clock_s: fn() -> f64) -> Self {
        Self { clock_s, ..self }
    }

    /// The time in seconds, for differences.
    pub fn now_s(&self) -> f64 {
        (self.clock_s)()
    }

    /// Adds a warning about the whole run. The same warning is kept once.
    pub fn warn(&self, id: WarningId, text: impl Into<String>) {
        self.push(Warning::new(id, text));
    }

    /// Adds a warning with a place or a remedy of its own. The same warning is kept once.
    pub fn push(&self, warning: Warning) {
        // A panic of another thread while it held the lock must not hide the warnings.
        let mut rows = self.warnings.lock().unwrap_or_else(std::sync::PoisonError::into_inner);
        // A linear search: each warning is kept once, so a run has some dozens of them.
        if !rows.contains(&warning) {
            rows.push(warning);
        }
    }

    /// All warnings so far: those about the whole run first, then layer by layer, whatever the
    /// number of threads.
    pub fn warnings(&self) -> Vec<Warning> {
        let mut rows = self.warnings.lock().unwrap_or_else(std::sync::PoisonError::into_inner).clone();
        rows.sort_by(Warning::order);
        rows
    }

    /// Begins a stage of `total` steps.
    pub fn begin(&self, stage: Stage, total: usize) {
        if let Some(p) = &self.progress {
            p.begin(stage, total);
        }
    }

    /// Counts `n` steps of the stage as done.
    pub fn advance(&self, n: usize) {
        if let Some(p) = &self.progress {
            p.advance(n);
        }
    }

    /// Makes the run stop at its next check.
    pub fn stop(&self) {
        // Relaxed is enough: the flag carries no other data, and a layer more or less makes no
        // difference.
        self.cancel.0.store(true, Ordering::Relaxed);
    }

    /// The flag that [`Diagnostics::stop`] sets.
    pub fn cancel_flag(&self) -> CancelFlag {
        self.cancel.clone()
    }

    /// Runs work that cannot look at the flag, such as a parser or a decompressor, in a thread of its own. After a stop
    /// the call returns within 20 ms; the work goes on unseen to its end, and its result is dropped.
    ///
    /// ```
    /// use grainpath_core::Diagnostics;
    ///
    /// let diagnostics = Diagnostics::default();
    /// assert_eq!(diagnostics.leave_at_stop(|| 6 * 7), Ok(42));
    /// diagnostics.stop();
    /// assert!(diagnostics.leave_at_stop(std::thread::park).is_err(), "work without an end is left");
    /// ```
    ///
    /// # Errors
    /// [`Interrupted`] after [`Diagnostics::stop`].
    ///
    /// # Panics
    /// When `work` does.
    pub fn leave_at_stop<T: Send + 'static>(
        &self,
        work: impl FnOnce() -> T + Send + 'static,
    ) -> Result<T, Interrupted> {
        let (give, take) = mpsc::channel();
        let worker = std::thread::spawn(move || drop(give.send(work())));
        loop {
            self.check()?;
            match take.recv_timeout(Duration::from_millis(20)) {
                Ok(result) => return Ok(result),
                Err(RecvTimeoutError::Timeout) => {}
                Err(RecvTimeoutError::Disconnected) => {
                    let panic = worker.join().expect_err("a worker that ends well sends its result");
                    std::panic::resume_unwind(panic);
                }
            }
        }
    }

    /// Fails once the run was asked to stop. Long loops call it once a layer.
    ///
    /// # Errors
    /// [`Interrupted`] after [`Diagnostics::stop`].
    pub fn check(&self) -> Result<(), Interrupted> {
        self.cancel.check()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn warnings_are_sorted_and_kept_once() {
        let d = Diagnostics::default();
        let thin = || Warning::new(WarningId::PathNeck, "a thin place").in_layer(6, 1.4);
        d.push(thin());
        d.warn(WarningId::UnitAssumed, "the unit is taken for mm");
        d.push(thin());
        let ids: Vec<&str> = d.warnings().iter().map(|w| w.id.name()).collect();
        assert_eq!(ids, ["unit-assumed", "path-neck"]);
    }
}
