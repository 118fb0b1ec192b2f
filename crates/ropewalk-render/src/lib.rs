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
//! bit, it gives the CPU's picture to the bit.

#![forbid(unsafe_code)]

mod begin;
mod brdf;
pub mod camera;
mod error;
mod film;
mod ground;
pub mod image_file;
mod lights;
mod offset;
mod picture;
mod ramp;
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
mod view;

pub use begin::Begin;
pub use camera::CameraChoice;
pub use error::{ImageError, RenderError};
pub use film::Film;
pub use ground::Ground;
pub use lights::LightChoice;
pub use picture::{Legend, Picture};
pub use renderer::Renderer;
pub use settings::{LARGEST_PIXEL_COUNT, LARGEST_SIDE, MOST_SAMPLES, RenderSettings};
pub use stage::{Stage, StageOptions};
pub use statistics::{Incomplete, Statistics};
pub use tone::{decode_srgb, encode_srgb8};
pub use trace::Trace;
pub use view::View;
