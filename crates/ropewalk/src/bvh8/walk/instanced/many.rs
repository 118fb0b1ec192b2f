//! Several rays in turn through two levels.

use super::course::{Course, Step};
use super::find::Goal;
use super::levels::Levels;
use crate::bvh8::arena::Reader;
use crate::bvh8::simd::{Level, Task};
use crate::{NoProbe, PreparedRay, Ray};
use std::marker::PhantomData;

/// The rays of a batch that have not begun.
struct Queue<'a> {
    rays: &'a [Ray],
    next: usize,
}

impl Queue<'_> {
    /// The next ray that can be traced, and which it is; those that cannot are answered on the way.
    #[inline(always)]
    fn next<'a, G: Goal<'a>>(&mut self, answers: &mut [G::Answer]) -> Option<(usize, Ray, PreparedRay)> {
        while let Some(ray) = self.rays.get(self.next) {
            let index = self.next;
            self.next += 1;
            if let Some(prepared) = PreparedRay::new(ray) {
                return Some((index, *ray, prepared));
            }
            answers[index] = G::NOTHING;
        }
        None
    }
}

/// A batch, `SLOTS` rays at a time. The top level must not be empty.
pub(super) struct Many<'a, 'b, R, G: Goal<'a>, const SLOTS: usize> {
    pub(super) levels: Levels<'a, R>,
    pub(super) rays: &'b [Ray],
    /// As many as there are rays.
    pub(super) answers: &'b mut [G::Answer],
    pub(super) goal: PhantomData<G>,
}

impl<'a, R: Reader<'a>, G: Goal<'a>, const SLOTS: usize> Task for Many<'a, '_, R, G, SLOTS> {
    type Output = ();

    #[inline(always)]
    fn run<L: Level>(self, level: L) {
        let Self { levels, rays, answers, .. } = self;
        let mut queue = Queue { rays, next: 0 };
        let mut slots: [Option<Course<'a, R, G>>; SLOTS] = [const { None }; SLOTS];
        // Which of the batch each slot leads, and the slots that lead one.
        let mut indices = [0; SLOTS];
        let mut busy: [usize; SLOTS] = std::array::from_fn(|slot| slot);
        let mut count = 0;
        while count < SLOTS
            && let Some((index, question, ray)) = queue.next::<G>(answers)
        {
            slots[count] = Some(Course::new(&question, ray, G::new(&ray)));
            indices[count] = index;
            count += 1;
        }
        while count > 0 {
            let mut turn = 0;
            while turn < count {
                let slot = busy[turn];
                let Some(course) = &mut slots[slot] else { return };
                if course.step(level, levels, &mut NoProbe) == Step::Done {
                    answers[indices[slot]] = course.find.answer();
                    match queue.next::<G>(answers) {
                        Some((index, question, ray)) => {
                            course.begin(&question, ray, G::new(&ray));
                            indices[slot] = index;
                        }
                        None => {
                            count -= 1;
                            busy.swap(turn, count);
                            continue;
                        }
                    }
                }
                turn += 1;
            }
        }
    }
}
