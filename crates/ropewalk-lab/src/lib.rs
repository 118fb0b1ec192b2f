//! Measurements of ropewalk: what it costs to build a structure, and how many rays a second each walk answers.
//!
//! | module | concept |
//! |---|---|
//! | [`mod@bench`] | one scene: builds, agreement of all walks, rates per ray class |
//! | [`machine`] | what a record must say about where it was made |
//! | [`spread`] | the median of many rounds |
//!
//! Times are measured here and printed; no test depends on one.

#![forbid(unsafe_code)]

pub mod bench;
pub mod machine;
pub mod spread;

pub use machine::Machine;
pub use spread::Spread;
