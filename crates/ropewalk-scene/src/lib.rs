//! Scenes for ropewalk: from files, and procedural ones that need no file.
//!
//! [`load`] reads a file of any known format, gzipped or not, into a [`Model`]; [`builtin`] makes one; [`animation`] says where its
//! parts are at a time.

#![forbid(unsafe_code)]

pub mod animation;
pub mod builtin;
mod error;
pub mod load;
mod material;
mod model;
mod texture;

pub use animation::{Animated, Clip, Motion, Pose, Span};
pub use error::LoadError;
pub use material::Material;
pub use model::{Camera, CornerAttribute, Light, LoadReport, MaterialAssignment, Model, Skipped, Surface};
pub use texture::{Filter, Texture, TextureUse, Wrap};
