//! Triangles, and the one test by which every walk decides what a ray hits.
//!
//! **Watertight** (Woop, Benthin, Wald 2013): the vertices are translated and sheared into a space in which the
//! ray is the z axis; three edge functions of two dimensions then tell the side. Rounding a product keeps the
//! order of products, so the sign of `a * b - c * d` is right or zero, never wrong. Zero counts as inside, so a
//! ray at a shared edge or vertex hits at least one of the triangles that share it.
//!
//! **`t` comes from the plane**, not from the weights as in the paper: a needle's weights are noise, and a ray that
//! starts near one would hit it 1e-5 of the needle's length away (seen in a kitchen of many needles, against f64).
//!
//! **The triangle's own box decides too.** A hit must pass the padded slab test of the triangle's own box, and its
//! `t` is moved into the interval in which the ray is in that box. Any box of a hierarchy contains the triangle's
//! own, and the slab test is monotone ([`crate::aabb`]), so no ancestor can be missed or be entered behind the hit:
//! the answer does not depend on the structure or on the order of a walk.
//!
//! Only a triangle that passed the edge test pays for the two.
//!
//! [`FlatTriangle`] is 48 bytes; `shared/triangle.wgsl` holds the twin `intersect_triangle`.

use crate::aabb::{Aabb, larger, slab_span, smaller};
use crate::ray::{PARALLEL, PreparedRay};
use bytemuck::{Pod, Zeroable};
use glam::{Vec2, Vec3, Vec4};

use crate::Hit;

/// Three vertices.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Triangle {
    /// The vertices, counter-clockwise seen from the front.
    pub vertices: [Vec3; 3],
}

impl Triangle {
    /// The smallest box around the triangle.
    #[inline]
    #[must_use]
    pub fn bounds(&self) -> Aabb {
        Aabb::of_points(self.vertices)
    }

    /// The normal, not of unit length: twice the area long.
    #[inline]
    #[must_use]
    pub fn normal(&self) -> Vec3 {
        let [a, b, c] = self.vertices;
        (b - a).cross(c - a)
    }

    /// Whether the area is more than exactly zero, in f64, where no product of f32 coordinates underflows.
    #[must_use]
    pub fn has_area(&self) -> bool {
        let [a, b, c] = self.vertices.map(Vec3::as_dvec3);
        (b - a).cross(c - a) != glam::DVec3::ZERO
    }

    /// Whether two of the vertices are the same point. Then the neighbours at its two other edges share one edge,
    /// and nothing is lost without the triangle. One of three different points on a line has no area either, but
    /// must stay: where a vertex lies in the middle of a neighbour's edge, it covers what rounding opens there.
    #[must_use]
    pub fn is_degenerate(&self) -> bool {
        let [a, b, c] = self.vertices;
        a == b || b == c || c == a
    }
}

/// A triangle in the space of the scene, with who it is: what the leaves of a flattened hierarchy hold.
///
/// Twelve little-endian words: three times a vertex and a word of identity.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
pub struct FlatTriangle {
    /// The first vertex.
    pub v0: [f32; 3],
    /// The index within the geometry.
    pub primitive: u32,
    /// The second vertex.
    pub v1: [f32; 3],
    /// The geometry's index in the low 31 bits; the top bit is set when the instance mirrors.
    pub geometry_and_mirror: u32,
    /// The third vertex.
    pub v2: [f32; 3],
    /// The instance's index in the low 24 bits, its mask in the top 8.
    pub instance_and_mask: u32,
}

impl FlatTriangle {
    /// The largest number of instances in a flattened scene.
    pub const INSTANCE_LIMIT: usize = 1 << 24;
    /// The bit of a mirroring instance in [`FlatTriangle::geometry_and_mirror`].
    pub const MIRROR: u32 = 1 << 31;

    /// The vertices.
    #[inline]
    #[must_use]
    pub fn triangle(&self) -> Triangle {
        Triangle { vertices: [self.v0.into(), self.v1.into(), self.v2.into()] }
    }

    /// The index of the geometry within its object.
    #[inline]
    #[must_use]
    pub const fn geometry(&self) -> u32 {
        self.geometry_and_mirror & !Self::MIRROR
    }

    /// The index of the instance within the scene.
    #[inline]
    #[must_use]
    pub const fn instance(&self) -> u32 {
        self.instance_and_mask & 0x00ff_ffff
    }

    /// Whether the instance mirrors, so that the winding here is the opposite of that in the object's space.
    #[inline]
    #[must_use]
    pub const fn is_mirrored(&self) -> bool {
        self.geometry_and_mirror & Self::MIRROR != 0
    }

    /// The hit of a ray within `[ray.t_min, t_max]`, ends included, or `None`. Both sides are hit.
    #[inline(always)]
    #[must_use]
    pub fn intersect(&self, ray: &PreparedRay, t_max: f32) -> Option<Hit> {
        self.hit::<false>(ray, t_max)
    }

    /// The same for a triangle of one side, which only rays hit that see its front: the same hit to the bit, or `None`.
    ///
    /// Two signs must agree on it, that of the edge functions, which is [`Hit::front_face`], and that of the ray's slope
    /// towards the plane. The first may be noise for rays that almost run in the plane. The second is a sum of products
    /// of the direction and [`FlatTriangle::normals`]: where each of these products is known not to be negative, so is
    /// their sum, rounded or not. Lists that leave out what a set of directions cannot see rely on that.
    #[inline(always)]
    #[must_use]
    pub fn intersect_front(&self, ray: &PreparedRay, t_max: f32) -> Option<Hit> {
        self.hit::<true>(ray, t_max)
    }

    #[inline(always)]
    fn hit<const FRONT: bool>(&self, ray: &PreparedRay, t_max: f32) -> Option<Hit> {
        if self.instance_and_mask & ray.mask == 0 {
            return None;
        }
        let faces = |seen_from_front: bool, normal| {
            !FRONT || (seen_from_front != self.is_mirrored() && self.runs_against(ray, normal))
        };
        let crossing = cross(ray, &[self.v0, self.v1, self.v2], t_max, faces)?;
        Some(Hit {
            t: crossing.t,
            barycentrics: Vec2::new(crossing.v, crossing.w),
            primitive_index: self.primitive,
            geometry_index: self.geometry(),
            instance_index: self.instance(),
            front_face: crossing.seen_from_front != self.is_mirrored(),
        })
    }

    /// Whether the ray runs against the normal of the front, strictly.
    #[inline(always)]
    fn runs_against(&self, ray: &PreparedRay, normal: Vec3) -> bool {
        let slope = slope(ray, normal);
        if ray.forward != self.is_mirrored() { slope < 0.0 } else { slope > 0.0 }
    }

    /// Whether a ray that begins on the triangle leaves it by its front, strictly.
    #[inline]
    #[must_use]
    pub fn is_left_by(&self, ray: &PreparedRay) -> bool {
        let slope = slope(ray, permute(ray, &self.front().to_array()).into());
        if ray.forward { slope > 0.0 } else { slope < 0.0 }
    }

    /// The normal of the front, not of unit length.
    #[inline]
    #[must_use]
    pub fn front(&self) -> Vec3 {
        let normal = self.triangle().normal();
        if self.is_mirrored() { -normal } else { normal }
    }

    /// The normals of the front that [`FlatTriangle::intersect_front`] may go by. In exact numbers they are one.
    #[must_use]
    pub fn normals(&self) -> [Vec3; 3] {
        let [a, b, c] = self.triangle().vertices;
        let (ab, bc, ca) = (b - a, c - b, a - c);
        [bc.cross(ca), ca.cross(ab), ab.cross(bc)]
            .map(|normal| if self.is_mirrored() { -normal } else { normal })
    }
}

/// Where a ray meets a triangle that has no name.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Crossing {
    pub(crate) t: f32,
    /// The weight of the second vertex.
    pub(crate) v: f32,
    /// The weight of the third vertex.
    pub(crate) w: f32,
    /// Whether the vertices run counter-clockwise seen from the ray's origin.
    pub(crate) seen_from_front: bool,
}

impl Crossing {
    /// Nowhere.
    pub(crate) const NONE: Self = Self { t: f32::INFINITY, v: 0.0, w: 0.0, seen_from_front: false };
}

/// Where a ray meets a triangle within `[ray.t_min, t_max]`, ends included, or `None`: what all walks ask, one triangle at a time
/// here and eight in [`crate::bvh8`]. `faces` agrees with whether the triangle is seen from its front, and with its normal in the
/// ray's order of axes.
#[inline(always)]
fn cross(
    ray: &PreparedRay,
    vertices: &[[f32; 3]; 3],
    t_max: f32,
    faces: impl Fn(bool, Vec3) -> bool,
) -> Option<Crossing> {
    let (a, b, c) = (shear(ray, &vertices[0]), shear(ray, &vertices[1]), shear(ray, &vertices[2]));
    let u = c[0] * b[1] - c[1] * b[0];
    let v = a[0] * c[1] - a[1] * c[0];
    let w = b[0] * a[1] - b[1] * a[0];
    if (u < 0.0 || v < 0.0 || w < 0.0) && (u > 0.0 || v > 0.0 || w > 0.0) {
        return None;
    }
    let determinant = u + v + w;
    // Below the smallest normal number the weights would lose their bits, and 1 / determinant overflow.
    if determinant.abs() < f32::MIN_POSITIVE {
        return None;
    }
    let scale = 1.0 / determinant;
    let (distance, normal) = plane(ray, vertices);
    let depth = depth(ray, distance, normal, (u * a[2] + v * b[2] + w * c[2]) * scale)?;
    let seen_from_front = (determinant > 0.0) == ray.forward;
    if !faces(seen_from_front, normal) {
        return None;
    }
    // The depth first, in units of the scene, and then `t`: a short direction must not make it overflow.
    let t = depth * ray.shear[2];
    let corner = |vertex: &[f32; 3]| Vec4::new(vertex[0], vertex[1], vertex[2], 1.0);
    let (first, second, third) = (corner(&vertices[0]), corner(&vertices[1]), corner(&vertices[2]));
    let span = slab_span(ray, first.min(second).min(third), first.max(second).max(third));
    if larger(span.entry, ray.t_min) > span.exit {
        return None;
    }
    // Plus zero: of -0 and 0 either may come, and neither ties nor bits must depend on it.
    let t = smaller(larger(t, span.entry), span.exit) + 0.0;
    if !(t >= ray.t_min && t <= t_max) {
        return None;
    }
    Some(Crossing { t, v: v * scale + 0.0, w: w * scale + 0.0, seen_from_front })
}

/// The triangle's plane, as a ray sees it: the distance of a vertex from the origin along the normal, and the normal,
/// both with the axes in the ray's order. The normal is the cross product of the two shorter edges: of a needle's two
/// long ones it would have no right digit.
#[inline(always)]
fn plane(ray: &PreparedRay, vertices: &[[f32; 3]; 3]) -> (f32, Vec3) {
    let a = Vec3::from(permute(ray, &vertices[0]));
    let b = Vec3::from(permute(ray, &vertices[1]));
    let c = Vec3::from(permute(ray, &vertices[2]));
    let (ab, bc, ca) = (b - a, c - b, a - c);
    let (ab_length, bc_length, ca_length) = (ab.length_squared(), bc.length_squared(), ca.length_squared());
    let normal = if ab_length >= bc_length && ab_length >= ca_length {
        bc.cross(ca)
    } else if bc_length >= ca_length {
        ca.cross(ab)
    } else {
        ab.cross(bc)
    };
    (normal.dot(a - Vec3::from(permute(ray, &ray.origin))), normal)
}

/// How far a unit along the axis `kz` leads a ray along a normal whose axes are in the ray's order. Along an axis to which the
/// ray is parallel for the slab test it does not run at all, so that this goes by the same directions as the choice of a
/// list. The axis `kz` comes last in the sum, and the ray runs along no other more than along it: so the sum is not
/// negative where the normal's component along `kz` is at least the rounded sum of the others' magnitudes.
#[inline(always)]
pub(crate) fn slope(ray: &PreparedRay, normal: Vec3) -> f32 {
    let along = |shear: f32| if shear.abs() <= PARALLEL { 0.0 } else { shear };
    normal.dot(Vec3::new(along(ray.shear[0]), along(ray.shear[1]), 1.0))
}

/// How far along the axis `kz` the ray meets a plane. Where the ray runs in the plane the depth is `interpolated`, by the
/// weights, whose error is that of a needle's weights times its length. `None` where everything overflows.
#[inline(always)]
fn depth(ray: &PreparedRay, distance: f32, normal: Vec3, interpolated: f32) -> Option<f32> {
    let slope = normal.dot(Vec3::new(ray.shear[0], ray.shear[1], 1.0));
    let depth = distance / slope;
    if depth.is_finite() {
        Some(depth)
    } else if interpolated.is_finite() {
        Some(interpolated)
    } else {
        None
    }
}

/// The coordinates in the order `kx`, `ky`, `kz`.
#[inline(always)]
pub(crate) fn permute(ray: &PreparedRay, point: &[f32; 3]) -> [f32; 3] {
    let point = [point[0], point[1], point[2], 0.0];
    // The mask lets the compiler see that the index is in range.
    let [x, y, z] = ray.axes;
    [point[usize::from(x & 3)], point[usize::from(y & 3)], point[usize::from(z & 3)]]
}

/// A vertex in the space in which the ray is the z axis.
#[inline(always)]
fn shear(ray: &PreparedRay, vertex: &[f32; 3]) -> [f32; 3] {
    let moved = [vertex[0] - ray.origin[0], vertex[1] - ray.origin[1], vertex[2] - ray.origin[2]];
    let [x, y, z] = permute(ray, &moved);
    [x - ray.shear[0] * z, y - ray.shear[1] * z, z]
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Ray;

    fn flat(vertices: [Vec3; 3]) -> FlatTriangle {
        FlatTriangle {
            v0: vertices[0].into(),
            primitive: 5,
            v1: vertices[1].into(),
            geometry_and_mirror: 2,
            v2: vertices[2].into(),
            instance_and_mask: 0xff00_0003,
        }
    }

    fn hit(triangle: &FlatTriangle, ray: Ray) -> Option<Hit> {
        triangle.intersect(&PreparedRay::new(&ray).unwrap(), ray.t_max)
    }

    #[test]
    fn a_hit_has_all_its_fields() {
        assert_eq!(size_of::<FlatTriangle>(), 48);
        for axis in 0..3 {
            let turn = |v: Vec3| Vec3::new(v[axis], v[(axis + 1) % 3], v[(axis + 2) % 3]);
            let triangle = flat([Vec3::ZERO, Vec3::X, Vec3::Y].map(turn));
            let ray = Ray::new(turn(Vec3::new(0.25, 0.5, 4.0)), turn(Vec3::new(0.0, 0.0, -2.0)));
            let front = hit(&triangle, ray).expect("the ray goes through the triangle");
            assert_eq!((front.t, front.barycentrics), (2.0, Vec2::new(0.25, 0.5)));
            assert_eq!(front.id(), (3, 2, 5));
            assert!(front.front_face, "counter-clockwise from +z");
            let back = Ray::new(turn(Vec3::new(0.25, 0.5, -4.0)), turn(Vec3::Z));
            assert!(!hit(&triangle, back).unwrap().front_face);
            let mirrored = FlatTriangle { geometry_and_mirror: 2 | FlatTriangle::MIRROR, ..triangle };
            let front = hit(&mirrored, ray).unwrap();
            assert!(!front.front_face);
            assert_eq!(front.geometry_index, 2);
        }
    }

    /// The front alone, whichever axis the ray goes along, and with a mirroring instance the other side.
    #[test]
    fn one_side_is_hit_where_only_one_is_wanted() {
        let triangle = flat([Vec3::ZERO, Vec3::X, Vec3::Y]);
        let mirrored = FlatTriangle { geometry_and_mirror: 2 | FlatTriangle::MIRROR, ..triangle };
        for (triangle, front) in [(triangle, -1.0), (mirrored, 1.0)] {
            for (x, y) in [(0.0, 0.0), (0.3, -0.2), (-4.0, 1e-30), (1e-25, 9.0)] {
                let dir = Vec3::new(x, y, front);
                let from = |dir: Vec3| Ray::new(Vec3::new(0.25, 0.25, 0.0) - dir * 2.0, dir);
                let seen =
                    |dir: Vec3| triangle.intersect_front(&PreparedRay::new(&from(dir)).unwrap(), f32::MAX);
                assert_eq!(seen(dir), hit(&triangle, from(dir)), "{dir}");
                assert!(seen(dir).is_some() && hit(&triangle, from(-dir)).is_some(), "{dir}");
                assert_eq!(seen(-dir), None, "{dir}");
            }
        }
        for normal in mirrored.normals() {
            assert_eq!(normal, Vec3::NEG_Z);
        }
    }

    #[test]
    fn the_window_is_closed() {
        let triangle = flat([Vec3::ZERO, Vec3::X, Vec3::Y]);
        let ray = Ray::new(Vec3::new(0.2, 0.2, 1.0), -Vec3::Z);
        assert!(hit(&triangle, ray.window(0.0, 1.0)).is_some());
        assert!(hit(&triangle, ray.window(1.0, 9.0)).is_some());
        assert!(hit(&triangle, ray.window(0.0, 0.999)).is_none());
        assert!(hit(&triangle, ray.window(1.001, 9.0)).is_none());
        assert!(hit(&triangle, ray.window(2.0, 0.5)).is_none());
    }

    #[test]
    fn a_mask_without_a_common_bit_sees_nothing() {
        let triangle =
            FlatTriangle { instance_and_mask: 0x0100_0000, ..flat([Vec3::ZERO, Vec3::X, Vec3::Y]) };
        let ray = Ray::new(Vec3::new(0.2, 0.2, 1.0), -Vec3::Z);
        assert!(hit(&triangle, ray.with_mask(3)).is_some());
        assert!(hit(&triangle, ray.with_mask(2)).is_none());
    }

    #[test]
    fn edges_and_vertices_are_inside() {
        let triangle = flat([Vec3::ZERO, Vec3::X, Vec3::Y]);
        for (x, y) in [(0.0, 0.0), (1.0, 0.0), (0.0, 1.0), (0.5, 0.0), (0.0, 0.5), (0.5, 0.5)] {
            assert!(hit(&triangle, Ray::new(Vec3::new(x, y, 3.0), -Vec3::Z)).is_some(), "{x} {y}");
        }
    }

    /// A ray that almost runs in the plane of a triangle has edge functions that are no longer normal numbers; a
    /// hit at infinity came of that. And small triangles must not lose their `t`.
    #[test]
    fn small_numbers_give_right_hits_or_none() {
        let triangle = flat([Vec3::ZERO, Vec3::X, Vec3::Y]);
        for tiny in [1e-40, 1e-39, -1e-38, 1e-37] {
            let ray = Ray::new(Vec3::new(-1.0, 0.25, 0.0), Vec3::new(1.0, 0.1, tiny));
            assert!(hit(&triangle, ray).is_none_or(|hit| (0.999..2.001).contains(&hit.t)), "{tiny}");
        }
        for size in [1e-12, 1e-9, 1e9, 1e12] {
            let triangle = flat([Vec3::ZERO, Vec3::X, Vec3::Y].map(|corner| corner * size));
            for length in [1e-12, 1.0, 1e12] {
                let ray = Ray::new(Vec3::new(0.25, 0.25, 3.0) * size, Vec3::new(0.0, 0.0, -length));
                let hit = hit(&triangle, ray).unwrap();
                assert!((hit.t / (size / length) - 3.0).abs() < 1e-5, "{size} {length}: {hit:?}");
            }
        }
    }

    #[test]
    fn a_degenerate_triangle_is_never_hit() {
        let line = flat([Vec3::ZERO, Vec3::X, Vec3::X * 2.0]);
        assert!(!line.triangle().is_degenerate(), "three points on a line may close a gap");
        assert!(!line.triangle().has_area());
        assert!(hit(&line, Ray::new(Vec3::new(0.5, 0.0, 1.0), -Vec3::Z)).is_none());
        let point_twice = flat([Vec3::ZERO, Vec3::new(1.0, 0.3, 0.7), Vec3::ZERO]);
        assert!(point_twice.triangle().is_degenerate());
        assert!(hit(&point_twice, Ray::new(Vec3::new(0.5, 0.15, 1.0), -Vec3::Z)).is_none());
    }
}
