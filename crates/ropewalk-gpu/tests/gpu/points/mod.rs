//! Point queries: the same bytes in, and the CPU and every adapter give the same words out, counters included.

mod broken;
mod compare;
mod errors;
mod queries;
mod tiles;
mod twins;

use crate::scenes::Case;
use ropewalk::{Bvh, PointQuery, Structure, TraceOptions};

const COUNTED: TraceOptions = TraceOptions { counters: true };
const PLAIN: TraceOptions = TraceOptions { counters: false };

/// The tree that the CPU asks.
fn bvh(structure: &Structure) -> &Bvh {
    match structure {
        Structure::Bvh(bvh) => bvh,
        other => panic!("'{}' answers no point queries", other.kind()),
    }
}

/// A scene with its queries.
fn asked(case: Case) -> (Case, Vec<PointQuery>) {
    let queries = queries::against(bvh(&case.structure));
    (case, queries)
}
