//! Shows a progress line on the terminal and lets Ctrl-C stop the run.

use std::io::IsTerminal;
use std::sync::Arc;
use std::time::Duration;

use grainpath_core::Diagnostics;
use grainpath_core::diagnostics::{Progress, Stage};
use indicatif::{ProgressBar, ProgressStyle};

use crate::interrupt;

struct Bar(ProgressBar);

/// The line of a stage that counts no steps.
const NAME_AND_TIME: &str = "{msg:<15} {elapsed}";

fn style(template: &str) -> ProgressStyle {
    ProgressStyle::with_template(template).unwrap_or_else(|_| ProgressStyle::default_bar())
}

impl Progress for Bar {
    fn begin(&self, stage: Stage, total: usize) {
        self.0.set_position(0);
        self.0.reset_elapsed();
        // A stage that counts no steps tells how long it has taken, and no "0 of 0".
        if total == 0 {
            self.0.unset_length();
            self.0.set_style(style(NAME_AND_TIME));
        } else {
            self.0.set_length(total as u64);
            self.0.set_style(style("{msg:<15} {wide_bar} {pos} of {len} {eta}"));
        }
        self.0.set_message(match stage {
            Stage::Read => "reading",
            Stage::Slice => "slicing",
            Stage::Guide => "guide",
            Stage::Fill => "walls and fill",
            Stage::Support => "support",
            Stage::Order => "ordering",
            Stage::Write => "writing",
            Stage::Strength => "strength test",
        });
        // Redraws are limited to some a second, and a stage that counts no steps would never show its name.
        self.0.force_draw();
    }

    fn advance(&self, n: usize) {
        self.0.inc(n as u64);
    }
}

// The line is cleared at the end, so that the result is printed in its place.
impl Drop for Bar {
    fn drop(&mut self) {
        self.0.finish_and_clear();
    }
}

/// Diagnostics that show progress if standard error is a terminal, and stop the run on Ctrl-C.
pub(crate) fn diagnostics() -> Arc<Diagnostics> {
    // The line is drawn on terminals only: a log file would get a line for each redraw.
    let diagnostics = Arc::new(if std::io::stderr().is_terminal() {
        let bar = ProgressBar::no_length().with_style(style(NAME_AND_TIME));
        // The seconds go on while a stage counts nothing, as the strength test.
        bar.enable_steady_tick(Duration::from_secs(1));
        Diagnostics::with_progress(Box::new(Bar(bar)))
    } else {
        Diagnostics::default()
    });
    interrupt::stops(Arc::clone(&diagnostics));
    diagnostics
}
