//! What stays from one picture of a stage to the next: the tables for shading, and the kernel with its copy of them.

use crate::error::RenderError;
use crate::gpu::TreeKernel;
use crate::looks::Looks;
use crate::stage::Stage;
use std::fmt;
use std::ops::Range;
use std::sync::{Mutex, PoisonError};

/// What stays from one picture to the next, for pictures of the same stage in several poses.
///
/// Only what has changed is written anew, and sent to a device: instances, vertices and normals, lights. Give it to
/// [`Renderer::keeping`](crate::Renderer::keeping); pictures are the same without it. A stage of other counts of anything is
/// noticed, and starts anew; other materials or textures of the same counts are not: take another `Kept` for another scene.
#[derive(Default)]
pub struct Kept(Mutex<Option<Tables>>);

impl fmt::Debug for Kept {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        formatter.debug_struct("Kept").finish_non_exhaustive()
    }
}

impl Kept {
    pub(crate) fn take(&self) -> Option<Tables> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner).take()
    }

    pub(crate) fn put(&self, tables: Tables) {
        *self.0.lock().unwrap_or_else(PoisonError::into_inner) = Some(tables);
    }
}

/// The tables for shading, and the kernel that has a copy of them.
#[derive(Debug)]
pub(crate) struct Tables {
    pub(crate) looks: Looks,
    pub(crate) kernel: Option<TreeKernel>,
}

impl Tables {
    /// The tables of a stage, made from those of another pose where there are any.
    pub(crate) fn new(
        stage: &Stage,
        light: &[u32],
        request: &[u32],
        before: Option<Self>,
    ) -> Result<Self, RenderError> {
        if let Some(mut before) = before
            && let Some(changed) = before.update(stage, light, request)
        {
            if let Some(kernel) = &before.kernel
                && !kernel.update(&before.looks, &changed)?
            {
                before.kernel = None;
            }
            return Ok(before);
        }
        Ok(Self { looks: Looks::new(stage, light, request)?, kernel: None })
    }

    /// The words that have changed; `None` when these are the tables of another stage.
    fn update(&mut self, stage: &Stage, light: &[u32], request: &[u32]) -> Option<Vec<Range<usize>>> {
        let mut changed = self.looks.update(stage)?;
        changed.push(self.looks.set_light(light)?);
        changed.push(self.looks.set_request(request)?);
        Some(changed)
    }
}
