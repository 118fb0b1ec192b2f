// The short stack as a ring that keeps the youngest entries and drops the oldest.
// Source: Horn et al. 2007, Laine 2010; the twin of ropewalk's bvh/walk/short_stack.rs. Where a place of the ring lies is
//   the matter of short_stack_private and short_stack_workgroup, by keep_entry and kept_entry.
// Invariants: zero-filled, it is empty. next < SHORT_STACK_ENTRIES and held <= SHORT_STACK_ENTRIES always.
//   The ring has exactly as many places as entries, since its memory is what limits a GPU, and wraps by a comparison:
//   two instructions for any size, where a remainder by a constant that is no power of two takes a wide
//   multiplication, a shift and a multiplication more.

#import shared/postponed

// Pushes, and tells how many entries are held.
fn push_short(stack: ptr<function, ShortStack>, entry: Postponed) -> u32 {
    let place = (*stack).next;
    keep_entry(stack, place, entry);
    (*stack).next = select(place + 1u, 0u, place == #{SHORT_STACK_ENTRIES}u - 1u);
    (*stack).held = min((*stack).held + 1u, #{SHORT_STACK_ENTRIES}u);
    return (*stack).held;
}

// Takes the youngest entry. False when the stack is exhausted.
fn pop_short(stack: ptr<function, ShortStack>, entry: ptr<function, Postponed>) -> bool {
    if (*stack).held == 0u {
        return false;
    }
    let place = select((*stack).next, #{SHORT_STACK_ENTRIES}u, (*stack).next == 0u) - 1u;
    *entry = kept_entry(stack, place);
    (*stack).next = place;
    (*stack).held -= 1u;
    return true;
}
