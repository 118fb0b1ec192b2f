//! A model of what a ray costs, that knows no machine: what a node takes, in units of a kd-tree's node (ALGORITHMS: R15).
//!
//! A kd-tree's node is one plane, a BVH's two boxes, so 1 and 2; a triangle is as two boxes, 2. An object costs 3 whenever its box
//! is tested, entered or not: the box, and taking the ray to the object. A node of a wide BVH is as many boxes as it has children,
//! a list's element one.

use super::work::RayWork;
use ropewalk::two_level::Bottoms;
use ropewalk::wide_bvh::Width;
use ropewalk::{StructureSpec, TwoLevelOptions};

const KD_NODE: f64 = 1.0;
const BOX: f64 = 1.0;
const TRIANGLE: f64 = 2.0;
const OBJECT: f64 = 3.0;

/// What a node of each level costs.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct NodeCost {
    top: f64,
    bottom: f64,
}

impl NodeCost {
    /// In a structure. Objects of several kinds have no one cost: they count as BVHs.
    pub(super) fn of(structure: &StructureSpec) -> Self {
        let bottom = match structure {
            StructureSpec::TwoLevel(TwoLevelOptions { bottoms: Bottoms::Each(bottom), .. }) => {
                of_node(&(*bottom).into())
            }
            other => of_node(other),
        };
        Self { top: 2.0 * BOX, bottom }
    }

    /// Of a ray.
    pub(super) fn ray(self, work: &RayWork) -> f64 {
        self.top * f64::from(work.top_visits)
            + self.bottom * f64::from(work.bottom_visits)
            + TRIANGLE * f64::from(work.primitive_tests)
            + OBJECT * f64::from(work.objects_tested)
    }

    /// The mean over rays; zero where there are none.
    pub(super) fn mean(self, works: &[RayWork]) -> f64 {
        works.iter().map(|work| self.ray(work)).sum::<f64>() / works.len().max(1) as f64
    }
}

fn of_node(structure: &StructureSpec) -> f64 {
    match structure {
        StructureSpec::KdTree(_) => KD_NODE,
        StructureSpec::List(_) => BOX,
        StructureSpec::WideBvh(options) => match options.width {
            Width::Four => 4.0 * BOX,
            Width::Eight => 8.0 * BOX,
        },
        _ => 2.0 * BOX,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_ray_costs_what_it_did() {
        let work = RayWork {
            top_visits: 10,
            bottom_visits: 100,
            primitive_tests: 7,
            objects_tested: 4,
            ..RayWork::default()
        };
        let cost = |name: &str| NodeCost::of(&name.parse().unwrap()).ray(&work);
        assert_eq!(cost("two-level"), 20.0 + 100.0 + 14.0 + 12.0);
        assert_eq!(cost("two-level:bottom=bvh"), 20.0 + 200.0 + 14.0 + 12.0);
        assert_eq!(cost("two-level:bottom=wide-bvh,width=4"), 20.0 + 400.0 + 14.0 + 12.0);
        assert_eq!(cost("two-level:bottom=list"), cost("two-level"));
        let single = RayWork { bottom_visits: 100, primitive_tests: 7, ..RayWork::default() };
        assert_eq!(NodeCost::of(&"kd-tree".parse().unwrap()).mean(&[single, RayWork::default()]), 57.0);
        assert_eq!(NodeCost::of(&"bvh".parse().unwrap()).mean(&[]), 0.0);
    }
}
