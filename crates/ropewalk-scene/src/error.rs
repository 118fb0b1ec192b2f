//! Why a scene was not loaded.

use std::path::PathBuf;
use thiserror::Error;

/// Why a scene was not loaded: the file, the place in it, and what is wrong there.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum LoadError {
    /// The file system said no.
    #[error("{}: {source}", path.display())]
    Io {
        /// The file.
        path: PathBuf,
        /// What the system said.
        source: std::io::Error,
    },
    /// The content is of no format that is known.
    #[error("{}: {what}", path.display())]
    UnknownFormat {
        /// The file.
        path: PathBuf,
        /// What was looked for.
        what: String,
    },
    /// The content breaks the rules of its format.
    #[error("{}: {place}: {what}", path.display())]
    Malformed {
        /// The file.
        path: PathBuf,
        /// Where, such as `line 17` or `byte 1024`.
        place: String,
        /// What is wrong.
        what: String,
    },
    /// The scene has no clip of that name.
    #[error("there is no clip '{name}': {known}")]
    NoSuchClip {
        /// What was asked for.
        name: String,
        /// The clips that there are.
        known: String,
    },
    /// There is no built-in scene of that name.
    #[error("there is no built-in scene '{name}'; there is {known}")]
    NoSuchBuiltin {
        /// What was asked for.
        name: String,
        /// The names that there are.
        known: String,
    },
}
