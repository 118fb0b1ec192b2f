//! A model made ready for its picture: its bounds and what is up known, shading normals where the file has
//! none, a ground to catch its shadow. The structure is built over [`Stage::scene`].

use crate::ground::{self, Catcher, Ground};
use crate::smooth;
use glam::Vec3;
use ropewalk::{Aabb, Scene};
use ropewalk_scene::{Model, Surface};

/// How a stage is set.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct StageOptions {
    /// Whether there is a ground to catch shadows.
    pub ground: Ground,
    /// What is up; else what the file says, else Z for STL and Y for everything else.
    pub up: Option<Vec3>,
    /// The largest angle, in radians, across which faces without normals of their own are shaded as one surface;
    /// 0 shades every triangle flat.
    pub crease: f32,
}

impl Default for StageOptions {
    /// Ground where there is none, and edges kept from 40 degrees on: the flanks of a bolt's hexagon (60) stay
    /// flat, a cylinder of ten sides (36) and the noise of a scan are round.
    fn default() -> Self {
        Self { ground: Ground::Auto, up: None, crease: 40.0_f32.to_radians() }
    }
}

/// A model made ready for its picture.
#[derive(Clone, Debug)]
pub struct Stage {
    model: Model,
    up: Vec3,
    bounds: Aabb,
    catcher: Option<Catcher>,
    crease: f32,
}

impl Stage {
    /// Sets the stage. The ground, where there is one, becomes the last object and instance, so that all other
    /// indices stay what they were.
    #[must_use]
    pub fn new(mut model: Model, options: &StageOptions) -> Self {
        let given = options.up.or(model.up).filter(|up| up.is_finite());
        let guess = if model.report.format.starts_with("STL") { Vec3::Z } else { Vec3::Y };
        let up = given.and_then(|up| up.as_dvec3().try_normalize()).map_or(guess, glam::DVec3::as_vec3);
        fill_surfaces(&mut model, options.crease);
        let mut bounds = Aabb::EMPTY;
        for_each_point(&model.scene, model.scene.instances.len(), |point| bounds = bounds.with_point(point));
        // An instance that names no object must stay the builder's error, not come to name the ground.
        let objects = model.scene.objects.len();
        let is_whole = model.scene.instances.iter().all(|instance| (instance.object as usize) < objects);
        let wanted = match options.ground {
            Ground::Off => false,
            Ground::On => true,
            Ground::Auto => !ground::has_ground(&model.scene, up),
        } && is_whole
            && !bounds.is_empty();
        let catcher = wanted.then(|| ground::add(&mut model, up));
        Self { model, up, bounds, catcher, crease: options.crease }
    }

    /// What the structure is built over.
    #[must_use]
    pub fn scene(&self) -> &Scene {
        &self.model.scene
    }

    /// The model, with the ground where there is one.
    #[must_use]
    pub fn model(&self) -> &Model {
        &self.model
    }

    /// What is up, of unit length.
    #[must_use]
    pub fn up(&self) -> Vec3 {
        self.up
    }

    /// The box around the model without the added ground.
    #[must_use]
    pub fn bounds(&self) -> Aabb {
        self.bounds
    }

    /// The instance of the added ground, where there is one.
    #[must_use]
    pub fn ground_instance(&self) -> Option<u32> {
        self.catcher.as_ref().map(|catcher| catcher.instance)
    }

    /// The model, to be changed in place.
    pub(crate) fn model_mut(&mut self) -> &mut Model {
        &mut self.model
    }

    /// The largest angle across which faces without normals of their own are shaded as one surface.
    pub(crate) fn crease(&self) -> f32 {
        self.crease
    }

    pub(crate) fn catcher(&self) -> Option<&Catcher> {
        self.catcher.as_ref()
    }

    /// Calls for the corners of every triangle of the model, without the added ground.
    pub(crate) fn for_each_point(&self, each: impl FnMut(Vec3)) {
        let added = usize::from(self.catcher.is_some());
        for_each_point(&self.model.scene, self.model.scene.instances.len() - added, each);
    }
}

/// Gives every geometry a surface, and every surface normals.
fn fill_surfaces(model: &mut Model, crease: f32) {
    model.surfaces.resize_with(model.scene.objects.len(), Vec::new);
    for (object, surfaces) in model.scene.objects.iter().zip(&mut model.surfaces) {
        surfaces.resize_with(object.geometries.len(), Surface::default);
        for (mesh, surface) in object.geometries.iter().zip(surfaces) {
            if surface.normals.is_none() && crease > 0.0 {
                surface.normals = Some(smooth::corner_normals(mesh, crease));
            }
        }
    }
}

/// Calls for the corners of every triangle that can be hit of the first `instances`.
pub(crate) fn for_each_point(scene: &Scene, instances: usize, mut each: impl FnMut(Vec3)) {
    for instance in scene.instances.iter().take(instances) {
        let Some(object) = scene.objects.get(instance.object as usize) else { continue };
        for mesh in &object.geometries {
            for triangle in (0..mesh.triangles.len()).filter_map(|index| mesh.triangle(index)) {
                let corners = triangle.vertices.map(|vertex| instance.transform.point(vertex));
                if corners.iter().all(|&corner| is_in_range(corner)) {
                    corners.into_iter().for_each(&mut each);
                }
            }
        }
    }
}

/// Whether the core's builders take such a vertex. Written so that a NaN is out of range.
fn is_in_range(point: Vec3) -> bool {
    point.is_finite() && point.abs().max_element() <= Scene::LARGEST_COORDINATE
}

#[cfg(test)]
mod tests {
    use super::*;
    use ropewalk::Mesh;

    fn model(format: &str) -> Model {
        let points = vec![Vec3::ZERO, Vec3::X, Vec3::Y, Vec3::splat(f32::NAN), Vec3::splat(1e13)];
        let mesh = Mesh::new(points, vec![[0, 1, 2], [0, 1, 3], [0, 1, 4], [0, 1, 77]]);
        let mut model = Model { scene: Scene::from_mesh(mesh), ..Model::default() };
        model.report.format = format.into();
        model
    }

    #[test]
    fn bounds_are_of_what_can_be_hit_and_leave_the_ground_out() {
        let stage = Stage::new(model("OBJ"), &StageOptions { ground: Ground::On, ..Default::default() });
        assert_eq!(stage.bounds(), Aabb::new(Vec3::ZERO, Vec3::new(1.0, 1.0, 0.0)));
        assert_eq!(stage.ground_instance(), Some(1));
        assert!(stage.scene().bounds().size().x > 1.0);
        let stage = Stage::new(model("OBJ"), &StageOptions { ground: Ground::Off, ..Default::default() });
        assert_eq!(stage.ground_instance(), None);
        assert_eq!(stage.scene().instances.len(), 1);
    }

    #[test]
    fn up_is_asked_then_read_then_guessed() {
        let up = |format: &str, of_file: Option<Vec3>, asked: Option<Vec3>| {
            let model = Model { up: of_file, ..model(format) };
            Stage::new(model, &StageOptions { up: asked, ..Default::default() }).up()
        };
        assert_eq!(up("OBJ", None, None), Vec3::Y);
        assert_eq!(up("STL binary", None, None), Vec3::Z);
        assert_eq!(up("OBJ", Some(Vec3::X * 3.0), None), Vec3::X);
        assert_eq!(up("OBJ", Some(Vec3::X), Some(Vec3::NEG_Z)), Vec3::NEG_Z);
        assert_eq!(up("OBJ", Some(Vec3::ZERO), None), Vec3::Y);
        assert_eq!(up("OBJ", None, Some(Vec3::NAN)), Vec3::Y);
    }

    #[test]
    fn an_instance_of_nothing_does_not_become_the_ground() {
        let mut model = model("OBJ");
        model.scene.add_instance(1, ropewalk::Transform::IDENTITY);
        let stage = Stage::new(model, &StageOptions { ground: Ground::On, ..Default::default() });
        assert!(stage.scene().build(&ropewalk::BuildOptions::default()).is_err());
    }

    #[test]
    fn an_empty_model_has_no_ground() {
        for ground in [Ground::On, Ground::Auto] {
            let stage = Stage::new(Model::default(), &StageOptions { ground, ..Default::default() });
            assert_eq!(stage.ground_instance(), None);
            assert!(stage.bounds().is_empty());
        }
    }
}
