//! Clocks and scales: what the arena measures with.
//!
//! One thread is timed by its own processor time where the system tells it, which other programs disturb least; several
//! threads by the wall. The arena itself knows only the wall; whoever runs it may bring better instruments.

use std::time::Instant;

/// Which time counts.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kind {
    /// The wall's.
    Wall,
    /// The calling thread's processor time.
    Thread,
    /// The whole process's processor time.
    Process,
}

/// Tells the time and the memory.
pub trait Instruments: Sync {
    /// Seconds since some moment; `None` where there is no such clock.
    fn now(&self, kind: Kind) -> Option<f64>;

    /// Begins to count what is allocated, from zero.
    fn start_counting(&self) {}

    /// Ends counting; the bytes that are there still and the most there were at once. `None` where nobody counts.
    fn stop_counting(&self) -> Option<Counted> {
        None
    }
}

/// Bytes that were allocated between two moments.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Counted {
    /// Not freed again.
    pub kept: usize,
    /// The most at once.
    pub peak: usize,
}

/// The wall's clock alone.
#[derive(Clone, Copy, Debug)]
pub struct WallClock(Instant);

impl WallClock {
    /// From now on.
    #[must_use]
    pub fn new() -> Self {
        Self(Instant::now())
    }
}

impl Default for WallClock {
    fn default() -> Self {
        Self::new()
    }
}

impl Instruments for WallClock {
    fn now(&self, kind: Kind) -> Option<f64> {
        (kind == Kind::Wall).then(|| self.0.elapsed().as_secs_f64())
    }
}

/// The seconds that some work takes by the best clock there is.
pub(super) fn seconds(instruments: &dyn Instruments, wanted: Kind, work: impl FnOnce()) -> f64 {
    let kind = if instruments.now(wanted).is_some() { wanted } else { Kind::Wall };
    let start = instruments.now(kind).unwrap_or(0.0);
    work();
    // A clock that shows no time would show an infinite rate.
    (instruments.now(kind).unwrap_or(0.0) - start).max(1e-9)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_clock_that_is_not_there_is_replaced_by_the_wall() {
        let wall = WallClock::new();
        assert!(wall.now(Kind::Thread).is_none());
        let slept = seconds(&wall, Kind::Thread, || std::thread::sleep(std::time::Duration::from_millis(3)));
        assert!(slept >= 0.003);
    }
}
