// The short stack in the memory that a workgroup shares, beside those of the other invocations.
// Source: Laine 2010, section 3: on-chip memory; for the rest as short_stack_ring.
// Invariants: those of short_stack_ring. Each invocation reads and writes its own places alone, and reads none that
//   it has not written, so there is no barrier and nothing need be zeroed. The same place of neighbouring invocations
//   lies side by side, so that no two of them ask the same bank. At most 16 entries of 8 bytes, or 12 of cells, for
//   64 invocations: 8 KiB, or 12.

#import shared/invocation
#import shared/postponed
#import shared/short_stack_ring

var<workgroup> short_stacks: array<Postponed, #{SHORT_STACK_ENTRIES} * #{WORKGROUP_SIZE}>;

struct ShortStack {
    // The place of the next push.
    next: u32,
    held: u32,
}

fn keep_entry(stack: ptr<function, ShortStack>, place: u32, entry: Postponed) {
    short_stacks[place * #{WORKGROUP_SIZE}u + local_index] = entry;
}

fn kept_entry(stack: ptr<function, ShortStack>, place: u32) -> Postponed {
    return short_stacks[place * #{WORKGROUP_SIZE}u + local_index];
}
