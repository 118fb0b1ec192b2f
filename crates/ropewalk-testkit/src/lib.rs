//! Oracle, hard cases, seeded rays and the conformance suite of ropewalk.
//!
//! | module | what |
//! |---|---|
//! | [`oracle`] | brute force in f64, with how far a right answer in f32 may lie from it |
//! | [`rays`] | seeded rays of every class, the same on every machine; the benchmarks use them too |
//! | [`cases`] | small scenes that are hard to get right, each with its rays |
//! | [`compare`] | comparators of answers; each is tested with wrong ones |
//! | [`conformance`] | every row of the catalogue over every case, on any device |
//! | [`faulty_trail`] | restart trails with known faults |
//! | [`meshes`] | procedural meshes: spheres, fans, grids, soups |
//! | [`points`] | point queries: where to ask, an oracle in f64, comparators |
//! | [`random`] | the random numbers of all this |
//! | [`recorder`] | what a walk does, event by event |
//!
//! Nothing here knows how a device traces: a GPU is judged by the same code as the CPU.

#![forbid(unsafe_code)]

pub mod cases;
pub mod compare;
pub mod conformance;
pub mod faulty_trail;
pub mod meshes;
pub mod oracle;
pub mod points;
pub mod random;
pub mod rays;
pub mod recorder;
