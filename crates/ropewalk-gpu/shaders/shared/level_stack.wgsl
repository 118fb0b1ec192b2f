// The stack of both levels in the memory of the invocation: entries of the top level, and above them those of an object.
// Source: as shared/levels.
// Invariants: zero-filled, it is empty. floor <= held <= STACK_ENTRIES. The same functions as smart_stack.

#import shared/postponed

struct LevelStack {
    entries: array<Postponed, #{STACK_ENTRIES}>,
    held: u32,
    // Entries of the top level while the ray is in an object; else 0.
    floor: u32,
}

// What comes now is of an object; its entries have three words, or two.
fn begin_object(stack: ptr<function, LevelStack>, has_cells: bool) {
    (*stack).floor = (*stack).held;
}

// What comes now is of the top level. There must be nothing left of the object.
fn end_object(stack: ptr<function, LevelStack>) {
    (*stack).floor = 0u;
}

// Pushes, of the level that the ray is in. False when there is no room.
fn push_level(stack: ptr<function, LevelStack>, entry: Postponed) -> bool {
    let place = (*stack).held;
    if place == #{STACK_ENTRIES}u {
        return false;
    }
    (*stack).entries[place] = entry;
    (*stack).held = place + 1u;
    return true;
}

// Takes the youngest entry of the level that the ray is in. False when there is none.
fn pop_level(stack: ptr<function, LevelStack>, entry: ptr<function, Postponed>) -> bool {
    if (*stack).held == (*stack).floor {
        return false;
    }
    (*stack).held -= 1u;
    *entry = (*stack).entries[(*stack).held];
    return true;
}

// How many entries of the level that the ray is in there are.
fn held_of_level(stack: ptr<function, LevelStack>) -> u32 {
    return (*stack).held - (*stack).floor;
}
