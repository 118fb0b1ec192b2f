//! The short stack (Horn et al. 2007, Laine 2010): a ring that keeps the youngest entries and drops the oldest.

/// The youngest `capacity` of all entries that were pushed: one for which there is no room drops the oldest.
///
/// The ring has `ROOM` places, a power of two, so that the capacity may be known only at run time and no place needs a
/// division.
#[derive(Clone, Copy)]
pub(crate) struct ShortStack<E, const ROOM: usize> {
    ring: [E; ROOM],
    /// Pushed minus popped; its low bits are the place of the next push.
    next: usize,
    held: usize,
    capacity: usize,
}

impl<E: Copy + Default, const ROOM: usize> ShortStack<E, ROOM> {
    const WRAP: usize = {
        assert!(ROOM.is_power_of_two());
        ROOM - 1
    };

    /// An empty stack of at most `min(capacity, ROOM)` entries.
    #[inline(always)]
    pub(crate) fn new(capacity: usize) -> Self {
        Self { ring: [E::default(); ROOM], next: 0, held: 0, capacity: capacity.min(ROOM) }
    }

    /// Pushes, and tells how many entries are held: none where there is no room at all.
    #[inline(always)]
    pub(crate) fn push(&mut self, entry: E) -> usize {
        self.ring[self.next & Self::WRAP] = entry;
        self.next = self.next.wrapping_add(1);
        self.held = (self.held + 1).min(self.capacity);
        self.held
    }

    /// The youngest entry, or `None` where the stack is exhausted.
    #[inline(always)]
    pub(crate) fn pop(&mut self) -> Option<E> {
        if self.held == 0 {
            return None;
        }
        self.held -= 1;
        self.next = self.next.wrapping_sub(1);
        Some(self.ring[self.next & Self::WRAP])
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Against a list that drops its first element when it grows too long.
    #[test]
    fn it_keeps_the_youngest() {
        for capacity in 0..=16usize {
            let mut stack = ShortStack::<u32, 16>::new(capacity);
            let mut model: Vec<u32> = Vec::new();
            let mut state = 1u32;
            for step in 0..1000 {
                state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
                if state >> 30 != 0 {
                    model.push(step);
                    if model.len() > capacity {
                        model.remove(0);
                    }
                    assert_eq!(stack.push(step), model.len());
                } else {
                    assert_eq!(stack.pop(), model.pop());
                }
            }
        }
    }
}
