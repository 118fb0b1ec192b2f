//! Walks and their settings.

use super::spec::{Spec, Written, number, pick, unknown};
use crate::bvh::StackOrder;
use crate::bvh::walk::{Trail, TrailU32, TrailU64};
use crate::error::{CatalogueError, TraceError};
use crate::two_level::SmartStack;
use crate::wide_bvh::walk as wide;
use std::fmt;
use std::str::FromStr;

/// How a ray goes through a structure.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Walk {
    /// Tests every triangle; no hierarchy takes part.
    BruteForce,
    /// Depth first by recursion.
    Recursive,
    /// A loop with a stack.
    Stack(StackOrder),
    /// A loop with a short stack, or none, and a trail that leads back after a restart.
    RestartTrail(TrailOptions),
    /// On by one element, or by as many as its escape index says.
    List,
    /// Back to the root of a kd-tree after each leaf.
    KdRestart,
    /// Back to the nearest node of a kd-tree that the ray has not left.
    KdBacktrack,
    /// A short stack for a kd-tree; when it is exhausted, back to the deepest node that holds the rest of the ray.
    ShortStack {
        /// Entries, 1 to [`Walk::MAX_SHORT_STACK`].
        entries: u32,
    },
    /// From leaf to leaf of a kd-tree by the links of its faces.
    Ropes,
    /// One loop and one ring of bytes for both levels of a two-level structure.
    SmartStack {
        /// Bytes of the ring, [`SmartStack::LEAST_BYTES`] to [`SmartStack::MOST_BYTES`], a multiple of 4.
        bytes: u32,
    },
}

/// Where the restart trail keeps its bits, which also limits how deep a tree may be.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum TrailRegister {
    /// The smallest that serves the tree.
    #[default]
    Auto,
    /// An array: any depth.
    Array,
    /// 32 bits: binary trees of depth 31.
    U32,
    /// 64 bits: binary trees of depth 63, wide ones of 16 levels. Two words on a GPU.
    U64,
}

impl TrailRegister {
    /// The names on the command line.
    pub const NAMES: &[(&str, Self)] =
        &[("auto", Self::Auto), ("array", Self::Array), ("u32", Self::U32), ("u64", Self::U64)];
}

/// Where a GPU keeps the short stack.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum StackMemory {
    /// In the memory of the invocation.
    #[default]
    Private,
    /// In the memory that a workgroup shares. There is none on a CPU.
    Workgroup,
}

impl StackMemory {
    /// The names on the command line.
    pub const NAMES: &[(&str, Self)] = &[("private", Self::Private), ("workgroup", Self::Workgroup)];
}

/// The settings of the restart trail.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct TrailOptions {
    /// Entries of the short stack, 0 to [`TrailOptions::MAX_SHORT_STACK`].
    pub short_stack: u32,
    /// Where the trail is kept.
    pub register: TrailRegister,
    /// Where a GPU keeps the short stack.
    pub memory: StackMemory,
}

impl Default for TrailOptions {
    /// Four entries: within a few percent of the visits of a full stack.
    fn default() -> Self {
        Self { short_stack: 4, register: TrailRegister::Auto, memory: StackMemory::Private }
    }
}

impl TrailOptions {
    /// The most entries of a short stack.
    pub const MAX_SHORT_STACK: u32 = 16;

    /// The register for a binary tree whose deepest leaf has this depth: the prescribed one, or the smallest that
    /// serves.
    ///
    /// # Errors
    /// When the prescribed one is too small.
    pub fn register_for(self, depth: u32) -> Result<TrailRegister, TraceError> {
        self.choose(depth, &[(TrailRegister::U32, TrailU32::LEVELS), (TrailRegister::U64, TrailU64::LEVELS)])
    }

    /// The register for a wide tree of this many levels of inner nodes: the prescribed one, or the smallest that
    /// serves.
    ///
    /// # Errors
    /// When the prescribed one is too small.
    pub fn wide_register_for(self, levels: u32) -> Result<TrailRegister, TraceError> {
        self.choose(levels, &[(TrailRegister::U64, <wide::TrailU64 as wide::Trail>::LEVELS)])
    }

    /// Chooses among the registers with a limit, the smallest first. The array has none.
    fn choose(self, depth: u32, registers: &[(TrailRegister, u32)]) -> Result<TrailRegister, TraceError> {
        let mut registers = registers.iter().copied();
        if self.register == TrailRegister::Auto {
            let smallest = registers.find(|&(_, limit)| depth <= limit);
            return Ok(smallest.map_or(TrailRegister::Array, |(register, _)| register));
        }
        match registers.find(|&(register, limit)| register == self.register && depth > limit) {
            Some((_, limit)) => Err(TraceError::too_deep(Walk::RestartTrail(self), depth, limit)),
            None => Ok(self.register),
        }
    }
}

impl Default for Walk {
    fn default() -> Self {
        Self::Stack(StackOrder::Ordered)
    }
}

const fn trail(short_stack: u32, register: TrailRegister, memory: StackMemory) -> Walk {
    Walk::RestartTrail(TrailOptions { short_stack, register, memory })
}

impl Walk {
    /// Every walk, in the settings in which the conformance suite tries it against the oracle. The short stacks of
    /// the sizes between are compared with these.
    pub const EVERY: [Self; 20] = [
        Self::BruteForce,
        Self::Recursive,
        Self::Stack(StackOrder::Unordered),
        Self::Stack(StackOrder::Culled),
        Self::Stack(StackOrder::Sorted),
        Self::Stack(StackOrder::Ordered),
        trail(0, TrailRegister::Auto, StackMemory::Private),
        trail(1, TrailRegister::Auto, StackMemory::Private),
        trail(4, TrailRegister::Auto, StackMemory::Private),
        trail(16, TrailRegister::Auto, StackMemory::Private),
        trail(2, TrailRegister::Array, StackMemory::Private),
        trail(2, TrailRegister::U32, StackMemory::Private),
        trail(2, TrailRegister::U64, StackMemory::Private),
        trail(4, TrailRegister::Auto, StackMemory::Workgroup),
        Self::List,
        Self::KdRestart,
        Self::KdBacktrack,
        Self::ShortStack { entries: 2 },
        Self::Ropes,
        // The size that swaps the most.
        Self::SmartStack { bytes: SmartStack::LEAST_BYTES },
    ];

    /// The most entries of the short stack of a kd-tree.
    pub const MAX_SHORT_STACK: u32 = TrailOptions::MAX_SHORT_STACK;

    /// What it is and where it comes from.
    #[must_use]
    pub const fn about(self) -> &'static str {
        match self {
            Self::BruteForce => "every triangle, no hierarchy: the baseline of O(n)",
            Self::Recursive => "depth-first recursion (blog 2022)",
            Self::Stack(StackOrder::Unordered) => "stack, first child first, no culling (blog 2022)",
            Self::Stack(StackOrder::Culled) => "stack, boxes behind the closest hit are culled (blog 2022)",
            Self::Stack(StackOrder::Sorted) => "stack, culled, nearer inner child first (blog 2022)",
            Self::Stack(StackOrder::Ordered) => "stack, nearer child first, leaves too, culled again at pop",
            Self::RestartTrail(TrailOptions { short_stack: 0, .. }) => {
                "no stack: one bit a level leads back after each restart (Laine 2010)"
            }
            Self::RestartTrail(_) => "short stack; a trail leads back when it is exhausted (Laine 2010)",
            Self::List => "no stack: escape indices lead past what is missed (Toczek 2010)",
            Self::KdRestart => "no stack: after each leaf from the root on (Foley and Sugerman 2005)",
            Self::KdBacktrack => {
                "no stack: after each leaf up to where the ray goes on (Foley and Sugerman 2005)"
            }
            Self::ShortStack { .. } => {
                "short stack with push-down, restart when it is exhausted (Horn et al. 2007)"
            }
            Self::Ropes => "no stack: links lead from leaf to leaf (Popov et al. 2007)",
            Self::SmartStack { .. } => "one ring for both levels that swaps its oldest entries (Reichl 2010)",
        }
    }

    /// The name without its keys.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::BruteForce => "brute-force",
            Self::Recursive => "recursive",
            Self::Stack(_) => "stack",
            Self::RestartTrail(_) => "restart-trail",
            Self::List => "list",
            Self::KdRestart => "kd-restart",
            Self::KdBacktrack => "kd-backtrack",
            Self::ShortStack { .. } => "short-stack",
            Self::Ropes => "ropes",
            Self::SmartStack { .. } => "smart-stack",
        }
    }
}

impl fmt::Display for Walk {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        let written = Written::default();
        let written = match self {
            Self::BruteForce
            | Self::Recursive
            | Self::List
            | Self::KdRestart
            | Self::KdBacktrack
            | Self::Ropes => written,
            Self::ShortStack { entries } => written.key("entries", entries),
            Self::SmartStack { bytes } => written.key("bytes", bytes),
            Self::Stack(order) => match StackOrder::NAMES.iter().find(|(_, it)| it == order) {
                Some((name, _)) => written.key("order", name),
                None => written,
            },
            Self::RestartTrail(options) => {
                let plain = TrailOptions::default();
                written
                    .key("short-stack", options.short_stack)
                    .chosen("register", &options.register, &plain.register, TrailRegister::NAMES)
                    .chosen("memory", &options.memory, &plain.memory, StackMemory::NAMES)
            }
        };
        formatter.pad(&written.under(self.name()))
    }
}

impl FromStr for Walk {
    type Err = CatalogueError;

    fn from_str(text: &str) -> Result<Self, Self::Err> {
        let spec = Spec::parse(text)?;
        match spec.name {
            "brute-force" => spec.none("walk").map(|()| Self::BruteForce),
            "recursive" => spec.none("walk").map(|()| Self::Recursive),
            "list" => spec.none("walk").map(|()| Self::List),
            "kd-restart" => spec.none("walk").map(|()| Self::KdRestart),
            "kd-backtrack" => spec.none("walk").map(|()| Self::KdBacktrack),
            "ropes" => spec.none("walk").map(|()| Self::Ropes),
            "short-stack" => {
                let mut entries = 3;
                for (key, value) in spec.options {
                    match key {
                        "entries" => entries = within(key, value, 1, Self::MAX_SHORT_STACK, 1)?,
                        _ => return Err(unknown("key of the walk short-stack", key, &["entries"])),
                    }
                }
                Ok(Self::ShortStack { entries })
            }
            "smart-stack" => {
                let mut bytes = SmartStack::MOST_BYTES;
                for (key, value) in spec.options {
                    let (least, most) = (SmartStack::LEAST_BYTES, SmartStack::MOST_BYTES);
                    match key {
                        "bytes" => bytes = within(key, value, least, most, 4)?,
                        _ => return Err(unknown("key of the walk smart-stack", key, &["bytes"])),
                    }
                }
                Ok(Self::SmartStack { bytes })
            }
            "stack" => {
                let mut order = StackOrder::Ordered;
                for (key, value) in spec.options {
                    match key {
                        "order" => order = pick("order", value, StackOrder::NAMES)?,
                        _ => return Err(unknown("key of the walk stack", key, &["order"])),
                    }
                }
                Ok(Self::Stack(order))
            }
            "restart-trail" => {
                let mut options = TrailOptions::default();
                for (key, value) in spec.options {
                    match key {
                        "short-stack" => options.short_stack = short_stack(value)?,
                        "register" => options.register = pick(key, value, TrailRegister::NAMES)?,
                        "memory" => options.memory = pick(key, value, StackMemory::NAMES)?,
                        _ => {
                            let right = ["short-stack", "register", "memory"];
                            return Err(unknown("key of the walk restart-trail", key, &right));
                        }
                    }
                }
                Ok(Self::RestartTrail(options))
            }
            name => {
                let right = [
                    "stack",
                    "restart-trail",
                    "list",
                    "kd-restart",
                    "kd-backtrack",
                    "short-stack",
                    "ropes",
                    "smart-stack",
                    "recursive",
                    "brute-force",
                ];
                Err(unknown("walk", name, &right))
            }
        }
    }
}

fn short_stack(value: &str) -> Result<u32, CatalogueError> {
    let entries = number("short-stack", value)?;
    if entries <= TrailOptions::MAX_SHORT_STACK {
        return Ok(entries);
    }
    Err(CatalogueError(format!(
        "short-stack={value}: it can have 0 to {} entries; a stack that never drops one is the walk stack",
        TrailOptions::MAX_SHORT_STACK
    )))
}

/// A number from `least` to `most` in steps of `step`.
fn within(key: &str, value: &str, least: u32, most: u32, step: u32) -> Result<u32, CatalogueError> {
    let given = number(key, value)?;
    if (least..=most).contains(&given) && given % step == 0 {
        return Ok(given);
    }
    let steps = if step == 1 { String::new() } else { format!(" in steps of {step}") };
    Err(CatalogueError(format!("{key}={value}: it can be {least} to {most}{steps}")))
}
