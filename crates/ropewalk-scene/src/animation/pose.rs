//! Where everything is at a time.

use crate::{Camera, CornerAttribute, Light, Model};
use glam::{Affine3A, Vec3};
use ropewalk::{Ray, Transform};

/// Where everything is at a time, relative to the fixed origin of the model that it belongs to.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Pose {
    /// The time.
    pub time: f64,
    /// From each instance's object to the scene. Each can be undone; an instance that is flattened to nothing at this time
    /// keeps one that can, and is not visible.
    pub transforms: Vec<Affine3A>,
    /// Whether each instance is shown.
    pub visible: Vec<bool>,
    /// The cameras, in the model's order.
    pub cameras: Vec<Camera>,
    /// The lights, in the model's order.
    pub lights: Vec<Light>,
    /// The objects whose shape changes, each once. Which ones is the same at all times.
    pub shapes: Vec<ObjectShape>,
}

/// The shape of an object at a time.
#[derive(Clone, Debug, PartialEq)]
pub struct ObjectShape {
    /// The index of the object.
    pub object: u32,
    /// One for each geometry.
    pub geometries: Vec<GeometryShape>,
}

/// The shape of a geometry at a time.
#[derive(Clone, Debug, PartialEq)]
pub struct GeometryShape {
    /// As many positions as the mesh has.
    pub positions: Vec<Vec3>,
    /// As many as its surface has distinct normals; `None` where they stay what they are, or the surface has none.
    pub normals: Option<Vec<Vec3>>,
}

impl Pose {
    /// Brings a model into this pose. What the model does not have is passed over: it is another model than the pose's.
    pub fn apply(&self, model: &mut Model) {
        let places = self.transforms.iter().zip(&self.visible);
        for (instance, (&to_world, &is_visible)) in model.scene.instances.iter_mut().zip(places) {
            if let Ok(transform) = Transform::new(to_world) {
                instance.transform = transform;
            }
            instance.mask = if is_visible { Ray::ALL } else { 0 };
        }
        if self.cameras.len() == model.cameras.len() {
            model.cameras.clone_from(&self.cameras);
        }
        if self.lights.len() == model.lights.len() {
            model.lights.clone_from(&self.lights);
        }
        for shape in &self.shapes {
            shape.apply(model);
        }
    }
}

impl ObjectShape {
    /// Gives an object of a model this shape.
    pub fn apply(&self, model: &mut Model) {
        let index = self.object as usize;
        let Some(object) = model.scene.objects.get_mut(index) else { return };
        for (mesh, shape) in object.geometries.iter_mut().zip(&self.geometries) {
            if mesh.positions.len() == shape.positions.len() {
                mesh.positions.clone_from(&shape.positions);
            }
        }
        let Some(surfaces) = model.surfaces.get_mut(index) else { return };
        for (surface, shape) in surfaces.iter_mut().zip(&self.geometries) {
            if let (Some(CornerAttribute { values, .. }), Some(normals)) =
                (&mut surface.normals, &shape.normals)
                && values.len() == normals.len()
            {
                values.clone_from(normals);
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Surface;
    use ropewalk::{Mesh, Scene};

    fn model() -> Model {
        let mesh = Mesh::new(vec![Vec3::ZERO, Vec3::X, Vec3::Y], vec![[0, 1, 2]]);
        let normals = Some(CornerAttribute { values: vec![Vec3::Z], indices: Some(vec![[0; 3]]) });
        let surfaces = vec![vec![Surface { normals, ..Surface::default() }]];
        Model { scene: Scene::from_mesh(mesh), surfaces, ..Model::default() }
    }

    fn pose() -> Pose {
        let shape = GeometryShape { positions: vec![Vec3::ONE; 3], normals: Some(vec![Vec3::X]) };
        Pose {
            transforms: vec![Affine3A::from_translation(Vec3::Y)],
            visible: vec![false],
            shapes: vec![ObjectShape { object: 0, geometries: vec![shape] }],
            ..Pose::default()
        }
    }

    #[test]
    fn a_pose_moves_hides_and_deforms() {
        let mut posed = model();
        pose().apply(&mut posed);
        assert_eq!(posed.scene.instances[0].mask, 0);
        assert_eq!(posed.scene.instances[0].transform.point(Vec3::ZERO), Vec3::Y);
        assert_eq!(posed.scene.objects[0].geometries[0].positions, [Vec3::ONE; 3]);
        assert_eq!(posed.surfaces[0][0].normals.as_ref().unwrap().values, [Vec3::X]);
    }

    #[test]
    fn a_pose_of_another_model_breaks_nothing() {
        let mut wrong = pose();
        wrong.transforms = vec![Affine3A::from_scale(Vec3::ZERO), Affine3A::IDENTITY];
        wrong.visible = vec![true, false];
        wrong.shapes[0].geometries[0].positions.push(Vec3::ZERO);
        wrong.shapes[0].geometries[0].normals = Some(Vec::new());
        wrong.shapes.push(ObjectShape { object: 7, geometries: Vec::new() });
        let mut posed = model();
        wrong.apply(&mut posed);
        assert_eq!(posed.scene, model().scene);
        assert_eq!(posed.surfaces, model().surfaces);
    }
}
