//! One triangle of one instance: what every walk that comes to it finds there. For those who find out by other means than a
//! walk which triangles a ray may meet, as a rasteriser does.

use super::enter::{Approach, Moving};
use super::{ObjectStructure, Placed, TwoLevel};
use crate::bvh::walk::{ClosestHit, Summary};
use crate::{FlatTriangle, Hit, PreparedRay, Ray};

/// A ray that has entered an instance.
#[derive(Clone, Copy, Debug)]
pub struct EnteredInstance {
    ray: PreparedRay,
    moving: Moving,
    is_one_sided: bool,
}

impl EnteredInstance {
    /// Of an object whose triangles have two sides, where a ray has a span in the box of its instance.
    #[inline]
    pub(crate) fn two_sided(placed: &Placed, question: &Ray, ray: &PreparedRay) -> Option<Self> {
        let span = placed.span(ray)?;
        let local = placed.local(question)?;
        Some(Self { ray: local.ray, moving: Moving::new(placed, span, &local), is_one_sided: false })
    }

    /// The hit with a triangle of the object, in its frame, up to a `t_max` of the scene: to the bit what a walk offers.
    #[inline]
    #[must_use]
    pub fn intersect(&self, triangle: &FlatTriangle, t_max: f32) -> Option<Hit> {
        let limit = self.moving.limit(t_max);
        let hit = match self.is_one_sided {
            true => triangle.intersect_front(&self.ray, limit),
            false => triangle.intersect(&self.ray, limit),
        };
        hit.map(|hit| self.moving.hit(hit)).filter(|hit| hit.t <= t_max)
    }
}

impl TwoLevel {
    /// Takes a ray to the frame of an instance, by its place among [`TwoLevel::placed`]. `None` where the ray does not meet the
    /// instance's box, or does not see it. The ray must be that of which the prepared one was made.
    #[inline]
    #[must_use]
    pub fn entered(&self, place: u32, question: &Ray, ray: &PreparedRay) -> Option<EnteredInstance> {
        self.placed.get(place as usize)?;
        let approach = self.instances().approach(place, question, ray, &ClosestHit::new(ray));
        let Approach { ray, moving, .. } = approach?;
        Some(EnteredInstance { ray, moving, is_one_sided: self.is_one_sided() })
    }
}

impl ObjectStructure {
    /// The triangles in the object's frame, each once, by geometry and primitive.
    #[must_use]
    pub fn triangles(&self) -> Vec<FlatTriangle> {
        let mut triangles = Vec::new();
        self.bottom().append_triangles(&mut triangles);
        triangles
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::two_level::TwoLevelOptions;
    use crate::{Mesh, Scene, Transform};
    use glam::{Affine3A, Quat, Vec3};

    /// The closest of all triangles, one by one, is what the walk finds, in turned, mirrored and uneven places.
    #[test]
    fn triangle_by_triangle_is_what_the_walk_finds() {
        let mut scene = Scene::default();
        let points = [Vec3::ZERO, Vec3::X, Vec3::Y, Vec3::Z * 0.3].map(|point| point + Vec3::splat(0.1));
        let mesh = Mesh::new(points.to_vec(), vec![[0, 1, 2], [1, 2, 3], [0, 1, 3]]);
        let object = scene.add_object(mesh);
        for step in 0..5u8 {
            let turn = Quat::from_euler(glam::EulerRot::XYZ, f32::from(step), 0.4, 1.0);
            let place = Affine3A::from_scale_rotation_translation(
                Vec3::new(1.0, -0.5 - f32::from(step), 0.2),
                turn,
                Vec3::splat(f32::from(step) * 0.2),
            );
            scene.add_instance(object, Transform::new(place).unwrap());
        }
        let two_level = scene.build_two_level(&TwoLevelOptions::default()).unwrap();
        let mut met = 0;
        for step in 0..400u16 {
            let (x, y) = (f32::from(step % 20) * 0.15 - 1.0, f32::from(step / 20) * 0.15 - 1.0);
            let ray = Ray::new(Vec3::new(x, y, 5.0), Vec3::new(0.01, -0.02, -0.7));
            let prepared = PreparedRay::new(&ray).unwrap();
            let mut best = Hit::MISS;
            for (place, placed) in (0..).zip(two_level.placed()) {
                let Some(entered) = two_level.entered(place, &ray, &prepared) else { continue };
                let object = two_level.objects()[placed.object as usize].as_ref().unwrap();
                for triangle in object.triangles() {
                    let hit = entered.intersect(&triangle, prepared.t_max);
                    best = hit.filter(|hit| hit.precedes(&best)).unwrap_or(best);
                }
            }
            assert_eq!(best.to_words(), two_level.closest(&ray).to_words(), "{ray:?}");
            met += usize::from(best.is_hit());
        }
        assert!(met > 20, "{met}");
    }
}
