//! From the words that a kernel writes to the answers that the core crate speaks of.

use crate::GpuError;
use crate::shader::{Kernel, STATUS_WRITTEN};
use ropewalk::glam::Vec2;
use ropewalk::{Answer, Counters, Hit, Query, Status, Traced};

/// The answers of a batch, tile after tile.
#[derive(Debug)]
pub(super) struct Results {
    kernel: Kernel,
    hits: Vec<Hit>,
    flags: Vec<bool>,
    status: Vec<Status>,
    counters: Vec<Counters>,
}

impl Results {
    pub(super) fn new(kernel: Kernel, rays: usize) -> Self {
        let any = kernel.query == Query::Any;
        Self {
            kernel,
            hits: Vec::with_capacity(if any { 0 } else { rays }),
            flags: Vec::with_capacity(if any { rays } else { 0 }),
            status: Vec::with_capacity(rays),
            counters: Vec::with_capacity(if kernel.counters { rays } else { 0 }),
        }
    }

    /// Takes the words of the next rays.
    pub(super) fn append(&mut self, words: &[u32]) -> Result<(), GpuError> {
        for record in words.chunks_exact(self.kernel.result_words()) {
            let counted = match (self.kernel.query, record) {
                (Query::Any, &[hit, status, ref counted @ ..]) => {
                    self.status(status)?;
                    self.flags.push(hit != 0);
                    counted
                }
                (_, &[t, u, v, primitive, geometry, instance, front_face, status, ref counted @ ..]) => {
                    self.status(status)?;
                    self.hits.push(Hit {
                        t: f32::from_bits(t),
                        barycentrics: Vec2::new(f32::from_bits(u), f32::from_bits(v)),
                        primitive_index: primitive,
                        geometry_index: geometry,
                        instance_index: instance,
                        front_face: front_face != 0,
                    });
                    counted
                }
                // A record has as many words as the kernel says: one of the arms above takes it.
                _ => return Err(GpuError::Unanswered { ray: self.status.len() }),
            };
            if let (
                true,
                &[inner_visits, leaf_visits, primitive_tests, restarts, stack_depth, objects_entered, ..],
            ) = (self.kernel.counters, counted)
            {
                self.counters.push(Counters {
                    inner_visits,
                    leaf_visits,
                    primitive_tests,
                    restarts,
                    stack_depth,
                    objects_entered,
                });
            }
        }
        Ok(())
    }

    pub(super) fn into_traced(self) -> Traced {
        let answer = if self.kernel.query == Query::Any {
            Answer::Any(self.flags)
        } else {
            Answer::Closest(self.hits)
        };
        Traced { answer, status: self.status, counters: self.kernel.counters.then_some(self.counters) }
    }

    fn status(&mut self, word: u32) -> Result<(), GpuError> {
        if word & STATUS_WRITTEN == 0 {
            return Err(GpuError::Unanswered { ray: self.status.len() });
        }
        self.status.push(Status(word & !STATUS_WRITTEN));
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use ropewalk::Walk;

    fn results(query: Query, counters: bool) -> Results {
        Results::new(Kernel { walk: Walk::default(), query, counters, stack_entries: 8 }, 2)
    }

    #[test]
    fn words_become_answers() {
        let mut closest = results(Query::Closest, true);
        let t = 2.5_f32.to_bits();
        let record = [t, 0, t, 7, 8, 9, 1, STATUS_WRITTEN | 2, 1, 2, 3, 4, 5, 6, 0, 0];
        closest.append(&record).unwrap();
        let traced = closest.into_traced();
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
        assert_eq!(any.into_traced().answer, Answer::Any(vec![true, false]));
    }

    #[test]
    fn a_ray_that_nobody_answered_is_an_error() {
        let mut closest = results(Query::Closest, false);
        let mut words = [0; 16];
        words[7] = STATUS_WRITTEN;
        assert_eq!(closest.append(&words), Err(GpuError::Unanswered { ray: 1 }));
        assert_eq!(results(Query::Any, false).append(&[0, 0]), Err(GpuError::Unanswered { ray: 0 }));
    }
}
