//! Parts that were modelled askew: the scene as it is, and every shape in a space of its own that is turned at random.
//!
//! Files tell of shapes along the axes of their own space, mostly, and there an oriented box is no better than the plain one. Where a
//! part was exported in the place and turn that it has in an assembly, it is: the boxes of long and flat parts fill with air. Here
//! each shape's vertices are turned and its instances turned back, so that, but for rounding, nothing moves.

use glam::{Affine3A, EulerRot, Mat3, Quat};
use ropewalk::{Scene, Transform, TransformError};
use ropewalk_testkit::random::Random;
use std::f64::consts::TAU;

/// The same scene of shapes that are turned in their own space.
///
/// # Errors
/// When an instance cannot be turned back, which no transform of a scene should lead to.
pub fn turned(mut scene: Scene) -> Result<Scene, TransformError> {
    let mut random = Random::new(11);
    let turns: Vec<Mat3> = scene
        .objects
        .iter()
        .map(|_| {
            let [a, b, c] = [0; 3].map(|_| random.between(0.0, TAU) as f32);
            Mat3::from_quat(Quat::from_euler(EulerRot::XYZ, a, b, c).normalize())
        })
        .collect();
    for (object, turn) in scene.objects.iter_mut().zip(&turns) {
        let meshes = object.geometries.iter_mut();
        meshes.flat_map(|mesh| &mut mesh.positions).for_each(|position| *position = *turn * *position);
    }
    for instance in &mut scene.instances {
        if let Some(turn) = turns.get(instance.object as usize) {
            let back = Affine3A::from_mat3(turn.transpose());
            instance.transform = Transform::new(*instance.transform.to_world() * back)?;
        }
    }
    Ok(scene)
}

#[cfg(test)]
mod tests {
    use super::super::batches::tests::balls;
    use super::*;
    use ropewalk::Aabb;

    #[test]
    fn everything_stays_in_its_place() {
        let (before, after) = (balls(), turned(balls()).unwrap());
        assert_ne!(before.objects[0].geometries[0].positions, after.objects[0].geometries[0].positions);
        let (before, after) = (before.flatten().unwrap().triangles, after.flatten().unwrap().triangles);
        assert_eq!(before.len(), after.len());
        for (a, b) in before.iter().zip(&after) {
            for (a, b) in a.triangle().vertices.iter().zip(b.triangle().vertices) {
                assert!(a.distance(b) < 1e-5, "{a} {b}");
            }
        }
        assert_eq!(turned(Scene::default()).unwrap().bounds(), Aabb::EMPTY);
    }
}
