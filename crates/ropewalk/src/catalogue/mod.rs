//! The catalogue: every structure, walk, query and device that exists together. `ropewalk list` prints it, the
//! conformance suite runs over it, and nothing can be traced that is not in it.
//!
//! A structure and a walk are written `NAME[:key=value,...]`, such as `bvh:max-leaf=8` and
//! `restart-trail:short-stack=3`. A wrong name or key is answered with the right ones.

mod spec;
mod structure;
mod walk;

pub use structure::{Structure, StructureSpec};
pub use walk::{StackMemory, TrailOptions, TrailRegister, Walk};

use crate::Query;
use crate::bvh::StackOrder;
use crate::error::CatalogueError;
use std::fmt;

/// Where a walk runs.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum DeviceKind {
    /// The processor.
    Cpu,
    /// A graphics adapter, through wgpu.
    Gpu,
}

impl fmt::Display for DeviceKind {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        formatter.pad(match self {
            Self::Cpu => "cpu",
            Self::Gpu => "gpu",
        })
    }
}

/// A kind of structure, whatever its settings: what decides which walks there are.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum StructureKind {
    /// [`crate::Bvh`].
    Bvh,
    /// [`crate::WideBvh`].
    WideBvh,
    /// [`crate::Bvh8`].
    Bvh8,
    /// [`crate::bvh8::Instanced`].
    Instanced,
    /// [`crate::TraversalList`].
    List,
    /// [`crate::KdTree`].
    KdTree,
    /// [`crate::TwoLevel`].
    TwoLevel,
}

impl StructureKind {
    /// Every kind.
    pub const EVERY: [Self; 7] =
        [Self::Bvh, Self::WideBvh, Self::Bvh8, Self::Instanced, Self::List, Self::KdTree, Self::TwoLevel];

    /// The name on the command line, without its keys.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Bvh => "bvh",
            Self::WideBvh => "wide-bvh",
            Self::Bvh8 => "bvh8",
            Self::Instanced => "bvh8-instanced",
            Self::List => "list",
            Self::KdTree => "kd-tree",
            Self::TwoLevel => "two-level",
        }
    }
}

impl StructureKind {
    /// The walk that is meant where none is named: the best there is for all queries on every device that has any.
    #[must_use]
    pub const fn default_walk(self) -> Walk {
        match self {
            Self::Bvh | Self::WideBvh | Self::Bvh8 | Self::Instanced | Self::KdTree | Self::TwoLevel => {
                Walk::Stack(StackOrder::Ordered)
            }
            Self::List => Walk::List,
        }
    }
}

impl fmt::Display for StructureKind {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        formatter.pad(self.name())
    }
}

/// One row of the catalogue.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Row {
    /// What is built.
    pub structure: StructureSpec,
    /// How it is walked.
    pub walk: Walk,
    /// What is asked.
    pub query: Query,
    /// Where it runs.
    pub device: DeviceKind,
}

/// Every row.
#[must_use]
pub fn rows() -> Vec<Row> {
    let mut rows = Vec::new();
    for device in [DeviceKind::Cpu, DeviceKind::Gpu] {
        for structure in StructureSpec::every() {
            for walk in Walk::EVERY {
                for query in Query::EVERY {
                    if is_offered(structure.kind(), walk, query, device) {
                        rows.push(Row { structure, walk, query, device });
                    }
                }
            }
        }
    }
    rows
}

/// Whether a walk of a structure answers a query on a device: what [`rows`] is made of.
#[must_use]
pub const fn is_offered(structure: StructureKind, walk: Walk, query: Query, device: DeviceKind) -> bool {
    let first_hits = matches!(query, Query::Closest | Query::Any);
    let on_cpu = matches!(device, DeviceKind::Cpu);
    match (walk, structure) {
        (Walk::BruteForce, _) => on_cpu,
        // Their layout is that of a CPU's vectors.
        (Walk::Stack(StackOrder::Ordered), StructureKind::Bvh8 | StructureKind::Instanced) => on_cpu,
        (_, StructureKind::Bvh8 | StructureKind::Instanced) => false,
        // The one walk of lists; on a graphics adapter they have no other.
        (Walk::List, StructureKind::List) => true,
        // By skip pointers.
        (Walk::List, StructureKind::Bvh) => on_cpu,
        (Walk::List, _) | (_, StructureKind::List) => false,
        (Walk::Recursive, StructureKind::Bvh) => on_cpu && first_hits,
        (Walk::Recursive, _) => false,
        (Walk::Stack(StackOrder::Ordered), _) => true,
        (Walk::Stack(_), StructureKind::Bvh) => first_hits,
        (Walk::Stack(_), _) => false,
        (Walk::SmartStack { .. }, StructureKind::TwoLevel) => true,
        (Walk::SmartStack { .. }, _) | (_, StructureKind::TwoLevel) => false,
        // A kd-tree is never so deep that a register could be too short.
        (Walk::RestartTrail(options), StructureKind::KdTree) => {
            matches!((options.register, options.memory), (TrailRegister::Auto, StackMemory::Private))
        }
        (Walk::RestartTrail(options), _) => {
            let is_there = matches!(options.memory, StackMemory::Private) || !on_cpu;
            let is_wide = matches!(structure, StructureKind::WideBvh);
            is_there && !(is_wide && matches!(options.register, TrailRegister::U32))
        }
        (Walk::KdRestart | Walk::KdBacktrack | Walk::ShortStack { .. } | Walk::Ropes, _) => {
            matches!(structure, StructureKind::KdTree)
        }
    }
}

/// Refuses what the catalogue does not have, and says what it has instead.
///
/// # Errors
/// When there is no such row.
pub fn check(
    structure: StructureKind,
    walk: Walk,
    query: Query,
    device: DeviceKind,
) -> Result<(), CatalogueError> {
    if is_offered(structure, walk, query, device) {
        return Ok(());
    }
    let walks: Vec<String> = Walk::EVERY
        .into_iter()
        .filter(|&other| is_offered(structure, other, query, device))
        .map(|other| other.to_string())
        .collect();
    Err(CatalogueError(if walks.is_empty() {
        format!("no walk of the structure '{structure}' answers '{query}' on the {device}; try --device cpu")
    } else {
        format!(
            "the walk '{walk}' of the structure '{structure}' does not answer '{query}' on the {device}; these do: {}",
            walks.join(", ")
        )
    }))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_printed_is_read_back() {
        for row in rows() {
            assert_eq!(row.walk.to_string().parse(), Ok(row.walk));
            assert_eq!(row.structure.to_string().parse(), Ok(row.structure));
            assert_eq!(row.query.to_string().parse(), Ok(row.query));
        }
        let keys =
            "builder=sbvh,max-leaf=8,max-depth=31,bins=32,duplication=20,reinsertion=2,leaf-order=left";
        for full in [format!("bvh:{keys}"), format!("wide-bvh:width=4,collapse=sah,{keys}")] {
            assert_eq!(full.parse::<StructureSpec>().unwrap().to_string(), full);
        }
        let full = "list:source=sah,bounds=aabb,directions=6,order=latest-last,big=30,cull=exact,heads=simple,clearance=above,frustum-grid=16,moving=3";
        assert_eq!(full.parse::<StructureSpec>().unwrap().to_string(), full);
        let best = "list:preset=best,frustum-grid=8".parse::<StructureSpec>().unwrap();
        assert_eq!(best.to_string(), "list:source=sbvh,bounds=aabb,cull=exact,heads=regular,frustum-grid=8");
        assert_eq!("wide-bvh:width=8".parse::<StructureSpec>().unwrap().to_string(), "wide-bvh");
        for full in [
            "kd-tree:max-depth=20,traversal-cost=90,intersection-cost=140,empty-bonus=35,duplication=16",
            "two-level:oriented=no,opening=by-cost,parts=8,max-depth=20",
            "two-level:bottom=wide-bvh,opening=blindly,width=4,builder=sbvh",
            "two-level:bottom=mixed",
            "bvh8-instanced:preset=fast,level=portable",
        ] {
            assert_eq!(full.parse::<StructureSpec>().unwrap().to_string(), full);
        }
        let full = "restart-trail:short-stack=3,register=u64,memory=workgroup";
        assert_eq!(full.parse::<Walk>().unwrap().to_string(), full);
        assert_eq!("restart-trail".parse::<Walk>().unwrap().to_string(), "restart-trail:short-stack=4");
    }

    #[test]
    fn a_wrong_word_is_answered_with_the_right_ones() {
        let answer = |text: &str| text.parse::<Walk>().unwrap_err().to_string();
        assert!(answer("stak").contains("stack, restart-trail, list, kd-restart, kd-backtrack"));
        assert!(answer("short-stack:entries=17").contains("1 to 16"));
        assert!(answer("smart-stack:bytes=26").contains("24 to 256 in steps of 4"));
        assert!(answer("restart-trail:short-stack=17").contains("0 to 16"));
        assert!(answer("restart-trail:register=u16").contains("auto, array, u32, u64"));
        assert!(answer("stack:ordre=culled").contains("order"));
        assert!(answer("stack:order=best").contains("unordered, culled, sorted, ordered"));
        assert!(answer("stack:order").contains("key=value"));
        assert!(answer("recursive:depth=3").contains("no keys"));
        let answer = |text: &str| text.parse::<StructureSpec>().unwrap_err().to_string();
        assert!(answer("kd").contains("bvh"));
        assert!(answer("bvh:max-leaf=many").contains("whole number"));
        assert!("first".parse::<Query>().unwrap_err().to_string().contains("closest"));
        let missing =
            check(StructureKind::Bvh, Walk::Recursive, Query::All, DeviceKind::Cpu).unwrap_err().to_string();
        assert!(missing.contains("stack:order=ordered"), "{missing}");
        let missing =
            check(StructureKind::Bvh, Walk::BruteForce, Query::All, DeviceKind::Gpu).unwrap_err().to_string();
        assert!(missing.contains("stack:order=ordered, restart-trail:short-stack=0"), "{missing}");
    }
}
