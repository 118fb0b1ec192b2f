//! Where a scene has the triangles of a tree, by their numbers.
//!
//! Every vertex is placed once, 16 bytes apart; what a triangle of the tree needs then is its three indices and three loads. A vertex
//! that no triangle may have is kept as one that is no number.
//!
//! **What fits.** The triangles of the scene that can be hit must be those of the tree: as many, and those that cannot be hit are those
//! that were left out when the tree was built ([`Names::holes`]).

use crate::bvh8::Bvh8;
use crate::bvh8::arena::prefetch;
use crate::bvh8::names::{Names, Part};
use crate::memory::with_capacity;
use crate::parallel::{extend, map_chunks};
use crate::{InputReport, Mesh, Scene, Transform, Triangle, UpdateError};
use glam::{Vec3, Vec3A, Vec3Swizzles, Vec4};

/// Triangles that a thread checks at a time.
const CHUNK: usize = 1 << 14;

/// What stands for a vertex that is not finite or too large.
const UNUSABLE: Vec4 = Vec4::NAN;

/// A scene as the leaves of a tree take it.
pub(super) struct Moved<'a> {
    /// The placed vertices of all geometries of all instances.
    vertices: Vec<Vec4>,
    /// By growing base, as the tree's parts.
    places: Vec<Place<'a>>,
    pub(super) report: InputReport,
}

/// One geometry of one instance.
struct Place<'a> {
    base: u32,
    triangles: &'a [[u32; 3]],
    /// Its first vertex, among all.
    first: usize,
}

impl<'a> Moved<'a> {
    /// # Errors
    /// When the scene has other triangles than the tree.
    pub(super) fn of(bvh: &Bvh8, scene: &'a Scene) -> Result<Self, UpdateError> {
        scene.check_instances()?;
        let objects = || scene.instances.iter().map(|instance| &scene.objects[instance.object as usize]);
        let vertices = objects().flat_map(|object| &object.geometries).map(|mesh| mesh.positions.len()).sum();
        let mut this =
            Self { vertices: with_capacity(vertices), places: Vec::new(), report: InputReport::default() };
        let mut parts = bvh.names.parts().peekable();
        // The first triangle of the tree that is not there.
        let mut missing = None;
        for (index, (instance, object)) in scene.instances.iter().zip(objects()).enumerate() {
            for (geometry, mesh) in object.geometries.iter().enumerate() {
                let is_this =
                    |part: &Part| (part.instance as usize, part.geometry as usize) == (index, geometry);
                let part = parts.next_if(is_this);
                let checked = this.place(mesh, &instance.transform, part.map(|part| part.base));
                this.report += checked.report;
                if let Some(part) = part {
                    missing = missing.or_else(|| missing_of(&part, &bvh.names, mesh, &checked.skipped));
                }
            }
        }
        let (was, is) = (bvh.report().triangles, this.report.triangles - this.report.skipped());
        if was != is {
            return Err(UpdateError::OtherCount { was, is });
        }
        match missing.or_else(|| parts.next().map(|part| part.base)) {
            Some(number) => Err(UpdateError::OtherTriangle { number: number as usize }),
            None => Ok(this),
        }
    }

    /// Places the vertices of a mesh, and says what is wrong with its triangles.
    fn place(&mut self, mesh: &'a Mesh, transform: &Transform, base: Option<u32>) -> Checked {
        let first = self.vertices.len();
        extend(&mut self.vertices, &mesh.positions, |_, &position| placed(transform, position));
        let vertices = &self.vertices[first..];
        let parts =
            map_chunks(&mesh.triangles, CHUNK, |first, triangles| checked(first, triangles, vertices));
        let mut all = Checked::default();
        for part in parts {
            all.report += part.report;
            all.skipped.extend(part.skipped);
        }
        if let Some(base) = base {
            self.places.push(Place { base, triangles: &mesh.triangles, first });
        }
        all
    }

    /// Where the vertices of a triangle of the tree are, among all.
    #[inline(always)]
    pub(super) fn corners(&self, number: u32) -> [usize; 3] {
        let place = self.place_of(number);
        let [a, b, c] = place.triangles[(number - place.base) as usize];
        [place.first + a as usize, place.first + b as usize, place.first + c as usize]
    }

    /// A vertex.
    #[inline(always)]
    pub(super) fn vertex(&self, index: usize) -> Vec4 {
        self.vertices[index]
    }

    /// Asks for what [`Self::corners`] reads.
    #[inline(always)]
    pub(super) fn prefetch_corners(&self, number: u32) {
        let place = self.place_of(number);
        let triangle = place.triangles.as_ptr().wrapping_add((number - place.base) as usize);
        // One in eight goes on in the next line.
        prefetch(triangle);
        prefetch(triangle.cast::<u32>().wrapping_add(2));
    }

    /// Asks for what [`Self::vertex`] reads.
    #[inline(always)]
    pub(super) fn prefetch_vertex(&self, index: usize) {
        prefetch(self.vertices.as_ptr().wrapping_add(index));
    }

    #[inline(always)]
    fn place_of(&self, number: u32) -> &Place<'a> {
        match self.places.as_slice() {
            [place] => place,
            places => &places[places.partition_point(|place| place.base <= number) - 1],
        }
    }
}

/// What came of the triangles of a mesh.
#[derive(Default)]
struct Checked {
    report: InputReport,
    /// Those that cannot be hit, ascending.
    skipped: Vec<u32>,
}

/// The first triangle of a part that the mesh does not have, or cannot be hit there, or could not before.
fn missing_of(part: &Part, names: &Names, mesh: &Mesh, skipped: &[u32]) -> Option<u32> {
    let length = part.end - part.base;
    let mut holes = names.holes(part).iter().copied();
    for &primitive in skipped.iter().take_while(|&&primitive| primitive < length) {
        let (number, hole) = (part.base + primitive, holes.next());
        if hole != Some(number) {
            return Some(hole.map_or(number, |hole| hole.min(number)));
        }
    }
    let behind = part.base + (mesh.triangles.len() as u32).min(length);
    holes.next().or((behind < part.end).then_some(behind))
}

/// A vertex in the scene, with the operations of a build.
#[inline(always)]
fn placed(transform: &Transform, position: Vec3) -> Vec4 {
    let vertex = transform.point(position);
    let is_usable = vertex.abs().cmple(Vec3::splat(Scene::LARGEST_COORDINATE)).all();
    if is_usable { vertex.extend(0.0) } else { UNUSABLE }
}

/// What becomes of a triangle.
enum Verdict {
    Kept { is_collinear: bool },
    OutOfRange,
    NotFinite,
    Degenerate,
}

/// As [`Scene::flatten`] judges.
#[inline(always)]
fn judge(&[a, b, c]: &[u32; 3], vertices: &[Vec4]) -> Verdict {
    let (Some(&a), Some(&b), Some(&c)) =
        (vertices.get(a as usize), vertices.get(b as usize), vertices.get(c as usize))
    else {
        return Verdict::OutOfRange;
    };
    if (a.x + b.x + c.x).is_nan() {
        return Verdict::NotFinite;
    }
    if a == b || b == c || c == a {
        return Verdict::Degenerate;
    }
    Verdict::Kept { is_collinear: !has_area([a, b, c]) }
}

/// As [`Triangle::has_area`], which is asked where f32 cannot tell: a component of the cross product that exceeds what its two
/// products, of rounded differences, can be wrong by is not zero.
#[inline(always)]
fn has_area([a, b, c]: [Vec4; 3]) -> bool {
    let (e, f) = (Vec3A::from_vec4(b - a), Vec3A::from_vec4(c - a));
    let (p, q) = (e.yzx() * f.zxy(), e.zxy() * f.yzx());
    // Eight times the unit roundoff, where five do, and more than the least normal number is rounded by.
    let slack = (p.abs() + q.abs()) * (4.0 * f32::EPSILON) + Vec3A::splat(1e-30);
    (p - q).abs().cmpgt(slack).any() || exact_area([a, b, c])
}

#[cold]
fn exact_area(corners: [Vec4; 3]) -> bool {
    Triangle { vertices: corners.map(Vec4::truncate) }.has_area()
}

fn checked(first: usize, triangles: &[[u32; 3]], vertices: &[Vec4]) -> Checked {
    let mut checked = Checked::default();
    checked.report.triangles = triangles.len();
    for (index, triangle) in triangles.iter().enumerate() {
        let counter = match judge(triangle, vertices) {
            Verdict::Kept { is_collinear } => {
                checked.report.collinear += usize::from(is_collinear);
                continue;
            }
            Verdict::OutOfRange => &mut checked.report.out_of_range,
            Verdict::NotFinite => &mut checked.report.not_finite,
            Verdict::Degenerate => &mut checked.report.degenerate,
        };
        *counter += 1;
        checked.skipped.push((first + index) as u32);
    }
    checked
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Slivers of every thinness, at every size: the filter never says more than f64 does.
    #[test]
    fn the_area_of_slivers_is_that_of_f64() {
        let mut kinds = [0; 2];
        for size in [1e-20f32, 1e-9, 1.0, 3e5, 1e12] {
            for step in -40i16..40 {
                let thin = if step == 0 {
                    0.0
                } else {
                    f32::powi(0.5, i32::from(step.abs())) * f32::from(step.signum())
                };
                for shift in [0.0, 0.1, 7.3] {
                    let vertices = [
                        Vec3::splat(shift),
                        Vec3::new(1.0, 2.0, 3.0),
                        Vec3::new(2.0 - shift, 4.0, 6.0 + thin),
                    ]
                    .map(|vertex| vertex * size);
                    let expected = Triangle { vertices }.has_area();
                    assert_eq!(has_area(vertices.map(|vertex| vertex.extend(0.0))), expected, "{vertices:?}");
                    kinds[usize::from(expected)] += 1;
                }
            }
        }
        assert!(kinds.iter().all(|&count| count > 10), "{kinds:?}");
    }
}
