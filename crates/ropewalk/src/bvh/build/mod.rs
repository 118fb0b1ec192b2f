//! Builders of binary BVHs, the optimisation that may follow each, and what they share: flattening, the clock, emitting triangles in leaf order.

pub(crate) mod binned_sah;
mod leaf_left;
mod limits;
pub(super) mod options;
pub(crate) mod part;
pub(crate) mod reference;
pub(crate) mod reinsertion;
mod sbvh;
pub(crate) mod subtree;
mod sweep;
mod sweep_sah;

use super::{BuildOptions, BuildReport, Builder, Bvh, LeafOrder, Node};
use crate::clock::Clock;
use crate::parallel::fill_chunks;
use crate::{BuildError, FlatTriangle, Monitor, Scene};
use bytemuck::Zeroable;
use reference::Reference;
use std::sync::OnceLock;

/// Flattens the scene, builds the tree, and puts the triangles into leaf order.
pub(super) fn build(scene: &Scene, options: &BuildOptions, monitor: &dyn Monitor) -> Result<Bvh, BuildError> {
    options.check()?;
    let clock = Clock::start();
    let flat = scene.flatten()?;
    let flatten_time = clock.elapsed();
    let clock = Clock::start();
    let (nodes, references) = build_over(&flat.triangles, options, monitor)?;
    let triangles = in_leaf_order(&flat.triangles, &references);
    let build_time = clock.elapsed();
    let report = BuildReport {
        input: flat.report,
        flatten_time,
        build_time,
        ..BuildReport::measure(&nodes, &triangles, flat.triangles.len())
    };
    Ok(Bvh { nodes, triangles, report, skips: OnceLock::new() })
}

/// Builds the tree over triangles: its nodes, and the index of the triangle in each place of the leaves.
pub(crate) fn tree_over(
    triangles: &[FlatTriangle],
    options: &BuildOptions,
    monitor: &dyn Monitor,
) -> Result<(Vec<Node>, Vec<u32>), BuildError> {
    options.check()?;
    let (nodes, references) = build_over(triangles, options, monitor)?;
    Ok((nodes, references.iter().map(|reference| reference.index() as u32).collect()))
}

fn build_over(
    triangles: &[FlatTriangle],
    options: &BuildOptions,
    monitor: &dyn Monitor,
) -> Result<(Vec<Node>, Vec<Reference>), BuildError> {
    let mut references = reference::of_triangles(triangles);
    let mut nodes = match options.builder {
        Builder::BinnedSah => binned_sah::build(&mut references, options, monitor)?,
        Builder::SweepSah => sweep_sah::build(&mut references, options, monitor)?,
        Builder::Sbvh => sbvh::build(&mut references, options, monitor)?,
    };
    if options.reinsertion > 0 {
        nodes = reinsertion::optimise(&nodes, &mut references, options, monitor)?;
    }
    if options.leaf_order == LeafOrder::Left {
        nodes = leaf_left::reorder(&nodes);
    }
    Ok((nodes, references))
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
