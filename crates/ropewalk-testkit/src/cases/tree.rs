//! The trees over which a case is asked: those of builders, and chains that no builder makes.
//!
//! A tree as deep as a register of 63 levels takes more than the range of f32 to provoke: the surface area heuristic
//! cuts off several triangles of a chain at a time. So the deepest trees are made by hand.

use super::Case;
use ropewalk::bvh::{LeafOrder, Node};
use ropewalk::{
    Aabb, BuildOptions, Builder, Bvh, FlatTriangle, NoMonitor, Structure, StructureSpec, WideBvh,
};
use std::fmt;

/// A tree over the triangles of a case.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Tree {
    /// How it is built; of a chain the settings that describe it best.
    pub spec: StructureSpec,
    /// Whether it is a chain of depth `max_depth`, made by hand.
    pub is_chain: bool,
}

impl Tree {
    /// A tree that a builder makes.
    #[must_use]
    pub const fn built(spec: StructureSpec) -> Self {
        Self { spec, is_chain: false }
    }

    /// The chains in place of what a structure would be; none for settings that mean nothing to a chain.
    pub(super) fn chains(row: StructureSpec, depths: &'static [u32]) -> impl Iterator<Item = Self> {
        let options = row.build_options().copied();
        let is_plain =
            |options| BuildOptions { leaf_order: LeafOrder::Split, ..options } == BuildOptions::default();
        let depths = if options.is_some_and(is_plain) { depths } else { &[] };
        let options = options.unwrap_or_default();
        depths.iter().map(move |&max_depth| {
            let spec = row.with_build_options(BuildOptions { max_depth, max_leaf: 1, ..options });
            Self { spec, is_chain: true }
        })
    }

    /// Builds the tree.
    ///
    /// # Errors
    /// When the scene cannot be built.
    pub fn build(&self, case: &Case) -> Result<Structure, String> {
        if !self.is_chain {
            return self.spec.build(&case.scene, &NoMonitor).map_err(|error| error.to_string());
        }
        let flat = case.scene.flatten().map_err(|error| error.to_string())?;
        let options = self.spec.build_options().copied().unwrap_or_default();
        debug_assert_eq!(options.builder, Builder::BinnedSah);
        let chain = chain(&flat.triangles, options.max_depth, options.leaf_order)?;
        match self.spec {
            StructureSpec::Bvh(_) => Ok(Structure::Bvh(chain)),
            StructureSpec::WideBvh(wide) => {
                Ok(Structure::WideBvh(WideBvh::from_bvh(&chain, wide.width, wide.collapse)))
            }
            _ => Err("there is no chain of this structure".into()),
        }
    }
}

impl fmt::Display for Tree {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(formatter, "{}{}", self.spec, if self.is_chain { " as a chain" } else { "" })
    }
}

/// A tree in which every inner node has a leaf of one triangle, down to `depth`, where the last leaf holds the rest.
/// The leaf comes first with [`LeafOrder::Left`], else the chain.
///
/// # Errors
/// When there are too few triangles for the depth.
fn chain(triangles: &[FlatTriangle], depth: u32, order: LeafOrder) -> Result<Bvh, String> {
    let depth = depth as usize;
    if triangles.len() <= depth {
        return Err(format!("{} triangles make no chain of depth {depth}", triangles.len()));
    }
    let bounds_of = |some: &[FlatTriangle]| {
        some.iter().map(|triangle| triangle.triangle().bounds()).fold(Aabb::EMPTY, Aabb::union)
    };
    let leaf = |first: usize, count: usize| {
        Node::leaf(&bounds_of(&triangles[first..first + count]), first as u32, count as u32)
    };
    let mut nodes = Vec::with_capacity(2 * depth + 1);
    for level in 0..depth {
        // Leaf first: the chain goes on two nodes further. Chain first: its nodes all come before the leaf.
        let second = match order {
            LeafOrder::Left => 2 * level + 2,
            LeafOrder::Split => 2 * depth - level,
        };
        nodes.push(Node::inner(&bounds_of(&triangles[level..]), second as u32));
        if order == LeafOrder::Left {
            nodes.push(leaf(level, 1));
        }
    }
    nodes.push(leaf(depth, triangles.len() - depth));
    if order == LeafOrder::Split {
        nodes.extend((0..depth).rev().map(|level| leaf(level, 1)));
    }
    Bvh::from_parts(nodes, triangles.to_vec()).map_err(|error| error.to_string())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn chains_are_as_deep_as_they_say() {
        let flat = Case::named("chain").unwrap().scene.flatten().unwrap();
        for order in [LeafOrder::Left, LeafOrder::Split] {
            for depth in [1, 2, 31, 32, 63, 64] {
                let bvh = chain(&flat.triangles, depth, order).unwrap();
                assert_eq!((bvh.report().depth, bvh.report().leaves), (depth, depth as usize + 1));
                assert_eq!(bvh.nodes()[1].is_leaf(), order == LeafOrder::Left || depth == 1);
            }
            assert!(chain(&flat.triangles, 65, order).is_err(), "deeper than any tree may be");
        }
        assert!(chain(&flat.triangles[..3], 3, LeafOrder::Left).is_err());
    }
}
