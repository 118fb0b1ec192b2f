//! The shipped kernels: which files and definitions each combination of walk, query and counters is made of.

use super::assembly::{AssemblyError, Definitions};
use super::library::ShaderLibrary;
use crate::gpu::WORKGROUP_SIZE;
use ropewalk::bvh::{MAX_DEPTH, StackOrder};
use ropewalk::catalogue::is_offered;
use ropewalk::{
    DeviceKind, FlatTriangle, Hit, LARGEST_DIRECTION, Query, SMALLEST_DIRECTION, Status, Walk, aabb, ray,
};

/// The bind group of a structure: nodes and triangles.
pub const STRUCTURE_GROUP: u32 = 0;
/// The bind group of a batch: rays, results and the batch's numbers.
pub const BATCH_GROUP: u32 = 1;
/// The bit of a status word that a kernel always sets. Results are zeroed before a run, so that a ray without
/// the bit is one that no invocation answered.
pub const STATUS_WRITTEN: u32 = 1 << 31;

/// One combination of the batch kernel.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct Kernel {
    /// The walk.
    pub walk: Walk,
    /// The query: closest or any.
    pub query: Query,
    /// Whether it counts.
    pub counters: bool,
    /// Entries of each ray's stack.
    pub stack_entries: u32,
}

impl Kernel {
    /// The stack sizes in use: multiples of this.
    pub const STACK_STEP: u32 = 8;

    /// The entries of a stack that is deep enough for a structure whose deepest leaf has this depth.
    #[must_use]
    pub fn stack_entries_for(depth: u32) -> u32 {
        depth.clamp(1, MAX_DEPTH).next_multiple_of(Self::STACK_STEP)
    }

    /// Every kernel that a valid structure can ask for.
    #[must_use]
    pub fn every() -> Vec<Self> {
        let mut kernels = Vec::new();
        for row in ropewalk::catalogue::rows() {
            for counters in [false, true] {
                for stack_entries in (Self::STACK_STEP..=MAX_DEPTH).step_by(Self::STACK_STEP as usize) {
                    let kernel = Self { walk: row.walk, query: row.query, counters, stack_entries };
                    if row.device == DeviceKind::Gpu && !kernels.contains(&kernel) {
                        kernels.push(kernel);
                    }
                }
            }
        }
        kernels
    }

    /// Words that the kernel writes a ray.
    ///
    /// | query | without counters | with counters |
    /// |---|---|---|
    /// | closest | t, u, v, primitive, geometry, instance, front face, status | then 6 counters and 2 zeros |
    /// | any | hit, status | then 6 counters |
    #[must_use]
    pub const fn result_words(&self) -> usize {
        match (self.query, self.counters) {
            (Query::Any, false) => 2,
            (Query::Any, true) => 8,
            (_, false) => 8,
            (_, true) => 16,
        }
    }

    /// A name for labels and messages.
    #[must_use]
    pub fn label(&self) -> String {
        let counters = if self.counters { " with counters" } else { "" };
        format!("{} {}{counters}, {} stack entries", self.walk, self.query, self.stack_entries)
    }

    /// What the shader's conditions and constants are.
    #[must_use]
    pub fn definitions(&self) -> Definitions {
        let order = match self.walk {
            Walk::Stack(order) if is_offered(self.walk, self.query, DeviceKind::Gpu) => Some(order),
            _ => None,
        };
        let walk = match order {
            Some(StackOrder::Ordered) => Some("walk/walk_bvh_stack"),
            Some(_) => Some("walk/walk_bvh_postponed"),
            // Without a walk the shader cannot be assembled, which is the right answer.
            None => None,
        };
        let definitions = walk.into_iter().fold(Definitions::new(), |these, walk| these.text("WALK", walk));
        definitions
            .text("STACK_ENTRIES", self.stack_entries)
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
            .flag("CULL", order != Some(StackOrder::Unordered))
            .flag("SORT", order == Some(StackOrder::Sorted))
            .flag("ANY", self.query == Query::Any)
            .flag("COUNTERS", self.counters)
    }

    /// The kernel's WGSL.
    ///
    /// # Errors
    /// When the catalogue has no such row for a graphics adapter. The test suite assembles every one that it has.
    pub fn source(&self, library: &ShaderLibrary) -> Result<String, AssemblyError> {
        library.assemble("kernel/batch", &self.definitions())
    }
}

/// The shortest decimal text that reads back as the same f32.
fn float(value: f32) -> String {
    format!("{value:e}f")
}

fn word(value: u32) -> String {
    format!("{value:#x}u")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_stack_holds_a_postponed_child_for_each_level() {
        assert_eq!([0, 1, 8, 9, 48, 64, 900].map(Kernel::stack_entries_for), [8, 8, 8, 16, 48, 64, 64]);
    }

    #[test]
    fn every_row_of_the_catalogue_has_its_kernels() {
        let stacks = (MAX_DEPTH / Kernel::STACK_STEP) as usize;
        assert_eq!(Kernel::every().len(), 4 * 2 * 2 * stacks);
    }

    #[test]
    fn what_the_catalogue_does_not_have_is_not_assembled() {
        let kernel =
            Kernel { walk: Walk::default(), query: Query::Closest, counters: false, stack_entries: 8 };
        let library = ShaderLibrary::shipped();
        assert!(kernel.source(&library).is_ok());
        for missing in [
            Kernel { walk: Walk::BruteForce, ..kernel },
            Kernel { walk: Walk::Recursive, ..kernel },
            Kernel { query: Query::All, ..kernel },
            Kernel { query: Query::Count, ..kernel },
        ] {
            let error = missing.source(&library).unwrap_err().to_string();
            assert!(error.contains("WALK"), "{error}");
        }
    }

    #[test]
    fn constants_read_back_as_they_were() {
        for value in [aabb::PAD_ENTRY, aabb::PAD_EXIT, ray::PARALLEL, ray::LEAST_OUTWARDS_SHORT, f32::MAX] {
            assert_eq!(float(value).trim_end_matches('f').parse(), Ok(value));
        }
    }
}
