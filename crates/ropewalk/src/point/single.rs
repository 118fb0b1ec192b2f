//! One query at a time, with the best walk there is for it.

use super::{ClosestPoint, CollectPoints, KeepClosest, KeepNearest, PointQuery, PointVisitor, PreparedPoint};
use crate::bvh::walk::{BvhWalk, Ordered};
use crate::{Bvh, NoProbe, Probe};

impl Bvh {
    /// The closest point of the surface; [`ClosestPoint::NONE`] where there is none within the radius or the query is
    /// not valid.
    ///
    /// ```
    /// use ropewalk::{BuildOptions, Mesh, PointQuery, Scene, glam::Vec3};
    /// let mesh = Mesh::new(vec![Vec3::ZERO, Vec3::X, Vec3::Y], vec![[0, 1, 2]]);
    /// let bvh = Scene::from_mesh(mesh).build(&BuildOptions::default())?;
    /// let found = bvh.closest_point(&PointQuery::new(Vec3::new(0.25, 0.25, 2.0)));
    /// assert_eq!((found.distance, found.primitive_index), (2.0, 0));
    /// # Ok::<(), ropewalk::BuildError>(())
    /// ```
    #[must_use]
    pub fn closest_point(&self, query: &PointQuery) -> ClosestPoint {
        self.closest_point_by(Ordered, query, NoProbe).0
    }

    /// Replaces `points` by the nearest point of each of the `k` nearest triangles within the radius, sorted by
    /// distance, ties by id. Fewer where there are no more; none where the query is not valid.
    pub fn nearest(&self, query: &PointQuery, k: usize, points: &mut Vec<ClosestPoint>) {
        points.clear();
        self.append_nearest_by(Ordered, query, k, points, NoProbe);
    }

    /// Leads a query through the structure by a walk, and gives back what was collected and counted.
    #[inline(always)]
    pub fn visit_point<W: BvhWalk<PreparedPoint>, C: CollectPoints, P: Probe>(
        &self,
        walk: W,
        point: &PreparedPoint,
        collect: C,
        probe: P,
    ) -> (C, P) {
        let mut visitor = PointVisitor::new(self, point, collect, probe);
        walk.walk(self.nodes(), point, &mut visitor);
        (visitor.collect, visitor.probe)
    }

    #[inline(always)]
    pub(super) fn closest_point_by<W: BvhWalk<PreparedPoint>, P: Probe>(
        &self,
        walk: W,
        query: &PointQuery,
        probe: P,
    ) -> (ClosestPoint, P) {
        let Some(point) = PreparedPoint::new(query) else { return (ClosestPoint::NONE, probe) };
        let (keep, probe) = self.visit_point(walk, &point, KeepClosest::new(&point), probe);
        (keep.answer(), probe)
    }

    #[inline(always)]
    pub(super) fn append_nearest_by<W: BvhWalk<PreparedPoint>, P: Probe>(
        &self,
        walk: W,
        query: &PointQuery,
        k: usize,
        points: &mut Vec<ClosestPoint>,
        probe: P,
    ) -> P {
        let Some(point) = PreparedPoint::new(query).filter(|_| k > 0) else { return probe };
        let (keep, probe) = self.visit_point(walk, &point, KeepNearest::new(&point, k), probe);
        keep.append_to(points);
        probe
    }
}
