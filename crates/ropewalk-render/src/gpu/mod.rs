//! The tree of rays as one kernel on a graphics device: Reichl et al. 2010, listing 1.
//!
//! The kernel is a [`Program`] of ropewalk-gpu: an item is a sample, a turn takes one ray from the sample's stack, traces it,
//! adds its light and pushes the rays that follow. Rays of all kinds take this one path, so the threads of a group trace and
//! shade together whatever their rays are for. The stacks lie in the program's scratch, the looks in its tables.
//!
//! | file of the crate's `shaders` | is the twin of |
//! |---|---|
//! | `looks_words`, `looks_texture`, `looks_shaded`, `looks_place`, `looks_panes` | `looks` |
//! | `bsdf_arithmetic`, `bsdf_fresnel`, `bsdf`, `bsdf_shading` | `bsdf` |
//! | `sampling`, `light_source`, `light_environment` | `sampling.rs`, `light`, `sky.rs` |
//! | `ray_tree_request`, `ray_tree_ray`, `ray_tree_node`, `ray_tree` | `ray_tree`: its words, its stack, its nodes, its loop |
//!
//! **Invariants.** The same operations in the same order as on the CPU, so that a device that rounds as IEEE 754 says gives
//! the same bits; the tests compare them on such a device, part by part and as a whole. What is cut off is counted as there.
//!
//! **Cost.** Twelve words a ray that may wait, for each sample of a tile; the looks once a picture, and what has changed of them
//! once a frame. A pipeline is made for each kind of structure and walk, and for each size of the stack.

mod item;
mod source;

#[cfg(test)]
mod tests;

use crate::error::RenderError;
use crate::looks::Looks;
use crate::ray_tree::{Followed, Root, Tally};
use item::{ITEM_WORDS, RESULT_WORDS};
use ropewalk::{TraceOptions, Walk};
use ropewalk_gpu::shader::ShaderLibrary;
use ropewalk_gpu::{GpuError, GpuStructure, Program, ProgramOptions, Table, Tables, Tracer};
use std::ops::Range;

/// Words of a ray on the stack, as `ray_tree_ray` counts them.
const STACK_RAY_WORDS: usize = 12;

/// The most samples that are sent at a time, so that their items and answers take a bounded amount of memory: 70 MB.
const MOST_ITEMS: usize = 1 << 19;

/// The kernel of trees on a device, with the looks it reads.
#[derive(Debug)]
pub(crate) struct TreeKernel {
    program: Program,
    tables: Tables,
    most_waiting: usize,
}

impl TreeKernel {
    /// The kernel for stacks of so many rays, and the looks on the device.
    pub(crate) fn new(tracer: &Tracer, looks: &Looks, most_waiting: usize) -> Result<Self, RenderError> {
        Self::of_library(source::library(), tracer, looks, most_waiting)
    }

    /// The same of other shaders.
    fn of_library(
        library: ShaderLibrary,
        tracer: &Tracer,
        looks: &Looks,
        most_waiting: usize,
    ) -> Result<Self, RenderError> {
        let scratch_words = 1 + STACK_RAY_WORDS * most_waiting.max(1);
        let source = source::of(library, "ray_tree").with_words(ITEM_WORDS, RESULT_WORDS, scratch_words);
        let program = Program::new(tracer, source, ProgramOptions::default()).map_err(failed)?;
        let tables = program.tables(looks.words(), looks.texels()).map_err(failed)?;
        Ok(Self { program, tables, most_waiting })
    }

    /// How many rays its stacks hold.
    pub(crate) const fn most_waiting(&self) -> usize {
        self.most_waiting
    }

    /// Takes over words of the looks that have changed. False when these are looks of another size, which need a kernel anew.
    pub(crate) fn update(&self, looks: &Looks, changed: &[Range<usize>]) -> Result<bool, RenderError> {
        if self.tables.len(Table::A) != looks.words().len()
            || self.tables.len(Table::B) != looks.texels().len()
        {
            return Ok(false);
        }
        for range in changed {
            if let Some(words) = looks.words().get(range.clone()) {
                self.tables.write(Table::A, range.start, words).map_err(failed)?;
            }
        }
        Ok(true)
    }

    /// Follows the trees of samples. With `is_known` their hits are taken as they come with them; else the kernel traces the
    /// first rays too.
    pub(crate) fn follow(
        &self,
        structure: &GpuStructure,
        walk: Walk,
        roots: &[Root],
        is_known: bool,
    ) -> Result<(Vec<Followed>, Tally), RenderError> {
        let mut all = Vec::with_capacity(roots.len());
        let mut tally = Tally::default();
        for part in roots.chunks(MOST_ITEMS) {
            let items: Vec<u32> = part.iter().flat_map(|root| item::words(root, is_known)).collect();
            let answer = self
                .program
                .run(structure, walk, &self.tables, &items, TraceOptions::default())
                .map_err(failed)?;
            for (words, &status) in answer.words.chunks_exact(RESULT_WORDS).zip(&answer.status) {
                all.push(item::read(words, status, &mut tally));
            }
        }
        Ok((all, tally))
    }
}

fn failed(error: GpuError) -> RenderError {
    RenderError::Trace(Box::new(error))
}
