//! Ray queries on the CPU: acceleration structures, ways to walk them, and one contract for what a hit is.
//!
//! ```
//! use ropewalk::{BuildOptions, Mesh, Ray, Scene, glam::Vec3};
//! let mesh = Mesh::new(vec![Vec3::ZERO, Vec3::X, Vec3::Y], vec![[0, 1, 2]]);
//! let bvh = Scene::from_mesh(mesh).build(&BuildOptions::default())?;
//! let hit = bvh.closest(&Ray::new(Vec3::new(0.2, 0.3, 5.0), -Vec3::Z));
//! assert_eq!((hit.t, hit.primitive_index), (5.0, 0));
//! # Ok::<(), ropewalk::BuildError>(())
//! ```
//!
//! The vocabulary stands in small modules: [`Ray`], [`Hit`], [`Aabb`], [`Sphere`], [`Triangle`],
//! [`Transform`], [`Mesh`], [`Scene`]. Each structure has a folder with its nodes, builders and walks: [`bvh`],
//! [`bvh8`], [`wide_bvh`], [`traversal_list`], [`kd_tree`], [`two_level`].
//! [`catalogue`] is the one table of what can be traced.
//!
//! **Features.** `parallel` (default) builds and traces batches on rayon, in whichever pool the caller
//! installs. Without it the crate starts no thread.
//!
//! **Unsafe code** stands in [`bvh8`], for vector instructions and nodes that are read by checked words, and where the system is told
//! of large pieces of memory. Each module says why
//! it is sound.

#![deny(unsafe_code)]

pub mod aabb;
pub mod batch;
pub mod bvh;
pub mod bvh8;
pub mod catalogue;
mod clock;
mod error;
mod flatten;
mod hit;
pub mod kd_tree;
mod memory;
mod mesh;
mod monitor;
mod parallel;
pub mod point;
mod probe;
mod processor;
mod progress;
mod query;
pub mod ray;
mod refit;
mod scene;
mod sphere;
mod status;
mod transform;
pub mod traversal_list;
pub mod triangle;
pub mod two_level;
pub mod wide_bvh;

pub use aabb::Aabb;
pub use batch::{Answer, HitLists, Keep, TraceOptions, Traced};
pub use bvh::{BuildOptions, BuildReport, Builder, Bvh};
pub use bvh8::{Bvh8, Bvh8Options};
pub use catalogue::{DeviceKind, Structure, StructureKind, StructureSpec, Walk};
pub use error::{
    BuildError, CatalogueError, SceneError, TraceError, TransformError, UpdateError, ValidationError,
};
pub use flatten::FlatScene;
pub use glam;
pub use hit::Hit;
pub use kd_tree::{KdOptions, KdTree};
pub use mesh::Mesh;
pub use monitor::{Monitor, NoMonitor};
pub use point::{
    ClosestPoint, Feature, NearestLists, PointAnswers, PointQuery, PointSearch, SignedDistance, SurfaceError,
    SurfacePoint,
};
pub use probe::{CounterTotals, Counters, NoProbe, Probe};
pub use query::Query;
pub use ray::{LARGEST_DIRECTION, PreparedRay, Ray, SMALLEST_DIRECTION};
pub use refit::RefitReport;
pub use scene::{InputReport, Instance, Object, Scene};
pub use sphere::Sphere;
pub use status::Status;
pub use transform::Transform;
pub use traversal_list::{ListOptions, TraversalList};
pub use triangle::{FlatTriangle, Triangle};
pub use two_level::{ChangeError, TwoLevel, TwoLevelOptions};
pub use wide_bvh::{WideBvh, WideOptions};
