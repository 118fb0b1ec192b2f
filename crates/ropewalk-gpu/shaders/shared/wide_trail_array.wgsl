// The trail of a wide tree in an array, for any depth that a structure may have: four bits a level, the number of
// finished children and, in the top bit, whether no sibling comes after the one in progress.
// Source: the generalised trail of Laine 2010, section 4, as ropewalk's wide_bvh/walk has it.
// Invariants: 64 levels of inner nodes, eight a word, level 0 in the lowest bits of word 0. A count grows only while a
//   sibling is left, so seven is the most and nothing is carried into the top bit. The same functions as
//   wide_trail_u64.

struct Trail {
    bits: array<u32, 8>,
}

// The top bits of all levels of a word.
const LAST_BITS: u32 = 0x88888888u;

// The bits of a word's levels from the first to this one, 0 to 7.
fn up_to(level: u32) -> u32 {
    return 0xffffffffu >> (28u - 4u * level);
}

// Nothing done.
fn new_trail() -> Trail {
    return Trail(array<u32, 8>(0u, 0u, 0u, 0u, 0u, 0u, 0u, 0u));
}

// How many children of the node at this level are finished.
fn finished_children(trail: ptr<function, Trail>, level: u32) -> u32 {
    return ((*trail).bits[level / 8u] >> (4u * (level % 8u))) & 7u;
}

// Notes that the child in progress of the node at this level is its last.
fn set_last(trail: ptr<function, Trail>, level: u32) {
    (*trail).bits[level / 8u] |= 8u << (4u * (level % 8u));
}

// Notes that the node at this level is finished. The level of the next one, which is the next child of the deepest
// ancestor that has one left; 0 when there is none.
fn finish_trail(trail: ptr<function, Trail>, level: u32) -> u32 {
    if level == 0u {
        return 0u;
    }
    let parent = level - 1u;
    var word = parent / 8u;
    var open = ~(*trail).bits[word] & LAST_BITS & up_to(parent % 8u);
    while open == 0u {
        if word == 0u {
            return 0u;
        }
        word -= 1u;
        open = ~(*trail).bits[word] & LAST_BITS;
    }
    let ancestor = firstLeadingBit(open) / 4u;
    // What was known of the levels below is forgotten, those below the finished node too: a hit may have culled what
    // the walk was in.
    (*trail).bits[word] = ((*trail).bits[word] & up_to(ancestor)) + (1u << (4u * ancestor));
    for (var below = word + 1u; below < 8u; below += 1u) {
        (*trail).bits[below] = 0u;
    }
    return 8u * word + ancestor + 1u;
}
