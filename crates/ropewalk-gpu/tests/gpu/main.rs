//! Tests that run on every adapter of the machine. They are one program, so that each adapter is opened once and
//! each kernel is compiled once.
//!
//! Without an adapter they fail where the environment has `CI`, and say elsewhere that they were skipped.

mod all_hits;
mod broken;
mod broken_kd;
mod broken_lists;
mod compare;
mod conformance;
mod damage;
mod errors;
mod heads;
mod kd_trees;
mod levels;
mod lists;
mod machine;
mod points;
mod programs;
mod rays;
mod scenes;
mod starts;
mod surface;
mod trails;
mod trees;
mod twins;
mod versions;
