//! Words that all items of a program read: materials, textures, settings.

use crate::scope::scoped;
use crate::tracer::structure::{PIECE, room};
use crate::{Gpu, GpuError};

/// Which of a program's two tables.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Table {
    /// `table_a`.
    A,
    /// `table_b`.
    B,
}

/// Two tables of words on a device. They are uploaded once; ranges can be written anew between runs.
#[derive(Debug)]
pub struct Tables {
    gpu: Gpu,
    buffers: [wgpu::Buffer; 2],
    lengths: [usize; 2],
}

impl Tables {
    pub(super) fn new(gpu: &Gpu, a: &[u32], b: &[u32]) -> Result<Self, GpuError> {
        let tables = Self {
            gpu: gpu.clone(),
            buffers: [buffer(gpu, a)?, buffer(gpu, b)?],
            lengths: [a.len(), b.len()],
        };
        tables.write(Table::A, 0, a)?;
        tables.write(Table::B, 0, b)?;
        Ok(tables)
    }

    pub(super) const fn gpu(&self) -> &Gpu {
        &self.gpu
    }

    pub(super) const fn buffers(&self) -> &[wgpu::Buffer; 2] {
        &self.buffers
    }

    /// Words of a table.
    #[must_use]
    pub const fn len(&self, table: Table) -> usize {
        self.lengths[table as usize]
    }

    /// Whether a table has no words.
    #[must_use]
    pub const fn is_empty(&self, table: Table) -> bool {
        self.len(table) == 0
    }

    /// Writes words of a table from one on. Runs that were begun before do not see them.
    ///
    /// # Errors
    /// When the table has not so many words, or the device fails.
    pub fn write(&self, table: Table, first: usize, words: &[u32]) -> Result<(), GpuError> {
        let there = self.len(table);
        let end = first.saturating_add(words.len());
        if end > there {
            return Err(GpuError::OutsideTable { first, end, there });
        }
        let bytes: &[u8] = bytemuck::cast_slice(words);
        let buffer = &self.buffers[table as usize];
        scoped(self.gpu.device(), "a table of a program", bytes.len() as u64, || {
            let mut at = (first * size_of::<u32>()) as u64;
            for piece in bytes.chunks(PIECE) {
                self.gpu.queue().write_buffer(buffer, at, piece);
                at += piece.len() as u64;
                // Sends the piece off, so that its copy can be dropped.
                self.gpu.queue().submit([]);
            }
        })
    }
}

fn buffer(gpu: &Gpu, words: &[u32]) -> Result<wgpu::Buffer, GpuError> {
    let what = "table of a program";
    // No binding may be empty.
    let size = (size_of_val(words) as u64).max(size_of::<u32>() as u64);
    if size > room(gpu) {
        return Err(GpuError::TooLarge {
            what,
            needed: size,
            limit: room(gpu),
            limit_name: "max_storage_buffer_binding_size and max_buffer_size",
            way_out: "make the tables smaller, such as by smaller textures, or run on the CPU",
        });
    }
    scoped(gpu.device(), what, size, || {
        gpu.device().create_buffer(&wgpu::BufferDescriptor {
            label: Some("ropewalk table"),
            size,
            usage: wgpu::BufferUsages::STORAGE | wgpu::BufferUsages::COPY_DST,
            mapped_at_creation: false,
        })
    })
}
