//! What a kernel goes through: trees and lists, by their layout.

use ropewalk::catalogue::{StackMemory, TrailOptions, TrailRegister};
use ropewalk::traversal_list::Bounds;
use ropewalk::two_level::SmartStack;
use ropewalk::wide_bvh::Width;
use ropewalk::{StructureKind, TraceError, Walk};

/// What structures the objects of a two-level structure have.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum LevelBottoms {
    /// Kd-trees.
    KdTree,
    /// Binary BVHs.
    Bvh,
    /// Wide BVHs.
    Wide(Width),
    /// Traversal lists.
    List {
        /// What bounds an inner node.
        bounds: Bounds,
        /// Whether triangles are hit from the front alone.
        one_sided: bool,
    },
    /// Several kinds, or all of them.
    Mixed {
        /// Of the wide BVHs.
        width: Width,
        /// What bounds an inner node of the lists.
        bounds: Bounds,
    },
}

impl LevelBottoms {
    /// Every one.
    pub const EVERY: [Self; 12] = [
        Self::KdTree,
        Self::Bvh,
        Self::Wide(Width::Four),
        Self::Wide(Width::Eight),
        Self::List { bounds: Bounds::Sphere, one_sided: false },
        Self::List { bounds: Bounds::Sphere, one_sided: true },
        Self::List { bounds: Bounds::Aabb, one_sided: false },
        Self::List { bounds: Bounds::Aabb, one_sided: true },
        Self::Mixed { width: Width::Four, bounds: Bounds::Sphere },
        Self::Mixed { width: Width::Four, bounds: Bounds::Aabb },
        Self::Mixed { width: Width::Eight, bounds: Bounds::Sphere },
        Self::Mixed { width: Width::Eight, bounds: Bounds::Aabb },
    ];

    /// Whether there may be kd-trees.
    #[must_use]
    pub const fn has_kd_trees(self) -> bool {
        matches!(self, Self::KdTree | Self::Mixed { .. })
    }

    /// The width of the wide BVHs, where there may be any.
    #[must_use]
    pub const fn width(self) -> Option<Width> {
        match self {
            Self::Wide(width) | Self::Mixed { width, .. } => Some(width),
            _ => None,
        }
    }

    /// What bounds the inner nodes of the lists, where there may be any.
    #[must_use]
    pub const fn bounds(self) -> Option<Bounds> {
        match self {
            Self::List { bounds, .. } | Self::Mixed { bounds, .. } => Some(bounds),
            _ => None,
        }
    }

    /// What serves both kinds; `None` where they have lists of other volumes, or of one side and of two, or wide BVHs of other
    /// widths.
    #[must_use]
    pub fn and(self, other: Self) -> Option<Self> {
        if self == other {
            return Some(self);
        }
        let one_sided = |bottoms| matches!(bottoms, Self::List { one_sided: true, .. });
        let same = |a: Option<_>, b: Option<_>| a.is_none() || b.is_none() || a == b;
        if one_sided(self) || one_sided(other) || !same(self.width(), other.width()) {
            return None;
        }
        if self.bounds().is_some() && other.bounds().is_some() && self.bounds() != other.bounds() {
            return None;
        }
        Some(Self::Mixed {
            width: self.width().or(other.width()).unwrap_or_default(),
            bounds: self.bounds().or(other.bounds()).unwrap_or_default(),
        })
    }
}

/// What a kernel goes through: a structure by its layout.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Tree {
    /// [`ropewalk::Bvh`].
    Binary,
    /// [`ropewalk::WideBvh`].
    Wide(Width),
    /// [`ropewalk::KdTree`].
    Kd,
    /// [`ropewalk::TraversalList`].
    List {
        /// What bounds an inner node.
        bounds: Bounds,
        /// Whether triangles are hit from the front alone.
        one_sided: bool,
    },
    /// [`ropewalk::TwoLevel`].
    Levels(LevelBottoms),
}

impl Tree {
    /// Every layout.
    pub const EVERY: [Self; 20] = [
        Self::Binary,
        Self::Wide(Width::Four),
        Self::Wide(Width::Eight),
        Self::Kd,
        Self::List { bounds: Bounds::Sphere, one_sided: false },
        Self::List { bounds: Bounds::Sphere, one_sided: true },
        Self::List { bounds: Bounds::Aabb, one_sided: false },
        Self::List { bounds: Bounds::Aabb, one_sided: true },
        Self::Levels(LevelBottoms::EVERY[0]),
        Self::Levels(LevelBottoms::EVERY[1]),
        Self::Levels(LevelBottoms::EVERY[2]),
        Self::Levels(LevelBottoms::EVERY[3]),
        Self::Levels(LevelBottoms::EVERY[4]),
        Self::Levels(LevelBottoms::EVERY[5]),
        Self::Levels(LevelBottoms::EVERY[6]),
        Self::Levels(LevelBottoms::EVERY[7]),
        Self::Levels(LevelBottoms::EVERY[8]),
        Self::Levels(LevelBottoms::EVERY[9]),
        Self::Levels(LevelBottoms::EVERY[10]),
        Self::Levels(LevelBottoms::EVERY[11]),
    ];

    /// The catalogue's name for it.
    #[must_use]
    pub const fn kind(self) -> StructureKind {
        match self {
            Self::Binary => StructureKind::Bvh,
            Self::Wide(_) => StructureKind::WideBvh,
            Self::Kd => StructureKind::KdTree,
            Self::List { .. } => StructureKind::List,
            Self::Levels(_) => StructureKind::TwoLevel,
        }
    }

    /// The walk as a kernel has it: with a register that goes through a tree of this depth, and with no choice left
    /// that would make no difference.
    ///
    /// # Errors
    /// When a register is prescribed that is too small.
    pub fn resolve(self, walk: Walk, depth: u32) -> Result<Walk, TraceError> {
        let options = match walk {
            Walk::RestartTrail(options) => options,
            Walk::SmartStack { bytes } => return Ok(Walk::SmartStack { bytes: SmartStack::round(bytes) }),
            _ => return Ok(walk),
        };
        let register = match self {
            Self::Binary => options.register_for(depth)?,
            Self::Wide(_) => options.wide_register_for(depth)?,
            // Two words lead through the deepest.
            Self::Kd => TrailRegister::Auto,
            // Refused by the catalogue: a list is no tree to find a way back in, and two levels are two.
            Self::List { .. } | Self::Levels(_) => return Ok(walk),
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

    #[test]
    fn kinds_of_objects_mix_where_one_kernel_serves_them() {
        let [four, eight] = [Width::Four, Width::Eight];
        let list = |bounds, one_sided| LevelBottoms::List { bounds, one_sided };
        let mixed = |width, bounds| Some(LevelBottoms::Mixed { width, bounds });
        let (wide, spheres) = (LevelBottoms::Wide(eight), list(Bounds::Sphere, false));
        assert_eq!(LevelBottoms::Bvh.and(LevelBottoms::Bvh), Some(LevelBottoms::Bvh));
        assert_eq!(wide.and(spheres), mixed(eight, Bounds::Sphere));
        assert_eq!(
            mixed(eight, Bounds::Sphere).and_then(|both| both.and(wide)),
            mixed(eight, Bounds::Sphere)
        );
        assert_eq!(wide.and(LevelBottoms::Wide(four)), None);
        assert_eq!(spheres.and(list(Bounds::Aabb, false)), None);
        assert_eq!(list(Bounds::Aabb, true).and(LevelBottoms::KdTree), None);
        assert_eq!(list(Bounds::Aabb, true).and(list(Bounds::Aabb, true)), Some(list(Bounds::Aabb, true)));
    }

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
