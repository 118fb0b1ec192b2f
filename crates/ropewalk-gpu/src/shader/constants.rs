//! The constants that all kernels have in common, from the Rust code that has them.

use super::assembly::Definitions;
use super::kernel::{BATCH_GROUP, STATUS_WRITTEN, STRUCTURE_GROUP};
use super::{kd_layout, level_layout, list_layout};
use crate::gpu::WORKGROUP_SIZE;
use ropewalk::traversal_list::NO_HEAD;
use ropewalk::two_level::DIRECTION_STEP;
use ropewalk::{
    FlatTriangle, Hit, LARGEST_DIRECTION, SMALLEST_DIRECTION, Sphere, Status, aabb, kd_tree, ray,
};

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
        .text("SMALLEST_DIRECTION", float(SMALLEST_DIRECTION))
        .text("LARGEST_DIRECTION", float(LARGEST_DIRECTION))
        .text("DIRECTION_STEP", float(DIRECTION_STEP))
        .text("LEVEL_HEADER_FOURS", level_layout::HEADER_FOURS)
        .text("LEVEL_OBJECT_FOURS", level_layout::OBJECT_FOURS)
        .text("LEVEL_BVH", word(level_layout::BVH))
        .text("LEVEL_KD_TREE", word(level_layout::KD_TREE))
        .text("LEVEL_WIDE_BVH", word(level_layout::WIDE_BVH))
        .text("LEVEL_LIST", word(level_layout::LIST))
        .text("LIST_BUFFERS", "shared/list_buffers")
        .text("KD_BAND", float(kd_tree::walk::BAND))
        .text("KD_HEADER_PAIRS", kd_layout::HEADER_PAIRS)
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

    #[test]
    fn constants_read_back_as_they_were() {
        for value in
            [aabb::PAD_ENTRY, aabb::PAD_EXIT, ray::PARALLEL, ray::LEAST_OUTWARDS_SHORT, Sphere::PAD, f32::MAX]
        {
            assert_eq!(float(value).trim_end_matches('f').parse(), Ok(value));
        }
    }
}
