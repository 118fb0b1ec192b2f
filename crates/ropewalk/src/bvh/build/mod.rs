//! Builders of binary BVHs, and what they share: flattening, the clock, emitting triangles in leaf order.

mod binned_sah;
mod leaf_left;
pub(super) mod options;
mod reference;
mod subtree;

use super::{BuildOptions, BuildReport, Bvh, LeafOrder};
use crate::parallel::fill_chunks;
use crate::{BuildError, FlatTriangle, Monitor, Scene};
use bytemuck::Zeroable;
use reference::Reference;
use std::time::Duration;

/// Flattens the scene, builds the tree, and puts the triangles into leaf order.
pub(super) fn build(scene: &Scene, options: &BuildOptions, monitor: &dyn Monitor) -> Result<Bvh, BuildError> {
    options.check()?;
    let clock = Clock::start();
    let flat = scene.flatten()?;
    let flatten_time = clock.elapsed();
    let clock = Clock::start();
    let mut references = reference::of_triangles(&flat.triangles);
    let mut nodes = binned_sah::build(&mut references, options, monitor)?;
    if options.leaf_order == LeafOrder::Left {
        nodes = leaf_left::reorder(&nodes);
    }
    let triangles = in_leaf_order(&flat.triangles, &references);
    let build_time = clock.elapsed();
    let report = BuildReport {
        input: flat.report,
        flatten_time,
        build_time,
        ..BuildReport::measure(&nodes, &triangles)
    };
    Ok(Bvh { nodes, triangles, report })
}

fn in_leaf_order(triangles: &[FlatTriangle], references: &[Reference]) -> Vec<FlatTriangle> {
    let mut ordered = vec![FlatTriangle::zeroed(); references.len()];
    fill_chunks(&mut ordered, 1 << 14, |first, part| {
        for (place, reference) in part.iter_mut().zip(&references[first..]) {
            *place = triangles[reference.index()];
        }
    });
    ordered
}

/// A clock that stands still where there is none.
struct Clock {
    #[cfg(not(target_family = "wasm"))]
    start: std::time::Instant,
}

impl Clock {
    fn start() -> Self {
        Self {
            #[cfg(not(target_family = "wasm"))]
            start: std::time::Instant::now(),
        }
    }

    fn elapsed(&self) -> Duration {
        #[cfg(not(target_family = "wasm"))]
        return self.start.elapsed();
        #[cfg(target_family = "wasm")]
        Duration::ZERO
    }
}
