//! The memory of a packed tree: one piece on a boundary of 2 MiB, in huge pages where the system has them.
//!
//! A walk through a tree beyond the cache misses the table of pages as often as the cache: with pages of 4 KiB a miss
//! took 214 to 286 ns on the machine of the study that this follows, with pages of 2 MiB 167 to 193.
//!
//! **Soundness.** Walks read nodes and leaves ([`Reader`]) by words that only [`super::layout`] and [`super::compact`] write;
//! they have checked that each lies inside (readers check it again in debug builds), and nothing changes a word afterwards.

use super::compact::CompactNode;
use super::leaf::{IndexedLeaf, Leaf, Triangles};
use super::node::{PackedNode, Word};
use super::walk::Boxes;
use bytemuck::{Pod, Zeroable};

/// What the memory is made of: a cache line.
#[repr(C, align(64))]
#[derive(Clone, Copy, Pod, Zeroable)]
struct Line([u32; 16]);

/// Bytes of a cache line.
pub(super) const LINE: usize = size_of::<Line>();

/// Zeroed memory on a boundary of a cache line at least.
pub(super) struct Arena {
    memory: Memory,
    bytes: usize,
}

enum Memory {
    Lines(Box<[Line]>),
    #[cfg(all(unix, not(miri)))]
    Pages {
        map: memmap2::MmapMut,
        first: usize,
    },
}

/// Below, memory comes from the allocator: huge pages of 2 MiB would waste it.
#[cfg(all(unix, not(miri)))]
const SMALLEST_MAP: usize = 1 << 21;

impl Arena {
    /// `bytes` of zeros, rounded up to whole lines.
    pub(super) fn new(bytes: usize) -> Self {
        let bytes = bytes.next_multiple_of(LINE);
        #[cfg(all(unix, not(miri)))]
        if bytes >= SMALLEST_MAP
            && let Some(memory) = Self::pages(bytes)
        {
            return Self { memory, bytes };
        }
        let lines = vec![Line::zeroed(); bytes / LINE].into_boxed_slice();
        Self { memory: Memory::Lines(lines), bytes }
    }

    /// Memory of the system's own, on a boundary of a huge page; `None` where it has none to give.
    #[cfg(all(unix, not(miri)))]
    fn pages(bytes: usize) -> Option<Memory> {
        let mut map = memmap2::MmapMut::map_anon(bytes.checked_add(SMALLEST_MAP)?).ok()?;
        let first = map.as_mut_ptr().align_offset(SMALLEST_MAP);
        #[cfg(target_os = "linux")]
        {
            // A system without huge pages says no, and small ones do.
            let _ = map.advise_range(memmap2::Advice::HugePage, first, bytes);
            // What fills no huge page comes at once, instead of with a fault for every small one.
            let tail = bytes / SMALLEST_MAP * SMALLEST_MAP;
            let _ = map.advise_range(memmap2::Advice::PopulateWrite, first + tail, bytes - tail);
        }
        Some(Memory::Pages { map, first })
    }

    pub(super) const fn len(&self) -> usize {
        self.bytes
    }

    #[inline(always)]
    pub(super) fn words(&self) -> &[u32] {
        match &self.memory {
            Memory::Lines(lines) => bytemuck::cast_slice(lines),
            #[cfg(all(unix, not(miri)))]
            Memory::Pages { map, first } => bytemuck::cast_slice(&map[*first..][..self.bytes]),
        }
    }

    pub(super) fn words_mut(&mut self) -> &mut [u32] {
        match &mut self.memory {
            Memory::Lines(lines) => bytemuck::cast_slice_mut(lines),
            #[cfg(all(unix, not(miri)))]
            Memory::Pages { map, first } => bytemuck::cast_slice_mut(&mut map[*first..][..self.bytes]),
        }
    }
}

impl Clone for Arena {
    fn clone(&self) -> Self {
        let mut copy = Self::new(self.bytes);
        copy.words_mut().copy_from_slice(self.words());
        copy
    }
}

impl std::fmt::Debug for Arena {
    fn fmt(&self, formatter: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        formatter.debug_struct("Arena").field("bytes", &self.bytes).finish_non_exhaustive()
    }
}

/// An arena as walks read it: by words that its packing wrote into it.
pub(super) trait Reader<'a>: Copy {
    type Node: Boxes + 'a;
    type Leaf: Triangles;

    /// Whether leaves have their vertices elsewhere, so that it is known only at a leaf which lines these are.
    const APART: bool;
    /// Trees beyond this many bytes are walked with more rays in turn: what they wait for comes from memory.
    const LARGE: usize;

    /// # Safety
    /// The arena's nodes and leaves are of this kind.
    unsafe fn new(arena: &'a Arena) -> Self;

    /// The node of a word.
    ///
    /// # Safety
    /// The word is the root's, or a node's word of a node of this arena.
    unsafe fn node(self, word: Word) -> &'a Self::Node;

    /// The leaf of a word.
    ///
    /// # Safety
    /// The word is a leaf's word of a node of this arena, and not [`super::node::DONE`].
    unsafe fn leaf(self, word: Word) -> Self::Leaf;

    /// Asks for the lines from a word's first byte on, whatever is there: all of a node, or the most of a leaf. An address beyond
    /// the memory does no harm.
    fn prefetch(self, word: Word);

    /// Asks for the vertices of a leaf, where they lie elsewhere.
    ///
    /// # Safety
    /// As [`Self::leaf`].
    unsafe fn prefetch_vertices(self, word: Word);
}

/// An arena of full nodes ([`super::layout`]).
#[derive(Clone, Copy, Debug)]
pub(super) struct View<'a> {
    words: &'a [u32],
}

impl<'a> Reader<'a> for View<'a> {
    type Node = PackedNode;
    type Leaf = Leaf<'a>;
    const APART: bool = false;
    const LARGE: usize = 24 << 20;

    #[inline(always)]
    unsafe fn new(arena: &'a Arena) -> Self {
        Self { words: arena.words() }
    }

    #[inline(always)]
    unsafe fn node(self, word: Word) -> &'a PackedNode {
        debug_assert!(!word.is_leaf() && word.offset() + size_of::<PackedNode>() <= 4 * self.words.len());
        debug_assert_eq!(word.offset() % LINE, 0);
        // SAFETY: the layout has put a whole node there, on a boundary of a line.
        unsafe { &*self.words.as_ptr().byte_add(word.offset()).cast() }
    }

    #[inline(always)]
    unsafe fn leaf(self, word: Word) -> Leaf<'a> {
        debug_assert!(word.is_leaf() && word.offset() / 4 + Leaf::span(word.count()) <= self.words.len());
        // SAFETY: the layout has put a leaf there, and a margin behind the last one.
        let words = unsafe {
            std::slice::from_raw_parts(self.words.as_ptr().byte_add(word.offset()), Leaf::span(word.count()))
        };
        Leaf::new(words, word.count())
    }

    #[inline(always)]
    fn prefetch(self, word: Word) {
        let first = self.words.as_ptr().wrapping_byte_add(word.offset());
        for line in 0..4 {
            prefetch(first.wrapping_byte_add(line * LINE));
        }
    }

    #[inline(always)]
    unsafe fn prefetch_vertices(self, _: Word) {}
}

/// An arena of compact nodes ([`super::compact`]).
#[derive(Clone, Copy, Debug)]
pub(super) struct CompactView<'a> {
    words: &'a [u32],
}

impl<'a> Reader<'a> for CompactView<'a> {
    type Node = CompactNode;
    type Leaf = IndexedLeaf<'a>;
    const APART: bool = true;
    const LARGE: usize = 8 << 20;

    #[inline(always)]
    unsafe fn new(arena: &'a Arena) -> Self {
        Self { words: arena.words() }
    }

    #[inline(always)]
    unsafe fn node(self, word: Word) -> &'a CompactNode {
        debug_assert!(!word.is_leaf() && word.offset() + size_of::<CompactNode>() <= 4 * self.words.len());
        debug_assert_eq!(word.offset() % LINE, 0);
        // SAFETY: packing has put a whole node there, on a boundary of a line.
        unsafe { &*self.words.as_ptr().byte_add(word.offset()).cast() }
    }

    #[inline(always)]
    unsafe fn leaf(self, word: Word) -> IndexedLeaf<'a> {
        debug_assert!(word.is_leaf());
        // SAFETY: packing has put a leaf there, whose indices lead to vertices of the same arena, with a margin behind the last
        // one.
        unsafe { IndexedLeaf::new(self.words, word.offset() / 4, word.count()) }
    }

    #[inline(always)]
    fn prefetch(self, word: Word) {
        let first = self.words.as_ptr().wrapping_byte_add(word.offset());
        for line in 0..2 {
            prefetch(first.wrapping_byte_add(line * LINE));
        }
    }

    #[inline(always)]
    unsafe fn prefetch_vertices(self, word: Word) {
        // SAFETY: the caller's.
        let leaf = unsafe { self.leaf(word) };
        for triangle in 0..leaf.len() {
            for corner in 0..3 {
                prefetch(self.words.as_ptr().wrapping_add(leaf.vertex(corner, triangle)));
            }
        }
    }
}

/// Asks for the line of an address. One where there is no memory does no harm.
#[inline(always)]
pub(super) fn prefetch<T>(address: *const T) {
    #[cfg(all(target_arch = "x86_64", not(miri)))]
    {
        use std::arch::x86_64::{_MM_HINT_T0, _mm_prefetch};
        // SAFETY: the instruction reads nothing that a program could see, and faults nowhere.
        unsafe { _mm_prefetch::<_MM_HINT_T0>(address.cast()) };
    }
    #[cfg(all(target_arch = "aarch64", not(miri)))]
    // SAFETY: the instruction reads nothing that a program could see, and faults nowhere.
    unsafe {
        std::arch::asm!("prfm pldl1keep, [{line}]", line = in(reg) address,
            options(nostack, preserves_flags, readonly));
    }
    #[cfg(any(miri, not(any(target_arch = "x86_64", target_arch = "aarch64"))))]
    let _ = address;
}
