//! The rays that rendering asks, beyond the camera's.

use super::{Closest, RayClass, RayMaker};
use glam::DVec3;
use ropewalk::Ray;

/// A point that the camera sees, moved off the surface, and the normal on the camera's side.
#[derive(Clone, Copy, Debug)]
struct SurfacePoint {
    position: DVec3,
    normal: DVec3,
}

impl RayMaker<'_> {
    /// What `count` primary rays see.
    fn seen(&self, count: usize, closest: &Closest<'_>) -> Vec<SurfacePoint> {
        let rays = self.view.rays(count);
        let hits = closest(&rays);
        let off = self.diagonal() * 1e-5;
        rays.iter()
            .zip(&hits)
            .filter_map(|(ray, hit)| {
                let corners = self.triangle_of(hit)?.triangle().vertices.map(glam::Vec3::as_dvec3);
                let normal = (corners[1] - corners[0]).cross(corners[2] - corners[0]).try_normalize()?;
                let dir = ray.dir.as_dvec3();
                let normal = if normal.dot(dir) > 0.0 { -normal } else { normal };
                let position = ray.origin.as_dvec3() + dir * f64::from(hit.t) + normal * off;
                Some(SurfacePoint { position, normal })
            })
            .collect()
    }

    /// `count` rays from what is seen, point after point, again from the first when there are too few.
    fn rays_from_seen(
        &self,
        count: usize,
        closest: &Closest<'_>,
        mut ray: impl FnMut(&SurfacePoint) -> Ray,
    ) -> Vec<Ray> {
        let seen = self.seen(count, closest);
        seen.iter().cycle().take(if seen.is_empty() { 0 } else { count }).map(&mut ray).collect()
    }

    pub(super) fn shadow(&self, count: usize, closest: &Closest<'_>) -> Vec<Ray> {
        self.rays_from_seen(count, closest, |point| {
            super::towards(point.position, self.light).window(0.0, 1.0)
        })
    }

    pub(super) fn ambient_occlusion(&self, count: usize, closest: &Closest<'_>) -> Vec<Ray> {
        let mut random = self.random(RayClass::AmbientOcclusion);
        let reach = (self.diagonal() * 0.1) as f32;
        self.rays_from_seen(count, closest, |point| {
            let dir = by_cosine(point.normal, random.direction());
            Ray::new(point.position.as_vec3(), dir.as_vec3()).window(0.0, reach)
        })
    }

    pub(super) fn bounce(&self, count: usize, closest: &Closest<'_>) -> Vec<Ray> {
        let mut random = self.random(RayClass::DiffuseBounce);
        self.rays_from_seen(count, closest, |point| {
            let dir = by_cosine(point.normal, random.direction());
            Ray::new(point.position.as_vec3(), dir.as_vec3())
        })
    }
}

/// A direction distributed by the cosine to the normal: the normal plus a uniform direction.
fn by_cosine(normal: DVec3, uniform: DVec3) -> DVec3 {
    (normal + uniform * 0.999_999).normalize()
}
