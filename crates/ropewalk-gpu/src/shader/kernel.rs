//! The shipped kernels: which files and definitions each combination of tree, walk, query and counters is made of.

use super::assembly::{AssemblyError, Definitions};
use super::constants::constants;
use super::library::ShaderLibrary;
use super::tree::{LevelBottoms, Tree};
use ropewalk::bvh::StackOrder;
use ropewalk::catalogue::{StackMemory, TrailOptions, TrailRegister, is_offered};
use ropewalk::traversal_list::Bounds;
use ropewalk::{DeviceKind, Query, Walk};

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
            Tree::Kd => "kd-tree".into(),
            Tree::Levels(bottoms) => format!("two-level of {bottoms:?}"),
            Tree::List { bounds, one_sided } => {
                let bounds = if bounds == Bounds::Sphere { "sphere" } else { "aabb" };
                format!("list:bounds={bounds}{}", if one_sided { ", one-sided" } else { "" })
            }
        };
        let stack = match self.walk {
            Walk::Stack(_) | Walk::SmartStack { .. } => format!(", {} stack entries", self.stack_entries),
            _ => String::new(),
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
            Tree::Kd => "shared/seek_cells",
            Tree::Levels(_) => "shared/seek_levels",
            Tree::List { bounds: Bounds::Sphere, .. } => "shared/seek_spheres",
            Tree::List { bounds: Bounds::Aabb, .. } => "shared/seek_boxes",
        };
        definitions = definitions.text("SEEKER", seeker).text("COLLECT", collect).text("RESULT", result);
        if self.starts > 0 {
            definitions = definitions.text("STARTS", self.starts);
        }
        match self.tree {
            Tree::Binary => {}
            Tree::Kd => definitions = definitions.flag("CELLS", true),
            Tree::Levels(bottoms) => {
                let has_cells = bottoms.has_kd_trees();
                definitions = definitions
                    .flag("TWO_LEVEL", true)
                    .flag("CELLS", has_cells)
                    .flag("BOTTOM_KD_TREE", has_cells)
                    .flag("BOTTOM_WIDE", bottoms.width().is_some())
                    .flag("BOTTOM_LIST", bottoms.bounds().is_some())
                    .flag("ONE_SIDED", matches!(bottoms, LevelBottoms::List { one_sided: true, .. }))
                    .text("LIST_BUFFERS", "shared/level_list");
                if let Some(width) = bottoms.width() {
                    definitions = definitions.text("WIDTH", width.children());
                }
                if let Some(bounds) = bottoms.bounds() {
                    let is_sphere = bounds == Bounds::Sphere;
                    let volumes = if is_sphere { "shared/seek_spheres" } else { "shared/seek_boxes" };
                    definitions = definitions.text("VOLUMES", volumes);
                }
            }
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
        Walk::SmartStack { bytes } => definitions
            .text("WALK", "walk/walk_two_level")
            .text("LEVEL_STACK", "shared/smart_stack")
            .text("RING_WORDS", bytes / 4)
            .text("STACK_ENTRIES", stack_entries),
        Walk::List => definitions.text("WALK", "walk/walk_list"),
        Walk::Stack(order) => {
            let file = match (tree, order) {
                (Tree::List { .. }, _) => return definitions,
                (Tree::Kd, _) => "walk/walk_kd_stack",
                (Tree::Levels(_), _) => "walk/walk_two_level",
                (Tree::Wide(_), _) => "walk/walk_wide_bvh_stack",
                (Tree::Binary, StackOrder::Ordered) => "walk/walk_bvh_stack",
                (Tree::Binary, _) => "walk/walk_bvh_postponed",
            };
            definitions
                .text("WALK", file)
                .text("LEVEL_STACK", "shared/level_stack")
                .text("STACK_ENTRIES", stack_entries)
                .flag("CULL", order != StackOrder::Unordered)
                .flag("SORT", order == StackOrder::Sorted)
        }
        Walk::RestartTrail(options) => {
            let file = match tree {
                Tree::Binary => "walk/walk_bvh_restart_trail",
                Tree::Wide(_) => "walk/walk_wide_bvh_restart_trail",
                Tree::Kd => "walk/walk_kd_restart_trail",
                Tree::List { .. } | Tree::Levels(_) => return definitions,
            };
            let definitions = definitions.text("WALK", file).flag("TRAIL_STACK", options.short_stack > 0);
            with_trail(definitions, tree, options)
        }
        Walk::KdRestart => with_trail(definitions.text("WALK", "walk/walk_kd_restart"), tree, WITHOUT_STACK),
        Walk::KdBacktrack => {
            with_trail(definitions.text("WALK", "walk/walk_kd_backtrack"), tree, WITHOUT_STACK)
        }
        Walk::Ropes => with_trail(definitions.text("WALK", "walk/walk_kd_ropes"), tree, WITHOUT_STACK),
        Walk::ShortStack { entries } => {
            let options = TrailOptions { short_stack: entries, ..WITHOUT_STACK };
            with_trail(definitions.text("WALK", "walk/walk_kd_short_stack"), tree, options)
        }
    }
}

/// The trail that walks by `t` alone hand a ray over to where `t` decides nothing.
const WITHOUT_STACK: TrailOptions =
    TrailOptions { short_stack: 0, register: TrailRegister::Auto, memory: StackMemory::Private };

/// The files of the trail's bits and of its short stack.
fn with_trail(definitions: Definitions, tree: Tree, options: TrailOptions) -> Definitions {
    let trail = match (tree, options.register) {
        (Tree::Binary, TrailRegister::U32) => Some("shared/trail_u32"),
        (Tree::Binary, TrailRegister::U64) | (Tree::Kd, TrailRegister::Auto) => Some("shared/trail_u64"),
        (Tree::Binary, TrailRegister::Array) => Some("shared/trail_array"),
        (Tree::Wide(_), TrailRegister::U64) => Some("shared/wide_trail_u64"),
        (Tree::Wide(_), TrailRegister::Array) => Some("shared/wide_trail_array"),
        // Not resolved, or not there: the shader cannot be assembled.
        (_, TrailRegister::Auto)
        | (Tree::Wide(_), TrailRegister::U32)
        | (Tree::Kd | Tree::List { .. } | Tree::Levels(_), _) => None,
    };
    let stack = match (options.short_stack, options.memory) {
        (0, _) => "shared/short_stack_none",
        (_, StackMemory::Private) => "shared/short_stack_private",
        (_, StackMemory::Workgroup) => "shared/short_stack_workgroup",
    };
    let definitions = definitions.text("SHORT_STACK", stack).text("SHORT_STACK_ENTRIES", options.short_stack);
    trail.into_iter().fold(definitions, |these, trail| these.text("TRAIL", trail))
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
        // Kd-trees: stacks in 8 sizes, 17 trails, 16 short stacks and three walks without a stack, four queries each.
        let kd_trees = 2 * 4 * (8 + 17 + 16 + 3);
        // Two levels: twelve kinds, a stack and two rings, each in two sizes, four queries.
        let levels = 2 * 12 * 3 * 2 * 4;
        assert_eq!(every.len(), binary + wide + lists + kd_trees + levels);
        for row in ropewalk::catalogue::rows().into_iter().filter(|row| row.device == DeviceKind::Gpu) {
            for tree in Tree::EVERY.into_iter().filter(|tree| tree.kind() == row.structure.kind()) {
                for (depth, counters) in [(1, false), (20, true), (31, false)] {
                    let Ok(walk) = tree.resolve(row.walk, depth) else { continue };
                    let has_stack = matches!(walk, Walk::Stack(_) | Walk::SmartStack { .. });
                    let stack_entries = match (has_stack, tree) {
                        (false, _) => 0,
                        (true, Tree::Levels(_)) => 8,
                        (true, _) => 32,
                    };
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
}
