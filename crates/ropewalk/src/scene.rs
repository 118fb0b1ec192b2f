//! Scenes: objects, and instances that place them.
//!
//! An [`Object`] is one or more meshes ("geometries") that move together; an [`Instance`] places it. Hits name
//! all three: instance, geometry, primitive.
//!
//! **Far from the origin.** A f32 has 24 bits: a bolt 10 kilometres away would be made of millimetre steps. So
//! a scene has an [`origin`](Scene::origin) in f64, and everything in it, instances, rays and hits, is relative to it.

use crate::error::SceneError;
use crate::memory::with_capacity;
use crate::parallel::extend;
use crate::{Aabb, FlatTriangle, Mesh, Ray, Transform};
use glam::{DVec3, Vec3};
use std::sync::atomic::{AtomicUsize, Ordering};

/// Meshes that move together.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Object {
    /// The parts; a hit's `geometry_index` counts them.
    pub geometries: Vec<Mesh>,
}

impl From<Mesh> for Object {
    fn from(mesh: Mesh) -> Self {
        Self { geometries: vec![mesh] }
    }
}

impl Object {
    /// The number of triangles, good or bad.
    #[must_use]
    pub fn triangle_count(&self) -> usize {
        self.geometries.iter().map(|mesh| mesh.triangles.len()).sum()
    }

    /// The box around all parts, in the object's space.
    #[must_use]
    pub fn bounds(&self) -> Aabb {
        self.geometries.iter().map(Mesh::bounds).fold(Aabb::EMPTY, Aabb::union)
    }
}

/// An object placed in the scene.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Instance {
    /// The index of the object.
    pub object: u32,
    /// From the object's space to the scene's.
    pub transform: Transform,
    /// Rays with a common bit see the instance. The low 8 bits count.
    pub mask: u32,
}

impl Instance {
    /// An instance that every ray sees.
    #[must_use]
    pub const fn new(object: u32, transform: Transform) -> Self {
        Self { object, transform, mask: Ray::ALL }
    }
}

/// Objects and their instances.
///
/// ```
/// use ropewalk::{Mesh, Ray, Scene, BuildOptions, glam::Vec3};
/// let mut scene = Scene::default();
/// let object = scene.add_object(Mesh::new(vec![Vec3::ZERO, Vec3::X, Vec3::Y], vec![[0, 1, 2]]));
/// scene.add_instance(object, Default::default());
/// let bvh = scene.build(&BuildOptions::default())?;
/// let hit = bvh.closest(&Ray::new(Vec3::new(0.2, 0.2, 1.0), -Vec3::Z));
/// assert_eq!(hit.t, 1.0);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Scene {
    /// Where the scene's zero lies in the world.
    pub origin: DVec3,
    /// The objects.
    pub objects: Vec<Object>,
    /// The instances; a hit's `instance_index` counts them.
    pub instances: Vec<Instance>,
}

/// What was wrong with the triangles of a scene, and what was done: nothing is carried on silently.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct InputReport {
    /// Triangles given, instances counted.
    pub triangles: usize,
    /// Triangles left out because a vertex is NaN, infinite, or beyond [`Scene::LARGEST_COORDINATE`].
    pub not_finite: usize,
    /// Triangles left out because an index points at no vertex.
    pub out_of_range: usize,
    /// Triangles left out because two of their vertices are the same point: they have no area, and their
    /// neighbours meet without them. Triangles of three points on a line are not: they may close a gap.
    pub degenerate: usize,
    /// Triangles of three different points on a line: kept, although they have no area.
    pub collinear: usize,
}

impl InputReport {
    /// The number of triangles left out.
    #[must_use]
    pub const fn skipped(&self) -> usize {
        self.not_finite + self.out_of_range + self.degenerate
    }
}

/// The triangles of all instances in the scene's space, and what was left out.
#[derive(Clone, Debug, Default)]
pub struct FlatScene {
    /// The good triangles, ordered by instance, geometry, primitive.
    pub triangles: Vec<FlatTriangle>,
    /// What was wrong with the others.
    pub report: InputReport,
}

impl Scene {
    /// Coordinates beyond this size would overflow products of three in f32.
    pub const LARGEST_COORDINATE: f32 = 1e12;

    /// A scene of one mesh, placed as it is.
    #[must_use]
    pub fn from_mesh(mesh: Mesh) -> Self {
        let mut scene = Self::default();
        let object = scene.add_object(mesh);
        scene.add_instance(object, Transform::IDENTITY);
        scene
    }

    /// Adds an object and returns its index.
    pub fn add_object(&mut self, object: impl Into<Object>) -> u32 {
        self.objects.push(object.into());
        (self.objects.len() - 1) as u32
    }

    /// Adds an instance that every ray sees and returns its index.
    pub fn add_instance(&mut self, object: u32, transform: Transform) -> u32 {
        self.instances.push(Instance::new(object, transform));
        (self.instances.len() - 1) as u32
    }

    /// The number of triangles with instances counted.
    #[must_use]
    pub fn triangle_count(&self) -> usize {
        self.placed().map(|(_, object)| object.triangle_count()).sum()
    }

    /// The box around all instances.
    #[must_use]
    pub fn bounds(&self) -> Aabb {
        // From the vertices: a turned box would be larger than what it holds.
        self.placed()
            .flat_map(|(instance, object)| {
                object.geometries.iter().flat_map(move |mesh| {
                    mesh.triangles
                        .iter()
                        .flatten()
                        .filter_map(|&index| mesh.positions.get(index as usize))
                        .map(|&position| instance.transform.point(position))
                        .filter(|position| position.is_finite())
                })
            })
            .fold(Aabb::EMPTY, Aabb::with_point)
    }

    /// A ray of the world in the scene: its origin moves, in f64, by [`Scene::origin`].
    #[must_use]
    pub fn ray_from_world(&self, origin: DVec3, dir: DVec3) -> Ray {
        Ray::new((origin - self.origin).as_vec3(), dir.as_vec3())
    }

    /// Places every triangle in the scene's space, leaving out and counting what cannot be hit.
    ///
    /// # Errors
    /// When an instance names no object, or there are more instances or triangles than the identity words hold.
    pub fn flatten(&self) -> Result<FlatScene, SceneError> {
        self.check_instances()?;
        let triangles = self.triangle_count();
        // A node's link and a binary tree's node count must fit 32 bits.
        let limit = (u32::MAX / 2) as usize;
        if triangles > limit {
            return Err(SceneError::TooManyTriangles { triangles, limit });
        }
        let mut flat = FlatScene { triangles: with_capacity(triangles), ..FlatScene::default() };
        for (instance_index, instance) in self.instances.iter().enumerate() {
            let object = &self.objects[instance.object as usize];
            let mirror = if instance.transform.mirrors() { FlatTriangle::MIRROR } else { 0 };
            let instance_and_mask = instance_index as u32 | instance.mask << 24;
            for (geometry, mesh) in object.geometries.iter().enumerate() {
                let place = |position: Vec3| instance.transform.point(position);
                flat.place(mesh, geometry as u32 | mirror, instance_and_mask, place);
            }
        }
        if flat.report.skipped() > 0 {
            flat.triangles.retain(|triangle| !triangle.v0[0].is_nan());
        }
        Ok(flat)
    }

    /// Refuses instances of nothing, and more of them than an index counts.
    pub(crate) fn check_instances(&self) -> Result<(), SceneError> {
        if self.instances.len() > FlatTriangle::INSTANCE_LIMIT {
            return Err(SceneError::TooManyInstances {
                instances: self.instances.len(),
                limit: FlatTriangle::INSTANCE_LIMIT,
            });
        }
        for (index, instance) in self.instances.iter().enumerate() {
            if instance.object as usize >= self.objects.len() {
                return Err(SceneError::NoSuchObject {
                    instance: index,
                    object: instance.object,
                    objects: self.objects.len(),
                });
            }
        }
        Ok(())
    }

    fn placed(&self) -> impl Iterator<Item = (&Instance, &Object)> {
        self.instances
            .iter()
            .filter_map(|instance| Some((instance, self.objects.get(instance.object as usize)?)))
    }
}

impl FlatScene {
    /// What stands for a triangle that is left out, until the end: no good one has a vertex that is not a number.
    const LEFT_OUT: FlatTriangle = FlatTriangle {
        v0: [f32::NAN; 3],
        primitive: 0,
        v1: [0.0; 3],
        geometry_and_mirror: 0,
        v2: [0.0; 3],
        instance_and_mask: 0,
    };

    /// Places the triangles of a mesh; some of them may be [`Self::LEFT_OUT`].
    fn place(
        &mut self,
        mesh: &Mesh,
        geometry_and_mirror: u32,
        instance_and_mask: u32,
        place: impl Fn(Vec3) -> Vec3 + Send + Sync,
    ) {
        // What is counted is rare, so that several threads may count in one place.
        let [out_of_range, not_finite, degenerate, collinear] = [const { AtomicUsize::new(0) }; 4];
        let count = |counter: &AtomicUsize| {
            counter.fetch_add(1, Ordering::Relaxed);
        };
        extend(&mut self.triangles, &mesh.triangles, |primitive, _| {
            let Some(mut triangle) = mesh.triangle(primitive) else {
                count(&out_of_range);
                return Self::LEFT_OUT;
            };
            triangle.vertices = triangle.vertices.map(&place);
            // `all` of a comparison that NaN fails, and infinity: both count as too large.
            let is_small = |vertex: &Vec3| vertex.abs().cmple(Vec3::splat(Scene::LARGEST_COORDINATE)).all();
            if !triangle.vertices.iter().all(is_small) {
                count(&not_finite);
                return Self::LEFT_OUT;
            }
            if triangle.is_degenerate() {
                count(&degenerate);
                return Self::LEFT_OUT;
            }
            if !triangle.has_area() {
                count(&collinear);
            }
            let [v0, v1, v2] = triangle.vertices.map(|vertex| vertex.to_array());
            let primitive = primitive as u32;
            FlatTriangle { v0, primitive, v1, geometry_and_mirror, v2, instance_and_mask }
        });
        let report = &mut self.report;
        report.triangles += mesh.triangles.len();
        report.out_of_range += out_of_range.into_inner();
        report.not_finite += not_finite.into_inner();
        report.degenerate += degenerate.into_inner();
        report.collinear += collinear.into_inner();
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::Affine3A;

    #[test]
    fn what_cannot_be_hit_is_counted() {
        let mesh = Mesh::new(
            vec![Vec3::ZERO, Vec3::X, Vec3::Y, Vec3::splat(f32::NAN), Vec3::splat(1e13), Vec3::X * 2.0],
            vec![[0, 1, 2], [0, 1, 3], [0, 1, 4], [0, 1, 9], [0, 1, 5], [1, 1, 2]],
        );
        let flat = Scene::from_mesh(mesh).flatten().unwrap();
        // Three different points on a line are kept.
        let expected =
            InputReport { triangles: 6, not_finite: 2, out_of_range: 1, degenerate: 1, collinear: 1 };
        assert_eq!(flat.report, expected);
        assert_eq!(flat.triangles.len(), 2);
    }

    #[test]
    fn instances_keep_their_names_and_sides() {
        let mut scene = Scene::default();
        let mesh = Mesh::new(vec![Vec3::ZERO, Vec3::X, Vec3::Y], vec![[0, 1, 2]]);
        let object = scene.add_object(Object { geometries: vec![Mesh::default(), mesh] });
        scene.add_instance(object, Transform::IDENTITY);
        let mirror = Transform::new(Affine3A::from_scale(Vec3::new(-1.0, 1.0, 1.0))).unwrap();
        scene.add_instance(object, mirror);
        scene.instances[1].mask = 2;
        let flat = scene.flatten().unwrap();
        let names: Vec<_> = flat
            .triangles
            .iter()
            .map(|triangle| {
                (triangle.instance(), triangle.geometry(), triangle.primitive, triangle.is_mirrored())
            })
            .collect();
        assert_eq!(names, [(0, 1, 0, false), (1, 1, 0, true)]);
        assert_eq!(flat.triangles[1].instance_and_mask >> 24, 2);
        assert_eq!(scene.bounds(), Aabb::new(Vec3::new(-1.0, 0.0, 0.0), Vec3::new(1.0, 1.0, 0.0)));
    }

    #[test]
    fn an_instance_of_nothing_is_an_error() {
        let mut scene = Scene::default();
        scene.add_instance(4, Transform::IDENTITY);
        let error = scene.flatten().unwrap_err();
        assert_eq!(error, SceneError::NoSuchObject { instance: 0, object: 4, objects: 0 });
    }
}
