//! The scene, and the ground of two triangles and four vertices on which the paper's scenes stand.

use glam::Vec3;
use ropewalk::{Aabb, Mesh, Scene, Transform};

/// How far the ground reaches from the middle, in units of the scene's largest side. The reference measurements do not say;
/// with this one, rays that start on the ground have the share that their counts ask for.
const REACH: f32 = 2.5;

/// A scene with its ground and without.
#[derive(Clone, Debug)]
pub(super) struct Stage {
    /// What stands on the ground.
    pub(super) alone: Scene,
    /// The same on its ground.
    pub(super) on_ground: Scene,
    /// The box of what stands on the ground: views are about that.
    pub(super) bounds: Aabb,
}

impl Stage {
    /// Puts a scene on the ground. A ground that it has of its own is taken away first, so that all stand on the same.
    pub(super) fn new(mut scene: Scene) -> Self {
        remove_ground(&mut scene);
        let bounds = scene.bounds();
        let mut on_ground = scene.clone();
        if !bounds.is_empty() {
            let (center, reach) = (bounds.center(), bounds.size().max_element() * REACH);
            let corner = |x: f32, z: f32| Vec3::new(center.x + x * reach, bounds.min.y, center.z + z * reach);
            let corners = vec![corner(-1.0, -1.0), corner(-1.0, 1.0), corner(1.0, 1.0), corner(1.0, -1.0)];
            let ground = on_ground.add_object(Mesh::new(corners, vec![[0, 1, 2], [0, 2, 3]]));
            on_ground.add_instance(ground, Transform::IDENTITY);
        }
        Self { alone: scene, on_ground, bounds }
    }
}

/// Empties the mesh that is a ground: two triangles in the scene's lowest plane that reach beyond everything else on all
/// four sides. The indices of the others stay what they are.
fn remove_ground(scene: &mut Scene) {
    let bounds = scene.bounds();
    let found = scene.instances.iter().enumerate().find_map(|(index, instance)| {
        let object = scene.objects.get(instance.object as usize)?;
        let is_shared = scene
            .instances
            .iter()
            .enumerate()
            .any(|(other, it)| other != index && it.object == instance.object);
        let geometry = object.geometries.iter().position(|mesh| {
            let places = mesh.triangles.iter().flatten().filter_map(|&vertex| {
                mesh.positions.get(vertex as usize).map(|&position| instance.transform.point(position))
            });
            let own = Aabb::of_points(places);
            let is_flat = own.min.y == bounds.min.y && own.max.y == bounds.min.y;
            mesh.triangles.len() == 2
                && is_flat
                && own.min.x == bounds.min.x
                && own.max.x == bounds.max.x
                && own.min.z == bounds.min.z
                && own.max.z == bounds.max.z
        })?;
        (!is_shared).then_some((instance.object as usize, geometry))
    });
    let Some((object, geometry)) = found else { return };
    let mesh = scene.objects.get_mut(object).and_then(|object| object.geometries.get_mut(geometry));
    let Some(mesh) = mesh else { return };
    let triangles = std::mem::take(&mut mesh.triangles);
    let rest = scene.bounds();
    let is_inside = rest.min.x > bounds.min.x
        && rest.max.x < bounds.max.x
        && rest.min.z > bounds.min.z
        && rest.max.z < bounds.max.z;
    // The lid of a box is no ground, and neither is all that there is.
    if rest.is_empty() || !is_inside {
        let mesh = scene.objects.get_mut(object).and_then(|object| object.geometries.get_mut(geometry));
        if let Some(mesh) = mesh {
            mesh.triangles = triangles;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use ropewalk_testkit::meshes;

    #[test]
    fn the_ground_is_two_triangles_below_with_its_front_above() {
        let stage = Stage::new(Scene::from_mesh(meshes::icosphere(1)));
        assert_eq!((stage.alone.triangle_count(), stage.on_ground.triangle_count()), (80, 82));
        assert_eq!(stage.bounds, stage.alone.bounds());
        assert_eq!(stage.on_ground.bounds().min.y, stage.bounds.min.y);
        assert_eq!(stage.on_ground.bounds().size().x, 2.0 * REACH * stage.bounds.size().max_element());
        let flat = stage.on_ground.flatten().unwrap();
        assert!(flat.triangles.iter().rev().take(2).all(|triangle| triangle.front().y > 0.0));
        assert_eq!(Stage::new(Scene::default()).on_ground.triangle_count(), 0);
    }

    #[test]
    fn a_ground_of_its_own_is_replaced() {
        let stage = Stage::new(Scene::from_mesh(meshes::icosphere(1)));
        let again = Stage::new(stage.on_ground.clone());
        assert_eq!((again.alone.triangle_count(), again.on_ground.triangle_count()), (80, 82));
        assert_eq!(again.bounds, stage.bounds);
        // The same ground alone, and a quad below that is no wider than the rest, are no grounds.
        let mut quad = Scene::default();
        let object = quad.add_object(stage.on_ground.objects[1].clone());
        quad.add_instance(object, Transform::IDENTITY);
        assert_eq!(Stage::new(quad).alone.triangle_count(), 2);
        let mut narrow = Scene::from_mesh(meshes::icosphere(1));
        let corners = [[-0.5, -0.5], [-0.5, 0.5], [0.5, 0.5], [0.5, -0.5]];
        let corners = corners.map(|[x, z]| Vec3::new(x, -1.0, z)).to_vec();
        let object = narrow.add_object(Mesh::new(corners, vec![[0, 1, 2], [0, 2, 3]]));
        narrow.add_instance(object, Transform::IDENTITY);
        assert_eq!(Stage::new(narrow).alone.triangle_count(), 82);
    }
}
