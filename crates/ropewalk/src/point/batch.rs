//! Batches of queries, spread over threads where there are any.

use super::walk::{PointBruteForce, PointRestartTrail, PointStack, PointWalk};
use super::{ClosestPoint, NearestLists, PointAnswers, PointQuery, PointSearch, catalogue};
use crate::batch::CHUNK;
use crate::bvh::StackOrder;
use crate::bvh::walk::{ArrayTrail, Trail, TrailU32, TrailU64};
use crate::catalogue::{StructureKind, TrailRegister};
use crate::parallel::{fill_chunks, map_chunks};
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
        let len = queries.len().min(points.len());
        fill_chunks(&mut points[..len], CHUNK, |first, part| {
            for (point, query) in part.iter_mut().zip(&queries[first..]) {
                *point = self.closest_point(query);
            }
        });
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
                Walk::Stack(StackOrder::Ordered) => search.run(self, PointStack),
                _ => search.run(self, PointBruteForce),
            });
        };
        let (depth, room) = (self.report().depth, trail.short_stack);
        match trail.register_for(depth) {
            TrailRegister::U32 if depth > TrailU32::LEVELS => {
                Err(TraceError::too_deep(walk, depth, TrailU32::LEVELS))
            }
            TrailRegister::U64 if depth > TrailU64::LEVELS => {
                Err(TraceError::too_deep(walk, depth, TrailU64::LEVELS))
            }
            TrailRegister::U32 => Ok(search.run(self, PointRestartTrail::<TrailU32>::new(room))),
            TrailRegister::U64 => Ok(search.run(self, PointRestartTrail::<TrailU64>::new(room))),
            TrailRegister::Array | TrailRegister::Auto => {
                Ok(search.run(self, PointRestartTrail::<ArrayTrail>::new(room)))
            }
        }
    }
}

/// A batch and its question, whatever the walk.
trait Search {
    /// The answers.
    type Points;
    /// Answers the batch.
    fn run<W: PointWalk>(&self, bvh: &Bvh, walk: W) -> PointAnswers<Self::Points>;
}

struct Closest<'a> {
    queries: &'a [PointQuery],
    options: TraceOptions,
}

impl Closest<'_> {
    fn by<W: PointWalk, P: Probe + Copy + Default + Send>(
        &self,
        bvh: &Bvh,
        walk: W,
    ) -> (Vec<ClosestPoint>, Vec<P>) {
        let mut records = vec![(ClosestPoint::NONE, P::default()); self.queries.len()];
        fill_chunks(&mut records, CHUNK, |first, part| {
            for (record, query) in part.iter_mut().zip(&self.queries[first..]) {
                *record = bvh.closest_point_by(walk, query, P::default());
            }
        });
        records.into_iter().unzip()
    }
}

impl Search for Closest<'_> {
    type Points = Vec<ClosestPoint>;

    fn run<W: PointWalk>(&self, bvh: &Bvh, walk: W) -> PointAnswers<Self::Points> {
        let status = statuses(self.queries);
        if self.options.counters {
            let (points, counters) = self.by::<W, Counters>(bvh, walk);
            return PointAnswers { points, status, counters: Some(counters) };
        }
        let points = self.by::<W, NoProbe>(bvh, walk).0;
        PointAnswers { points, status, counters: None }
    }
}

struct Nearest<'a> {
    k: usize,
    queries: &'a [PointQuery],
    options: TraceOptions,
}

impl Nearest<'_> {
    fn by<W: PointWalk, P: Probe + Copy + Default + Send>(
        &self,
        bvh: &Bvh,
        walk: W,
    ) -> (NearestLists, Vec<P>) {
        let parts = map_chunks(self.queries, CHUNK, |_, queries| {
            let (mut points, mut ends, mut probes) = (Vec::new(), Vec::new(), Vec::new());
            for query in queries {
                probes.push(bvh.append_nearest_by(walk, query, self.k, &mut points, P::default()));
                ends.push(points.len() as u64);
            }
            (points, ends, probes)
        });
        let mut lists = NearestLists { offsets: vec![0], points: Vec::new() };
        let mut all_probes = Vec::with_capacity(self.queries.len());
        for (points, ends, probes) in parts {
            let before = lists.points.len() as u64;
            lists.offsets.extend(ends.into_iter().map(|end| before + end));
            lists.points.extend(points);
            all_probes.extend(probes);
        }
        (lists, all_probes)
    }
}

impl Search for Nearest<'_> {
    type Points = NearestLists;

    fn run<W: PointWalk>(&self, bvh: &Bvh, walk: W) -> PointAnswers<Self::Points> {
        let status = statuses(self.queries);
        if self.options.counters {
            let (points, counters) = self.by::<W, Counters>(bvh, walk);
            return PointAnswers { points, status, counters: Some(counters) };
        }
        let points = self.by::<W, NoProbe>(bvh, walk).0;
        PointAnswers { points, status, counters: None }
    }
}

fn statuses(queries: &[PointQuery]) -> Vec<Status> {
    let status = |query: &PointQuery| if query.is_valid() { Status::COMPLETE } else { Status::INVALID_RAY };
    queries.iter().map(status).collect()
}
