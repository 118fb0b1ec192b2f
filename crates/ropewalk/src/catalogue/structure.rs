//! Structures and their settings.

use super::spec::{Spec, Written, number, pick, unknown};
use super::{StructureKind, Walk};
use crate::bvh::{BuildOptions, Builder, Bvh, LeafOrder};
use crate::bvh8::{Bvh8, Bvh8Options, Instanced, Preset, SimdLevel};
use crate::error::{BuildError, CatalogueError, TraceError};
use crate::kd_tree::{Depth, KdOptions, KdTree};
use crate::traversal_list::{
    Bounds, ChildOrder, Clearance, Cull, Directions, Heads, ListOptions, Source, Starts, TraversalList,
};
use crate::two_level::{BottomSpec, Bottoms, Opening, TwoLevel, TwoLevelOptions};
use crate::wide_bvh::{Collapse, WideBvh, WideOptions, Width};
use crate::{BuildReport, FlatTriangle, Keep, Monitor, Query, Ray, Scene, TraceOptions, Traced};
use std::borrow::Cow;
use std::fmt;
use std::str::FromStr;

/// What to build: the structure's name and the options of its builder.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub enum StructureSpec {
    /// A binary bounding volume hierarchy.
    Bvh(BuildOptions),
    /// A bounding volume hierarchy of 4 or 8 children a node.
    WideBvh(WideOptions),
    /// A packed bounding volume hierarchy of 8 children a node, for the CPU's vectors.
    Bvh8(Bvh8Options),
    /// Objects with packed hierarchies of their own, under one over their instances.
    Instanced(Bvh8Options),
    /// Traversal lists.
    List(ListOptions),
    /// A kd-tree.
    KdTree(KdOptions),
    /// Objects with structures of their own, under a hierarchy over their instances.
    TwoLevel(TwoLevelOptions),
}

impl From<BottomSpec> for StructureSpec {
    fn from(bottom: BottomSpec) -> Self {
        match bottom {
            BottomSpec::KdTree(options) => Self::KdTree(options),
            BottomSpec::Bvh(options) => Self::Bvh(options),
            BottomSpec::WideBvh(options) => Self::WideBvh(options),
            BottomSpec::List(options) => Self::List(options),
        }
    }
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
        let sweep = BuildOptions { builder: Builder::SweepSah, reinsertion: 3, ..plain };
        let sbvh = BuildOptions { builder: Builder::Sbvh, ..plain };
        let (wide, list) = (WideOptions::default(), ListOptions::default());
        let two_level = |bottom, oriented| {
            Self::TwoLevel(TwoLevelOptions {
                bottoms: Bottoms::Each(bottom),
                oriented,
                opening: Opening::Never,
            })
        };
        vec![
            Self::Bvh(plain),
            Self::Bvh(BuildOptions { leaf_order: LeafOrder::Left, ..plain }),
            Self::Bvh(sweep),
            Self::Bvh(sbvh),
            Self::WideBvh(wide),
            Self::WideBvh(WideOptions { width: Width::Four, collapse: Collapse::Sah, build: sbvh }),
            Self::Bvh8(Bvh8Options::default()),
            Self::Bvh8(Bvh8Options { preset: Preset::High, level: Some(SimdLevel::Portable) }),
            Self::Bvh8(Bvh8Options { preset: Preset::Fast, level: Some(SimdLevel::Avx2) }),
            Self::Bvh8(Bvh8Options { preset: Preset::Fastest, level: None }),
            Self::Bvh8(Bvh8Options { preset: Preset::Compact, level: None }),
            Self::Instanced(Bvh8Options::default()),
            Self::Instanced(Bvh8Options { preset: Preset::High, level: Some(SimdLevel::Portable) }),
            Self::List(list),
            Self::List(ListOptions {
                source: Source::Sah,
                bounds: Bounds::Aabb,
                directions: Directions::Two,
                moving: Some(1),
                ..list
            }),
            Self::List(ListOptions {
                directions: Directions::Six,
                order: ChildOrder::LatestLast,
                cull: Cull::Exact,
                heads: Heads::Simple,
                ..list
            }),
            Self::List(ListOptions {
                source: Source::Sbvh,
                bounds: Bounds::Aabb,
                directions: Directions::One,
                heads: Heads::Regular,
                clearance: Clearance::Above,
                ..list
            }),
            Self::List(ListOptions::BEST),
            Self::KdTree(KdOptions::default()),
            Self::TwoLevel(TwoLevelOptions::default()),
            two_level(BottomSpec::Bvh(sbvh), false),
            two_level(BottomSpec::WideBvh(wide), true),
            two_level(BottomSpec::List(list), false),
            Self::TwoLevel(TwoLevelOptions {
                bottoms: Bottoms::Mixed,
                oriented: false,
                opening: Opening::ByCost(3),
            }),
        ]
    }

    /// What kind of structure it is, whatever its settings.
    #[must_use]
    pub const fn kind(&self) -> StructureKind {
        match self {
            Self::Bvh(_) => StructureKind::Bvh,
            Self::WideBvh(_) => StructureKind::WideBvh,
            Self::Bvh8(_) => StructureKind::Bvh8,
            Self::Instanced(_) => StructureKind::Instanced,
            Self::List(_) => StructureKind::List,
            Self::KdTree(_) => StructureKind::KdTree,
            Self::TwoLevel(_) => StructureKind::TwoLevel,
        }
    }

    /// The options of the builder of the binary tree that the structure is, or is made of, where they can be chosen.
    #[must_use]
    pub const fn build_options(&self) -> Option<&BuildOptions> {
        match self {
            Self::Bvh(options) => Some(options),
            Self::WideBvh(options) => Some(&options.build),
            Self::Bvh8(_) | Self::Instanced(_) | Self::List(_) | Self::KdTree(_) | Self::TwoLevel(_) => None,
        }
    }

    /// The same structure over another binary tree, where that can be chosen.
    #[must_use]
    pub const fn with_build_options(self, build: BuildOptions) -> Self {
        match self {
            Self::Bvh(_) => Self::Bvh(build),
            Self::WideBvh(options) => Self::WideBvh(WideOptions { build, ..options }),
            Self::Bvh8(_) | Self::Instanced(_) | Self::List(_) | Self::KdTree(_) | Self::TwoLevel(_) => self,
        }
    }

    /// Whether triangles have one side: rays pass through them from behind.
    #[must_use]
    pub const fn is_one_sided(&self) -> bool {
        match self {
            Self::Bvh(_) | Self::WideBvh(_) | Self::Bvh8(_) | Self::Instanced(_) | Self::KdTree(_) => false,
            Self::List(options) => options.is_one_sided(),
            Self::TwoLevel(options) => options.is_one_sided(),
        }
    }

    /// Builds the structure over a scene.
    ///
    /// # Errors
    /// When the scene or an option is out of range, or the monitor cancels.
    pub fn build(&self, scene: &Scene, monitor: &dyn Monitor) -> Result<Structure, BuildError> {
        match self {
            Self::Bvh(options) => Ok(Structure::Bvh(scene.build_monitored(options, monitor)?)),
            Self::WideBvh(options) => Ok(Structure::WideBvh(scene.build_wide_monitored(options, monitor)?)),
            Self::Bvh8(options) => Ok(Structure::Bvh8(scene.build_packed_monitored(options, monitor)?)),
            Self::Instanced(options) => {
                Ok(Structure::Instanced(scene.build_instanced_monitored(options, monitor)?))
            }
            Self::List(options) => Ok(Structure::List(scene.build_list_monitored(options, monitor)?)),
            Self::KdTree(options) => Ok(Structure::KdTree(scene.build_kd_monitored(options, monitor)?)),
            Self::TwoLevel(options) => {
                Ok(Structure::TwoLevel(scene.build_two_level_monitored(options, monitor)?))
            }
        }
    }
}

fn build_keys(written: Written, options: &BuildOptions) -> Written {
    let plain = BuildOptions::default();
    written
        .chosen("builder", &options.builder, &plain.builder, Builder::NAMES)
        .changed("max-leaf", options.max_leaf, plain.max_leaf)
        .changed("max-depth", options.max_depth, plain.max_depth)
        .changed("bins", options.bins, plain.bins)
        .changed("duplication", options.duplication, plain.duplication)
        .changed("reinsertion", options.reinsertion, plain.reinsertion)
        .chosen("leaf-order", &options.leaf_order, &plain.leaf_order, LeafOrder::NAMES)
}

const BUILD_KEYS: [&str; 7] =
    ["builder", "max-leaf", "max-depth", "bins", "duplication", "reinsertion", "leaf-order"];

const LIST_KEYS: [&str; 11] = [
    "preset",
    "source",
    "bounds",
    "directions",
    "order",
    "big",
    "cull",
    "heads",
    "clearance",
    "frustum-grid",
    "moving",
];

const BVH8_KEYS: [&str; 2] = ["preset", "level"];

fn bvh8_keys(options: &Bvh8Options) -> Written {
    let plain = Bvh8Options::default();
    Written::default()
        .chosen("preset", &options.preset, &plain.preset, Preset::NAMES)
        .given("level", options.level)
}

/// Reads the keys of packed hierarchies, of one level and of two.
fn bvh8(spec: Spec<'_>) -> Result<Bvh8Options, CatalogueError> {
    let mut options = Bvh8Options::default();
    for (key, value) in spec.options {
        match key {
            "preset" => options.preset = pick(key, value, Preset::NAMES)?,
            "level" if value == "auto" => options.level = None,
            "level" => options.level = Some(pick(key, value, SimdLevel::NAMES)?),
            _ => return Err(unknown(&format!("key of the structure {}", spec.name), key, &BVH8_KEYS)),
        }
    }
    Ok(options)
}

const KD_KEYS: [&str; 5] = ["max-depth", "traversal-cost", "intersection-cost", "empty-bonus", "duplication"];

const TWO_LEVEL_KEYS: [&str; 4] = ["bottom", "oriented", "opening", "parts"];

/// The structures that an object can have.
const BOTTOMS: [&str; 5] = ["kd-tree", "bvh", "wide-bvh", "list", "mixed"];

/// Reads the keys of two levels. Those that it does not have itself are keys of the objects' structures.
fn two_level(options: Vec<(&str, &str)>) -> Result<StructureSpec, CatalogueError> {
    let plain = TwoLevelOptions::default();
    let (mut bottom, mut oriented, mut of_bottom) = ("kd-tree", plain.oriented, Written::default());
    let (mut opening, mut parts) = (Opening::Never, PARTS);
    for (key, value) in options {
        match key {
            "bottom" if BOTTOMS.contains(&value) => bottom = value,
            "bottom" => return Err(unknown("structure of objects", value, &BOTTOMS)),
            "oriented" => oriented = pick(key, value, YES_OR_NO)?,
            "opening" => opening = pick(key, value, OPENINGS)?,
            "parts" => parts = number(key, value)?,
            _ => of_bottom = of_bottom.key(key, value),
        }
    }
    let opening = match opening {
        Opening::Never => Opening::Never,
        Opening::ByCost(_) => Opening::ByCost(parts),
        Opening::Blindly(_) => Opening::Blindly(parts),
    };
    if bottom == "mixed" {
        let keys = of_bottom.under("mixed");
        return match keys.split_once(':') {
            None => {
                Ok(StructureSpec::TwoLevel(TwoLevelOptions { bottoms: Bottoms::Mixed, oriented, opening }))
            }
            Some((_, keys)) => Err(CatalogueError(format!(
                "the structures of bottom=mixed have no keys, but '{keys}' was given"
            ))),
        };
    }
    let bottom = match of_bottom.under(bottom).parse()? {
        StructureSpec::KdTree(options) => BottomSpec::KdTree(options),
        StructureSpec::Bvh(options) => BottomSpec::Bvh(options),
        StructureSpec::WideBvh(options) => BottomSpec::WideBvh(options),
        StructureSpec::List(options) => BottomSpec::List(options),
        StructureSpec::Bvh8(_) | StructureSpec::Instanced(_) | StructureSpec::TwoLevel(_) => {
            return Err(unknown("structure of objects", bottom, &BOTTOMS));
        }
    };
    Ok(StructureSpec::TwoLevel(TwoLevelOptions { bottoms: Bottoms::Each(bottom), oriented, opening }))
}

const YES_OR_NO: &[(&str, bool)] = &[("yes", true), ("no", false)];

/// The parts of an object that is opened where nobody says how many.
const PARTS: u32 = 4;

const OPENINGS: &[(&str, Opening)] =
    &[("never", Opening::Never), ("by-cost", Opening::ByCost(PARTS)), ("blindly", Opening::Blindly(PARTS))];

/// Writes two levels, with the keys of the objects' structures.
fn write_two_level(options: &TwoLevelOptions) -> String {
    let plain = TwoLevelOptions::default();
    let (bottom, keys) = match options.bottoms {
        Bottoms::Mixed => ("mixed".to_owned(), None),
        Bottoms::Each(bottom) => {
            let text = StructureSpec::from(bottom).to_string();
            match text.split_once(':') {
                Some((name, keys)) => (name.to_owned(), Some(keys.to_owned())),
                None => (text, None),
            }
        }
    };
    let written = Written::default().changed("bottom", bottom.as_str(), "kd-tree").chosen(
        "oriented",
        &options.oriented,
        &plain.oriented,
        YES_OR_NO,
    );
    let written = match options.opening {
        Opening::Never => written,
        Opening::ByCost(parts) => written.key("opening", "by-cost").changed("parts", parts, PARTS),
        Opening::Blindly(parts) => written.key("opening", "blindly").changed("parts", parts, PARTS),
    };
    let written = keys.into_iter().fold(written, Written::keys);
    written.under("two-level")
}

/// Takes a key of a builder; false when it is none.
fn set_build_key(options: &mut BuildOptions, key: &str, value: &str) -> Result<bool, CatalogueError> {
    match key {
        "builder" => options.builder = pick(key, value, Builder::NAMES)?,
        "max-leaf" => options.max_leaf = number(key, value)?,
        "max-depth" => options.max_depth = number(key, value)?,
        "bins" => options.bins = number(key, value)?,
        "duplication" => options.duplication = number(key, value)?,
        "reinsertion" => options.reinsertion = number(key, value)?,
        "leaf-order" => options.leaf_order = pick(key, value, LeafOrder::NAMES)?,
        _ => return Ok(false),
    }
    Ok(true)
}

impl fmt::Display for StructureSpec {
    /// Only what differs from the default is written.
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        let plain = WideOptions::default();
        formatter.pad(&match self {
            Self::Bvh(options) => build_keys(Written::default(), options).under("bvh"),
            Self::WideBvh(options) => {
                let written = Written::default()
                    .chosen("width", &options.width, &plain.width, Width::NAMES)
                    .chosen("collapse", &options.collapse, &plain.collapse, Collapse::NAMES);
                build_keys(written, &options.build).under("wide-bvh")
            }
            Self::Bvh8(options) => bvh8_keys(options).under("bvh8"),
            Self::Instanced(options) => bvh8_keys(options).under("bvh8-instanced"),
            Self::List(options) => {
                let plain = ListOptions::default();
                Written::default()
                    .chosen("source", &options.source, &plain.source, Source::NAMES)
                    .chosen("bounds", &options.bounds, &plain.bounds, Bounds::NAMES)
                    .chosen("directions", &options.directions, &plain.directions, Directions::NAMES)
                    .chosen("order", &options.order, &plain.order, ChildOrder::NAMES)
                    .changed("big", options.big, plain.big)
                    .chosen("cull", &options.cull, &plain.cull, Cull::NAMES)
                    .chosen("heads", &options.heads, &plain.heads, Heads::NAMES)
                    .chosen("clearance", &options.clearance, &plain.clearance, Clearance::NAMES)
                    .changed("frustum-grid", options.frustum_grid, plain.frustum_grid)
                    .given("moving", options.moving)
                    .under("list")
            }
            Self::KdTree(options) => {
                let plain = KdOptions::default();
                let cap = match options.max_depth {
                    Depth::Auto => None,
                    Depth::Cap(depth) => Some(depth),
                };
                Written::default()
                    .given("max-depth", cap)
                    .changed("traversal-cost", options.traversal_cost, plain.traversal_cost)
                    .changed("intersection-cost", options.intersection_cost, plain.intersection_cost)
                    .changed("empty-bonus", options.empty_bonus, plain.empty_bonus)
                    .changed("duplication", options.duplication, plain.duplication)
                    .under("kd-tree")
            }
            Self::TwoLevel(options) => write_two_level(options),
        })
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
                    if !set_build_key(&mut options, key, value)? {
                        return Err(unknown("key of the structure bvh", key, &BUILD_KEYS));
                    }
                }
                Ok(Self::Bvh(options))
            }
            "wide-bvh" => {
                let mut options = WideOptions::default();
                for (key, value) in spec.options {
                    match key {
                        "width" => options.width = pick(key, value, Width::NAMES)?,
                        "collapse" => options.collapse = pick(key, value, Collapse::NAMES)?,
                        _ if set_build_key(&mut options.build, key, value)? => {}
                        _ => {
                            let right = [["width", "collapse"].as_slice(), &BUILD_KEYS].concat();
                            return Err(unknown("key of the structure wide-bvh", key, &right));
                        }
                    }
                }
                Ok(Self::WideBvh(options))
            }
            "bvh8" => bvh8(spec).map(Self::Bvh8),
            "bvh8-instanced" => bvh8(spec).map(Self::Instanced),
            "list" => {
                let mut options = ListOptions::default();
                for (key, value) in spec.options {
                    match key {
                        "preset" => options = pick(key, value, ListOptions::PRESETS)?,
                        "source" => options.source = pick(key, value, Source::NAMES)?,
                        "bounds" => options.bounds = pick(key, value, Bounds::NAMES)?,
                        "directions" => options.directions = pick(key, value, Directions::NAMES)?,
                        "order" => options.order = pick(key, value, ChildOrder::NAMES)?,
                        "big" => options.big = number(key, value)?,
                        "cull" => options.cull = pick(key, value, Cull::NAMES)?,
                        "heads" => options.heads = pick(key, value, Heads::NAMES)?,
                        "clearance" => options.clearance = pick(key, value, Clearance::NAMES)?,
                        "frustum-grid" => options.frustum_grid = number(key, value)?,
                        "moving" => options.moving = Some(number(key, value)?),
                        _ => return Err(unknown("key of the structure list", key, &LIST_KEYS)),
                    }
                }
                Ok(Self::List(options))
            }
            "kd-tree" => {
                let mut options = KdOptions::default();
                for (key, value) in spec.options {
                    match key {
                        "max-depth" if value == "auto" => options.max_depth = Depth::Auto,
                        "max-depth" => options.max_depth = Depth::Cap(number(key, value)?),
                        "traversal-cost" => options.traversal_cost = number(key, value)?,
                        "intersection-cost" => options.intersection_cost = number(key, value)?,
                        "empty-bonus" => options.empty_bonus = number(key, value)?,
                        "duplication" => options.duplication = number(key, value)?,
                        _ => return Err(unknown("key of the structure kd-tree", key, &KD_KEYS)),
                    }
                }
                Ok(Self::KdTree(options))
            }
            "two-level" => two_level(spec.options).map_err(|error| match error.0.contains("key of") {
                true => CatalogueError(format!("{error}; two-level has {}", TWO_LEVEL_KEYS.join(", "))),
                false => error,
            }),
            name => Err(unknown("structure", name, &StructureKind::EVERY.map(StructureKind::name))),
        }
    }
}

/// A structure that was built.
#[derive(Clone, Debug)]
#[non_exhaustive]
pub enum Structure {
    /// A binary bounding volume hierarchy.
    Bvh(Bvh),
    /// A bounding volume hierarchy of 4 or 8 children a node.
    WideBvh(WideBvh),
    /// A packed bounding volume hierarchy of 8 children a node, for the CPU's vectors.
    Bvh8(Bvh8),
    /// Objects with packed hierarchies of their own, under one over their instances.
    Instanced(Instanced),
    /// Traversal lists.
    List(TraversalList),
    /// A kd-tree.
    KdTree(KdTree),
    /// Objects with structures of their own, under a hierarchy over their instances.
    TwoLevel(TwoLevel),
}

impl Structure {
    /// What kind of structure it is.
    #[must_use]
    pub const fn kind(&self) -> StructureKind {
        match self {
            Self::Bvh(_) => StructureKind::Bvh,
            Self::WideBvh(_) => StructureKind::WideBvh,
            Self::Bvh8(_) => StructureKind::Bvh8,
            Self::Instanced(_) => StructureKind::Instanced,
            Self::List(_) => StructureKind::List,
            Self::KdTree(_) => StructureKind::KdTree,
            Self::TwoLevel(_) => StructureKind::TwoLevel,
        }
    }

    /// Traces a batch on the CPU.
    ///
    /// # Errors
    /// When the catalogue has no such row, or the walk cannot go through a tree as deep as this one.
    pub fn trace(
        &self,
        walk: Walk,
        query: Query,
        rays: &[Ray],
        options: TraceOptions,
    ) -> Result<Traced, TraceError> {
        match self {
            Self::Bvh(bvh) => bvh.trace(walk, query, rays, options),
            Self::WideBvh(bvh) => bvh.trace(walk, query, rays, options),
            Self::Bvh8(bvh) => bvh.trace(walk, query, rays, options),
            Self::Instanced(scene) => scene.trace(walk, query, rays, options),
            Self::List(list) => list.trace(walk, query, rays, options),
            Self::KdTree(tree) => tree.trace(walk, query, rays, options),
            Self::TwoLevel(scene) => scene.trace(walk, query, rays, options),
        }
    }

    /// Traces a batch on the CPU, as if the hits that `keep` does not keep were not there: holes in leaves, parts that are
    /// hidden, the side that does not count.
    ///
    /// ```
    /// use ropewalk::{Answer, Hit, Mesh, NoMonitor, Query, Ray, Scene, StructureSpec, TraceOptions, Walk, glam::Vec3};
    /// let corners = vec![Vec3::ZERO, Vec3::X, Vec3::Y, Vec3::Z, Vec3::X + Vec3::Z, Vec3::Y + Vec3::Z];
    /// let scene = Scene::from_mesh(Mesh::new(corners, vec![[3, 4, 5], [0, 1, 2]]));
    /// let structure = StructureSpec::default().build(&scene, &NoMonitor)?;
    /// let rays = [Ray::new(Vec3::new(0.2, 0.2, 3.0), Vec3::NEG_Z)];
    /// let without_the_first = |hit: &Hit| hit.primitive_index != 0;
    /// let (walk, options) = (Walk::default(), TraceOptions::default());
    /// let traced = structure.trace_filtered(walk, Query::Closest, &rays, options, &without_the_first)?;
    /// assert!(matches!(traced.answer, Answer::Closest(hits) if hits[0].primitive_index == 1));
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    ///
    /// # Errors
    /// As [`Structure::trace`].
    pub fn trace_filtered(
        &self,
        walk: Walk,
        query: Query,
        rays: &[Ray],
        options: TraceOptions,
        keep: Keep<'_>,
    ) -> Result<Traced, TraceError> {
        match self {
            Self::Bvh(bvh) => bvh.trace_filtered(walk, query, rays, options, keep),
            Self::WideBvh(bvh) => bvh.trace_filtered(walk, query, rays, options, keep),
            Self::Bvh8(bvh) => bvh.trace_filtered(walk, query, rays, options, keep),
            Self::Instanced(scene) => scene.trace_filtered(walk, query, rays, options, keep),
            Self::List(list) => list.trace_filtered(walk, query, rays, options, keep),
            Self::KdTree(tree) => tree.trace_filtered(walk, query, rays, options, keep),
            Self::TwoLevel(scene) => scene.trace_filtered(walk, query, rays, options, keep),
        }
    }

    /// Traces a batch on the CPU by the walk of lists, each ray from its heads on: see [`TraversalList::trace_from`].
    ///
    /// # Errors
    /// When the structure is no lists, the heads are of others, or there is not a row for each ray.
    pub fn trace_from(
        &self,
        query: Query,
        rays: &[Ray],
        starts: Starts<'_>,
        options: TraceOptions,
    ) -> Result<Traced, TraceError> {
        match self {
            Self::List(list) => list.trace_from(query, rays, starts, options),
            _ => {
                Err(CatalogueError(format!("the structure '{}' has no heads to begin with", self.kind()))
                    .into())
            }
        }
    }

    /// How it was built.
    #[must_use]
    pub fn report(&self) -> &BuildReport {
        match self {
            Self::Bvh(bvh) => bvh.report(),
            Self::WideBvh(bvh) => bvh.report(),
            Self::Bvh8(bvh) => bvh.report(),
            Self::Instanced(scene) => scene.report(),
            Self::List(list) => list.report(),
            Self::KdTree(tree) => tree.report(),
            Self::TwoLevel(scene) => scene.report(),
        }
    }

    /// Whether triangles have one side: see [`StructureSpec::is_one_sided`].
    #[must_use]
    pub const fn is_one_sided(&self) -> bool {
        match self {
            Self::Bvh(_) | Self::WideBvh(_) | Self::Bvh8(_) | Self::Instanced(_) | Self::KdTree(_) => false,
            Self::List(list) => list.is_one_sided(),
            Self::TwoLevel(scene) => scene.is_one_sided(),
        }
    }

    /// Whether some triangle stands in more than one leaf: see [`Builder::Sbvh`].
    #[must_use]
    pub fn has_repeats(&self) -> bool {
        match self {
            Self::Bvh(bvh) => bvh.has_repeats(),
            Self::WideBvh(bvh) => bvh.has_repeats(),
            Self::Bvh8(bvh) => bvh.has_repeats(),
            Self::Instanced(scene) => scene.has_repeats(),
            Self::List(list) => list.has_repeats(),
            Self::KdTree(tree) => tree.has_repeats(),
            Self::TwoLevel(scene) => scene.has_repeats(),
        }
    }

    /// The triangles, in the order of the leaves; one stands in several places where spatial splits put it into
    /// several leaves. Lists have them in pieces, of which they are put together here, each once, by their numbers. Kd-trees
    /// have each once; of two levels these are the objects', each once, in the objects' frames.
    #[must_use]
    pub fn triangles(&self) -> Cow<'_, [FlatTriangle]> {
        match self {
            Self::Bvh(bvh) => Cow::Borrowed(bvh.triangles()),
            Self::WideBvh(bvh) => Cow::Borrowed(bvh.triangles()),
            Self::Bvh8(bvh) => Cow::Owned(bvh.triangles()),
            Self::Instanced(scene) => Cow::Owned(scene.triangles()),
            Self::List(list) => Cow::Owned(list.triangles().collect()),
            Self::KdTree(tree) => Cow::Borrowed(tree.triangles()),
            Self::TwoLevel(scene) => Cow::Owned(scene.triangles()),
        }
    }
}
