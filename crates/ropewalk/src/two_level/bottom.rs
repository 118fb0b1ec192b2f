//! The structure over the triangles of one object.

use super::BottomSpec;
use crate::bvh::Node;
use crate::bvh::walk::{self as binary, Collect};
use crate::kd_tree::{self, KdPlace, KdTree};
use crate::refit::RefitReport;
use crate::wide_bvh::walk as wide;
use crate::{
    Aabb, BuildError, BuildReport, Bvh, FlatTriangle, Monitor, PreparedRay, Probe, Scene, TraversalList,
    UpdateError, WideBvh,
};

/// What lies over the triangles of one object.
#[derive(Clone, Debug)]
#[non_exhaustive]
pub enum Bottom {
    /// A kd-tree.
    KdTree(KdTree),
    /// A binary BVH.
    Bvh(Bvh),
    /// A BVH of 4 or 8 children a node.
    WideBvh(WideBvh),
    /// Traversal lists.
    List(TraversalList),
}

impl Bottom {
    /// Builds it over a scene of one object, placed as it is.
    pub(super) fn build(spec: BottomSpec, scene: &Scene, monitor: &dyn Monitor) -> Result<Self, BuildError> {
        Ok(match spec {
            BottomSpec::KdTree(options) => Self::KdTree(scene.build_kd_monitored(&options, monitor)?),
            BottomSpec::Bvh(options) => Self::Bvh(scene.build_monitored(&options, monitor)?),
            BottomSpec::WideBvh(options) => Self::WideBvh(scene.build_wide_monitored(&options, monitor)?),
            BottomSpec::List(options) => Self::List(scene.build_list_monitored(&options, monitor)?),
        })
    }

    /// How it was built.
    #[must_use]
    pub fn report(&self) -> &BuildReport {
        match self {
            Self::KdTree(tree) => tree.report(),
            Self::Bvh(bvh) => bvh.report(),
            Self::WideBvh(bvh) => bvh.report(),
            Self::List(list) => list.report(),
        }
    }

    /// The box around everything.
    #[must_use]
    pub fn bounds(&self) -> Aabb {
        match self {
            Self::KdTree(tree) => tree.bounds(),
            Self::Bvh(bvh) => bvh.bounds(),
            Self::WideBvh(bvh) => bvh.bounds(),
            Self::List(list) => list.bounds(),
        }
    }

    /// Appends the triangles, each once.
    pub(super) fn append_triangles(&self, triangles: &mut Vec<FlatTriangle>) {
        let first = triangles.len();
        match self {
            Self::KdTree(tree) => triangles.extend_from_slice(tree.triangles()),
            Self::Bvh(bvh) => triangles.extend_from_slice(bvh.triangles()),
            Self::WideBvh(bvh) => triangles.extend_from_slice(bvh.triangles()),
            Self::List(list) => triangles.extend(list.triangles()),
        }
        let added = &mut triangles[first..];
        added.sort_unstable_by_key(|triangle| (triangle.geometry(), triangle.primitive));
        let mut kept = first;
        for place in first..triangles.len() {
            let id = |place: usize| (triangles[place].geometry(), triangles[place].primitive);
            if place == first || id(place) != id(kept - 1) {
                triangles[kept] = triangles[place];
                kept += 1;
            }
        }
        triangles.truncate(kept);
    }

    /// The most entries that the stack of the walk that [`super::TwoLevel`] takes can hold.
    #[must_use]
    pub fn stack_entries(&self) -> u32 {
        match self {
            Self::KdTree(tree) => tree.report().depth,
            Self::Bvh(bvh) => bvh.report().depth,
            Self::WideBvh(bvh) => bvh.stack_entries(),
            Self::List(_) => 0,
        }
    }

    /// The two children of a node and their boxes; `None` where it is a leaf, or the structure cannot be opened.
    pub(super) fn parts(&self, node: u32) -> Option<[(u32, Aabb); 2]> {
        match self {
            Self::KdTree(tree) => {
                let inner = tree.nodes().get(node as usize).filter(|node| !node.is_leaf())?;
                let cell =
                    |child: u32| tree.places().get(child as usize).map(|place| (child, place.bounds()));
                Some([cell(node + 1)?, cell(inner.upper())?])
            }
            Self::Bvh(bvh) => {
                let inner = bvh.nodes().get(node as usize).filter(|node| !node.is_leaf())?;
                let part = |child: u32| bvh.nodes().get(child as usize).map(|it| (child, it.bounds()));
                Some([part(node + 1)?, part(inner.link)?])
            }
            Self::WideBvh(_) | Self::List(_) => None,
        }
    }

    /// The box of a node of a structure that can be opened; of another the whole.
    pub(super) fn part_bounds(&self, node: u32) -> Aabb {
        let index = node as usize;
        match self {
            _ if node == 0 => self.bounds(),
            Self::KdTree(tree) => tree.places().get(index).map_or_else(|| self.bounds(), KdPlace::bounds),
            Self::Bvh(bvh) => bvh.nodes().get(index).map_or_else(|| self.bounds(), Node::bounds),
            Self::WideBvh(_) | Self::List(_) => self.bounds(),
        }
    }

    /// Moves the triangles to where a scene of the same object has them.
    pub(super) fn refit(&mut self, scene: &Scene) -> Result<RefitReport, UpdateError> {
        match self {
            Self::KdTree(_) => Err(UpdateError::FixedPlanes),
            Self::Bvh(bvh) => bvh.refit(scene),
            Self::WideBvh(bvh) => bvh.refit(scene),
            Self::List(list) => {
                let cost_before = list.report().sah_cost;
                let report = list.update(scene)?;
                Ok(RefitReport { cost_before, cost: list.report().sah_cost, time: report.time })
            }
        }
    }

    /// Whether a triangle may be met several times.
    #[must_use]
    pub fn has_repeats(&self) -> bool {
        match self {
            Self::KdTree(tree) => tree.has_repeats(),
            Self::Bvh(bvh) => bvh.has_repeats(),
            Self::WideBvh(bvh) => bvh.has_repeats(),
            Self::List(list) => list.has_repeats(),
        }
    }

    /// Leads a ray of the object's frame through the structure by the best walk that it has: through the subtree of a node,
    /// of those structures that can be opened.
    #[inline(always)]
    pub(super) fn visit<C: Collect, P: Probe>(
        &self,
        node: u32,
        ray: &PreparedRay,
        collect: C,
        probe: P,
    ) -> (C, P) {
        match self {
            Self::KdTree(tree) => tree.visit(kd_tree::walk::StackFrom(node), ray, collect, probe),
            Self::Bvh(bvh) => bvh.visit(binary::OrderedFrom(node), ray, collect, probe),
            Self::WideBvh(bvh) => bvh.visit(wide::Ordered, ray, collect, probe),
            Self::List(list) => list.visit(ray, None, collect, probe),
        }
    }

    /// Tests every triangle.
    pub(super) fn visit_all<C: Collect, P: Probe>(
        &self,
        ray: &PreparedRay,
        mut collect: C,
        mut probe: P,
    ) -> (C, P) {
        match self {
            Self::KdTree(tree) => {
                for triangle in tree.triangles() {
                    probe.primitive_test();
                    if let Some(hit) = triangle.intersect(ray, collect.t_max())
                        && collect.offer(hit).is_break()
                    {
                        break;
                    }
                }
                (collect, probe)
            }
            Self::Bvh(bvh) => bvh.visit(binary::BruteForce, ray, collect, probe),
            Self::WideBvh(bvh) => bvh.visit(wide::BruteForce, ray, collect, probe),
            Self::List(list) => list.visit_all(ray, collect, probe),
        }
    }
}
