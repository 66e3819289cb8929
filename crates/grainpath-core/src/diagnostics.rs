//! Messages during a run: warnings, progress, and the request to stop.
//!
//! All threads of a run share one `Diagnostics`. Warnings are sorted before they are read, so their
//! order does not depend on the number of threads.

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

/// Receives the progress of a run. It is called often and from any thread, so it must be fast.
pub trait Progress: Send + Sync {
    /// `stage` begins, with `total` steps (0 when unknown).
    fn begin(&self, stage: Stage, total: usize);
    /// `n` more steps of the current stage are done.
    fn advance(&self, n: usize);
    /// Whether [`Progress::layers`] is to be called.
    fn wants_layers(&self) -> bool {
        false
    }
    /// The first layers of a plan are finished while the others are still to come. Each call has more layers than the last.
    fn layers(&self, early: &EarlyLayers<'_>) {
        let _ = early;
    }
}

/// The first layers of a plan, as the program that prints them alone.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct EarlyLayers<'a> {
    /// G-code. The moves of these layers are those that the program of the whole plan has.
    pub gcode: &'a [u8],
    /// Diameter of the filament, mm.
    pub filament_mm: f64,
    /// Lowest and highest corner of the bed, mm.
    pub bed_mm: [[f64; 2]; 2],
}

/// The run was interrupted by the user.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
#[error("interrupted; nothing was written")]
pub struct Interrupted;

/// The flag that asks a run to stop. Copies share one flag, so that solvers without a [`Diagnostics`] can hold one.
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
    /// Returns an error if a stop was requested. Long loops call this at least ten times a second.
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
    /// Diagnostics that report no progress and use the system's clock.
    fn default() -> Self {
        Self {
            warnings: Mutex::default(),
            progress: None,
            cancel: CancelFlag::default(),
            clock_s: system_clock_s,
        }
    }
}

/// Seconds since the first call, from a monotonic clock.
fn system_clock_s() -> f64 {
    static FIRST: OnceLock<Instant> = OnceLock::new();
    FIRST.get_or_init(Instant::now).elapsed().as_secs_f64()
}

impl Diagnostics {
    /// Reports progress to `progress`.
    pub fn with_progress(progress: Box<dyn Progress>) -> Self {
        Self { progress: Some(progress), ..Self::default() }
    }

    /// Takes the time from `clock_s`, a monotonic clock in seconds with any zero. WebAssembly needs this: it has no clock.
    ///
    /// ```
    /// use grainpath_core::Diagnostics;
    ///
    /// assert_eq!(Diagnostics::default().with_clock(|| 12.5).now_s(), 12.5);
    /// ```
    pub fn with_clock(self, clock_s: fn() -> f64) -> Self {
        Self { clock_s, ..self }
    }

    /// The time in seconds since an arbitrary zero; only differences have a meaning.
    pub fn now_s(&self) -> f64 {
        (self.clock_s)()
    }

    /// Adds a warning about the whole run. Of equal warnings only one is kept.
    pub fn warn(&self, id: WarningId, text: impl Into<String>) {
        self.push(Warning::new(id, text));
    }

    /// Adds a warning that may have its own place or remedy. Of equal warnings only one is kept.
    pub fn push(&self, warning: Warning) {
        // Warnings stay readable even if another thread panicked while it held the lock.
        let mut rows = self.warnings.lock().unwrap_or_else(std::sync::PoisonError::into_inner);
        // A linear search is fast enough: without duplicates, a run has some dozens of warnings.
        if !rows.contains(&warning) {
            rows.push(warning);
        }
    }

    /// All warnings so far: those about the whole run first, then layer by layer. The order is the same
    /// for any number of threads.
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

    /// Whether the first layers of a plan are wanted while the others are still to come.
    pub fn wants_layers(&self) -> bool {
        self.progress.as_ref().is_some_and(|p| p.wants_layers())
    }

    /// Passes on the first layers of a plan.
    pub fn layers(&self, early: &EarlyLayers<'_>) {
        if let Some(p) = &self.progress {
            p.layers(early);
        }
    }

    /// Makes the run stop at its next check.
    pub fn stop(&self) {
        // Relaxed ordering is enough: the flag guards no other data, and the run may stop a layer
        // later.
        self.cancel.0.store(true, Ordering::Relaxed);
    }

    /// The flag that [`Diagnostics::stop`] sets.
    pub fn cancel_flag(&self) -> CancelFlag {
        self.cancel.clone()
    }

    /// Runs work that cannot check the flag, such as a parser or a decompressor, in a separate thread. After a stop the
    /// call returns within 20 ms; the thread then goes on to the end of its work, and the result is dropped.
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
    /// When `work` panics.
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

    /// Returns an error if a stop was requested. Loops over layers call it once per layer.
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
        d.warn(WarningId::GuideFar, "a guide that is missed");
        let ids: Vec<&str> = d.warnings().iter().map(|w| w.id.name()).collect();
        // What was assumed about the input stands before what may follow from it.
        assert_eq!(ids, ["unit-assumed", "guide-far", "path-neck"]);
    }
}
