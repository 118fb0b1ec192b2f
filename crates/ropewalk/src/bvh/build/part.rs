//! What is known of the references of a node, and halving them.

use super::reference::{Extent, Reference};
use crate::parallel::map_chunks;

/// As many references are measured by one thread, 0.1 ms, without an allocation.
const CHUNK: usize = 1 << 14;

/// The common box of a node's references, and the box of their doubled centres.
#[derive(Clone, Copy)]
pub(crate) struct Part {
    pub(crate) bounds: Extent,
    pub(crate) centers: Extent,
}

impl Part {
    pub(crate) const EMPTY: Self = Self { bounds: Extent::EMPTY, centers: Extent::EMPTY };

    pub(crate) fn measure(references: &[Reference]) -> Self {
        if references.len() <= CHUNK {
            return Self::of_chunk(references);
        }
        map_chunks(references, CHUNK, |_, chunk| Self::of_chunk(chunk)).into_iter().fold(
            Self::EMPTY,
            |a, b| Self { bounds: a.bounds.union(b.bounds), centers: a.centers.union(b.centers) },
        )
    }

    fn of_chunk(references: &[Reference]) -> Self {
        let mut part = Self::EMPTY;
        references.iter().for_each(|reference| part.add(reference));
        part
    }

    #[inline(always)]
    pub(crate) fn add(&mut self, reference: &Reference) {
        self.bounds.add(reference);
        self.centers.add_point(reference.doubled_center());
    }

    /// The axis along which the centres are spread most.
    pub(crate) fn longest_axis(&self) -> usize {
        let size = self.centers.high - self.centers.low;
        if size.x >= size.y && size.x >= size.z {
            0
        } else if size.y >= size.z {
            1
        } else {
            2
        }
    }
}

/// Puts the lower half along the longest axis of the centres first. Needs no order of the centres to be there.
pub(crate) fn halve(references: &mut [Reference], part: &Part) -> (usize, [Part; 2]) {
    let middle = references.len() / 2;
    let axis = part.longest_axis();
    if middle > 0 {
        references.select_nth_unstable_by_key(middle, |reference| reference.key(axis));
    }
    let (low, high) = references.split_at(middle);
    (middle, [Part::measure(low), Part::measure(high)])
}
