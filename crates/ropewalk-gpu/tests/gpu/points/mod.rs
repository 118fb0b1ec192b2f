//! Point queries: the same bytes in, and the CPU and every adapter give the same words out, counters included.

mod broken;
mod compare;
mod errors;
mod queries;
mod tiles;
mod twins;

use crate::scenes::Case;
use ropewalk::catalogue::{StackMemory, TrailOptions};
use ropewalk::{Bvh, PointQuery, Structure, TraceOptions, Walk};

const COUNTED: TraceOptions = TraceOptions { counters: true };
const PLAIN: TraceOptions = TraceOptions { counters: false };

/// The tree that the CPU asks.
fn bvh(structure: &Structure) -> &Bvh {
    match structure {
        Structure::Bvh(bvh) => bvh,
        other => panic!("'{}' answers no point queries", other.kind()),
    }
}

/// The CPU's walk of the same words: it has no workgroup memory, and no answer depends on it.
fn twin(walk: Walk) -> Walk {
    match walk {
        Walk::RestartTrail(options) => {
            Walk::RestartTrail(TrailOptions { memory: StackMemory::Private, ..options })
        }
        other => other,
    }
}

/// A scene with its queries.
fn asked(case: Case) -> (Case, Vec<PointQuery>) {
    let queries = queries::against(bvh(&case.structure));
    (case, queries)
}
