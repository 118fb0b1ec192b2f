// The trail of a binary tree as the paper's figure 2 words it, a bit a level, for trees of any depth that a structure
// may have: the reference of the registers.
// Source: Laine 2010, figure 2; the twin of ArrayTrail in ropewalk's bvh/walk/restart_trail.rs.
// Invariants: level 0 is the sentinel; levels go to 64, the largest depth of a structure, so 65 bits in three words. The
//   same functions as trail_u32.

struct Trail {
    // Bit `level % 32` of word `level / 32`.
    bits: array<u32, 3>,
    level: u32,
    // The levels at which the far child's turn has come, likewise.
    far: array<u32, 3>,
}

fn new_trail() -> Trail {
    return Trail(array<u32, 3>(0u, 0u, 0u), 0u, array<u32, 3>(0u, 0u, 0u));
}

fn descend(trail: ptr<function, Trail>) {
    (*trail).level += 1u;
}

fn is_near_done(trail: ptr<function, Trail>) -> bool {
    let level = (*trail).level;
    return (((*trail).bits[level / 32u] >> (level % 32u)) & 1u) != 0u;
}

fn set_single(trail: ptr<function, Trail>) {
    let level = (*trail).level;
    (*trail).bits[level / 32u] |= 1u << (level % 32u);
}

fn is_far_level(trail: ptr<function, Trail>) -> bool {
    let level = (*trail).level;
    return (((*trail).far[level / 32u] >> (level % 32u)) & 1u) != 0u;
}

fn finish_trail(trail: ptr<function, Trail>) -> bool {
    while (*trail).level > 0u && is_near_done(trail) {
        (*trail).level -= 1u;
    }
    let level = (*trail).level;
    // Nothing has been visited of the next branch: the levels below are cleared.
    for (var word = level / 32u + 1u; word < 3u; word += 1u) {
        (*trail).bits[word] = 0u;
        (*trail).far[word] = 0u;
    }
    let bit = 1u << (level % 32u);
    (*trail).bits[level / 32u] = ((*trail).bits[level / 32u] & (bit - 1u)) | bit;
    (*trail).far[level / 32u] = ((*trail).far[level / 32u] & (bit - 1u)) | bit;
    return level > 0u;
}

fn restart_trail(trail: ptr<function, Trail>) {
    (*trail).level = 0u;
}
