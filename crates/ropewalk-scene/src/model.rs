//! A model: the geometry of a [`ropewalk::Scene`] and how it looks.

use crate::{Material, Texture};
use glam::{Vec2, Vec3};
use ropewalk::Scene;

/// A scene with its looks: what a file holds.
#[derive(Clone, Debug, Default)]
pub struct Model {
    /// The geometry. A hit's indices lead into it.
    pub scene: Scene,
    /// The names of the objects, one each; empty where the file gives none.
    pub object_names: Vec<String>,
    /// For each object and each of its geometries: how its surface looks.
    pub surfaces: Vec<Vec<Surface>>,
    /// The materials; never empty in a model that has triangles.
    pub materials: Vec<Material>,
    /// The pictures that materials name.
    pub textures: Vec<Texture>,
    /// The cameras of the file, in the scene's space.
    pub cameras: Vec<Camera>,
    /// The lights of the file, in the scene's space.
    pub lights: Vec<Light>,
    /// The radiance of what rays see that leave the scene, where the file says so.
    pub background: Option<Vec3>,
    /// Light that reaches every place alike, where the file says so; materials say how much of it they send on.
    pub ambient: Option<Vec3>,
    /// Which way is up, where the format or the file says so.
    pub up: Option<Vec3>,
    /// What was read, and what was not.
    pub report: LoadReport,
}

/// A value at each corner of each triangle of a mesh.
#[derive(Clone, Debug, PartialEq)]
pub struct CornerAttribute<T> {
    /// The distinct values.
    pub values: Vec<T>,
    /// Three indices into `values` a triangle; `None` when they are the indices of the vertices.
    pub indices: Option<Vec<[u32; 3]>>,
}

impl<T: Copy> CornerAttribute<T> {
    /// The values at the three corners of a triangle whose vertices are `vertices`; `None` where an index leads nowhere.
    pub fn corners(&self, triangle: usize, vertices: [u32; 3]) -> Option<[T; 3]> {
        let [a, b, c] = match &self.indices {
            None => vertices,
            Some(indices) => *indices.get(triangle)?,
        };
        let value = |index: u32| self.values.get(index as usize).copied();
        Some([value(a)?, value(b)?, value(c)?])
    }
}

/// Which material each triangle has.
#[derive(Clone, Debug, PartialEq)]
pub enum MaterialAssignment {
    /// All the same.
    One(u32),
    /// An index a triangle.
    PerTriangle(Vec<u32>),
}

impl MaterialAssignment {
    /// The material of a triangle; 0 where none is given.
    #[must_use]
    pub fn of(&self, triangle: usize) -> u32 {
        match self {
            Self::One(material) => *material,
            Self::PerTriangle(materials) => materials.get(triangle).copied().unwrap_or(0),
        }
    }
}

/// How the surface of a mesh looks.
#[derive(Clone, Debug, PartialEq)]
pub struct Surface {
    /// Shading normals, where the file has them; not necessarily of unit length.
    pub normals: Option<CornerAttribute<Vec3>>,
    /// Texture coordinates, where the file has them.
    pub texture_coordinates: Option<CornerAttribute<Vec2>>,
    /// Materials.
    pub materials: MaterialAssignment,
}

impl Default for Surface {
    fn default() -> Self {
        Self { normals: None, texture_coordinates: None, materials: MaterialAssignment::One(0) }
    }
}

/// A pinhole camera, in the scene's space.
#[derive(Clone, Debug, PartialEq)]
pub struct Camera {
    /// The name in the file.
    pub name: String,
    /// The eye.
    pub position: Vec3,
    /// Where it looks; any length but zero.
    pub forward: Vec3,
    /// What is up in the picture; not parallel to `forward`.
    pub up: Vec3,
    /// The angle between the lower and the upper edge of the picture, in radians.
    pub vertical_fov: f32,
}

/// A light, in the scene's space. Colours are linear.
#[derive(Clone, Debug, PartialEq)]
pub enum Light {
    /// Parallel light from far away.
    Sun {
        /// From the light into the scene; any length but zero.
        direction: Vec3,
        /// The irradiance on a surface that faces it.
        color: Vec3,
    },
    /// Light from a point, falling with the square of the distance.
    Point {
        /// Where it is.
        position: Vec3,
        /// The intensity: irradiance at distance one.
        color: Vec3,
    },
    /// Light from a point that does not fall with the distance: no lamp does that, but older formats' do.
    Lamp {
        /// Where it is.
        position: Vec3,
        /// The irradiance on a surface that faces it, at any distance.
        color: Vec3,
    },
}

/// What a loader read, and what it left out and why.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct LoadReport {
    /// The format, such as `OBJ` or `PLY binary little endian`; empty for a built-in scene.
    pub format: String,
    /// Vertices as stored in the file.
    pub vertices: usize,
    /// What was left out, a row a reason.
    pub skipped: Vec<Skipped>,
    /// What was understood in a way that a user may want to know, such as a material file that is not there.
    pub notes: Vec<String>,
}

/// Things left out for one reason.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Skipped {
    /// The reason, such as `faces with fewer than three vertices`.
    pub what: String,
    /// How many.
    pub count: usize,
    /// Where the first one stands, such as `line 17`.
    pub first: String,
}

impl LoadReport {
    /// Counts one more thing that was left out; only the first place of a reason is kept.
    pub fn skip(&mut self, what: &str, place: impl FnOnce() -> String) {
        match self.skipped.iter_mut().find(|row| row.what == what) {
            Some(row) => row.count += 1,
            None => self.skipped.push(Skipped { what: what.into(), count: 1, first: place() }),
        }
    }

    /// How many things were left out.
    #[must_use]
    pub fn skipped_count(&self) -> usize {
        self.skipped.iter().map(|row| row.count).sum()
    }
}
