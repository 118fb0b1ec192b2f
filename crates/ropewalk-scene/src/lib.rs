//! Scenes for ropewalk: from files, and procedural ones that need no file.
//!
//! [`load`] reads a file of any known format, gzipped or not, into a [`Model`]; [`builtin`] makes one.

#![forbid(unsafe_code)]

pub mod builtin;
mod error;
pub mod load;
mod model;

pub use error::LoadError;
pub use model::{
    Camera, CornerAttribute, Light, LoadReport, Material, MaterialAssignment, Model, Skipped, Surface,
};
