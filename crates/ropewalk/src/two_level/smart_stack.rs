//! The smart stack (Reichl 2010, section 4.3 and its figure of the mixed stack): one ring of bytes for the stacks of both levels,
//! which hands its oldest entries to a slower memory when it is full, and takes the youngest of them back when it is empty.
//!
//! An entry of a BVH takes 8 bytes, a node and where the ray enters it; one of a kd-tree 12, since the ray leaves its cell where
//! its parent says. Both kinds share the ring: while an object is walked the top level's entries rest below, and when they are
//! wanted again all of the object's have gone. So nothing has to be stored about what an entry is: two counters for the ring
//! and two for the other memory tell. That is the invariant, and [`SmartStack::push_top`] says so in debug builds.
//!
//! The paper has 256 bytes for each of 64 rays, the 16 KiB of on-chip memory of its time. On a CPU the ring saves nothing; it is
//! here as the twin of `shared/smart_stack.wgsl`, where the ring lies in workgroup memory. A stack of 64 words is the largest, 24
//! bytes the smallest, which has room for two entries of either kind.

/// Words of the largest ring.
const MOST_WORDS: usize = (SmartStack::MOST_BYTES / 4) as usize;

/// Words of an entry of the top level.
const TOP_WORDS: usize = 2;

/// A stack of entries of two kinds.
#[derive(Clone, Debug)]
pub struct SmartStack {
    ring: [u32; MOST_WORDS],
    /// Words in use as a ring.
    capacity: usize,
    /// The place of the oldest word.
    first: usize,
    /// Words held.
    held: usize,
    /// Entries in the ring: of the top level, and above them of an object.
    in_ring: [u32; 2],
    /// The oldest entries of all, the youngest last.
    swapped: Vec<u32>,
    /// Entries there, of both kinds.
    in_swap: [u32; 2],
    /// Words of an object's entry.
    bottom_words: usize,
    /// Entries that went to the slower memory.
    swaps: u32,
    /// The most bytes that all entries took.
    deepest: u32,
}

const TOP: usize = 0;
const BOTTOM: usize = 1;

impl SmartStack {
    /// Bytes of the smallest ring.
    pub const LEAST_BYTES: u32 = 24;
    /// Bytes of the largest ring: the paper's.
    pub const MOST_BYTES: u32 = 256;

    /// The next number of bytes that a ring can have.
    #[must_use]
    pub const fn round(bytes: u32) -> u32 {
        let whole = bytes / 4 * 4;
        if whole < Self::LEAST_BYTES {
            Self::LEAST_BYTES
        } else if whole > Self::MOST_BYTES {
            Self::MOST_BYTES
        } else {
            whole
        }
    }

    /// An empty stack with a ring of so many bytes, [rounded](SmartStack::round).
    #[must_use]
    pub fn new(bytes: u32) -> Self {
        Self {
            ring: [0; MOST_WORDS],
            capacity: (Self::round(bytes) / 4) as usize,
            first: 0,
            held: 0,
            in_ring: [0; 2],
            swapped: Vec::new(),
            in_swap: [0; 2],
            bottom_words: TOP_WORDS,
            swaps: 0,
            deepest: 0,
        }
    }

    /// Pushes an entry of the top level. There must be none of an object.
    #[inline(always)]
    pub fn push_top(&mut self, entry: [u32; TOP_WORDS]) {
        debug_assert_eq!(self.bottom_entries(), 0, "an object's entries lie above the top level's");
        self.push::<TOP, TOP_WORDS>(entry);
    }

    /// Takes the youngest entry of the top level. There must be none of an object.
    #[inline(always)]
    pub fn pop_top(&mut self) -> Option<[u32; TOP_WORDS]> {
        debug_assert_eq!(self.bottom_entries(), 0, "an object's entries lie above the top level's");
        self.pop::<TOP, TOP_WORDS>()
    }

    /// Pushes an entry of the object that is being walked: of 2 words or of 3, the same for all that are held.
    #[inline(always)]
    pub fn push_bottom<const WORDS: usize>(&mut self, entry: [u32; WORDS]) {
        const { assert!(WORDS == 2 || WORDS == 3) };
        debug_assert!(self.bottom_entries() == 0 || self.bottom_words == WORDS);
        self.bottom_words = WORDS;
        self.push::<BOTTOM, WORDS>(entry);
    }

    /// Takes the youngest entry of the object that is being walked.
    #[inline(always)]
    pub fn pop_bottom<const WORDS: usize>(&mut self) -> Option<[u32; WORDS]> {
        self.pop::<BOTTOM, WORDS>()
    }

    /// Entries of the top level.
    #[must_use]
    pub const fn top_entries(&self) -> usize {
        (self.in_ring[TOP] + self.in_swap[TOP]) as usize
    }

    /// Entries of the object that is being walked.
    #[must_use]
    pub const fn bottom_entries(&self) -> usize {
        (self.in_ring[BOTTOM] + self.in_swap[BOTTOM]) as usize
    }

    /// How many entries went to the slower memory so far.
    #[must_use]
    pub const fn swaps(&self) -> u32 {
        self.swaps
    }

    /// The most bytes that all entries took so far, in both memories.
    #[must_use]
    pub const fn deepest_bytes(&self) -> u32 {
        self.deepest
    }

    #[inline(always)]
    fn push<const KIND: usize, const WORDS: usize>(&mut self, entry: [u32; WORDS]) {
        while self.capacity - self.held < WORDS {
            self.swap_out();
        }
        for (offset, word) in entry.into_iter().enumerate() {
            let place = self.place(self.held + offset);
            self.ring[place] = word;
        }
        self.held += WORDS;
        self.in_ring[KIND] += 1;
        self.deepest = self.deepest.max(4 * (self.held + self.swapped.len()) as u32);
    }

    #[inline(always)]
    fn pop<const KIND: usize, const WORDS: usize>(&mut self) -> Option<[u32; WORDS]> {
        if self.in_ring[KIND] == 0 {
            if self.in_swap[KIND] == 0 {
                return None;
            }
            self.swap_in::<KIND, WORDS>();
        }
        self.held -= WORDS;
        self.in_ring[KIND] -= 1;
        Some(std::array::from_fn(|offset| self.ring[self.place(self.held + offset)]))
    }

    /// Hands the oldest entry of the ring to the slower memory.
    #[cold]
    fn swap_out(&mut self) {
        // Those of the top level are the older ones.
        let (kind, words) =
            if self.in_ring[TOP] > 0 { (TOP, TOP_WORDS) } else { (BOTTOM, self.bottom_words) };
        for offset in 0..words {
            self.swapped.push(self.ring[self.place(offset)]);
        }
        self.first = self.place(words);
        self.held -= words;
        self.in_ring[kind] -= 1;
        self.in_swap[kind] += 1;
        self.swaps += 1;
    }

    /// Takes the youngest entry of the slower memory back. The ring is empty: what is in the slower memory is older than
    /// all that is in the ring, and is wanted only when that has gone.
    #[cold]
    fn swap_in<const KIND: usize, const WORDS: usize>(&mut self) {
        let from = self.swapped.len() - WORDS;
        for offset in 0..WORDS {
            let place = self.place(self.held + offset);
            self.ring[place] = self.swapped[from + offset];
        }
        self.swapped.truncate(from);
        self.held += WORDS;
        self.in_ring[KIND] += 1;
        self.in_swap[KIND] -= 1;
    }

    /// The place in the ring of a word, counted from the oldest.
    #[inline(always)]
    const fn place(&self, word: usize) -> usize {
        let place = self.first + word;
        if place < self.capacity { place } else { place - self.capacity }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// What a smart stack must behave like.
    #[derive(Default)]
    struct Unbounded {
        top: Vec<[u32; 2]>,
        bottom: Vec<[u32; 3]>,
    }

    /// Random walks of two levels: the top level's entries are touched only while there are none of an object. Gives back
    /// the first operation at which the two differ.
    fn differ(bytes: u32, operations: u32, seed: u64, damage: impl Fn(&mut SmartStack, u32)) -> Option<u32> {
        let mut stack = SmartStack::new(bytes);
        let mut model = Unbounded::default();
        let mut state = seed;
        let mut random = move || {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            (state >> 33) as u32
        };
        // Of the object that is being walked: 0 for none, or the words of its entries.
        let mut object = 0;
        for operation in 0..operations {
            damage(&mut stack, operation);
            let value = random();
            let wants_push = random() % 100 < 52;
            let same = match object {
                0 if random() % 4 == 0 => {
                    object = 2 + random() as usize % 2;
                    true
                }
                0 if wants_push && model.top.len() < 64 => {
                    stack.push_top([value, !value]);
                    model.top.push([value, !value]);
                    true
                }
                0 => stack.pop_top() == model.top.pop(),
                words if wants_push && model.bottom.len() < 64 => {
                    let entry = [value, !value, value ^ 5];
                    model.bottom.push(entry);
                    if words == 2 {
                        stack.push_bottom([entry[0], entry[1]]);
                    } else {
                        stack.push_bottom(entry);
                    }
                    true
                }
                words => {
                    let wanted = model.bottom.pop();
                    if wanted.is_none() {
                        object = 0;
                    }
                    if words == 2 {
                        stack.pop_bottom::<2>() == wanted.map(|[a, b, _]| [a, b])
                    } else {
                        stack.pop_bottom::<3>() == wanted
                    }
                }
            };
            let counts = (stack.top_entries(), stack.bottom_entries());
            if !same || counts != (model.top.len(), model.bottom.len()) {
                return Some(operation);
            }
        }
        None
    }

    /// A million operations for each ring from 24 to 256 bytes.
    #[test]
    fn it_is_a_stack_without_bounds() {
        for bytes in (SmartStack::LEAST_BYTES..=SmartStack::MOST_BYTES).step_by(4) {
            assert_eq!(differ(bytes, 1_000_000, u64::from(bytes), |_, _| {}), None, "{bytes} bytes");
        }
    }

    #[test]
    fn an_entry_that_comes_back_wrong_is_noticed() {
        // Once, at any time, one of the words in the slower memory is another.
        let damaged = |damage: fn(&mut SmartStack)| {
            let once = std::cell::Cell::new(false);
            differ(24, 100_000, 7, |stack, operation| {
                if operation > 1000 && stack.in_swap[BOTTOM] > 1 && !once.replace(true) {
                    damage(stack);
                }
            })
        };
        assert!(damaged(|_| {}).is_none(), "the damage is what is noticed");
        assert!(damaged(|stack| stack.swapped[0] ^= 1).is_some(), "a wrong word");
        let one_and_the_next = |stack: &mut SmartStack| {
            let end = stack.swapped.len();
            stack.swapped.swap(end - 1, end - 1 - stack.bottom_words);
        };
        assert!(damaged(one_and_the_next).is_some(), "entries in the wrong order");
        assert!(damaged(|stack| stack.in_swap[BOTTOM] -= 1).is_some(), "a lost entry");
    }

    #[test]
    fn rings_have_whole_words_within_the_limits() {
        let rounded = [0, 24, 27, 52, 256, 1000].map(SmartStack::round);
        assert_eq!(rounded, [24, 24, 24, 52, 256, 256]);
    }

    #[test]
    fn what_fits_is_not_swapped() {
        let mut stack = SmartStack::new(256);
        for entry in 0..32 {
            stack.push_top([entry, 0]);
        }
        assert_eq!((stack.swaps(), stack.deepest_bytes()), (0, 256));
        stack.push_bottom([1, 2, 3]);
        assert_eq!((stack.swaps(), stack.deepest_bytes()), (2, 268), "the two oldest make room for 12 bytes");
        assert_eq!(stack.pop_bottom::<3>(), Some([1, 2, 3]));
        for entry in (0..32).rev() {
            assert_eq!(stack.pop_top(), Some([entry, 0]));
        }
        assert_eq!(stack.pop_top(), None);
    }
}
