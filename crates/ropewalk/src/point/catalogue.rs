//! Which walks answer which point queries, over which structure, on which device: the counterpart of
//! [`crate::catalogue`] for points.

use crate::bvh::StackOrder;
use crate::catalogue::{StackMemory, StructureKind, Walk};
use crate::{CatalogueError, DeviceKind};
use std::fmt;
use std::str::FromStr;

/// What is asked about a point.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum PointSearch {
    /// The closest point of the surface, ties by the smaller id.
    Closest,
    /// The nearest point of each of the `k` nearest triangles, sorted by distance, ties by id.
    Nearest,
}

impl PointSearch {
    /// Every search.
    pub const EVERY: [Self; 2] = [Self::Closest, Self::Nearest];

    /// The name on the command line and in the catalogue.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Closest => "closest-point",
            Self::Nearest => "k-nearest",
        }
    }
}

impl fmt::Display for PointSearch {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        formatter.pad(self.name())
    }
}

impl FromStr for PointSearch {
    type Err = CatalogueError;

    fn from_str(text: &str) -> Result<Self, Self::Err> {
        Self::EVERY.into_iter().find(|search| search.name() == text).ok_or_else(|| {
            let names = Self::EVERY.map(Self::name).join(", ");
            CatalogueError(format!("there is no point query '{text}'; there is {names}"))
        })
    }
}

/// One row of the catalogue of points.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct PointRow {
    /// What is walked.
    pub structure: StructureKind,
    /// How it is walked.
    pub walk: Walk,
    /// What is asked.
    pub search: PointSearch,
    /// Where it runs.
    pub device: DeviceKind,
}

/// Every row.
#[must_use]
pub fn rows() -> Vec<PointRow> {
    let mut rows = Vec::new();
    for device in [DeviceKind::Cpu, DeviceKind::Gpu] {
        for structure in StructureKind::EVERY {
            for walk in Walk::EVERY {
                for search in PointSearch::EVERY {
                    if is_offered(structure, walk, search, device) {
                        rows.push(PointRow { structure, walk, search, device });
                    }
                }
            }
        }
    }
    rows
}

/// Whether a walk of a structure answers a search on a device: what [`rows`] is made of.
#[must_use]
pub const fn is_offered(
    structure: StructureKind,
    walk: Walk,
    search: PointSearch,
    device: DeviceKind,
) -> bool {
    let walk_is_there = match walk {
        Walk::BruteForce => matches!(device, DeviceKind::Cpu),
        Walk::Stack(StackOrder::Ordered) => true,
        // There is no workgroup memory on a CPU.
        Walk::RestartTrail(options) => {
            matches!(
                (options.memory, device),
                (StackMemory::Private, _) | (StackMemory::Workgroup, DeviceKind::Gpu)
            )
        }
        _ => false,
    };
    let search_is_there = match search {
        PointSearch::Closest | PointSearch::Nearest => true,
    };
    matches!(structure, StructureKind::Bvh) && walk_is_there && search_is_there
}

/// Refuses what the catalogue does not have, and says what it has instead.
///
/// # Errors
/// When there is no such row.
pub fn check(
    structure: StructureKind,
    walk: Walk,
    search: PointSearch,
    device: DeviceKind,
) -> Result<(), CatalogueError> {
    if is_offered(structure, walk, search, device) {
        return Ok(());
    }
    let walks: Vec<String> = Walk::EVERY
        .into_iter()
        .filter(|&other| is_offered(structure, other, search, device))
        .map(|other| other.to_string())
        .collect();
    Err(CatalogueError(if walks.is_empty() {
        let bvh = StructureKind::Bvh;
        format!("no walk of the structure '{structure}' answers '{search}'; the structure '{bvh}' does")
    } else {
        format!(
            "the walk '{walk}' of the structure '{structure}' does not answer '{search}' on the {device}; these do: {}",
            walks.join(", ")
        )
    }))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_row_is_offered_and_what_is_not_is_answered_with_the_right_ones() {
        let rows = rows();
        for search in PointSearch::EVERY {
            assert_eq!(search.to_string().parse(), Ok(search));
            for device in [DeviceKind::Cpu, DeviceKind::Gpu] {
                let walks: Vec<Walk> = rows
                    .iter()
                    .filter(|row| row.search == search && row.device == device)
                    .map(|row| row.walk)
                    .collect();
                assert_eq!(walks.contains(&Walk::BruteForce), device == DeviceKind::Cpu);
                assert!(walks.contains(&Walk::default()));
                let trails = |memory| {
                    let is_one = |walk: &&Walk| matches!(walk, Walk::RestartTrail(it) if it.memory == memory);
                    walks.iter().filter(is_one).count()
                };
                assert!(trails(StackMemory::Private) >= 7);
                assert_eq!(trails(StackMemory::Workgroup) > 0, device == DeviceKind::Gpu);
            }
        }
        let (bvh, cpu, gpu) = (StructureKind::Bvh, DeviceKind::Cpu, DeviceKind::Gpu);
        let answer = |structure, walk, device| {
            check(structure, walk, PointSearch::Closest, device).unwrap_err().to_string()
        };
        let text = answer(bvh, Walk::Recursive, cpu);
        assert!(text.contains("stack:order=ordered, restart-trail:short-stack=0"), "{text}");
        assert!(answer(bvh, Walk::Stack(StackOrder::Culled), cpu).contains("brute-force"));
        let workgroup: Walk = "restart-trail:memory=workgroup".parse().unwrap();
        assert!(answer(bvh, workgroup, cpu).contains("short-stack=4"));
        assert!(answer(StructureKind::WideBvh, Walk::default(), cpu).contains("'bvh'"));
        assert!(answer(StructureKind::WideBvh, Walk::default(), gpu).contains("'bvh'"));
        assert!(answer(bvh, Walk::BruteForce, gpu).contains("memory=workgroup"));
        assert!(
            "closest".parse::<PointSearch>().unwrap_err().to_string().contains("closest-point, k-nearest")
        );
        assert!(rows.iter().all(|row| check(row.structure, row.walk, row.search, row.device).is_ok()));
    }
}
