//! Cameras to pixels on the CPU and the GPU, with ropewalk.
//!
//! A [`Stage`] is a model made ready for its picture, a [`Renderer`] traces it and shades it, and a [`Picture`]
//! is what comes out, to be saved as PNG or EXR.
//!
//! ```
//! use ropewalk::{Mesh, NoMonitor, Scene, StructureSpec, glam::Vec3};
//! use ropewalk_render::{Ground, RenderSettings, Renderer, Stage, StageOptions};
//! use ropewalk_scene::Model;
//! use std::ops::ControlFlow;
//!
//! let mesh = Mesh::new(vec![Vec3::ZERO, Vec3::X, Vec3::Y], vec![[0, 1, 2]]);
//! let model = Model { scene: Scene::from_mesh(mesh), ..Model::default() };
//! let stage = Stage::new(model, &StageOptions::default());
//! let structure = StructureSpec::default().build(stage.scene(), &NoMonitor)?;
//! let settings = RenderSettings { width: 32, height: 18, ..RenderSettings::default() };
//! let picture = Renderer::new(&stage, &structure).render(&settings, &|_, _| ControlFlow::Continue(()))?;
//! assert_eq!(picture.to_srgb8().len(), 32 * 18 * 3);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! **One picture on every device.** Rays are traced in batches on whatever implements [`Trace`]; everything
//! else, camera rays, shading, film, is one piece of code on the CPU. Where a device gives the CPU's hits to the
//! bit, it gives the CPU's picture to the bit. Trees of rays are followed on a graphics adapter by one kernel, the twin of
//! the code here: the same operations on the same words, so that an adapter that rounds as IEEE 754 says draws the same bits.

#![forbid(unsafe_code)]

mod begin;
mod brdf;
mod bsdf;
pub mod camera;
mod error;
mod expose;
mod film;
mod filtered;
mod follow;
mod frames;
mod gpu;
mod ground;
pub mod image_file;
mod integrator;
mod kept;
mod light;
mod lights;
mod looks;
mod metadata;
mod offset;
mod path;
mod picture;
mod primary;
mod ramp;
mod raster;
mod ray_tree;
mod renderer;
mod sampling;
mod settings;
mod shade;
mod sky;
mod smooth;
mod stage;
mod statistics;
mod surface;
mod tone;
mod trace;
mod tracing;
mod view;

pub use begin::Begin;
pub use camera::CameraChoice;
pub use error::{ImageError, RenderError};
pub use film::{Film, Layers};
pub use frames::{
    Frame, FrameJob, FrameStatistics, FramesError, render_frames, resident_bytes, structure_for_frames,
};
pub use ground::Ground;
pub use integrator::{Integrator, MOST_BOUNCES, Primary, TreeOrder, TreeSettings};
pub use kept::Kept;
pub use lights::LightChoice;
pub use metadata::Metadata;
pub use path::Noise;
pub use picture::{Legend, Picture};
pub use raster::{PrimaryComparison, PrimaryTime};
pub use renderer::{Renderer, Show};
pub use settings::{LARGEST_PIXEL_COUNT, LARGEST_SIDE, MOST_SAMPLES, RenderSettings};
pub use stage::{Stage, StageOptions};
pub use statistics::{Incomplete, Statistics};
pub use tone::{decode_srgb, encode_srgb8};
pub use trace::Trace;
pub use view::View;
