//! From where rays leave a surface: a little above it, at any scale, but never far.
//!
//! **Why at all.** A point computed on a triangle lies off its plane by rounding. A ray that starts there may
//! find the triangle itself in its way: dark specks ("acne"). Too large a step lets light into contacts.
//!
//! **How far the point is off.** It is computed from the barycentrics in f64 and rounded once to f32, by half a
//! step of each coordinate. Along the normal `n` that is at most `2^-24 * sum(|n_i| * |p_i|)`. The error of the
//! barycentrics moves the point within the plane, which does no harm; the hit's `t`, whose error grows with the
//! distance of the eye, takes no part.
//!
//! **How far the test is off.** The triangle test of the core subtracts the ray's origin from the vertices,
//! which rounds to `2^-24` of the difference, and shears, which rounds a few times more: a small multiple of
//! `2^-24` of the triangle's extent, however far it is from the origin.
//!
//! So the step is `2^-24 * STEPS * (sum(|n_i| * largest |v_i|) + extent)` along the geometric normal. It
//! follows the scale of the scene, the scale of the triangle, and the direction of the normal: on a level floor
//! at height zero a thousand kilometres from the origin it is as small as the floor's triangles allow.

use glam::Vec3;

/// Steps of `2^-24`. The tests below find rays that meet their own triangle at 1 step and none at 2; 8 leaves
/// room for neighbours whose planes are not quite the same.
const STEPS: f32 = 8.0;

/// The distance along the unit normal of a triangle at which rays leave it.
#[inline]
pub(crate) fn distance(vertices: &[Vec3; 3], normal: Vec3) -> f32 {
    distance_in_steps(vertices, normal, STEPS)
}

#[inline]
fn distance_in_steps(vertices: &[Vec3; 3], normal: Vec3, steps: f32) -> f32 {
    let [a, b, c] = *vertices;
    let largest = a.abs().max(b.abs()).max(c.abs());
    let extent = (a.max(b).max(c) - a.min(b).min(c)).max_element();
    (normal.abs().dot(largest) + extent) * (steps / 16_777_216.0)
}

/// Where rays leave a surface that is shaded with interpolated normals.
///
/// The facets of a smooth shape hide the light from one another although the shape they stand for would not: the
/// light's edge comes out in teeth. The point is lifted onto the curved surface that the normals describe, by
/// the mean of its projections onto the planes at the corners (Hanika 2021); in hollows it stays where it is.
#[inline]
pub(crate) fn lifted(point: Vec3, vertices: &[Vec3; 3], normals: &[Vec3; 3], weights: [f32; 3]) -> Vec3 {
    let mut lift = Vec3::ZERO;
    for corner in 0..3 {
        let below = (point - vertices[corner]).dot(normals[corner]).min(0.0);
        lift -= normals[corner] * (below * weights[corner]);
    }
    point + lift
}

#[cfg(test)]
mod tests {
    use super::*;
    use ropewalk::{FlatTriangle, PreparedRay, Ray};

    /// A fixed sequence of numbers from 0 to 1.
    struct Numbers(u64);
    impl Numbers {
        fn next(&mut self) -> f32 {
            self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            (self.0 >> 40) as f32 / 16_777_216.0
        }
        fn vector(&mut self) -> Vec3 {
            Vec3::new(self.next(), self.next(), self.next()) * 2.0 - 1.0
        }
    }

    /// How many of many rays away from triangles of many sizes and places meet the triangle they leave.
    fn self_hits(steps: f32) -> usize {
        let mut numbers = Numbers(7);
        let mut hits = 0;
        for round in 0..200_000 {
            let place = numbers.vector() * 10.0_f32.powi(round % 9 - 3);
            let size = 10.0_f32.powi(round / 9 % 7 - 4);
            let vertices = [0; 3].map(|_| place + numbers.vector() * size);
            let [a, b, c] = vertices.map(Vec3::as_dvec3);
            let Some(normal) = (b - a).cross(c - a).try_normalize() else { continue };
            let (u, v) = (numbers.next(), numbers.next());
            let (u, v) = if u + v > 1.0 { (1.0 - u, 1.0 - v) } else { (u, v) };
            let point = (a + (b - a) * f64::from(u) + (c - a) * f64::from(v)).as_vec3();
            let normal = normal.as_vec3();
            let origin = point + normal * distance_in_steps(&vertices, normal, steps);
            // Half of the directions graze the plane.
            let along = numbers.vector();
            let flat = along - normal * along.dot(normal);
            let rise = if round % 2 == 0 { 1e-4 * numbers.next() } else { numbers.next() };
            let ray = Ray::new(origin, flat + normal * rise);
            let flat = FlatTriangle {
                v0: vertices[0].into(),
                primitive: 0,
                v1: vertices[1].into(),
                geometry_and_mirror: 0,
                v2: vertices[2].into(),
                instance_and_mask: 0xff00_0000,
            };
            let prepared = PreparedRay::new(&ray);
            hits += usize::from(prepared.is_some_and(|ray| flat.intersect(&ray, f32::INFINITY).is_some()));
        }
        hits
    }

    #[test]
    fn no_ray_meets_the_triangle_it_leaves() {
        assert_eq!(self_hits(STEPS), 0);
        assert!(self_hits(0.0) > 1000, "without a step the test must find specks");
        println!("self hits by steps: {:?}", [0.5, 1.0, 2.0, 3.0, 4.0, 8.0].map(self_hits));
    }

    #[test]
    fn a_level_floor_far_away_keeps_a_small_step() {
        let floor =
            [Vec3::new(1e6, 0.0, 1e6), Vec3::new(1e6 + 1.0, 0.0, 1e6), Vec3::new(1e6, 0.0, 1e6 + 1.0)];
        assert!(distance(&floor, Vec3::Y) < 1e-5);
        let wall = [Vec3::new(1e6, 0.0, 0.0), Vec3::new(1e6, 1.0, 0.0), Vec3::new(1e6, 0.0, 1.0)];
        assert!(distance(&wall, Vec3::X) > 0.4);
    }

    #[test]
    fn a_bulge_is_lifted_and_a_hollow_is_not() {
        let vertices = [Vec3::new(-1.0, 0.0, 0.0), Vec3::new(1.0, 0.0, 0.0), Vec3::new(0.0, 1.0, 0.0)];
        let bulge = [Vec3::new(-0.5, 0.0, 1.0), Vec3::new(0.5, 0.0, 1.0), Vec3::new(0.0, 0.5, 1.0)]
            .map(Vec3::normalize);
        let point = Vec3::new(0.0, 0.25, 0.0);
        let weights = [0.375, 0.375, 0.25];
        assert!(lifted(point, &vertices, &bulge, weights).z > 0.1);
        let hollow = bulge.map(|normal| Vec3::new(-normal.x, -normal.y, normal.z));
        let kept = lifted(point, &vertices, &hollow, weights);
        assert!(kept.distance(point) < 1e-6 || kept.z <= 0.2, "{kept}");
        assert_eq!(lifted(vertices[0], &vertices, &bulge, [1.0, 0.0, 0.0]), vertices[0]);
    }
}
