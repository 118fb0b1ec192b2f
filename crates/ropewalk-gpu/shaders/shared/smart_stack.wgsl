// The smart stack: one ring of bytes for the stacks of both levels, in the memory that a workgroup shares, which hands its
// oldest entries to the memory of the invocation when it is full and takes the youngest of them back when it is empty.
// Source: Reichl et al. 2010, section 4.3; the twin of ropewalk's two_level/smart_stack.rs, entry for entry.
// Invariants: an object's entries lie above the top level's, and are used up before these are wanted. Zero-filled, it is empty.
//   Each invocation reads and writes its own places alone, and reads none that it has not written, so there is no barrier and
//   nothing need be zeroed. At most 64 words for 64 invocations: 16 KiB. The same functions as level_stack.

#import shared/invocation
#import shared/postponed

var<workgroup> smart_rings: array<u32, #{RING_WORDS} * #{WORKGROUP_SIZE}>;

// Room for all entries, if each had three words.
const SWAP_WORDS: u32 = 3u * #{STACK_ENTRIES}u;

struct LevelStack {
    swapped: array<u32, 3 * #{STACK_ENTRIES}>,
    swapped_words: u32,
    // The place of the oldest word of the ring, and how many words it holds.
    first: u32,
    held: u32,
    // Entries in the ring and in the other memory: of the top level, and of an object.
    top_in_ring: u32,
    bottom_in_ring: u32,
    top_in_swap: u32,
    bottom_in_swap: u32,
    // Words of an object's entry while the ray is in one; else 0.
    bottom_words: u32,
}

fn begin_object(stack: ptr<function, LevelStack>, has_cells: bool) {
    (*stack).bottom_words = select(2u, 3u, has_cells);
}

fn end_object(stack: ptr<function, LevelStack>) {
    (*stack).bottom_words = 0u;
}

fn held_of_level(stack: ptr<function, LevelStack>) -> u32 {
    if (*stack).bottom_words == 0u {
        return (*stack).top_in_ring + (*stack).top_in_swap;
    }
    return (*stack).bottom_in_ring + (*stack).bottom_in_swap;
}

// Where the word of the ring is that comes so many after the oldest.
fn ring_place(stack: ptr<function, LevelStack>, word: u32) -> u32 {
    let place = (*stack).first + word;
    return select(place, place - #{RING_WORDS}u, place >= #{RING_WORDS}u) * #{WORKGROUP_SIZE}u + local_index;
}

// Hands the oldest entry of the ring to the other memory. False where that is full.
fn swap_out(stack: ptr<function, LevelStack>) -> bool {
    // Those of the top level are the older ones.
    let is_top = (*stack).top_in_ring > 0u;
    let words = select((*stack).bottom_words, 2u, is_top);
    if (*stack).swapped_words + words > SWAP_WORDS {
        return false;
    }
#repeat WORD 3
    if #{WORD}u < words {
        (*stack).swapped[(*stack).swapped_words + #{WORD}u] = smart_rings[ring_place(stack, #{WORD}u)];
    }
#endrepeat
    (*stack).swapped_words += words;
    let first = (*stack).first + words;
    (*stack).first = select(first, first - #{RING_WORDS}u, first >= #{RING_WORDS}u);
    (*stack).held -= words;
    if is_top {
        (*stack).top_in_ring -= 1u;
        (*stack).top_in_swap += 1u;
    } else {
        (*stack).bottom_in_ring -= 1u;
        (*stack).bottom_in_swap += 1u;
    }
    return true;
}

// Takes the youngest entry of the other memory back, which has so many words and is of the level that the ray is in. Nothing of
// that level is in the ring, and nothing of any other.
fn swap_in(stack: ptr<function, LevelStack>, words: u32) {
    (*stack).swapped_words -= words;
#repeat WORD 3
    if #{WORD}u < words {
        smart_rings[ring_place(stack, (*stack).held + #{WORD}u)] =
            (*stack).swapped[(*stack).swapped_words + #{WORD}u];
    }
#endrepeat
    (*stack).held += words;
    if (*stack).bottom_words == 0u {
        (*stack).top_in_ring += 1u;
        (*stack).top_in_swap -= 1u;
    } else {
        (*stack).bottom_in_ring += 1u;
        (*stack).bottom_in_swap -= 1u;
    }
}

fn push_level(stack: ptr<function, LevelStack>, entry: Postponed) -> bool {
    let words = select((*stack).bottom_words, 2u, (*stack).bottom_words == 0u);
    // Three words need the room of two entries of two at most. Written out, as drivers count loops.
#repeat SWAP 2
    if #{RING_WORDS}u - (*stack).held < words && !swap_out(stack) {
        return false;
    }
#endrepeat
    smart_rings[ring_place(stack, (*stack).held)] = entry.node;
    smart_rings[ring_place(stack, (*stack).held + 1u)] = bitcast<u32>(entry.entry);
#ifdef CELLS
    if words == 3u {
        smart_rings[ring_place(stack, (*stack).held + 2u)] = bitcast<u32>(entry.exit);
    }
#endif
    (*stack).held += words;
    if (*stack).bottom_words == 0u {
        (*stack).top_in_ring += 1u;
    } else {
        (*stack).bottom_in_ring += 1u;
    }
    return true;
}

fn pop_level(stack: ptr<function, LevelStack>, entry: ptr<function, Postponed>) -> bool {
    let of_top = (*stack).bottom_words == 0u;
    let words = select((*stack).bottom_words, 2u, of_top);
    let in_ring = select((*stack).bottom_in_ring, (*stack).top_in_ring, of_top);
    if in_ring == 0u {
        if select((*stack).bottom_in_swap, (*stack).top_in_swap, of_top) == 0u {
            return false;
        }
        swap_in(stack, words);
    }
    (*stack).held -= words;
    if of_top {
        (*stack).top_in_ring -= 1u;
    } else {
        (*stack).bottom_in_ring -= 1u;
    }
    (*entry).node = smart_rings[ring_place(stack, (*stack).held)];
    (*entry).entry = bitcast<f32>(smart_rings[ring_place(stack, (*stack).held + 1u)]);
#ifdef CELLS
    if words == 3u {
        (*entry).exit = bitcast<f32>(smart_rings[ring_place(stack, (*stack).held + 2u)]);
    }
#endif
    return true;
}
