//! Batches of queries, spread over threads where there are any.

use super::{ClosestPoint, NearestLists, PointAnswers, PointQuery, PointSearch, PreparedPoint, catalogue};
use crate::batch::{answer_each, gather};
use crate::bvh::StackOrder;
use crate::bvh::walk::{ArrayTrail, BruteForce, BvhWalk, Ordered, RestartTrail, TrailU32, TrailU64};
use crate::catalogue::{StructureKind, TrailRegister};
use crate::{Bvh, Counters, DeviceKind, NoProbe, Probe, Status, TraceError, TraceOptions, Walk};

impl Bvh {
    /// Answers a batch of [`PointSearch::Closest`] by any walk of [`super::catalogue`].
    ///
    /// # Errors
    /// When the walk is for rays alone, or the tree is too deep for it.
    pub fn closest_points(
        &self,
        walk: Walk,
        queries: &[PointQuery],
        options: TraceOptions,
    ) -> Result<PointAnswers<Vec<ClosestPoint>>, TraceError> {
        self.search(walk, PointSearch::Closest, &Closest { queries, options })
    }

    /// Answers a batch of [`PointSearch::Nearest`] by any walk of [`super::catalogue`]: the nearest
    /// point of each of the `k` nearest triangles.
    ///
    /// # Errors
    /// When the walk is for rays alone, or the tree is too deep for it.
    pub fn nearest_points(
        &self,
        walk: Walk,
        k: usize,
        queries: &[PointQuery],
        options: TraceOptions,
    ) -> Result<PointAnswers<NearestLists>, TraceError> {
        self.search(walk, PointSearch::Nearest, &Nearest { k, queries, options })
    }

    /// The closest points of many queries, into `points`, by the best walk. Only the first
    /// `min(queries.len(), points.len())` are answered.
    pub fn closest_point_batch(&self, queries: &[PointQuery], points: &mut [ClosestPoint]) {
        answer_each(queries, points, |query| self.closest_point(query));
    }

    /// Runs a search by the walk that a value of the catalogue names.
    fn search<S: Search>(
        &self,
        walk: Walk,
        kind: PointSearch,
        search: &S,
    ) -> Result<PointAnswers<S::Points>, TraceError> {
        catalogue::check(StructureKind::Bvh, walk, kind, DeviceKind::Cpu)?;
        let Walk::RestartTrail(trail) = walk else {
            return Ok(match walk {
                Walk::Stack(StackOrder::Ordered) => search.run(self, Ordered),
                _ => search.run(self, BruteForce),
            });
        };
        let room = trail.short_stack;
        Ok(match trail.register_for(self.report().depth)? {
            TrailRegister::U32 => search.run(self, RestartTrail::<TrailU32>::new(room)),
            TrailRegister::U64 => search.run(self, RestartTrail::<TrailU64>::new(room)),
            TrailRegister::Array | TrailRegister::Auto => {
                search.run(self, RestartTrail::<ArrayTrail>::new(room))
            }
        })
    }
}

/// A batch and its question, whatever the walk.
trait Search {
    /// The answers.
    type Points;

    /// Who asks, and how.
    fn batch(&self) -> (&[PointQuery], TraceOptions);

    /// Answers the batch, and counts with one probe a query.
    fn by<W: BvhWalk<PreparedPoint>, P: Probe + Copy + Default + Send>(
        &self,
        bvh: &Bvh,
        walk: W,
    ) -> (Self::Points, Vec<P>);

    /// Answers the batch.
    fn run<W: BvhWalk<PreparedPoint>>(&self, bvh: &Bvh, walk: W) -> PointAnswers<Self::Points> {
        let (queries, options) = self.batch();
        let status = queries.iter().map(status).collect();
        if options.counters {
            let (points, counters) = self.by::<W, Counters>(bvh, walk);
            return PointAnswers { points, status, counters: Some(counters) };
        }
        let points = self.by::<W, NoProbe>(bvh, walk).0;
        PointAnswers { points, status, counters: None }
    }
}

fn status(query: &PointQuery) -> Status {
    if query.is_valid() { Status::COMPLETE } else { Status::INVALID_RAY }
}

struct Closest<'a> {
    queries: &'a [PointQuery],
    options: TraceOptions,
}

impl Search for Closest<'_> {
    type Points = Vec<ClosestPoint>;

    fn batch(&self) -> (&[PointQuery], TraceOptions) {
        (self.queries, self.options)
    }

    fn by<W: BvhWalk<PreparedPoint>, P: Probe + Copy + Default + Send>(
        &self,
        bvh: &Bvh,
        walk: W,
    ) -> (Self::Points, Vec<P>) {
        let mut records = vec![(ClosestPoint::NONE, P::default()); self.queries.len()];
        answer_each(self.queries, &mut records, |query| bvh.closest_point_by(walk, query, P::default()));
        records.into_iter().unzip()
    }
}

struct Nearest<'a> {
    k: usize,
    queries: &'a [PointQuery],
    options: TraceOptions,
}

impl Search for Nearest<'_> {
    type Points = NearestLists;

    fn batch(&self) -> (&[PointQuery], TraceOptions) {
        (self.queries, self.options)
    }

    fn by<W: BvhWalk<PreparedPoint>, P: Probe + Copy + Default + Send>(
        &self,
        bvh: &Bvh,
        walk: W,
    ) -> (Self::Points, Vec<P>) {
        let (offsets, points, probes) = gather(self.queries, |query, points| {
            bvh.append_nearest_by(walk, query, self.k, points, P::default())
        });
        (NearestLists { offsets, points }, probes)
    }
}
