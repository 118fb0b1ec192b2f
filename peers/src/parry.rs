//! parry3d: a `TriMesh` with its binary tree of node pairs.

use crate::flush::Flushed;
use parry3d::math::Vector;
use parry3d::query::{Ray as PeerRay, RayCast};
use parry3d::shape::{CompositeShapeRef, TriMesh};
use ropewalk::{Hit, Ray};
use ropewalk_lab::arena::{Engine, EngineError, Grade, Mode, RaySet, Shape, Tracer};
use std::ops::Range;

pub(crate) fn engines() -> Vec<Box<dyn Engine>> {
    vec![Box::new(Parry)]
}

struct Parry;

impl Engine for Parry {
    fn name(&self) -> &str {
        "parry3d 0.31"
    }

    fn preset(&self) -> &str {
        "trimesh"
    }

    fn is_peer(&self) -> bool {
        true
    }

    fn grade(&self) -> Grade {
        Grade::Balanced
    }

    fn build(&self, shape: &Shape, _threads: usize) -> Result<Box<dyn Tracer>, EngineError> {
        let vertices = shape.positions().iter().map(|at| vector(*at)).collect();
        let mesh = TriMesh::new(vertices, shape.triangles().to_vec());
        Ok(Box::new(Built(mesh.map_err(|error| self.error(error))?)))
    }
}

struct Built(TriMesh);

fn vector(at: ropewalk::glam::Vec3) -> Vector {
    Vector::new(at.x, at.y, at.z)
}

fn peer_ray(ray: &Ray) -> PeerRay {
    PeerRay::new(vector(ray.origin), vector(ray.dir))
}

impl Tracer for Built {
    /// Counted from outside: it does not tell.
    fn bytes(&self) -> Option<usize> {
        None
    }

    fn modes(&self) -> &[Mode] {
        &[Mode::Single]
    }

    fn closest(&self, _: Mode, rays: &RaySet, range: Range<usize>, hits: &mut [Hit]) {
        let _flushed = Flushed::new();
        for (ray, out) in rays.rays[range].iter().zip(hits) {
            let found =
                CompositeShapeRef(&self.0).cast_local_ray(&peer_ray(ray), ray.t_max.min(f32::MAX), false);
            *out = match found {
                Some((primitive_index, t)) => {
                    Hit { t, primitive_index, geometry_index: 0, instance_index: 0, ..Hit::MISS }
                }
                None => Hit::MISS,
            };
        }
    }

    /// There is no query for any hit: the closest one is asked.
    fn any(&self, _: Mode, rays: &RaySet, range: Range<usize>, hits: &mut [bool]) {
        let _flushed = Flushed::new();
        for (ray, out) in rays.rays[range].iter().zip(hits) {
            *out = self.0.cast_local_ray(&peer_ray(ray), ray.t_max.min(f32::MAX), false).is_some();
        }
    }
}
