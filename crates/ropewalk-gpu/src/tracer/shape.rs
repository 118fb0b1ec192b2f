//! What kernels and budgets depend on in a structure.

use crate::GpuError;
use crate::shader::Tree;
use ropewalk::{BuildReport, Structure, TraversalList, Walk};

/// What kernels and budgets depend on.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Shape {
    /// How the nodes are laid out.
    pub(super) tree: Tree,
    /// Binary nodes, wide ones, or elements of all lists.
    pub(super) node_count: u32,
    /// The depth of the deepest leaf, as the structure's report has it.
    pub(super) depth: u32,
    /// The most entries that the stack of a stack walk can hold.
    pub(super) stack_entries: u32,
    /// Whether a triangle may stand in several leaves, or in a list several times.
    pub(super) has_repeats: bool,
    /// Nodes and leaves that a walk with a full stack can enter, each once; elements that a ray can meet in its lists.
    pub(super) entered: u64,
    /// Leaves.
    pub(super) leaves: u64,
    /// Where the places and ropes of a kd-tree do not fit the device, the bytes that its nodes would need with them; else 0.
    pub(super) left_out: u64,
    /// The bytes that a buffer of the device may have, where something was left out.
    pub(super) room: u64,
}

impl Shape {
    /// Of a tree.
    pub(super) fn of_tree(tree: Tree, structure: &Structure, node_count: usize, stack_entries: u32) -> Self {
        let &BuildReport { nodes, leaves, depth, .. } = structure.report();
        Self {
            tree,
            // A tree has fewer than 2^32 nodes: links are 32 bits.
            node_count: node_count as u32,
            depth,
            stack_entries,
            has_repeats: structure.has_repeats(),
            entered: nodes as u64,
            leaves: leaves as u64,
            left_out: 0,
            room: 0,
        }
    }

    /// Of traversal lists.
    pub(super) fn of_lists(lists: &TraversalList) -> Self {
        let of_direction =
            |list| (0..lists.layers()).map(|layer| lists.list_of_layer(layer, list).len()).sum();
        let most: usize = (0..lists.options().directions.lists()).map(of_direction).max().unwrap_or(0);
        let &BuildReport { leaves, depth, .. } = lists.report();
        Self {
            tree: Tree::List { bounds: lists.options().bounds, one_sided: lists.is_one_sided() },
            // No more than an escape index leads over: 31 bits.
            node_count: lists.elements().len() as u32,
            depth,
            stack_entries: 0,
            has_repeats: lists.has_repeats(),
            entered: most as u64,
            leaves: leaves as u64,
            left_out: 0,
            room: 0,
        }
    }

    /// Refuses a walk that reads what was left out for want of room.
    pub(super) fn check_places(&self, walk: Walk) -> Result<(), GpuError> {
        if self.left_out == 0 || !matches!(walk, Walk::KdBacktrack | Walk::Ropes) {
            return Ok(());
        }
        Err(GpuError::TooLarge {
            what: "nodes, places and ropes of the kd-tree",
            needed: self.left_out,
            limit: self.room,
            limit_name: "max_storage_buffer_binding_size and max_buffer_size",
            way_out: "walk by restart-trail, short-stack or stack, which need the nodes alone, or trace on the CPU",
        })
    }

    /// Steps that no ray uses up, a step being a node, a leaf or an element that is entered.
    ///
    /// A walk with a full stack enters each once, and so does a walk of a ray's lists. A restart trail goes down from the
    /// root or from an entry of its stack again and again. Each way down is no longer than the longest path, and ends with
    /// a leaf that the walk is done with for good: so there are no more ways down than leaves. With spatial splits a
    /// triangle may be hit in front of the leaf that it was found in, which then culls a node that the walk is in; in a
    /// binary tree the trail cannot tell, and leads through that node's sibling again, at worst once for each node above a
    /// leaf.
    ///
    /// The walks that go from leaf to leaf of a kd-tree finish a leaf on each way down, or up and down again; at any time they
    /// may hand a ray over to the trail.
    ///
    /// Where that is more than a word holds, a ray would take minutes to count so far, and no driver waits so long.
    pub(super) fn step_budget(&self, walk: Walk) -> u32 {
        let path = u64::from(self.depth) + 1;
        let ways_down = self.leaves.saturating_mul(path);
        let by_trail = match self.tree {
            Tree::Binary | Tree::Kd if self.has_repeats => ways_down.saturating_mul(path),
            _ => ways_down,
        };
        let steps = match walk {
            Walk::RestartTrail(_) => by_trail,
            Walk::KdRestart | Walk::KdBacktrack | Walk::ShortStack { .. } | Walk::Ropes => {
                by_trail.saturating_add(ways_down.saturating_mul(2))
            }
            _ => self.entered,
        };
        u32::try_from(steps).unwrap_or(u32::MAX)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use ropewalk::wide_bvh::Width;

    #[test]
    fn budgets_grow_with_the_tree_and_end_at_the_largest_word() {
        let shape = Shape {
            tree: Tree::Binary,
            node_count: 9,
            depth: 3,
            stack_entries: 3,
            has_repeats: false,
            entered: 9,
            leaves: 5,
            left_out: 0,
            room: 0,
        };
        let trail = "restart-trail".parse().unwrap();
        assert_eq!([shape.step_budget(Walk::default()), shape.step_budget(trail)], [9, 20]);
        let repeats = Shape { has_repeats: true, ..shape };
        assert_eq!([repeats.step_budget(Walk::default()), repeats.step_budget(trail)], [9, 80]);
        let wide = Shape { tree: Tree::Wide(Width::Four), ..repeats };
        assert_eq!(wide.step_budget(trail), 20);
        let [kd, ropes] = [Shape { tree: Tree::Kd, ..shape }, Shape { tree: Tree::Kd, ..repeats }];
        assert_eq!([kd.step_budget(trail), kd.step_budget(Walk::KdRestart)], [20, 60]);
        assert_eq!([ropes.step_budget(trail), ropes.step_budget(Walk::Ropes)], [80, 120]);
        let large = Shape { leaves: 1 << 31, entered: (1 << 32) - 1, depth: 64, ..repeats };
        assert_eq!([large.step_budget(Walk::default()), large.step_budget(trail)], [u32::MAX; 2]);
        let empty = Shape { leaves: 0, entered: 0, node_count: 0, depth: 0, ..shape };
        assert_eq!(empty.step_budget(trail), 0, "there is nothing to enter");
    }
}
