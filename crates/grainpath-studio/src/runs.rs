//! The queue of runs: one run is worked on, the others wait.
//!
//! Runs have a thread of their own, so that the server can answer meanwhile. The planner uses all cores by itself, so two
//! long runs at a time would only be slower. What a page waits for as it opens a file, a program or a shape, has a second
//! thread, so that it does not wait for a strength test of minutes. Progress is counted in atomics, since the planner counts often and from any thread.
//! Streams of events read them ten times a second, so that the number of events does not depend on how often the planner
//! counts. Cancelling sets a flag that every loop of the planner reads.

use std::collections::VecDeque;
use std::sync::atomic::{AtomicU64, AtomicUsize, Ordering};
use std::sync::{Arc, Condvar, Mutex, MutexGuard, PoisonError};
use std::time::Instant;

use grainpath_core::Diagnostics;
use grainpath_core::diagnostics::{EarlyLayers, Progress, Stage};
use grainpath_gcode::{Limits, Program, simulate};
use serde::Serialize;
use tokio::sync::watch;

use crate::engine::Finished;
use crate::records::{Frame, Records};
use crate::refusal::{Refusal, RefusalKind};

/// The greatest number of waiting runs. Source: chosen; a page that asks for more has a fault.
const MOST_WAITING: usize = 64;
/// If there are more runs than this, the oldest finished ones are dropped; a finished run holds its program.
/// Source: chosen; 32 programs of 30 MB are 1 GB.
pub(crate) const MOST_KEPT: usize = 32;
/// The greatest number of finished runs that are kept of each kind that shows a surface (shape, stress, supports). Each
/// change of a job makes a new one, and the page shows only the last.
/// Source: chosen; four of a million triangles are 100 MB.
pub(crate) const MOST_SURFACES: usize = 4;

/// The progress of a run from the queue to its end.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Phase {
    /// In the queue.
    Waiting,
    /// Being worked on.
    Running,
    /// Done; the result is there.
    Done,
    /// Ended with an error.
    Failed,
    /// Ended by the user.
    Cancelled,
}

impl Phase {
    /// Whether the run has ended.
    pub fn is_over(self) -> bool {
        matches!(self, Self::Done | Self::Failed | Self::Cancelled)
    }
}

/// What a run does.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Kind {
    /// Reads a program.
    View,
    /// Shows the shape of a job.
    Shape,
    /// Solves the loads of a job.
    Stress,
    /// Ranks the poses of a job's part.
    Orient,
    /// Grows the supports of a job.
    Supports,
    /// Plans a job.
    Plan,
    /// Tests strength.
    Strength,
}

impl Kind {
    /// Whether a page shows nothing before it is done: such runs wait only for each other.
    fn opens(self) -> bool {
        matches!(self, Self::View | Self::Shape)
    }
}

/// The state of a run as the page sees it.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct State {
    /// Its number.
    pub id: u64,
    /// What it does.
    pub kind: Kind,
    /// The name of the job or file that it works on.
    pub title: String,
    /// Its phase.
    pub phase: Phase,
    /// Runs before it in the queue.
    pub ahead: usize,
    /// The stage that the planner is in.
    pub stage: Option<&'static str>,
    /// Steps of this stage that are done.
    pub done: usize,
    /// All steps of this stage; 0 if their number is not known.
    pub total: usize,
    /// Whether its layers can be asked for.
    pub layers: bool,
    /// Number of layers that can be asked for; those above may still be planned.
    pub ready: usize,
    /// Time since it was begun, s.
    pub elapsed_s: f64,
    /// Why it failed: the sentence of the command line.
    pub error: Option<String>,
    /// Exit code of the command line.
    pub code: Option<i32>,
}

/// Progress of a run, which is counted without locks.
#[derive(Default)]
struct Counted {
    /// Index of the stage in [`Stage::ALL`] plus one; 0 before the first stage.
    stage: AtomicUsize,
    done: AtomicUsize,
    total: AtomicUsize,
    /// What can be drawn before the run is done.
    early: Mutex<Option<Arc<Drawn>>>,
}

impl Counted {
    /// Draws a program from now on. It keeps the frame of the layers before it, so that their bytes stay. `bed` is the frame
    /// of the first layers of a plan; `None` for whole programs.
    fn draw(&self, program: &Arc<Program>, bed: Option<&Frame>) -> Arc<Drawn> {
        let before = locked(&self.early).clone();
        let frame = before.as_ref().map(|b| b.records.frame()).or(bed);
        let records = Records::within(program, frame);
        let records = if bed.is_some() { records.unfinished() } else { records };
        let drawn = Arc::new(Drawn { program: Arc::clone(program), records });
        *locked(&self.early) = Some(Arc::clone(&drawn));
        drawn
    }
}

struct Counter {
    counted: Arc<Counted>,
    /// Whether the first layers are drawn while the others are planned.
    draws: bool,
}

impl Progress for Counter {
    fn begin(&self, stage: Stage, total: usize) {
        let place = Stage::ALL.iter().position(|s| *s == stage).map_or(0, |k| k + 1);
        self.counted.done.store(0, Ordering::Relaxed);
        self.counted.total.store(total, Ordering::Relaxed);
        self.counted.stage.store(place, Ordering::Relaxed);
    }

    fn advance(&self, n: usize) {
        self.counted.done.fetch_add(n, Ordering::Relaxed);
    }

    fn wants_layers(&self) -> bool {
        self.draws
    }

    fn layers(&self, early: &EarlyLayers<'_>) {
        // The times of these layers are estimates with common limits until the whole program is there.
        if let Ok(program) = simulate(early.gcode, early.filament_mm, &Limits::default()) {
            self.counted.draw(&Arc::new(program), Some(&Frame::of_box(early.bed_mm)));
        }
    }
}

/// A program as the page draws it.
pub struct Drawn {
    /// The program.
    pub program: Arc<Program>,
    /// Its index and records.
    pub records: Records,
}

/// The result of a run, with its program as the page draws it.
pub struct Result {
    /// The result that the engine returned.
    pub finished: Finished,
    /// Its program.
    pub drawn: Arc<Drawn>,
}

/// The work of a run; it may hand its program over before it is done.
pub type Work =
    Box<dyn FnOnce(&Diagnostics, &dyn Fn(&Arc<Program>)) -> std::result::Result<Finished, Refusal> + Send>;

struct Ended {
    at: Instant,
    outcome: std::result::Result<Arc<Result>, Refusal>,
}

/// A run.
pub struct Run {
    id: u64,
    kind: Kind,
    title: String,
    diagnostics: Diagnostics,
    counted: Arc<Counted>,
    phase: watch::Sender<Phase>,
    begun: Mutex<Option<Instant>>,
    ended: Mutex<Option<Ended>>,
}

fn locked<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}

impl Run {
    /// Its number.
    pub fn id(&self) -> u64 {
        self.id
    }

    /// Receiver of the changes of its phase.
    pub fn phases(&self) -> watch::Receiver<Phase> {
        self.phase.subscribe()
    }

    /// Its result, once it is done.
    pub fn result(&self) -> Option<Arc<Result>> {
        locked(&self.ended).as_ref().and_then(|e| e.outcome.as_ref().ok().map(Arc::clone))
    }

    /// Its program: once it is done, or, while it runs, as soon as the work hands it over. `None` if it failed.
    pub fn drawn(&self) -> Option<Arc<Drawn>> {
        match *self.phase.borrow() {
            // A program that was handed over early is shown while the run goes on.
            Phase::Running => locked(&self.counted.early).as_ref().map(Arc::clone),
            Phase::Done => self.result().map(|result| Arc::clone(&result.drawn)),
            Phase::Waiting | Phase::Failed | Phase::Cancelled => None,
        }
    }

    /// Its warnings so far.
    pub fn warnings(&self) -> Vec<grainpath_core::Warning> {
        self.diagnostics.warnings()
    }

    fn end(&self, phase: Phase, outcome: std::result::Result<Arc<Result>, Refusal>) {
        *locked(&self.ended) = Some(Ended { at: Instant::now(), outcome });
        self.phase.send_replace(phase);
        // From here on the layers of a run that is done are those of its result; others have none.
        *locked(&self.counted.early) = None;
    }
}

#[derive(Default)]
struct Queue {
    waiting: VecDeque<(Arc<Run>, Work)>,
    all: VecDeque<Arc<Run>>,
    is_closed: bool,
}

/// The exit code of the command line for a kind of failure.
type ExitCode = Box<dyn Fn(RefusalKind) -> i32 + Send + Sync>;

/// All runs of a studio.
pub struct Runs {
    shared: Arc<(Mutex<Queue>, Condvar)>,
    last: AtomicU64,
    exit_code: ExitCode,
}

impl Runs {
    /// An empty queue and the threads that work on it.
    pub fn new(exit_code: ExitCode) -> Self {
        let shared: Arc<(Mutex<Queue>, Condvar)> = Arc::default();
        for opens in [false, true] {
            let own = Arc::clone(&shared);
            std::thread::spawn(move || work(&own, opens));
        }
        Self { shared, last: AtomicU64::new(0), exit_code }
    }

    /// Adds a run to the queue.
    ///
    /// # Errors
    /// [`Refusal`] where too many wait.
    pub fn add(&self, kind: Kind, title: String, work: Work) -> std::result::Result<Arc<Run>, Refusal> {
        let counted: Arc<Counted> = Arc::default();
        let counter = Counter { counted: Arc::clone(&counted), draws: kind == Kind::Plan };
        let diagnostics = Diagnostics::with_progress(Box::new(counter));
        let run = Arc::new(Run {
            id: self.last.fetch_add(1, Ordering::Relaxed) + 1,
            kind,
            title,
            diagnostics,
            counted,
            phase: watch::Sender::new(Phase::Waiting),
            begun: Mutex::default(),
            ended: Mutex::default(),
        });
        let (queue, changed) = &*self.shared;
        let mut queue = locked(queue);
        if queue.waiting.len() >= MOST_WAITING {
            return Err(Refusal::usage(format!("{MOST_WAITING} runs wait already; cancel some of them")));
        }
        queue.waiting.push_back((Arc::clone(&run), work));
        queue.all.push_back(Arc::clone(&run));
        // The oldest finished run is dropped first; runs that have not ended are never dropped.
        while queue.all.len() > MOST_KEPT {
            let Some(oldest) = queue.all.iter().position(|r| r.phase.borrow().is_over()) else { break };
            queue.all.remove(oldest);
        }
        let is_old = |r: &Run| r.kind == kind && r.phase.borrow().is_over();
        while matches!(kind, Kind::Shape | Kind::Stress | Kind::Supports)
            && queue.all.iter().filter(|r| is_old(r)).count() >= MOST_SURFACES
        {
            let Some(oldest) = queue.all.iter().position(|r| is_old(r)) else { break };
            queue.all.remove(oldest);
        }
        drop(queue);
        changed.notify_all();
        Ok(run)
    }

    /// The run of this number.
    pub fn get(&self, id: u64) -> Option<Arc<Run>> {
        locked(&self.shared.0).all.iter().find(|r| r.id == id).map(Arc::clone)
    }

    /// All runs, oldest first.
    pub fn all(&self) -> Vec<Arc<Run>> {
        locked(&self.shared.0).all.iter().map(Arc::clone).collect()
    }

    /// The state of a run.
    pub fn state(&self, run: &Run) -> State {
        let phase = *run.phase.borrow();
        let ahead = if phase == Phase::Waiting {
            let queue = locked(&self.shared.0);
            let is_open = |r: &Run| !r.phase.borrow().is_over();
            let is_before = |r: &Run| r.id < run.id && r.kind.opens() == run.kind.opens();
            queue.all.iter().filter(|r| is_before(r) && is_open(r)).count()
        } else {
            0
        };
        let stage = run.counted.stage.load(Ordering::Relaxed).checked_sub(1).map(|k| Stage::ALL[k].name());
        let begun = *locked(&run.begun);
        let ready = run.drawn().map(|drawn| drawn.program.layers.len());
        let ended = locked(&run.ended);
        let until = ended.as_ref().map_or_else(Instant::now, |e| e.at);
        let elapsed_s = begun.map_or(0.0, |b| until.saturating_duration_since(b).as_secs_f64());
        let refusal = ended.as_ref().and_then(|e| e.outcome.as_ref().err());
        State {
            id: run.id,
            kind: run.kind,
            title: run.title.clone(),
            phase,
            ahead,
            stage,
            done: run.counted.done.load(Ordering::Relaxed),
            total: run.counted.total.load(Ordering::Relaxed),
            layers: ready.is_some(),
            ready: ready.unwrap_or(0),
            elapsed_s: (elapsed_s * 1e3).round() / 1e3,
            error: refusal.map(|r| r.message.clone()),
            code: refusal.map(|r| (self.exit_code)(r.kind)),
        }
    }

    /// Cancels a run: removes it from the queue if it waits, or asks it to stop if it runs.
    pub fn cancel(&self, run: &Run) {
        run.diagnostics.stop();
        let mut queue = locked(&self.shared.0);
        if let Some(at) = queue.waiting.iter().position(|(r, _)| r.id == run.id) {
            queue.waiting.remove(at);
            drop(queue);
            run.end(Phase::Cancelled, Err(interrupted()));
        }
    }

    /// Stops every run; no further run is started.
    pub fn close(&self) {
        let (queue, changed) = &*self.shared;
        let mut queue = locked(queue);
        queue.is_closed = true;
        queue.waiting.clear();
        queue.all.iter().for_each(|r| r.diagnostics.stop());
        drop(queue);
        changed.notify_all();
    }
}

impl Drop for Runs {
    fn drop(&mut self) {
        self.close();
    }
}

fn interrupted() -> Refusal {
    Refusal { message: "cancelled; nothing more was written".to_owned(), kind: RefusalKind::Interrupted }
}

/// Works on the runs of the queue that open a file, or on all others, until it is closed.
fn work(shared: &(Mutex<Queue>, Condvar), opens: bool) {
    let (queue, changed) = shared;
    loop {
        let mut open = locked(queue);
        let (run, work) = loop {
            if open.is_closed {
                return;
            }
            let next = open.waiting.iter().position(|(run, _)| run.kind.opens() == opens);
            if let Some(next) = next.and_then(|k| open.waiting.remove(k)) {
                // The phase is set under the lock, so that the run is always seen as either waiting or running.
                next.0.phase.send_replace(Phase::Running);
                break next;
            }
            open = changed.wait(open).unwrap_or_else(PoisonError::into_inner);
        };
        drop(open);
        *locked(&run.begun) = Some(Instant::now());
        // A panic is a fault of grainpath. It ends only the run, not the server, and the page shows it.
        let caught = std::panic::catch_unwind(std::panic::AssertUnwindSafe(|| {
            work(&run.diagnostics, &|program: &Arc<Program>| drop(run.counted.draw(program, None)))
        }));
        let outcome = caught.unwrap_or_else(|_| {
            let message = "the run failed by a fault of grainpath; the terminal shows where";
            Err(Refusal { message: message.to_owned(), kind: RefusalKind::Fault })
        });
        let is_stopped = run.diagnostics.check().is_err();
        match outcome {
            Ok(finished) => {
                // If the page already has records of this program, they are kept.
                let early = locked(&run.counted.early).clone();
                let early = early.filter(|e| Arc::ptr_eq(&e.program, &finished.program));
                let drawn = early.unwrap_or_else(|| run.counted.draw(&finished.program, None));
                run.end(Phase::Done, Ok(Arc::new(Result { finished, drawn })));
            }
            Err(_) if is_stopped => run.end(Phase::Cancelled, Err(interrupted())),
            Err(refusal) => run.end(Phase::Failed, Err(refusal)),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::time::Duration;

    fn until(run: &Run, phase: Phase) {
        let begun = Instant::now();
        while *run.phase.borrow() != phase {
            assert!(begun.elapsed() < Duration::from_secs(20), "{:?} is not {phase:?}", *run.phase.borrow());
            std::thread::sleep(Duration::from_millis(1));
        }
    }

    fn endless() -> Work {
        Box::new(|d, _| {
            d.begin(Stage::Fill, 10);
            d.advance(3);
            while d.check().is_ok() {
                std::thread::sleep(Duration::from_millis(1));
            }
            Err(Refusal::input("stopped"))
        })
    }

    #[test]
    fn runs_wait_for_each_other_and_can_be_cancelled() {
        let runs = Runs::new(Box::new(|kind| kind as i32));
        let first = runs.add(Kind::Plan, "a".into(), endless()).expect("room");
        let second =
            runs.add(Kind::Plan, "b".into(), Box::new(|_, _| Ok(Finished::default()))).expect("room");
        let third =
            runs.add(Kind::Stress, "c".into(), Box::new(|_, _| Ok(Finished::default()))).expect("room");
        until(&first, Phase::Running);
        // A file is opened meanwhile.
        let view = runs.add(Kind::View, "d".into(), Box::new(|_, _| Ok(Finished::default()))).expect("room");
        until(&view, Phase::Done);
        assert_eq!(runs.state(&first).phase, Phase::Running);
        while runs.state(&first).done < 3 {
            std::thread::sleep(Duration::from_millis(1));
        }
        let state = runs.state(&first);
        assert_eq!((state.stage, state.done, state.total), (Some("fill"), 3, 10));
        assert_eq!((runs.state(&second).ahead, runs.state(&third).ahead), (1, 2));
        runs.cancel(&second);
        assert_eq!(runs.state(&second).phase, Phase::Cancelled);
        assert!(second.result().is_none());
        runs.cancel(&first);
        until(&third, Phase::Done);
        assert_eq!(runs.state(&first).phase, Phase::Cancelled);
        assert!(third.result().is_some());
    }

    #[test]
    fn refusals_and_panics_end_a_run_and_not_the_queue() {
        let runs = Runs::new(Box::new(|kind| kind as i32));
        let refused = runs
            .add(Kind::View, "a".into(), Box::new(|_, _| Err(Refusal::input("a.stl: is empty"))))
            .expect("room");
        let broken = runs.add(Kind::View, "b".into(), Box::new(|_, _| panic!("a fault"))).expect("room");
        let good = runs.add(Kind::View, "c".into(), Box::new(|_, _| Ok(Finished::default()))).expect("room");
        until(&good, Phase::Done);
        let state = runs.state(&refused);
        assert_eq!((state.phase, state.code), (Phase::Failed, Some(RefusalKind::Input as i32)));
        assert_eq!(state.error.as_deref(), Some("a.stl: is empty"));
        assert_eq!(runs.state(&broken).phase, Phase::Failed);
    }

    #[test]
    fn old_runs_are_dropped_and_the_queue_has_an_end() {
        let runs = Runs::new(Box::new(|kind| kind as i32));
        let hold = runs.add(Kind::View, "held".into(), endless()).expect("room");
        until(&hold, Phase::Running);
        let mut refused = 0;
        for _ in 0..100 {
            refused += usize::from(
                runs.add(Kind::View, "x".into(), Box::new(|_, _| Ok(Finished::default()))).is_err(),
            );
        }
        assert_eq!(refused, 100 - MOST_WAITING);
        runs.cancel(&hold);
        let last = runs.all().pop().expect("some");
        until(&last, Phase::Done);
        runs.add(Kind::View, "y".into(), Box::new(|_, _| Ok(Finished::default()))).expect("room");
        assert!(runs.all().len() <= MOST_KEPT, "{}", runs.all().len());
        for _ in 0..2 * MOST_SURFACES {
            let shape =
                runs.add(Kind::Shape, "z".into(), Box::new(|_, _| Ok(Finished::default()))).expect("room");
            until(&shape, Phase::Done);
        }
        assert_eq!(runs.all().iter().filter(|r| r.kind == Kind::Shape).count(), MOST_SURFACES);
    }
}
