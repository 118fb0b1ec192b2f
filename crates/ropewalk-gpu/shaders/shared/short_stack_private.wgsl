// The short stack in the memory of the invocation.
// Source: as short_stack_ring.
// Invariants: those of short_stack_ring.

#import shared/postponed
#import shared/short_stack_ring

struct ShortStack {
    ring: array<Postponed, #{SHORT_STACK_ENTRIES}>,
    // The place of the next push.
    next: u32,
    held: u32,
}

fn keep_entry(stack: ptr<function, ShortStack>, place: u32, entry: Postponed) {
    (*stack).ring[place] = entry;
}

fn kept_entry(stack: ptr<function, ShortStack>, place: u32) -> Postponed {
    return (*stack).ring[place];
}
