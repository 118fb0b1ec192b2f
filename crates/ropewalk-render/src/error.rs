//! Why there is no picture.

use std::error::Error;
use std::path::PathBuf;
use thiserror::Error;

/// Why nothing was rendered.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum RenderError {
    /// A size that is no size, or too large.
    #[error(
        "a picture of {width}x{height} cannot be made: each side must be 1 to {} and both together at most {} pixels",
        crate::LARGEST_SIDE,
        crate::LARGEST_PIXEL_COUNT
    )]
    Size {
        /// The width that was asked for.
        width: u32,
        /// The height that was asked for.
        height: u32,
    },
    /// A number of samples that cannot be laid out.
    #[error(
        "{samples} samples a pixel cannot be laid out evenly: take a square number, 1, 4, 9, 16, ... up to {}",
        crate::MOST_SAMPLES
    )]
    Samples {
        /// The number that was asked for.
        samples: u32,
    },
    /// A setting that is no usable number.
    #[error("{setting} is {value}; {wanted}")]
    Setting {
        /// The setting.
        setting: &'static str,
        /// What was given.
        value: String,
        /// What can be given.
        wanted: &'static str,
    },
    /// The camera cannot be had.
    #[error("camera: {0}")]
    Camera(String),
    /// A word of the command line that means nothing here.
    #[error("{0}")]
    Word(String),
    /// There is not enough memory for the picture.
    #[error(
        "a picture of {width}x{height} needs {bytes} bytes of memory, which are not to be had; render it smaller"
    )]
    Memory {
        /// The width that was asked for.
        width: u32,
        /// The height that was asked for.
        height: u32,
        /// The bytes that it needs.
        bytes: u64,
    },
    /// There are more texels than one atlas can hold.
    #[error(
        "the textures have {texels} texels, and there is no room for an atlas of them, which may have {most} at most; \
         make them smaller"
    )]
    Textures {
        /// The texels of all textures.
        texels: u64,
        /// How many an atlas can have.
        most: u64,
    },
    /// There are more triangles than the tables for shading can hold.
    #[error(
        "the tables for shading need {words} words of 4 bytes, which are not to be had; {most} is the most; leave \
         objects out, or render with the studio"
    )]
    Looks {
        /// The words that the tables need.
        words: u64,
        /// How many they can have.
        most: u64,
    },
    /// Primary hits cannot be drawn.
    #[error("rasterising failed: {0}")]
    Raster(String),
    /// The device did not answer.
    #[error("tracing failed: {0}")]
    Trace(#[source] Box<dyn Error + Send + Sync>),
}

/// Why a picture was not written. Nothing half-written is left under the file's name.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum ImageError {
    /// The name says no format that is known.
    #[error("{}: unknown image format; the name must end in .png (8-bit sRGB) or .exr (32-bit linear)", path.display())]
    UnknownExtension {
        /// The file.
        path: PathBuf,
    },
    /// The name is that of a folder.
    #[error("{}: is a folder; name a file in it", path.display())]
    IsFolder {
        /// The folder.
        path: PathBuf,
    },
    /// The folder is not there.
    #[error("{}: the folder {} does not exist", path.display(), folder.display())]
    NoFolder {
        /// The file.
        path: PathBuf,
        /// Its folder.
        folder: PathBuf,
    },
    /// The file system said no.
    #[error("{}: {source}", path.display())]
    Io {
        /// The file.
        path: PathBuf,
        /// What the system said.
        source: std::io::Error,
    },
    /// The encoder said no.
    #[error("{}: {what}", path.display())]
    Encode {
        /// The file.
        path: PathBuf,
        /// What it said.
        what: String,
    },
}
