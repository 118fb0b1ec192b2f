//! Surfaces that give off light, as lights: which are asked for, and how likely.
//!
//! A triangle is picked by its area times what its material gives off, textures left out; a point on it evenly. So what
//! a texture makes dark is asked for in vain, but nothing is missed. Both sides shine.
//!
//! **Cost.** 64 bytes a shining triangle.

use crate::stage::Stage;
use glam::{Vec2, Vec3};
use ropewalk::Hit;

/// The triangles that shine.
#[derive(Clone, Debug, Default)]
pub(crate) struct Emitters {
    triangles: Vec<Emitter>,
}

#[derive(Clone, Copy, Debug)]
struct Emitter {
    id: (u32, u32, u32),
    vertices: [Vec3; 3],
    /// The chances of all triangles up to this one.
    up_to: f32,
    /// The chance of a point, by area.
    density: f32,
}

/// A point on a triangle that shines.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Picked {
    /// As a ray would find it, without its distance.
    pub(crate) hit: Hit,
    pub(crate) position: Vec3,
    /// The chance by area.
    pub(crate) density: f32,
}

impl Emitters {
    pub(crate) fn new(stage: &Stage) -> Self {
        let model = stage.model();
        let mut triangles: Vec<(Emitter, f64)> = Vec::new();
        for (number, instance) in model.scene.instances.iter().enumerate() {
            let object = instance.object as usize;
            let (Some(geometries), Some(surfaces)) =
                (model.scene.objects.get(object), model.surfaces.get(object))
            else {
                continue;
            };
            for (geometry, (mesh, surface)) in geometries.geometries.iter().zip(surfaces).enumerate() {
                for primitive in 0..mesh.triangles.len() {
                    let material = model.materials.get(surface.materials.of(primitive) as usize);
                    let radiance = material.map_or(0.0, |material| material.emissive.max_element().min(1e6));
                    let Some(triangle) = mesh.triangle(primitive).filter(|_| radiance > 0.0) else {
                        continue;
                    };
                    let vertices = triangle.vertices.map(|vertex| instance.transform.point(vertex));
                    let [a, b, c] = vertices.map(Vec3::as_dvec3);
                    let power = 0.5 * (b - a).cross(c - a).length() * f64::from(radiance);
                    // Written so that a NaN has no power.
                    if power > 0.0 && power.is_finite() {
                        let id = (number as u32, geometry as u32, primitive as u32);
                        triangles.push((Emitter { id, vertices, up_to: 0.0, density: radiance }, power));
                    }
                }
            }
        }
        let total: f64 = triangles.iter().map(|(_, power)| power).sum();
        let mut sum = 0.0;
        let finished = triangles.into_iter().map(|(emitter, power)| {
            sum += power;
            let density = (f64::from(emitter.density) / total) as f32;
            Emitter { up_to: (sum / total) as f32, density, ..emitter }
        });
        Self { triangles: finished.collect() }
    }

    /// How likely a point of a triangle is picked, by area; 0 for one that does not shine.
    pub(crate) fn density(&self, id: (u32, u32, u32)) -> f32 {
        // They were listed in the order of their indices.
        let found = self.triangles.binary_search_by_key(&id, |emitter| emitter.id);
        found.ok().and_then(|index| self.triangles.get(index)).map_or(0.0, |emitter| emitter.density)
    }

    /// Picks a point; `None` without triangles.
    pub(crate) fn pick(&self, number: f32, square: Vec2) -> Option<Picked> {
        let index = self.triangles.partition_point(|emitter| emitter.up_to <= number);
        let emitter = self.triangles.get(index).or_else(|| self.triangles.last())?;
        let root = square.x.sqrt();
        let barycentrics = Vec2::new(root * (1.0 - square.y), root * square.y);
        let [a, b, c] = emitter.vertices;
        let (instance_index, geometry_index, primitive_index) = emitter.id;
        let hit =
            Hit { t: 1.0, barycentrics, primitive_index, geometry_index, instance_index, front_face: true };
        let position = a + (b - a) * barycentrics.x + (c - a) * barycentrics.y;
        Some(Picked { hit, position, density: emitter.density })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Ground, StageOptions};
    use ropewalk::{Mesh, Scene};
    use ropewalk_scene::{Material, MaterialAssignment, Model, Surface};

    #[test]
    fn triangles_are_picked_by_what_they_give_off() {
        let positions = vec![Vec3::ZERO, Vec3::X, Vec3::Y, Vec3::X * 2.0, Vec3::Y * 2.0];
        let triangles = vec![[0, 1, 2], [0, 3, 4], [0, 1, 2], [0, 0, 0]];
        let materials =
            [0.0, 1.0, 4.0].map(|light| Material { emissive: Vec3::splat(light), ..Material::default() });
        let surface =
            Surface { materials: MaterialAssignment::PerTriangle(vec![1, 1, 2, 2]), ..Surface::default() };
        let model = Model {
            scene: Scene::from_mesh(Mesh::new(positions, triangles)),
            surfaces: vec![vec![surface]],
            materials: materials.to_vec(),
            ..Model::default()
        };
        let options = StageOptions { ground: Ground::Off, ..StageOptions::default() };
        let emitters = Emitters::new(&Stage::new(model, &options));
        // Power 0.5, 2 and 2; the fourth has no area.
        let mut picked = [0; 4];
        let (mut mean, count) = (Vec3::ZERO, 900);
        for index in 0..count {
            let number = (index as f32 + 0.5) / count as f32;
            let one = emitters.pick(number, Vec2::new((index * 37 % 900) as f32 / 900.0, number)).unwrap();
            picked[one.hit.primitive_index as usize] += 1;
            assert_eq!(emitters.density(one.hit.id()), one.density);
            mean += one.position / count as f32;
        }
        assert_eq!(picked, [100, 400, 400, 0]);
        assert!(mean.is_finite() && mean.z == 0.0);
        // The density times the area adds up to one.
        let sum = 0.5 * emitters.density((0, 0, 0))
            + 2.0 * emitters.density((0, 0, 1))
            + 0.5 * emitters.density((0, 0, 2));
        assert!((sum - 1.0).abs() < 1e-5, "{sum}");
        assert_eq!(emitters.density((0, 0, 3)), 0.0);
        assert!(Emitters::default().pick(0.5, Vec2::ZERO).is_none());
    }
}
