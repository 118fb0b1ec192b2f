//! From the words that a kernel writes to the answers that the core crate speaks of.

use crate::GpuError;
use crate::shader::{Kernel, STATUS_WRITTEN};
use ropewalk::glam::Vec2;
use ropewalk::{Answer, Counters, Hit, Query, Status, Traced};

/// What the kernel wrote for the rays of a batch, tile after tile.
#[derive(Debug)]
pub(super) struct Results {
    kernel: Kernel,
    /// Of closest hits.
    hits: Vec<Hit>,
    /// Of the other queries: whether there is a hit, or how many there are.
    words: Vec<u32>,
    status: Vec<Status>,
    counters: Vec<Counters>,
}

impl Results {
    pub(super) fn new(kernel: Kernel, rays: usize) -> Self {
        let closest = kernel.query == Query::Closest;
        Self {
            kernel,
            hits: Vec::with_capacity(if closest { rays } else { 0 }),
            words: Vec::with_capacity(if closest { 0 } else { rays }),
            status: Vec::with_capacity(rays),
            counters: Vec::with_capacity(if kernel.counters { rays } else { 0 }),
        }
    }

    /// Takes the words of the next rays.
    pub(super) fn append(&mut self, words: &[u32]) -> Result<(), GpuError> {
        for record in words.chunks_exact(self.kernel.result_words()) {
            let unanswered = GpuError::Unanswered { ray: self.status.len() };
            let (status, counted) = if self.kernel.query == Query::Closest {
                let Some((hit, status)) = read_hit(record) else { return Err(unanswered) };
                self.hits.push(hit);
                (status, record.get(Kernel::HIT_WORDS..))
            } else {
                let Some((word, status)) = read_word(record) else { return Err(unanswered) };
                self.words.push(word);
                (status, record.get(2..))
            };
            self.status.push(status);
            if let (true, Some(counted)) = (self.kernel.counters, counted.and_then(<[u32]>::first_chunk::<6>))
            {
                self.counters.push(bytemuck::cast(*counted));
            }
        }
        Ok(())
    }

    /// The words of the rays: of an all-hits batch, how many hits each has.
    pub(super) fn words(&self) -> &[u32] {
        &self.words
    }

    /// The answers. An all-hits batch brings its own, since its hits are another matter.
    pub(super) fn into_traced(self, all: Option<Answer>) -> Traced {
        let answer = match (all, self.kernel.query) {
            (Some(answer), _) => answer,
            (None, Query::Any) => Answer::Any(self.words.iter().map(|&word| word != 0).collect()),
            (None, Query::Count | Query::All) => Answer::Count(self.words),
            (None, Query::Closest) => Answer::Closest(self.hits),
        };
        Traced { answer, status: self.status, counters: self.kernel.counters.then_some(self.counters) }
    }
}

/// The hit and the status in eight words; `None` where no invocation wrote them.
pub(super) fn read_hit(record: &[u32]) -> Option<(Hit, Status)> {
    let &[t, u, v, primitive_index, geometry_index, instance_index, front_face, status, ..] = record else {
        return None;
    };
    let hit = Hit {
        t: f32::from_bits(t),
        barycentrics: Vec2::new(f32::from_bits(u), f32::from_bits(v)),
        primitive_index,
        geometry_index,
        instance_index,
        front_face: front_face != 0,
    };
    Some((hit, written(status)?))
}

/// The word and the status in two words; `None` where no invocation wrote them.
pub(super) fn read_word(record: &[u32]) -> Option<(u32, Status)> {
    let &[word, status, ..] = record else { return None };
    Some((word, written(status)?))
}

pub(super) fn written(status: u32) -> Option<Status> {
    (status & STATUS_WRITTEN != 0).then_some(Status(status & !STATUS_WRITTEN))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::shader::Tree;
    use ropewalk::Walk;

    fn results(query: Query, counters: bool) -> Results {
        let (tree, walk) = (Tree::Binary, Walk::default());
        Results::new(Kernel { tree, walk, query, counters, stack_entries: 8, starts: 0 }, 2)
    }

    #[test]
    fn words_become_answers() {
        let mut closest = results(Query::Closest, true);
        let t = 2.5_f32.to_bits();
        let record = [t, 0, t, 7, 8, 9, 1, STATUS_WRITTEN | 2, 1, 2, 3, 4, 5, 6, 0, 0];
        closest.append(&record).unwrap();
        let traced = closest.into_traced(None);
        let hit = Hit {
            t: 2.5,
            barycentrics: Vec2::new(0.0, 2.5),
            primitive_index: 7,
            geometry_index: 8,
            instance_index: 9,
            front_face: true,
        };
        assert_eq!(traced.answer, Answer::Closest(vec![hit]));
        assert_eq!(traced.status, [Status::STEP_BUDGET]);
        let counters = bytemuck::cast::<[u32; 6], Counters>([1, 2, 3, 4, 5, 6]);
        assert_eq!(traced.counters, Some(vec![counters]));

        let mut any = results(Query::Any, false);
        any.append(&[1, STATUS_WRITTEN, 0, STATUS_WRITTEN]).unwrap();
        assert_eq!(any.into_traced(None).answer, Answer::Any(vec![true, false]));

        let mut count = results(Query::Count, true);
        count.append(&[17, STATUS_WRITTEN | 1, 1, 2, 3, 4, 5, 6]).unwrap();
        let traced = count.into_traced(None);
        assert_eq!((traced.answer, traced.status), (Answer::Count(vec![17]), vec![Status::INVALID_RAY]));
        assert_eq!(traced.counters, Some(vec![counters]));
    }

    #[test]
    fn a_ray_that_nobody_answered_is_an_error() {
        let mut closest = results(Query::Closest, false);
        let mut words = [0; 16];
        words[7] = STATUS_WRITTEN;
        assert_eq!(closest.append(&words), Err(GpuError::Unanswered { ray: 1 }));
        for query in [Query::Any, Query::Count, Query::All] {
            assert_eq!(results(query, false).append(&[0; 4]), Err(GpuError::Unanswered { ray: 0 }));
        }
    }
}
