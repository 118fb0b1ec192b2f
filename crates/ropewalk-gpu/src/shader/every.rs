//! The list of all kernels, for the checks of all of them.

use super::kernel::Kernel;
use super::list_layout::MOST_LAYERS;
use super::tree::Tree;
use ropewalk::bvh::{MAX_DEPTH, StackOrder};
use ropewalk::catalogue::{StackMemory, TrailOptions, TrailRegister, is_offered};
use ropewalk::{DeviceKind, Query, Walk};

impl Kernel {
    /// Every kernel that a structure of the catalogue can ask for.
    #[must_use]
    pub fn every() -> Vec<Self> {
        let mut kernels = Vec::new();
        for tree in Tree::EVERY {
            for walk in walks() {
                for query in Query::EVERY {
                    if !is_offered(tree.kind(), walk, query, DeviceKind::Gpu) {
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

/// Every walk as [`Tree::resolve`] gives it.
pub(super) fn walks() -> Vec<Walk> {
    let mut walks: Vec<Walk> = StackOrder::NAMES.iter().map(|&(_, order)| Walk::Stack(order)).collect();
    for register in [TrailRegister::U32, TrailRegister::U64, TrailRegister::Array] {
        for short_stack in 0..=TrailOptions::MAX_SHORT_STACK {
            for memory in [StackMemory::Private, StackMemory::Workgroup] {
                let options = TrailOptions { short_stack, register, memory };
                if short_stack > 0 || memory == StackMemory::Private {
                    walks.push(Walk::RestartTrail(options));
                }
            }
        }
    }
    walks.push(Walk::List);
    walks
}

/// The numbers of layers that rays may have heads for.
fn starts(tree: Tree) -> std::ops::RangeInclusive<u32> {
    match tree {
        Tree::Binary | Tree::Wide(_) => 0..=0,
        Tree::List { .. } => 0..=MOST_LAYERS as u32,
    }
}

/// The stack sizes that a tree can need: one child a level is postponed in a binary one, all but one in a wide one.
pub(super) fn stack_sizes(tree: Tree, walk: Walk) -> Vec<u32> {
    let most = match (walk, tree) {
        (Walk::RestartTrail(_) | Walk::List, _) | (_, Tree::List { .. }) => return vec![0],
        (_, Tree::Binary) => MAX_DEPTH,
        (_, Tree::Wide(width)) => MAX_DEPTH * (width.children() as u32 - 1),
    };
    (Kernel::STACK_STEP..=most).step_by(Kernel::STACK_STEP as usize).collect()
}
