//! The kernels of point queries: which files and definitions each combination of walk, search and counters is made of.

use super::assembly::{AssemblyError, Definitions};
use super::constants::{constants, word};
use super::every::{stack_sizes, walks};
use super::head_kernel::HeadKernel;
use super::kernel::{Kernel, with_walk};
use super::library::ShaderLibrary;
use super::tree::Tree;
use ropewalk::point::{LARGEST_POINT, PointSearch, catalogue};
use ropewalk::{DeviceKind, StructureKind, Walk};

/// One combination of the kernel of point queries, all of which go through binary trees.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct PointKernel {
    /// The walk, of which the register is not `auto`: see [`Tree::resolve`].
    pub walk: Walk,
    /// What is asked.
    pub search: PointSearch,
    /// Places of each query's list, one of [`PointKernel::ROOMS`]; the closest point has the first and no list.
    pub room: u32,
    /// Whether it counts.
    pub counters: bool,
    /// Entries of each query's stack; without meaning for a restart trail, which brings its own.
    pub stack_entries: u32,
}

impl PointKernel {
    /// Words of a query's record.
    pub const QUERY_WORDS: usize = 5;

    /// Words of a triangle that was found: distance, point, barycentrics, primitive, geometry, instance, and the
    /// status with [`STATUS_WRITTEN`](super::STATUS_WRITTEN).
    pub const POINT_WORDS: usize = 12;

    /// The rooms for which there are kernels: few, since what is not filled costs nothing but its zeroes. An entry is two
    /// words, so the lists of a workgroup have 16 KiB with the largest room. With a longer one a graphics card, whose
    /// caches are not much larger, would move lists about.
    pub const ROOMS: [u32; 2] = [8, 32];

    /// The room in use for so many triangles; none where they are too many.
    #[must_use]
    pub fn room_for(k: usize) -> Option<u32> {
        Self::ROOMS.into_iter().find(|&room| room as usize >= k)
    }

    /// Words that the kernel writes a query.
    ///
    /// | search | words |
    /// |---|---|
    /// | closest | [`PointKernel::POINT_WORDS`]; with counters six more, of which the last two words above are the first |
    /// | nearest | number of triangles, status, and 6 counters or 2 zeros; then `k` times [`PointKernel::POINT_WORDS`] |
    #[must_use]
    pub const fn result_words(&self, k: usize) -> usize {
        match (self.search, self.counters) {
            (PointSearch::Closest, false) => Self::POINT_WORDS,
            (PointSearch::Closest, true) => Self::POINT_WORDS + 4,
            (PointSearch::Nearest, false) => 4 + k * Self::POINT_WORDS,
            (PointSearch::Nearest, true) => 8 + k * Self::POINT_WORDS,
        }
    }

    /// A name for labels and messages.
    #[must_use]
    pub fn label(&self) -> String {
        let stack = match self.walk {
            Walk::RestartTrail(_) => String::new(),
            _ => format!(", {} stack entries", self.stack_entries),
        };
        let room = match self.search {
            PointSearch::Closest => String::new(),
            PointSearch::Nearest => format!(" of {}", self.room),
        };
        let counters = if self.counters { " with counters" } else { "" };
        format!("bvh {} {}{room}{counters}{stack}", self.walk, self.search)
    }

    /// What the shader's conditions and constants are.
    #[must_use]
    pub fn definitions(&self) -> Definitions {
        let (collect, result) = match self.search {
            PointSearch::Closest => ("shared/point_closest", "kernel/result_point_closest"),
            PointSearch::Nearest => ("shared/point_nearest", "kernel/result_point_nearest"),
        };
        let definitions = constants()
            .text("LARGEST_POINT_BITS", word(LARGEST_POINT.to_bits()))
            .text("SEEKER", "shared/seek_point")
            .text("COLLECT", collect)
            .text("RESULT", result)
            .text("NEAREST_ROOM", self.room)
            .flag("COUNTERS", self.counters);
        if !catalogue::is_offered(StructureKind::Bvh, self.walk, self.search, DeviceKind::Gpu) {
            // Without a walk the shader cannot be assembled, which is the right answer.
            return definitions;
        }
        with_walk(definitions, Tree::Binary, self.walk, self.stack_entries)
    }

    /// The kernel's WGSL.
    ///
    /// # Errors
    /// When the catalogue has no such row for a graphics adapter, or the walk is not [resolved](Tree::resolve). The
    /// test suite assembles every one that there is.
    pub fn source(&self, library: &ShaderLibrary) -> Result<String, AssemblyError> {
        library.assemble("kernel/points", &self.definitions())
    }

    /// Every kernel that can be asked for.
    #[must_use]
    pub fn every() -> Vec<Self> {
        let mut kernels = Vec::new();
        for walk in walks() {
            for search in PointSearch::EVERY {
                if Tree::Binary.resolve(walk, 0) != Ok(walk) {
                    continue;
                }
                if !catalogue::is_offered(StructureKind::Bvh, walk, search, DeviceKind::Gpu) {
                    continue;
                }
                let rooms = match search {
                    PointSearch::Closest => &Self::ROOMS[..1],
                    PointSearch::Nearest => &Self::ROOMS[..],
                };
                for &room in rooms {
                    for stack_entries in stack_sizes(Tree::Binary, walk) {
                        for counters in [false, true] {
                            kernels.push(Self { walk, search, room, counters, stack_entries });
                        }
                    }
                }
            }
        }
        kernels
    }
}

/// Any shipped kernel.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub(crate) enum AnyKernel {
    /// Of rays.
    Rays(Kernel),
    /// Of point queries.
    Points(PointKernel),
    /// Of heads.
    Heads(HeadKernel),
}

impl AnyKernel {
    pub(crate) const fn walk(&self) -> Walk {
        match self {
            Self::Rays(kernel) => kernel.walk,
            Self::Points(kernel) => kernel.walk,
            // A search asks each element of a list once, as a walk does.
            Self::Heads(_) => Walk::List,
        }
    }

    pub(crate) fn label(&self) -> String {
        match self {
            Self::Rays(kernel) => kernel.label(),
            Self::Points(kernel) => kernel.label(),
            Self::Heads(kernel) => kernel.label(),
        }
    }

    pub(crate) fn source(&self, library: &ShaderLibrary) -> Result<String, AssemblyError> {
        match self {
            Self::Rays(kernel) => kernel.source(library),
            Self::Points(kernel) => kernel.source(library),
            Self::Heads(kernel) => kernel.source(library),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use ropewalk::bvh::StackOrder;
    use ropewalk::catalogue::TrailOptions;
    use std::collections::HashSet;

    #[test]
    fn a_room_holds_what_is_wanted() {
        let rooms = [0, 1, 8, 9, 32].map(PointKernel::room_for);
        assert_eq!(rooms, [8, 8, 8, 32, 32].map(Some));
        assert_eq!([33, usize::MAX].map(PointKernel::room_for), [None; 2]);
    }

    #[test]
    fn the_list_has_each_kernel_once_and_all_of_every_row() {
        let list = PointKernel::every();
        let every: HashSet<PointKernel> = list.iter().copied().collect();
        assert_eq!(every.len(), list.len());
        // Eight stack sizes, and 33 short stacks with 3 registers; the closest, and lists in two rooms.
        assert_eq!(every.len(), 2 * (8 + 33 * 3) * (1 + 2));
        for row in catalogue::rows().into_iter().filter(|row| row.device == DeviceKind::Gpu) {
            for (depth, counters) in [(1, false), (20, true), (31, false)] {
                let walk = Tree::Binary.resolve(row.walk, depth).unwrap();
                let stack_entries = if matches!(walk, Walk::Stack(_)) { 32 } else { 0 };
                let kernel = PointKernel { walk, search: row.search, room: 8, counters, stack_entries };
                assert!(every.contains(&kernel), "{}", kernel.label());
            }
        }
    }

    #[test]
    fn what_the_catalogue_does_not_have_is_not_assembled() {
        let kernel = PointKernel {
            walk: Walk::default(),
            search: PointSearch::Closest,
            room: 8,
            counters: false,
            stack_entries: 8,
        };
        let library = ShaderLibrary::shipped();
        assert!(kernel.source(&library).is_ok());
        for (walk, constant) in [
            (Walk::BruteForce, "WALK"),
            (Walk::Recursive, "WALK"),
            (Walk::Stack(StackOrder::Sorted), "WALK"),
            // Not resolved.
            (Walk::RestartTrail(TrailOptions::default()), "TRAIL"),
        ] {
            let error = PointKernel { walk, ..kernel }.source(&library).unwrap_err().to_string();
            assert!(error.contains(&format!("'{constant}'")), "{error}");
        }
    }
}
