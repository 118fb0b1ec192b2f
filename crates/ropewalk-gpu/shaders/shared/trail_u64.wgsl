// The trail of a binary tree in 64 bits, each two words, for trees of depth 63: the sentinel is the top bit, each level
// the next lower one. WGSL has no 64-bit integers that are portable.
// Source: Laine 2010, section 2.1, with both formulas corrected; the twin of TrailU64 in ropewalk's
//   bvh/walk/restart_trail.rs.
// Invariants: those of trail_u32. x holds the upper 32 bits, y the lower ones.

struct Trail {
    bits: vec2<u32>,
    level: vec2<u32>,
    far: vec2<u32>,
}

// Zero minus a number.
fn negated(number: vec2<u32>) -> vec2<u32> {
    return vec2<u32>(~number.x + u32(number.y == 0u), 0u - number.y);
}

// The sum, modulo 2^64.
fn sum(a: vec2<u32>, b: vec2<u32>) -> vec2<u32> {
    let low = a.y + b.y;
    return vec2<u32>(a.x + b.x + u32(low < a.y), low);
}

fn new_trail() -> Trail {
    return Trail(vec2<u32>(0u), vec2<u32>(0x80000000u, 0u), vec2<u32>(0u));
}

fn descend(trail: ptr<function, Trail>) {
    let level = (*trail).level;
    (*trail).level = vec2<u32>(level.x >> 1u, (level.y >> 1u) | (level.x << 31u));
}

fn is_near_done(trail: ptr<function, Trail>) -> bool {
    return any(((*trail).bits & (*trail).level) != vec2<u32>(0u));
}

fn set_single(trail: ptr<function, Trail>) {
    (*trail).bits |= (*trail).level;
}

fn is_far_level(trail: ptr<function, Trail>) -> bool {
    return any(((*trail).far & (*trail).level) != vec2<u32>(0u));
}

fn finish_trail(trail: ptr<function, Trail>) -> bool {
    let level = (*trail).level;
    let bits = sum((*trail).bits & negated(level), level);
    (*trail).bits = bits;
    let next = bits & negated(bits);
    (*trail).level = next;
    (*trail).far = ((*trail).far & negated(next)) | next;
    return (bits.x & 0x80000000u) == 0u;
}

fn restart_trail(trail: ptr<function, Trail>) {
    (*trail).level = vec2<u32>(0x80000000u, 0u);
}
