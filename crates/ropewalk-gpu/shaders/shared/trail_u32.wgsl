// The trail of a binary tree in 32-bit registers, for trees of depth 31: the sentinel is the top bit, each level the
// next lower one.
// Source: Laine 2010, section 2.1, with both formulas corrected; the twin of TrailU32 in ropewalk's
//   bvh/walk/restart_trail.rs, which says what is wrong with the printed ones.
// Invariants: level is one bit; far has the levels at which the far child's turn has come. The same functions as
//   trail_u64 and trail_array. finish_trail makes the trail larger, as a number, so no walk returns to where it was.

struct Trail {
    bits: u32,
    level: u32,
    far: u32,
}

// Nothing done, at the root.
fn new_trail() -> Trail {
    return Trail(0u, 0x80000000u, 0u);
}

// Goes down to a child. To be called before the bit of the node is asked or set.
fn descend(trail: ptr<function, Trail>) {
    (*trail).level >>= 1u;
}

// Whether the near child of the node that was left by the last descend is finished.
fn is_near_done(trail: ptr<function, Trail>) -> bool {
    return ((*trail).bits & (*trail).level) != 0u;
}

// Notes that the node has one child to visit.
fn set_single(trail: ptr<function, Trail>) {
    (*trail).bits |= (*trail).level;
}

// Whether a pop led to the far child at this level: the near one is finished.
fn is_far_level(trail: ptr<function, Trail>) -> bool {
    return ((*trail).far & (*trail).level) != 0u;
}

// Notes that the current node is finished, and goes up to the level of the next one; whether there is one.
fn finish_trail(trail: ptr<function, Trail>) -> bool {
    let level = (*trail).level;
    // Clears the levels below, and carries through the ones above to the next zero.
    let bits = ((*trail).bits & (0u - level)) + level;
    (*trail).bits = bits;
    let next = bits & (0u - bits);
    (*trail).level = next;
    (*trail).far = ((*trail).far & (0u - next)) | next;
    return (bits & 0x80000000u) == 0u;
}

// Goes to the root, to be led down again.
fn restart_trail(trail: ptr<function, Trail>) {
    (*trail).level = 0x80000000u;
}
