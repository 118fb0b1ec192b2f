//! Processor time and allocated bytes.

use ropewalk_lab::arena::{Counted, Instruments, Kind};
use std::alloc::{GlobalAlloc, Layout, System};
use std::sync::atomic::{AtomicBool, AtomicI64, Ordering};

static COUNTS: AtomicBool = AtomicBool::new(false);
static CURRENT: AtomicI64 = AtomicI64::new(0);
static PEAK: AtomicI64 = AtomicI64::new(0);

/// The system's allocator, which counts while it is told to. A program that measures makes it its global one.
#[derive(Clone, Copy, Debug, Default)]
pub struct CountingAllocator;

fn count(bytes: i64) {
    // Outside of a counted build this is one load: timed builds pay nothing for it.
    if COUNTS.load(Ordering::Relaxed) {
        let now = CURRENT.fetch_add(bytes, Ordering::Relaxed) + bytes;
        PEAK.fetch_max(now, Ordering::Relaxed);
    }
}

// SAFETY: every call is handed to the system's allocator as it came; counting touches no memory of it.
unsafe impl GlobalAlloc for CountingAllocator {
    unsafe fn alloc(&self, layout: Layout) -> *mut u8 {
        count(layout.size() as i64);
        // SAFETY: the caller's promise, passed on.
        unsafe { System.alloc(layout) }
    }

    unsafe fn alloc_zeroed(&self, layout: Layout) -> *mut u8 {
        count(layout.size() as i64);
        // SAFETY: the caller's promise, passed on.
        unsafe { System.alloc_zeroed(layout) }
    }

    unsafe fn dealloc(&self, pointer: *mut u8, layout: Layout) {
        count(-(layout.size() as i64));
        // SAFETY: the caller's promise, passed on.
        unsafe { System.dealloc(pointer, layout) }
    }

    unsafe fn realloc(&self, pointer: *mut u8, layout: Layout, size: usize) -> *mut u8 {
        count(size as i64 - layout.size() as i64);
        // SAFETY: the caller's promise, passed on.
        unsafe { System.realloc(pointer, layout, size) }
    }
}

/// The system's clocks, and the bytes of [`CountingAllocator`] where it is the program's.
#[derive(Clone, Copy, Debug, Default)]
pub struct SystemInstruments;

impl Instruments for SystemInstruments {
    fn now(&self, kind: Kind) -> Option<f64> {
        clock(match kind {
            Kind::Wall => libc::CLOCK_MONOTONIC,
            Kind::Thread => libc::CLOCK_THREAD_CPUTIME_ID,
            Kind::Process => libc::CLOCK_PROCESS_CPUTIME_ID,
        })
    }

    fn start_counting(&self) {
        CURRENT.store(0, Ordering::SeqCst);
        PEAK.store(0, Ordering::SeqCst);
        COUNTS.store(true, Ordering::SeqCst);
    }

    fn stop_counting(&self) -> Option<Counted> {
        COUNTS.store(false, Ordering::SeqCst);
        let bytes = |counter: &AtomicI64| usize::try_from(counter.load(Ordering::SeqCst)).unwrap_or(0);
        // Nothing at all was counted: the allocator is another one.
        (bytes(&PEAK) > 0).then_some(Counted { kept: bytes(&CURRENT), peak: bytes(&PEAK) })
    }
}

fn clock(id: libc::clockid_t) -> Option<f64> {
    let mut time = libc::timespec { tv_sec: 0, tv_nsec: 0 };
    // SAFETY: the function writes one `timespec` where it is told.
    let failed = unsafe { libc::clock_gettime(id, &mut time) };
    (failed == 0).then_some(time.tv_sec as f64 + time.tv_nsec as f64 * 1e-9)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn work_takes_processor_time() {
        let clocks = SystemInstruments;
        let before = [Kind::Thread, Kind::Process].map(|kind| clocks.now(kind).unwrap());
        let mut sum = 0u64;
        for number in 0..20_000_000u64 {
            sum = std::hint::black_box(sum.wrapping_add(number * number));
        }
        let after = [Kind::Thread, Kind::Process].map(|kind| clocks.now(kind).unwrap());
        assert!(after[0] > before[0] && after[1] > before[1], "{sum}");
    }
}
