//! The planner as a WebAssembly module: a job and its files in, G-code and the report out.
//!
//! Interface: the page writes bytes into the module's one input buffer ([`input`]) and says what they are ([`add_file`],
//! [`add_setting`]); [`plan`] takes the buffer as the text of the job. [`answer`] and [`answer_len`] tell where the results
//! lie. The page never passes an address, so the module follows none. The page provides the clock and the receiver of
//! progress as imports: `env.now_s` and `env.progress`.
//!
//! After a panic the answer is its message and the module traps; the page then starts a new module. Limits: one
//! thread, 4 GiB of memory, no scans, no virtual strength test; `docs/try.md` says so to users. `cargo xtask wasm` compares
//! the G-code with that of the program, byte for byte.

mod job;

use std::sync::{Mutex, MutexGuard, PoisonError};

use grainpath_core::Diagnostics;

use job::Inputs;

#[cfg(target_family = "wasm")]
mod page {
    //! Functions that the page provides.

    use std::sync::atomic::{AtomicU32, Ordering};

    use grainpath_core::diagnostics::{Progress, Stage};

    mod imports {
        #[link(wasm_import_module = "env")]
        #[expect(unsafe_code, reason = "imports of the page; they take numbers and keep none")]
        unsafe extern "C" {
            pub(super) safe fn now_s() -> f64;
            pub(super) safe fn progress(stage: u32, done: u32, total: u32);
        }
    }

    /// The page's clock, s.
    pub(super) fn now_s() -> f64 {
        imports::now_s()
    }

    /// Passes progress on to the page: the index of the stage in [`Stage::ALL`], steps done and all steps.
    #[derive(Default)]
    pub(super) struct ToPage {
        stage: AtomicU32,
        done: AtomicU32,
        total: AtomicU32,
    }

    impl Progress for ToPage {
        fn begin(&self, stage: Stage, total: usize) {
            let index = Stage::ALL.iter().position(|s| *s == stage).unwrap_or_default();
            self.stage.store(index as u32, Ordering::Relaxed);
            self.done.store(0, Ordering::Relaxed);
            self.total.store(total as u32, Ordering::Relaxed);
            self.advance(0);
        }

        fn advance(&self, n: usize) {
            let done = self.done.fetch_add(n as u32, Ordering::Relaxed) + n as u32;
            imports::progress(self.stage.load(Ordering::Relaxed), done, self.total.load(Ordering::Relaxed));
        }
    }
}

#[cfg(target_family = "wasm")]
fn diagnostics() -> Diagnostics {
    Diagnostics::with_progress(Box::<page::ToPage>::default()).with_clock(page::now_s)
}

#[cfg(not(target_family = "wasm"))]
fn diagnostics() -> Diagnostics {
    Diagnostics::default()
}

/// The input buffer, and the inputs that were added so far.
static STATE: Mutex<State> = Mutex::new(State { input: Vec::new(), inputs: Inputs::new() });

/// The G-code or the error, and the report as JSON. They are not part of the state, so that a panic can be reported.
static ANSWERS: Mutex<[Vec<u8>; 2]> = Mutex::new([Vec::new(), Vec::new()]);

struct State {
    input: Vec<u8>,
    inputs: Inputs,
}

fn locked<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}

/// Makes room for `len` bytes of input and returns its address, to which the page writes.
#[expect(unsafe_code, reason = "a name that the page calls")]
#[unsafe(no_mangle)]
pub extern "C" fn input(len: usize) -> *mut u8 {
    let mut state = locked(&STATE);
    state.input = vec![0; len];
    state.input.as_mut_ptr()
}

/// Takes the input as a file: the first `name_len` bytes are its name as the job writes it, the others its content.
#[expect(unsafe_code, reason = "a name that the page calls")]
#[unsafe(no_mangle)]
pub extern "C" fn add_file(name_len: usize) {
    let mut state = locked(&STATE);
    let mut name = std::mem::take(&mut state.input);
    let content = name.split_off(name_len.min(name.len()));
    state.inputs.add_file(String::from_utf8_lossy(&name).into_owned(), content);
}

/// Takes the input as one `SECTION.KEY=VALUE`, which overrides the job as the option `--set` does.
#[expect(unsafe_code, reason = "a name that the page calls")]
#[unsafe(no_mangle)]
pub extern "C" fn add_setting() {
    let mut state = locked(&STATE);
    let text = std::mem::take(&mut state.input);
    state.inputs.add_setting(String::from_utf8_lossy(&text).into_owned());
}

/// Plans the input as a job, with the files and settings given before, and then forgets them. If it returns 0, answer 0 is
/// the G-code and answer 1 the report as JSON. If it returns 1, answer 0 is the error.
#[expect(unsafe_code, reason = "a name that the page calls")]
#[unsafe(no_mangle)]
pub extern "C" fn plan() -> u32 {
    std::panic::set_hook(Box::new(|panic| {
        *locked(&ANSWERS) = [format!("grainpath failed: {panic}").into_bytes(), Vec::new()];
    }));
    let (text, inputs) = {
        let mut state = locked(&STATE);
        (std::mem::take(&mut state.input), std::mem::replace(&mut state.inputs, Inputs::new()))
    };
    let outcome = match String::from_utf8(text) {
        Ok(text) => inputs.plan(&text, &diagnostics()),
        Err(e) => Err(format!("job.toml: not UTF-8 text (byte {})", e.utf8_error().valid_up_to())),
    };
    let is_error = outcome.is_err();
    *locked(&ANSWERS) = match outcome {
        Ok(planned) => [planned.gcode, planned.report.into_bytes()],
        Err(message) => [message.into_bytes(), Vec::new()],
    };
    u32::from(is_error)
}

/// The address of an answer.
#[expect(unsafe_code, reason = "a name that the page calls")]
#[unsafe(no_mangle)]
pub extern "C" fn answer(which: usize) -> *const u8 {
    locked(&ANSWERS).get(which).map_or(std::ptr::null(), |bytes| bytes.as_ptr())
}

/// The length of an answer, bytes.
#[expect(unsafe_code, reason = "a name that the page calls")]
#[unsafe(no_mangle)]
pub extern "C" fn answer_len(which: usize) -> usize {
    locked(&ANSWERS).get(which).map_or(0, Vec::len)
}

/// Frees the answers.
#[expect(unsafe_code, reason = "a name that the page calls")]
#[unsafe(no_mangle)]
pub extern "C" fn clear() {
    *locked(&ANSWERS) = [Vec::new(), Vec::new()];
}
