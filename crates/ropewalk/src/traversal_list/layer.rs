//! Layers: the lists of a part of the scene. A ray goes through its list of the first layer, then through that of the
//! second, with what it has found so far (Toczek 2010, section 5). What moves has a layer of its own, so that what does
//! not move need not be built anew.

use super::cull::Hidden;
use super::encode::{Encoded, Encoder};
use super::hierarchy::{BinaryTree, Hierarchy};
use super::packed_box::Grid;
use super::{Element, ListOptions, along, octree};
use crate::bvh::tree_over;
use crate::parallel::map_chunks;
use crate::progress::Progress;
use crate::{Aabb, BuildError, FlatTriangle, Monitor};
use std::ops::Range;

/// The lists of a part of the scene.
#[derive(Clone, Debug)]
pub struct Layer {
    pub(super) grid: Grid,
    pub(super) triangles: Range<u32>,
    /// Inner nodes of its hierarchy.
    pub(super) groups: usize,
    /// Where each group is in each list, the first list's places first. Empty where lists leave something out: then
    /// they cannot be updated.
    pub(super) places: Vec<u32>,
}

impl Layer {
    /// The grid of its boxes.
    #[must_use]
    pub const fn grid(&self) -> &Grid {
        &self.grid
    }

    /// The numbers of its triangles.
    #[must_use]
    pub const fn triangles(&self) -> &Range<u32> {
        &self.triangles
    }

    /// The places of its groups in a list.
    pub(super) fn places(&self, list: usize) -> &[u32] {
        self.places.get(list * self.groups..(list + 1) * self.groups).unwrap_or_default()
    }
}

/// A layer that was just made.
pub(super) struct Made {
    pub(super) layer: Layer,
    pub(super) lists: Vec<Vec<Element>>,
    pub(super) references: usize,
    pub(super) depth: u32,
    /// Of its elements but the first, weighed by half areas.
    pub(super) weighted_cost: f64,
}

/// Makes the layer of some of the triangles.
pub(super) fn make(
    triangles: &[FlatTriangle],
    range: Range<u32>,
    corners: &[[u32; 3]],
    options: &ListOptions,
    monitor: &dyn Monitor,
) -> Result<Made, BuildError> {
    let own = &triangles[range.start as usize..range.end as usize];
    let root = match options.build_options() {
        Some(build) => {
            let (nodes, order) = tree_over(own, &build, monitor)?;
            let has_repeats = order.len() > own.len();
            let reach = options.reach;
            BinaryTree { nodes: &nodes, order: &order, triangles: own, has_repeats, reach }.hierarchy()
        }
        None => {
            let progress = Progress::new(monitor, own.len());
            let root = octree::build(own, options, &progress);
            progress.finish()?;
            root
        }
    };
    let Hierarchy { root, groups, references } = Hierarchy::new(root, range.start);
    let bounds = own.iter().map(|triangle| triangle.triangle().bounds()).fold(Aabb::EMPTY, Aabb::union);
    let grid = Grid::over(&bounds);
    let directions = along(options.directions);
    let encoded: Vec<Encoded> = map_chunks(&directions, 1, |list, directions| {
        let encoder = Encoder {
            triangles,
            corners,
            bounds: options.bounds,
            grid: &grid,
            along: directions[0],
            order: options.order,
            hidden: Hidden::new(options.cull, options.directions, list),
        };
        encoder.encode(root.as_ref(), groups)
    });
    let depth = root.as_ref().map_or(0, super::hierarchy::Child::depth);
    let weighted_cost = root.as_ref().map_or(0.0, super::hierarchy::Child::weighted_cost);
    let mut places = Vec::new();
    let lists = encoded
        .into_iter()
        .map(|list| {
            if !options.is_one_sided() {
                places.extend(list.places);
            }
            list.elements
        })
        .collect();
    let layer = Layer { grid, triangles: range, groups, places };
    Ok(Made { layer, lists, references, depth, weighted_cost })
}
