//! Large pieces of memory in large pages.
//!
//! The first touch of a page costs the system one to three microseconds, most of it whatever its size: a seventh of the time of
//! a build over 871,000 triangles. With pages of 2 MiB what is left is setting them to zero.
//!
//! **Why the unsafe code is sound**: the system is told how some memory that a vector owns is going to be used. That changes
//! neither what is in it nor who may use it; what the system does not know or does not like, it ignores.
#![allow(unsafe_code, reason = "advice to the system on memory that the caller owns")]

/// Vectors of fewer bytes stay as they are: less than one large page may lie in them.
const SMALLEST: usize = 1 << 22;

/// A vector with room for so many elements, in large pages where it is large and the system has them.
pub(crate) fn with_capacity<T>(capacity: usize) -> Vec<T> {
    let mut room = Vec::with_capacity(capacity);
    advise(&mut room);
    room
}

/// So many words of zeros, in large pages where there are many and the system has them.
pub(crate) fn zeros(count: usize) -> Vec<u64> {
    // From the system's own zeros, so that nothing is touched before the advice.
    let mut zeros = vec![0; count];
    advise(&mut zeros);
    zeros
}

#[cfg(all(target_os = "linux", any(target_arch = "x86_64", target_arch = "aarch64"), not(miri)))]
fn advise<T>(vector: &mut Vec<T>) {
    use std::ffi::{c_int, c_void};
    unsafe extern "C" {
        fn madvise(address: *mut c_void, length: usize, advice: c_int) -> c_int;
    }
    const MADV_HUGEPAGE: c_int = 14;
    /// Advice begins and ends at a boundary of a page, of which there are up to 64 KiB.
    const PAGE: usize = 1 << 16;
    let bytes = vector.capacity() * size_of::<T>();
    let skipped = vector.as_mut_ptr().cast::<u8>().align_offset(PAGE);
    if bytes < SMALLEST || skipped > bytes {
        return;
    }
    let first = vector.as_mut_ptr().cast::<u8>().wrapping_add(skipped);
    // SAFETY: whole pages of the vector's own memory; the advice changes nothing that a program could see.
    let _ = unsafe { madvise(first.cast(), (bytes - skipped) / PAGE * PAGE, MADV_HUGEPAGE) };
}

#[cfg(not(all(target_os = "linux", any(target_arch = "x86_64", target_arch = "aarch64"), not(miri))))]
fn advise<T>(_vector: &mut Vec<T>) {}

#[cfg(test)]
mod tests {
    #[test]
    fn advised_vectors_are_vectors() {
        for len in [0, 1, 1000, 3_000_000] {
            let mut vector = super::with_capacity(len);
            vector.extend(0..len as u64);
            assert!(vector.capacity() >= len && vector.iter().copied().eq(0..len as u64));
        }
    }
}
