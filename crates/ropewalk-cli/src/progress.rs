//! A line on standard error that says what takes so long: only on a terminal, and gone when the work is done.

use crate::interrupt;
use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};
use std::ops::ControlFlow;
use std::time::Duration;

/// A bar or a spinner. Dropping it takes it off the screen.
#[derive(Debug)]
pub(crate) struct Progress(ProgressBar);

impl Progress {
    /// For work of unknown length.
    pub(crate) fn spinner(label: impl Into<String>) -> Self {
        let progress = Self::with_style(None, "{spinner} {msg} {elapsed}", label.into());
        if !progress.0.is_hidden() {
            progress.0.enable_steady_tick(Duration::from_millis(120));
        }
        progress
    }

    /// For work in steps.
    pub(crate) fn bar(label: impl Into<String>) -> Self {
        Self::with_style(Some(0), "{msg} [{wide_bar}] {percent:>3}% {eta}", label.into())
    }

    fn with_style(length: Option<u64>, template: &str, label: String) -> Self {
        let bar = ProgressBar::with_draw_target(length, ProgressDrawTarget::stderr());
        if let Ok(style) = ProgressStyle::with_template(template) {
            bar.set_style(style.progress_chars("=> "));
        }
        bar.set_message(label);
        Self(bar)
    }

    /// Says what is being done now.
    pub(crate) fn label(&self, label: String) {
        if !self.0.is_hidden() {
            self.0.set_message(label);
        }
    }

    /// Shows that `done` of `total` steps are behind us.
    pub(crate) fn set(&self, done: usize, total: usize) {
        self.0.set_length(total as u64);
        self.0.set_position(done as u64);
    }

    /// The same, and says whether ctrl-C asks to stop.
    pub(crate) fn step(&self, done: usize, total: usize) -> ControlFlow<()> {
        self.set(done, total);
        interrupt::check()
    }
}

impl Drop for Progress {
    fn drop(&mut self) {
        self.0.finish_and_clear();
    }
}
