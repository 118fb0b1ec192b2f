//! The catalogue: every structure, walk, query and device that exists together. `ropewalk list` prints it, the
//! conformance suite runs over it, and nothing can be traced that is not in it.
//!
//! A structure and a walk are written `NAME[:key=value,...]`, such as `bvh:max-leaf=8` and
//! `stack:order=culled`. A wrong name or key is answered with the right ones.

use crate::bvh::{BuildOptions, Bvh, LeafOrder, StackOrder};
use crate::error::{BuildError, CatalogueError, TraceError};
use crate::{BuildReport, FlatTriangle, Monitor, Query, Ray, Scene, TraceOptions, Traced};
use std::fmt;
use std::str::FromStr;

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

/// How a ray goes through a structure.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Walk {
    /// Tests every triangle; no hierarchy takes part.
    BruteForce,
    /// Depth first by recursion.
    Recursive,
    /// A loop with a stack.
    Stack(StackOrder),
}

impl Default for Walk {
    fn default() -> Self {
        Self::Stack(StackOrder::Ordered)
    }
}

impl Walk {
    /// Every walk.
    pub const EVERY: [Self; 6] = [
        Self::BruteForce,
        Self::Recursive,
        Self::Stack(StackOrder::Unordered),
        Self::Stack(StackOrder::Culled),
        Self::Stack(StackOrder::Sorted),
        Self::Stack(StackOrder::Ordered),
    ];

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
        }
    }
}

impl fmt::Display for Walk {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::BruteForce => formatter.pad("brute-force"),
            Self::Recursive => formatter.pad("recursive"),
            Self::Stack(order) => formatter.pad(match order {
                StackOrder::Unordered => "stack:order=unordered",
                StackOrder::Culled => "stack:order=culled",
                StackOrder::Sorted => "stack:order=sorted",
                StackOrder::Ordered => "stack:order=ordered",
            }),
        }
    }
}

impl FromStr for Walk {
    type Err = CatalogueError;

    fn from_str(text: &str) -> Result<Self, Self::Err> {
        let spec = Spec::parse(text)?;
        match spec.name {
            "brute-force" => spec.none("walk").map(|()| Self::BruteForce),
            "recursive" => spec.none("walk").map(|()| Self::Recursive),
            "stack" => {
                let mut order = StackOrder::Ordered;
                for (key, value) in spec.options {
                    match key {
                        "order" => order = pick("order", value, StackOrder::NAMES)?,
                        _ => return Err(unknown("key of the walk stack", key, ["order"])),
                    }
                }
                Ok(Self::Stack(order))
            }
            name => Err(unknown("walk", name, ["stack", "recursive", "brute-force"])),
        }
    }
}

/// What to build: the structure's name and the options of its builder.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub enum StructureSpec {
    /// A binary bounding volume hierarchy.
    Bvh(BuildOptions),
}

impl Default for StructureSpec {
    fn default() -> Self {
        Self::Bvh(BuildOptions::default())
    }
}

impl StructureSpec {
    /// Every structure with the settings in which the conformance suite tries it.
    #[must_use]
    pub fn every() -> Vec<Self> {
        let plain = BuildOptions::default();
        vec![Self::Bvh(plain), Self::Bvh(BuildOptions { leaf_order: LeafOrder::Left, ..plain })]
    }

    /// Builds the structure over a scene.
    ///
    /// # Errors
    /// When the scene or an option is out of range, or the monitor cancels.
    pub fn build(&self, scene: &Scene, monitor: &dyn Monitor) -> Result<Structure, BuildError> {
        match self {
            Self::Bvh(options) => Ok(Structure::Bvh(scene.build_monitored(options, monitor)?)),
        }
    }
}

impl fmt::Display for StructureSpec {
    /// Only what differs from the default is written.
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self::Bvh(options) = self;
        let plain = BuildOptions::default();
        let mut parts = Vec::new();
        if options.max_leaf != plain.max_leaf {
            parts.push(format!("max-leaf={}", options.max_leaf));
        }
        if options.max_depth != plain.max_depth {
            parts.push(format!("max-depth={}", options.max_depth));
        }
        if options.bins != plain.bins {
            parts.push(format!("bins={}", options.bins));
        }
        if options.leaf_order != plain.leaf_order {
            parts.push("leaf-order=left".into());
        }
        formatter.pad(&if parts.is_empty() { "bvh".into() } else { format!("bvh:{}", parts.join(",")) })
    }
}

impl FromStr for StructureSpec {
    type Err = CatalogueError;

    fn from_str(text: &str) -> Result<Self, Self::Err> {
        let spec = Spec::parse(text)?;
        match spec.name {
            "bvh" => {
                let mut options = BuildOptions::default();
                for (key, value) in spec.options {
                    match key {
                        "max-leaf" => options.max_leaf = number(key, value)?,
                        "max-depth" => options.max_depth = number(key, value)?,
                        "bins" => options.bins = number(key, value)?,
                        "leaf-order" => options.leaf_order = pick(key, value, LeafOrder::NAMES)?,
                        _ => {
                            let right = ["max-leaf", "max-depth", "bins", "leaf-order"];
                            return Err(unknown("key of the structure bvh", key, right));
                        }
                    }
                }
                Ok(Self::Bvh(options))
            }
            name => Err(unknown("structure", name, ["bvh"])),
        }
    }
}

/// A structure that was built.
#[derive(Clone, Debug)]
#[non_exhaustive]
pub enum Structure {
    /// A binary bounding volume hierarchy.
    Bvh(Bvh),
}

impl Structure {
    /// Traces a batch on the CPU.
    ///
    /// # Errors
    /// When the catalogue has no such row.
    pub fn trace(
        &self,
        walk: Walk,
        query: Query,
        rays: &[Ray],
        options: TraceOptions,
    ) -> Result<Traced, TraceError> {
        match self {
            Self::Bvh(bvh) => bvh.trace(walk, query, rays, options),
        }
    }

    /// How it was built.
    #[must_use]
    pub fn report(&self) -> &BuildReport {
        match self {
            Self::Bvh(bvh) => bvh.report(),
        }
    }

    /// The triangles, in the order of the leaves.
    #[must_use]
    pub fn triangles(&self) -> &[FlatTriangle] {
        match self {
            Self::Bvh(bvh) => bvh.triangles(),
        }
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
                    if is_offered(walk, query, device) {
                        rows.push(Row { structure, walk, query, device });
                    }
                }
            }
        }
    }
    rows
}

/// Whether a walk answers a query on a device: what [`rows`] is made of.
#[must_use]
pub const fn is_offered(walk: Walk, query: Query, device: DeviceKind) -> bool {
    match (device, walk) {
        (DeviceKind::Cpu, Walk::BruteForce | Walk::Stack(StackOrder::Ordered)) => true,
        (DeviceKind::Cpu, Walk::Recursive | Walk::Stack(_)) => matches!(query, Query::Closest | Query::Any),
        (DeviceKind::Gpu, Walk::Stack(_)) => matches!(query, Query::Closest | Query::Any),
        (DeviceKind::Gpu, _) => false,
    }
}

/// Refuses what the catalogue does not have, and says what it has instead.
///
/// # Errors
/// When there is no such row.
pub fn check(walk: Walk, query: Query, device: DeviceKind) -> Result<(), CatalogueError> {
    if is_offered(walk, query, device) {
        return Ok(());
    }
    let walks: Vec<String> = Walk::EVERY
        .into_iter()
        .filter(|&other| is_offered(other, query, device))
        .map(|other| other.to_string())
        .collect();
    Err(CatalogueError(if walks.is_empty() {
        format!("no walk answers '{query}' on the {device}; try --device cpu")
    } else {
        format!("the walk '{walk}' does not answer '{query}' on the {device}; these do: {}", walks.join(", "))
    }))
}

struct Spec<'a> {
    name: &'a str,
    options: Vec<(&'a str, &'a str)>,
}

impl<'a> Spec<'a> {
    fn parse(text: &'a str) -> Result<Self, CatalogueError> {
        let (name, rest) = text.split_once(':').unwrap_or((text, ""));
        let options = rest
            .split(',')
            .filter(|part| !part.is_empty())
            .map(|part| {
                part.split_once('=').ok_or_else(|| {
                    CatalogueError(format!("'{part}' in '{text}' is not of the form key=value"))
                })
            })
            .collect::<Result<_, _>>()?;
        Ok(Self { name, options })
    }

    fn none(&self, kind: &str) -> Result<(), CatalogueError> {
        match self.options.first() {
            None => Ok(()),
            Some((key, _)) => {
                Err(CatalogueError(format!("the {kind} '{}' has no keys, but '{key}' was given", self.name)))
            }
        }
    }
}

fn unknown<const N: usize>(what: &str, given: &str, right: [&str; N]) -> CatalogueError {
    CatalogueError(format!("there is no {what} '{given}'; there is {}", right.join(", ")))
}

fn number(key: &str, value: &str) -> Result<u32, CatalogueError> {
    value.parse().map_err(|_| CatalogueError(format!("{key}={value}: a whole number is wanted")))
}

fn pick<T: Copy>(key: &str, value: &str, names: &[(&str, T)]) -> Result<T, CatalogueError> {
    names.iter().find(|(name, _)| *name == value).map(|(_, it)| *it).ok_or_else(|| {
        let right: Vec<&str> = names.iter().map(|(name, _)| *name).collect();
        CatalogueError(format!("{key}={value}: it can be {}", right.join(", ")))
    })
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
        let full: StructureSpec = "bvh:max-leaf=8,max-depth=31,bins=32,leaf-order=left".parse().unwrap();
        assert_eq!(full.to_string(), "bvh:max-leaf=8,max-depth=31,bins=32,leaf-order=left");
    }

    #[test]
    fn a_wrong_word_is_answered_with_the_right_ones() {
        let answer = |text: &str| text.parse::<Walk>().unwrap_err().to_string();
        assert!(answer("stak").contains("stack, recursive, brute-force"));
        assert!(answer("stack:ordre=culled").contains("order"));
        assert!(answer("stack:order=best").contains("unordered, culled, sorted, ordered"));
        assert!(answer("stack:order").contains("key=value"));
        assert!(answer("recursive:depth=3").contains("no keys"));
        let answer = |text: &str| text.parse::<StructureSpec>().unwrap_err().to_string();
        assert!(answer("kd").contains("bvh"));
        assert!(answer("bvh:max-leaf=many").contains("whole number"));
        assert!("first".parse::<Query>().unwrap_err().to_string().contains("closest"));
        let missing = check(Walk::Recursive, Query::All, DeviceKind::Cpu).unwrap_err().to_string();
        assert!(missing.contains("stack:order=ordered"), "{missing}");
        let missing = check(Walk::BruteForce, Query::All, DeviceKind::Gpu).unwrap_err().to_string();
        assert!(missing.contains("--device cpu"), "{missing}");
    }
}
