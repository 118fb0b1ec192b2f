//! Flattening: the triangles of all instances in the scene's space, and what of them cannot be hit.
//!
//! Nearly every triangle is good, and has an area that f32 can tell from none: one test sees that, and only the others are looked
//! at closely. So a triangle takes some nanoseconds, most of them for its memory.

use crate::error::SceneError;
use crate::memory::with_capacity;
use crate::parallel::extend;
use crate::{FlatTriangle, InputReport, Mesh, Scene, Transform, Triangle};
use glam::{Vec3, Vec3A, Vec3Swizzles};
use std::sync::Mutex;
use std::sync::atomic::{AtomicUsize, Ordering};

/// The triangles of all instances in the scene's space, and what was left out.
#[derive(Clone, Debug, Default)]
pub struct FlatScene {
    /// The good triangles, ordered by instance, geometry, primitive.
    pub triangles: Vec<FlatTriangle>,
    /// What was wrong with the others.
    pub report: InputReport,
}

/// The same with a number for each triangle, good or not, as they come.
#[derive(Debug, Default)]
pub(crate) struct NumberedScene {
    /// The good triangles, in any order, with their numbers in place of those of their primitives.
    pub(crate) triangles: Vec<FlatTriangle>,
    /// The numbers of the others, ascending.
    pub(crate) left_out: Vec<u32>,
    pub(crate) report: InputReport,
}

impl Scene {
    /// Places every triangle in the scene's space, leaving out and counting what cannot be hit.
    ///
    /// # Errors
    /// When an instance names no object, or there are more instances or triangles than the identity words hold.
    pub fn flatten(&self) -> Result<FlatScene, SceneError> {
        let NumberedScene { mut triangles, left_out, report } = self.place(|_| 0)?;
        close_gaps(&mut triangles, &left_out);
        Ok(FlatScene { triangles, report })
    }

    /// The same for who names triangles by numbers.
    ///
    /// # Errors
    /// As [`Self::flatten`].
    pub(crate) fn flatten_numbered(&self) -> Result<NumberedScene, SceneError> {
        let mut flat = self.place(|first| first)?;
        fill_gaps(&mut flat.triangles, &flat.left_out);
        Ok(flat)
    }

    /// All triangles, with something in the places of those that are left out. The numbers of a geometry's primitives count from
    /// what its place among all makes.
    fn place(&self, first_number: impl Fn(u32) -> u32) -> Result<NumberedScene, SceneError> {
        self.check_instances()?;
        let triangles = self.triangle_count();
        // A node's link and a binary tree's node count must fit 32 bits.
        let limit = (u32::MAX / 2) as usize;
        if triangles > limit {
            return Err(SceneError::TooManyTriangles { triangles, limit });
        }
        let mut flat = NumberedScene { triangles: with_capacity(triangles), ..NumberedScene::default() };
        for (instance_index, instance) in self.instances.iter().enumerate() {
            let object = &self.objects[instance.object as usize];
            let mirror = if instance.transform.mirrors() { FlatTriangle::MIRROR } else { 0 };
            let instance_and_mask = instance_index as u32 | instance.mask << 24;
            for (geometry, mesh) in object.geometries.iter().enumerate() {
                let name = FlatTriangle {
                    primitive: first_number(flat.triangles.len() as u32),
                    geometry_and_mirror: geometry as u32 | mirror,
                    instance_and_mask,
                    ..BLANK
                };
                flat.place(mesh, &instance.transform, &name);
            }
        }
        flat.left_out.sort_unstable();
        Ok(flat)
    }
}

const BLANK: FlatTriangle = FlatTriangle {
    v0: [0.0; 3],
    primitive: 0,
    v1: [0.0; 3],
    geometry_and_mirror: 0,
    v2: [0.0; 3],
    instance_and_mask: 0,
};

impl NumberedScene {
    /// Places the triangles of a mesh, with the words of identity that primitive 0 has.
    fn place(&mut self, mesh: &Mesh, transform: &Transform, name: &FlatTriangle) {
        // What is counted is rare, so that several threads may count in one place.
        let [out_of_range, not_finite, degenerate, collinear] = [const { AtomicUsize::new(0) }; 4];
        let first = self.triangles.len();
        let left_out = Mutex::new(&mut self.left_out);
        let leave_out = |counter: &AtomicUsize, primitive: usize| {
            counter.fetch_add(1, Ordering::Relaxed);
            if let Ok(mut left_out) = left_out.lock() {
                left_out.push((first + primitive) as u32);
            }
            BLANK
        };
        extend(&mut self.triangles, &mesh.triangles, |primitive, &indices| {
            let Some(vertices) = placed(mesh, indices, transform) else {
                return leave_out(&out_of_range, primitive);
            };
            if !is_certainly_good(vertices) {
                let triangle = Triangle { vertices: vertices.map(Vec3::from) };
                if !triangle.vertices.iter().all(is_small) {
                    return leave_out(&not_finite, primitive);
                }
                if triangle.is_degenerate() {
                    return leave_out(&degenerate, primitive);
                }
                if !triangle.has_area() {
                    collinear.fetch_add(1, Ordering::Relaxed);
                }
            }
            let [v0, v1, v2] = vertices.map(|vertex| vertex.to_array());
            FlatTriangle { v0, v1, v2, primitive: name.primitive + primitive as u32, ..*name }
        });
        let report = &mut self.report;
        report.triangles += mesh.triangles.len();
        report.out_of_range += out_of_range.into_inner();
        report.not_finite += not_finite.into_inner();
        report.degenerate += degenerate.into_inner();
        report.collinear += collinear.into_inner();
    }
}

/// The vertices of a triangle in the scene's space, where there are such.
#[inline(always)]
fn placed(mesh: &Mesh, [a, b, c]: [u32; 3], transform: &Transform) -> Option<[Vec3A; 3]> {
    let vertex = |index: u32| {
        let position = *mesh.positions.get(index as usize)?;
        Some(transform.to_world().transform_point3a(position.into()))
    };
    Some([vertex(a)?, vertex(b)?, vertex(c)?])
}

/// Whether a vertex is finite and not too large: of a comparison that NaN fails, and infinity.
fn is_small(vertex: &Vec3) -> bool {
    vertex.abs().cmple(Vec3::splat(Scene::LARGEST_COORDINATE)).all()
}

/// Whether all vertices are small and some component of the normal is larger than what rounding could have made of 0.
///
/// Four roundings, of edges, products and their difference, change a component by less than 3e-7 of the sum of its products'
/// sizes, and what underflows by less than 1e-44. So an area that is seen here is there in f64, too, and no two vertices
/// are the same.
#[inline(always)]
fn is_certainly_good([a, b, c]: [Vec3A; 3]) -> bool {
    let limit = Vec3A::splat(Scene::LARGEST_COORDINATE);
    let is_small = a.abs().cmple(limit) & b.abs().cmple(limit) & c.abs().cmple(limit);
    let (ab, ac) = (b - a, c - a);
    let [plus, minus] = [ab.zxy() * ac, ab * ac.zxy()];
    let noise = (plus.abs() + minus.abs()) * 1e-6 + Vec3A::splat(1e-30);
    let has_area = (plus - minus).abs().cmpgt(noise);
    is_small.all() && has_area.any()
}

/// Moves triangles down to where others are left out: their order stays.
fn close_gaps(triangles: &mut Vec<FlatTriangle>, gaps: &[u32]) {
    let Some(&first) = gaps.first() else { return };
    let mut to = first as usize;
    let ends = gaps[1..].iter().map(|&gap| gap as usize).chain([triangles.len()]);
    for (&gap, end) in gaps.iter().zip(ends) {
        let from = gap as usize + 1;
        triangles.copy_within(from..end, to);
        to += end - from;
    }
    triangles.truncate(to);
}

/// Moves the last triangles to where others are left out, which are few: none of the others is touched.
fn fill_gaps(triangles: &mut Vec<FlatTriangle>, gaps: &[u32]) {
    let good = triangles.len() - gaps.len();
    let (inner, outer) = gaps.split_at(gaps.partition_point(|&gap| (gap as usize) < good));
    // As many good ones lie behind as there are gaps before.
    let is_good = |place: &usize| outer.binary_search(&(*place as u32)).is_err();
    let spare = (good..triangles.len()).filter(is_good);
    for (&gap, place) in inner.iter().zip(spare) {
        triangles[gap as usize] = triangles[place];
    }
    triangles.truncate(good);
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Aabb, Object};
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

    #[test]
    fn numbered_triangles_are_the_same_with_their_numbers() {
        // Needles, points and what is beyond, in all places.
        let positions = vec![Vec3::ZERO, Vec3::X, Vec3::Y, Vec3::splat(f32::NAN), Vec3::new(1.0, 1e-12, 0.0)];
        for pattern in 0..3_u32.pow(6) {
            let kinds = (0..6).map(|place| pattern / 3_u32.pow(place) % 3);
            let triangles: Vec<_> =
                kinds.map(|kind| [[0, 1, 2], [0, 1, 3], [0, 1, 4]][kind as usize]).collect();
            let mut scene = Scene::default();
            let object = scene.add_object(Mesh::new(positions.clone(), triangles[..4].to_vec()));
            scene.add_instance(object, Transform::IDENTITY);
            let other = scene.add_object(Mesh::new(positions.clone(), triangles[4..].to_vec()));
            scene.add_instance(other, Transform::IDENTITY);
            let (flat, mut numbered) = (scene.flatten().unwrap(), scene.flatten_numbered().unwrap());
            assert_eq!(flat.report, numbered.report);
            let bad: Vec<u32> = (0..6).filter(|&number| triangles[number as usize] == [0, 1, 3]).collect();
            assert_eq!(numbered.left_out, bad, "{pattern}");
            numbered.triangles.sort_by_key(|triangle| triangle.primitive);
            let expected = flat.triangles.iter().map(|triangle| {
                let first = if triangle.instance() == 0 { 0 } else { 4 };
                FlatTriangle { primitive: first + triangle.primitive, ..*triangle }
            });
            assert_eq!(numbered.triangles, expected.collect::<Vec<_>>(), "{pattern}");
        }
    }

    #[test]
    fn what_is_certainly_good_has_an_area() {
        let mut state = 1_u32;
        let mut random = || {
            state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            (state >> 8) as f32 / 8_388_608.0 - 1.0
        };
        let (mut certain, mut doubtful) = (0, 0);
        for case in 0..20_000 {
            let size = [1e-25, 1e-12, 1.0, 1e9, 9e11][case % 5];
            let mut vertex = || Vec3::new(random(), random(), random()) * size;
            let (a, b) = (vertex(), vertex());
            // Exactly on the line, as far as f32 goes, and beside it.
            let c = a + (b - a) * 0.5 + vertex() * [0.0, 1e-8, 1e-5, 1.0][case / 5 % 4];
            let triangle = Triangle { vertices: [a, b, c] };
            if is_certainly_good(triangle.vertices.map(Vec3A::from)) {
                assert!(triangle.has_area() && !triangle.is_degenerate());
                certain += 1;
            } else {
                doubtful += 1;
            }
        }
        assert!(certain > 4000 && doubtful > 4000, "{certain} {doubtful}");
    }
}
