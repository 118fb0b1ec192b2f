// A child that waits: two words, the entry of every stack.
// Source: the twin of Entry in ropewalk's bvh/walk/ordered.rs.
// Invariants: what is culled behind `entry` holds nothing that is nearer.

struct Postponed {
    // A binary tree's node; a wide one's record, with the mark of the last sibling in the top bit.
    node: u32,
    // Where the seeker enters its box.
    entry: f32,
}
