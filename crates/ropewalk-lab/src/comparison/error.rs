//! Why there is no comparison.

use ropewalk::{BuildError, ChangeError};
use ropewalk_gpu::GpuError;
use ropewalk_render::RenderError;
use thiserror::Error;

/// Why there is no comparison.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum ComparisonError {
    /// A tree was not built.
    #[error(transparent)]
    Build(#[from] BuildError),
    /// A device failed.
    #[error(transparent)]
    Gpu(#[from] GpuError),
    /// A picture was not rendered.
    #[error(transparent)]
    Render(#[from] RenderError),
    /// A walk gives wrong answers.
    #[error("{walk} on {device}, {structure}, {asked}: {what}")]
    Disagrees {
        /// The walk.
        walk: String,
        /// The device.
        device: String,
        /// The tree.
        structure: String,
        /// What was asked, and beside what it was held.
        asked: String,
        /// The first difference.
        what: String,
    },
    /// A scene was not changed.
    #[error(transparent)]
    Change(#[from] ChangeError),
    /// A thread was not started.
    #[error("a thread cannot be started: {reason}")]
    Threads {
        /// What the system said.
        reason: String,
    },
    /// The scene has nothing to find.
    #[error("the scene has no triangle that could be found: there is nothing to compare")]
    Empty,
    /// The caller stopped it.
    #[error("stopped before the scene was through")]
    Stopped,
}
