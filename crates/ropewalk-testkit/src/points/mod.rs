//! Point queries: where to ask, an oracle in f64, and comparators.
//!
//! | file | what |
//! |---|---|
//! | `queries` | seeded points: around a scene, and in every awkward place of it |
//! | `measure` | the distance of a point from a triangle in f64, with what f32 may make of it |
//! | `oracle` | all triangles of a scene, and what is wrong with an answer |
//! | `compare` | whole batches: against the oracle, and against each other to the bit |
//!
//! The comparators are tested with wrong answers of every kind.

mod compare;
mod measure;
mod oracle;
mod queries;

#[cfg(test)]
mod tests;

pub use compare::{
    PointMismatch, closest_against_oracle, nearest_against_oracle, same_closest_points, same_nearest_points,
};
pub use measure::Measured;
pub use oracle::PointOracle;
pub use queries::{around, awkward, invalid};
