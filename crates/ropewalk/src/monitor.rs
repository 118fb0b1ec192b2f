//! Watching and cancelling a long build.

use std::ops::ControlFlow;

/// Is told how far a build is, from any of its threads, and may stop it.
///
/// ```
/// use ropewalk::Monitor;
/// use std::ops::ControlFlow;
/// let stop_at_half = |done: usize, total: usize| {
///     if done * 2 > total { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
/// };
/// let _: &dyn Monitor = &stop_at_half;
/// ```
pub trait Monitor: Sync {
    /// `done` of `total` primitives have found their leaf. `Break` cancels the build.
    fn progress(&self, done: usize, total: usize) -> ControlFlow<()>;
}

impl<F: Fn(usize, usize) -> ControlFlow<()> + Sync> Monitor for F {
    fn progress(&self, done: usize, total: usize) -> ControlFlow<()> {
        self(done, total)
    }
}

/// The monitor that never stops anything.
#[derive(Clone, Copy, Debug, Default)]
pub struct NoMonitor;
impl Monitor for NoMonitor {
    fn progress(&self, _done: usize, _total: usize) -> ControlFlow<()> {
        ControlFlow::Continue(())
    }
}
