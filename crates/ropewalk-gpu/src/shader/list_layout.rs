//! Where things stand in the buffers of traversal lists: what `shared/list.wgsl` reads and the upload writes.
//!
//! The first buffer has a header and then the elements of all lists of all layers, each as
//! [`ropewalk::traversal_list::Element`] has it. The second has the vertices and then the identities.
//!
//! | words of the header | hold |
//! |---|---|
//! | 0 | the number of layers |
//! | 1 | lists a layer |
//! | 2 | the word of the second buffer at which the identities begin |
//! | 3 | the number of triangles |
//! | 4 | the largest magnitude of a vertex's coordinate, a float |
//! | from [`LAYERS_AT`] on, [`LAYER_WORDS`] a layer | the place of the first element of each of 8 lists, or [`NO_ELEMENT`]; then the grid's origin and step, three floats each |

/// Words before the first element.
pub(crate) const HEADER_WORDS: usize = 80;
/// Where the first layer's words begin.
pub(crate) const LAYERS_AT: usize = 8;
/// Words a layer. Four are left over.
pub(crate) const LAYER_WORDS: usize = 18;
/// Where a layer's words have its grid.
pub(crate) const GRID_AT: usize = 8;
/// The layers that the header has room for.
pub(crate) const MOST_LAYERS: usize = (HEADER_WORDS - LAYERS_AT) / LAYER_WORDS;
/// The place of the first element of an empty list.
pub(crate) const NO_ELEMENT: u32 = u32::MAX;
