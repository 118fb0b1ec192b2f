//! Traversal lists: bounding volume hierarchies without a stack, laid out in the order in which rays go through them
//! (Toczek, Houzet, Mancini 2010).
//!
//! A list is a hierarchy depth first: the next element of the array is a node's first child, and each element says how far
//! it is to what comes after its subtree ([`Element`]). A walk is a pointer that goes on by one, or by that much. Nothing
//! else is remembered, so any ray may begin at any element, and several lists may be walked one after the other.
//!
//! Since the order of children is fixed, there are several lists of the same hierarchy, each for the rays of some directions
//! ([`Directions`]), with the children in the order in which such rays are likely to meet them ([`ChildOrder`]).
//!
//! | file | concept |
//! |---|---|
//! | `element` | 20 bytes, and the special values of the escape index |
//! | `options` | what lists are made of and how |
//! | `octree` | the paper's hierarchy |
//! | `hierarchy` | any hierarchy, that of a binary tree too |
//! | `directions` | the sets of directions, and the list of a ray |
//! | `packed_box` | boxes in the room of a sphere |
//! | `encode` | from a hierarchy to a list |
//! | `validate` | the rules of the structure |
//! | `walk` | the loop |
//!
//! **Cost.** 20 bytes an element and list, of which there is one a triangle and one an inner node; besides, once for all
//! lists, 12 bytes a vertex and 12 a triangle. An element that is visited counts as one inner visit or one primitive test.
//!
//! **Invariants** of every [`TraversalList`], checked by [`TraversalList::validate`]: an inner node has a child, and its
//! subtree ends within the list, at the end of its parent's or before; its volume holds all volumes and triangles' boxes
//! below it (with spatial splits, the parts of these that its hierarchy put there); the last element is a triangle with the
//! escape index 0, and no other has it; an inner node has the index -1 exactly where its subtree ends with the list;
//! all lists hold the same triangles.

mod directions;
mod element;
mod encode;
mod hierarchy;
mod octree;
mod options;
pub mod packed_box;
mod validate;
mod walk;

pub use directions::{along, list_of};
pub use element::Element;
pub use options::{Bounds, ChildOrder, Directions, ListOptions, Source};
pub use packed_box::{Grid, PackedBox};

use crate::clock::Clock;
use crate::parallel::map_chunks;
use crate::progress::Progress;
use crate::{
    Aabb, BuildError, BuildReport, FlatScene, FlatTriangle, Monitor, NoMonitor, Scene, ValidationError,
};
use bytemuck::{Pod, Zeroable};
use encode::Encoder;
use glam::Vec3;
use hierarchy::Child;
use std::collections::HashMap;

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

/// Traversal lists over the triangles of a scene.
#[derive(Clone, Debug)]
pub struct TraversalList {
    options: ListOptions,
    /// All lists, one after the other.
    elements: Vec<Element>,
    /// Where each list begins, and where the last one ends.
    starts: Vec<u32>,
    vertices: Vec<[f32; 3]>,
    identities: Vec<Identity>,
    bounds: Aabb,
    grid: Grid,
    report: BuildReport,
}

impl TraversalList {
    /// How it was made.
    #[must_use]
    pub const fn options(&self) -> &ListOptions {
        &self.options
    }

    /// The elements of a list. There are [`Directions::lists`] of them, in the order of [`along`].
    #[must_use]
    pub fn list(&self, list: usize) -> &[Element] {
        match (self.starts.get(list), self.starts.get(list + 1)) {
            (Some(&from), Some(&to)) => &self.elements[from as usize..to as usize],
            _ => &[],
        }
    }

    /// The vertices that all lists share, each position once.
    #[must_use]
    pub fn vertices(&self) -> &[[f32; 3]] {
        &self.vertices
    }

    /// Who each triangle is: what the fourth word of a triangle's payload leads to. As many as there are references.
    #[must_use]
    pub fn identities(&self) -> &[Identity] {
        &self.identities
    }

    /// The grid of the boxes.
    #[must_use]
    pub const fn grid(&self) -> &Grid {
        &self.grid
    }

    /// How it was built, and what came of it. `nodes` counts the elements of one list, `leaves` the triangles among them;
    /// `bytes` is everything, all lists included.
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

    /// The triangle of an element that is one.
    #[inline(always)]
    #[must_use]
    pub fn triangle(&self, element: &Element) -> FlatTriangle {
        let [a, b, c, identity] = element.payload.map(|word| word as usize);
        let Identity { primitive, geometry_and_mirror, instance_and_mask } = self.identities[identity];
        FlatTriangle {
            v0: self.vertices[a],
            primitive,
            v1: self.vertices[b],
            geometry_and_mirror,
            v2: self.vertices[c],
            instance_and_mask,
        }
    }

    /// The triangles, in the order of the first list.
    pub fn triangles(&self) -> impl Iterator<Item = FlatTriangle> {
        self.list(0).iter().filter(|element| element.is_triangle()).map(|element| self.triangle(element))
    }

    /// Checks every rule of the structure.
    ///
    /// # Errors
    /// Names the first element that breaks one, counted over all lists.
    pub fn validate(&self) -> Result<(), ValidationError> {
        validate::validate(self)
    }

    fn encode(
        options: &ListOptions,
        root: Option<&Child>,
        triangles: &[FlatTriangle],
        report: BuildReport,
    ) -> Result<Self, BuildError> {
        let bounds =
            triangles.iter().map(|triangle| triangle.triangle().bounds()).fold(Aabb::EMPTY, Aabb::union);
        let grid = Grid::over(&bounds);
        let (vertices, corners) = share_vertices(triangles);
        let directions = along(options.directions);
        let lists: Vec<Vec<Element>> = map_chunks(&directions, 1, |_, directions| {
            let of = |&along: &Vec3| {
                let (bounds, order) = (options.bounds, options.order);
                let encoder = Encoder { triangles, corners: &corners, bounds, grid: &grid, along, order };
                root.map_or_else(Vec::new, |root| encoder.encode(root))
            };
            directions.iter().flat_map(of).collect()
        });
        let one = lists.first().map_or(0, Vec::len);
        let all = one * lists.len();
        let limit = i32::MAX as usize;
        if all > limit {
            return Err(BuildError::TooMany { what: "elements of all lists", count: all, limit });
        }
        let starts = (0..=lists.len()).map(|list| (list * one) as u32).collect();
        let identity = |triangle: &FlatTriangle| Identity {
            primitive: triangle.primitive,
            geometry_and_mirror: triangle.geometry_and_mirror,
            instance_and_mask: triangle.instance_and_mask,
        };
        let mut this = Self {
            options: *options,
            elements: lists.concat(),
            starts,
            vertices,
            identities: triangles.iter().map(identity).collect(),
            bounds,
            grid,
            report,
        };
        this.report.nodes = one;
        this.report.leaves = triangles.len();
        this.report.largest_leaf = u32::from(!triangles.is_empty());
        this.report.depth = root.map_or(0, depth);
        this.report.sah_cost = root.map_or(0.0, cost);
        this.report.bytes = size_of_val(this.elements.as_slice())
            + size_of_val(this.vertices.as_slice())
            + size_of_val(this.identities.as_slice());
        Ok(this)
    }
}

/// The positions of all vertices, each once, and for each triangle which are its own. By bits: 0 and -0 stay what they are.
fn share_vertices(triangles: &[FlatTriangle]) -> (Vec<[f32; 3]>, Vec<[u32; 3]>) {
    let mut places: HashMap<[u32; 3], u32> = HashMap::with_capacity(triangles.len());
    let mut vertices = Vec::new();
    let mut place = |vertex: [f32; 3]| {
        *places.entry(vertex.map(f32::to_bits)).or_insert_with(|| {
            vertices.push(vertex);
            vertices.len() as u32 - 1
        })
    };
    let corners = triangles.iter().map(|it| [it.v0, it.v1, it.v2].map(&mut place)).collect();
    (vertices, corners)
}

/// The depth of the deepest triangle below.
fn depth(child: &Child) -> u32 {
    match child {
        Child::Triangle(_) => 0,
        Child::Group(group) => 1 + group.children.iter().map(depth).max().unwrap_or(0),
    }
}

/// What a random ray through the root costs by the surface area heuristic, by boxes: 1 for each element that it tests.
fn cost(root: &Child) -> f64 {
    fn weighted(child: &Child) -> f64 {
        match child {
            Child::Triangle(_) => 0.0,
            Child::Group(group) => {
                let tested = f64::from(group.bounds.half_area()) * group.children.len() as f64;
                tested + group.children.iter().map(weighted).sum::<f64>()
            }
        }
    }
    match root {
        Child::Group(group) if group.bounds.half_area() > 0.0 => {
            1.0 + weighted(root) / f64::from(group.bounds.half_area())
        }
        _ => 1.0,
    }
}

impl Scene {
    /// Builds traversal lists over all instances.
    ///
    /// ```
    /// use ropewalk::{ListOptions, Mesh, Ray, Scene, glam::Vec3};
    /// let mesh = Mesh::new(vec![Vec3::ZERO, Vec3::X, Vec3::Y], vec![[0, 1, 2]]);
    /// let list = Scene::from_mesh(mesh).build_list(&ListOptions::default())?;
    /// assert!(list.any(&Ray::new(Vec3::new(0.2, 0.3, 5.0), -Vec3::Z)));
    /// # Ok::<(), ropewalk::BuildError>(())
    /// ```
    ///
    /// # Errors
    /// When the scene or an option is out of range.
    pub fn build_list(&self, options: &ListOptions) -> Result<TraversalList, BuildError> {
        self.build_list_monitored(options, &NoMonitor)
    }

    /// Builds traversal lists over all instances, under the eyes of a monitor that may cancel the build of the hierarchy.
    ///
    /// # Errors
    /// When the scene or an option is out of range, or the monitor cancels.
    pub fn build_list_monitored(
        &self,
        options: &ListOptions,
        monitor: &dyn Monitor,
    ) -> Result<TraversalList, BuildError> {
        options.check()?;
        if let Some(build) = options.build_options() {
            let bvh = self.build_monitored(&build, monitor)?;
            let clock = Clock::start();
            let root = hierarchy::of_bvh(&bvh);
            let mut list = TraversalList::encode(options, root.as_ref(), bvh.triangles(), *bvh.report())?;
            list.report.build_time += clock.elapsed();
            return Ok(list);
        }
        let clock = Clock::start();
        let FlatScene { triangles, report: input } = self.flatten()?;
        let flatten_time = clock.elapsed();
        let clock = Clock::start();
        let progress = Progress::new(monitor, triangles.len());
        let root = octree::build(&triangles, options.big, &progress);
        progress.finish()?;
        let count = triangles.len();
        let report = BuildReport {
            input,
            flatten_time,
            triangles: count,
            references: count,
            ..BuildReport::default()
        };
        let mut list = TraversalList::encode(options, root.as_ref(), &triangles, report)?;
        list.report.build_time = clock.elapsed();
        Ok(list)
    }
}
