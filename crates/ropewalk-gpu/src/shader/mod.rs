//! Shaders: WGSL files, and what puts them together.
//!
//! | folder | holds |
//! |---|---|
//! | `shaders/shared` | rays, boxes, triangles, hits, counters: the twins of the core crate's modules |
//! | `shaders/walk` | one walk a file, the twins of `ropewalk::bvh::walk` |
//! | `shaders/kernel` | entry points |
//!
//! [`ShaderLibrary`] holds the files and assembles them; [`Kernel`] names each shipped combination. A caller's
//! own shader can be [added](ShaderLibrary::with) and import the shared parts and the walks.

mod assembly;
mod kernel;
mod library;

pub use assembly::{AssemblyError, Definitions};
pub use kernel::{BATCH_GROUP, Kernel, STATUS_WRITTEN, STRUCTURE_GROUP};
pub use library::ShaderLibrary;
