//! Heads of traversal lists, worked out on a device: the twin of [`ropewalk::traversal_list::heads`].
//!
//! Each invocation searches one list for one row. The half-spaces of polygons are made by the kernel, as Rust makes them;
//! those of cells by the host, in f64, which kernels do not have.

use super::limits::TileLimits;
use super::results::read_word;
use super::starts::Lists;
use super::tile::Job;
use super::{GpuStructure, Run, Tracer};
use crate::GpuError;
use crate::shader::{AnyKernel, HeadKernel, HeadRows};
use ropewalk::glam::Vec3;
use ropewalk::traversal_list::heads::{Plane, facets, own_share};
use ropewalk::traversal_list::{Frustum, HeadTable, Heads, along};
use ropewalk::{CatalogueError, TraversalList};
use std::borrow::Cow;

impl Tracer {
    /// The heads of rays that leave a triangle by its front, a row a triangle, of lists that were uploaded: what
    /// [`TraversalList::polygon_heads`] has when the lists are built with this setting.
    ///
    /// # Errors
    /// When the structure is not those lists, no heads are wanted, or the device fails.
    pub fn polygon_heads(
        &self,
        structure: &GpuStructure,
        lists: &TraversalList,
        heads: Heads,
    ) -> Result<HeadTable, GpuError> {
        let directions = lists.options().directions;
        let normals = |along| match heads {
            Heads::Regular => facets(directions, along),
            _ => vec![],
        };
        if heads == Heads::Disabled {
            return Err(wrong("heads that are disabled are not worked out: ask for simple or regular ones"));
        }
        // They begin at the triangle, wherever that is.
        let of_list = |along| {
            normals(along).into_iter().map(|normal| Plane { normal, offset: 0.0, length: 0.0 }).collect()
        };
        let row = |number: usize| {
            let [a, b, c] = lists.corners()[number];
            vec![number as u32, a, b, c]
        };
        self.heads(structure, lists, HeadRows::Polygons, of_list, lists.corners().len(), row)
    }

    /// The heads of primary rays, a row a cell of the screen, of lists that were uploaded: the twin of
    /// [`TraversalList::frustum_heads`].
    ///
    /// # Errors
    /// When the structure is not those lists, or the device fails.
    pub fn frustum_heads(
        &self,
        structure: &GpuStructure,
        lists: &TraversalList,
        frustum: &Frustum,
    ) -> Result<HeadTable, GpuError> {
        let directions = lists.options().directions;
        let largest = lists.largest_coordinate();
        let reach = largest.max(frustum.eye.abs().max_element());
        let of_list = |along| {
            let plane = |normal| Plane::from_first_of(normal, [frustum.eye; 3], reach);
            facets(directions, along).into_iter().map(plane).collect()
        };
        let cells = frustum.planes(largest);
        let row = |cell: usize| cells[cell].iter().flat_map(half_space).collect();
        self.heads(structure, lists, HeadRows::Cells, of_list, cells.len(), row)
    }

    /// So many rows of heads. `of_list` gives the half-spaces of a list by its direction, `row` the record of a row.
    fn heads(
        &self,
        structure: &GpuStructure,
        lists: &TraversalList,
        rows: HeadRows,
        of_list: impl Fn(Vec3) -> Vec<Plane>,
        row_count: usize,
        row: impl Fn(usize) -> Vec<u32>,
    ) -> Result<HeadTable, GpuError> {
        if structure.lists() != Some(&Lists::of(lists)) {
            return Err(wrong("these are not the lists that were uploaded: upload them first"));
        }
        let header: Vec<u32> = along(lists.options().directions)
            .into_iter()
            .flat_map(|along| of_direction(along, &of_list(along), own_share(lists.options().clearance)))
            .collect();
        let width = lists.starts().len() - 1;
        let heads = self.with_own(structure, || {
            let kernel = HeadKernel { bounds: lists.options().bounds, rows };
            let record_words = HeadKernel::RESULT_WORDS.max(rows.record_words());
            let mut run = Run::new(&self.inner, structure, AnyKernel::Heads(kernel), record_words)?;
            run.uniform.k = width as u32;
            let tile = rows_of(run.limits, header.len(), rows, width);
            let jobs = (0..row_count).step_by(tile).map(|first| {
                let part = first..row_count.min(first + tile);
                let heads = part.len() * width;
                let mut records = header.clone();
                part.for_each(|index| records.extend(row(index)));
                Job {
                    rays: Cow::Owned(records),
                    ray_count: heads as u32,
                    result_words: heads * HeadKernel::RESULT_WORDS,
                }
            });
            let mut heads = Vec::with_capacity(row_count * width);
            run.trace(jobs, |words| {
                for record in words.chunks_exact(HeadKernel::RESULT_WORDS) {
                    match read_word(record) {
                        Some((head, status)) if status.is_complete() => heads.push(head),
                        _ => return Err(GpuError::NoHead { row: heads.len() / width }),
                    }
                }
                Ok(())
            })?;
            Ok(heads)
        })?;
        HeadTable::from_heads(lists, heads)
            .map_err(|error| GpuError::Refused { what: "its own heads", reason: error.to_string() })
    }
}

/// How many rows a tile has: at least one, of which the heads are so few that they fit any device.
fn rows_of(limits: TileLimits, header_words: usize, rows: HeadRows, width: usize) -> usize {
    let words = usize::try_from(limits.result_bytes / 4).unwrap_or(usize::MAX);
    let by_records = words.saturating_sub(header_words) / rows.record_words();
    (limits.rays / width).min(by_records).max(1)
}

/// The words of a list: see [`HeadKernel::LIST_WORDS`]. The last is the share by which a triangle's own half-space is moved.
fn of_direction(along: Vec3, planes: &[Plane], share: f32) -> [u32; HeadKernel::LIST_WORDS] {
    let mut words = [0; HeadKernel::LIST_WORDS];
    let direction = along.to_array().map(f32::to_bits);
    let content =
        [planes.len() as u32].into_iter().chain(direction).chain(planes.iter().flat_map(half_space));
    words.iter_mut().zip(content).for_each(|(word, content)| *word = content);
    words[HeadKernel::LIST_WORDS - 1] = share.to_bits();
    words
}

/// The words of a half-space.
fn half_space(plane: &Plane) -> [u32; HeadKernel::HALF_SPACE_WORDS] {
    let [x, y, z] = plane.normal.to_array();
    [x, y, z, plane.offset, plane.length].map(f32::to_bits)
}

fn wrong(text: &str) -> GpuError {
    GpuError::Catalogue(CatalogueError(text.into()))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_tile_has_as_many_rows_as_its_limits_allow() {
        let limits = |rays, result_bytes| TileLimits { rays, result_bytes };
        assert_eq!(rows_of(limits(1000, 1 << 20), 256, HeadRows::Polygons, 8), 125);
        assert_eq!(rows_of(limits(1000, 2048), 256, HeadRows::Polygons, 8), 64, "4 words a row, 256 for all");
        assert_eq!(rows_of(limits(1, 100), 256, HeadRows::Cells, 16), 1);
    }
}
