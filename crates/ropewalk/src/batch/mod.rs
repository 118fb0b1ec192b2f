//! Many rays at once, and what comes back: the same types from the CPU and from a GPU.

mod entries;
mod filter;
mod trace;

pub(crate) use entries::trace_entries;
pub use filter::Keep;
pub use trace::settle;
pub(crate) use trace::{Batch, Question, Traversal, answer_each, gather};

use crate::{CounterTotals, Counters, Hit, Query, Status};

/// How a batch is traced.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct TraceOptions {
    /// Whether the walk's work is counted for each ray. Off, it costs nothing.
    pub counters: bool,
}

/// The hits of every ray of an [`Query::All`] batch, one list after the other.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct HitLists {
    /// One more than there are rays: the hits of ray `i` are `hits[offsets[i]..offsets[i + 1]]`.
    pub offsets: Vec<u64>,
    /// The hits, those of a ray sorted by `t`, ties by id.
    pub hits: Vec<Hit>,
}

impl HitLists {
    /// The hits of one ray. Empty for a ray that is not there.
    #[must_use]
    pub fn of(&self, ray: usize) -> &[Hit] {
        match (self.offsets.get(ray), self.offsets.get(ray + 1)) {
            (Some(&from), Some(&to)) => &self.hits[from as usize..to as usize],
            _ => &[],
        }
    }
}

/// What a batch answers, in the order of its rays.
#[derive(Clone, Debug, PartialEq)]
pub enum Answer {
    /// For [`Query::Closest`]: [`Hit::MISS`] where nothing was hit.
    Closest(Vec<Hit>),
    /// For [`Query::Any`].
    Any(Vec<bool>),
    /// For [`Query::All`].
    All(HitLists),
    /// For [`Query::Count`].
    Count(Vec<u32>),
}

impl Answer {
    /// The query that this answers.
    #[must_use]
    pub const fn query(&self) -> Query {
        match self {
            Self::Closest(_) => Query::Closest,
            Self::Any(_) => Query::Any,
            Self::All(_) => Query::All,
            Self::Count(_) => Query::Count,
        }
    }

    /// The number of rays.
    #[must_use]
    pub fn len(&self) -> usize {
        match self {
            Self::Closest(hits) => hits.len(),
            Self::Any(hits) => hits.len(),
            Self::All(lists) => lists.offsets.len().saturating_sub(1),
            Self::Count(counts) => counts.len(),
        }
    }

    /// Whether there were no rays.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// How many rays hit something.
    #[must_use]
    pub fn rays_that_hit(&self) -> usize {
        match self {
            Self::Closest(hits) => hits.iter().filter(|hit| hit.is_hit()).count(),
            Self::Any(hits) => hits.iter().filter(|&&hit| hit).count(),
            Self::All(lists) => lists.offsets.windows(2).filter(|pair| pair[0] < pair[1]).count(),
            Self::Count(counts) => counts.iter().filter(|&&count| count > 0).count(),
        }
    }
}

/// A traced batch.
#[derive(Clone, Debug, PartialEq)]
pub struct Traced {
    /// The answers.
    pub answer: Answer,
    /// A word a ray that says whether its answer is complete.
    pub status: Vec<Status>,
    /// What each ray's walk did, where [`TraceOptions::counters`] asked for it.
    pub counters: Option<Vec<Counters>>,
}

impl Traced {
    /// How many rays have `bit` set in their status.
    #[must_use]
    pub fn count_status(&self, bit: Status) -> usize {
        self.status.iter().filter(|status| status.contains(bit)).count()
    }

    /// The sums of the counters, where they were asked for.
    #[must_use]
    pub fn totals(&self) -> Option<CounterTotals> {
        self.counters.as_ref().map(|counters| counters.iter().collect())
    }
}
