//! Shaders: WGSL files, and what puts them together.
//!
//! | folder | holds |
//! |---|---|
//! | `shaders/shared` | rays, boxes, triangles, hits, counters: the twins of the core crate's modules |
//! | `shaders/walk` | one walk a file, the twins of the walks of `ropewalk::bvh`, `ropewalk::wide_bvh`, `ropewalk::traversal_list`, `ropewalk::kd_tree` and `ropewalk::two_level` |
//! | `shaders/kernel` | entry points, and what they write |
//!
//! [`ShaderLibrary`] holds the files and assembles them; [`Kernel`], [`PointKernel`] and [`HeadKernel`] name each shipped combination. A caller's
//! own shader can be [added](ShaderLibrary::with) and import the shared parts and the walks; a [`ProgramSource`] runs it.

mod assembly;
mod constants;
mod every;
mod head_kernel;
pub(crate) mod kd_layout;
mod kernel;
pub(crate) mod level_layout;
mod library;
pub(crate) mod list_layout;
mod point_kernel;
mod program;
mod tree;

pub use assembly::{AssemblyError, Definitions};
pub use head_kernel::{HeadKernel, HeadRows};
pub use kernel::{BATCH_GROUP, Kernel, STATUS_WRITTEN, STRUCTURE_GROUP};
pub use library::ShaderLibrary;
pub(crate) use point_kernel::AnyKernel;
pub use point_kernel::PointKernel;
pub use program::{PROGRAM_GROUP, ProgramSource, STATUS_UNFINISHED};
pub use tree::{LevelBottoms, Tree};
