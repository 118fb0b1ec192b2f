//! The kinds of structures and their keys: what may be written behind a structure's name, and what it means.

use ropewalk::bvh::{LeafOrder, MAX_DEPTH};
use ropewalk::bvh8::{Preset, SimdLevel};
use ropewalk::catalogue::StructureKind;
use ropewalk::traversal_list::{Bounds, ChildOrder, Clearance, Cull, Directions, Heads, Source};
use ropewalk::two_level::Opening;
use ropewalk::wide_bvh::{Collapse, Width};
use ropewalk::{BuildOptions, Builder, Bvh8Options, KdOptions, ListOptions, StructureSpec};
use serde::Serialize;

/// A kind of structure and how it is written.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub(crate) struct KindRecord {
    pub(crate) structure: &'static str,
    /// What it is.
    pub(crate) about: &'static str,
    /// Its keys with their values, and the value that each has when it is left out.
    pub(crate) keys: Vec<KeyRecord>,
    /// The settings in which the conformance suite tries it.
    pub(crate) tried: Vec<String>,
}

/// A key of a structure.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub(crate) struct KeyRecord {
    pub(crate) key: &'static str,
    pub(crate) values: String,
    /// What is taken when the key is left out: one of the values, or [`NONE`].
    pub(crate) default: String,
    /// What it means.
    pub(crate) about: &'static str,
}

/// The default of a key that stands for nothing where it is left out.
const NONE: &str = "none";

/// Every kind of structure.
pub(crate) fn kinds() -> Vec<KindRecord> {
    let kind = |kind: StructureKind| {
        let (about, mut keys) = match kind {
            StructureKind::Bvh => ("a binary bounding volume hierarchy", Vec::new()),
            StructureKind::WideBvh => {
                let width = choice("width", Width::NAMES, &Width::default(), "children a node");
                let about = "the largest are merged, or those that SAH expects to gain";
                let collapse = choice("collapse", Collapse::NAMES, &Collapse::default(), about);
                (
                    "a bounding volume hierarchy of 4 or 8 children a node, collapsed from a binary one",
                    vec![width, collapse],
                )
            }
            StructureKind::Bvh8 => (
                "a packed hierarchy of 8 children a node for the CPU's vectors: the fastest on a CPU",
                bvh8_keys().into(),
            ),
            StructureKind::Instanced => (
                "packed hierarchies of objects, under one over all instances: the fastest for many instances",
                bvh8_keys().into(),
            ),
            StructureKind::List => (
                "traversal lists: elements in the order of the walk, with escape indices",
                list_keys().into(),
            ),
            StructureKind::KdTree => {
                ("space cut by planes, with the triangles of every cell that they reach", kd_keys().into())
            }
            StructureKind::TwoLevel => (
                "a structure an object, with that one's keys besides, under a hierarchy over all instances",
                two_level_keys().into(),
            ),
        };
        if matches!(kind, StructureKind::Bvh | StructureKind::WideBvh) {
            keys.extend(build_keys());
        }
        let tried = StructureSpec::every().into_iter().filter(|spec| spec.kind() == kind);
        KindRecord {
            structure: kind.name(),
            about,
            keys,
            tried: tried.map(|spec| spec.to_string()).collect(),
        }
    };
    StructureKind::EVERY.into_iter().map(kind).collect()
}

fn number(
    key: &'static str,
    [smallest, largest]: [u32; 2],
    default: Option<u32>,
    about: &'static str,
) -> KeyRecord {
    let default = default.map_or_else(|| NONE.to_owned(), |default| default.to_string());
    KeyRecord { key, values: format!("{smallest}..{largest}"), default, about }
}

fn choice<T: PartialEq>(
    key: &'static str,
    names: &[(&str, T)],
    default: &T,
    about: &'static str,
) -> KeyRecord {
    let default = names.iter().find(|(_, value)| value == default).map_or(NONE, |(name, _)| name);
    let values: Vec<&str> = names.iter().map(|(name, _)| *name).collect();
    KeyRecord { key, values: values.join("|"), default: default.into(), about }
}

fn bvh8_keys() -> [KeyRecord; 2] {
    let plain = Bvh8Options::default();
    let levels: Vec<&str> = std::iter::once("auto").chain(SimdLevel::EVERY.map(SimdLevel::name)).collect();
    [
        choice(
            "preset",
            Preset::NAMES,
            &plain.preset,
            "how much work goes into the tree; compact: half the memory",
        ),
        KeyRecord {
            key: "level",
            values: levels.join("|"),
            default: "auto".into(),
            about: "vector instructions; auto: the best of the machine",
        },
    ]
}

fn kd_keys() -> [KeyRecord; 5] {
    let plain = KdOptions::default();
    let costs = [1, KdOptions::MAX_COST];
    [
        KeyRecord {
            key: "max-depth",
            values: format!("auto|1..{}", ropewalk::kd_tree::MAX_DEPTH),
            default: "auto".into(),
            about: "the depth that no leaf exceeds; auto: 8 + 1.3 log2 n",
        },
        number("traversal-cost", costs, Some(plain.traversal_cost), "what SAH takes a node to cost"),
        number(
            "intersection-cost",
            costs,
            Some(plain.intersection_cost),
            "what SAH takes a triangle to cost, in the same unit",
        ),
        number(
            "empty-bonus",
            [0, KdOptions::MAX_EMPTY_BONUS],
            Some(plain.empty_bonus),
            "what a split that leaves one side empty is spared, in percent",
        ),
        number(
            "duplication",
            [1, KdOptions::MAX_DUPLICATION],
            Some(plain.duplication),
            "the most references in all leaves, per triangle",
        ),
    ]
}

fn two_level_keys() -> [KeyRecord; 4] {
    let key = |key, values: &str, default: &str, about| KeyRecord {
        key,
        values: values.into(),
        default: default.into(),
        about,
    };
    [
        key("bottom", "kd-tree|bvh|wide-bvh|list|mixed", "kd-tree", "the structure of each object"),
        key("oriented", "yes|no", "yes", "whether it lies in the oriented box, where that is smaller"),
        key(
            "opening",
            "never|by-cost|blindly",
            "never",
            "whether it sees parts: where it pays, or of all large ones",
        ),
        key(
            "parts",
            &format!("{}..{}", Opening::PARTS[0], Opening::PARTS[1]),
            "4",
            "by-cost: entries an instance on average; blindly: of a large one",
        ),
    ]
}

fn list_keys() -> [KeyRecord; 11] {
    let plain = ListOptions::default();
    let grid = [0, ListOptions::MOST_FRUSTUM_GRID];
    [
        choice(
            "preset",
            ListOptions::PRESETS,
            &plain,
            "many keys at once, to be written first; best visits the least",
        ),
        choice(
            "source",
            Source::NAMES,
            &plain.source,
            "the hierarchy: the paper's groups of eight, or a binary tree",
        ),
        choice("bounds", Bounds::NAMES, &plain.bounds, "what is around a node: a sphere, or a box on a grid"),
        choice(
            "directions",
            Directions::NAMES,
            &plain.directions,
            "how many lists, each for the rays of its directions",
        ),
        choice(
            "order",
            ChildOrder::NAMES,
            &plain.order,
            "the first child: the one that begins or that ends first",
        ),
        number(
            "big",
            ListOptions::BIG,
            Some(plain.big),
            "octree: in percent of a node, the triangles it keeps itself",
        ),
        choice(
            "cull",
            Cull::NAMES,
            &plain.cull,
            "exact: triangles have one side, and unseen ones are left out",
        ),
        choice("heads", Heads::NAMES, &plain.heads, "where rays begin that leave a triangle by its front"),
        choice(
            "clearance",
            Clearance::NAMES,
            &plain.clearance,
            "heads for rays that begin on the surface, or clearly above",
        ),
        number(
            "frustum-grid",
            grid,
            Some(plain.frustum_grid),
            "primary rays: cells a side of the screen, with heads each",
        ),
        number("moving", [0, u32::MAX], plain.moving, "the instance with which a second layer begins"),
    ]
}

fn build_keys() -> [KeyRecord; 7] {
    let plain = BuildOptions::default();
    let bins = [2, BuildOptions::MAX_BINS as u32];
    let growth = [0, BuildOptions::MAX_DUPLICATION];
    let rounds = [0, BuildOptions::MAX_REINSERTION];
    let number = |key, range, default, about| number(key, range, Some(default), about);
    [
        choice(
            "builder",
            Builder::NAMES,
            &plain.builder,
            "SAH over bins, over every plane, or with spatial splits",
        ),
        number("max-leaf", [1, 255], plain.max_leaf, "the most triangles of a leaf"),
        number("max-depth", [1, MAX_DEPTH], plain.max_depth, "the depth that no leaf exceeds"),
        number("bins", bins, plain.bins, "planes that are tried an axis, unless every plane is"),
        number(
            "duplication",
            growth,
            plain.duplication,
            "the most references that sbvh adds, in percent of the triangles",
        ),
        number(
            "reinsertion",
            rounds,
            plain.reinsertion,
            "rounds after the build that move subtrees to better places",
        ),
        choice(
            "leaf-order",
            LeafOrder::NAMES,
            &plain.leaf_order,
            "left: where one child is a leaf, it comes first",
        ),
    ]
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The keys are written with values that the program takes, and with no others.
    #[test]
    fn keys_take_the_values_that_they_say() {
        for kind in kinds() {
            for key in &kind.keys {
                let parse =
                    |value: &str| format!("{}:{}={value}", kind.structure, key.key).parse::<StructureSpec>();
                let ends = |value| match str::split_once(value, "..") {
                    Some((from, to)) => vec![from, to],
                    None => vec![value],
                };
                let values: Vec<&str> = key.values.split('|').flat_map(ends).collect();
                for value in values {
                    assert!(parse(value).is_ok(), "{} {}={value}", kind.structure, key.key);
                }
                // What stands for nothing is not written.
                match parse(&key.default) {
                    Ok(spec) => assert_eq!(Ok(spec), kind.structure.parse(), "{}", key.key),
                    Err(error) => assert_eq!(key.default, NONE, "{}: {error}", key.key),
                }
                assert!(!key.about.is_empty(), "{}", key.key);
            }
            let wrong = format!("{}:colour=red", kind.structure).parse::<StructureSpec>().unwrap_err();
            for key in &kind.keys {
                assert!(wrong.to_string().contains(key.key), "{wrong} lacks {}", key.key);
            }
        }
    }

    /// A build refuses what lies beyond the ends that are shown.
    #[test]
    fn ranges_end_where_builders_refuse() {
        let scene = ropewalk::Scene::default();
        let (build, list, kd) = (build_keys(), list_keys(), kd_keys());
        let of = |structure, keys| std::iter::repeat(structure).zip(keys);
        let keys = of("bvh", build.as_slice()).chain(of("list", list.as_slice())).chain(of("kd-tree", &kd));
        for (structure, key) in keys {
            let range = key.values.split('|').find_map(|values| values.split_once(".."));
            let Some((from, to)) = range else { continue };
            let (from, to): (u32, u32) = (from.parse().unwrap(), to.parse().unwrap());
            let builds = |value: u64| {
                let spec = format!("{structure}:{}={value}", key.key).parse::<StructureSpec>();
                spec.is_ok_and(|spec| spec.build(&scene, &ropewalk::NoMonitor).is_ok())
            };
            let (from, to) = (u64::from(from), u64::from(to));
            assert!(builds(from) && builds(to) && !builds(to + 1), "{}", key.key);
            assert!(from == 0 || !builds(from - 1), "{}", key.key);
        }
    }

    /// A preset says what it stands for, and what is written behind it changes that.
    #[test]
    fn a_preset_is_a_beginning() {
        let spec = |text: &str| text.parse::<StructureSpec>().unwrap().to_string();
        assert_eq!(spec("list:preset=best"), "list:source=sbvh,bounds=aabb,cull=exact,heads=regular");
        assert_eq!(
            spec("list:preset=best,heads=disabled,directions=6"),
            "list:source=sbvh,bounds=aabb,directions=6,cull=exact"
        );
    }
}
