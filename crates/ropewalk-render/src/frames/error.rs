//! Why there are no further frames.

use crate::error::RenderError;
use ropewalk::two_level::ChangeError;
use ropewalk::{BuildError, SceneError};
use ropewalk_gpu::GpuError;
use thiserror::Error;

/// Why there are no further frames.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum FramesError {
    /// A frame was not rendered.
    #[error(transparent)]
    Render(#[from] RenderError),
    /// The structure was not built.
    #[error(transparent)]
    Build(#[from] BuildError),
    /// The structure could not follow.
    #[error(transparent)]
    Change(#[from] ChangeError),
    /// The scene is out of range.
    #[error(transparent)]
    Scene(#[from] SceneError),
    /// The device failed.
    #[error(transparent)]
    Gpu(#[from] GpuError),
    /// Frames of a scene that stands still.
    #[error("the scene stands still: it has no frames but the one that it is rendered as without")]
    Still,
}
