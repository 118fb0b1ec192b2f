//! Point queries on either device.

use super::{Device, Traceable};
use crate::{GpuError, GpuPoints};
use ropewalk::point::{PointSearch, catalogue};
use ropewalk::{
    Bvh, ClosestPoint, DeviceKind, NearestLists, PointAnswers, PointQuery, Structure, TraceOptions, Walk,
};

impl Traceable {
    /// The closest point of the surface for each query.
    ///
    /// # Errors
    /// When the catalogue has no such row for the device, or the device fails.
    pub fn closest_points(
        &self,
        walk: Walk,
        queries: &[PointQuery],
        options: TraceOptions,
    ) -> Result<PointAnswers<Vec<ClosestPoint>>, GpuError> {
        self.closest_points_timed(walk, queries, options).map(|points| points.answers)
    }

    /// The closest points, and the time that a graphics device itself took, where it can measure it.
    ///
    /// # Errors
    /// When the catalogue has no such row for the device, or the device fails.
    pub fn closest_points_timed(
        &self,
        walk: Walk,
        queries: &[PointQuery],
        options: TraceOptions,
    ) -> Result<GpuPoints<Vec<ClosestPoint>>, GpuError> {
        if let (Device::Gpu(tracer), Some(uploaded)) = (&self.device, &self.uploaded) {
            return tracer.closest_points(uploaded, walk, queries, options);
        }
        let answers = self.bvh(walk, PointSearch::Closest)?.closest_points(walk, queries, options)?;
        Ok(GpuPoints { answers, device_time: None })
    }

    /// The nearest point of each of the `k` nearest triangles for each query.
    ///
    /// # Errors
    /// When the catalogue has no such row for the device, `k` is larger than the device's
    /// [limit](crate::Tracer::MOST_NEAREST), or the device fails.
    pub fn nearest_points(
        &self,
        walk: Walk,
        k: usize,
        queries: &[PointQuery],
        options: TraceOptions,
    ) -> Result<PointAnswers<NearestLists>, GpuError> {
        self.nearest_points_timed(walk, k, queries, options).map(|points| points.answers)
    }

    /// The nearest triangles, and the time that a graphics device itself took, where it can measure it.
    ///
    /// # Errors
    /// When the catalogue has no such row for the device, `k` is larger than the device's
    /// [limit](crate::Tracer::MOST_NEAREST), or the device fails.
    pub fn nearest_points_timed(
        &self,
        walk: Walk,
        k: usize,
        queries: &[PointQuery],
        options: TraceOptions,
    ) -> Result<GpuPoints<NearestLists>, GpuError> {
        if let (Device::Gpu(tracer), Some(uploaded)) = (&self.device, &self.uploaded) {
            return tracer.nearest_points(uploaded, walk, k, queries, options);
        }
        let answers = self.bvh(walk, PointSearch::Nearest)?.nearest_points(walk, k, queries, options)?;
        Ok(GpuPoints { answers, device_time: None })
    }

    /// The tree that the CPU asks.
    fn bvh(&self, walk: Walk, search: PointSearch) -> Result<&Bvh, GpuError> {
        catalogue::check(self.structure.kind(), walk, search, DeviceKind::Cpu)?;
        match &*self.structure {
            Structure::Bvh(bvh) => Ok(bvh),
            other => {
                let text = format!("the structure '{}' answers no '{search}'", other.kind());
                Err(GpuError::Catalogue(ropewalk::CatalogueError(text)))
            }
        }
    }
}
