//! Where things stand in the buffers of kd-trees: what `shared/kd_tree.wgsl` and `shared/kd_places.wgsl` read and the upload
//! writes.
//!
//! The first buffer is counted in pairs of words: a header of [`HEADER_PAIRS`], the nodes, one pair each, and where they fit
//! the places of all nodes, four pairs each, and the ropes of all leaves, three pairs each. The second one is counted in
//! fours of words: the triangles, three each, and then the references, one word each.
//!
//! | words of the header | hold |
//! |---|---|
//! | 0 to 2 | the lower corner of the tree's box, floats |
//! | 3 to 5 | the upper corner |
//! | 6 | the pair at which the places begin; 0 where they are left out |
//! | 7 | the pair at which the ropes begin; 0 where they are left out |
//! | 8 | the four at which the references begin |
//! | 9 | nothing |

/// Pairs of words before the first node.
pub(crate) const HEADER_PAIRS: usize = 5;
/// Words before the first node.
pub(crate) const HEADER_WORDS: usize = 2 * HEADER_PAIRS;
/// Where the tree's box stands.
pub(crate) const BOUNDS_AT: usize = 0;
/// Where the header has the place of the places and that of the ropes.
pub(crate) const PLACES_AT: usize = 6;
/// Where the header has the place of the references.
pub(crate) const REFERENCES_AT: usize = 8;
