//! The list of all kernels, for the checks of all of them.

use super::kernel::Kernel;
use super::list_layout::MOST_LAYERS;
use super::tree::Tree;
use ropewalk::bvh::{MAX_DEPTH, StackOrder};
use ropewalk::catalogue::{StackMemory, TrailOptions, TrailRegister, is_offered};
use ropewalk::two_level::SmartStack;
use ropewalk::{DeviceKind, Query, Walk};

impl Kernel {
    /// Every kernel that a structure of the catalogue can ask for, but for the stacks of two levels, and the rings of smart
    /// stacks, of other sizes than the smallest and the largest.
    #[must_use]
    pub fn every() -> Vec<Self> {
        let mut kernels = Vec::new();
        for tree in Tree::EVERY {
            for walk in walks() {
                for query in Query::EVERY {
                    let is_resolved = tree.resolve(walk, 0) == Ok(walk);
                    if !is_resolved || !is_offered(tree.kind(), walk, query, DeviceKind::Gpu) {
                        continue;
                    }
                    for stack_entries in stack_sizes(tree, walk) {
                        for starts in starts(tree) {
                            for counters in [false, true] {
                                kernels.push(Self { tree, walk, query, counters, stack_entries, starts });
                            }
                        }
                    }
                }
            }
        }
        kernels
    }
}

/// Every walk that [`Tree::resolve`] gives of some tree.
pub(super) fn walks() -> Vec<Walk> {
    let mut walks: Vec<Walk> = StackOrder::NAMES.iter().map(|&(_, order)| Walk::Stack(order)).collect();
    for &(_, register) in TrailRegister::NAMES {
        for short_stack in 0..=TrailOptions::MAX_SHORT_STACK {
            for memory in [StackMemory::Private, StackMemory::Workgroup] {
                let options = TrailOptions { short_stack, register, memory };
                if short_stack > 0 || memory == StackMemory::Private {
                    walks.push(Walk::RestartTrail(options));
                }
            }
        }
    }
    walks.extend([Walk::List, Walk::KdRestart, Walk::KdBacktrack, Walk::Ropes]);
    walks.extend((1..=Walk::MAX_SHORT_STACK).map(|entries| Walk::ShortStack { entries }));
    // The smallest ring and the largest: what lies between differs by a constant.
    walks.extend([SmartStack::LEAST_BYTES, SmartStack::MOST_BYTES].map(|bytes| Walk::SmartStack { bytes }));
    walks
}

/// The numbers of layers that rays may have heads for.
fn starts(tree: Tree) -> std::ops::RangeInclusive<u32> {
    match tree {
        Tree::Binary | Tree::Wide(_) | Tree::Kd | Tree::Levels(_) => 0..=0,
        Tree::List { .. } => 0..=MOST_LAYERS as u32,
    }
}

/// The stack sizes that a tree can need: one child a level is postponed in a binary one, all but one in a wide one.
pub(super) fn stack_sizes(tree: Tree, walk: Walk) -> Vec<u32> {
    let most = match (walk, tree) {
        (Walk::Stack(_), Tree::Binary | Tree::Kd) => MAX_DEPTH,
        // The smallest and the largest: what lies between differs by a constant.
        (Walk::Stack(_) | Walk::SmartStack { .. }, Tree::Levels(bottoms)) => {
            let of_object = bottoms.width().map_or(1, |width| width.children() as u32 - 1);
            return vec![Kernel::STACK_STEP, MAX_DEPTH * (1 + of_object)];
        }
        (Walk::Stack(_), Tree::Wide(width)) => MAX_DEPTH * (width.children() as u32 - 1),
        _ => return vec![0],
    };
    (Kernel::STACK_STEP..=most).step_by(Kernel::STACK_STEP as usize).collect()
}
