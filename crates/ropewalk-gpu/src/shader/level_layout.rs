//! Where things stand in the buffers of two-level structures: what `shared/levels.wgsl` reads and the upload writes.
//!
//! Places are counted in fours of words, 16 bytes, from the beginning of their buffer. The first buffer has a header, a record
//! of [`OBJECT_FOURS`] for each object, the nodes of all objects, and behind them what changes from frame to frame: the nodes of
//! the top level, what each of its leaves leads to, two fours each, and the instances, six fours each. The second one has
//! the triangles of each object, three fours each, and behind those of a kd-tree its references, one word each.
//!
//! | words of the header | hold |
//! |---|---|
//! | 0 | the place of the top level's first node, in pairs of fours |
//! | 1 | the four at which begins what the leaves lead to |
//! | 2 | the four at which the instances begin |
//! | 3, 4 | by what share rays are wider for the top level, and the largest coordinate of its box, floats |
//! | 5 to 7 | nothing |
//!
//! | words of what a leaf leads to | hold |
//! |---|---|
//! | 0 to 2, 4 to 6 | the corners of the part of the object, floats |
//! | 3 | the place of the instance |
//! | 7 | the node of the object's structure at which rays begin |
//!
//! | words of an object | hold |
//! |---|---|
//! | 0 to 2, 4 to 6 | the corners of its box, floats |
//! | 3 | its structure: [`BVH`], [`KD_TREE`], [`WIDE_BVH`] or [`LIST`] |
//! | 7 | the place of its first node: of a BVH in pairs of fours, of a wide one in wide nodes, of a kd-tree in fours; of lists that of their header, in fours |
//! | 8 | the place of its first triangle, or of its lists' first vertex, in threes of fours |
//! | 9 | of a kd-tree: the four at which its references begin |
//! | 10, 11 | nothing |

/// Fours of words before the first object.
pub(crate) const HEADER_FOURS: usize = 2;
/// Fours of words an object.
pub(crate) const OBJECT_FOURS: usize = 3;
/// An object whose structure is a binary BVH.
pub(crate) const BVH: u32 = 1;
/// An object whose structure is a kd-tree.
pub(crate) const KD_TREE: u32 = 2;
/// An object whose structure is a wide BVH.
pub(crate) const WIDE_BVH: u32 = 3;
/// An object whose structure is traversal lists, laid out as [`super::list_layout`] says.
pub(crate) const LIST: u32 = 4;
