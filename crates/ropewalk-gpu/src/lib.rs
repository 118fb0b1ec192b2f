//! The traversals of ropewalk in WGSL, run through wgpu on any graphics adapter, with ray tracing cores or without.
//!
//! ```no_run
//! use ropewalk::{Mesh, Query, Ray, Scene, Structure, TraceOptions, Walk, glam::Vec3};
//! use ropewalk_gpu::{Device, DeviceChoice};
//!
//! let opened = Device::open(&DeviceChoice::Auto)?;
//! let mesh = Mesh::new(vec![Vec3::ZERO, Vec3::X, Vec3::Y], vec![[0, 1, 2]]);
//! let structure = Structure::Bvh(Scene::from_mesh(mesh).build(&Default::default())?);
//! let traceable = opened.device.prepare(structure)?;
//! let rays = [Ray::new(Vec3::new(0.2, 0.3, 5.0), -Vec3::Z)];
//! let traced = traceable.trace(Walk::default(), Query::Closest, &rays, TraceOptions::default())?;
//! assert_eq!(traced.answer.rays_that_hit(), 1);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! | module | concept |
//! |---|---|
//! | `adapter` | which adapters there are, and which one is meant |
//! | `gpu` | a device and its queue, ours or the caller's |
//! | [`shader`] | WGSL files, put together by imports, conditions and text constants |
//! | `tracer` | a structure in buffers, batches in tiles, answers read back |
//! | [`Program`] | kernels of a caller's own, which trace rays as they go |
//! | `device` | one way to trace, and to ask about points, on either device |
//!
//! **Agreement with the CPU.** Every kernel is the twin of a walk in [`ropewalk::bvh::walk`],
//! [`ropewalk::wide_bvh::walk`], [`ropewalk::kd_tree::walk`], [`ropewalk::traversal_list`] or [`ropewalk::two_level`]: same
//! operations, same order. Where a device rounds as IEEE 754 says (lavapipe does), hits and counters are the same to the bit.
//! Where it fuses multiplications with additions or divides by an approximate reciprocal, indices agree and `t`
//! lies within 1e-5 relative, ties aside.
//!
//! **Drivers that end loops.** Mesa's lavapipe allows 65,535 iterations of all loops of a shader together, and then ends
//! them. A ray that goes so far, or shares a vector with one that does, has [`ropewalk::Status::STEP_BUDGET`].
//!
//! **Features.** Vulkan is always in. `metal`, `dx12` and `gles` add the interfaces of their platforms.

#![deny(unsafe_code)]

mod adapter;
mod device;
mod error;
mod gpu;
mod scope;
pub mod shader;
mod tracer;
mod trusted;

pub use adapter::{AdapterSummary, DeviceChoice, adapters};
pub use device::{Device, Moving, OpenedDevice, Traceable};
pub use error::GpuError;
pub use gpu::Gpu;
pub use tracer::{
    GpuPoints, GpuStructure, GpuTraced, Program, ProgramAnswer, ProgramOptions, StructureVersions, Table,
    Tables, Tracer, TracerOptions, UploadReport,
};
pub use wgpu;
