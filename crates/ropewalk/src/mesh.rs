//! Triangle meshes, as the caller gives them.

use crate::{Aabb, Triangle};
use glam::Vec3;

/// Vertices and the triangles between them.
///
/// A mesh may hold anything: indices that point nowhere, vertices that are not numbers, triangles without
/// area. Building a structure skips such triangles and counts them in an [`InputReport`](crate::InputReport).
///
/// ```
/// use ropewalk::{Mesh, glam::Vec3};
/// let mesh = Mesh::new(vec![Vec3::ZERO, Vec3::X, Vec3::Y], vec![[0, 1, 2]]);
/// assert_eq!(mesh.bounds().max, Vec3::new(1.0, 1.0, 0.0));
/// ```
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Mesh {
    /// The vertices, in the object's space.
    pub positions: Vec<Vec3>,
    /// Three indices into `positions` a triangle, counter-clockwise seen from the front.
    pub triangles: Vec<[u32; 3]>,
}

impl Mesh {
    /// A mesh of these vertices and triangles.
    #[must_use]
    pub const fn new(positions: Vec<Vec3>, triangles: Vec<[u32; 3]>) -> Self {
        Self { positions, triangles }
    }

    /// A triangle, or `None` when it or one of its vertices is not there.
    #[must_use]
    pub fn triangle(&self, index: usize) -> Option<Triangle> {
        let [a, b, c] = *self.triangles.get(index)?;
        let vertex = |index: u32| self.positions.get(index as usize).copied();
        Some(Triangle { vertices: [vertex(a)?, vertex(b)?, vertex(c)?] })
    }

    /// The box around the finite vertices that triangles use.
    #[must_use]
    pub fn bounds(&self) -> Aabb {
        self.triangles
            .iter()
            .flatten()
            .filter_map(|&index| self.positions.get(index as usize).copied())
            .filter(|position| position.is_finite())
            .fold(Aabb::EMPTY, Aabb::with_point)
    }
}
