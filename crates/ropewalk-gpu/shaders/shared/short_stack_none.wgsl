// The short stack without a place: every push is forgotten, every pop finds nothing.
// Source: Laine 2010; the twin of ropewalk's bvh/walk/short_stack.rs with a capacity of 0.
// Invariants: no memory at all. The same functions as short_stack_ring.

#import shared/postponed

struct ShortStack {
    // WGSL has no struct without a member.
    held: u32,
}

fn push_short(stack: ptr<function, ShortStack>, entry: Postponed) -> u32 {
    return 0u;
}

fn pop_short(stack: ptr<function, ShortStack>, entry: ptr<function, Postponed>) -> bool {
    return false;
}
