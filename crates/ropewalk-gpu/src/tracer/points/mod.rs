//! Point queries on a device: closest points and k nearest triangles, in tiles like rays.
//!
//! The walks are the twins of those in [`ropewalk::bvh::walk`]. What a query has found while it walks is two words a
//! triangle; the rest of the answer is worked out at its end.
//!
//! **Limits.** A query's list of the nearest lies in the memory of its invocation, so `k` is bounded by the largest
//! of [`PointKernel::ROOMS`].

mod results;

use super::limits::HIT_BYTES;
use super::tile::Job;
use super::{GpuStructure, Run, Tracer};
use crate::GpuError;
use crate::shader::{AnyKernel, PointKernel};
use results::Results;
use ropewalk::point::{PointSearch, SLACK_SHARE, catalogue};
use ropewalk::{ClosestPoint, DeviceKind, NearestLists, PointAnswers, PointQuery, TraceOptions, Walk};
use std::borrow::Cow;
use std::time::Duration;

/// What a batch of point queries answers, and the time the device took.
#[derive(Clone, Debug, PartialEq)]
pub struct GpuPoints<A> {
    /// The answers.
    pub answers: PointAnswers<A>,
    /// The time that the kernel ran, without transfers, where the device has timestamps.
    pub device_time: Option<Duration>,
}

impl Tracer {
    /// The most triangles that [`Tracer::nearest_points`] finds for a query.
    pub const MOST_NEAREST: usize = PointKernel::ROOMS[PointKernel::ROOMS.len() - 1] as usize;

    /// The closest point of the surface for each query: the twin of [`ropewalk::Bvh::closest_points`].
    ///
    /// # Errors
    /// When the catalogue has no such row for a graphics adapter, the structure is too deep for the walk, or the device
    /// fails.
    pub fn closest_points(
        &self,
        structure: &GpuStructure,
        walk: Walk,
        queries: &[PointQuery],
        options: TraceOptions,
    ) -> Result<GpuPoints<Vec<ClosestPoint>>, GpuError> {
        let question = Question { search: PointSearch::Closest, k: 1, room: PointKernel::ROOMS[0] };
        let (results, device_time) = self.search(structure, walk, question, queries, options)?;
        Ok(GpuPoints { answers: results.into_closest(), device_time })
    }

    /// The nearest point of each of the `k` nearest triangles for each query: the twin of
    /// [`ropewalk::Bvh::nearest_points`], with `k` up to [`Tracer::MOST_NEAREST`].
    ///
    /// # Errors
    /// When `k` is larger, the catalogue has no such row for a graphics adapter, the structure is too deep for the walk,
    /// or the device fails.
    pub fn nearest_points(
        &self,
        structure: &GpuStructure,
        walk: Walk,
        k: usize,
        queries: &[PointQuery],
        options: TraceOptions,
    ) -> Result<GpuPoints<NearestLists>, GpuError> {
        let Some(room) = PointKernel::room_for(k) else {
            return Err(GpuError::TooManyNearest { k, limit: Self::MOST_NEAREST });
        };
        // No larger than the room.
        let question = Question { search: PointSearch::Nearest, k: k as u32, room };
        let (results, device_time) = self.search(structure, walk, question, queries, options)?;
        Ok(GpuPoints { answers: results.into_nearest(), device_time })
    }

    fn search(
        &self,
        structure: &GpuStructure,
        walk: Walk,
        question: Question,
        queries: &[PointQuery],
        options: TraceOptions,
    ) -> Result<(Results, Option<Duration>), GpuError> {
        let Question { search, k, room } = question;
        let shape = structure.shape();
        catalogue::check(shape.tree.kind(), walk, search, DeviceKind::Gpu)?;
        self.with_own(structure, || {
            let kernel = PointKernel {
                walk: shape.tree.resolve(walk, shape.depth)?,
                search,
                room,
                counters: options.counters,
                stack_entries: self.stack_entries(structure, walk),
            };
            let result_words = kernel.result_words(k as usize);
            let record_words = PointKernel::QUERY_WORDS.max(result_words);
            let mut run = Run::new(&self.inner, structure, AnyKernel::Points(kernel), record_words)?;
            run.uniform.k = k;
            if k == 0 {
                // Of none, nothing is asked of the tree.
                run.uniform.node_count = 0;
            }
            if shape.has_repeats {
                run.uniform.slack_share = SLACK_SHARE;
            }
            // Lists are long: a tile has no more of them than an all-hits tile has hits.
            let tile = run.limits.rays.min(HIT_BYTES as usize / size_of::<u32>() / result_words);
            let mut results = Results::new(kernel, k as usize, queries.len());
            let jobs = queries.chunks(tile).map(|part| Job {
                rays: Cow::Borrowed(bytemuck::cast_slice(part)),
                ray_count: part.len() as u32,
                result_words: part.len() * result_words,
            });
            let device_time = run.trace(jobs, |words| results.append(words))?;
            Ok((results, device_time))
        })
    }
}

/// What is asked of each query of a batch.
#[derive(Clone, Copy, Debug)]
struct Question {
    search: PointSearch,
    /// How many triangles are wanted, at most `room`.
    k: u32,
    /// Places of a query's list, as the kernel has them.
    room: u32,
}
