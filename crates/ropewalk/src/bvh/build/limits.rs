//! What a node may become: the leaf rule and the depth cap, the same for every builder.
//!
//! A node of at most `max_leaf` references is a leaf unless the surface area heuristic (1 for a node, 1 for a
//! triangle) expects the best split to be cheaper. The depth cap is kept by falling back to halving: a split is
//! taken only when both sides still fit under the cap with full leaves. Halving keeps what fits fitting, so a leaf
//! grows beyond `max_leaf` only where the whole input does not fit.

use crate::bvh::BuildOptions;

/// What the options leave to a node at some depth.
#[derive(Clone, Copy)]
pub(super) struct Limits {
    max_leaf: usize,
    /// How many levels there may be below the node.
    levels: u32,
}

/// What becomes of a node.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Choice {
    /// A leaf.
    Leaf,
    /// The best split is taken.
    Split,
    /// It is halved, whatever that costs.
    Halve,
}

impl Limits {
    pub(super) const fn at(options: &BuildOptions, depth: u32) -> Self {
        Self { max_leaf: options.max_leaf as usize, levels: options.max_depth.saturating_sub(depth) }
    }

    /// Whether a node of `count` references can only be a leaf.
    pub(super) const fn forces_leaf(&self, count: usize) -> bool {
        count <= 1 || self.levels == 0
    }

    /// Whether two children of so many references each fit under the cap with full leaves.
    pub(super) fn fits(&self, counts: [usize; 2]) -> bool {
        let room = (self.max_leaf as u64) << self.levels.saturating_sub(1).min(32);
        counts.iter().all(|&count| count as u64 <= room)
    }

    /// What becomes of a node of `count` references and half the surface area `area`. `best` is the best split: the
    /// sum over both sides of half area times count, and the counts.
    pub(super) fn choose(&self, count: usize, area: f32, best: Option<(f32, [usize; 2])>) -> Choice {
        let may_be_leaf = count <= self.max_leaf;
        match best {
            // All areas times 1 / the node's: a leaf costs its triangles, a split one more for the node.
            Some((cost, _)) if may_be_leaf && area + cost >= area * count as f32 => Choice::Leaf,
            Some((_, counts)) if self.fits(counts) => Choice::Split,
            None if may_be_leaf => Choice::Leaf,
            _ => Choice::Halve,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn limits(max_leaf: u32, max_depth: u32, depth: u32) -> Limits {
        Limits::at(&BuildOptions { max_leaf, max_depth, ..BuildOptions::default() }, depth)
    }

    #[test]
    fn a_split_must_be_cheaper_than_a_leaf_where_there_may_be_one() {
        let limits = limits(4, 48, 0);
        assert_eq!(limits.choose(4, 1.0, Some((2.9, [2, 2]))), Choice::Split);
        assert_eq!(limits.choose(4, 1.0, Some((3.0, [2, 2]))), Choice::Leaf);
        assert_eq!(limits.choose(4, 1.0, None), Choice::Leaf);
        assert_eq!(limits.choose(5, 1.0, Some((9.0, [2, 3]))), Choice::Split);
        assert_eq!(limits.choose(5, 1.0, None), Choice::Halve);
    }

    #[test]
    fn a_split_must_leave_room_under_the_cap() {
        // Two levels below, leaves of four: each side may have eight.
        let limits = limits(4, 10, 8);
        assert_eq!(limits.choose(16, 1.0, Some((1.0, [8, 8]))), Choice::Split);
        assert_eq!(limits.choose(16, 1.0, Some((1.0, [7, 9]))), Choice::Halve);
        assert!(!limits.forces_leaf(16) && limits.forces_leaf(1));
        assert!(Limits { levels: 0, ..limits }.forces_leaf(16));
    }
}
