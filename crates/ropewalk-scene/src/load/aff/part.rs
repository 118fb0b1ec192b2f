//! A part while it grows: the shapes of one object, moved into its space.

use super::shape::{Shape, Values};
use crate::{CornerAttribute, MaterialAssignment, Surface};
use glam::{DAffine3, DMat3, DVec3, Vec2, Vec3};
use ropewalk::Mesh;

/// The geometry of one object, in its own space.
#[derive(Debug, Default)]
pub(super) struct Part {
    pub(super) positions: Vec<DVec3>,
    pub(super) triangles: Vec<[u32; 3]>,
    materials: Vec<u32>,
    normals: Attribute<Vec3>,
    coordinates: Attribute<Vec2>,
}

/// A corner attribute that may begin anywhere: triangles before or between have [`NONE`].
#[derive(Debug)]
struct Attribute<T> {
    values: Vec<T>,
    indices: Vec<[u32; 3]>,
}

impl<T> Default for Attribute<T> {
    fn default() -> Self {
        Self { values: Vec::new(), indices: Vec::new() }
    }
}

const NONE: [u32; 3] = [u32::MAX; 3];

impl Part {
    /// Moves a shape into the part; `to_part` leads from its space to the part's. Mirrored shapes are turned round, so
    /// that their outside stays outside. Returns the bytes that it takes, or what keeps it out.
    pub(super) fn add(&mut self, shape: &Shape, to_part: &DAffine3, material: u32) -> Result<usize, String> {
        let before = self.bytes();
        let first = offset(self.positions.len(), shape.positions.len(), "vertices")?;
        self.positions.extend(shape.positions.iter().map(|&at| to_part.transform_point3(at)));
        let is_mirrored = to_part.matrix3.determinant() < 0.0;
        let turned = |[a, b, c]: [u32; 3]| if is_mirrored { [a, c, b] } else { [a, b, c] };
        let triangles = shape.triangles.iter().map(|&triangle| turned(triangle).map(|vertex| vertex + first));
        self.triangles.extend(triangles);
        self.materials.resize(self.triangles.len(), material);

        let end = self.triangles.len();
        if let Some(normals) = &shape.normals {
            let to_normal = normal_matrix(&to_part.matrix3);
            let moved = |&normal: &DVec3| (to_normal * normal).normalize_or_zero().as_vec3();
            self.normals.add(normals, end, moved, turned)?;
        }
        if let Some(coordinates) = &shape.coordinates {
            self.coordinates.add(coordinates, end, |pair| pair.as_vec2(), turned)?;
        }
        Ok(self.bytes() - before)
    }

    /// The bytes of all lists, and of the triangles and vertices that are made of them.
    fn bytes(&self) -> usize {
        let Self { positions, triangles, materials, normals, coordinates } = self;
        size_of_val(positions.as_slice())
            + positions.len() * size_of::<Vec3>()
            + size_of_val(triangles.as_slice())
            + size_of_val(materials.as_slice())
            + size_of_val(normals.values.as_slice())
            + size_of_val(normals.indices.as_slice())
            + size_of_val(coordinates.values.as_slice())
            + size_of_val(coordinates.indices.as_slice())
    }

    /// The mesh with its surface; `place` makes the scene's coordinates. Where some triangles have normals, the others
    /// get their own; where some have texture coordinates, the others get zero.
    pub(super) fn finish(self, place: impl Fn(DVec3) -> Vec3) -> (Mesh, Surface) {
        let Self { positions, triangles, materials, normals, coordinates } = self;
        let flat_normal = |triangle: [u32; 3]| {
            let [a, b, c] =
                triangle.map(|vertex| positions.get(vertex as usize).copied().unwrap_or(DVec3::NAN));
            let normal = (b - a).cross(c - a).normalize_or_zero();
            if normal.is_finite() { normal.as_vec3() } else { Vec3::ZERO }
        };
        let normals = normals.finish(&triangles, |values, triangle| {
            values.push(flat_normal(triangle));
            values.len() - 1
        });
        let mut zero = None;
        let coordinates = coordinates.finish(&triangles, |values, _| {
            *zero.get_or_insert_with(|| {
                values.push(Vec2::ZERO);
                values.len() - 1
            })
        });
        let materials = match materials.first() {
            Some(&first) if materials.iter().all(|&material| material == first) => {
                MaterialAssignment::One(first)
            }
            _ => MaterialAssignment::PerTriangle(materials),
        };
        let positions = positions.into_iter().map(place).collect();
        (Mesh::new(positions, triangles), Surface { normals, texture_coordinates: coordinates, materials })
    }
}

impl<T> Attribute<T> {
    /// Adds the values of a shape whose triangles are the last of those up to `end`.
    fn add<U>(
        &mut self,
        shape: &Values<U>,
        end: usize,
        convert: impl Fn(&U) -> T,
        turned: impl Fn([u32; 3]) -> [u32; 3],
    ) -> Result<(), String> {
        let first = offset(self.values.len(), shape.values.len(), "values at corners")?;
        self.values.extend(shape.values.iter().map(convert));
        self.indices.resize(end - shape.indices.len(), NONE);
        self.indices
            .extend(shape.indices.iter().map(|&triangle| turned(triangle).map(|index| index + first)));
        Ok(())
    }

    /// `None` where no triangle has it; else `stand_in` makes the index of a value for those without.
    fn finish(
        mut self,
        triangles: &[[u32; 3]],
        mut stand_in: impl FnMut(&mut Vec<T>, [u32; 3]) -> usize,
    ) -> Option<CornerAttribute<T>> {
        if self.indices.is_empty() {
            return None;
        }
        self.indices.resize(triangles.len(), NONE);
        for (indices, &triangle) in self.indices.iter_mut().zip(triangles) {
            if *indices == NONE {
                *indices = [stand_in(&mut self.values, triangle) as u32; 3];
            }
        }
        let same = self.indices == triangles;
        Some(CornerAttribute { values: self.values, indices: (!same).then_some(self.indices) })
    }
}

/// The index of the first of `more` values behind `count`. Stand-ins, one a triangle at most, must find room too.
fn offset(count: usize, more: usize, what: &str) -> Result<u32, String> {
    const MOST: usize = (u32::MAX / 2) as usize;
    match count.checked_add(more) {
        Some(all) if all <= MOST => Ok(count as u32),
        _ => Err(format!("one object has more than {MOST} {what}, the limit; split it")),
    }
}

/// The inverse transpose times the size of the determinant: it has a value for flat maps too.
pub(super) fn normal_matrix(linear: &DMat3) -> DMat3 {
    let cofactors = DMat3::from_cols(
        linear.y_axis.cross(linear.z_axis),
        linear.z_axis.cross(linear.x_axis),
        linear.x_axis.cross(linear.y_axis),
    );
    if linear.determinant() < 0.0 { cofactors * -1.0 } else { cofactors }
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::DVec2;

    fn triangle() -> Shape {
        Shape {
            positions: vec![DVec3::ZERO, DVec3::X, DVec3::Y],
            triangles: vec![[0, 1, 2]],
            ..Shape::default()
        }
    }

    fn with_normal(normal: DVec3) -> Shape {
        let normals = Some(Values { values: vec![normal], indices: vec![[0; 3]] });
        Shape { normals, ..triangle() }
    }

    #[test]
    fn triangles_without_a_value_get_one_where_others_have_it() {
        let mut part = Part::default();
        part.add(&triangle(), &DAffine3::IDENTITY, 3).unwrap();
        part.add(&with_normal(DVec3::X), &DAffine3::IDENTITY, 4).unwrap();
        let coordinates = Some(Values { values: vec![DVec2::ONE; 3], indices: vec![[0, 1, 2]] });
        part.add(&Shape { coordinates, ..triangle() }, &DAffine3::IDENTITY, 4).unwrap();
        let (mesh, surface) = part.finish(DVec3::as_vec3);
        assert_eq!(mesh.triangles, [[0, 1, 2], [3, 4, 5], [6, 7, 8]]);
        assert_eq!(surface.materials, MaterialAssignment::PerTriangle(vec![3, 4, 4]));
        let corners = |index: usize| {
            let normals = surface.normals.as_ref().unwrap();
            let coordinates = surface.texture_coordinates.as_ref().unwrap();
            let vertices = mesh.triangles[index];
            (normals.corners(index, vertices).unwrap()[0], coordinates.corners(index, vertices).unwrap()[0])
        };
        assert_eq!(corners(0), (Vec3::Z, Vec2::ZERO));
        assert_eq!(corners(1), (Vec3::X, Vec2::ZERO));
        assert_eq!(corners(2), (Vec3::Z, Vec2::ONE));
    }

    #[test]
    fn what_nobody_has_is_not_there() {
        let mut part = Part::default();
        part.add(&triangle(), &DAffine3::IDENTITY, 7).unwrap();
        let (_, surface) = part.finish(DVec3::as_vec3);
        let expected = Surface { materials: MaterialAssignment::One(7), ..Surface::default() };
        assert_eq!(surface, expected);
    }

    #[test]
    fn mirrors_turn_triangles_and_scales_bend_normals() {
        let mut part = Part::default();
        let mirror = DAffine3::from_scale(DVec3::new(-1.0, 1.0, 1.0));
        part.add(&with_normal(DVec3::Z), &mirror, 0).unwrap();
        let flat = DAffine3::from_scale(DVec3::new(1.0, 1.0, 0.0));
        part.add(&with_normal(DVec3::new(1.0, 1.0, 1.0)), &flat, 0).unwrap();
        let long = DAffine3::from_scale(DVec3::new(2.0, 1.0, 1.0));
        part.add(&with_normal(DVec3::new(1.0, 1.0, 0.0)), &long, 0).unwrap();
        let (mesh, surface) = part.finish(DVec3::as_vec3);
        assert_eq!(mesh.triangles[0], [0, 2, 1]);
        let [a, b, c] = mesh.triangle(0).unwrap().vertices;
        assert!((b - a).cross(c - a).z > 0.0, "the front stays in front");
        let normals = surface.normals.unwrap().values;
        assert_eq!(normals[..2], [Vec3::Z, Vec3::Z]);
        assert!(normals[2].distance(Vec3::new(1.0, 2.0, 0.0).normalize()) < 1e-6);
    }

    #[test]
    fn an_object_has_a_most_of_vertices() {
        assert_eq!(offset(5, 7, "vertices"), Ok(5));
        assert!(offset(5, usize::MAX, "vertices").unwrap_err().contains("limit"));
        assert!(offset(1 << 31, 0, "vertices").is_err());
    }
}
