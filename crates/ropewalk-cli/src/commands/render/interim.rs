//! Saving a picture while it is rendered: now and then the rows that are finished, so that one can look, and a machine that fails
//! takes less with it.
//!
//! A file is replaced as a whole, and what is finished in the end replaces it for good. Failing to save in between is told
//! once and stops nothing.

use super::arguments::Arguments;
use crate::output::note;
use ropewalk_render::image_file::{self, ImageFormat};
use ropewalk_render::{Film, ImageError, Metadata, View};
use std::path::Path;
use std::sync::{Mutex, PoisonError};
use std::time::{Duration, Instant};

/// Saves a film every so many seconds.
pub(super) struct Interim<'a> {
    every: Duration,
    path: &'a Path,
    exposure: f32,
    metadata: Metadata,
    /// When it was saved last; `None` once that has failed.
    last: Mutex<Option<Instant>>,
}

impl<'a> Interim<'a> {
    /// `None` where nobody asked for it.
    pub(super) fn new(arguments: &'a Arguments, metadata: Metadata) -> Option<Self> {
        // Of other views there are no colours before the end.
        let every = arguments.save_every.filter(|_| arguments.view == View::Shaded)?;
        Some(Self {
            every: Duration::from_secs(every.into()),
            path: &arguments.output,
            exposure: arguments.exposure,
            metadata,
            last: Mutex::new(Some(Instant::now())),
        })
    }

    /// Saves the film, if it is time.
    pub(super) fn offer(&self, film: &Film, rows: u32) {
        let mut last = self.last.lock().unwrap_or_else(PoisonError::into_inner);
        let Some(before) = *last else { return };
        if before.elapsed() < self.every || rows == 0 {
            return;
        }
        *last = match self.save(film) {
            Ok(()) => Some(Instant::now()),
            Err(error) => {
                note(&format!("{error}; it is not saved again before it is finished"));
                None
            }
        };
    }

    fn save(&self, film: &Film) -> Result<(), ImageError> {
        match ImageFormat::from_path(self.path)? {
            ImageFormat::Png => {
                let bytes = film.to_srgb8(View::Shaded, self.exposure);
                image_file::write_png_with(self.path, film.width, film.height, &bytes, &self.metadata)
            }
            ImageFormat::Exr => image_file::write_exr_with(self.path, film, &self.metadata),
        }
    }
}
