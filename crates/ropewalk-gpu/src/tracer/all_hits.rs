//! Every hit of every ray: the second run of an all-hits kernel, after the first has counted them.
//!
//! The first run has room for no hit and counts. Then the host gives each ray as many places as it has hits, and the
//! same kernel runs again and fills them. Rays without hits take no part in the second run.
//!
//! **Invariants.** The places of a tile's rays follow each other from 0 on, and end where its buffer ends. A ray that
//! finds another number of hits in the second run than in the first has no answer.

use super::limits::TileLimits;
use super::records::Records;
use super::results::{read_hit, read_word};
use super::tile::Job;
use crate::GpuError;
use crate::shader::Kernel;
use ropewalk::{HitLists, batch};
use std::borrow::Cow;
use std::ops::Range;

/// What the second run has to do.
#[derive(Debug)]
pub(super) struct Plan {
    kernel: Kernel,
    /// The rays that hit something, in their order.
    rays: Vec<usize>,
    /// How many hits each of them has, repeats included.
    counts: Vec<u32>,
    /// Ranges of `rays`.
    tiles: Vec<Range<usize>>,
}

impl Plan {
    /// Cuts the rays into tiles, of which the first run found so many hits each.
    pub(super) fn new(kernel: Kernel, counts: &[u32], limits: TileLimits) -> Result<Self, GpuError> {
        let (rays, counts): (Vec<usize>, Vec<u32>) =
            counts.iter().copied().enumerate().filter(|&(_, count)| count > 0).unzip();
        let mut tiles = Vec::new();
        let mut first = 0;
        while first < rays.len() {
            let end = limits.tile_end(kernel, &counts, first)?;
            tiles.push(first..end);
            first = end;
        }
        Ok(Self { kernel, rays, counts, tiles })
    }

    /// The tiles, for the rays of the whole batch.
    pub(super) fn jobs<'a>(&'a self, rays: Records<'a>) -> impl Iterator<Item = Job<'a>> {
        self.tiles.iter().map(move |tile| {
            let counts = &self.counts[tile.clone()];
            let mut records = Vec::with_capacity(counts.len() * self.kernel.ray_words());
            let mut place = 0;
            for (&ray, &count) in self.rays[tile.clone()].iter().zip(counts) {
                rays.append(&mut records, ray, &[place, count]);
                // A tile's hits fit a buffer, of which the words are counted in 32 bits.
                place += count;
            }
            Job {
                rays: Cow::Owned(records),
                ray_count: counts.len() as u32,
                result_words: counts.len() * self.kernel.result_words() + place as usize * Kernel::HIT_WORDS,
            }
        })
    }

    /// Takes the words of one tile after the other.
    pub(super) fn read(&self, lists: &mut Lists, words: &[u32]) -> Result<(), GpuError> {
        let Some(tile) = self.tiles.get(lists.tiles_read) else { return Ok(()) };
        lists.tiles_read += 1;
        let counts = &self.counts[tile.clone()];
        let (headers, mut hits) =
            words.split_at_checked(counts.len() * self.kernel.result_words()).unwrap_or_default();
        let headers = headers.chunks_exact(self.kernel.result_words());
        for ((&ray, &count), header) in self.rays[tile.clone()].iter().zip(counts).zip(headers) {
            let unanswered = GpuError::Unanswered { ray };
            let Some((own, rest)) = hits.split_at_checked(count as usize * Kernel::HIT_WORDS) else {
                return Err(unanswered);
            };
            hits = rest;
            if read_word(header).is_none_or(|(found, _)| found != count) {
                return Err(unanswered);
            }
            let first = lists.hits.len();
            for hit in own.chunks_exact(Kernel::HIT_WORDS) {
                let Some((hit, _)) = read_hit(hit) else { return Err(unanswered) };
                lists.hits.push(hit);
            }
            batch::settle(&mut lists.hits, first, lists.has_repeats);
            lists.kept.push((ray, lists.hits.len() - first));
        }
        Ok(())
    }
}

/// Some rays of the first run: there is room for no hit.
pub(super) fn counting_job(kernel: Kernel, rays: Records<'_>, part: Range<usize>) -> Job<'static> {
    let ray_count = part.len();
    let mut records = Vec::with_capacity(ray_count * kernel.ray_words());
    part.for_each(|ray| rays.append(&mut records, ray, &[0, 0]));
    Job {
        rays: Cow::Owned(records),
        ray_count: ray_count as u32,
        result_words: ray_count * kernel.result_words(),
    }
}

/// What the second run has answered so far.
#[derive(Debug)]
pub(super) struct Lists {
    has_repeats: bool,
    tiles_read: usize,
    hits: Vec<ropewalk::Hit>,
    /// Rays that hit something, with the number of hits that are left when repeats are gone.
    kept: Vec<(usize, usize)>,
}

impl Lists {
    /// Nothing yet.
    pub(super) const fn new(has_repeats: bool) -> Self {
        Self { has_repeats, tiles_read: 0, hits: Vec::new(), kept: Vec::new() }
    }

    /// The lists of so many rays.
    pub(super) fn into_lists(self, rays: usize) -> HitLists {
        let mut offsets = Vec::with_capacity(rays + 1);
        let mut end = 0;
        for (ray, kept) in self.kept {
            // Those before it that hit nothing begin where it begins.
            offsets.resize(ray + 1, end);
            end += kept as u64;
        }
        offsets.resize(rays + 1, end);
        HitLists { offsets, hits: self.hits }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::shader::STATUS_WRITTEN;
    use crate::tracer::limits::tests::ALL;
    use ropewalk::{Ray, glam::Vec3};

    const LIMITS: TileLimits = TileLimits { rays: 2, result_bytes: 1 << 20 };

    fn hit(t: f32, primitive: u32) -> [u32; 8] {
        [t.to_bits(), 0, 0, primitive, 0, 0, 0, STATUS_WRITTEN]
    }

    fn header(found: u32) -> [u32; 4] {
        [found, STATUS_WRITTEN, 0, 0]
    }

    #[test]
    fn hits_go_back_to_their_rays() {
        let plan = Plan::new(ALL, &[0, 2, 0, 1, 3, 0], LIMITS).unwrap();
        let rays: Vec<Ray> = (0..6).map(|i| Ray::new(Vec3::splat(i as f32), Vec3::X)).collect();
        let jobs: Vec<Job<'_>> = plan.jobs(Records::plain(&rays)).collect();
        assert_eq!(jobs.len(), 2);
        assert_eq!(
            (jobs[0].ray_count, jobs[0].result_words, jobs[1].result_words),
            (2, 2 * 4 + 3 * 8, 4 + 3 * 8)
        );
        // The second ray that hits begins behind the first one's two hits.
        assert_eq!(jobs[0].rays[11..12], [3.0_f32.to_bits()]);
        assert_eq!(jobs[0].rays[20..22], [2, 1]);
        let first = [header(2).as_slice(), &header(1), &hit(2.0, 7), &hit(1.0, 8), &hit(5.0, 9)].concat();
        let second = [header(3).as_slice(), &hit(4.0, 3), &hit(3.0, 4), &hit(4.0, 3)].concat();
        for (has_repeats, ends) in [(false, [0, 0, 2, 2, 3, 6, 6]), (true, [0, 0, 2, 2, 3, 5, 5])] {
            let mut lists = Lists::new(has_repeats);
            plan.read(&mut lists, &first).unwrap();
            plan.read(&mut lists, &second).unwrap();
            let lists = lists.into_lists(6);
            assert_eq!(lists.offsets, ends);
            assert_eq!(lists.of(1).iter().map(|hit| hit.primitive_index).collect::<Vec<_>>(), [8, 7]);
            assert_eq!(lists.of(4)[0].primitive_index, 4);
        }
    }

    #[test]
    fn what_was_not_written_is_an_error() {
        let plan = Plan::new(ALL, &[0, 2], LIMITS).unwrap();
        let sound = [header(2).as_slice(), &hit(2.0, 7), &hit(1.0, 8)].concat();
        assert!(plan.read(&mut Lists::new(false), &sound).is_ok());
        for (place, word) in [(0, 1), (0, 3), (1, 0), (11, 0), (19, 0)] {
            let mut words = sound.clone();
            words[place] = word;
            let error = plan.read(&mut Lists::new(false), &words).unwrap_err();
            assert_eq!(error, GpuError::Unanswered { ray: 1 }, "word {place}");
        }
    }

    #[test]
    fn rays_that_hit_nothing_have_empty_lists() {
        let plan = Plan::new(ALL, &[0, 0], LIMITS).unwrap();
        assert_eq!(plan.jobs(Records::plain(&[])).count(), 0);
        assert_eq!(Lists::new(true).into_lists(2).offsets, [0, 0, 0]);
        assert_eq!(Lists::new(true).into_lists(0).offsets, [0]);
    }
}
