//! What builders tell the monitor, and how they learn that the build is cancelled. Shared by all threads.

use crate::{BuildError, Monitor};
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};

/// How far a build is.
pub(crate) struct Progress<'a> {
    monitor: &'a dyn Monitor,
    total: usize,
    done: AtomicUsize,
    cancelled: AtomicBool,
}

impl<'a> Progress<'a> {
    /// Of `total` primitives none has found its leaf.
    pub(crate) fn new(monitor: &'a dyn Monitor, total: usize) -> Self {
        Self { monitor, total, done: AtomicUsize::new(0), cancelled: AtomicBool::new(false) }
    }

    /// Whether all threads should come home.
    pub(crate) fn is_cancelled(&self) -> bool {
        self.cancelled.load(Ordering::Relaxed)
    }

    /// So many more primitives have found their leaf. Of none the monitor hears nothing: each amount is told once.
    pub(crate) fn add(&self, primitives: usize) {
        if primitives == 0 {
            return;
        }
        let done = self.done.fetch_add(primitives, Ordering::Relaxed) + primitives;
        if self.monitor.progress(done, self.total).is_break() {
            self.cancelled.store(true, Ordering::Relaxed);
        }
    }

    /// The end of the build: an error when it was cancelled.
    pub(crate) fn finish(self) -> Result<(), BuildError> {
        if self.cancelled.into_inner() { Err(BuildError::Cancelled) } else { Ok(()) }
    }
}
