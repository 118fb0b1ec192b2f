//! Measurements of ropewalk: what it costs to build a structure, how many rays a second each walk answers, and the
//! experiments of the papers.
//!
//! | module | concept |
//! |---|---|
//! | [`arena`] | ours and foreign engines side by side: rates, builds, refits, top levels |
//! | [`mod@bench`] | one scene: builds, agreement of all walks, rates per ray class |
//! | [`mod@comparison`] | what the comparisons of short stacks share |
//! | [`closest_point`] | whether closest points are right, and what the walks to them cost |
//! | [`reichl_table2`] | frames a second of two levels beside one: Table 2 of Reichl et al. 2010 |
//! | [`restart_trail`] | what stacklessness costs: the comparison of Laine 2010 |
//! | [`traversal_lists`] | what lists cost with each of their options: the tables of Toczek et al. 2010 |
//! | [`two_level`] | what two levels cost beside one: the tables of Reichl et al. 2010 |
//! | `charts` | what their plots share |
//! | [`machine`] | what a record must say about where it was made |
//! | [`spread`] | the median of many rounds |
//!
//! Times are measured here and printed; no test depends on one.

#![forbid(unsafe_code)]

pub mod arena;
pub mod bench;
mod charts;
pub mod closest_point;
pub mod comparison;
pub mod machine;
pub mod reichl_table2;
pub mod restart_trail;
pub mod spread;
pub mod traversal_lists;
pub mod two_level;

pub use charts::PlotError;
pub use machine::Machine;
pub use spread::Spread;
