//! The shipped kernels: which files and definitions each combination of tree, walk, query and counters is made of.

use super::assembly::{AssemblyError, Definitions};
use super::library::ShaderLibrary;
use crate::gpu::WORKGROUP_SIZE;
use ropewalk::bvh::StackOrder;
use ropewalk::catalogue::{StackMemory, TrailOptions, TrailRegister, is_offered};
use ropewalk::wide_bvh::Width;
use ropewalk::{
    DeviceKind, FlatTriangle, Hit, LARGEST_DIRECTION, Query, SMALLEST_DIRECTION, Status, StructureKind,
    TraceError, Walk, aabb, ray,
};

/// The bind group of a structure: nodes and triangles.
pub const STRUCTURE_GROUP: u32 = 0;
/// The bind group of a batch: rays, results and the batch's numbers.
pub const BATCH_GROUP: u32 = 1;
/// The bit of a status word that a kernel always sets. Results are zeroed before a run, so that a ray without
/// the bit is one that no invocation answered.
pub const STATUS_WRITTEN: u32 = 1 << 31;

/// What a kernel goes through: a structure by its layout.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Tree {
    /// [`ropewalk::Bvh`].
    Binary,
    /// [`ropewalk::WideBvh`].
    Wide(Width),
}

impl Tree {
    /// Every layout.
    pub const EVERY: [Self; 3] = [Self::Binary, Self::Wide(Width::Four), Self::Wide(Width::Eight)];

    /// The catalogue's name for it.
    #[must_use]
    pub const fn kind(self) -> StructureKind {
        match self {
            Self::Binary => StructureKind::Bvh,
            Self::Wide(_) => StructureKind::WideBvh,
        }
    }

    /// The walk as a kernel has it: with a register that goes through a tree of this depth, and with no choice left
    /// that would make no difference.
    ///
    /// # Errors
    /// When a register is prescribed that is too small.
    pub fn resolve(self, walk: Walk, depth: u32) -> Result<Walk, TraceError> {
        let Walk::RestartTrail(options) = walk else { return Ok(walk) };
        let register = match self {
            Self::Binary => options.register_for(depth)?,
            Self::Wide(_) => options.wide_register_for(depth)?,
        };
        let short_stack = options.short_stack.min(TrailOptions::MAX_SHORT_STACK);
        // Where there is no stack, it is nowhere.
        let memory = if short_stack == 0 { StackMemory::Private } else { options.memory };
        Ok(Walk::RestartTrail(TrailOptions { short_stack, register, memory }))
    }
}

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

    /// Words of a ray's record: the ray's own, and with [`Query::All`] where its hits go and how many.
    #[must_use]
    pub const fn ray_words(&self) -> usize {
        if matches!(self.query, Query::All) { 11 } else { 9 }
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
        };
        let stack = match self.walk {
            Walk::RestartTrail(_) => String::new(),
            _ => format!(", {} stack entries", self.stack_entries),
        };
        let counters = if self.counters { " with counters" } else { "" };
        format!("{tree} {} {}{counters}{stack}", self.walk, self.query)
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
        definitions =
            definitions.text("SEEKER", "shared/seek_ray").text("COLLECT", collect).text("RESULT", result);
        if let Tree::Wide(width) = self.tree {
            definitions = definitions.text("WIDTH", width.children());
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

/// The file of the walk, and what it needs. A graphics adapter has no brute force, no recursion and no lists.
pub(super) fn with_walk(definitions: Definitions, tree: Tree, walk: Walk, stack_entries: u32) -> Definitions {
    match walk {
        Walk::BruteForce | Walk::Recursive | Walk::List => definitions,
        Walk::Stack(order) => {
            let file = match (tree, order) {
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
        (_, TrailRegister::Auto) | (Tree::Wide(_), TrailRegister::U32) => None,
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
        .text("NONE", word(Hit::NONE))
        .text("MIRROR", word(FlatTriangle::MIRROR))
        .text("STATUS_COMPLETE", word(Status::COMPLETE.0))
        .text("STATUS_INVALID_RAY", word(Status::INVALID_RAY.0))
        .text("STATUS_STEP_BUDGET", word(Status::STEP_BUDGET.0))
        .text("STATUS_STACK_OVERFLOW", word(Status::STACK_OVERFLOW.0))
        .text("STATUS_WRITTEN", word(STATUS_WRITTEN))
}

/// The shortest decimal text that reads back as the same f32.
fn float(value: f32) -> String {
    format!("{value:e}f")
}

pub(super) fn word(value: u32) -> String {
    format!("{value:#x}u")
}

#[cfg(test)]
mod tests {
    use super::*;
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
        assert_eq!(every.len(), binary + wide);
        for row in ropewalk::catalogue::rows().into_iter().filter(|row| row.device == DeviceKind::Gpu) {
            for tree in Tree::EVERY.into_iter().filter(|tree| tree.kind() == row.structure.kind()) {
                for (depth, counters) in [(1, false), (20, true), (31, false)] {
                    let Ok(walk) = tree.resolve(row.walk, depth) else { continue };
                    let stack_entries = if matches!(walk, Walk::Stack(_)) { 32 } else { 0 };
                    let kernel = Kernel { tree, walk, query: row.query, counters, stack_entries };
                    assert!(every.contains(&kernel), "{}", kernel.label());
                }
            }
        }
    }

    #[test]
    fn a_register_is_chosen_by_depth_or_refused() {
        let trail = |text: &str| format!("restart-trail:short-stack={text}").parse::<Walk>().unwrap();
        let register = |tree: Tree, text: &str, depth| match tree.resolve(trail(text), depth) {
            Ok(Walk::RestartTrail(options)) => Ok(options.register),
            Ok(other) => panic!("{other}"),
            Err(error) => Err(error.to_string()),
        };
        for (depth, expected) in [
            (0, TrailRegister::U32),
            (31, TrailRegister::U32),
            (32, TrailRegister::U64),
            (64, TrailRegister::Array),
        ] {
            assert_eq!(register(Tree::Binary, "4", depth), Ok(expected));
        }
        let wide = Tree::Wide(Width::Eight);
        assert_eq!(register(wide, "4", 16), Ok(TrailRegister::U64));
        assert_eq!(register(wide, "4", 17), Ok(TrailRegister::Array));
        for (tree, text, depth, limit) in [
            (Tree::Binary, "4,register=u32", 32, 31),
            (Tree::Binary, "4,register=u64", 64, 63),
            (wide, "4,register=u64", 17, 16),
        ] {
            assert!(register(tree, text, limit).is_ok());
            let error = register(tree, text, depth).unwrap_err();
            assert!(
                error.contains(&depth.to_string()) && error.contains(&format!("max-depth={limit}")),
                "{error}"
            );
        }
        assert_eq!(wide.resolve(Walk::default(), 1000), Ok(Walk::default()));
        // No stack is kept in no memory, and none is longer than the longest.
        let none = Tree::Binary.resolve(trail("0,memory=workgroup"), 5).unwrap();
        assert_eq!(none, trail("0,register=u32"));
        let long = TrailOptions { short_stack: 99, ..TrailOptions::default() };
        assert_eq!(Tree::Binary.resolve(Walk::RestartTrail(long), 5), Ok(trail("16,register=u32")));
    }

    #[test]
    fn what_the_catalogue_does_not_have_is_not_assembled() {
        let kernel = Kernel {
            tree: Tree::Binary,
            walk: Walk::default(),
            query: Query::Closest,
            counters: false,
            stack_entries: 8,
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
        for value in [aabb::PAD_ENTRY, aabb::PAD_EXIT, ray::PARALLEL, ray::LEAST_OUTWARDS_SHORT, f32::MAX] {
            assert_eq!(float(value).trim_end_matches('f').parse(), Ok(value));
        }
    }
}
