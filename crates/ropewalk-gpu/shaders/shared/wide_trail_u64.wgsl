// The trail of a wide tree in two words, for 16 levels of inner nodes: four bits a level, the number of finished children
// and, in the top bit, whether no sibling comes after the one in progress.
// Source: the generalised trail of Laine 2010, section 4, as ropewalk's wide_bvh/walk has it.
// Invariants: level 0, the root, is the lowest nibble of x; level 8 that of y. A count grows only while a sibling is
//   left, so seven is the most and nothing is carried into the top bit. The same functions as wide_trail_array.

struct Trail {
    bits: vec2<u32>,
}

// The top bits of all levels.
const LAST_BITS: u32 = 0x88888888u;

// The bits of a word's levels from the first to this one, 0 to 7.
fn up_to(level: u32) -> u32 {
    return 0xffffffffu >> (28u - 4u * level);
}

fn nibble(trail: ptr<function, Trail>, level: u32) -> u32 {
    return (select((*trail).bits.x, (*trail).bits.y, level >= 8u) >> (4u * (level % 8u))) & 0xfu;
}

// Nothing done.
fn new_trail() -> Trail {
    return Trail(vec2<u32>(0u));
}

// How many children of the node at this level are finished.
fn finished_children(trail: ptr<function, Trail>, level: u32) -> u32 {
    return nibble(trail, level) & 7u;
}

// Notes that the child in progress of the node at this level is its last.
fn set_last(trail: ptr<function, Trail>, level: u32) {
    let bit = 8u << (4u * (level % 8u));
    (*trail).bits |= select(vec2<u32>(bit, 0u), vec2<u32>(0u, bit), level >= 8u);
}

// Notes that the node at this level is finished. The level of the next one, which is the next child of the deepest
// ancestor that has one left; 0 when there is none.
fn finish_trail(trail: ptr<function, Trail>, level: u32) -> u32 {
    if level == 0u {
        return 0u;
    }
    let parent = level - 1u;
    let bits = (*trail).bits;
    if parent >= 8u {
        let open = ~bits.y & LAST_BITS & up_to(parent - 8u);
        if open != 0u {
            let ancestor = firstLeadingBit(open) / 4u;
            (*trail).bits.y = (bits.y & up_to(ancestor)) + (1u << (4u * ancestor));
            return ancestor + 9u;
        }
    }
    let open = ~bits.x & LAST_BITS & up_to(min(parent, 7u));
    if open == 0u {
        return 0u;
    }
    let ancestor = firstLeadingBit(open) / 4u;
    (*trail).bits = vec2<u32>((bits.x & up_to(ancestor)) + (1u << (4u * ancestor)), 0u);
    return ancestor + 1u;
}
