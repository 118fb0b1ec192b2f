//! Scenes: objects, and instances that place them.
//!
//! An [`Object`] is one or more meshes ("geometries") that move together; an [`Instance`] places it. Hits name
//! all three: instance, geometry, primitive.
//!
//! **Far from the origin.** A f32 has 24 bits: a bolt 10 kilometres away would be made of millimetre steps. So
//! a scene has an [`origin`](Scene::origin) in f64, and everything in it, instances, rays and hits, is relative to it.

use crate::error::SceneError;
use crate::{Aabb, FlatTriangle, Mesh, Ray, Transform};
use glam::DVec3;

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

impl std::ops::AddAssign for InputReport {
    fn add_assign(&mut self, other: Self) {
        self.triangles += other.triangles;
        self.not_finite += other.not_finite;
        self.out_of_range += other.out_of_range;
        self.degenerate += other.degenerate;
        self.collinear += other.collinear;
    }
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
