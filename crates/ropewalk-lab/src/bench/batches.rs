//! The rays that are measured, and the answers that every lane must give.

use super::{BenchError, BenchSettings, ClassRecord};
use ropewalk::{Answer, FlatScene, Hit, Query, Ray, Structure, TraceError, TraceOptions, Traced, Walk};
use ropewalk_gpu::GpuError;
use ropewalk_testkit::rays::{RayClass, RayMaker};
use std::cell::RefCell;

/// Rays of a class, and the reference's answer.
#[derive(Clone, Debug)]
pub(super) struct Batch {
    pub(super) class: RayClass,
    pub(super) query: Query,
    pub(super) rays: Vec<Ray>,
    pub(super) expected: Traced,
}

impl Batch {
    pub(super) fn record(&self) -> ClassRecord {
        ClassRecord {
            class: self.class.to_string(),
            query: self.query.to_string(),
            rays: self.rays.len(),
            rays_that_hit: self.expected.answer.rays_that_hit(),
        }
    }
}

/// Makes a batch of every class that has rays in this scene.
pub(super) fn make(
    flat: &FlatScene,
    structure: &Structure,
    settings: &BenchSettings,
) -> Result<Vec<Batch>, BenchError> {
    let trace = |query, rays: &[Ray]| structure.trace(Walk::default(), query, rays, TraceOptions::default());
    // The maker's question has no way to fail, the catalogue's answer has.
    let failure: RefCell<Option<TraceError>> = RefCell::default();
    let closest = |rays: &[Ray]| match trace(Query::Closest, rays).map(|traced| traced.answer) {
        Ok(Answer::Closest(hits)) => hits,
        Ok(_) => vec![Hit::MISS; rays.len()],
        Err(error) => {
            failure.replace(Some(error));
            vec![Hit::MISS; rays.len()]
        }
    };
    let outside = RayMaker::new(flat, settings.seed);
    let maker = settings.view.map_or_else(|| outside.clone(), |view| outside.clone().with_view(view));
    let mut batches = Vec::new();
    for class in RayClass::MEASURED {
        let rays = maker.make(class, settings.rays, &closest);
        if let Some(error) = failure.take() {
            return Err(GpuError::from(error).into());
        }
        if !rays.is_empty() {
            let query = class.query();
            let expected = trace(query, &rays).map_err(GpuError::from)?;
            batches.push(Batch { class, query, rays, expected });
        }
    }
    Ok(batches)
}
