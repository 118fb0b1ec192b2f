//! The shipped kernels: which files and definitions each combination of tree, walk, query and counters is made of.

use super::assembly::{AssemblyError, Definitions};
use super::library::ShaderLibrary;
use super::list_layout;
use super::tree::Tree;
use crate::gpu::WORKGROUP_SIZE;
use ropewalk::bvh::StackOrder;
use ropewalk::catalogue::{StackMemory, TrailOptions, TrailRegister, is_offered};
use ropewalk::traversal_list::{Bounds, NO_HEAD};
use ropewalk::{
    DeviceKind, FlatTriangle, Hit, LARGEST_DIRECTION, Query, SMALLEST_DIRECTION, Sphere, Status, Walk, aabb,
    ray,
};

/// The bind group of a structure: nodes and triangles.
pub const STRUCTURE_GROUP: u32 = 0;
/// The bind group of a batch: rays, results and the batch's numbers.
pub const BATCH_GROUP: u32 = 1;
/// The bit of a status word that a kernel always sets. Results are zeroed before a run, so that a ray without
/// the bit is one that no invocation answered.
pub const STATUS_WRITTEN: u32 = 1 << 31;

/// One combination of the kernel of rays.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct Kernel {
    /// What it goes through.
    pub tree: Tree,
    /// The walk, of which the register is not `auto`: see [`Tree::resolve`].
    pub walk: Walk,
    /// The query.
    pub query: Query,
    /// Whether it counts.
    pub counters: bool,
    /// Entries of each ray's stack; without meaning for a restart trail, which brings its own.
    pub stack_entries: u32,
    /// Layers of lists, of each of which the ray's record has the element to begin with; 0 where rays begin with the first.
    pub starts: u32,
}

impl Kernel {
    /// The stack sizes in use: multiples of this.
    pub const STACK_STEP: u32 = 8;

    /// The size in use of a stack that must hold so many entries.
    #[must_use]
    pub const fn stack_entries_for(entries: u32) -> u32 {
        let entries = if entries == 0 { 1 } else { entries };
        match entries.checked_next_multiple_of(Self::STACK_STEP) {
            Some(size) => size,
            None => entries,
        }
    }

    /// Words of a ray's record: the ray's own, with [`Query::All`] where its hits go and how many, and its heads.
    #[must_use]
    pub const fn ray_words(&self) -> usize {
        let own = if matches!(self.query, Query::All) { 11 } else { 9 };
        own + self.starts as usize
    }

    /// Words that the kernel writes a ray.
    ///
    /// | query | without counters | with counters |
    /// |---|---|---|
    /// | closest | t, u, v, primitive, geometry, instance, front face, status | then 6 counters and 2 zeros |
    /// | any, count | hit or number of hits, status | then 6 counters |
    /// | all | number of hits, status, 2 zeros | number of hits, status, 6 counters |
    ///
    /// With [`Query::All`] the hits follow behind the words of all rays, [`Kernel::HIT_WORDS`] each.
    #[must_use]
    pub const fn result_words(&self) -> usize {
        match (self.query, self.counters) {
            (Query::Any | Query::Count, false) => 2,
            (Query::All, false) => 4,
            (Query::Any | Query::Count | Query::All, true) | (Query::Closest, false) => 8,
            (Query::Closest, true) => 16,
        }
    }

    /// Words of a hit: t, u, v, primitive, geometry, instance, front face, [`STATUS_WRITTEN`].
    pub const HIT_WORDS: usize = 8;

    /// A name for labels and messages.
    #[must_use]
    pub fn label(&self) -> String {
        let tree = match self.tree {
            Tree::Binary => "bvh".into(),
            Tree::Wide(width) => format!("wide-bvh:width={}", width.children()),
            Tree::List { bounds, one_sided } => {
                let bounds = if bounds == Bounds::Sphere { "sphere" } else { "aabb" };
                format!("list:bounds={bounds}{}", if one_sided { ", one-sided" } else { "" })
            }
        };
        let stack = match self.walk {
            Walk::RestartTrail(_) | Walk::List => String::new(),
            _ => format!(", {} stack entries", self.stack_entries),
        };
        let counters = if self.counters { " with counters" } else { "" };
        let starts = match self.starts {
            0 => String::new(),
            layers => format!(" from heads of {layers} layers"),
        };
        format!("{tree} {} {}{starts}{counters}{stack}", self.walk, self.query)
    }

    /// What the shader's conditions and constants are.
    #[must_use]
    pub fn definitions(&self) -> Definitions {
        let mut definitions = constants()
            .text("RAY_WORDS", self.ray_words())
            .flag("COUNTERS", self.counters)
            .flag("ALL", self.query == Query::All);
        let (collect, result) = match self.query {
            Query::Closest => ("shared/collect_closest", "kernel/result_closest"),
            Query::Any => ("shared/collect_any", "kernel/result_word"),
            Query::Count => ("shared/collect_count", "kernel/result_word"),
            Query::All => ("shared/collect_all", "kernel/result_all"),
        };
        let seeker = match self.tree {
            Tree::Binary | Tree::Wide(_) => "shared/seek_ray",
            Tree::List { bounds: Bounds::Sphere, .. } => "shared/seek_spheres",
            Tree::List { bounds: Bounds::Aabb, .. } => "shared/seek_boxes",
        };
        definitions = definitions.text("SEEKER", seeker).text("COLLECT", collect).text("RESULT", result);
        if self.starts > 0 {
            definitions = definitions.text("STARTS", self.starts);
        }
        match self.tree {
            Tree::Binary => {}
            Tree::Wide(width) => definitions = definitions.text("WIDTH", width.children()),
            Tree::List { one_sided, .. } => definitions = definitions.flag("ONE_SIDED", one_sided),
        }
        if !is_offered(self.tree.kind(), self.walk, self.query, DeviceKind::Gpu) {
            // Without a walk the shader cannot be assembled, which is the right answer.
            return definitions;
        }
        with_walk(definitions, self.tree, self.walk, self.stack_entries)
    }

    /// The kernel's WGSL.
    ///
    /// # Errors
    /// When the catalogue has no such row for a graphics adapter, or the walk is not [resolved](Tree::resolve). The
    /// test suite assembles every one that there is.
    pub fn source(&self, library: &ShaderLibrary) -> Result<String, AssemblyError> {
        library.assemble("kernel/rays", &self.definitions())
    }
}

/// The file of the walk, and what it needs. A graphics adapter has no brute force and no recursion.
pub(super) fn with_walk(definitions: Definitions, tree: Tree, walk: Walk, stack_entries: u32) -> Definitions {
    match walk {
        Walk::BruteForce | Walk::Recursive => definitions,
        Walk::List => definitions.text("WALK", "walk/walk_list"),
        Walk::Stack(order) => {
            let file = match (tree, order) {
                (Tree::List { .. }, _) => return definitions,
                (Tree::Wide(_), _) => "walk/walk_wide_bvh_stack",
                (Tree::Binary, StackOrder::Ordered) => "walk/walk_bvh_stack",
                (Tree::Binary, _) => "walk/walk_bvh_postponed",
            };
            definitions
                .text("WALK", file)
                .text("STACK_ENTRIES", stack_entries)
                .flag("CULL", order != StackOrder::Unordered)
                .flag("SORT", order == StackOrder::Sorted)
        }
        Walk::RestartTrail(options) => {
            let file = match tree {
                Tree::Binary => "walk/walk_bvh_restart_trail",
                Tree::Wide(_) => "walk/walk_wide_bvh_restart_trail",
                Tree::List { .. } => return definitions,
            };
            with_trail(definitions.text("WALK", file), tree, options)
        }
    }
}

/// The files of the trail's bits and of its short stack.
fn with_trail(definitions: Definitions, tree: Tree, options: TrailOptions) -> Definitions {
    let trail = match (tree, options.register) {
        (Tree::Binary, TrailRegister::U32) => Some("shared/trail_u32"),
        (Tree::Binary, TrailRegister::U64) => Some("shared/trail_u64"),
        (Tree::Binary, TrailRegister::Array) => Some("shared/trail_array"),
        (Tree::Wide(_), TrailRegister::U64) => Some("shared/wide_trail_u64"),
        (Tree::Wide(_), TrailRegister::Array) => Some("shared/wide_trail_array"),
        // Not resolved, or not there: the shader cannot be assembled.
        (_, TrailRegister::Auto) | (Tree::Wide(_), TrailRegister::U32) | (Tree::List { .. }, _) => None,
    };
    let stack = match (options.short_stack, options.memory) {
        (0, _) => "shared/short_stack_none",
        (_, StackMemory::Private) => "shared/short_stack_private",
        (_, StackMemory::Workgroup) => "shared/short_stack_workgroup",
    };
    let definitions = definitions.text("SHORT_STACK", stack).text("SHORT_STACK_ENTRIES", options.short_stack);
    trail.into_iter().fold(definitions, |these, trail| these.text("TRAIL", trail))
}

/// What is the same in all kernels.
pub(super) fn constants() -> Definitions {
    Definitions::new()
        .text("WORKGROUP_SIZE", WORKGROUP_SIZE)
        .text("STRUCTURE_GROUP", STRUCTURE_GROUP)
        .text("BATCH_GROUP", BATCH_GROUP)
        .text("PAD_ENTRY", float(aabb::PAD_ENTRY))
        .text("PAD_EXIT", float(aabb::PAD_EXIT))
        .text("SMALLEST_DIRECTION_BITS", word(SMALLEST_DIRECTION.to_bits()))
        .text("LARGEST_DIRECTION_BITS", word(LARGEST_DIRECTION.to_bits()))
        .text("PARALLEL", float(ray::PARALLEL))
        .text("PARALLEL_INVERSE", float(ray::PARALLEL_INVERSE))
        .text("LARGEST_INVERSE", float(ray::LARGEST_INVERSE))
        .text("LEAST_OUTWARDS", float(ray::LEAST_OUTWARDS))
        .text("LEAST_OUTWARDS_SHORT", float(ray::LEAST_OUTWARDS_SHORT))
        .text("LARGEST_FLOAT", float(f32::MAX))
        .text("SPHERE_PAD", float(Sphere::PAD))
        .text("LIST_HEADER_WORDS", list_layout::HEADER_WORDS)
        .text("LIST_LAYERS_AT", list_layout::LAYERS_AT)
        .text("LIST_LAYER_WORDS", list_layout::LAYER_WORDS)
        .text("LIST_GRID_AT", list_layout::GRID_AT)
        .text("NONE", word(Hit::NONE))
        .text("NO_HEAD", word(NO_HEAD))
        .text("MIRROR", word(FlatTriangle::MIRROR))
        .text("STATUS_COMPLETE", word(Status::COMPLETE.0))
        .text("STATUS_INVALID_RAY", word(Status::INVALID_RAY.0))
        .text("STATUS_STEP_BUDGET", word(Status::STEP_BUDGET.0))
        .text("STATUS_STACK_OVERFLOW", word(Status::STACK_OVERFLOW.0))
        .text("STATUS_WRITTEN", word(STATUS_WRITTEN))
}

/// The shortest decimal text that reads back as the same f32.
pub(super) fn float(value: f32) -> String {
    format!("{value:e}f")
}

pub(super) fn word(value: u32) -> String {
    format!("{value:#x}u")
}

#[cfg(test)]
mod tests {
    use super::*;
    use ropewalk::wide_bvh::Width;
    use std::collections::HashSet;

    #[test]
    fn a_stack_holds_what_may_wait() {
        let sizes = [0, 1, 8, 9, 48, 64, 448, u32::MAX].map(Kernel::stack_entries_for);
        assert_eq!(sizes, [8, 8, 8, 16, 48, 64, 448, u32::MAX]);
    }

    #[test]
    fn the_list_has_each_kernel_once_and_all_of_every_row() {
        let every: HashSet<Kernel> = Kernel::every().into_iter().collect();
        assert_eq!(every.len(), Kernel::every().len());
        // Binary: 4 stack walks in 8 sizes for 2 queries, and one of them for 2 more; 33 short stacks with 3 registers.
        let binary = 2 * (8 * (4 * 2 + 2) + 4 * 33 * 3);
        // Wide: stacks of 8 to 192 and to 448; two registers.
        let wide = 2 * 4 * (24 + 56 + 2 * 33 * 2);
        // Lists: two bounds, of one side and of two, four queries, from the first elements or from heads of one layer to
        // four.
        let lists = 2 * (2 * 2 * 4 * 5);
        assert_eq!(every.len(), binary + wide + lists);
        for row in ropewalk::catalogue::rows().into_iter().filter(|row| row.device == DeviceKind::Gpu) {
            for tree in Tree::EVERY.into_iter().filter(|tree| tree.kind() == row.structure.kind()) {
                for (depth, counters) in [(1, false), (20, true), (31, false)] {
                    let Ok(walk) = tree.resolve(row.walk, depth) else { continue };
                    let stack_entries = if matches!(walk, Walk::Stack(_)) { 32 } else { 0 };
                    let kernel = Kernel { tree, walk, query: row.query, counters, stack_entries, starts: 0 };
                    assert!(every.contains(&kernel), "{}", kernel.label());
                }
            }
        }
    }

    #[test]
    fn what_the_catalogue_does_not_have_is_not_assembled() {
        let kernel = Kernel {
            tree: Tree::Binary,
            walk: Walk::default(),
            query: Query::Closest,
            counters: false,
            stack_entries: 8,
            starts: 0,
        };
        let library = ShaderLibrary::shipped();
        assert!(kernel.source(&library).is_ok());
        let sorted = Walk::Stack(StackOrder::Sorted);
        let u32_trail = "restart-trail:register=u32".parse().unwrap();
        for (missing, constant) in [
            (Kernel { walk: Walk::BruteForce, ..kernel }, "WALK"),
            (Kernel { walk: Walk::Recursive, ..kernel }, "WALK"),
            (Kernel { walk: sorted, query: Query::All, ..kernel }, "WALK"),
            (Kernel { walk: sorted, tree: Tree::Wide(Width::Four), ..kernel }, "WALK"),
            (Kernel { walk: u32_trail, tree: Tree::Wide(Width::Four), ..kernel }, "WALK"),
            // Not resolved.
            (Kernel { walk: "restart-trail".parse().unwrap(), ..kernel }, "TRAIL"),
        ] {
            let error = missing.source(&library).unwrap_err().to_string();
            assert!(error.contains(&format!("'{constant}'")), "{error}");
        }
    }

    #[test]
    fn constants_read_back_as_they_were() {
        for value in
            [aabb::PAD_ENTRY, aabb::PAD_EXIT, ray::PARALLEL, ray::LEAST_OUTWARDS_SHORT, Sphere::PAD, f32::MAX]
        {
            assert_eq!(float(value).trim_end_matches('f').parse(), Ok(value));
        }
    }
}
