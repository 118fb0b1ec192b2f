//! Trees that are deeper than a walk's register: what a walk must refuse, with which words.

use ropewalk::catalogue::TrailRegister;
use ropewalk::{Structure, TraceError, Walk};

/// The depth of a binary tree to which a trail of 32 bits leads: one bit is the sentinel.
const U32_DEPTH: u32 = 31;
/// The same of 64 bits.
const U64_DEPTH: u32 = 63;
/// The levels of a wide tree to which 64 bits lead, at four bits a level.
const U64_LEVELS: u32 = 16;

/// The text with which a walk must refuse a structure; `None` where it must answer.
#[must_use]
pub fn refusal(structure: &Structure, walk: Walk) -> Option<String> {
    let Walk::RestartTrail(options) = walk else { return None };
    let depth = structure.report().depth;
    let limit = match (structure, options.register) {
        (_, TrailRegister::Auto | TrailRegister::Array) => return None,
        (Structure::Bvh(_), TrailRegister::U32) => U32_DEPTH,
        (Structure::Bvh(_), TrailRegister::U64) => U64_DEPTH,
        _ => U64_LEVELS,
    };
    (depth > limit).then(|| TraceError::too_deep(walk, depth, limit).to_string())
}
