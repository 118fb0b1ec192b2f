//! What is built, and how it is walked.

use ropewalk::kd_tree::Depth;
use ropewalk::two_level::{BottomSpec, Bottoms, Opening, SmartStack};
use ropewalk::{
    BuildOptions, Builder, KdOptions, ListOptions, StructureSpec, TwoLevelOptions, Walk, WideOptions,
};

/// A structure and a walk.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Setting {
    pub(super) structure: StructureSpec,
    pub(super) walk: Walk,
}

/// The depth that the paper gives its kd-trees.
const PAPER_DEPTH: u32 = 20;
/// Into how many parts large objects are opened: what partial re-braiding allows for each instance, and into how many the
/// paper's blind subdivision cuts a background.
const PARTS: [u32; 2] = [4, 8];

/// One kd-tree, as deep as its triangles ask for.
pub(super) fn single_kd() -> StructureSpec {
    StructureSpec::KdTree(KdOptions::default())
}

/// One kd-tree, no deeper than the paper's.
pub(super) fn single_kd_20() -> StructureSpec {
    StructureSpec::KdTree(KdOptions { max_depth: Depth::Cap(PAPER_DEPTH), ..KdOptions::default() })
}

/// One BVH.
pub(super) fn single_bvh() -> StructureSpec {
    StructureSpec::default()
}

/// The structures that objects have: kd-trees as deep as they ask for and as deep as the paper's, BVH, SBVH, wide BVH, lists.
pub(super) fn every_bottom() -> Vec<BottomSpec> {
    let capped = KdOptions { max_depth: Depth::Cap(PAPER_DEPTH), ..KdOptions::default() };
    vec![
        BottomSpec::default(),
        BottomSpec::KdTree(capped),
        BottomSpec::Bvh(BuildOptions::default()),
        BottomSpec::Bvh(BuildOptions { builder: Builder::Sbvh, ..BuildOptions::default() }),
        BottomSpec::WideBvh(WideOptions::default()),
        BottomSpec::List(ListOptions::default()),
    ]
}

/// One structure over everything, and two levels with each structure for objects, in oriented boxes and without; of the first,
/// in oriented boxes, also by the walk with one ring, and with large objects opened.
pub(super) fn settings(bottoms: &[BottomSpec]) -> Vec<Setting> {
    let plain = |structure: StructureSpec| Setting { structure, walk: structure.kind().default_walk() };
    let levels = |bottom, oriented, opening| {
        StructureSpec::TwoLevel(TwoLevelOptions { bottoms: Bottoms::Each(bottom), oriented, opening })
    };
    let mut settings: Vec<Setting> = [single_kd(), single_kd_20(), single_bvh()].map(plain).into();
    for &bottom in bottoms {
        settings.extend([true, false].map(|oriented| plain(levels(bottom, oriented, Opening::Never))));
    }
    if let Some(&first) = bottoms.first() {
        let structure = levels(first, true, Opening::Never);
        settings.push(Setting { structure, walk: Walk::SmartStack { bytes: SmartStack::MOST_BYTES } });
        // Wide trees and lists stay whole.
        if matches!(first, BottomSpec::KdTree(_) | BottomSpec::Bvh(_)) {
            let [by_cost, blindly] = PARTS;
            let openings = [Opening::ByCost(by_cost), Opening::Blindly(blindly)];
            settings.extend(openings.map(|opening| plain(levels(first, true, opening))));
        }
    }
    settings
}

impl Setting {
    /// The options of two levels, where there are two.
    pub(super) fn levels(&self) -> Option<&TwoLevelOptions> {
        match &self.structure {
            StructureSpec::TwoLevel(options) => Some(options),
            _ => None,
        }
    }

    /// What each object has, where there are two levels.
    pub(super) fn bottom(&self) -> Option<BottomSpec> {
        match self.levels()?.bottoms {
            Bottoms::Each(bottom) => Some(bottom),
            Bottoms::Mixed => None,
        }
    }

    /// Whether both levels share a ring: kd-trees and binary BVHs do.
    pub(super) fn has_ring(&self) -> bool {
        matches!(self.bottom(), Some(BottomSpec::KdTree(_) | BottomSpec::Bvh(_)))
    }

    /// Whether it is the plain two levels with this bottom: no object opened, the ordinary walk.
    pub(super) fn is_plain(&self) -> bool {
        self.levels().is_some_and(|levels| levels.opening == Opening::Never)
            && !matches!(self.walk, Walk::SmartStack { .. })
    }
}

/// A bottom structure as it is written on the command line.
pub(super) fn bottom_name(bottom: BottomSpec) -> String {
    StructureSpec::from(bottom).to_string()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_bottom_is_there_with_boxes_of_both_kinds() {
        let settings = settings(&every_bottom());
        let names: Vec<String> = settings.iter().map(|it| it.structure.to_string()).collect();
        assert_eq!(names[..3], ["kd-tree", "kd-tree:max-depth=20", "bvh"]);
        assert_eq!(settings.len(), 3 + 2 * 6 + 3, "{names:?}");
        for bottom in every_bottom() {
            let of = |oriented: bool| {
                let is_of = |it: &&Setting| {
                    it.is_plain()
                        && it.bottom() == Some(bottom)
                        && it.levels().is_some_and(|levels| levels.oriented == oriented)
                };
                settings.iter().filter(is_of).count()
            };
            assert_eq!((of(true), of(false)), (1, 1), "{}", bottom_name(bottom));
        }
        assert!(settings.iter().all(|it| it.structure.to_string().parse() == Ok(it.structure)));
        assert_eq!(settings.iter().filter(|it| it.has_ring()).count(), 2 * 4 + 3);
        assert!(super::settings(&[]).len() == 3 && !settings[0].has_ring() && !settings[0].is_plain());
        let list = super::settings(&[BottomSpec::List(ListOptions::default())]);
        assert_eq!(list.len(), 3 + 2 + 1, "lists are not opened");
    }
}
