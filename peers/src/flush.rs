//! Denormal numbers as zeros, while a peer traces.
//!
//! Embree's documentation asks for it, and the other peers gain by it. It must not stay: our own answers are defined with
//! denormals, and tinybvh builds broken trees with it (it keeps indices in the low bits of floats).

/// Flush to zero and denormals are zero: bits 15 and 6 of the control register.
#[cfg(target_arch = "x86_64")]
const FLUSH: u32 = 1 << 15 | 1 << 6;

/// Sets the mode for this thread, and sets it back when dropped.
#[derive(Debug)]
pub(crate) struct Flushed {
    #[cfg(target_arch = "x86_64")]
    before: u32,
}

impl Flushed {
    pub(crate) fn new() -> Self {
        #[cfg(target_arch = "x86_64")]
        {
            let before = read();
            write(before | FLUSH);
            Self { before }
        }
        #[cfg(not(target_arch = "x86_64"))]
        Self {}
    }
}

impl Drop for Flushed {
    fn drop(&mut self) {
        #[cfg(target_arch = "x86_64")]
        write(self.before);
    }
}

#[cfg(target_arch = "x86_64")]
fn read() -> u32 {
    let mut word = 0u32;
    // SAFETY: the instruction stores 4 bytes where it is told, which is `word`.
    unsafe { std::arch::asm!("stmxcsr [{}]", in(reg) &mut word, options(nostack, preserves_flags)) };
    word
}

/// `word` is what `read` gave, with the two bits above at most, so that no reserved bit is set.
#[cfg(target_arch = "x86_64")]
fn write(word: u32) {
    // SAFETY: the instruction loads 4 bytes from `word`. Arithmetic between the two writes is that of foreign functions, and
    // of ours only copies and comparisons, which no rounding mode changes.
    unsafe { std::arch::asm!("ldmxcsr [{}]", in(reg) &word, options(nostack, preserves_flags)) };
}

#[cfg(all(test, target_arch = "x86_64"))]
mod tests {
    use super::*;

    #[test]
    fn the_mode_is_set_back() {
        let before = read();
        {
            let _flushed = Flushed::new();
            assert_eq!(read() & FLUSH, FLUSH);
        }
        assert_eq!(read(), before);
    }
}
