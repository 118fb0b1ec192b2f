//! What a kernel goes through: trees and lists, by their layout.

use ropewalk::catalogue::{StackMemory, TrailOptions};
use ropewalk::traversal_list::Bounds;
use ropewalk::wide_bvh::Width;
use ropewalk::{StructureKind, TraceError, Walk};

/// What a kernel goes through: a structure by its layout.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Tree {
    /// [`ropewalk::Bvh`].
    Binary,
    /// [`ropewalk::WideBvh`].
    Wide(Width),
    /// [`ropewalk::TraversalList`].
    List {
        /// What bounds an inner node.
        bounds: Bounds,
        /// Whether triangles are hit from the front alone.
        one_sided: bool,
    },
}

impl Tree {
    /// Every layout.
    pub const EVERY: [Self; 7] = [
        Self::Binary,
        Self::Wide(Width::Four),
        Self::Wide(Width::Eight),
        Self::List { bounds: Bounds::Sphere, one_sided: false },
        Self::List { bounds: Bounds::Sphere, one_sided: true },
        Self::List { bounds: Bounds::Aabb, one_sided: false },
        Self::List { bounds: Bounds::Aabb, one_sided: true },
    ];

    /// The catalogue's name for it.
    #[must_use]
    pub const fn kind(self) -> StructureKind {
        match self {
            Self::Binary => StructureKind::Bvh,
            Self::Wide(_) => StructureKind::WideBvh,
            Self::List { .. } => StructureKind::List,
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
            // Refused by the catalogue: a list is no tree to find a way back in.
            Self::List { .. } => return Ok(walk),
        };
        let short_stack = options.short_stack.min(TrailOptions::MAX_SHORT_STACK);
        // Where there is no stack, it is nowhere.
        let memory = if short_stack == 0 { StackMemory::Private } else { options.memory };
        Ok(Walk::RestartTrail(TrailOptions { short_stack, register, memory }))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use ropewalk::catalogue::TrailRegister;

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
}
