//! The stack of a walk: what waits for its turn, and where the ray enters it.
//!
//! Two arrays, so that a vector can be stored on top of each at once; 3.8 KiB, of which a walk touches what it uses, and which nobody
//! sets to zero before. The word [`DONE`] lies at the bottom, entered before everything, so that no test for an empty stack is
//! needed.

use crate::bvh8::node::{DONE, Word};
use crate::bvh8::tree::{MAX_LEVELS, WIDTH};
use std::mem::MaybeUninit;

/// At each level of a path all children but one may wait, at the deepest all, and below them lies the sentinel.
const MOST: usize = MAX_LEVELS as usize * (WIDTH - 1) + 2;
/// What vectors may write or read above the top.
const MARGIN: usize = 16;
/// What it comes to decides how slots of batches lie in the cache, see [`super::interleave`].
pub(super) const ROOM: usize = (MOST + MARGIN).next_multiple_of(16) + 16;

/// The stack. **Invariant**: the first `len` places of `words` are written, those of `entries` where the walk pushes with
/// entries; `len` is at most [`MOST`], because trees have no more than [`MAX_LEVELS`] levels.
#[derive(Clone, Copy)]
pub(in super::super) struct Stack {
    words: [MaybeUninit<u32>; ROOM],
    entries: [MaybeUninit<f32>; ROOM],
    len: usize,
}

#[cfg_attr(not(target_arch = "x86_64"), allow(dead_code, reason = "levels that push one by one need less"))]
impl Stack {
    /// With [`DONE`] in it.
    #[inline(always)]
    pub(in super::super) fn new() -> Self {
        let mut this = Self {
            words: [const { MaybeUninit::uninit() }; ROOM],
            entries: [const { MaybeUninit::uninit() }; ROOM],
            len: 0,
        };
        this.reset();
        this
    }

    /// Writes [`DONE`] and a word on top of it to where a stack shall be.
    ///
    /// # Safety
    /// A stack can be written there.
    #[inline(always)]
    pub(in super::super) unsafe fn begin(stack: *mut Self, word: u32) {
        // SAFETY: the caller's; words and entries are arrays of numbers that need not be written.
        unsafe {
            let (words, entries) = (&raw mut (*stack).words, &raw mut (*stack).entries);
            words.cast::<[u32; 2]>().write([DONE, word]);
            entries.cast::<[f32; 2]>().write([f32::NEG_INFINITY, 0.0]);
            (&raw mut (*stack).len).write(2);
        }
    }

    /// Nothing but [`DONE`].
    #[inline(always)]
    pub(in super::super) fn reset(&mut self) {
        self.words[0].write(DONE);
        self.entries[0].write(f32::NEG_INFINITY);
        self.len = 1;
    }

    #[inline(always)]
    pub(in super::super) fn push(&mut self, word: u32, entry: f32) {
        self.words[self.len].write(word);
        self.entries[self.len].write(entry);
        self.len += 1;
    }

    /// The top, which must be there: a walk ends when it pops [`DONE`].
    #[inline(always)]
    pub(in super::super) fn pop(&mut self) -> Word {
        debug_assert!(self.len > 0 && self.len <= MOST);
        self.len -= 1;
        // SAFETY: below `len` every word is written, and `len` is at most `ROOM`.
        Word(unsafe { self.words.get_unchecked(self.len).assume_init() })
    }

    /// The top and where it is entered. Only for walks that push with entries.
    #[inline(always)]
    pub(in super::super) fn pop_with_entry(&mut self) -> (Word, f32) {
        let word = self.pop();
        // SAFETY: as in `pop`; entries are written where words are.
        (word, unsafe { self.entries.get_unchecked(self.len).assume_init() })
    }

    /// What is popped next.
    #[inline(always)]
    pub(in super::super) fn peek(&self) -> Word {
        debug_assert!(self.len > 0 && self.len <= MOST);
        // SAFETY: as in `pop`.
        Word(unsafe { self.words.get_unchecked(self.len - 1).assume_init() })
    }

    #[inline(always)]
    pub(in super::super) const fn len(&self) -> usize {
        self.len
    }

    /// Where the next eight words and entries go.
    #[inline(always)]
    pub(in super::super) fn top(&mut self) -> (*mut u32, *mut f32) {
        debug_assert!(self.len + WIDTH <= ROOM);
        let (words, entries) = self.bottom();
        (words.wrapping_add(self.len), entries.wrapping_add(self.len))
    }

    /// Where words and entries begin.
    #[inline(always)]
    pub(in super::super) fn bottom(&mut self) -> (*mut u32, *mut f32) {
        (self.words.as_mut_ptr().cast(), self.entries.as_mut_ptr().cast())
    }

    /// Takes `count` of the places that were written on top.
    #[inline(always)]
    pub(in super::super) fn grow(&mut self, count: u32) {
        self.len += count as usize;
        debug_assert!(self.len <= MOST);
    }

    #[inline(always)]
    pub(in super::super) fn shrink_to(&mut self, len: usize) {
        debug_assert!(len <= self.len);
        self.len = len;
    }

    /// Leaves out what is not kept.
    #[inline(always)]
    pub(in super::super) fn keep(&mut self, keep: impl Fn(f32) -> bool) {
        let mut kept = 0;
        for place in 0..self.len {
            // SAFETY: only walks that push with entries leave any out; below `len` they are written.
            if keep(unsafe { self.entries[place].assume_init() }) {
                (self.words[kept], self.entries[kept]) = (self.words[place], self.entries[place]);
                kept += 1;
            }
        }
        self.len = kept;
    }
}
