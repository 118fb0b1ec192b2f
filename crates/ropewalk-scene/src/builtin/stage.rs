//! Puts solids together to a [`Model`].

use super::shape::{Solid, normals};
use crate::{Camera, CornerAttribute, Light, Material, MaterialAssignment, Model, Surface};
use glam::{Affine3A, DAffine3, DVec3, Mat3, Vec3};
use ropewalk::{Mesh, Object, Transform};

/// Edges sharper than this stay hard in the shading: above the steps of a round surface, below any chamfer.
const CREASE: f64 = 35.0 * std::f64::consts::PI / 180.0;

/// A model in the making. Every part has a name; equal parts are instances of one object.
pub(crate) struct Stage {
    model: Model,
}

impl Stage {
    /// An empty stage on which y is up.
    pub(crate) fn new(materials: Vec<Material>) -> Self {
        Self { model: Model { materials, up: Some(Vec3::Y), ..Model::default() } }
    }

    /// Adds an object of one solid, not yet placed.
    pub(crate) fn part(&mut self, name: &str, solid: &Solid) -> u32 {
        let normals = normals::smooth(solid, CREASE);
        self.parts(name, &[(solid, Some(normals))])
    }

    /// Adds an object that is shaded face by face, not yet placed.
    pub(crate) fn flat_part(&mut self, name: &str, solid: &Solid) -> u32 {
        self.parts(name, &[(solid, None)])
    }

    /// Adds an object of several solids, each a geometry with normals of its own, not yet placed.
    pub(crate) fn parts(&mut self, name: &str, solids: &[(&Solid, Option<CornerAttribute<Vec3>>)]) -> u32 {
        let mut object = Object::default();
        let mut surfaces = Vec::new();
        for (solid, normals) in solids {
            let positions: Vec<Vec3> = solid.positions.iter().map(|position| position.as_vec3()).collect();
            self.model.report.vertices += positions.len();
            object.geometries.push(Mesh::new(positions, solid.triangles.clone()));
            let one = solid.materials.first().copied().unwrap_or(0);
            let materials = if solid.materials.iter().all(|&material| material == one) {
                MaterialAssignment::One(one)
            } else {
                MaterialAssignment::PerTriangle(solid.materials.clone())
            };
            surfaces.push(Surface { normals: normals.clone(), texture_coordinates: None, materials });
        }
        self.model.object_names.push(name.into());
        self.model.surfaces.push(surfaces);
        self.model.scene.add_object(object)
    }

    /// Places an object.
    pub(crate) fn place(&mut self, object: u32, placement: &DAffine3) {
        let transform =
            Transform::new(affine(placement)).expect("a turn, a shift and a scale above zero can be undone");
        self.model.scene.add_instance(object, transform);
    }

    /// The finished model.
    pub(crate) fn finish(mut self, camera: Camera, sun: Light) -> Model {
        self.model.cameras.push(camera);
        self.model.lights.push(sun);
        self.model
    }
}

/// A placement in f32.
pub(crate) fn affine(placement: &DAffine3) -> Affine3A {
    let matrix = placement.matrix3;
    let columns = [matrix.x_axis, matrix.y_axis, matrix.z_axis].map(DVec3::as_vec3);
    Affine3A::from_mat3_translation(
        Mat3::from_cols(columns[0], columns[1], columns[2]),
        placement.translation.as_vec3(),
    )
}

/// A camera that looks from a point at another one.
pub(crate) fn camera(name: &str, eye: [f32; 3], target: [f32; 3], vertical_fov_degrees: f32) -> Camera {
    let (eye, target) = (Vec3::from(eye), Vec3::from(target));
    Camera {
        name: name.into(),
        position: eye,
        forward: (target - eye).normalize(),
        up: Vec3::Y,
        vertical_fov: vertical_fov_degrees.to_radians(),
    }
}

/// A material that gives off no light and lets none through.
pub(crate) fn material(name: &str, base_color: [f32; 3], roughness: f32, metallic: f32) -> Material {
    Material { name: name.into(), base_color: base_color.into(), roughness, metallic, ..Material::default() }
}
