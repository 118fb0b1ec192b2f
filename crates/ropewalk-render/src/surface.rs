//! From a hit to what shading needs to know about the place.

use crate::offset;
use crate::stage::Stage;
use glam::Vec3;
use ropewalk::{Hit, Ray};

/// A place on a surface that an eye sees.
#[derive(Clone, Copy, Debug)]
pub(crate) struct SurfacePoint {
    /// Where it is.
    pub(crate) position: Vec3,
    /// From where rays leave it, on the side that is seen.
    pub(crate) origin: Vec3,
    /// The normal of the triangle, of unit length, towards the side that is seen.
    pub(crate) geometric_normal: Vec3,
    /// The normal for shading, of unit length, on the same side.
    pub(crate) normal: Vec3,
    /// To the eye, of unit length.
    pub(crate) view: Vec3,
    /// The material.
    pub(crate) material: u32,
    /// Whether this is the added ground.
    pub(crate) is_ground: bool,
    /// The indices of instance, geometry and primitive, where rays leave from the triangle itself and not from a curved
    /// surface above it.
    pub(crate) triangle: Option<(u32, u32, u32)>,
}

impl Stage {
    /// The place of a hit; `None` when its indices lead nowhere, which a sound structure never answers.
    pub(crate) fn surface_point(&self, ray: &Ray, hit: &Hit) -> Option<SurfacePoint> {
        let model = self.model();
        let instance = model.scene.instances.get(hit.instance_index as usize)?;
        let object = model.scene.objects.get(instance.object as usize)?;
        let mesh = object.geometries.get(hit.geometry_index as usize)?;
        let triangle = hit.primitive_index as usize;
        let indices = *mesh.triangles.get(triangle)?;
        // The same operation as when the scene was flattened: the same vertices to the bit.
        let vertices = mesh.triangle(triangle)?.vertices.map(|vertex| instance.transform.point(vertex));

        let [a, b, c] = vertices.map(Vec3::as_dvec3);
        let (u, v) = (f64::from(hit.barycentrics.x), f64::from(hit.barycentrics.y));
        let position = (a * (1.0 - u - v) + b * u + c * v).as_vec3();
        let view = -ray.dir.normalize_or_zero();
        let outward = (b - a).cross(c - a).try_normalize()?.as_vec3();
        let geometric_normal = if outward.dot(view) < 0.0 { -outward } else { outward };

        let surface = model.surfaces.get(instance.object as usize)?.get(hit.geometry_index as usize)?;
        let corner_normals = surface.normals.as_ref().and_then(|normals| normals.corners(triangle, indices));
        let weights = [(1.0 - u - v) as f32, u as f32, v as f32];
        let (mut normal, mut lifted) = (geometric_normal, position);
        if let Some(corners) = corner_normals {
            let towards_eye = |normal: Vec3| {
                let normal = instance.transform.normal(normal).as_dvec3().normalize_or_zero().as_vec3();
                if normal.dot(geometric_normal) < 0.0 { -normal } else { normal }
            };
            let corners = corners.map(towards_eye);
            let mean = corners[0] * weights[0] + corners[1] * weights[1] + corners[2] * weights[2];
            // A file's normals may be zero or no numbers: then the triangle's own counts.
            if let Some(mean) = mean.try_normalize().filter(|mean| mean.dot(geometric_normal) > 0.0) {
                normal = mean;
                lifted = offset::lifted(position, &vertices, &corners, weights);
            }
        }
        let step = offset::distance(&vertices, geometric_normal);
        Some(SurfacePoint {
            position,
            origin: lifted + geometric_normal * step,
            geometric_normal,
            normal,
            view,
            material: surface.materials.of(triangle),
            is_ground: self.ground_instance() == Some(hit.instance_index),
            triangle: (lifted == position).then(|| hit.id()),
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Ground, StageOptions};
    use glam::{Affine3A, Vec2};
    use ropewalk::{BuildOptions, Mesh, Scene, Transform};
    use ropewalk_scene::{CornerAttribute, Model, Surface};

    fn stage(normals: Option<CornerAttribute<Vec3>>, transform: Affine3A) -> Stage {
        let mut scene = Scene::default();
        let object = scene.add_object(Mesh::new(vec![Vec3::ZERO, Vec3::X, Vec3::Y], vec![[0, 1, 2]]));
        scene.add_instance(object, Transform::new(transform).unwrap());
        let surfaces = vec![vec![Surface { normals, ..Surface::default() }]];
        let options = StageOptions { ground: Ground::Off, crease: 0.0, up: None };
        Stage::new(Model { scene, surfaces, ..Model::default() }, &options)
    }

    fn seen(stage: &Stage, ray: Ray) -> SurfacePoint {
        let hit = stage.scene().build(&BuildOptions::default()).unwrap().closest(&ray);
        assert!(hit.is_hit());
        stage.surface_point(&ray, &hit).unwrap()
    }

    #[test]
    fn the_side_that_is_seen_has_the_normal() {
        let stage = stage(None, Affine3A::IDENTITY);
        let front = seen(&stage, Ray::new(Vec3::new(0.25, 0.25, 2.0), Vec3::NEG_Z * 3.0));
        assert_eq!((front.normal, front.view), (Vec3::Z, Vec3::Z));
        assert_eq!(front.position, Vec3::new(0.25, 0.25, 0.0));
        assert!(front.origin.z > 0.0 && front.origin.z < 1e-5);
        let back = seen(&stage, Ray::new(Vec3::new(0.25, 0.25, -2.0), Vec3::Z));
        assert_eq!((back.normal, back.geometric_normal), (Vec3::NEG_Z, Vec3::NEG_Z));
        assert!(back.origin.z < 0.0);
    }

    #[test]
    fn given_normals_are_interpolated_placed_and_turned() {
        let tilted = Vec3::new(0.0, 0.6, 0.8);
        let normals = CornerAttribute { values: vec![tilted * 5.0; 3], indices: None };
        // A mirror and a squash: the normal keeps its right angle to the surface it stands for.
        let squash = Affine3A::from_scale(Vec3::new(-1.0, 0.5, 1.0));
        let stage = stage(Some(normals), squash);
        let point = seen(&stage, Ray::new(Vec3::new(-0.25, 0.1, 2.0), Vec3::NEG_Z));
        let expected = Vec3::new(0.0, 1.2, 0.8).normalize();
        assert!(point.normal.distance(expected) < 1e-6, "{}", point.normal);
        let behind = seen(&stage, Ray::new(Vec3::new(-0.25, 0.1, -2.0), Vec3::Z));
        assert!(behind.normal.distance(-expected) < 1e-6, "{}", behind.normal);
    }

    #[test]
    fn bad_normals_fall_back_to_the_triangles_own() {
        for values in [vec![Vec3::ZERO; 3], vec![Vec3::NAN; 3], vec![Vec3::Z; 2]] {
            let stage = stage(Some(CornerAttribute { values, indices: None }), Affine3A::IDENTITY);
            let point = seen(&stage, Ray::new(Vec3::new(0.25, 0.25, 2.0), Vec3::NEG_Z));
            assert_eq!(point.normal, Vec3::Z);
            assert!(point.origin.is_finite());
        }
    }

    #[test]
    fn indices_that_lead_nowhere_are_noticed() {
        let stage = stage(None, Affine3A::IDENTITY);
        let ray = Ray::new(Vec3::Z, Vec3::NEG_Z);
        let hit = Hit {
            t: 1.0,
            barycentrics: Vec2::splat(0.2),
            primitive_index: 0,
            geometry_index: 0,
            instance_index: 0,
            front_face: true,
        };
        assert!(stage.surface_point(&ray, &hit).is_some());
        assert!(stage.surface_point(&ray, &Hit { primitive_index: 1, ..hit }).is_none());
        assert!(stage.surface_point(&ray, &Hit { geometry_index: 1, ..hit }).is_none());
        assert!(stage.surface_point(&ray, &Hit { instance_index: 1, ..hit }).is_none());
    }
}
