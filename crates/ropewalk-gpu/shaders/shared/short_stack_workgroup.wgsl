// The short stack in the memory that a workgroup shares: the ring of short_stack_private, kept beside those of the
// other invocations.
// Source: Laine 2010, section 3: on-chip memory; the twin of ropewalk's bvh/walk/short_stack.rs.
// Invariants: those of short_stack_private. Each invocation reads and writes its own places alone, and reads none that
//   it has not written, so there is no barrier and nothing need be zeroed. The same place of neighbouring invocations
//   lies side by side, so that no two of them ask the same bank. At most 16 entries of 8 bytes for 64 invocations:
//   8 KiB.

#import shared/invocation
#import shared/postponed

var<workgroup> short_stacks: array<Postponed, #{SHORT_STACK_ENTRIES} * #{WORKGROUP_SIZE}>;

struct ShortStack {
    // The place of the next push.
    next: u32,
    held: u32,
}

// Pushes, and tells how many entries are held.
fn push_short(stack: ptr<function, ShortStack>, entry: Postponed) -> u32 {
    let place = (*stack).next;
    short_stacks[place * #{WORKGROUP_SIZE}u + local_index] = entry;
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
    *entry = short_stacks[place * #{WORKGROUP_SIZE}u + local_index];
    (*stack).next = place;
    (*stack).held -= 1u;
    return true;
}
