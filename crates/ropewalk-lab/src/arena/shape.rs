//! The triangles that every engine gets: one mesh, no triangle twice as far as its vertices go, none that cannot be hit.

use ropewalk::glam::{DQuat, DVec3, Vec3, Vec3A};
use ropewalk::{Aabb, FlatScene, Mesh, Scene, SceneError};
use std::collections::HashMap;
use std::sync::{Arc, OnceLock};

/// One mesh as every engine gets it. A hit's `primitive_index` counts its triangles.
#[derive(Clone, Debug)]
pub struct Shape {
    scene: Scene,
    flat: FlatScene,
    aligned_positions: OnceLock<Arc<[Vec3A]>>,
    aligned_corners: OnceLock<Arc<[Vec3A]>>,
}

impl Shape {
    /// The triangles of a scene with all instances placed. What cannot be hit is left out, so that no engine has to know
    /// what to do with it; vertices with the same bits become one, as a file with indices would have them.
    ///
    /// # Errors
    /// When the scene cannot be flattened.
    pub fn new(scene: &Scene) -> Result<Self, SceneError> {
        let flat = scene.flatten()?;
        let mut known: HashMap<[u32; 3], u32> = HashMap::with_capacity(flat.triangles.len());
        let mut mesh = Mesh::default();
        for triangle in &flat.triangles {
            mesh.triangles.push(triangle.triangle().vertices.map(|vertex| {
                *known.entry(vertex.to_array().map(f32::to_bits)).or_insert_with(|| {
                    mesh.positions.push(vertex);
                    (mesh.positions.len() - 1) as u32
                })
            }));
        }
        Self::of_mesh(mesh)
    }

    fn of_mesh(mesh: Mesh) -> Result<Self, SceneError> {
        let scene = Scene::from_mesh(mesh);
        let flat = scene.flatten()?;
        Ok(Self { scene, flat, aligned_positions: OnceLock::new(), aligned_corners: OnceLock::new() })
    }

    /// The same as a scene of one mesh.
    #[must_use]
    pub fn scene(&self) -> &Scene {
        &self.scene
    }

    /// The same as flat triangles, for the oracle and for makers of rays.
    #[must_use]
    pub fn flat(&self) -> &FlatScene {
        &self.flat
    }

    /// The mesh.
    #[must_use]
    pub fn mesh(&self) -> &Mesh {
        // `of_mesh` made a scene of one object with one geometry.
        &self.scene.objects[0].geometries[0]
    }

    /// The vertices.
    #[must_use]
    pub fn positions(&self) -> &[Vec3] {
        &self.mesh().positions
    }

    /// Three vertices a triangle.
    #[must_use]
    pub fn triangles(&self) -> &[[u32; 3]] {
        &self.mesh().triangles
    }

    /// The vertices 16 bytes apart, for engines that share the caller's memory. Made once, so that it is no part of a build.
    #[must_use]
    pub fn aligned_positions(&self) -> Arc<[Vec3A]> {
        let made = self
            .aligned_positions
            .get_or_init(|| self.positions().iter().copied().map(Vec3A::from).collect());
        Arc::clone(made)
    }

    /// Three corners a triangle 16 bytes apart, for engines without indices.
    #[must_use]
    pub fn aligned_corners(&self) -> Arc<[Vec3A]> {
        let made = self.aligned_corners.get_or_init(|| self.corners().flatten().map(Vec3A::from).collect());
        Arc::clone(made)
    }

    /// The corners of each triangle.
    pub fn corners(&self) -> impl Iterator<Item = [Vec3; 3]> + '_ {
        self.flat.triangles.iter().map(|triangle| triangle.triangle().vertices)
    }

    /// The box around all.
    #[must_use]
    pub fn bounds(&self) -> Aabb {
        self.mesh().bounds()
    }

    /// The same triangles with every vertex taken elsewhere.
    ///
    /// # Errors
    /// When the result cannot be flattened.
    pub fn moved(&self, place: impl Fn(Vec3) -> Vec3) -> Result<Self, SceneError> {
        let positions = self.positions().iter().map(|&position| place(position)).collect();
        Self::of_mesh(Mesh::new(positions, self.triangles().to_vec()))
    }

    /// The same turned about the middle of its box.
    ///
    /// # Errors
    /// When the result cannot be flattened.
    pub fn turned(&self, turn: &Turn) -> Result<Self, SceneError> {
        self.moved(|position| turn.point(position.as_dvec3()).as_vec3())
    }

    /// The same bent a little, as a body that moves bends: what refits are timed with.
    ///
    /// # Errors
    /// When the result cannot be flattened.
    pub fn bent(&self, phase: f32) -> Result<Self, SceneError> {
        let bounds = self.bounds();
        let size = (bounds.max - bounds.min).max_element().max(f32::MIN_POSITIVE);
        self.moved(|position| {
            let along = (position - bounds.min) / size;
            // A parabola and no sine, which would not be the same on every machine.
            let wave = |x: f32| (x + phase).fract() * (1.0 - (x + phase).fract());
            position + Vec3::new(wave(along.y), wave(along.z), wave(along.x)) * (size * 0.02)
        })
    }
}

/// A rotation about a point.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Turn {
    about: DVec3,
    rotation: DQuat,
}

impl Turn {
    /// Off every axis, about the middle of a box: half a radian to nearly one about an axis that is none of the three.
    #[must_use]
    pub fn off_axis(bounds: &Aabb) -> Self {
        let about = if bounds.is_empty() { DVec3::ZERO } else { bounds.center().as_dvec3() };
        // Of whole numbers, so that no sine rounds differently elsewhere.
        Self { about, rotation: DQuat::from_xyzw(1.0, 2.0, -1.5, 5.5).normalize() }
    }

    /// A point, turned.
    #[must_use]
    pub fn point(&self, point: DVec3) -> DVec3 {
        self.about + self.rotation * (point - self.about)
    }

    /// A direction, turned.
    #[must_use]
    pub fn direction(&self, direction: DVec3) -> DVec3 {
        self.rotation * direction
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use ropewalk_testkit::meshes;

    #[test]
    fn vertices_are_shared_and_what_cannot_be_hit_is_left_out() {
        let mut mesh = meshes::icosphere(1);
        let triangles = mesh.triangles.len();
        mesh.triangles.push([0, 0, 1]);
        let shape = Shape::new(&Scene::from_mesh(mesh.clone())).unwrap();
        assert_eq!((shape.triangles().len(), shape.positions().len()), (triangles, mesh.positions.len()));
        assert_eq!(shape.corners().count(), shape.flat().triangles.len());
    }

    #[test]
    fn turning_keeps_lengths_and_bending_keeps_triangles() {
        let shape = Shape::new(&Scene::from_mesh(meshes::icosphere(2))).unwrap();
        let turn = Turn::off_axis(&shape.bounds());
        let turned = shape.turned(&turn).unwrap();
        let middle = shape.bounds().center();
        for (a, b) in shape.positions().iter().zip(turned.positions()) {
            assert!(((*a - middle).length() - (*b - middle).length()).abs() < 1e-5);
            assert!(a != b);
        }
        assert!((turn.direction(DVec3::X).length() - 1.0).abs() < 1e-12);
        let bent = shape.bent(0.3).unwrap();
        assert_eq!(bent.triangles(), shape.triangles());
        assert!(bent.positions() != shape.positions());
    }
}
