//! Traversal lists: bounding volume hierarchies without a stack, laid out in the order in which rays go through them
//! (Toczek, Houzet, Mancini 2010).
//!
//! A list is a hierarchy depth first: the next element of the array is a node's first child, and each element says how far
//! it is to what comes after its subtree ([`Element`]). A walk is a pointer that goes on by one, or by that much. Nothing
//! else is remembered, so any ray may begin at any element, and several lists may be walked one after the other.
//!
//! Since the order of children is fixed, there are several lists of the same hierarchy, each for the rays of some directions
//! ([`Directions`]), with the children in the order in which such rays are likely to meet them ([`ChildOrder`]), and perhaps
//! without what such rays cannot see ([`Cull`]).
//!
//! | file | concept |
//! |---|---|
//! | `element` | 20 bytes, and the special values of the escape index |
//! | `options` | what lists are made of and how |
//! | `octree` | the paper's hierarchy |
//! | `reach` | what spheres hold |
//! | `hierarchy` | any hierarchy, that of a binary tree too |
//! | `directions` | the sets of directions, and the list of a ray |
//! | `packed_box` | boxes in the room of a sphere |
//! | `vertices` | what all lists share |
//! | `cull` | what a list may leave out |
//! | `encode` | from a hierarchy to a list |
//! | `layer` | the lists of a part of the scene |
//! | `heads` | where a ray may begin of which something is known |
//! | `build` | from a scene to its lists |
//! | `update` | a scene that moved, without a new build |
//! | `validate` | the rules of the structure |
//! | `walk`, `trace` | the loop, and one ray or many |
//!
//! **Cost.** 20 bytes an element and list, of which there is one a triangle and one an inner node; besides, once for all
//! lists, 12 bytes a vertex and 24 a triangle, and 4 bytes a triangle and list with heads. An element that is visited counts
//! as one inner visit or one primitive test.
//!
//! **Invariants** of every [`TraversalList`], checked by [`TraversalList::validate`]: an inner node has at least two
//! children, and its subtree ends within the list, at the end of its parent's or before; its volume holds all volumes and
//! triangles' boxes below it (with spatial splits, the parts of these that its hierarchy put there; by [`Reach::Vertices`],
//! the vertices); the last element of a list is a triangle with the escape index 0, and no other has it; an inner node has
//! the index -1 exactly where its subtree ends with the list; the lists of a layer hold its triangles, but for those that
//! they may leave out.

mod build;
mod cull;
mod directions;
mod element;
mod encode;
pub mod heads;
mod hierarchy;
mod layer;
mod octree;
mod options;
pub mod packed_box;
mod reach;
mod trace;
mod update;
mod validate;
mod vertices;
mod walk;

pub use directions::{along, list_of};
pub use element::Element;
pub use heads::{Frustum, HeadTable, NO_HEAD, Starts};
pub use layer::Layer;
pub use options::{Bounds, ChildOrder, Clearance, Cull, Directions, Heads, ListOptions, Source};
pub use packed_box::{Grid, PackedBox};
pub use reach::Reach;
pub use update::UpdateReport;

use crate::{Aabb, BuildReport, FlatTriangle, ValidationError};
use bytemuck::{Pod, Zeroable};

/// Who a triangle is. Three little-endian words, those of [`FlatTriangle`] between its vertices.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, Eq, Pod, Zeroable)]
pub struct Identity {
    /// [`FlatTriangle::primitive`].
    pub primitive: u32,
    /// [`FlatTriangle::geometry_and_mirror`].
    pub geometry_and_mirror: u32,
    /// [`FlatTriangle::instance_and_mask`].
    pub instance_and_mask: u32,
}

impl Identity {
    pub(super) const fn of(triangle: &FlatTriangle) -> Self {
        Self {
            primitive: triangle.primitive,
            geometry_and_mirror: triangle.geometry_and_mirror,
            instance_and_mask: triangle.instance_and_mask,
        }
    }
}

/// Traversal lists over the triangles of a scene.
///
/// Triangles are numbered in the order of their instances, geometries and primitives, each once.
#[derive(Clone, Debug)]
pub struct TraversalList {
    options: ListOptions,
    /// All lists of all layers, one after the other.
    elements: Vec<Element>,
    /// Where each list begins, and where the last one ends.
    starts: Vec<u32>,
    layers: Vec<Layer>,
    vertices: Vec<[f32; 3]>,
    corners: Vec<[u32; 3]>,
    identities: Vec<Identity>,
    bounds: Aabb,
    /// The largest magnitude of any coordinate.
    largest: f32,
    heads: Option<HeadTable>,
    report: BuildReport,
}

impl TraversalList {
    /// How it was made.
    #[must_use]
    pub const fn options(&self) -> &ListOptions {
        &self.options
    }

    /// Whether triangles have one side: see [`Cull`].
    #[must_use]
    pub const fn is_one_sided(&self) -> bool {
        self.options.is_one_sided()
    }

    /// The elements of a list of the first layer. There are [`Directions::lists`] of them, in the order of [`along`].
    #[must_use]
    pub fn list(&self, list: usize) -> &[Element] {
        self.list_of_layer(0, list)
    }

    /// The elements of a list of a layer.
    #[inline(always)]
    #[must_use]
    pub fn list_of_layer(&self, layer: usize, list: usize) -> &[Element] {
        let lists = self.options.directions.lists();
        let place = layer * lists + list;
        match (self.starts.get(place), self.starts.get(place + 1)) {
            (Some(&from), Some(&to)) if list < lists => &self.elements[from as usize..to as usize],
            _ => &[],
        }
    }

    /// The elements of all lists of all layers, one after the other.
    #[must_use]
    pub fn elements(&self) -> &[Element] {
        &self.elements
    }

    /// Where each list of each layer begins among [`TraversalList::elements`], and where the last one ends.
    #[must_use]
    pub fn starts(&self) -> &[u32] {
        &self.starts
    }

    /// How many layers there are, one or two.
    #[must_use]
    pub const fn layers(&self) -> usize {
        self.layers.len()
    }

    /// A layer.
    #[must_use]
    pub fn layer(&self, layer: usize) -> Option<&Layer> {
        self.layers.get(layer)
    }

    /// The vertices that all lists share.
    #[must_use]
    pub fn vertices(&self) -> &[[f32; 3]] {
        &self.vertices
    }

    /// The three vertices of each triangle, by its number.
    #[must_use]
    pub fn corners(&self) -> &[[u32; 3]] {
        &self.corners
    }

    /// Who each triangle is, by its number, to which the fourth word of a triangle's payload leads.
    #[must_use]
    pub fn identities(&self) -> &[Identity] {
        &self.identities
    }

    /// The largest magnitude of any coordinate.
    #[must_use]
    pub const fn largest_coordinate(&self) -> f32 {
        self.largest
    }

    /// How it was built, and what came of it. `nodes` counts the elements of a list that leaves nothing out, `leaves` the
    /// triangles among them; `bytes` is everything, all lists and heads included.
    #[must_use]
    pub fn report(&self) -> &BuildReport {
        &self.report
    }

    /// Whether some triangle stands in a list more than once: see [`crate::Builder::Sbvh`].
    #[must_use]
    pub const fn has_repeats(&self) -> bool {
        self.report.references > self.report.triangles
    }

    /// The box around everything.
    #[must_use]
    pub const fn bounds(&self) -> Aabb {
        self.bounds
    }

    /// The share of places of triangles that the lists leave out, over all lists: 0 to 1.
    #[must_use]
    pub fn culled_share(&self) -> f64 {
        let places = self.report.references * self.options.directions.lists();
        let held = self.elements.iter().filter(|element| element.is_triangle()).count();
        if places == 0 { 0.0 } else { 1.0 - held as f64 / places as f64 }
    }

    /// The triangle of an element that is one.
    #[inline(always)]
    #[must_use]
    pub fn triangle(&self, element: &Element) -> FlatTriangle {
        let [a, b, c, number] = element.payload;
        self.assemble([a, b, c], number)
    }

    /// A triangle by its number, which must be below that of [`TraversalList::identities`].
    #[inline(always)]
    #[must_use]
    pub fn triangle_at(&self, number: u32) -> FlatTriangle {
        self.assemble(self.corners[number as usize], number)
    }

    #[inline(always)]
    fn assemble(&self, corners: [u32; 3], number: u32) -> FlatTriangle {
        let Identity { primitive, geometry_and_mirror, instance_and_mask } = self.identities[number as usize];
        let [v0, v1, v2] = corners.map(|corner| self.vertices[corner as usize]);
        FlatTriangle { v0, primitive, v1, geometry_and_mirror, v2, instance_and_mask }
    }

    /// The number of the triangle with these indices of instance, geometry and primitive, as [`crate::Hit::id`] gives
    /// them. `None` where there is none.
    #[must_use]
    pub fn number_of(&self, id: (u32, u32, u32)) -> Option<u32> {
        let key = |it: &Identity| {
            (it.instance_and_mask & 0x00ff_ffff, it.geometry_and_mirror & !FlatTriangle::MIRROR, it.primitive)
        };
        self.identities.binary_search_by_key(&id, key).ok().map(|number| number as u32)
    }

    /// The triangles by their numbers.
    pub fn triangles(&self) -> impl Iterator<Item = FlatTriangle> {
        (0..self.identities.len() as u32).map(|number| self.triangle_at(number))
    }

    /// Checks every rule of the structure.
    ///
    /// # Errors
    /// Names the first element that breaks one, counted over all lists.
    pub fn validate(&self) -> Result<(), ValidationError> {
        validate::validate(self)
    }
}
