//! From the words that a kernel of point queries writes to the answers that the core crate speaks of.

use crate::GpuError;
use crate::shader::PointKernel;
use crate::tracer::results::written;
use ropewalk::glam::{Vec2, Vec3};
use ropewalk::point::PointSearch;
use ropewalk::{ClosestPoint, Counters, NearestLists, PointAnswers, Status};

/// What the kernel wrote for the queries of a batch, tile after tile.
#[derive(Debug)]
pub(super) struct Results {
    kernel: PointKernel,
    record_words: usize,
    points: Vec<ClosestPoint>,
    /// Where the list of each query ends.
    ends: Vec<u64>,
    status: Vec<Status>,
    counters: Vec<Counters>,
}

impl Results {
    /// Nothing yet, of a kernel that writes `k` triangles a query where it writes lists.
    pub(super) fn new(kernel: PointKernel, k: usize, queries: usize) -> Self {
        let closest = kernel.search == PointSearch::Closest;
        Self {
            kernel,
            record_words: kernel.result_words(k),
            points: Vec::with_capacity(if closest { queries } else { 0 }),
            ends: Vec::with_capacity(if closest { 0 } else { queries }),
            status: Vec::with_capacity(queries),
            counters: Vec::with_capacity(if kernel.counters { queries } else { 0 }),
        }
    }

    /// Takes the words of the next queries.
    pub(super) fn append(&mut self, words: &[u32]) -> Result<(), GpuError> {
        for record in words.chunks_exact(self.record_words) {
            let unanswered = GpuError::UnansweredQuery { query: self.status.len() };
            let read = match self.kernel.search {
                PointSearch::Closest => self.read_closest(record),
                PointSearch::Nearest => self.read_nearest(record),
            };
            let Some((status, counted)) = read else { return Err(unanswered) };
            self.status.push(status);
            if self.kernel.counters {
                let Some(counted) = counted.first_chunk::<6>() else { return Err(unanswered) };
                self.counters.push(bytemuck::cast(*counted));
            }
        }
        Ok(())
    }

    /// The status, and the words behind it.
    fn read_closest<'a>(&mut self, record: &'a [u32]) -> Option<(Status, &'a [u32])> {
        let (point, status) = read_point(record)?;
        self.points.push(point);
        Some((status, record.get(10..)?))
    }

    /// The status, and the words behind it.
    fn read_nearest<'a>(&mut self, record: &'a [u32]) -> Option<(Status, &'a [u32])> {
        let (header, mut list) = record.split_at_checked(self.kernel.result_words(0))?;
        let (&[held, status], counted) = header.split_first_chunk()?;
        let status = written(status)?;
        for _ in 0..held {
            let (point, rest) = list.split_at_checked(PointKernel::POINT_WORDS)?;
            self.points.push(read_point(point)?.0);
            list = rest;
        }
        self.ends.push(self.points.len() as u64);
        Some((status, counted))
    }

    /// The answers of a search for the closest points.
    pub(super) fn into_closest(self) -> PointAnswers<Vec<ClosestPoint>> {
        let counters = self.kernel.counters.then_some(self.counters);
        PointAnswers { points: self.points, status: self.status, counters }
    }

    /// The answers of a search for the nearest triangles.
    pub(super) fn into_nearest(self) -> PointAnswers<NearestLists> {
        let counters = self.kernel.counters.then_some(self.counters);
        let offsets = std::iter::once(0).chain(self.ends).collect();
        let points = NearestLists { offsets, points: self.points };
        PointAnswers { points, status: self.status, counters }
    }
}

/// The point and the status in the first ten words; `None` where no invocation wrote them.
fn read_point(record: &[u32]) -> Option<(ClosestPoint, Status)> {
    let &[distance, x, y, z, u, v, primitive_index, geometry_index, instance_index, status, ..] = record
    else {
        return None;
    };
    let point = ClosestPoint {
        distance: f32::from_bits(distance),
        point: Vec3::from_array([x, y, z].map(f32::from_bits)),
        barycentrics: Vec2::from_array([u, v].map(f32::from_bits)),
        primitive_index,
        geometry_index,
        instance_index,
    };
    Some((point, written(status)?))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::shader::STATUS_WRITTEN;
    use ropewalk::Walk;

    const POINT: [u32; 12] =
        [0x3f80_0000, 0x4000_0000, 0, 0, 0, 0x3e80_0000, 7, 8, 9, STATUS_WRITTEN | 2, 0, 0];

    fn results(search: PointSearch, counters: bool, k: usize) -> Results {
        let walk = Walk::default();
        Results::new(PointKernel { walk, search, room: 4, counters, stack_entries: 8 }, k, 2)
    }

    fn point() -> ClosestPoint {
        ClosestPoint {
            distance: 1.0,
            point: Vec3::new(2.0, 0.0, 0.0),
            barycentrics: Vec2::new(0.0, 0.25),
            primitive_index: 7,
            geometry_index: 8,
            instance_index: 9,
        }
    }

    #[test]
    fn words_become_answers() {
        let counters = bytemuck::cast::<[u32; 6], Counters>([1, 2, 3, 4, 5, 6]);
        let mut closest = results(PointSearch::Closest, true, 1);
        closest.append(&[&POINT[..10], &[1, 2, 3, 4, 5, 6]].concat()).unwrap();
        let answers = closest.into_closest();
        assert_eq!((answers.points, answers.status), (vec![point()], vec![Status::STEP_BUDGET]));
        assert_eq!(answers.counters, Some(vec![counters]));
        let mut plain = results(PointSearch::Closest, false, 1);
        plain.append(&POINT).unwrap();
        assert_eq!(plain.into_closest().counters, None);

        let mut nearest = results(PointSearch::Nearest, true, 2);
        let list = |held| [held, STATUS_WRITTEN, 1, 2, 3, 4, 5, 6];
        nearest.append(&[&list(1)[..], &POINT, &[0; 12], &list(2), &POINT, &POINT].concat()).unwrap();
        nearest.append(&[&list(0)[..], &[0; 24]].concat()).unwrap();
        let answers = nearest.into_nearest();
        assert_eq!((answers.points.offsets, answers.points.points), (vec![0, 1, 3, 3], vec![point(); 3]));
        assert_eq!((answers.status, answers.counters), (vec![Status::COMPLETE; 3], Some(vec![counters; 3])));
        assert_eq!(results(PointSearch::Nearest, false, 0).into_nearest().points.offsets, [0]);
    }

    #[test]
    fn what_was_not_written_is_an_error() {
        let error = |query| Err(GpuError::UnansweredQuery { query });
        let mut closest = results(PointSearch::Closest, false, 1);
        assert_eq!(closest.append(&[POINT, [0; 12]].concat()), error(1));
        let append = |held: u32, status, points: [[u32; 12]; 2]| {
            results(PointSearch::Nearest, false, 2)
                .append(&[&[held, status, 0, 0], points.as_flattened()].concat())
        };
        assert_eq!(append(2, STATUS_WRITTEN, [POINT, POINT]), Ok(()));
        assert_eq!(append(0, 0, [[0; 12]; 2]), error(0));
        assert_eq!(append(2, STATUS_WRITTEN, [POINT, [0; 12]]), error(0));
        assert_eq!(append(3, STATUS_WRITTEN, [POINT, POINT]), error(0), "more than there is room for");
    }
}
