//! Shaders: WGSL files, and what puts them together.
//!
//! | folder | holds |
//! |---|---|
//! | `shaders/shared` | rays, boxes, triangles, hits, counters: the twins of the core crate's modules |
//! | `shaders/walk` | one walk a file, the twins of `ropewalk::bvh::walk` and `ropewalk::wide_bvh::walk` |
//! | `shaders/kernel` | entry points, and what they write |
//!
//! [`ShaderLibrary`] holds the files and assembles them; [`Kernel`] and [`PointKernel`] name each shipped combination. A caller's
//! own shader can be [added](ShaderLibrary::with) and import the shared parts and the walks.

mod assembly;
mod every;
mod kernel;
mod library;
mod point_kernel;

pub use assembly::{AssemblyError, Definitions};
pub use kernel::{BATCH_GROUP, Kernel, STATUS_WRITTEN, STRUCTURE_GROUP, Tree};
pub use library::ShaderLibrary;
pub(crate) use point_kernel::AnyKernel;
pub use point_kernel::PointKernel;
