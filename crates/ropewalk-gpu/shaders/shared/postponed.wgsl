// A child that waits: two words, the entry of every stack; with CELLS three.
// Source: the twin of Entry in ropewalk's bvh/walk/ordered.rs, with CELLS of that in kd_tree/walk.
// Invariants: what is culled behind `entry` holds nothing that is nearer.

struct Postponed {
    // A binary tree's node; a wide one's record, with the mark of the last sibling in the top bit.
    node: u32,
    // Where the seeker enters its box, or its cell.
    entry: f32,
#ifdef CELLS
    // Where the ray leaves its cell, at most the limit of the time.
    exit: f32,
#endif
}
