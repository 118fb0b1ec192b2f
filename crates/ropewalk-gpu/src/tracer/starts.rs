//! Rays that begin with heads: which element of which list it is, worked out on the host.
//!
//! **Invariants.** A head that is sent lies within the list that its ray goes through. The list depends on signs and on
//! which magnitude is the largest, which no device rounds, so the kernel chooses the same one.

use super::records::Records;
use super::{GpuStructure, GpuTraced, Tracer};
use crate::GpuError;
use ropewalk::traversal_list::{Directions, NO_HEAD, Starts, list_of};
use ropewalk::{
    CatalogueError, DeviceKind, PreparedRay, Query, Ray, TraceOptions, TraversalList, Walk, catalogue,
};

/// Where the lists of an uploaded structure begin.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct Lists {
    pub(super) directions: Directions,
    pub(super) layers: usize,
    /// [`TraversalList::starts`].
    pub(super) starts: Vec<u32>,
}

impl Lists {
    pub(super) fn of(lists: &TraversalList) -> Self {
        Self {
            directions: lists.options().directions,
            layers: lists.layers(),
            starts: lists.starts().to_vec(),
        }
    }

    /// How many elements a list has, counted over all layers.
    fn len(&self, list: usize) -> usize {
        match (self.starts.get(list), self.starts.get(list + 1)) {
            (Some(&from), Some(&to)) => (to - from) as usize,
            _ => 0,
        }
    }

    /// The heads of each ray in its own lists, one a layer.
    fn heads(&self, rays: &[Ray], starts: Starts<'_>) -> Result<Vec<u32>, GpuError> {
        let (width, lists) = (starts.table.width(), self.directions.lists() * self.layers);
        if width != lists {
            return Err(wrong(format!(
                "the heads are of {width} lists, and there are {lists}: they are of another structure"
            )));
        }
        if starts.rows.len() != rays.len() {
            let rows = starts.rows.len();
            return Err(wrong(format!("there are {} rays and rows of heads for {rows}", rays.len())));
        }
        let mut heads = Vec::with_capacity(rays.len() * self.layers);
        for (index, (ray, &row)) in rays.iter().zip(starts.rows).enumerate() {
            let row = match starts.of(index) {
                None if row == Starts::FROM_THE_FIRST => None,
                Some(row) => Some(row),
                None => {
                    let rows = starts.table.rows();
                    return Err(wrong(format!(
                        "a ray begins with the heads of row {row}, and there are {rows} rows"
                    )));
                }
            };
            // A ray that is not valid goes nowhere.
            let (Some(row), Some(ray)) = (row, PreparedRay::new(ray)) else {
                heads.extend(std::iter::repeat_n(0, self.layers));
                continue;
            };
            let list = list_of(self.directions, &ray);
            for own in (list..lists).step_by(self.directions.lists()) {
                let head = row.get(own).copied().unwrap_or(NO_HEAD);
                if head != NO_HEAD && head as usize >= self.len(own) {
                    return Err(wrong(format!(
                        "the head {head} lies beyond its list of {} elements: it is of another structure",
                        self.len(own)
                    )));
                }
                heads.push(head);
            }
        }
        Ok(heads)
    }
}

fn wrong(text: String) -> GpuError {
    GpuError::Catalogue(CatalogueError(text))
}

impl Tracer {
    /// Traces a batch by the walk of lists, each ray from its heads on: the twin of [`TraversalList::trace_from`].
    ///
    /// # Errors
    /// When the structure is no lists, the heads are of others, there is not a row for each ray, or the device fails.
    pub fn trace_from(
        &self,
        structure: &GpuStructure,
        query: Query,
        rays: &[Ray],
        starts: Starts<'_>,
        options: TraceOptions,
    ) -> Result<GpuTraced, GpuError> {
        let kind = structure.shape().tree.kind();
        catalogue::check(kind, Walk::List, query, DeviceKind::Gpu)?;
        let Some(lists) = structure.lists() else {
            return Err(wrong(format!("the structure '{kind}' has no heads to begin with")));
        };
        self.with_own(structure, || {
            let heads = lists.heads(rays, starts)?;
            let records = Records::from_heads(rays, lists.layers, &heads);
            self.trace_batch(structure, Walk::List, query, records, options)
        })
    }
}
