//! The knobs of a packed tree.

use super::SimdLevel;

/// How much work goes into a tree, and what for.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum Preset {
    /// The order of a space-filling curve: built in a third of the time of the next, for scenes that change all the time. Rays
    /// take a tenth longer where triangles are alike, a half where they are not.
    Fastest,
    /// The surface area heuristic at a few planes, with full leaves.
    Fast,
    /// The surface area heuristic at planes between bins: what most scenes want.
    #[default]
    Balanced,
    /// The same, and then subtrees move to where they make the boxes above them smaller: twice the time to build, for scenes that
    /// stay, most of all buildings and machines.
    High,
    /// As balanced, in half of the memory: boxes of a byte a side, leaves that are full rather than small, and vertices that
    /// triangles share. For scenes that hardly fit, and do not move: such a tree cannot be refitted. Rays take a fifth to a third
    /// longer.
    Compact,
}

impl Preset {
    /// Every preset.
    pub const EVERY: [Self; 5] = [Self::Fastest, Self::Fast, Self::Balanced, Self::High, Self::Compact];

    /// The names on the command line.
    pub const NAMES: &[(&str, Self)] = &[
        ("fastest", Self::Fastest),
        ("fast", Self::Fast),
        ("balanced", Self::Balanced),
        ("high", Self::High),
        ("compact", Self::Compact),
    ];

    /// Whether a tree of this preset can follow triangles that move ([`Bvh8::refit`](super::Bvh8::refit)).
    #[must_use]
    pub const fn can_refit(self) -> bool {
        !matches!(self, Self::Compact)
    }
}

/// The options of a packed tree.
///
/// ```
/// use ropewalk::bvh8::{Preset, SimdLevel};
/// use ropewalk::Bvh8Options;
/// let best = Bvh8Options { preset: Preset::High, ..Bvh8Options::default() };
/// let anywhere = Bvh8Options { level: Some(SimdLevel::Portable), ..best };
/// ```
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Bvh8Options {
    /// What builds the tree.
    pub preset: Preset,
    /// The vector instructions that walks use; `None` for the best that the machine has, which is also taken for a level that it
    /// does not have.
    pub level: Option<SimdLevel>,
}
