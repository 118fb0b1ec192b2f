//! One ray or many through a structure by one walk, whatever both are: what all structures share.
//!
//! Rays are spread over threads in chunks; answers come back in the order of the rays.

use super::filter::{Filtered, Keep};
use super::{Answer, HitLists, TraceOptions, Traced};
use crate::bvh::walk::{AllHits, AnyHit, ClosestHit, Collect, HitCount, Summary};
use crate::parallel::{fill_chunks, map_chunks};
use crate::{Counters, Hit, NoProbe, PreparedRay, Probe, Query, Ray, Status};

/// Rays that a thread takes at a time: long enough to hide the hand-over, short enough to share the work.
const CHUNK: usize = 1024;

/// What a walk is asked: a ray, and perhaps something that is known of it.
pub(crate) trait Question: Sync {
    /// The ray.
    fn ray(&self) -> &Ray;
}

impl Question for Ray {
    #[inline(always)]
    fn ray(&self) -> &Self {
        self
    }
}

/// Many rays, and what is asked of them.
#[derive(Clone, Copy)]
pub(crate) struct Batch<'a, Q = Ray> {
    pub(crate) query: Query,
    pub(crate) rays: &'a [Q],
    pub(crate) options: TraceOptions,
    /// Which hits count; `None` where all do.
    pub(crate) keep: Option<Keep<'a>>,
}

impl Batch<'_> {
    /// Asks for closest hits or any hits of all rays at once, as structures answer that lead several rays in turn. `None`
    /// where each hit counts, or the work of each ray, or hits must be kept first.
    pub(crate) fn answered_at_once(
        &self,
        closest: impl FnOnce(&[Ray], &mut [Hit]),
        any: impl FnOnce(&[Ray], &mut [bool]),
    ) -> Option<Traced> {
        if self.keep.is_some() || self.options.counters {
            return None;
        }
        let answer = match self.query {
            Query::Closest => {
                let mut hits = vec![Hit::MISS; self.rays.len()];
                closest(self.rays, &mut hits);
                Answer::Closest(hits)
            }
            Query::Any => {
                let mut hits = vec![false; self.rays.len()];
                any(self.rays, &mut hits);
                Answer::Any(hits)
            }
            Query::All | Query::Count => return None,
        };
        Some(Traced { answer, status: statuses(self.rays), counters: None })
    }
}

/// A structure together with the way to walk it.
pub(crate) trait Traversal<Q: Question = Ray>: Sync {
    /// Leads the ray of a question, ready made, through the structure, and gives back what was collected and counted.
    fn visit<C: Collect, P: Probe>(&self, question: &Q, ray: &PreparedRay, collect: C, probe: P) -> (C, P);

    /// Whether a triangle may stand in several leaves, so that its hit may be offered several times.
    fn has_repeats(&self) -> bool;

    /// The answer of a query, and what was counted on the way. With [`HitCount`] it counts offers.
    #[inline(always)]
    fn summary<S: Summary, P: Probe + Default>(&self, question: &Q) -> (S::Answer, P) {
        match PreparedRay::new(question.ray()) {
            None => Default::default(),
            Some(ray) => {
                let (summary, probe) = self.visit(question, &ray, S::new(&ray), P::default());
                (summary.answer(), probe)
            }
        }
    }

    /// How many hits a ray has in its window, each triangle's once; 0 where the ray is not valid.
    fn count(&self, question: &Q) -> u32 {
        if self.has_repeats() {
            let mut hits = Vec::new();
            self.append_all(question, &mut hits, NoProbe);
            return hits.len() as u32;
        }
        self.summary::<HitCount, NoProbe>(question).0
    }

    /// Appends every hit of a ray, each triangle's once, sorted by `t`, ties by id.
    fn append_all<P: Probe + Default>(&self, question: &Q, hits: &mut Vec<Hit>, probe: P) -> P {
        let Some(ray) = PreparedRay::new(question.ray()) else { return probe };
        let first = hits.len();
        let probe = self.visit(question, &ray, AllHits::new(&ray, hits), probe).1;
        settle(hits, first, self.has_repeats());
        probe
    }

    /// Traces a batch.
    fn trace(&self, batch: Batch<'_, Q>) -> Traced
    where
        Self: Sized,
    {
        let Batch { query, rays, options, keep } = batch;
        match keep {
            None => self.trace_all(query, rays, options),
            Some(keep) => {
                Filtered { walk: self, keep, counts: options.counters }.trace_all(query, rays, options)
            }
        }
    }

    /// Traces a batch; every hit counts.
    fn trace_all(&self, query: Query, rays: &[Q], options: TraceOptions) -> Traced {
        if options.counters {
            let (answer, counters) = self.by_probe::<Counters>(query, rays);
            Traced { answer, status: statuses(rays), counters: Some(counters) }
        } else {
            let (answer, _) = self.by_probe::<NoProbe>(query, rays);
            Traced { answer, status: statuses(rays), counters: None }
        }
    }

    /// Traces a batch and counts with one probe a ray.
    fn by_probe<P: Probe + Copy + Default + Send>(&self, query: Query, rays: &[Q]) -> (Answer, Vec<P>) {
        match query {
            Query::Closest => {
                let (hits, probes) = self.each::<ClosestHit, P>(rays);
                (Answer::Closest(hits), probes)
            }
            Query::Any => {
                let (hits, probes) = self.each::<AnyHit, P>(rays);
                (Answer::Any(hits), probes)
            }
            Query::Count if self.has_repeats() => {
                let (lists, probes) = self.lists(rays);
                (
                    Answer::Count(lists.offsets.windows(2).map(|pair| (pair[1] - pair[0]) as u32).collect()),
                    probes,
                )
            }
            Query::Count => {
                let (counts, probes) = self.each::<HitCount, P>(rays);
                (Answer::Count(counts), probes)
            }
            Query::All => {
                let (lists, probes) = self.lists(rays);
                (Answer::All(lists), probes)
            }
        }
    }

    /// The small answers of many rays.
    fn each<S: Summary, P: Probe + Copy + Default + Send>(&self, rays: &[Q]) -> (Vec<S::Answer>, Vec<P>) {
        let mut records = vec![(S::Answer::default(), P::default()); rays.len()];
        answer_each(rays, &mut records, |ray| self.summary::<S, P>(ray));
        records.into_iter().unzip()
    }

    /// Every hit of many rays.
    fn lists<P: Probe + Copy + Default + Send>(&self, rays: &[Q]) -> (HitLists, Vec<P>) {
        let (offsets, hits, probes) = gather(rays, |ray, hits| self.append_all(ray, hits, P::default()));
        (HitLists { offsets, hits }, probes)
    }
}

/// Answers each of many questions, into `answers`. Only the first `min(questions.len(), answers.len())` are answered.
pub(crate) fn answer_each<Q: Sync, A: Send>(
    questions: &[Q],
    answers: &mut [A],
    answer: impl Fn(&Q) -> A + Sync,
) {
    let len = questions.len().min(answers.len());
    fill_chunks(&mut answers[..len], CHUNK, |first, part| {
        for (slot, question) in part.iter_mut().zip(&questions[first..]) {
            *slot = answer(question);
        }
    });
}

/// Gathers the lists of many questions, one after the other: `append` adds a question's answers. Gives back where each
/// list begins, with the end of the last, all answers, and what `append` returned.
pub(crate) fn gather<Q: Sync, A: Send, R: Send>(
    questions: &[Q],
    append: impl Fn(&Q, &mut Vec<A>) -> R + Sync,
) -> (Vec<u64>, Vec<A>, Vec<R>) {
    let parts = map_chunks(questions, CHUNK, |_, questions| {
        let (mut answers, mut ends, mut returned) = (Vec::new(), Vec::new(), Vec::new());
        for question in questions {
            returned.push(append(question, &mut answers));
            ends.push(answers.len() as u64);
        }
        (answers, ends, returned)
    });
    let (mut offsets, mut all, mut all_returned) = (vec![0], Vec::new(), Vec::new());
    for (answers, ends, returned) in parts {
        let before = all.len() as u64;
        offsets.extend(ends.into_iter().map(|end| before + end));
        all.extend(answers);
        all_returned.extend(returned);
    }
    (offsets, all, all_returned)
}

/// Sorts the hits of one ray, those from `first` on, by `t`, ties by id; where the structure
/// [has repeats](crate::Structure::has_repeats), keeps the hit of each triangle once.
pub fn settle(hits: &mut Vec<Hit>, first: usize, has_repeats: bool) {
    let Some(own) = hits.get_mut(first..) else { return };
    own.sort_unstable_by(|a, b| a.t.total_cmp(&b.t).then_with(|| a.id().cmp(&b.id())));
    if has_repeats {
        keep_first_of_each(hits, first);
    }
}

/// Removes what repeats its predecessor from the sorted hits from `first` on: a triangle in several leaves gives
/// the same hit, to the bit, in each.
fn keep_first_of_each(hits: &mut Vec<Hit>, first: usize) {
    let mut kept = first;
    for index in first..hits.len() {
        if index == first || hits[index].id() != hits[kept - 1].id() {
            hits[kept] = hits[index];
            kept += 1;
        }
    }
    hits.truncate(kept);
}

fn statuses<Q: Question>(questions: &[Q]) -> Vec<Status> {
    let status =
        |question: &Q| if question.ray().is_valid() { Status::COMPLETE } else { Status::INVALID_RAY };
    questions.iter().map(status).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_repeated_hit_is_kept_once() {
        let hit = |t, primitive_index| Hit {
            t,
            primitive_index,
            instance_index: 0,
            geometry_index: 0,
            ..Hit::MISS
        };
        let (a, b, c) = (hit(1.0, 4), hit(1.0, 5), hit(2.0, 3));
        let mut hits = vec![a, a, a, b, c, c];
        keep_first_of_each(&mut hits, 1);
        assert_eq!(hits, [a, a, b, c], "what stood before is another ray's");
        let mut none = vec![a];
        keep_first_of_each(&mut none, 1);
        assert_eq!(none, [a]);
    }
}
